"""Gains of energy from Gibbs starts, for tests of the theorems of statistical mechanics."""

from dataclasses import replace

import numpy as np

import tribo

# Standard errors by which a mean may miss: of 16,000 tests one does.
MOST = 4.0
TEMPERATURE = 3.0


def deviation(weights: np.ndarray) -> float:
    """How many standard errors the mean of some weights is from 1."""
    return float((weights.mean() - 1.0) / weights.std() * np.sqrt(weights.size))


def gain(
    scene: tribo.Scene, members: int, seed: int = 1, temperature: float = TEMPERATURE, **settings
) -> np.ndarray:
    """The energies that all pendulums gain from starts at the temperature."""
    keep = [f"{s.name}.swing_energy" for s in scene.surfaces]
    starts = {"*.swing_state": tribo.Canonical(temperature)}
    data = tribo.ensemble(scene, members, starts, seed=seed, keep=keep, **settings)
    found = np.zeros(members)
    for s in scene.surfaces:
        each = s.each
        driven = isinstance(s.drive, tribo.DrivenBars)
        inertia = each["m1"] * each["length"] ** 2 if driven else each["inertia"]
        swing, omega = (data[f"{s.name}.{part}"].values for part in ("swing", "omega"))
        start = 0.5 * inertia * omega**2 + 0.5 * each["kappa"] * swing**2
        found += (data[f"{s.name}.swing_energy"].values - start).sum(axis=1)
    return found


def rows(counts=(2, 1), drive=None, **others) -> tribo.Scene:
    """Some asperites over others, in contact from the start."""
    drive = tribo.Forced() if drive is None else drive
    soft = tribo.Asperite(m1=0.7, m2=1.5, kappa=1.9, length=1.3)
    row = {"spacing": (1.1, 0.0), "drive": drive, "asperite": soft}
    upper = tribo.Surface("upper", shape=(counts[0], 1), bob=(-1.0, 0.3), velocity=(0.7, 0), **row)
    lower = tribo.Surface("lower", shape=(counts[1], 1), facing="up", **row)
    return tribo.Scene((upper, lower), tribo.Gaussian(1.5, 0.5), 4.0, **others)


def passing(gap: float, speed: float, duration: float, gaussian: tribo.Gaussian) -> tribo.Scene:
    """A pair whose bobs pass at a distance, midway in time: its own image under reversal."""
    scene = rows((1, 1))
    upper, lower = scene.surfaces
    upper = replace(upper, bob=(-0.5 * speed * duration, gap), velocity=(speed, 0.0))
    return replace(
        scene,
        surfaces=(upper, lower),
        interactions=(tribo.Interaction(gaussian),),
        duration=duration,
        output=tribo.Output(samples=2, series=("energies",)),
    )


# Passes at T = 1, at a distance, so that coarse steps resolve the encounter.
PASSING = passing(3.0, 0.3, 20.0, tribo.Gaussian(8.0, 2.0))
