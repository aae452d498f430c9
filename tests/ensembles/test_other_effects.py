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
        assert value == pytest.approx(tribo.simulate(start, **how)["upper"].W[-1], rel=1e-12)


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
