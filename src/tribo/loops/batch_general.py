"""Many runs of one scene of any kind, one after another with the arrays of one loop."""

from __future__ import annotations

import numpy as np
from numba import config

from tribo.compiler.jit import EntryPoint
from tribo.integrators.methods import Method
from tribo.integrators.step_control import Tolerance
from tribo.kernels.status import CODE, COMPLETED, COUNTS, EVALUATIONS, PAUSED, STEPS
from tribo.layout.layout import Layout
from tribo.layout.loop_memory import arrays_in, together
from tribo.ledger.sinks import exceeds_memory
from tribo.loops.batch import MemberStarts, RecordingLoop
from tribo.loops.general import GeneralLoop, in_blocks, unit_setting
from tribo.loops.guards import FEWEST_TRIALS, ProgressGuard, most_evaluations
from tribo.loops.integrate import Columns, Setting, first_step_at

# Steps of a call of the loop, at most, since an interrupt waits for its end; no more than the guard
# of a run's progress lets pass before its first look.
MOST_STEPS = FEWEST_TRIALS


def has_batches(layout: Layout) -> bool:
    """Whether members of a scene can be run without a result for each.

    Forces as series and calculators of ASE need one.
    """
    compiled = not config.DISABLE_JIT  # type: ignore[attr-defined]
    alone = layout.calculator_calls or layout.scene.output.series
    return compiled and not (alone or exceeds_memory(layout, layout.times.size))


class GeneralMembers(GeneralLoop, RecordingLoop):
    """A time loop that runs one member after another of a scene for which `has_batches` is true.

    `first_step` is the longest one of an adaptive method [time].
    """

    def __init__(self, layout: Layout, method: Method, first_step: float) -> None:
        setting = unit_setting(layout, method)
        super().__init__(layout, method, setting, layout.start, first_step)
        self._method, self._longest = method, first_step
        (self.state, self._scratch), numbers = together((self.state, self._scratch))
        active = None if self._neighbours is None else self._neighbours.active
        self._own = [numbers, *arrays_in((self.clocks, active))]
        self._fresh = [array.copy() for array in self._own]
        q, coordinates = layout.places.q, layout.room[0]
        self._places = np.concatenate([q, coordinates + q])
        examples = self._arguments(layout.times, self.room(1), 0)
        self._entry = EntryPoint(self.compiled, (self.model,), examples)

    def fill(self, setting: Setting, starts: MemberStarts, columns: Columns) -> np.ndarray:
        """Run members, fill in their samples, and return their counts.

        Seeds matter where there is noise.  The samples of members that did not complete are zeros.
        """
        self._constants = (self._method.coefficients, in_blocks(setting, self.layout))
        if isinstance(setting, Tolerance):
            clock = self._fresh[1]
            clock["h"] = first_step_at(setting, self._longest, self._method.order)
            clock["encounter_fraction"] = setting.encounter_fraction
        counts = np.empty((len(starts.y), COUNTS), np.int64)
        clock = self.clocks.view(np.ndarray)[0]
        for m, count in enumerate(counts):
            own = tuple(each[m] for each in columns)
            for array, fresh in zip(self._own, self._fresh, strict=True):
                array[...] = fresh
            self.forget_neighbours()
            self.state.y[self._places] = starts.y[m]
            if self._noise:
                self._noise = (np.random.default_rng([int(starts.seeds[m]), 2]),)
            count[CODE] = self._to_end(own)
            count[STEPS], count[EVALUATIONS] = clock["steps"], clock["evaluations"]
            if count[CODE] != COMPLETED:
                for each in own:
                    each[...] = 0.0
        return counts

    def advance(self, times: np.ndarray, columns: Columns, budget: int) -> int:
        code: int = self._entry(*self._arguments(times, columns, budget))
        return code

    def _to_end(self, columns: Columns) -> int:
        """Run the member through the times of the scene.

        Returns a code of a status; PAUSED of a member that makes no progress.
        """
        times = self.layout.times
        code = self.advance(times, columns, MOST_STEPS)
        if code != PAUSED:  # nearly always
            return code
        scene, ends = self.layout.scene, (times[0], times[-1])
        guard = ProgressGuard(self.clocks, *ends, scene.count, most_evaluations(scene))
        while code == PAUSED and not (self.adaptive and guard.is_hopeless()):
            code = self.advance(times, columns, guard.within(MOST_STEPS))
        return code
