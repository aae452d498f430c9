"""Settings of runs by the level of their errors, relative to the scales."""

from __future__ import annotations

import numpy as np

from tribo.accuracy.tolerance_scales import FLOOR, ToleranceScales, tolerances
from tribo.integrators.methods import Method
from tribo.layout.layout import Layout
from tribo.loops.integrate import Integration, Setting
from tribo.loops.resolution import bath_frequency, spring_frequency, unit_step

# Level of the fine run relative to the coarse ones.  Their difference exceeds the error of the
# fine run by about the inverse of this.  Errors of adaptive steps differ by chance, so that two
# runs may agree: of 600 random pairs of asperites 2.3 % had errors above the estimates at 0.3, and
# 0.3 % at 0.1.  Errors of equal steps fall smoothly.
FINE_LEVEL = 0.1
FINE_LEVEL_OF_EQUAL_STEPS = 0.3
# The longest step of a coarse run, as a fraction of the time to the next encounter.  That of a
# fine run is shorter, so that errors which tolerances do not control fall as much.
NEAR = 0.5
# Asperites that take as long as a call of an ASE calculator: 1 ms, as measured for EMT.
CALL = 8000


def fine_level(method: Method) -> float:
    """Level of a fine run relative to that of the coarse runs that it is compared with."""
    return FINE_LEVEL if method.adaptive else FINE_LEVEL_OF_EQUAL_STEPS


def finest_level(method: Method) -> float:
    """The finest level of coarse runs, with which a fine run is still finer."""
    return FLOOR / fine_level(method)


def setting_at(
    layout: Layout, method: Method, scales: ToleranceScales, level: float, near: float = NEAR
) -> Setting:
    """The setting whose errors are about `level` of the scales: tolerances or equal steps.

    Of an adaptive method, `near` is the longest step, as a fraction of the time to the next
    encounter.
    """
    if method.adaptive:
        return tolerances(layout, scales, level, near)
    return equal_step(layout, method, level)


def equal_step(layout: Layout, method: Method, level: float) -> float:
    """The equal step whose errors are about `level` of the scales."""
    return _unit(layout) * level ** (1.0 / method.order)


def coarsest_level(layout: Layout, method: Method) -> float:
    """The coarsest level, whose equal steps turn the fastest oscillator of a bath by one radian.

    Splitting methods advance oscillators exactly.  Others with longer steps damp a fast one or let
    it grow, at all levels alike, so that differences do not show their errors.
    """
    fastest = 0.0 if method.adaptive or method.splits else bath_frequency(layout)
    if fastest == 0.0:
        return 1.0
    return float(min(1.0, 1.0 / (fastest * _unit(layout))) ** method.order)


def _unit(layout: Layout) -> float:
    """The equal step of level 1: pendulums and springs turn by one radian at most."""
    springs = spring_frequency(layout)
    return min(unit_step(layout), 1.0 / springs if springs > 0.0 else np.inf)


def work(layout: Layout, run: Integration) -> float:
    """Force evaluations times asperites: a measure of cost that is the same on every machine."""
    return run.evaluations * float(layout.asperites.size + CALL * len(layout.calculator_calls))
