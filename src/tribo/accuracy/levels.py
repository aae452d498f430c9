"""The level of a run's errors, relative to the scales, and the tolerances or steps that have it."""

from dataclasses import dataclass

import numpy as np

from tribo.accuracy.force_rounding import rounding_of_forces
from tribo.accuracy.scales import largest, length_scale, resolved
from tribo.integrators.methods import Method
from tribo.integrators.step_control import Tolerance
from tribo.kernels.kinematics import rod_velocity
from tribo.kernels.records import BARS
from tribo.layout.layout import Layout, once_per_layout
from tribo.layout.span import Span
from tribo.layout.start import bath_slots
from tribo.ledger.accounts import account_columns
from tribo.ledger.motion import Motion, mean_velocity
from tribo.ledger.samples import Samples, are_among
from tribo.loops.integrate import Integration
from tribo.loops.resolution import bath_frequency, spring_frequency, unit_step
from tribo.loops.setting import Setting

# The smallest relative tolerance: nine roundings.  Step control cannot resolve less.
FLOOR = 2e-15
# Tolerances below the effect of rounding fall as this power of the level.  Were they constant,
# finer runs would take the same steps: one of 450 random scenes had an error of 4.1e-12 of a rate,
# for an estimate of 1.4e-12.
BELOW_ROUNDING = 0.25
# The smallest normal number.
TINY = float(np.finfo(float).tiny)
# Places of the impulses (x, y, ...) in each group of accounts.
IMPULSES = {
    "acc_contact": (0, 1),
    "acc_drive": (0, 1),
    "acc_ends": (2, 3),
    "acc_user_ends": (2, 3, 4, 5),
    "acc_internal": (0, 1),
    "acc_field": (0, 1),
    "acc_thermal": (0, 1),
}
# Places of integrals that have no factor of the arm's length yet; that of the drive of driven bars
# is a work, which the ledger finds (`ledger.motion.add_reactions`).
WITHOUT_ARM = {"acc_contact": (2, 3), "acc_drive": (2,)}
# Level of the fine run relative to the coarse ones; its error is about this part of the difference.
# Errors of adaptive steps differ by chance: of 600 random pairs of asperites 2.3 % had errors above
# the estimates at 0.3, and 0.3 % at 0.1.  Errors of equal steps fall smoothly.
FINE_LEVEL = 0.1
FINE_LEVEL_OF_EQUAL_STEPS = 0.3
# Longest step of a coarse run, relative to the time to the next encounter.  Steps of a fine run are
# shorter, so that errors which tolerances do not control fall as much.
NEAR = 0.5
# Asperites that take as long as a call of an ASE calculator: 1 ms, as measured for EMT.
CALL = 8000


@dataclass(frozen=True)
class ToleranceScales:
    """The scales of local tolerances, which are the same in every inertial frame."""

    velocity: float  # the largest speed of a bob relative to the surfaces' mean [length / time]
    energy: float  # the largest work or change of an asperite's internal energy
    impulse: float  # the largest of a force [mass length / time]
    rate: float  # the largest |omega| or |nu| [1 / time]
    spin: float  # the largest |omega| [1 / time]
    twist: float  # the largest |theta - rest - phi| [rad]
    length: float  # that of the motion, at most the longest rod [length]
    # What the rounding of forces changes, and no step resolves; see accuracy.force_rounding.
    lost_angle: float = 0.0
    lost_rate: float = 0.0
    lost_speed: float = 0.0
    lost_energy: float = 0.0

    def below_rounding(self, level: float) -> bool:
        """Whether the tolerances of a level are below the effect of the rounding of forces."""
        return level * self.energy < self.lost_energy


@once_per_layout
def first_guess(layout: Layout) -> ToleranceScales:
    """Scales for a first, coarse run, from the start of the scene."""
    a = layout.together.asperites
    relative = _relative_velocity(layout, layout.together)
    frequency = np.sqrt(a.kappa / a.inertia)
    omega = largest(layout.start[layout.coordinates :][: layout.scene.count])
    arm = largest(a.l1)
    velocity = largest(np.hypot(relative[:, 0], relative[:, 1])) + arm * omega
    velocity = velocity or largest(frequency * a.l1) or 1.0
    rate = max(omega, largest(a.nu), largest(frequency), velocity / max(arm, TINY))
    energy = largest(a.mass) * velocity**2
    rod = largest(a.l1 + a.l2)
    return ToleranceScales(velocity, energy, energy / velocity, rate, rate, 1.0, rod)


def _relative_velocity(layout: Layout, span: Span) -> np.ndarray:
    """Initial velocity of each asperite relative to the mean of the surfaces' (asperites, 2)."""
    velocities = layout.velocities
    first = velocities[0]  # less this all is exact where all surfaces move fast
    mean = (velocities - first).mean(axis=0)
    return np.asarray((span.velocity.T - first) - mean)


def tolerance_scales(layout: Layout, samples: Samples) -> ToleranceScales:
    """Scales of a run, in the frame of the surfaces' mean velocity; the first guess for zeros."""
    guess = first_guess(layout)
    span = layout.together
    motion = Motion(layout, layout.together, samples)
    relative = _relative_velocity(layout, span)
    vx, vy = motion.vx + relative[:, 0], motion.vy + relative[:, 1]
    bob = rod_velocity(vx, vy, motion.omega, span.asperites.l1, *motion.direction)
    velocity = max(guess.velocity, largest(np.hypot(*bob)))
    torsion = motion.swing - motion.phi
    internal = motion.energy
    highest = largest(internal)
    change = largest(internal - internal[0])
    spin = largest(motion.omega)
    turn = largest(motion.nu)
    twist = largest(torsion)
    weights = _account_weights(layout)
    top = np.maximum.reduce(np.abs(samples.s), axis=0, initial=0.0)
    # Works in the laboratory are reported at the scene's times; in between they may be far larger.
    reported = samples.s[are_among(samples.t, layout.times)]
    work = max(largest(top * weights), _work_of_impulses(layout, reported))
    # Where nothing does work, the change of an energy is round-off.
    energy = max(work, change) if work > 0.0 or top.size == 0 else highest
    potential = max(largest(samples.contact), largest(samples.field)) / layout.scene.count
    inertia = largest(span.asperites.inertia)
    lost = rounding_of_forces(layout, motion)
    path = largest(motion.bob_path(mean_velocity(layout)))
    return ToleranceScales(
        velocity=velocity,
        energy=float(resolved(energy, potential)) or guess.energy,
        impulse=largest(top[weights == 0.0]) or guess.impulse,
        rate=float(resolved(max(spin, turn), np.sqrt(potential / inertia))) or guess.rate,
        spin=spin or guess.spin,
        twist=twist or guess.twist,
        length=float(length_scale(path, guess.length)),
        lost_angle=lost.get("theta", 0.0),
        lost_rate=max(lost.get("omega", 0.0), lost.get("nu", 0.0)),
        lost_speed=lost.get("vx_cm", 0.0),
        lost_energy=lost.get("w", 0.0),
    )


@once_per_layout
def _account_weights(layout: Layout) -> np.ndarray:
    """The factor that makes a work of each account; 0 for impulses. Shape (accounts,)."""
    weights = np.ones(layout.accounts)
    span = layout.accounted
    a = span.asperites
    length = a.l1 + a.l2
    driven = layout.surfaces["drive"][a.surface] == BARS
    for name, offsets in IMPULSES.items():
        if name not in span.present:
            continue
        slots = getattr(a, name)
        present = slots >= 0
        for k in offsets:
            weights[(slots + k * a.stride)[present]] = 0.0
        armed = present & ~driven if name == "acc_drive" else present
        for k in WITHOUT_ARM.get(name, ()):
            weights[(slots + k * a.stride)[armed]] = length[armed]
    return weights


def _work_of_impulses(layout: Layout, s: np.ndarray) -> float:
    """The largest V . J of an impulse J, where V is relative to the surfaces' mean velocity."""
    span = layout.accounted
    vx, vy = _relative_velocity(layout, span).T
    highest = 0.0
    for name, offsets in IMPULSES.items():
        for k in offsets[::2] if name in span.present else ():
            jx, jy = account_columns(span, name, (k, k + 1), s)
            highest = max(highest, largest(vx * jx + vy * jy))
    return highest


def tolerances(layout: Layout, scales: ToleranceScales, level: float, near: float) -> Tolerance:
    """Local tolerances of all coordinates, rates and accounts for an accuracy of about `level`.

    A coordinate's tolerance is the smaller of two: `level` times its own scale, and the change that
    alters an energy by `level` times the scale of energies, which governs weakly coupled scenes of
    tiny works.  Both fall more slowly below the effect of the rounding of forces, for which steps
    would shrink without end.  `near` is the longest step in units of the time to an encounter.
    """
    level = max(level, FLOOR)
    span = layout.together
    a = span.asperites
    energy = float(_slower_below(level * scales.energy, scales.lost_energy))
    speed = float(_slower_below(level * scales.velocity, scales.lost_speed))
    y = np.empty(2 * layout.coordinates)
    q = y[: layout.coordinates]
    v = y[layout.coordinates :]
    q[:] = level * scales.length
    v[:] = speed
    swing = slice(0, layout.scene.count)
    # An error of a rate matters to the energy by the rate itself, or else by its own square.
    spin = np.maximum(scales.spin, np.sqrt(energy / a.inertia))
    with np.errstate(over="ignore"):  # infinite where a torsion or a momentum is tiny
        angle = np.minimum(level, energy / np.maximum(a.kappa * scales.twist, TINY))
        omega = np.minimum(level * scales.rate, energy / np.maximum(a.inertia * spin, TINY))
    q[swing] = _slower_below(angle, scales.lost_angle)
    v[swing] = _slower_below(omega, scales.lost_rate)
    if "dof_phi" in span.present:
        turning = a.dof_phi >= 0
        q[a.dof_phi[turning]] = q[swing][turning]
        nu = np.minimum(level * scales.rate, energy / (a.i2[turning] * scales.rate))
        v[a.dof_phi[turning]] = _slower_below(nu, scales.lost_rate)
    for name, slots in (("dof_x", a.dof_x), ("dof_y", a.dof_y)):
        if name not in span.present:
            continue
        live = slots >= 0
        slow = np.minimum(speed, energy / (a.mass[live] * scales.velocity))
        v[slots[live]] = _slower_below(slow, scales.lost_speed)
    slots, inertias = _torsional_oscillators(layout)
    if slots.size > 0:
        q[slots] = level  # angles [rad], unlike the displacements of other oscillators
        momenta = np.maximum(inertias * scales.rate, TINY)
        v[slots] = np.minimum(level * scales.rate, energy / momenta)
    weights = _account_weights(layout)
    # An impulse whose work is a small difference has no digits beyond its own round-off.
    lost = max(FLOOR * scales.impulse, largest(a.mass) * scales.lost_speed)
    impulse = _slower_below(level * min(scales.impulse, scales.energy / scales.velocity), lost)
    s = np.empty(layout.accounts)
    s.fill(impulse)
    np.divide(energy, weights, out=s, where=weights > 0.0)
    return Tolerance(y, s, level, near)


@once_per_layout
def _torsional_oscillators(layout: Layout) -> tuple[np.ndarray, np.ndarray]:
    """The slots of all torsional oscillators of baths, and their moments of inertia, (n,) each."""
    slots = [np.empty(0, int)]
    inertias = [np.empty(0)]
    for surface, part in zip(layout.scene.surfaces, layout.parts.values(), strict=True):
        if surface.bath.inertias.size > 0:
            *_, own = bath_slots(layout.asperites[part], surface.bath)
            slots.append(own.ravel())
            inertias.append(np.broadcast_to(surface.bath.inertias, own.shape).ravel())
    return np.concatenate(slots), np.concatenate(inertias)


def _slower_below(tolerance: float | np.ndarray, lost: float) -> float | np.ndarray:
    """Tolerances, of which those below the effect of rounding fall more slowly."""
    if lost == 0.0:
        return tolerance
    slower = lost ** (1.0 - BELOW_ROUNDING) * np.power(tolerance, BELOW_ROUNDING)
    return np.where(np.less(tolerance, lost), slower, tolerance)


def fine_level(method: Method) -> float:
    """Level of a fine run relative to that of the coarse runs that it is compared with."""
    return FINE_LEVEL if method.adaptive else FINE_LEVEL_OF_EQUAL_STEPS


def setting_at(
    layout: Layout, method: Method, scales: ToleranceScales, level: float, near: float = NEAR
) -> Setting:
    """The tolerances or equal steps whose errors are about `level` of the scales."""
    if method.adaptive:
        return Setting(tolerance=tolerances(layout, scales, level, near))
    return Setting(step=equal_step(layout, method, level))


def equal_step(layout: Layout, method: Method, level: float) -> float:
    """The equal step whose errors are about `level` of the scales."""
    return _unit(layout) * level ** (1.0 / method.order)


def coarsest_level(layout: Layout, method: Method) -> float:
    """The coarsest level, whose equal steps turn the fastest oscillator of a bath by one radian.

    Longer steps of methods that do not advance it exactly damp it, or let it grow, at all levels
    alike, so that differences do not show their errors.
    """
    fastest = 0.0 if method.adaptive or method.splits else bath_frequency(layout)
    if fastest == 0.0:
        return 1.0
    return float(min(1.0, 1.0 / (fastest * _unit(layout))) ** method.order)


def _unit(layout: Layout) -> float:
    """The equal step of level 1: pendulums and springs turn by one radian at most."""
    springs = spring_frequency(layout)
    return min(unit_step(layout), 1.0 / springs if springs > 0.0 else np.inf)


def work(layout: Layout, run: Integration) -> float:
    """Force evaluations times asperites: a measure of cost that is the same on every machine."""
    return run.evaluations * float(layout.asperites.size + CALL * len(layout.calculator_calls))
