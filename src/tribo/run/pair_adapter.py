"""One asperite on one: the layout of a scene for the loop of :mod:`tribo.pair`, and back.

The loop's record has few columns.  Every coordinate and every account of the scene's layout is a
multiple of one of them; two matrices hold the factors.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from numba import config

from tribo.integrators.collocation import Collocation
from tribo.integrators.methods import Method
from tribo.integrators.step_control import Tolerance
from tribo.kernels.compiled import EntryPoint, time_loop
from tribo.kernels.records import CHARGE, CLOCK, FORCED, FREE, Z
from tribo.kernels.simd import LANES
from tribo.kernels.status import COMPLETED, PAUSED, Status
from tribo.model.effects import Effect
from tribo.pair.forces import PAIR
from tribo.pair.loop import COLUMNS, ENERGY, pair_collocation
from tribo.pair.step import table
from tribo.pair.step_rows import (
    FIRST,
    LEVEL,
    LIMITS,
    OF_J,
    OF_V1,
    OF_V2,
    ROWS,
    STATE,
    V1,
    V2,
    J,
)
from tribo.plugins.compile_errors import compiling
from tribo.plugins.sources import source_stamp
from tribo.run.general_loop import numbers_of, set_numbers
from tribo.run.integrate import (
    Checkpoints,
    Columns,
    Integration,
    Memory,
    Progress,
    first_step_at,
    integrate,
)
from tribo.run.layout import Layout
from tribo.run.pair_factors import FIRST_ACCOUNT, Factors, factors_of
from tribo.run.pair_samples import PairSamples

# Effects of scenes that the loop of a pair knows.
KNOWN = {Effect.CONTACT, Effect.SWING, Effect.SLIDING, Effect.CLAMPED_ENDS, Effect.CUTOFF}

# First step in units of the one that is usual: the loop's method is of order 15, and a first step
# that is too long costs one rejection only.
FIRST_STEP_FACTOR = 8.0
# Steps before a run without a progress report can be interrupted: a few milliseconds.
UNINTERRUPTED_STEPS = 2048


def has_pair_loop(layout: Layout, method: Method) -> bool:
    """Whether the pair's loop serves a scene and a method; it exists in compiled form only."""
    compiled = not config.DISABLE_JIT  # type: ignore[attr-defined]
    adaptive = method.adaptive and isinstance(method.coefficients, Collocation)
    return compiled and adaptive and is_pair(layout)


def is_pair(layout: Layout) -> bool:
    """Whether a scene is one asperite on one, forced or free, with bars clamped at rest.

    Centres of mass start where they rest, with their surface's velocity: the loop has one number
    for the impulse of the contact and for their rates.
    """
    model = layout.model
    a, surfaces = layout.asperites, layout.surfaces
    along_x = a.dof_x[a.dof_x >= 0]
    return (
        a.size == surfaces.size == 2
        and not np.any(layout.start.reshape(2, -1)[:, along_x])
        and layout.scene.output.ledger == "asperites"
        and layout.scene.effects <= KNOWN
        and model.species is None
        and layout.rows == 0
        and len(model.contacts[0].pairs) == 1
        and bool(np.all(np.isin(surfaces.drive, (FORCED, FREE)) & (surfaces.loaded == 0)))
        and bool(np.all((a.dof_phi < 0) & (a.phi == 0.0) & (a.nu == 0.0) & (a.dof_y < 0)))
    )


class Pair:
    """A scene of two asperites, and its compiled loop.

    Parameters
    ----------
    layout : Layout
        Of a scene for which `has_pair_loop` is true.
    method : Method
        The collocation method.
    first_step : float
        A short first step [time].

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
    clocks : ndarray, (1,)
        How far the run has come.
    rows : ndarray, (ROWS, 8)
        The loop's memory; the first rows are the method's table.
    factors : Factors
        From the loop's record to the layout.
    compile_seconds : float
        Time taken to compile the loop, or to load it from disk.
    """

    def __init__(self, layout: Layout, method: Method, first_step: float) -> None:
        """Compile the loop, or load it from disk."""
        began = time.perf_counter()
        self.layout = layout
        self.adaptive = True
        asperites = np.asarray(layout.asperites)
        mobility = mobility_of(layout, asperites)
        depths, charges = layout.model.each[[Z, CHARGE]][:, layout.places.columns]
        record = record_of(asperites[None], depths, charges, mobility)
        potential = layout.model.contacts[0].potential
        self._first_step, self._order = FIRST_STEP_FACTOR * first_step, method.order
        self.clocks, self.rows = np.zeros(1, CLOCK), np.zeros((ROWS, LANES))
        assert isinstance(method.coefficients, Collocation)
        self.rows[:LIMITS] = table(method.coefficients)
        self.factors = Factors(*factors_of(layout, asperites, mobility), {})
        # The loop's first arguments, the same in each call.
        self._fixed = (record, potential, self.rows, self.clocks)
        self._evaluations = self.clocks["evaluations"]  # the loop begins a run where this is 0
        self._tolerance: Tolerance | None = None  # from which the rows' limits were made
        self._start = layout.start
        loop = time_loop(pair_collocation, source_stamp(layout.plugins))
        examples = (layout.start, np.zeros(1), np.empty((2, COLUMNS)), 0)
        with compiling(loop, layout.named_plugins):
            self._loop = EntryPoint(loop, self._fixed, examples)
        self.compile_seconds = time.perf_counter() - began

    def integrate(
        self,
        tolerance: Tolerance,
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
        if self._tolerance is not tolerance:
            self._tolerance = tolerance
            self.rows[LIMITS:STATE] = self.limits(tolerance)
            self.clocks["encounter_fraction"] = tolerance.encounter_fraction
        self._evaluations[0] = 0
        self._start = start
        if progress is not None or checkpoints is not None:
            return integrate(self, times, (), progress, None, checkpoints, most=most)
        record = np.empty((times.size + 1, COLUMNS))
        code = self._loop(start, times, record, UNINTERRUPTED_STEPS)
        if code != COMPLETED:
            if code != PAUSED:
                self._evaluations[0] = 0  # from the start again, to the same end
            return integrate(self, times, columns=(record,), most=most)
        seconds, clock = time.perf_counter() - began, self.clocks.tobytes()
        rows = self.rows[STATE:].copy()
        return Integration(
            lambda: self.samples(times, (record,)),
            Status.COMPLETED,
            record[-1],
            seconds,
            lambda: _memory(np.frombuffer(clock, CLOCK), rows),
        )

    @property
    def scene_arguments(self) -> tuple[Any, ...]:
        """The scene and its potential, the loop's first arguments."""
        return self._fixed[:2]

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
        return _memory(self.clocks, self.rows[STATE:].copy())

    def restore(self, memory: Memory) -> None:
        """Continue where another loop of this kind was."""
        set_numbers(self.clocks, memory["clock"])
        self.rows[STATE:] = memory["pair"]

    def limits(self, tolerance: Tolerance) -> np.ndarray:
        """The loop's own limits (2, 8), with which all of the layout's tolerances are met."""
        everything = np.concatenate([tolerance.y, tolerance.s])
        factors = np.abs(np.concatenate([self.factors.state, self.factors.accounts]))[:, :ENERGY]
        with np.errstate(divide="ignore"):
            own = np.min(everything[:, None] / factors, axis=0)
        both = np.zeros((2, LANES))
        rates = {OF_V1: own[V1], OF_V2: own[V2], OF_J: own[J]}
        first = first_step_at(tolerance, self._first_step, self._order)
        for place, value in (rates | {LEVEL: tolerance.level, FIRST: first}).items():
            both[0, place] = value
        both[1] = 1.0 / own[FIRST_ACCOUNT : FIRST_ACCOUNT + LANES]
        return both

    def samples(self, times: np.ndarray, columns: Columns) -> PairSamples:
        """The first samples in `columns`, of the scene's layout, which were recorded at `times`."""
        record = columns[0][: times.size]
        return PairSamples(times, record, record[0], self.factors)


def _memory(clocks: np.ndarray, rows: np.ndarray) -> Memory:
    return {"clock": numbers_of(clocks), "pair": rows}


def mobility_of(layout: Layout, asperites: np.ndarray) -> np.ndarray:
    """(..., 2) displacement of each centre of mass for k = 1."""
    free = layout.surfaces.drive == FREE
    return np.asarray(np.array([1.0, -1.0]) * free / asperites["mass"])


def record_of(
    asperites: np.ndarray, depths: np.ndarray, charges: np.ndarray, mobility: np.ndarray
) -> np.ndarray:
    """Scenes as the loop reads them.

    Parameters
    ----------
    asperites : ndarray, (..., 2), of ASPERITE
        Those of each scene.
    depths : ndarray, (2,)
        z of the bobs.
    charges, mobility : ndarray, (..., 2)
        Of the bobs; :func:`mobility_of`.

    Returns
    -------
    ndarray, (...), of PAIR
    """
    a = asperites
    record = np.zeros(a.shape[:-1], PAIR)
    for name, of in (("gap_x", "x"), ("gap_y", "y"), ("velocity_x", "vx"), ("velocity_y", "vy")):
        record[name] = a[of][..., 0] - a[of][..., 1]
    record["z_squared"] = (depths[0] - depths[1]) ** 2
    record["mobility"] = mobility[..., 0] - mobility[..., 1]
    for i, sign in enumerate((1.0, -1.0)):
        one, free = a[..., i], mobility[..., i] != 0.0
        lever = sign * one["facing"] / one["inertia"]
        across = one["l1"] + one["l2"]
        record[f"charge{i + 1}"] = charges[..., i]
        record[f"arm{i + 1}"] = one["facing"] * one["l1"]
        record[f"lever_x{i + 1}"] = lever * np.where(free, one["l1"], across)
        record[f"lever_y{i + 1}"] = lever * across
        record[f"omega_squared{i + 1}"] = one["kappa"] / one["inertia"]
    return record
