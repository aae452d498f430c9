"""Members of scenes at rest, without noise, or damped, by equal steps of any method."""

import numpy as np
import pytest

import tribo
from tribo.model.parameters import with_values


def pulled(temperature=0.0, gamma=1.0, samples=41):
    """A tip that starts at rest, without any energy, and that a stage pulls."""
    upper = tribo.Surface(
        "upper",
        drive=tribo.Pulled(stiffness=0.5, speed=0.2),
        langevin=tribo.Langevin(gamma, temperature) if gamma else None,
    )
    return tribo.Scene((upper,), (), 10.0, output=tribo.Output(samples=samples))


@pytest.mark.parametrize("method", ["midpoint", "rk4", "verlet"])
def test_damped_members_by_any_method(method):
    """Methods that do not split measure no stiffness."""
    how = {"method": method, "step": 0.05}
    found = tribo.ensemble(pulled(), 3, {"upper.theta": [0.1, 0.2, 0.3]}, keep=["upper.W"], **how)
    for value, theta in zip(found["upper.W"].values, (0.1, 0.2, 0.3), strict=True):
        start = with_values(pulled(), {"upper.theta": theta})
        assert value == pytest.approx(
            tribo.simulate(start, **how)["upper"].W[-1], rel=1e-12, abs=0.0
        )


def test_members_with_noise_of_a_scene_without():
    """The scene's method has no noise; the members once ran without theirs, and said nothing."""
    for how in ({"step": 0.05}, {}):
        with pytest.raises(tribo.InputError, match="effects that the scene does not have"):
            tribo.ensemble(pulled(), 4, {"upper.langevin.temperature": [0.3] * 4}, **how)
    vary = {"upper.langevin.temperature": [0.3] * 4}
    found = tribo.ensemble(pulled(), 4, vary, keep=["upper.W"], method="verlet", step=0.05)
    assert np.ptp(found["upper.W"].values) > 1e-3


@pytest.mark.parametrize("method", ["midpoint", "rk4", "verlet"])
def test_a_scene_that_starts_without_energy_does_not_run_away(method):
    """The first work is zero by equal steps; the first energy, of 1e-12, is not."""
    for samples in (41, 401):
        result = tribo.simulate(pulled(gamma=0.0, samples=samples), method=method, step=0.05)
        assert result.status == "completed"


@pytest.mark.parametrize(
    ("upper", "lower"),
    [
        pytest.param([0.0, 0.5, 2.0], [1.0, 1.0, 1.0], id="springs that only some have"),
        pytest.param([0.5, 0.0, 0.0], [0.0, 1.0, 2.0], id="springs that change surfaces"),
    ],
)
def test_members_by_tolerances_whose_accounts_differ(upper, lower):
    """Ends of springs have accounts of their own, for which the scene's tolerances need no place.

    Members of the first kind ended as a ValueError once.
    """
    pair = [
        tribo.Surface(
            name,
            shape=(2, 1),
            spacing=(1.0, 0.0),
            asperite=tribo.Asperite(kappa=kappa),
            bob=(0.0, height),
            facing=facing,
        )
        for name, kappa, height, facing in (("upper", 0.5, 1.0, "down"), ("lower", 0.0, 0.0, "up"))
    ]
    scene = tribo.Scene(pair, tribo.Yukawa(0.3, 1.0), 1.0, output=tribo.Output(samples=3))
    how = {"method": "dop853", "accuracy": 1e-7}
    keys = "upper.asperite.kappa", "lower.asperite.kappa"
    vary = dict(zip(keys, (upper, lower), strict=True))
    found = tribo.ensemble(scene, 3, vary, keep=["upper.W"], **how)
    for value, *kappas in zip(found["upper.W"].values, upper, lower, strict=True):
        own = tribo.simulate(with_values(scene, dict(zip(keys, kappas, strict=True))), **how)
        assert value == pytest.approx(own["upper"].W[-1], rel=1e-6)
        assert value != 0.0
