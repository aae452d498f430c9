"""The smoothness of potentials at their range, where their classes declare none."""

import math
from typing import Any

import numpy as np

from tribo.plugins.classes import parts
from tribo.potentials.potential import Potential, acting_charges

# Distances from the end of a potential, in units of its range, at which its energy is looked at.
INWARD = (2.0**-8, 2.0**-9, 2.0**-10)
# Largest difference of two exponents of one power: their next terms are a percent of it there.
SAME = 0.1


def smoothness_of(potential: Any) -> float:
    """The number of continuous derivatives of U: what is declared, at most what its ends show.

    A class that has a range, and declares no smoothness, would have infinitely many.  Methods of
    high order lose it at the end, and their error estimates fall too slowly to meet a request.
    """
    found = float(potential.smoothness())
    for part in parts(potential):
        if isinstance(part, Potential) and type(part).smoothness is Potential.smoothness:
            found = min(found, _at_end(part))
    return found


def _at_end(potential: Potential) -> float:
    """The number of continuous derivatives where U ends; infinite where it is no power there.

    U of the distance x from the end, as x^p, has those below the p-th.
    """
    end = float(potential.range())
    if not math.isfinite(end):
        return math.inf
    try:
        charges = acting_charges(potential)
        with np.errstate(all="ignore"):
            energies = [float(potential.energy_between(end * (1.0 - x), *charges)) for x in INWARD]
            far, near = np.log2(np.abs(np.divide(energies[:-1], energies[1:]))).tolist()
    except Exception:  # a user's methods may raise anything: it is reported when they are compiled
        return math.inf
    if not abs(far - near) < SAME:
        return math.inf
    return max(-1, math.ceil(near - SAME) - 1)
