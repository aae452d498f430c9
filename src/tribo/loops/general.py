"""The time loops of any scene, with the state of their run."""

import json
import time
from collections.abc import Hashable
from functools import cache
from typing import Any

import numpy as np

from tribo.compiler.generators import NO_NOISE, as_argument
from tribo.compiler.jit import EntryPoint, LoopJob, kind_of, undisturbed
from tribo.compiler.kept import Kept, keep, keep_like
from tribo.compiler.lanes import LANES
from tribo.compiler.lanes_memory import room, with_spare_lanes
from tribo.compiler.team import CLOSED
from tribo.compiler.unit_errors import keeping, raise_first
from tribo.integrators.methods import Method
from tribo.integrators.splitting import assist
from tribo.integrators.step_control import Tolerance
from tribo.integrators.stiffness import MOVED, WATCH_ROWS
from tribo.kernels.model import Neighbours
from tribo.kernels.records import CLOCK
from tribo.kernels.samples import Record, State, empty_state, initial_state
from tribo.layout.contacts import NO_NEIGHBOURS, with_room
from tribo.layout.layout import Layout
from tribo.ledger.samples import Samples, sample_columns
from tribo.loops.legs import LegsOfLoop
from tribo.loops.setting import Setting
from tribo.loops.stiffness import Stiffness, stiffness_of
from tribo.loops.time_loop import Columns, Memory, TimeLoop
from tribo.model.identity import plugins_of
from tribo.plugins.compile_errors import compiling
from tribo.threads.model_units import Wanted, loop_units, rate_units, step_units
from tribo.threads.shared_run import assisted
from tribo.threads.writable_memory import arrays_in, common_of, shared_loop, with_memory

# The lists of neighbours, and when they were made.
LISTS = ("start", "index", "place", "made", "listed")
# Which packs are active, and how long the others have not been advanced: names in saved states.
SELECTION = {
    "active_blocks": "packs",
    **{f"active_{name}": name for name in ("first", "since", "place", "selected")},
}


# The code of loops, by loop and what tells the types of their arguments: scenes share it.
_ENTRIES: dict[Hashable, EntryPoint] = {}

_no_lists = cache(lambda: keep(NO_NEIGHBOURS))


def kept_lists(neighbours: Neighbours) -> Any:
    """Lists of neighbours as loops are given them; scenes without lists share theirs."""
    return _no_lists() if neighbours is NO_NEIGHBOURS else keep(neighbours)


class GeneralLoop(TimeLoop):
    """The time loop of a method for one scene, and the state of its run.

    It begins from `start`, y at t = 0, with the step, or the tolerances and the first step [time],
    of its method.  Results do not depend on the number of threads that share each step.  `model`
    has arrays that no other loop writes; `compiled` is compiled at its first call.
    """

    def __init__(
        self,
        layout: Layout,
        method: Method,
        setting: Setting,
        start: np.ndarray,
        first_step: float,
        threads: int = 1,
    ) -> None:
        """Prepare the state, the memory of the method, and what is compiled."""
        self.layout = layout
        self._neighbours = layout.neighbours(method.splits)
        self.model, self.calls = with_memory(layout)
        self._legs = LegsOfLoop(layout, self.model)
        self._keeps_rates = not method.splits
        common = common_of(layout)
        self._kept = keep_like(common.kept, self.model)
        self._lists = kept_lists(self._neighbours)
        self._assistants = threads - 1
        self._method = method
        self.adaptive = method.adaptive
        self.step = setting.step
        self.clocks = np.zeros(1, CLOCK).view(np.recarray)
        self.clocks.h = first_step if method.adaptive else 0.0
        if setting.tolerance is not None:
            self.clocks.encounter_fraction = setting.tolerance.encounter_fraction
        coordinates, accounts = layout.room
        places = layout.places
        n = layout.coordinates
        y = np.zeros(2 * coordinates)
        y[places.q] = start[:n]
        y[coordinates + places.q] = start[n:]
        self.state = initial_state(y, accounts, remembered(layout, method), method.splits)
        core = places.q[: layout.core]
        # Where the coordinates and accounts of samples stand in the state.
        self.recorded = np.concatenate([core, coordinates + core]), places.s
        self._noise: np.random.Generator | None = None
        work = method.coefficients.workspace(self.model, self.state)
        if method.splits:
            self._noise = np.random.default_rng([layout.scene.seed, 2])
        speeds = room((3, self.model.each.shape[1]))
        self._scratch: tuple[tuple[Any, ...] | np.ndarray, ...] = (work, speeds)
        if method.adaptive:
            self._scratch += (empty_state(self.state),)
        self._constants = method.coefficients, keep(in_packs(setting, layout))
        self._hold()
        self.compiled = shared_loop(method.loop)
        self._entry: EntryPoint | None = None
        self._assist: Any = shared_loop(assist) if self._assistants else None
        self._errors: list[Exception] = []  # of units, in the present call
        self._columns: Columns = ()  # that it has filled last, and the record of them
        self._record: Any = None
        if method.name not in common.units:
            common.fulfil(self._wanted(work), lambda: LoopJob(method.loop, self._kinds()))
            lacking = self.model.units == 0
            common.units[method.name] = np.where(lacking, common.model.units, self.model.units)
        self.model.units[:] = common.units[method.name]

    def _wanted(self, work: Any) -> list[Wanted]:
        """The units of this package that its method needs."""
        if self._keeps_rates:
            return loop_units(self.model) + rate_units(self.model)
        listed = self.layout.rows > 0
        return loop_units(self.model) + step_units(self.model, self.state, work, 0, listed)

    def _kinds(self) -> tuple[Any, ...]:
        """numba's types of the arguments of the loop."""
        return tuple(map(kind_of, (self._kept, *self._arguments(np.ones(1), self.room(1), 0))))

    def _hold(self) -> None:
        """Let the loop use the state and the scratch that are there now."""
        self._held = keep(self.state), *map(keep, self._scratch)

    def room(self, samples: int) -> Columns:
        return sample_columns(self.layout, samples)

    def advance(self, times: np.ndarray, columns: Columns, budget: int) -> int:
        if self._legs.is_one:
            return self._call(self._arguments(times, columns, budget))

        def call(times: np.ndarray, budget: int) -> int:
            return self._call(self._arguments(times, columns, budget))

        return self._legs.advance(self.clocks[0], times, budget, call, self._keeps_rates)

    def _call(self, arguments: tuple[Any, ...]) -> int:
        errors = self._errors = []
        with assisted(self.model.team, self._assistants, self.assist), keeping(errors):
            code: int = self._entry_for(arguments)(*arguments)
        raise_first(errors)
        return code

    def _entry_for(self, arguments: tuple[Any, ...]) -> EntryPoint:
        """The code of the loop, for arguments of the types that all calls have."""
        if self._entry is None:
            kept = (self._kept, *arguments)
            key = (
                self.compiled,
                type(self._method.coefficients),
                *(each.kind for each in kept if isinstance(each, Kept)),
            )
            if key not in _ENTRIES:
                _ENTRIES[key] = EntryPoint(self.compiled, (self._kept,), arguments)
            self._entry = _ENTRIES[key].with_fixed(self._kept)
        return self._entry

    def assist(self) -> None:
        """Share the steps that another thread takes, until it has no more."""
        with keeping(self._errors):
            self._assist(self._kept, self._lists, *self._held[:2])

    def arguments(self, times: np.ndarray, columns: Columns, budget: int) -> tuple[Any, ...]:
        """All arguments of the compiled loop in another memory, where nothing draws noise.

        Steps about reservoirs and baths read the generator all the same, there at address 0.
        """
        return self._kept, *self._arguments(times, columns, budget, NO_NOISE)

    @property
    def neighbours(self) -> Neighbours:
        """The present lists of neighbours."""
        return self._neighbours

    def make_all_room(self) -> None:
        """Give the list of neighbours room for all packs in every row."""
        packs = self.model.each.shape[1] // LANES
        size = (self._neighbours.start.size - 1) * packs
        if size > self._neighbours.index.size:
            self._set_neighbours(self._neighbours._replace(index=np.zeros(size, np.int32)))

    def _arguments(
        self, times: np.ndarray, columns: Columns, budget: int, noise: Any = None
    ) -> tuple[Any, ...]:
        """The arguments of the loop, behind the model; `noise` in place of its own generator."""
        self._make_room()
        if self._columns is not columns:
            self._columns = columns
            self._record = keep(Record(*columns, *self.recorded))  # type: ignore[call-arg]
        state, *scratch = self._held
        run = self.clocks, state, times, self._record, budget
        if self.adaptive:
            return self._lists, *self._constants, *run, *scratch
        if noise is None:
            noise = NO_NOISE if self._noise is None else as_argument(self._noise)
        return self._lists, *self._constants, *run, noise, *scratch

    def _make_room(self) -> None:
        """Give the list of neighbours more room if it has too little."""
        neighbours = with_room(self._neighbours)
        if neighbours is not self._neighbours:
            self._set_neighbours(neighbours)

    def _set_neighbours(self, neighbours: Neighbours) -> None:
        self._neighbours = neighbours
        self._lists = kept_lists(neighbours)

    def forget_neighbours(self) -> None:
        if self.layout.rows > 0:
            self._neighbours.place[:] = np.nan

    @property
    def inactive(self) -> int:
        """Number of asperites that are not stepped, until packs are selected again."""
        if self._neighbours.active.packs.size == 0:
            return 0
        own = self._neighbours.active.since[self.layout.places.columns // LANES]
        return int(np.count_nonzero(np.isfinite(own)))

    @property
    def bytes(self) -> int:
        """Bytes of all arrays of the loop and of its layout."""
        own = tuple(vars(self).values()), self.layout.asperites, self.layout.surfaces
        return sum({id(array): array.nbytes for array in arrays_in(own)}.values())

    def stiffness(self) -> Stiffness | None:
        if self.step is None or self._noise is None or not self.layout.scene.is_noisy:
            return None
        steps = int(self.clocks["steps"][0])
        return stiffness_of(self.layout, self.stiffness_sums, steps, self.step)

    @property
    def stiffness_sums(self) -> np.ndarray:
        """Sums over watched kicks, (3, core), see `tribo.integrators.stiffness`."""
        rows = self.state.memory[MOVED - WATCH_ROWS :]
        return np.asarray(rows[:, self.layout.places.q[: self.layout.core]])

    def memory(self) -> Memory:
        """All that a run continues from: clock, state, lists of neighbours, and noise."""
        memory = {"clock": numbers_of_clock(self.clocks)}
        memory |= self.state._asdict()
        if self.layout.rows > 0:
            for name in LISTS:
                memory[f"neighbours_{name}"] = getattr(self._neighbours, name)
            if self._neighbours.active.packs.size > 0:
                for key, name in SELECTION.items():
                    memory[key] = getattr(self._neighbours.active, name)
        if self._noise is not None:
            text = json.dumps(self._noise.bit_generator.state)
            memory["noise"] = np.frombuffer(text.encode(), np.uint8)
        return memory

    def restore(self, memory: Memory) -> None:
        """Continue where another loop had this `memory`."""
        self.clocks[0] = tuple(memory["clock"])
        self.state = State(**{name: with_spare_lanes(memory[name]) for name in State._fields})
        self._hold()
        if self.layout.rows > 0:
            lists: dict[str, Any] = {name: memory[f"neighbours_{name}"].copy() for name in LISTS}
            lists["place"] = with_spare_lanes(lists["place"])
            self._set_neighbours(self._neighbours._replace(**lists))
            if self._neighbours.active.packs.size > 0:
                for key, name in SELECTION.items():
                    getattr(self._neighbours.active, name)[...] = memory[key]
        self.restore_noise(memory)

    def restore_noise(self, memory: Memory) -> None:
        """Draw the random numbers that follow those drawn before, if any were and are drawn."""
        if self._noise is not None and "noise" in memory:
            self._noise.bit_generator.state = json.loads(memory["noise"].tobytes())

    def samples(self, times: np.ndarray, columns: Columns) -> Samples:
        return Samples(times, *(column[: times.size] for column in columns))


def compile_loop(layout: Layout, method: Method, threads: int = 1) -> float:
    """Compile a loop for a scene, or load it from the disk cache; returns the seconds."""
    began = time.perf_counter()
    loop = GeneralLoop(layout, method, unit_setting(layout, method), layout.start, 0.0, threads)
    with undisturbed(), compiling(loop.compiled, plugins_of(layout.scene)):
        if threads > 1:
            loop.model.team.counters[CLOSED] = 1
            loop.assist()
        loop.advance(np.ones(1), loop.room(1), 0)
    return time.perf_counter() - began


def remembered(layout: Layout, method: Method) -> int:
    """Rows that a loop keeps from step to step, one number for each coordinate."""
    return method.remembers + (WATCH_ROWS if method.splits and is_damped(layout) else 0)


def is_damped(layout: Layout) -> bool:
    """Whether reservoirs act, so that a splitting method watches the stiffness of forces."""
    return layout.model.friction is not None or layout.model.swing_friction is not None


def unit_setting(layout: Layout, method: Method) -> Setting:
    """A step of 1, or tolerances of 1, of the type that a method takes."""
    if not method.adaptive:
        return Setting(step=1.0)
    ones = np.ones(2 * layout.coordinates), np.ones(layout.accounts)
    return Setting(tolerance=Tolerance(*ones, 1.0, 1.0))


def in_packs(setting: Setting, layout: Layout) -> float | Tolerance:
    """A setting as the kernels read it; a tolerance is 1 for what fills their packs."""
    tolerance = setting.tolerance
    if tolerance is None:
        return setting.of_equal_steps()
    coordinates, accounts = layout.room
    y = room((2 * coordinates,))
    s = room((accounts,))
    n = layout.coordinates
    y[:] = 1.0
    s[:] = 1.0
    y[layout.places.q] = tolerance.y[:n]
    y[coordinates + layout.places.q] = tolerance.y[n:]
    s[layout.places.s] = tolerance.s
    return tolerance._replace(y=y, s=s)


def numbers_of_clock(clocks: np.ndarray) -> np.ndarray:
    """The fields of a clock as numbers; counts below 2^53 are exact."""
    return np.array(clocks[0].tolist(), float)
