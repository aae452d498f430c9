"""Runs of one asperite on one by the loop of its own, in threads."""

from __future__ import annotations

import time
from collections.abc import Hashable
from copy import copy
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np
from numba import types

from tribo.compiler.jit import EntryPoint
from tribo.compiler.lanes import LANES, lanes
from tribo.compiler.numbers_in_lanes import numbers_of
from tribo.compiler.units import memory_of
from tribo.integrators.collocation import Collocation
from tribo.integrators.methods import METHODS, Method
from tribo.integrators.step_control import Tolerance
from tribo.kernels.potential_units import clearance_unit, clearances_unit, energy_unit
from tribo.kernels.records import CLOCK
from tribo.kernels.status import COMPLETED, PAUSED, Status
from tribo.layout.layout import Layout
from tribo.layout.scene_records import MemberNumbers
from tribo.ledger.pair_samples import Factors, PairSamples
from tribo.loops.general import numbers_of_clock
from tribo.loops.integrate import (
    Checkpoints,
    Integration,
    Progress,
    first_step_at,
    integrate,
)
from tribo.loops.pair_records import FIRST_ACCOUNT, MembersOfPair, factors_of, record_of_scene
from tribo.loops.setting import Setting
from tribo.loops.time_loop import Columns, Memory, TimeLoop
from tribo.model.identity import plugins_of
from tribo.pair import step_rows
from tribo.pair.loop import COLUMNS, ENERGY, pair_members
from tribo.pair.potential import PotentialUnits, force_unit
from tribo.pair.step import table
from tribo.plugins.compile_errors import compiling_units
from tribo.plugins.sources import is_own
from tribo.threads.model_units import Known
from tribo.threads.writable_memory import shared_loop

# First step in units of the one that is usual: the loop's method is of order 15, and a first step
# that is too long costs one rejection only.
FIRST_STEP_FACTOR = 8.0
# Tolerances with which the memory of loops is kept.
BEGINNINGS_KEPT = 4
# Steps before a run without a progress report can be interrupted: a few milliseconds.
UNINTERRUPTED_STEPS = 2048
# Arguments of the loop that each run makes: its memory and clock, and the record.
MADE = (0, 1, 4)
# Types of two charges of one run.
CHARGES = types.float64, types.float64


# The units of potentials by class, whether members have numbers of their own, and whether in lanes.
_UNITS: dict[Hashable, PotentialUnits] = {}
# The code of loops over pairs, by loop and kind of arguments.
_ENTRIES: dict[Hashable, EntryPoint] = {}


def entry_of(
    loop: Any,
    kind: Hashable,
    fixed: tuple[Any, ...],
    examples: tuple[Any, ...],
    made: tuple[int, ...] = (),
) -> EntryPoint:
    """The code of a loop over pairs, which is the same for all scenes.

    It is looked up once for each `kind` of its arguments, which tells their types.  The caller
    makes those at the places `made`, see :class:`tribo.compiler.jit.EntryPoint`.
    """
    key = loop, kind
    if key not in _ENTRIES:
        _ENTRIES[key] = EntryPoint(shared_loop(loop), fixed, examples, made)
    return _ENTRIES[key].with_fixed(*fixed)


class Beginning(NamedTuple):
    """The memory of a loop before a run with some tolerances."""

    rows: np.ndarray  # (ROWS, 8)
    clock: bytes  # of CLOCK, of which arrays take microseconds to copy


class Pair:
    """A scene with `has_pair_loop`, and its compiled loops, which threads can run at the same time.

    Raises InputError if the potential does not compile.
    """

    def __init__(self, layout: Layout, method: Method, first_step: float) -> None:
        """Fill the rows that no run changes, and compile the loop of single runs."""
        began = time.perf_counter()
        self.layout = layout
        self.record = record_of_scene(layout)
        self.potential = layout.model.contacts[0].potential
        self._potential_memory, self.numbers = memory_of((self.potential,))
        self.units = self._units(own=False, in_lanes=False)
        driven = layout if layout.model.pivots is not None else None
        state, accounts = factors_of(layout, np.asarray(layout.asperites))
        self.factors = Factors(state, accounts, {}, driven)
        # By which tolerances of the layout are those of the loop's rows.
        self._sizes = np.abs(np.concatenate([state, accounts]))[:, :ENERGY]
        self._first_step = FIRST_STEP_FACTOR * first_step
        self._order = method.order
        slots = np.asarray(layout.asperites)["dof_x"].tolist()
        along_x = np.array([slot for slot in slots if slot >= 0], int)
        # Of y: what is zero at the start of every run of the loop.
        self.zeros = np.concatenate([along_x, layout.coordinates + along_x])
        self._rows = np.zeros((step_rows.ROWS, LANES))
        self._rows[: step_rows.LIMITS] = _table_of(method.name)
        own_memory = (self._rows, np.zeros(1, CLOCK))
        examples = (*own_memory, layout.start[None], np.zeros(1), np.empty((2, COLUMNS)), 0)
        fixed = self.units, (self.record, self.numbers)
        self.entry = entry_of(pair_members, "single", fixed, examples, MADE)
        # Those of the last settings: a run with an estimate takes three by two of them.
        self._beginnings: dict[Setting, Beginning] = {}
        self._members: MembersOfPair | None = None
        self.compile_seconds = time.perf_counter() - began

    def displaced(self, layout: Layout) -> Pair:
        """The same loops for a layout in which the places of bobs alone are others."""
        pair = copy(self)
        pair.layout = layout
        pair.record = record_of_scene(layout)
        pair._members = None
        pair.entry = self.entry.with_fixed(self.units, (pair.record, self.numbers))
        return pair

    def units_in_lanes(self, own_numbers: bool) -> PotentialUnits:
        """The units of the potential for members side by side, which may have `own_numbers`."""
        return self._units(own_numbers, in_lanes=True)

    def _units(self, own: bool, in_lanes: bool) -> PotentialUnits:
        """The units of the potential for one run or, in lanes, members with `own` numbers or not.

        They are looked up once for each class of this package whose fields are floats: types of
        plug-ins take longer to find than a short run.
        """
        cls = type(self.potential)
        plain = is_own(cls) and set(map(type, self.potential)) <= {float}
        key = (cls, own, in_lanes) if plain else None
        if key in _UNITS:
            return _UNITS[key]._replace(numbers=self.numbers[0])
        known = Known(self.potential, own and bool(numbers_of(self.potential)))
        charges = (lanes, lanes) if own else CHARGES
        distance = known.kind, types.float64, *CHARGES, types.int64
        of_each = known.kind, lanes, *charges
        if in_lanes:
            clearance = known.job(clearances_unit, of_each, lanes)
        else:
            clearance = known.job(clearance_unit, distance)
        with compiling_units(plugins_of(self.layout.scene)):
            units = PotentialUnits(
                force=known.job(force_unit, of_each, lanes).address(),
                clearance=clearance.address(),
                energy=known.job(energy_unit, distance).address(),
                numbers=self.numbers[0],
            )
        if key is not None:
            _UNITS[key] = units
        return units

    def members(self, numbers: MemberNumbers) -> MembersOfPair:
        """What runs of members with these numbers share; the last ones are kept."""
        known = self._members
        if known is None or known.numbers is not numbers:
            known = MembersOfPair(self.layout, numbers)
            self._members = known
        return known

    def lacks(self, starts: np.ndarray) -> np.ndarray:
        """Whether starts, y (members, 2 coordinates), have centres of mass displaced along x."""
        return np.logical_or.reduce(starts[:, self.zeros], axis=1)

    def integrate(
        self,
        setting: Setting,
        start: np.ndarray,
        times: np.ndarray,
        progress: Progress | None = None,
        checkpoints: Checkpoints | None = None,
        most: float | None = None,
    ) -> Integration:
        """Integrate from `start`, y, with `most` evaluations, or those of the scene without it."""
        if progress is None and checkpoints is None:
            return self._integrate_at_once(setting, start, times, most)
        loop = PairLoop(self, self.beginning(setting), start)
        return integrate(loop, times, progress, None, checkpoints, most=most)

    def _integrate_at_once(
        self, setting: Setting, start: np.ndarray, times: np.ndarray, most: float | None
    ) -> Integration:
        """Integrate through `times` in one call, if it does not take too many steps.

        The driver with its guards would make 100 Python calls more, which take half of the loop's
        time.
        """
        began = time.perf_counter()
        known = self._beginnings
        before = known[setting] if setting in known else self.beginning(setting)
        rows = before.rows.copy()
        clocks = np.frombuffer(bytearray(before.clock), CLOCK)
        record = np.empty((times.size + 1, COLUMNS))
        code = self.entry(rows, clocks, start[None], times, record, UNINTERRUPTED_STEPS)
        if code != COMPLETED:
            loop = PairLoop(self, before, start)
            if code == PAUSED:  # else from the start again, to the same end
                loop.restore(_memory(rows, clocks))
            return integrate(loop, times, columns=(record,), most=most)
        seconds = time.perf_counter() - began
        samples = PairSamples(times, record[:-1], record[:1], self.factors)
        memory = partial(_memory, rows, clocks)
        return Integration(samples, Status.COMPLETED, record[-1], seconds, memory)

    def rows(self) -> np.ndarray:
        """The memory of a loop before its first run, (ROWS, 8)."""
        return self._rows.copy()

    def limits(self, setting: Setting) -> np.ndarray:
        """The loop's own limits (2, 8), with which all of the layout's tolerances are met."""
        return self.beginning(setting).rows[step_rows.LIMITS : step_rows.STATE]

    def beginning(self, setting: Setting) -> Beginning:
        """The memory of a loop before runs with some tolerances."""
        known = self._beginnings
        if setting in known:
            return known[setting]
        tolerance = setting.of_adaptive_steps()
        rows = self.rows()
        rows[step_rows.LIMITS : step_rows.STATE] = self._limits_of(tolerance)
        clocks = np.zeros(1, CLOCK)
        clocks["encounter_fraction"] = tolerance.encounter_fraction
        found = Beginning(rows, clocks.tobytes())
        # Not changed in place, as other threads may read it.
        last = tuple(self._beginnings.items())[1 - BEGINNINGS_KEPT :]
        self._beginnings = dict(last) | {setting: found}
        return found

    def _limits_of(self, tolerance: Tolerance) -> np.ndarray:
        """What the loop takes of tolerances: those of its own rows, and its first step."""
        everything = np.concatenate([tolerance.y, tolerance.s])
        with np.errstate(divide="ignore"):
            own = np.minimum.reduce(everything[:, None] / self._sizes, axis=0)
        both = np.zeros((2, LANES))
        rates = [step_rows.OF_V1, step_rows.OF_V2, step_rows.OF_J]
        both[0, rates] = own[[step_rows.V1, step_rows.V2, step_rows.J]]
        both[0, step_rows.LEVEL] = tolerance.level
        both[0, step_rows.FIRST] = first_step_at(tolerance, self._first_step, self._order)
        both[1] = 1.0 / own[FIRST_ACCOUNT : FIRST_ACCOUNT + LANES]
        return both


@cache
def _table_of(method: str) -> np.ndarray:
    """The coefficients of a method in rows, as the loop reads them."""
    coefficients = METHODS[method].coefficients
    assert isinstance(coefficients, Collocation)
    return table(coefficients)


def _memory(rows: np.ndarray, clocks: np.ndarray) -> Memory:
    """The state in the memory of a loop."""
    state = rows[step_rows.STATE :].copy()
    return {"clock": numbers_of_clock(clocks), "pair": state}


class PairLoop(TimeLoop):
    """The time loop of a pair in one run from `start`, y of the layout, and all that it writes."""

    adaptive = True

    def __init__(self, pair: Pair, before: Beginning, start: np.ndarray) -> None:
        self.layout = pair.layout
        self._pair = pair
        self._rows = before.rows.copy()
        self.clocks = np.frombuffer(bytearray(before.clock), CLOCK)
        self._start = start[None]

    def room(self, samples: int) -> Columns:
        return (np.empty((samples, COLUMNS)),)

    def advance(self, times: np.ndarray, columns: Columns, budget: int) -> int:
        """Take some steps; the loop begins the run where it has made no evaluations."""
        memory = self._rows, self.clocks
        code: int = self._pair.entry(*memory, self._start, times, columns[0], budget)
        return code

    def memory(self) -> Memory:
        return _memory(self._rows, self.clocks)

    def restore(self, memory: Memory) -> None:
        self.clocks[0] = tuple(memory["clock"])
        self._rows[step_rows.STATE :] = memory["pair"]

    def samples(self, times: np.ndarray, columns: Columns) -> PairSamples:
        record = columns[0][: times.size]
        return PairSamples(times, record, record[:1], self._pair.factors)
