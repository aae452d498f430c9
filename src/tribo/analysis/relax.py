"""Equilibria: where no force moves any coordinate of a scene.

Forces that a drive cancels have no energy, which the minimisers of scipy.optimize need, so forces
are followed, by scipy's solvers.  In each step the damped motion du/dtau = u'' is advanced
implicitly, (1 / dtau - J) step = u'' with J the derivative of u''.  Short dtau follow the forces
downhill; dtau grows on the way, and the last steps are Newton's.
C. T. Kelley, D. E. Keyes, SIAM J. Numer. Anal. 35 (1998) 508.
"""

import numpy as np
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs, gmres

from tribo.compiler.lanes_memory import room
from tribo.kernels.probe import acceleration_probe
from tribo.kernels.records import ASPERITE, I2, INERTIA, MASS
from tribo.layout.layout import Layout, lay_out
from tribo.layout.start import hang_baths
from tribo.ledger.samples import Samples
from tribo.ledger.separation import asperite_name, closest_bobs
from tribo.loops.saved_state import State, state_at_rest
from tribo.model.fields import period_of
from tribo.model.scene import Scene
from tribo.threads.model_units import rate_units
from tribo.threads.writable_memory import Probe
from tribo.validation import instance

# Steps until the search is given up: bobs have then moved up to 40 rods.
MOST_STEPS = 400
# Unstable equilibria that are left, until the search is given up.
MOST_ESCAPES = 20
# Largest step, in units of the shortest of rod, bobs' distance and period: larger ones pass bobs.
LONGEST_STEP = 0.1
# Displacement out of an unstable equilibrium, in units of that largest change.
ESCAPE = 0.01
# Accelerations that are zero, in units of the largest derivative; rounding is a hundredth of it.
ZERO = 1e-10
# The same, below all rounding of forces.
NOTHING = 1e-18
# Half the difference of coordinates from which derivatives are taken, in units of the largest
# change: errors of rounding and of the third derivative are about equal.
DIFFERENCE = 1e-4
# Relative accuracy of a step: a smaller one costs more evaluations than it saves steps.
STEP_ACCURACY = 1e-3
# Growth at an unstable equilibrium, in units of the largest derivative, which is known to 1e-9.
UNSTABLE = 1e-7
# Coordinates up to which all derivatives are computed to find an unstable direction.
DENSE = 64


class NoEquilibriumError(ValueError):
    """No equilibrium of a scene was found; :func:`relax` raises it.

    Attributes
    ----------
    asperite : str
        The asperite with the largest remaining acceleration.
    residual : float
        The force [force] or torque on it.
    """

    def __init__(self, asperite: str, residual: float, problem: str) -> None:
        self.asperite = asperite
        self.residual = residual
        super().__init__(problem)


def relax(scene: Scene) -> State:
    """Find a stable equilibrium of a scene, from its start.

    All coordinates that a run integrates move until no net force is left: swings, bars that turn,
    centres of mass, and baths, which end at their bars.  Drives and loads act as at t = 0. Driven
    bars and rigid asperites stay where they start. Surfaces keep their velocities: the equilibrium
    is that of the forces at t = 0, and all coordinates move with their surface.

    Parameters
    ----------
    scene : Scene
        The scene to relax.

    Returns
    -------
    State
        The equilibrium, at t = 0, from which ``tribo.simulate(scene, start=state)`` begins.

    Raises
    ------
    NoEquilibriumError
        No equilibrium was found: a force moves a coordinate without end, or a force jumps.
    InputError
        If `scene` is not a Scene, or a plug-in does not compile.
    """
    layout = lay_out(instance(Scene)("scene", scene))
    motion = _Accelerations(layout)
    u = layout.start[: layout.core] / motion.lengths
    for _ in range(MOST_ESCAPES):
        u, stiffness = _descend(motion, u)
        direction = _unstable_direction(motion, u, stiffness)
        if direction is None:
            return state_at_rest(layout, motion.coordinates(u))
        u = u + direction * (ESCAPE * motion.longest_step(u) / np.max(np.abs(direction)))
    raise motion.failure(u, f"{MOST_ESCAPES} equilibria were unstable")


class _Accelerations:
    """The accelerations u'' of a scene at rest at t = 0; lengths in u are in units of the rods."""

    def __init__(self, layout: Layout) -> None:
        """Find units, inertias and owners of all coordinates; no force is computed yet."""
        self._layout = layout
        # As a plain array, whose fields are found ten times sooner than a recarray's.
        self._asperites = layout.asperites.view(ASPERITE, np.ndarray)
        self._q, self._v, self._found = (room((layout.room[0],)) for _ in range(3))
        self._probe = Probe(layout, acceleration_probe, rate_units)
        # The unit, the inertia and the asperite of each coordinate, (core,).
        self.lengths = np.ones(layout.core)
        self._inertias = np.ones(layout.core)
        self._owners = np.zeros(layout.core, int)
        a = layout.asperites
        each = np.arange(a.size)
        for slots, row in ((each, INERTIA), (a.dof_phi, I2), (a.dof_x, MASS), (a.dof_y, MASS)):
            present = slots >= 0
            mine = slots[present]
            self._inertias[mine] = layout.constants[row, present]
            self._owners[mine] = each[present]
            if row == MASS:
                self.lengths[mine] = (a.l1 + a.l2)[present]
        # (core,) masses or inertias in the units of u; 0 for what a constraint holds.
        inertias = self._inertias * self.lengths**2
        self.weights = np.where(np.isinf(self._inertias), 0.0, inertias)

    def coordinates(self, u: np.ndarray) -> np.ndarray:
        """All coordinates, with the baths at their bars."""
        layout = self._layout
        q = np.zeros(layout.coordinates)
        q[: layout.core] = u * self.lengths
        hang_baths(self._asperites, layout.scene, q)
        return q

    def __call__(self, u: np.ndarray) -> np.ndarray:
        """u'' [1 / time^2], (core,)."""
        layout = self._layout
        self._q[layout.places.q] = self.coordinates(u)
        self._probe(1, 0.0, self._q, self._v, self._found)
        return self._found[layout.places.q[: layout.core]] / self.lengths

    def longest_step(self, u: np.ndarray) -> float:
        """The largest change of a coordinate in a step from u: larger ones can pass a bob."""
        layout = self._layout
        rod = float(np.max(layout.asperites.l1 + layout.asperites.l2))
        sample = Samples.at_zero(layout)
        sample.y[0, : layout.core] = u * self.lengths
        bobs = closest_bobs(layout, sample)
        periods = (period_of(item.potential) for item in layout.scene.fields)
        lengths = [rod, *(period for period in periods if period is not None)]
        if bobs is not None and bobs[0] > 0.0:
            lengths.append(bobs[0])
        return LONGEST_STEP * min(lengths) / rod

    def failure(self, u: np.ndarray, why: str) -> NoEquilibriumError:
        """The error that names the largest acceleration that is left."""
        found = self(u)
        worst = int(np.argmax(np.where(np.isfinite(found), np.abs(found), np.inf)))
        residual = float(self._inertias[worst] * found[worst] * self.lengths[worst])
        name = asperite_name(self._layout, int(self._owners[worst]))
        kind = "torque" if worst < self._layout.asperites.size else "force"
        problem = f"no equilibrium was found: {why}, where the {kind} on {name} is {residual:.3g}"
        return NoEquilibriumError(name, residual, problem)


class _Derivative:
    """J at one place, by central differences, and the largest |J w| / |w| so far [1 / time^2]."""

    def __init__(self, motion: _Accelerations, u: np.ndarray) -> None:
        self._motion = motion
        self._u = u
        self.largest = 0.0
        self.longest_step = motion.longest_step(u)
        self.operator = LinearOperator((u.size, u.size), self.product, dtype=float)

    def product(self, w: np.ndarray) -> np.ndarray:
        """J w."""
        w = w.ravel()
        size = float(np.max(np.abs(w)))
        if size == 0.0:
            return np.zeros(w.size)
        scale = DIFFERENCE * self.longest_step / size
        change = self._motion(self._u + scale * w) - self._motion(self._u - scale * w)
        product = change / (2.0 * scale)
        self.largest = max(self.largest, float(np.max(np.abs(product))) / size)
        return product


def _descend(motion: _Accelerations, u: np.ndarray) -> tuple[np.ndarray, float]:
    """An equilibrium, stable or not, and the largest derivative there [1 / time^2]."""
    found = motion(u)
    interval = 0.0  # dtau
    for _ in range(MOST_STEPS):
        residual = float(np.max(np.abs(found)))
        if not np.isfinite(residual):
            raise motion.failure(u, "forces at the start are not finite")
        derivative = _Derivative(motion, u)
        if residual == 0.0:
            return u, 0.0
        derivative.product(found)
        longest = derivative.longest_step
        interval = interval or min(1.0 / max(derivative.largest, 1e-300), longest / residual)
        step = _implicit_step(derivative, found, interval)
        length = np.max(np.abs(step))
        if length > longest:
            step *= longest / length
        there = motion(u + step)
        close = residual <= ZERO * derivative.largest
        ended = residual <= NOTHING * derivative.largest
        if ended or (close and np.max(np.abs(there)) > 0.5 * residual):
            return u, derivative.largest
        power, power_there = (float(np.sum(motion.weights * step * a)) for a in (found, there))
        if close or (power > 0.0 and power_there > -0.5 * power):
            gain = residual / max(float(np.max(np.abs(there))), 1e-300)
            interval *= min(max(gain, 1.5), 10.0)
            u = u + step
            found = there
        else:
            interval *= 0.25
    raise motion.failure(u, f"after {MOST_STEPS} steps forces do not vanish")


def _implicit_step(derivative: _Derivative, found: np.ndarray, interval: float) -> np.ndarray:
    """The step of (1 / interval - J) step = found."""
    operator = LinearOperator(
        (found.size, found.size),
        lambda w: w.ravel() / interval - derivative.product(w),
        dtype=float,
    )
    step, _ = gmres(operator, found, rtol=STEP_ACCURACY, restart=60, maxiter=5)
    return np.asarray(step)


def _unstable_direction(
    motion: _Accelerations, u: np.ndarray, stiffness: float
) -> np.ndarray | None:
    """A direction in which an equilibrium is left without end, (core,); None if there is none."""
    derivative = _Derivative(motion, u)
    if u.size <= DENSE:
        values, vectors = np.linalg.eig(derivative.operator @ np.eye(u.size))
    else:
        start = np.random.default_rng(0).standard_normal(u.size)
        try:
            values, vectors = eigs(derivative.operator, k=1, which="LR", v0=start, tol=0.01)
        except ArpackNoConvergence as error:
            values = error.eigenvalues
            vectors = error.eigenvectors
    if values.size == 0 or np.max(values.real) <= UNSTABLE * max(stiffness, derivative.largest):
        return None
    direction = vectors[:, np.argmax(values.real)].real
    # Either sign would do; the same one on any machine.
    return direction * np.sign(direction[np.argmax(np.abs(direction))])
