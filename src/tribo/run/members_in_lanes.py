"""Many runs of one scene by a splitting method, eight side by side in the lanes of registers."""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from tribo.integrators.methods import Method
from tribo.integrators.splitting import Splitting
from tribo.integrators.splitting_members import LOST, WATCHED, splitting_members
from tribo.integrators.step_control import LARGEST
from tribo.kernels.compiled import EntryPoint, time_loop
from tribo.kernels.langevin import Deviates
from tribo.kernels.records import CLOCK
from tribo.kernels.samples import STORED, Record, initial_state
from tribo.kernels.simd import LANES
from tribo.kernels.simd_arrays import room
from tribo.kernels.status import COMPLETED, PAUSED
from tribo.model.scene import Scene
from tribo.pair.members import EVALUATIONS, STEPS
from tribo.plugins.compile_errors import compiling
from tribo.plugins.sources import source_stamp
from tribo.run.general_members import GeneralMembers
from tribo.run.integrate import Setting
from tribo.run.interleaved import interleaved
from tribo.run.layout import Layout, lay_out
from tribo.run.loop_memory import together
from tribo.run.member_samples import MemberRuns, MemberSamples
from tribo.run.samples import Samples

# Steps of a call of the loop, at most, since an interrupt waits for its end.
MOST_STEPS = 4096
# Normal deviates that are drawn at once for a member, at most: 256 kB for eight.
MOST_DEVIATES = 4096
# Asperites of a scene whose members are run side by side, at most: eight asperites of one run fill
# registers as well.
MOST_ASPERITES = 64


def fit_lanes(layout: Layout, method: Method) -> bool:
    """Whether members of a scene, which can be run in batches, are run in lanes."""
    small = layout.asperites.size <= MOST_ASPERITES
    return method.splits and small and layout.model.sums is None and not layout.calculator_calls


class LaneLoop:
    """A time loop that runs eight members at once, with arrays of its own.

    Parameters
    ----------
    scene : Scene
        That of all members, but for their starts and seeds.
    splitting : Splitting
        The method.

    Raises
    ------
    InputError
        If a plug-in does not compile.
    """

    def __init__(self, scene: Scene, splitting: Splitting) -> None:
        self._layout = layout = lay_out(scene)
        self._eight = eight = interleaved(layout)
        coordinates, accounts = eight.room
        state = initial_state(np.zeros(2 * coordinates), accounts, 1, splits=True)
        work = splitting.workspace(eight.model, state)
        self._watch = room((WATCHED, LANES))
        moved, numbers = together((state, work, self._watch))
        self._state, self._work, self._watch = moved
        self._clocks = np.zeros(1, CLOCK).view(np.recarray)
        self._own = [numbers, self._clocks]
        self._fresh = [array.copy() for array in self._own]
        core = eight.q[0, : layout.core]
        self._recorded = np.concatenate([core, coordinates + core]), eight.s
        self._places = np.concatenate([eight.q, coordinates + eight.q], axis=1)
        self._draws = splitting.kicks.size * deviates_of_substep(layout)
        self._splitting = splitting
        self._none = np.empty((0, LANES))
        loop = time_loop(splitting_members, source_stamp(layout.plugins))
        examples = self._arguments(1.0, self.room(LANES), 0, self._none)
        with compiling(loop, layout.named_plugins):
            self._entry = EntryPoint(loop, (eight.model,), examples)

    def room(self, members: int) -> tuple[np.ndarray, ...]:
        """Arrays for the samples of so many members, one after another."""
        layout, rows = self._layout, members * self._layout.times.size
        surfaces = len(layout.scene.surfaces)
        return (
            np.empty((rows, 2 * layout.core)),
            np.empty((rows, layout.accounts)),
            np.empty(rows),
            np.empty(rows),
            np.zeros((rows, surfaces, STORED)),
            np.empty((rows, *layout.sampled_baths)),
        )

    def run(
        self, step: float, starts: np.ndarray, seeds: list[int], columns: tuple[np.ndarray, ...]
    ) -> tuple[int, int, np.ndarray]:
        """Run eight members from `starts` (8, 2 coordinates), and record their samples.

        Returns
        -------
        steps, evaluations : int
            Of each.
        lost : ndarray, (8,)
            Which of them need a loop of their own.
        """
        for array, fresh in zip(self._own, self._fresh, strict=True):
            array[...] = fresh
        self._state.y[self._places] = starts
        generators = [np.random.default_rng([seed, 2]) for seed in seeds] if self._draws else []
        left = steps_in_all(self._layout.times, step)
        code = PAUSED
        while code == PAUSED:
            budget = max(1, min(left, MOST_STEPS, MOST_DEVIATES // max(1, self._draws)))
            deviates = np.empty((budget * self._draws, LANES))
            for lane, generator in enumerate(generators):
                deviates[:, lane] = generator.standard_normal(len(deviates))
            code = self._entry(*self._arguments(step, columns, budget, deviates))
            left -= budget
        lost = self._watch[LOST] > 0.0
        if code != COMPLETED:
            lost[:] = True
        clock = self._clocks[0]
        return int(clock.steps), int(clock.evaluations), lost

    def _arguments(
        self, step: float, columns: tuple[np.ndarray, ...], budget: int, deviates: np.ndarray
    ) -> tuple[object, ...]:
        """The arguments of the loop, behind the model."""
        return (
            self._splitting,
            step,
            self._clocks,
            self._state,
            self._layout.times,
            Record(*columns, *self._recorded),  # type: ignore[call-arg]
            budget,
            self._watch,
            Deviates(deviates, np.zeros(1, np.int64)),
            self._work,
        )


class MembersInLanes:
    """Runs members of a scene, eight at once, in threads.

    What a member gives depends on that member alone.  One that meets an encounter which a step
    would jump, or whose numbers are not finite, is run alone.

    Parameters
    ----------
    layout : Layout
        The scene, for which `fit_lanes` is true.
    method : Method
        How time advances.
    """

    def __init__(self, layout: Layout, method: Method) -> None:
        assert isinstance(method.coefficients, Splitting)
        self._layout = layout
        self._splitting = method.coefficients
        self._alone = GeneralMembers(layout, method, 0.0)
        self._idle: list[LaneLoop] = []

    def run(
        self, setting: Setting, starts: np.ndarray, seeds: np.ndarray | None = None
    ) -> MemberRuns:
        """Run members with `starts` (members, 2 coordinates) and `seeds`, in this thread.

        Seeds matter where there is noise.  The samples of members that did not complete are zeros.
        """
        assert isinstance(setting, float)
        loop = self._free_loop()
        members, times = len(starts), self._layout.times
        chosen = np.arange(-(-members // LANES) * LANES).clip(max=members - 1)
        seeds = np.zeros(members, np.int64) if seeds is None else seeds
        columns = loop.room(chosen.size)
        counts = np.full((members, 3), COMPLETED, np.int64)
        lost = np.zeros(chosen.size, bool)
        for first in range(0, chosen.size, LANES):
            own = chosen[first : first + LANES]
            rows = slice(first * times.size, (first + LANES) * times.size)
            steps, evaluations, lost[first : first + LANES] = loop.run(
                setting, starts[own], seeds[own].tolist(), tuple(each[rows] for each in columns)
            )
            counts[own, STEPS], counts[own, EVALUATIONS] = steps, evaluations
        self._idle.append(loop)
        each_time = [
            np.swapaxes(each.reshape(chosen.size, times.size, *each.shape[1:])[:members], 0, 1)
            for each in columns
        ]
        whole = np.ones(members, bool)
        for each in each_time:
            others = tuple(axis for axis in range(each.ndim) if axis != 1)
            whole &= np.all(np.abs(each) <= LARGEST, axis=others)
        alone = np.flatnonzero(lost[:members] | ~whole)
        if alone.size:
            runs = self._alone.run(setting, starts[alone], seeds[alone])
            counts[alone] = runs.counts
            for each, field in zip(each_time, fields(Samples)[1:], strict=True):
                own = getattr(runs.samples, field.name)
                each[:, alone] = own.reshape(times.size, alone.size, *own.shape[1:])
        samples = (each.reshape(times.size * members, *each.shape[2:]) for each in each_time)
        repeated = np.repeat(times, members)
        return MemberRuns(self._layout, MemberSamples(members, repeated, *samples), counts)

    def _free_loop(self) -> LaneLoop:
        """A loop that no thread uses."""
        try:
            return self._idle.pop()
        except IndexError:
            return LaneLoop(self._layout.scene, self._splitting)


def steps_in_all(times: np.ndarray, step: float) -> int:
    """Steps of a run in equal steps of at most `step` between samples."""
    return int(np.sum(np.maximum(1.0, np.ceil(np.diff(times) / step - 1e-9))))


def deviates_of_substep(layout: Layout) -> int:
    """Normal deviates that a member takes for a substep of its reservoirs."""
    noisy = [s for s in layout.surfaces if s["temperature"] > 0.0]
    return sum(
        int(s["end"] - s["start"]) * (2 * (s["gamma"] > 0.0) + (s["swing_gamma"] > 0.0))
        for s in noisy
    )
