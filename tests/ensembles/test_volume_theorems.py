"""The integral theorem for random scenes, and with springs and baths, which move the bars."""

from dataclasses import replace

import numpy as np
import pytest

import tribo
from support.gibbs import MOST, TEMPERATURE, deviation, gain, rows

STEPS = {"method": "verlet", "step": 0.02}
SPREAD = 0.6
SPRINGS = tribo.Springs(3.0)
BATH = tribo.Bath(masses=[0.3, 0.2], frequencies=[1.1, 2.3], temperature=TEMPERATURE)


def with_surfaces(scene: tribo.Scene, **settings) -> tribo.Scene:
    """The scene with settings of all its surfaces."""
    return replace(scene, surfaces=tuple(replace(s, **settings) for s in scene.surfaces))


def random_scene(seed: int) -> tribo.Scene:
    """Two rows with random counts, places, masses, potential, speed and drive."""
    rng = np.random.default_rng(seed)
    drive = (tribo.Forced(), tribo.DrivenBars())[seed % 2]
    surfaces = []
    for name, facing in (("upper", "down"), ("lower", "up")):
        count = int(rng.integers(2, 4))
        masses = {k: rng.uniform(0.5, 1.5, count) for k in ("m1", "m2", "kappa")}
        moving = name == "upper"
        surfaces.append(
            tribo.Surface(
                name,
                facing=facing,
                shape=(count, 1),
                spacing=(rng.uniform(0.8, 1.6), 0.0),
                bob=(-1.5, rng.uniform(0.1, 0.5)) if moving else (0.0, 0.0),
                velocity=(rng.uniform(0.4, 1.2), 0.0) if moving else (0.0, 0.0),
                asperite=tribo.Asperite(**masses, length=rng.uniform(1.0, 2.0)),
                drive=drive,
            )
        )
    potential = (tribo.Gaussian(-1.0, 0.6), tribo.Morse(0.8, 2.0, 0.7), tribo.Yukawa(0.5, 1.0))
    return tribo.Scene(tuple(surfaces), potential[seed % 3], 3.0)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_random_scenes(seed):
    """Potentials of three kinds, with both drives."""
    w = gain(random_scene(seed), 2048, seed, method="verlet", step=0.02)
    assert abs(deviation(np.exp(-w / TEMPERATURE))) < MOST
    assert np.std(w) > 0.1


def everything(scene: tribo.Scene, members: int, bath: bool, **settings) -> dict[str, np.ndarray]:
    """Minus the logarithm of the density's ratio, end to start, of each kind of coordinate.

    Springs and baths move bars, so that places and velocities of centres of mass are drawn too:
    from a normal distribution about the motion without forces, with standard deviation SPREAD.
    Baths are drawn about the first velocity of their surface, which is zero with `bath`.
    """
    rng, kinds = np.random.default_rng(4), ("x", "y", "vx", "vy")
    vary: dict = {"*.swing_state": tribo.Canonical(TEMPERATURE)}
    for s in scene.surfaces:
        vary |= {f"{s.name}.{k}": rng.normal(0.0, SPREAD, (members, s.count)) for k in kinds}
    of_bath = ["k_bath", "e_bath"] if bath else []
    quantities = [*(f"{k}_cm" for k in kinds), "swing_energy", *of_bath]
    keep = [f"{s.name}.{q}" for s in scene.surfaces for q in quantities]
    output = tribo.Output(samples=2, series=("energies",))
    scene = replace(scene, output=output)
    data = tribo.ensemble(scene, members, vary, seed=1, keep=keep, at="samples", **settings)
    assert data.attrs["members"] == f'{{"completed": {members}}}'
    found = {"swings": np.zeros(members), "bars": np.zeros(members), "heat": np.zeros(members)}
    for s in scene.surfaces:
        energy = data[f"{s.name}.swing_energy"].values
        found["swings"] += (energy[:, 1] - energy[:, 0]).sum(axis=1) / TEMPERATURE
        for kind in kinds:
            start, place = vary[f"{s.name}.{kind}"], data[f"{s.name}.{kind}_cm"].values
            expected = s.velocity[0] * scene.duration if kind == "x" else 0.0
            end = start + place[:, 1] - place[:, 0] - expected
            found["bars"] += (0.5 * (end**2 - start**2) / SPREAD**2).sum(axis=1)
        if bath:
            energy = sum(data[f"{s.name}.{q}"].values.reshape(members, 2) for q in of_bath)
            found["heat"] += (energy[:, 1] - energy[:, 0]) / TEMPERATURE
    return found


def wide(counts: tuple[int, int], **settings) -> tribo.Scene:
    """Rows so far from each other that surfaces do not pass through each other."""
    scene = rows(counts)
    upper, lower = (replace(s, **settings) for s in scene.surfaces)
    upper = replace(upper, bob=(-1.0, 2.5))
    gaussian = tribo.Interaction(tribo.Gaussian(3.0, 1.2))
    return replace(scene, surfaces=(upper, lower), interactions=(gaussian,), duration=0.4)


@pytest.mark.slow
def test_springs_between_bars():
    """Springs move bars, whose coordinates are drawn with the swings."""
    found = everything(wide((2, 1), springs=SPRINGS), 4096, False, **STEPS)
    assert abs(deviation(np.exp(-found["swings"] - found["bars"]))) < MOST
    assert np.std(found["bars"]) > 0.3


@pytest.mark.slow
def test_baths():
    """Bars, swings and oscillators together fulfil the theorem; without one kind it fails."""
    scene = wide((1, 1), bath=BATH)
    upper, lower = scene.surfaces
    resting = replace(upper, velocity=(0.0, 0.0))
    found = everything(replace(scene, surfaces=(resting, lower)), 8192, True, **STEPS)
    assert abs(deviation(np.exp(-sum(found.values())))) < MOST
    assert abs(deviation(np.exp(-found["swings"]))) > 1.5 * MOST
    turned = found["heat"] - found["swings"] - found["bars"]
    assert abs(deviation(np.exp(turned))) > MOST
