"""Many runs of one scene of any kind, which differ in their starts and seeds, in threads."""

from __future__ import annotations

import numpy as np
from numba import config

from tribo.compiler.jit import EntryPoint
from tribo.integrators.methods import Method
from tribo.integrators.step_control import Tolerance
from tribo.kernels.status import COMPLETED, PAUSED
from tribo.layout.layout import Layout
from tribo.layout.loop_memory import arrays_in, together
from tribo.ledger.member_samples import MemberRuns, MemberSamples
from tribo.ledger.sinks import exceeds_memory
from tribo.loops.general import GeneralLoop, in_blocks
from tribo.loops.guards import FEWEST_TRIALS, ProgressGuard, most_evaluations
from tribo.loops.integrate import Columns, Setting, first_step_at
from tribo.pair.members import CODE, EVALUATIONS, STEPS

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


class ReusedLoop(GeneralLoop):
    """A time loop that runs one member after another, with arrays of its own.

    Parameters
    ----------
    layout : Layout
        That of all members, but for their starts and seeds.
    method : Method
        How time advances.
    first_step : float
        The longest first step of an adaptive method [time].
    """

    def __init__(self, layout: Layout, method: Method, first_step: float) -> None:
        setting: Setting = 1.0
        if method.adaptive:
            n, accounts = layout.coordinates, layout.accounts
            setting = Tolerance(np.ones(2 * n), np.ones(accounts), 1.0, 1.0)
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

    def set_up(self, setting: Setting) -> None:
        """Run members with a setting."""
        self._constants = (self._method.coefficients, in_blocks(setting, self.layout))
        if isinstance(setting, Tolerance):
            clock = self._fresh[1]
            clock["h"] = first_step_at(setting, self._longest, self._method.order)
            clock["encounter_fraction"] = setting.encounter_fraction

    def begin(self, start: np.ndarray, seed: int) -> None:
        """Forget the last member, and begin the next from y at t = 0."""
        for array, fresh in zip(self._own, self._fresh, strict=True):
            array[...] = fresh
        self.forget_neighbours()
        self.state.y[self._places] = start
        if self._noise:
            self._noise = (np.random.default_rng([seed, 2]),)

    def advance(self, times: np.ndarray, columns: Columns, budget: int) -> int:
        """Take at most `budget` steps, and record the samples at `times`; a code of a status."""
        code: int = self._entry(*self._arguments(times, columns, budget))
        return code

    def to_end(self, columns: Columns) -> int:
        """Run the member through the times of the scene.

        Returns a code of a status; PAUSED of a member that makes no progress.
        """
        times = self.layout.times
        code = self.advance(times, columns, MOST_STEPS)
        if code != PAUSED:  # nearly always
            return code
        scene = self.layout.scene
        most = most_evaluations(scene)
        guard = ProgressGuard(self.clocks, times[0], times[-1], scene.count, most)
        while code == PAUSED and not (self.adaptive and guard.is_hopeless()):
            code = self.advance(times, columns, guard.within(MOST_STEPS))
        return code


class GeneralMembers:
    """Runs members of a scene, in threads.

    Parameters
    ----------
    layout : Layout
        The scene, for which `has_batches` is true.
    method : Method
        How time advances; its loop has been compiled.
    first_step : float
        The longest first step of an adaptive method [time].
    """

    def __init__(self, layout: Layout, method: Method, first_step: float) -> None:
        self._layout = layout
        self._method = method
        self._first_step = first_step
        self._idle: list[ReusedLoop] = []

    def run(
        self, setting: Setting, starts: np.ndarray, seeds: np.ndarray | None = None
    ) -> MemberRuns:
        """Run members with `starts` (members, 2 coordinates) and `seeds`, in this thread.

        Seeds matter where there is noise.  The samples of members that did not complete are zeros.
        """
        loop = self._free_loop()
        times, members = self._layout.times, len(starts)
        columns = tuple(np.empty((members, *each.shape)) for each in loop.room(times.size))
        counts = np.empty((members, 3), np.int64)
        loop.set_up(setting)
        clock = loop.clocks.view(np.ndarray)[0]
        for m in range(members):
            own = tuple(each[m] for each in columns)
            loop.begin(starts[m], 0 if seeds is None else int(seeds[m]))
            code = loop.to_end(own)
            counts[m, CODE] = code
            counts[m, STEPS], counts[m, EVALUATIONS] = clock["steps"], clock["evaluations"]
            if code != COMPLETED:
                for each in own:
                    each[...] = 0.0
        self._idle.append(loop)
        each_time = (
            np.swapaxes(each, 0, 1).reshape(times.size * members, *each.shape[2:])
            for each in columns
        )
        samples = MemberSamples(members, np.repeat(times, members), *each_time)
        return MemberRuns.of(self._layout, samples, counts)

    def _free_loop(self) -> ReusedLoop:
        """A loop that no thread uses."""
        try:
            return self._idle.pop()
        except IndexError:
            return ReusedLoop(self._layout, self._method, self._first_step)
