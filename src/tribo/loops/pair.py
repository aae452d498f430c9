"""One asperite on one: the layout of a scene for the loop of :mod:`tribo.pair`, and back.

The loop's record has few columns.  Every coordinate and every account of the scene's layout is a
multiple of one of them; two matrices hold the factors.
"""

from __future__ import annotations

import time

import numpy as np
from numba import config

from tribo.compiler.lanes import LANES
from tribo.integrators.collocation import Collocation
from tribo.integrators.methods import Method
from tribo.integrators.step_control import Tolerance
from tribo.kernels.records import BARS, CHARGE, FORCED, FREE, Z
from tribo.layout.layout import Layout
from tribo.layout.pair_factors import FIRST_ACCOUNT, Factors, factors_of
from tribo.loops.integrate import Checkpoints, Integration, Progress, first_step_at
from tribo.loops.pair_loop import PairLoop
from tribo.model.effects import Effect
from tribo.pair.forces import PAIR
from tribo.pair.loop import ENERGY
from tribo.pair.step import table
from tribo.pair.step_rows import (
    FIRST,
    LEVEL,
    LIMITS,
    OF_J,
    OF_V1,
    OF_V2,
    ROWS,
    V1,
    V2,
    J,
)

# Effects of scenes that the loop of a pair knows.
KNOWN = {Effect.CONTACT, Effect.SWING, Effect.SLIDING, Effect.CLAMPED_ENDS, Effect.CUTOFF}
KNOWN |= {Effect.DRIVEN_BARS}

# First step in units of the one that is usual: the loop's method is of order 15, and a first step
# that is too long costs one rejection only.
FIRST_STEP_FACTOR = 8.0


def has_pair_loop(layout: Layout, method: Method) -> bool:
    """Whether the pair's loop serves a scene and a method; it exists in compiled form only."""
    compiled = not config.DISABLE_JIT  # type: ignore[attr-defined]
    adaptive = method.adaptive and isinstance(method.coefficients, Collocation)
    return compiled and adaptive and is_pair(layout)


def is_pair(layout: Layout) -> bool:
    """Whether a scene is one asperite on one, with bars clamped at rest, forced, free or driven.

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
        and bool(np.all(np.isin(surfaces.drive, (FORCED, FREE, BARS)) & (surfaces.loaded == 0)))
        and bool(np.all((a.dof_phi < 0) & (a.phi == 0.0) & (a.nu == 0.0) & (a.dof_y < 0)))
    )


class Pair:
    """A scene of two asperites, and its compiled loop; threads can run it at the same time.

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
    scene_arguments : tuple
        The scene and its potential, the loop's first arguments.
    factors : Factors
        From the loop's record to the layout.
    compile_seconds : float
        Time taken to compile the loop, or to load it from disk.
    """

    def __init__(self, layout: Layout, method: Method, first_step: float) -> None:
        """Compile the loop, or load it from disk."""
        began = time.perf_counter()
        self.layout = layout
        asperites = np.asarray(layout.asperites)
        mobility = mobility_of(layout, asperites)
        depths, charges = layout.model.each[[Z, CHARGE]][:, layout.places.columns]
        record = record_of(asperites[None], depths, charges, mobility)
        self.scene_arguments = record, layout.model.contacts[0].potential
        driven = layout if layout.model.pivots is not None else None
        self.factors = Factors(*factors_of(layout, asperites, mobility), {}, driven)
        self._first_step, self._order = FIRST_STEP_FACTOR * first_step, method.order
        assert isinstance(method.coefficients, Collocation)
        self._coefficients = method.coefficients
        self._idle = [self._new_loop()]
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
        loop = self.free_loop()
        if loop.tolerance is not tolerance:
            loop.set_up(tolerance, self.limits(tolerance))
        run = loop.integrate(start, times, progress, checkpoints, most)
        self._idle.append(loop)
        return run

    def free_loop(self) -> PairLoop:
        """A loop that no other thread uses; one that a run leaves unfinished is not used again."""
        try:
            return self._idle.pop()
        except IndexError:
            return self._new_loop()

    def rows(self) -> np.ndarray:
        """The memory of a loop before its first run, (ROWS, 8)."""
        rows = np.zeros((ROWS, LANES))
        rows[:LIMITS] = table(self._coefficients)
        return rows

    def _new_loop(self) -> PairLoop:
        return PairLoop(self.layout, self.scene_arguments, self.rows(), self.factors)

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


def mobility_of(layout: Layout, asperites: np.ndarray) -> np.ndarray:
    """(..., 2) displacement of each centre of mass for k = 1."""
    free = layout.surfaces.drive == FREE
    return np.asarray(np.array([1.0, -1.0]) * free / asperites["mass"])


def record_of(
    asperites: np.ndarray, depths: np.ndarray, charges: np.ndarray, mobility: np.ndarray
) -> np.ndarray:
    """Scenes as the loop reads them; driven bars take the place of centres of mass.

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
    raised = a["facing"] * a["pivot"]
    record["gap_y"] += raised[..., 0] - raised[..., 1]
    record["z_squared"] = (depths[0] - depths[1]) ** 2
    record["mobility"] = mobility[..., 0] - mobility[..., 1]
    for i, sign in enumerate((1.0, -1.0)):
        one, free = a[..., i], mobility[..., i] != 0.0
        inertia = one["inertia"] + one["mass"] * one["pivot"] ** 2
        lever = sign * one["facing"] / inertia
        across = one["l1"] + one["l2"]
        record[f"charge{i + 1}"] = charges[..., i]
        record[f"arm{i + 1}"] = one["facing"] * (one["l1"] + one["pivot"])
        record[f"lever_x{i + 1}"] = lever * np.where(free, one["l1"], across)
        record[f"lever_y{i + 1}"] = lever * across
        record[f"omega_squared{i + 1}"] = one["kappa"] / inertia
    return record
