"""The compiled time loops for one layout and one method: of single runs, and of members."""

from functools import cached_property
from typing import Any

import numpy as np

from tribo.integrators.methods import Method, named
from tribo.integrators.step_control import stricter
from tribo.kernels.status import Status
from tribo.layout.layout import Layout, lay_out
from tribo.ledger.guards import facing, lost_sample, passed_through
from tribo.ledger.sinks import StreamedLedger
from tribo.loops.batch import Batch, GeneralMembers, Pool
from tribo.loops.batch_pair import PairMembers
from tribo.loops.general import GeneralLoop, compile_loop
from tribo.loops.integrate import Integration, Progress, first_step_at, integrate
from tribo.loops.journal import Journal, key_of
from tribo.loops.lane_loop import NystromLanes, SplittingLanes, fit_lanes
from tribo.loops.origin import Origin, continued
from tribo.loops.pair import Pair
from tribo.loops.pair_records import has_pair_loop
from tribo.loops.resolution import first_step
from tribo.loops.saved_state import State
from tribo.loops.setting import Setting
from tribo.model.scene import Scene

# Factor of tolerances in one of two runs that are compared with a third, where forces are rough:
# a step over a jump of a derivative makes an error that depends on where it begins, and runs that
# end steps at other times alone take the same steps up to the first of these.
OTHER_STEPS = 0.7


class Integrator:
    """Integrates one layout by one method, with a loop that is compiled at construction.

    A pair of asperites has a loop of its own, `pair`, where the method provides one; runs that
    begin from an `origin`, a state, take the general loop.  `first_step` is the longest one of an
    adaptive method [time]; `threads` share each step.  Raises InputError if a plug-in cannot be
    compiled.
    """

    def __init__(
        self,
        layout: Layout,
        method: Method,
        progress: Progress | None = None,
        origin: Origin | None = None,
        journal: Journal | None = None,
        threads: int = 1,
    ) -> None:
        """Choose the loop of a pair or the general one, and compile it."""
        self.layout = layout
        self.method = method
        self.first_step = first_step(layout)
        self._progress = progress
        self.origin = origin
        self._journal = journal
        self.threads = threads
        pair = origin is None and has_pair_loop(layout, method)
        self.pair = Pair(layout, method, self.first_step) if pair else None
        if self.pair is not None:
            self.compile_seconds = self.pair.compile_seconds
        else:
            self.compile_seconds = compile_loop(layout, method, threads)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle what to lay out and compile again, without `progress` and `journal`."""
        origin = self.origin
        scene, state = (self.layout.scene, None) if origin is None else (origin.given, origin.state)
        return _integrator_from, (scene, self.method.name, state, self.threads)

    @cached_property
    def rounded(self) -> tuple[Layout, Pair | None]:
        """The layout with other roundings of the bobs' places, and a pair's loop for it."""
        layout = self.layout.with_other_rounding()
        return layout, self.pair and self.pair.displaced(layout)

    def batch(self, own_numbers: bool = False, rounded: bool = False) -> Batch:
        """The fastest kind of batch that runs members of the scene: in lanes or not, as a pair.

        A scene that is no pair has `has_batches`, and `fit_lanes` too for numbers of their own.
        """
        layout, pair = self.rounded if rounded else (self.layout, self.pair)
        method = self.method
        first_step = self.first_step
        if pair is not None:
            return Batch(lambda: PairMembers(pair))
        alone = Pool(lambda: GeneralMembers(layout, method, first_step))
        if not fit_lanes(layout, method):
            assert not own_numbers
            return Batch(alone.take)
        kind = SplittingLanes if method.splits else NystromLanes
        return Batch(lambda: kind(layout, method, first_step, own_numbers, alone))

    def loop(self, layout: Layout, setting: Setting, start: np.ndarray) -> GeneralLoop:
        """The general loop before a run from `start`, or from the origin if there is one."""
        first = self.first_step
        if setting.tolerance is not None:
            first = first_step_at(setting.tolerance, first, self.method.order)
        loop = GeneralLoop(layout, self.method, setting, start, first, self.threads)
        if self.origin is not None:
            exactly = np.array_equal(start, self.layout.start)
            self.origin.place(loop, self.method.name, exactly)
        return loop

    def __call__(
        self,
        setting: Setting,
        times: np.ndarray,
        start: np.ndarray | None = None,
        streamed: StreamedLedger | None = None,
        most: float | None = None,
        rounded: bool = False,
        resolved: bool = False,
    ) -> Integration:
        """Integrate through `times` from `start`, y at t = 0; the scene's without it.

        `streamed` takes the samples in, of which only the first and the last two are kept then.
        Adaptive steps may take `most` force evaluations; those of the scene without it.  `rounded`
        gives the bobs' places other roundings, and rough forces other steps.  If equal steps have
        to be `resolved`, the run stops where they are too long for the stiffest motion it meets.
        """
        layout, pair = self.rounded if rounded else (self.layout, self.pair)
        tolerance = setting.tolerance
        if rounded and tolerance is not None and np.isfinite(layout.scene.smoothness):
            setting = Setting(tolerance=stricter(tolerance, OTHER_STEPS))
        start = self.layout.start if start is None else start
        journal = self._journal
        entry = None if journal is None else journal.integration(key_of(setting, times, start))
        if pair is not None and not (pair.zeros.size and pair.lacks(start[None])[0]):
            return pair.integrate(setting, start, times, self._progress, entry, most)
        loop = self.loop(layout, setting, start)
        if self.origin is not None:
            times = times[times >= self.layout.beginning]
        run = integrate(loop, times, self._progress, streamed, entry, most=most, resolved=resolved)
        # A streamed run is guarded while its samples arrive, and adaptive steps keep the energy.
        if streamed is not None or self.method.adaptive:
            return run
        lost = lost_sample(self.layout, run.samples)
        return run if lost is None else run.up_to(lost, Status.ENERGY_RUNAWAY)


def up_to_passing(layout: Layout, run: Integration) -> Integration:
    """The run, or its part up to the first sample at which surfaces have passed."""
    if run.status != Status.COMPLETED or not facing(layout):
        return run
    passed = np.flatnonzero(passed_through(layout, run.samples))
    return run.up_to(int(passed[0]), Status.PASSED_THROUGH) if passed.size else run


def _integrator_from(scene: Scene, method: str, state: State | None, threads: int) -> Integrator:
    layout, origin = (lay_out(scene), None) if state is None else continued(scene, state)
    return Integrator(layout, named(method), origin=origin, threads=threads)
