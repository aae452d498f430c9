"""Two asperites and nothing else: their own layout, for the loop that takes them in registers.

The loop's record has few columns; every coordinate and every account of the scene's own layout
is a multiple of one of them, which one matrix says.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from numba import config

from tribo.integrators.collocation import chosen_collocation
from tribo.integrators.methods import Method
from tribo.integrators.step_control import Tolerance
from tribo.kernels.compiled import entry, time_loop
from tribo.kernels.records import CLOCK, FORCED, FREE
from tribo.kernels.samples import STORED
from tribo.kernels.simd import LANES
from tribo.kernels.status import COMPLETED, PAUSED, STATUS_OF_CODE, Status
from tribo.pair.forces import PAIR
from tribo.pair.loop import COLUMNS, ENERGY, REACHED, SAMPLES, pair_collocation
from tribo.pair.step import (
    FIRST,
    J_Y,
    LEVEL,
    LIMITS,
    OF_J,
    OF_V1,
    OF_V2,
    Q1,
    Q2,
    ROWS,
    STATE,
    T1,
    T2,
    V1,
    V2,
    X1,
    X2,
    Y1,
    Y2,
    J,
    K,
    S,
    table,
)
from tribo.plugins.compile_errors import Refusals, compile_error
from tribo.plugins.sources import stamp
from tribo.run.integrate import Integration, Progress, run_in_chunks
from tribo.run.layout import Layout
from tribo.run.samples import Samples

ARC1, ARC2 = ENERGY, ENERGY + 1  # in place of the energy: see `_arcs`
FIRST_ACCOUNT = J + 1
LONGER = 8.0  # times the usual first length: a method of this order can begin with longer ones
FEW = 2048  # steps, before the keyboard is looked at for the first time
INTERRUPTED = "Interrupted"


def has_loop(layout: Layout, method: Method) -> bool:
    """Whether there is a loop of its own for the scene by this method; it needs a compiler."""
    compiled = not config.DISABLE_JIT  # type: ignore[attr-defined]
    return compiled and method.loop is chosen_collocation and is_pair(layout)


def is_pair(layout: Layout) -> bool:
    """Whether a scene is one asperite on one, forced or free, with bars clamped at rest."""
    model = layout.model
    extra = (*model[model._fields.index("box") :], model.within, model.calculators, model.species)
    a, surfaces = model.asperites, model.surfaces
    return (
        a.size == surfaces.size == 2
        and all(item is None for item in extra)
        and layout.rows == 0
        and len(model.contacts[0].pairs) == 1
        and bool(np.all(np.isin(surfaces.drive, (FORCED, FREE)) & (surfaces.loaded == 0)))
        and bool(np.all((a.dof_phi < 0) & (a.phi == 0.0) & (a.nu == 0.0) & (a.dof_y < 0)))
    )


class Pair:
    """A scene of two asperites and its compiled loop; `has_loop` says for which there is one.

    `places` (2 coordinates, columns) and `books` (accounts, columns) make y and s of the scene's
    layout from a row of the loop's record and its arcs.
    """

    def __init__(self, layout: Layout, method: Method, first_step: float) -> None:
        """Have the loop compiled, or loaded from disk.  Raises InputError."""
        began = time.perf_counter()
        self.layout = layout
        ease = _ease(layout)
        self.places, self.books = _matrices(layout, ease)
        potential = layout.model.contacts[0].potential
        self._first_step = LONGER * first_step
        self._clocks, self._rows = np.zeros(1, CLOCK), np.zeros((ROWS, LANES))
        self._rows[:LIMITS] = table(method.coefficients)
        self._given = (_record(layout, ease), potential, self._rows)
        self._unbegun = self._clocks["evaluations"]  # 0 makes a run begin
        self._wanted: Tolerance | None = None  # that the rows' limits are made of
        loop = time_loop(pair_collocation, stamp(layout.plugins))
        moving = (self._clocks, np.zeros(1), np.empty((2, COLUMNS)), 0)
        try:
            self._loop = entry(loop, *self._given, layout.start, *moving)
        except Refusals as error:
            raise compile_error(layout.named_plugins, error) from None
        self.compile_seconds = time.perf_counter() - began

    def integrate(
        self,
        wanted: Tolerance,
        start: np.ndarray,
        times: np.ndarray,
        progress: Progress | None = None,
    ) -> Integration:
        """As :func:`tribo.run.integrate.integrate`, from `start`, y of the scene's layout."""
        began = time.perf_counter()
        if self._wanted is not wanted:
            self._wanted = wanted
            self._rows[LIMITS:STATE] = self.limits(wanted)
            self._clocks["near"] = wanted.near
        self._unbegun[0] = 0
        record = np.empty((times.size + 1, COLUMNS))
        code = PAUSED
        if progress is None:  # nobody to be told
            code = self._loop(*self._given, start, self._clocks, times, record, FEW)
        status = (
            STATUS_OF_CODE[code] if code != PAUSED else self._on(start, times, record, progress)
        )

        def recorded() -> Samples:
            reached = times
            if status != STATUS_OF_CODE[COMPLETED]:
                reached = times[: int(record[-1, SAMPLES])]
                if reached.size < times.size:  # the place reached is one more
                    reached = np.append(reached, record[-1, REACHED])
            return self.samples(reached, record)

        return Integration(recorded, status, record[-1], time.perf_counter() - began)

    def _on(
        self, start: np.ndarray, times: np.ndarray, record: np.ndarray, progress: Progress | None
    ) -> Status:
        """Go on with a run that takes long, to where it ends."""

        def call(clocks: Any, _: Any, times: np.ndarray, record: Any, budget: int) -> int:
            code: int = self._loop(*self._given, start, clocks, times, record, budget)
            return code

        clocks = self._clocks
        status = run_in_chunks(call, (), clocks, self._rows, times, record, progress)
        done = int(clocks["sample"][0])
        if status == INTERRUPTED and done < times.size:  # the place reached is one more sample
            clocks["sample"], clocks["t_low"] = 0, 0.0
            call(clocks, self._rows, clocks["t"].copy(), record[done:], 1)
            taken = (clocks[name][0] for name in ("steps", "evaluations"))
            record[-1, : REACHED + 1] = *taken, done, clocks["t"][0]
        return status

    def limits(self, wanted: Tolerance) -> np.ndarray:
        """The loop's own limits (2, 8), with which all of the layout's tolerances are met."""
        everything = np.concatenate([wanted.y, wanted.s])
        factors = np.abs(np.concatenate([self.places, self.books]))[:, :ENERGY]
        with np.errstate(divide="ignore"):
            own = np.min(everything[:, None] / factors, axis=0)
        both = np.zeros((2, LANES))
        rates = {OF_V1: own[V1], OF_V2: own[V2], OF_J: own[J]}
        for place, value in (rates | {LEVEL: wanted.level, FIRST: self._first_step}).items():
            both[0, place] = value
        both[1] = 1.0 / own[FIRST_ACCOUNT : FIRST_ACCOUNT + LANES]
        return both

    def samples(self, times: np.ndarray, record: np.ndarray) -> Samples:
        """What the general loop would have recorded."""
        own = record[: times.size]
        rows = np.concatenate([own[:, :ENERGY], self._arcs(own)], axis=1)
        none = np.zeros(times.size)
        return Samples(
            t=times,
            y=rows @ self.places.T,
            s=rows @ self.books.T,
            contact=own[:, ENERGY],
            field=none,
            stored=np.zeros((times.size, 2, STORED)),
        )

    def _arcs(self, record: np.ndarray) -> np.ndarray:
        """Integrals of q omega sin q: the spring's force on an end of the bar, as the bar moves."""
        q = record[:, [Q1, Q2]]
        arcs = np.sin(q) - q * np.cos(q)
        return arcs - arcs[:1]


def _ease(layout: Layout) -> np.ndarray:
    """(2,) what each centre of mass is displaced by for k = 1."""
    free = layout.model.surfaces.drive == FREE
    return np.array([1.0, -1.0]) * free / layout.model.asperites.mass


def _record(layout: Layout, ease: np.ndarray) -> np.ndarray:
    """The scene as the loop reads it."""
    a, b = layout.model.asperites, layout.model.bobs
    record = np.zeros(1, PAIR)
    record["gap_x"], record["gap_y"] = a.x[0] - a.x[1], a.y[0] - a.y[1]
    record["speed_x"], record["speed_y"] = a.vx[0] - a.vx[1], a.vy[0] - a.vy[1]
    record["square_z"] = (b.z[0] - b.z[1]) ** 2
    record["ease"] = ease[0] - ease[1]
    for i, sign in enumerate((1.0, -1.0)):
        lever = sign * a.facing[i] / a.inertia[i]
        across = a.l1[i] + a.l2[i]
        record[f"charge{i + 1}"] = b.charge[i]
        record[f"arm{i + 1}"] = a.facing[i] * a.l1[i]
        record[f"turn_x{i + 1}"] = lever * (across if ease[i] == 0.0 else a.l1[i])
        record[f"turn_y{i + 1}"] = lever * across
        record[f"square{i + 1}"] = a.kappa[i] / a.inertia[i]
    return record


def _matrices(layout: Layout, ease: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """`places` and `books` of a Pair; see kernels.powers for the accounts' meaning."""
    n = layout.coordinates
    places = np.zeros((2 * n, ENERGY + 2))
    books = np.zeros((layout.accounts, ENERGY + 2))
    columns = ((Q1, V1, X1, Y1, T1, ARC1), (Q2, V2, X2, Y2, T2, ARC2))
    for i, (a, sign) in enumerate(zip(layout.model.asperites, (1.0, -1.0), strict=True)):
        q, v, about_x, about_y, twist, arc = columns[i]
        places[i, q] = places[n + i, v] = 1.0
        first = FIRST_ACCOUNT
        contact = a.acc_contact
        books[contact, J] = books[contact + 1, first + J_Y] = sign
        books[contact + 2, first + about_x] = sign * a.facing
        books[contact + 3, first + about_y] = sign * a.facing
        if a.dof_x >= 0:
            places[a.dof_x, K] = places[n + a.dof_x, J] = ease[i]
            block = layout.model.surfaces[i].acc_block
            books[a.acc_slide, first + S] = books[block, first + S] = sign * ease[i]
        if a.acc_ends >= 0:
            end = a.kappa / a.bar_length
            books[a.acc_ends, arc] = -a.l2 * a.facing * end
            books[a.acc_ends + 1, arc] = a.l2 * a.facing * end
            books[a.acc_ends + 3, first + twist] = end
    return places, books
