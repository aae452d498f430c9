"""Reservoirs that differ between the asperites of one surface."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

import tribo

MASS, SPRING, PIN = 3.0, 2.0, 0.5
RIGID = tribo.Asperite(m1=1.0, m2=2.0, kappa=np.inf)
GAMMA = (1.5, 0.0, 0.0, 0.0, 0.7)
TEMPERATURE = (1.0, 0.0, 0.0, 0.0, 0.2)


def chain(gamma, temperature, duration=12.0, series=(), asperite=RIGID, **langevin):
    surface = tribo.Surface(
        "chain",
        shape=(5, 1),
        spacing=(1.0, 0.0),
        drive=tribo.Pulled(stiffness=PIN, speed=0.0),
        springs=tribo.Springs(stiffness=SPRING),
        asperite=asperite,
        langevin=tribo.Langevin(gamma, temperature, **langevin),
    )
    output = tribo.Output(samples=4, series=series)
    numerics = tribo.Numerics(method="verlet", step=0.05)
    return tribo.Scene([surface], [], duration, output=output, numerics=numerics)


def moments(pin, duration):
    """<v^2> of each bar along one axis at the end, and the mean work of its reservoir.

    The covariance of the linear motion obeys C' = A C + C A^T + D, from rest.
    """
    n = len(GAMMA)
    ends = np.diff(np.eye(n), axis=0)
    stiffness = SPRING * ends.T @ ends + pin * np.eye(n)
    gamma = np.array(GAMMA)
    a = np.block([[np.zeros((n, n)), np.eye(n)], [-stiffness / MASS, -np.diag(gamma / MASS)]])
    noise = np.concatenate([np.zeros(n), 2.0 * gamma * TEMPERATURE / MASS**2])
    steps = 4000
    h = duration / steps
    # The exact step, by the exponential of a block matrix (C. Van Loan, 1978).
    both = expm(h * np.block([[-a, np.diag(noise)], [np.zeros((2 * n, 2 * n)), a.T]]))
    forward = both[2 * n :, 2 * n :].T
    added = forward @ both[: 2 * n, 2 * n :]
    c = np.zeros((2 * n, 2 * n))
    powers = []
    for _ in range(steps + 1):
        v2 = np.diag(c)[n:].copy()
        powers.append(gamma * (np.array(TEMPERATURE) / MASS - v2))
        c = forward @ c @ forward.T + added
    return v2, np.trapezoid(powers, dx=h, axis=0)


def test_chain():
    """Two ends at different temperatures: heat and temperatures are those of the exact moments.

    Z. Rieder, J. L. Lebowitz, E. Lieb, J. Math. Phys. 8 (1967) 1073, from rest on.
    """
    scene = chain(GAMMA, TEMPERATURE)
    keep = ["chain.vx_cm", "chain.vy_cm", "chain.w_T"]
    members = 400
    data = tribo.ensemble(scene, members, keep=keep, seed=2, progress=False)
    along, work = moments(PIN, scene.duration)
    across, other_work = moments(0.0, scene.duration)
    for name, wanted in (("vx_cm", along), ("vy_cm", across)):
        squares = data[f"chain.{name}"].values.reshape(members, 5) ** 2
        error = np.std(squares, axis=0) / np.sqrt(members)
        assert np.all(np.abs(np.mean(squares, axis=0) - wanted) <= 4.0 * error + 2e-3)
    works = data["chain.w_T"].values.reshape(members, 5)
    error = np.std(works, axis=0) / np.sqrt(members)
    assert np.all(np.abs(np.mean(works, axis=0) - work - other_work) <= 4.0 * error + 5e-3)
    assert np.max(np.abs(works[:, 1:4])) < 1e-15  # no reservoir acts there
    assert np.mean(works[:, 0]) > 0.5 > 0.0 > np.mean(works[:, 4])


@pytest.mark.parametrize("on", ["bar", "swing"])
def test_equal_numbers(on):
    """A list of equal numbers is the number, bit for bit; and lanes have the bits of runs alone."""
    swinging = tribo.Asperite(kappa=2.0)
    numbers = chain(0.4, 0.3, asperite=swinging, on=on)
    lists = chain([0.4] * 5, [0.3] * 5, asperite=swinging, on=on)
    uneven = chain([0.4, 0.0, 0.1, 0.4, 0.2], [0.3, 0.1, 0.2, 0.0, 0.1], asperite=swinging, on=on)
    alone = replace(uneven, output=replace(uneven.output, series=["forces"]))
    keep = ["chain.theta", "chain.heat"]
    found = [
        tribo.ensemble(scene, 9, keep=keep, seed=1, progress=False)
        for scene in (numbers, lists, uneven, alone)
    ]
    for name in keep:
        one, other, third, fourth = (data[name].values for data in found)
        np.testing.assert_array_equal(one, other)
        np.testing.assert_array_equal(third, fourth)
        assert not np.array_equal(one, third)


def test_friction_alone():
    """Without noise, every method has the friction of each asperite."""
    surface = tribo.Surface(
        "row",
        shape=(3, 1),
        spacing=(1.0, 0.0),
        velocity=(0.0, 0.0),
        drive=tribo.Free(),
        asperite=RIGID,
        initial={"vx": [1.0, 1.0, 1.0]},
        langevin={"gamma": [0.0, 1.0, 3.0]},
    )
    scene = tribo.Scene([surface], [], 2.0, output=tribo.Output(samples=3))
    for settings in ({"method": "gauss-radau-15"}, {"method": "verlet", "step": 0.01}):
        run = tribo.simulate(scene, **settings)
        wanted = np.exp(-np.array([0.0, 1.0, 3.0]) * 2.0 / MASS)
        np.testing.assert_allclose(run["row"]["vx_cm"][-1], wanted, atol=1e-8)


def test_states_and_files():
    scene = chain(GAMMA, TEMPERATURE, duration=6.0)
    assert tribo.model.scene_file.scene_from(scene.to_table()) == scene
    longer = replace(scene, duration=12.0, output=tribo.Output(times=[6.0, 12.0]))
    rest = tribo.simulate(longer, start=tribo.simulate(scene).state())
    whole = tribo.simulate(longer)
    np.testing.assert_allclose(rest["chain"]["vx_cm"][-1], whole["chain"]["vx_cm"][-1], atol=1e-12)


def test_refused():
    with pytest.raises(tribo.InputError, match=r"langevin.gamma: must be one number or an array"):
        chain([1.0, 2.0], 0.1)
    with pytest.raises(tribo.InputError, match=r"temperature\[1\]: must not be negative"):
        chain(GAMMA, [0.1, -0.1, 0.0, 0.0, 0.0])
