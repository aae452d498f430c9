"""What all time loops share: how near the next encounter is, and whether numbers are numbers."""

import math

from tribo.kernels.compiled import kernel
from tribo.kernels.contact import encounter_rate
from tribo.kernels.motion import top_speeds

EPSILON = 2.0**-52


@kernel
def nearness(model, neighbours, t, y, speeds):
    """Rate at which the nearest encounter comes, and the smallest distance; bobs in place."""
    n = y.size // 2
    top_speeds(model, t, y[:n], y[n:], speeds)
    return encounter_rate(model, neighbours, speeds)


@kernel
def all_finite(x):
    """Whether every component is a number."""
    for m in range(x.size):
        if not math.isfinite(x[m]):
            return False
    return True
