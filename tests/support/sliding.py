"""A long slide of two rows, with neighbour lists."""

import numpy as np

import tribo

CUTOFF = 1.5


POTENTIAL = tribo.LennardJones(0.05, 0.5).with_cutoff(CUTOFF)


def scene(upper: np.ndarray, lower: np.ndarray, periodic: dict[str, float]) -> tribo.Scene:
    """Two surfaces with their resting bobs at the given places."""
    surfaces = (
        tribo.Surface("upper", positions=upper, velocity=(1.0, 0.0)),
        tribo.Surface("lower", facing="up", positions=lower),
    )
    return tribo.Scene(surfaces, POTENTIAL, 1.0, periodic=periodic)


def long_slide(periodic: dict[str, float]) -> tribo.Scene:
    """Two rough grids; the upper one slides many spacings, and its bobs are kicked about."""
    rng = np.random.default_rng(3)
    soft = tribo.Asperite(kappa=0.5)
    upper = tribo.Surface(
        "upper",
        bob=(0.1, 0.55),
        velocity=(3.0, 0.0),
        shape=(4, 3),
        spacing=(1.0, 1.0),
        heights=rng.uniform(-0.1, 0.1, 12),
        asperite=soft,
        initial=tribo.Initial(omega=4.0),
    )
    lower = tribo.Surface("lower", facing="up", shape=(6, 3), spacing=(1.0, 1.0), asperite=soft)
    return tribo.Scene(
        (upper, lower), POTENTIAL, 12.0, periodic=periodic, output=tribo.Output(samples=7)
    )
