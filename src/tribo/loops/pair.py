"""One asperite on one: its scene as its own loop reads it, and runs by that loop, in threads.

The samples of the loop have few columns.  Every coordinate and every account of the layout is a
multiple of one of them; two matrices hold the factors.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Hashable
from copy import copy
from dataclasses import replace
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np
from numba import config, types

from tribo.compiler.jit import EntryPoint
from tribo.compiler.lanes import LANES, lanes
from tribo.compiler.numbers_in_lanes import numbers_of
from tribo.compiler.units import memory_of
from tribo.integrators.collocation import Collocation
from tribo.integrators.methods import METHODS, Method
from tribo.integrators.step_control import Tolerance
from tribo.kernels.potential_units import clearance_unit, clearances_unit, energy_unit
from tribo.kernels.records import ASPERITE, BARS, CHARGE, CLOCK, FORCED, FREE
from tribo.kernels.status import COMPLETED, PAUSED, Status
from tribo.layout.layout import Layout, once_per_layout
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
from tribo.loops.setting import Setting
from tribo.loops.time_loop import Columns, Memory, TimeLoop
from tribo.model.effects import Effect
from tribo.model.identity import plugins_of
from tribo.pair import step_rows
from tribo.pair.bodies import Body, pair_of
from tribo.pair.forces import PAIR
from tribo.pair.loop import COLUMNS, ENERGY, pair_members
from tribo.pair.potential import PotentialUnits, force_unit
from tribo.pair.step import table
from tribo.plugins.compile_errors import compiling_units
from tribo.plugins.sources import is_own
from tribo.threads.model_units import Known
from tribo.threads.writable_memory import shared_loop

# Columns behind the record's accounts, in place of the contact energy: see `_arcs`.
ARC1 = ENERGY
ARC2 = ENERGY + 1

FIRST_ACCOUNT = step_rows.J + 1
# Names of what records of asperites contain.
OF_ASPERITE = frozenset(ASPERITE.names or ())
# Effects of scenes that the loop of a pair knows.
KNOWN = {
    *(Effect.CONTACT, Effect.SWING, Effect.SLIDING),
    *(Effect.CLAMPED_ENDS, Effect.CUTOFF, Effect.DRIVEN_BARS),
}
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


class Slots(NamedTuple):
    """The slots of one asperite of a pair: its coordinate along x, and its accounts."""

    dof_x: int
    acc_contact: int
    acc_ends: int
    acc_slide: int
    acc_block: int  # of its surface


@once_per_layout
def _slots_of(layout: Layout) -> tuple[Slots, ...]:
    asperites = np.asarray(layout.asperites)
    surfaces = np.asarray(layout.surfaces)
    names = Slots._fields[:-1]
    blocks = surfaces["acc_block"].tolist()
    each = zip(*(asperites[name].tolist() for name in names), blocks, strict=True)
    return tuple(itertools.starmap(Slots, each))


def factors_of(layout: Layout, asperites: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The factors of coordinates and of accounts, (..., 2 coordinates or accounts, columns).

    Asperites (..., 2) have the slots of the layout.  Accounts: see :mod:`tribo.kernels.powers`.
    """
    n = layout.coordinates
    shape = asperites.shape[:-1]
    mobility = _mobility_of(layout, asperites)
    to_state = np.zeros((*shape, 2 * n, ENERGY + 2))
    to_accounts = np.zeros((*shape, layout.accounts, ENERGY + 2))
    columns = (
        (step_rows.Q1, step_rows.V1, step_rows.X1, step_rows.Y1, step_rows.T1, ARC1),
        (step_rows.Q2, step_rows.V2, step_rows.X2, step_rows.Y2, step_rows.T2, ARC2),
    )
    for i, (slots, sign) in enumerate(zip(_slots_of(layout), (1.0, -1.0), strict=True)):
        q, v, about_x, about_y, twist, arc = columns[i]
        a = asperites[..., i]
        slide = mobility[..., i]
        to_state[..., i, q] = 1.0
        to_state[..., n + i, v] = 1.0
        first = FIRST_ACCOUNT
        contact = slots.acc_contact
        to_accounts[..., contact, step_rows.J] = sign
        to_accounts[..., contact + 1, first + step_rows.J_Y] = sign
        to_accounts[..., contact + 2, first + about_x] = sign * a["facing"]
        to_accounts[..., contact + 3, first + about_y] = sign * a["facing"]
        if slots.dof_x >= 0:
            to_state[..., slots.dof_x, step_rows.K] = slide
            to_state[..., n + slots.dof_x, step_rows.J] = slide
            for slot in (slots.acc_slide, slots.acc_block):
                to_accounts[..., slot, first + step_rows.S] = sign * slide
        if slots.acc_ends >= 0:
            end = a["kappa"] / a["bar_length"]
            to_accounts[..., slots.acc_ends, arc] = -a["l2"] * a["facing"] * end
            to_accounts[..., slots.acc_ends + 1, arc] = a["l2"] * a["facing"] * end
            to_accounts[..., slots.acc_ends + 3, first + twist] = end
            to_accounts[..., slots.acc_ends + 4, arc] = a["pivot"] * a["facing"] * end
    return to_state, to_accounts


def _mobility_of(layout: Layout, asperites: np.ndarray) -> np.ndarray:
    """(..., 2) displacement of each centre of mass for k = 1."""
    free = np.asarray(layout.surfaces)["drive"] == FREE
    return np.asarray(np.array([1.0, -1.0]) * free / asperites["mass"])


def record_of(layout: Layout, asperites: np.ndarray, charges: np.ndarray) -> np.ndarray:
    """Scenes as the loop reads them, (...) of PAIR; driven bars take the place of centres of mass.

    Asperites and charges are (..., 2).
    """
    free = layout.surfaces.drive == FREE
    bodies = []
    for i in range(2):
        own = {name: asperites[name][..., i] for name in Body._fields if name in OF_ASPERITE}
        bodies.append(
            Body(**own, depth=layout.depths[i], charge=charges[..., i], free=float(free[i]))
        )
    record = np.zeros(asperites.shape[:-1], PAIR)
    for name, values in pair_of(*bodies)._asdict().items():
        record[name] = values
    return record


def has_pair_loop(layout: Layout, method: Method) -> bool:
    """Whether the pair's loop serves a scene and a method; it exists in compiled form only."""
    compiled = not config.DISABLE_JIT  # type: ignore[attr-defined]
    adaptive = method.adaptive and isinstance(method.coefficients, Collocation)
    return compiled and adaptive and is_pair(layout)


@once_per_layout
def is_pair(layout: Layout) -> bool:
    """Whether a scene is one asperite on one, with bars clamped at rest, forced, free or driven.

    Centres of mass start where they rest, with their surface's velocity: the loop has one number
    for the impulse of the contact and for their rates.
    """
    model = layout.model
    a = layout.together.asperites
    surfaces = np.asarray(layout.surfaces)
    along_x = a.dof_x[a.dof_x >= 0]
    return (
        layout.scene.count == surfaces.size == 2
        and not np.any(layout.start.reshape(2, -1)[:, along_x])
        and layout.scene.output.ledger == "asperites"
        and layout.scene.effects <= KNOWN
        and model.species is None
        and layout.rows == 0
        and len(model.contacts[0].pairs) == 1
        and set(surfaces["drive"].tolist()) <= {FORCED, FREE, BARS}
        and not surfaces["loaded"].any()
        and bool(np.all((a.dof_phi < 0) & (a.phi == 0.0) & (a.nu == 0.0) & (a.dof_y < 0)))
    )


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


class MembersOfPair:
    """What all runs of some members share that have numbers of their own."""

    def __init__(self, layout: Layout, numbers: MemberNumbers) -> None:
        self.numbers = numbers
        self.record = record_of(layout, numbers.asperites, numbers.charges)
        self.factors = factors_of(layout, numbers.asperites)
        self._layout = layout
        self._layouts: dict[int, Layout] = {}

    def layout(self, times: int) -> Layout:
        """The layout of samples at so many times."""
        if times not in self._layouts:
            own = replace(self._layout, numbers=self.numbers, member_times=times)
            self._layouts[times] = own
        return self._layouts[times]


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
        self.record = _record_of(layout)
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
        pair.record = _record_of(layout)
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


def _record_of(layout: Layout) -> np.ndarray:
    """The scene as the loop reads it, (1,) of PAIR."""
    charges = layout.model.each[CHARGE, layout.places.columns]
    return record_of(layout, np.asarray(layout.asperites)[None], charges)


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
