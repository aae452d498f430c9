"""What all time loops share: how near the next encounter is, and whether numbers are numbers."""

import math

from tribo.kernels.compiled import kernel
from tribo.kernels.contact import encounter_rate, widest_rate
from tribo.kernels.motion import top_speeds

EPSILON = 2.0**-52


@kernel
def nearness(model, neighbours, t, y, speeds):
    """Rate at which the nearest encounter comes, and the smallest distance; bobs in place."""
    n = y.size // 2
    top_speeds(model, t, y[:n], y[n:], speeds)
    return encounter_rate(model, neighbours, speeds)


@kernel
def looks(model):
    """Every how many steps to look for encounters at least: bobs at rest may be about to fall."""
    return 1 if model.asperites.size <= 64 else 8


@kernel
def glance(model, neighbours, t, y, speeds, h):
    """Rate at which the nearest encounter comes, looked at pair by pair only where it matters.

    If the fastest bobs could not cross a potential's feature in a quarter of the step h, no pair
    need be looked at.
    """
    n = y.size // 2
    top_speeds(model, t, y[:n], y[n:], speeds)
    bound = widest_rate(model, speeds)
    if h * bound <= 0.25:
        return bound
    rate, _ = encounter_rate(model, neighbours, speeds)
    return rate


@kernel
def all_finite(x):
    """Whether every component is a number."""
    for m in range(x.size):
        if not math.isfinite(x[m]):
            return False
    return True
