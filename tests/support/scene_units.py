"""Scenes in other units, as the tables of scene files."""

import numpy as np

# Powers of length, mass, time and charge of every key of a scene that has a unit.
UNITS_OF = {
    "duration": (0, 0, 1, 0),
    "bob": (1, 0, 0, 0),
    "spacing": (1, 0, 0, 0),
    "heights": (1, 0, 0, 0),
    "velocity": (1, 0, -1, 0),
    "speed": (1, 0, -1, 0),
    "origin": (1, 0, 0, 0),
    "m1": (0, 1, 0, 0),
    "m2": (0, 1, 0, 0),
    "mass": (0, 1, 0, 0),
    "kappa": (2, 1, -2, 0),
    "length": (1, 0, 0, 0),
    "bar_length": (1, 0, 0, 0),
    "i2": (2, 1, 0, 0),
    "inertia": (2, 1, 0, 0),
    "charge": (0, 0, 0, 1),
    "omega": (0, 0, -1, 0),
    "nu": (0, 0, -1, 0),
    "frequency": (0, 0, -1, 0),
    "stiffness": (0, 1, -2, 0),
    "load": (1, 1, -2, 0),
    "gamma": (0, 1, -1, 0),
    "D": (2, 1, -2, 0),
    "epsilon": (2, 1, -2, 0),
    "A": (2, 1, -2, 0),
    "amplitude": (2, 1, -2, 0),
    "C": (8, 1, -2, 0),
    "strength": (3, 1, -2, -2),
    "alpha": (-1, 0, 0, 0),
    "screening": (-1, 0, 0, 0),
    "period": (1, 0, 0, 0),
    "x": (1, 0, 0, 0),
    "z": (1, 0, 0, 0),
    "switch_from": (1, 0, 0, 0),
    "r0": (1, 0, 0, 0),
    "sigma": (1, 0, 0, 0),
    "softening": (1, 0, 0, 0),
    "rho": (1, 0, 0, 0),
}


def in_other_units(scene: dict, units: list[float]) -> dict:
    """The same scene in other units: factors of length, mass, time and charge."""

    def rescaled(key: str, value, bath: bool):
        """A value by its key, in other units; `bath` is whether it belongs to a bath."""
        if isinstance(value, dict):
            return {k: rescaled(k, v, bath or key == "bath") for k, v in value.items()}
        if isinstance(value, list):
            return [rescaled(key, item, bath) for item in value]
        powers = UNITS_OF.get(key, (0, 0, 0, 0))
        if key == "cutoff":  # of a potential a length, of a spectrum a frequency
            powers = (0, 0, -1, 0) if bath else (1, 0, 0, 0)
        if isinstance(value, str) or not any(powers):
            return value
        return value * float(np.prod([unit**p for unit, p in zip(units, powers, strict=True)]))

    return {key: rescaled(key, value, False) for key, value in scene.items()}
