"""The compiled loop of one asperite on one, and all that it writes: for one run at a time."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from tribo.compiler.jit import EntryPoint, time_loop
from tribo.integrators.step_control import Tolerance
from tribo.kernels.records import CLOCK
from tribo.kernels.status import COMPLETED, PAUSED, Status
from tribo.layout.layout import Layout
from tribo.layout.pair_factors import Factors
from tribo.ledger.pair_samples import PairSamples
from tribo.loops.general import numbers_of, set_numbers
from tribo.loops.integrate import (
    Checkpoints,
    Columns,
    Integration,
    Memory,
    Progress,
    integrate,
)
from tribo.pair.loop import COLUMNS, pair_collocation
from tribo.pair.step_rows import LIMITS, STATE
from tribo.plugins.compile_errors import compiling
from tribo.plugins.sources import source_stamp

# Steps before a run without a progress report can be interrupted: a few milliseconds.
UNINTERRUPTED_STEPS = 2048


class PairLoop:
    """The time loop of a pair.

    Parameters
    ----------
    layout : Layout
        The scene.
    scene_arguments : tuple
        The scene as the loop reads it, and its potential.
    rows : ndarray, (ROWS, 8)
        The loop's memory; the first rows are the method's table.
    factors : Factors
        From the loop's record to the layout.

    Raises
    ------
    InputError
        If the potential does not compile.

    Attributes
    ----------
    layout : Layout
        Of the scene.
    adaptive : bool
        True: the loop chooses its steps.
    calls : tuple
        Empty: it calls no calculators.
    clocks : ndarray, (1,)
        How far the run has come.
    tolerance : Tolerance or None
        From which the limits in its memory were made.
    """

    adaptive = True
    calls = ()

    def __init__(
        self,
        layout: Layout,
        scene_arguments: tuple[Any, ...],
        rows: np.ndarray,
        factors: Factors,
    ) -> None:
        """Compile the loop, or load it from disk."""
        self.layout = layout
        self.tolerance: Tolerance | None = None
        self.clocks, self._rows, self._factors = np.zeros(1, CLOCK), rows, factors
        self._evaluations = self.clocks["evaluations"]  # the loop begins a run where this is 0
        self._start = layout.start
        loop = time_loop(pair_collocation, source_stamp(layout.plugins))
        fixed = (*scene_arguments, rows, self.clocks)
        examples = (layout.start, np.zeros(1), np.empty((2, COLUMNS)), 0)
        with compiling(loop, layout.named_plugins):
            self._loop = EntryPoint(loop, fixed, examples)

    def set_up(self, tolerance: Tolerance, limits: np.ndarray) -> None:
        """Run with a tolerance, from which the loop's own limits (2, 8) follow."""
        self.tolerance = tolerance
        self._rows[LIMITS:STATE] = limits
        self.clocks["encounter_fraction"] = tolerance.encounter_fraction

    def integrate(
        self,
        start: np.ndarray,
        times: np.ndarray,
        progress: Progress | None = None,
        checkpoints: Checkpoints | None = None,
        most: float | None = None,
    ) -> Integration:
        """Integrate from `start`, y of the scene's layout, through `times`.

        With `most` force evaluations, or those of the scene without it.
        """
        began = time.perf_counter()
        self._evaluations[0] = 0
        self._start = start
        if progress is not None or checkpoints is not None:
            return integrate(self, times, progress, None, checkpoints, most=most)
        record = np.empty((times.size + 1, COLUMNS))
        code = self._loop(start, times, record, UNINTERRUPTED_STEPS)
        if code != COMPLETED:
            if code != PAUSED:
                self._evaluations[0] = 0  # from the start again, to the same end
            return integrate(self, times, columns=(record,), most=most)
        seconds, clock = time.perf_counter() - began, self.clocks.tobytes()
        rows, factors = self._rows[STATE:].copy(), self._factors
        return Integration(
            lambda: PairSamples(times, record[:-1], record[0], factors),
            Status.COMPLETED,
            record[-1],
            seconds,
            lambda: _memory(np.frombuffer(clock, CLOCK), rows),
        )

    def room(self, samples: int) -> Columns:
        """Arrays for so many samples."""
        return (np.empty((samples, COLUMNS)),)

    def advance(self, times: np.ndarray, columns: Columns, budget: int) -> int:
        """Take at most `budget` steps, and record the samples at `times`; a code of a status."""
        code: int = self._loop(self._start, times, columns[0], budget)
        return code

    def forget_neighbours(self) -> None:
        """Nothing, as a pair has no list."""

    def memory(self) -> Memory:
        """All that another loop of this kind needs to continue."""
        return _memory(self.clocks, self._rows[STATE:].copy())

    def restore(self, memory: Memory) -> None:
        """Continue where another loop of this kind was."""
        set_numbers(self.clocks, memory["clock"])
        self._rows[STATE:] = memory["pair"]

    def samples(self, times: np.ndarray, columns: Columns) -> PairSamples:
        """The first samples in `columns`, of the scene's layout, which were recorded at `times`."""
        record = columns[0][: times.size]
        return PairSamples(times, record, record[0], self._factors)


def _memory(clocks: np.ndarray, rows: np.ndarray) -> Memory:
    return {"clock": numbers_of(clocks), "pair": rows}
