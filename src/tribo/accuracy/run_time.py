"""The time of a run by the model of costs: its evaluations, and the time of each."""

from __future__ import annotations

import numpy as np

from tribo.accuracy.choose_method import PAIR, RATES, Rate
from tribo.integrators.methods import Method
from tribo.integrators.splitting import Splitting
from tribo.integrators.step_control import count_of_steps
from tribo.layout.layout import Layout
from tribo.loops.pair import has_pair_loop

# Time of a pair of bobs, and of a call of an ASE calculator [ns]: of 512 bobs on 512 with AVX-512
# Coulomb takes 0.8 and Morse 2.9; EMT takes a million.
PAIR_OF_BOBS = 2.0
CALCULATOR_CALL = 1e6
# Neighbours of a bob in a list, as in benchmarks/scale.py: each is in reach of about a dozen.
LISTED = 16.0


def pairs_of_bobs(layout: Layout) -> tuple[int, bool]:
    """The pairs of bobs that are visited in one evaluation, and whether some are listed.

    Of listed bobs each is taken to have LISTED neighbours.
    """
    counts = [surface.count for surface in layout.scene.surfaces]
    visited, listed = 0.0, False
    for contact in (*layout.model.contacts, *(layout.model.within or ())):
        for (one, other), row in zip(contact.pairs.tolist(), contact.rows.tolist(), strict=True):
            among = counts[one] * (counts[one] - 1) // 2
            every = among if one == other else counts[one] * counts[other]
            visited += every if row < 0 else LISTED * counts[one]
            listed = listed or row >= 0
    return round(visited), listed


def evaluation_time(layout: Layout, method: Method) -> float:
    """Nanoseconds of one evaluation by the model of costs, which knows no effect apart."""
    rate = rate_of(layout, method)
    oscillators = layout.coordinates - layout.core
    pairs, _ = pairs_of_bobs(layout)
    return (
        rate.run
        + layout.scene.count * rate.asperite
        + oscillators * rate.oscillator
        + pairs * PAIR_OF_BOBS
        + len(layout.calculator_calls) * CALCULATOR_CALL
    )


def rate_of(layout: Layout, method: Method) -> Rate:
    """The costs of a method on a scene."""
    return PAIR if has_pair_loop(layout, method) else RATES[method.name]


def counted(layout: Layout, method: Method, step: float, times: np.ndarray) -> float:
    """The evaluations of one run through `times` with a given step."""
    each = RATES[method.name].step
    if isinstance(method.coefficients, Splitting):
        each = method.coefficients.kicks.size
    intervals = np.diff(times)
    steps = np.sum(count_of_steps(intervals, step))
    return float(steps * each + (not method.splits))
