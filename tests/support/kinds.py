"""Surfaces over one another that differ in their settings."""

import numpy as np

import tribo


def surfaces_of(kinds, shape):
    """A surface with the settings of each kind, and the pairs of those that face each other."""
    heights = 0.01 * np.arange(float(np.prod(shape)))
    grids = {"shape": shape, "spacing": (0.9, 0.9), "heights": heights}
    surfaces = [
        tribo.Surface(
            name,
            facing="up" if n % 2 else "down",
            bob=(0.3 * n, 0.4 * (n % 2)),
            depth=0.2 * n,
            velocity=(0.3 * (-1) ** n, 0.0),
            **({"initial": tribo.Initial(swing=0.1)} | grids | kind),
        )
        for n, (name, kind) in enumerate(kinds.items())
    ]
    names = list(kinds)
    return surfaces, [(one, other) for one in names[::2] for other in names[1::2]]
