"""The scales that errors are relative to, and the local tolerances made from them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from tribo.integrators.step_control import Tolerance
from tribo.kernels.kinematics import bob_velocity
from tribo.run.batch import Batch
from tribo.run.layout import Layout
from tribo.run.ledger import Ledger
from tribo.run.motion import Motion, internal_energy, swing_direction
from tribo.run.quantities import (
    ASPERITE_QUANTITIES,
    BLOCK_QUANTITIES,
    OPTIONAL_QUANTITIES,
    QUANTITIES,
    SYSTEM_QUANTITIES,
)
from tribo.run.resolution import bath_frequency, pendulum_frequency
from tribo.run.samples import Samples

# The distance from 1 to the next double.
EPSILON = float(np.finfo(float).eps)
# The kind of every reported quantity, which selects its scale; energies of a surface as a whole and
# of the system have one of their own.
KINDS = {name: quantity.kind for name, quantity in QUANTITIES.items()}
KINDS |= dict.fromkeys(BLOCK_QUANTITIES | SYSTEM_QUANTITIES, "total")
# The quantities of asperites by which rates and energies are measured.
ENERGIES = tuple(
    name
    for name, quantity in (ASPERITE_QUANTITIES | OPTIONAL_QUANTITIES).items()
    if quantity.kind == "energy"
)
# The quantities of surfaces and of the system by which their energies are measured.  The energy of
# contacts is none: it has an arbitrary origin.
TOTALS = tuple(name for name, kind in KINDS.items() if kind == "total" and name != "contact_energy")
# Energies of a position, with which those of the motion are compared.
POTENTIALS = ("contact_energy", "field_energy")
MEASURED = ("omega", "nu", *ENERGIES, *TOTALS, *POTENTIALS)
# Motion with less energy than this fraction of the energy of contacts and fields is made of
# round-off.  Two rows of five in an equilibrium have works of 1e-15 of that energy, and a total of
# 1e-14.
UNRESOLVED = 256.0 * EPSILON
# The smallest relative tolerance: nine roundings.  Step control cannot resolve less.
FLOOR = 2e-15


@dataclass(frozen=True)
class Scales:
    """One scale for each kind of quantity, which its errors are relative to.

    No scale is made of round-off: where energies, rates or velocities are below UNRESOLVED of the
    energy of contacts and fields by asperite, or of the rate or velocity that this energy could
    give an asperite, these are the scales.

    Attributes
    ----------
    rate
        the largest ``|omega|`` or ``|nu|`` [1 / time]
    length
        the longest rod [length]
    velocity
        the largest speed of a bob relative to the mean of the surfaces' initial
        velocities [length / time]
    energy
        the largest work, pseudowork, delta_e_int or delta_k_trans [energy]; where all works are
        below the round-off of the largest internal energy, that energy
    total
        the largest work, pseudowork or change of energy of a surface as a whole or of the system,
        and at least `energy` [energy]
    angle
        1 radian
    """

    rate: float
    length: float
    velocity: float
    energy: float
    total: float
    angle: float = 1.0

    def of(self, kind: str) -> float:
        """The scale of one kind of quantity."""
        return float(getattr(self, kind))


def reported_scales(layout: Layout, ledger: Ledger) -> Scales:
    """The scales of a run's errors: maxima over asperites and samples, in the laboratory."""
    tops = {
        name: max(map(largest, ledger.series(name))) for name in MEASURED if ledger.series(name)
    }
    return scales_of(layout, tops, _fastest_bob(layout, ledger), _internal_energy(layout, ledger))


def scales_of(layout: Layout, tops: Mapping[str, float], speed: float, internal: float) -> Scales:
    """The scales of a run's errors.

    Parameters
    ----------
    layout
        the scene
    tops
        the largest magnitude of each quantity
    speed
        the largest of a bob relative to the mean of the surfaces' initial velocities
    internal
        the largest internal energy
    """
    a = layout.together.asperites
    by_kind = motion_scales(
        tops, speed, internal, np.max(a.inertia), np.max(a.mass), layout.scene.count
    )
    return Scales(length=_longest_rod(layout), **{kind: float(x) for kind, x in by_kind.items()})


# A value of one run, or those of several members (members,).
Values = float | np.ndarray


def motion_scales(
    tops: Mapping[str, Values],
    speed: Values,
    internal: Values,
    inertia: Values,
    mass: Values,
    asperites: int,
) -> dict[str, np.ndarray]:
    """The scales of rates, velocities and energies, by kind; see :class:`Scales`.

    Parameters
    ----------
    tops
        the largest magnitude of each quantity
    speed
        the largest of a bob relative to the mean of the surfaces' initial velocities
    internal
        the largest internal energy
    inertia, mass
        the largest of an asperite
    asperites
        how many there are
    """
    energies = {name: tops[name] for name in ENERGIES if name in tops}
    highest = _highest(energies.values())
    works = _highest([top for name, top in energies.items() if name.startswith("w")] or [highest])
    potential = _highest([tops[name] for name in POTENTIALS if name in tops] or [0.0]) / asperites
    measured = np.where(works > EPSILON * np.asarray(internal), highest, internal)
    energy = _resolved(measured, potential)
    return {
        "rate": _resolved(_highest([tops["omega"], tops["nu"]]), np.sqrt(potential / inertia)),
        "velocity": _resolved(speed, np.sqrt(potential / mass)),
        "energy": energy,
        "total": _highest([energy, *(tops[name] for name in TOTALS if name in tops)]),
    }


def _highest(values: Iterable[Values]) -> np.ndarray:
    return np.asarray(np.max(np.broadcast_arrays(*values), axis=0))


def _resolved(measured: Values, possible: Values) -> np.ndarray:
    """What was measured, or what is possible where only round-off was."""
    possible = np.where(np.isfinite(possible), possible, 0.0)
    return np.where(measured > UNRESOLVED * possible, measured, possible)


def mean_velocity(layout: Layout) -> np.ndarray:
    """The mean of the surfaces' initial velocities, (2,)."""
    velocities = np.array([layout.velocity_of(k) for k in range(len(layout.parts))])
    return np.asarray(velocities.sum(axis=0) / len(velocities))


def _internal_energy(layout: Layout, ledger: Ledger) -> float:
    """The largest internal energy of an asperite."""
    highest = 0.0
    for surface in layout.scene.surfaces:
        table = ledger.surfaces[surface.name]
        a = layout.asperites[layout.parts[surface.name]]
        twist = table["theta"] - surface.rest - table["phi"]
        energy = internal_energy(a, table["omega"], table["nu"], twist)
        highest = max(highest, largest(energy))
    return highest


def _longest_rod(layout: Layout) -> float:
    a = layout.together.asperites
    return float(np.max(a.l1 + a.l2))


def _fastest_bob(layout: Layout, ledger: Ledger) -> float:
    """The largest |v_cm + l1 omega (cos theta, sin theta)|, less the surfaces' mean velocity."""
    mean = mean_velocity(layout)
    fastest = 0.0
    for surface in layout.scene.surfaces:
        table = ledger.surfaces[surface.name]
        a = layout.asperites[layout.parts[surface.name]]
        tx, ty = swing_direction(a.facing, table["theta"] - surface.rest)
        vx, vy = table["vx_cm"] - mean[0], table["vy_cm"] - mean[1]
        vx, vy = bob_velocity(vx, vy, table["omega"], a.l1, tx, ty)
        fastest = max(fastest, float(np.max(np.hypot(vx, vy))))
    return fastest


def _fastest_of(batch: Batch, m: Motion, velocity: np.ndarray) -> float:
    """The largest speed of a bob, where `velocity` are those of the surfaces (2, asperites)."""
    a = batch.asperites
    direction = swing_direction(a.facing, m.swing)
    vx, vy = bob_velocity(m.vx + velocity[0], m.vy + velocity[1], m.omega, a.l1, *direction)
    return float(np.max(np.hypot(vx, vy)))


@dataclass(frozen=True)
class ToleranceScales:
    """The scales of local tolerances, which are the same in every inertial frame.

    Attributes
    ----------
    velocity
        the largest speed of a bob relative to the surfaces' mean [length / time]
    energy
        the largest work or change of an asperite's internal energy [energy]
    impulse
        the largest impulse of a force [mass length / time]
    rate
        the largest ``|omega|`` or ``|nu|`` [1 / time]
    spin
        the largest ``|omega|`` [1 / time]
    twist
        the largest ``|theta - rest - phi|`` [radian]
    """

    velocity: float
    energy: float
    impulse: float
    rate: float
    spin: float
    twist: float


def first_guess(layout: Layout) -> ToleranceScales:
    """Scales for a first, coarse run, from the start of the scene."""
    a = layout.together.asperites
    relative = _relative_velocity(layout, layout.together)
    frequency = np.sqrt(a.kappa / a.inertia)
    omega = np.max(np.abs(layout.start[layout.coordinates :][: layout.scene.count]))
    velocity = float(np.max(np.hypot(relative[:, 0], relative[:, 1])) + np.max(a.l1) * omega)
    velocity = velocity or float(np.max(frequency * a.l1)) or 1.0
    rate = float(max(omega, largest(a.nu), np.max(frequency), velocity / np.max(a.l1)))
    energy = float(np.max(a.mass)) * velocity**2
    return ToleranceScales(velocity, energy, energy / velocity, rate, rate, 1.0)


def _relative_velocity(layout: Layout, batch: Batch) -> np.ndarray:
    """Initial velocity of each asperite relative to the mean of the surfaces' (asperites, 2)."""
    first = layout.velocity[0]  # less this all is exact where all surfaces move fast
    starts = [part.start for part in layout.parts.values()]
    mean = np.mean([layout.velocity[start] - first for start in starts], axis=0)
    return np.asarray((batch.velocity.T - first) - mean)


def tolerance_scales(layout: Layout, samples: Samples) -> ToleranceScales:
    """Scales measured in a run; `first_guess` replaces those that are zero.

    The works are those in the frame of the surfaces' mean velocity.
    """
    guess = first_guess(layout)
    batch, motion = layout.together, Motion(layout, layout.together, samples)
    relative = _relative_velocity(layout, batch)
    velocity = max(guess.velocity, _fastest_of(batch, motion, relative.T))
    torsion = motion.swing - motion.phi
    internal = internal_energy(batch.asperites, motion.omega, motion.nu, torsion)
    highest, change = largest(internal), largest(internal - internal[0])
    spin, turn, twist = largest(motion.omega), largest(motion.nu), largest(torsion)
    weights = _account_weights(layout)
    top = np.max(np.abs(samples.s), axis=0, initial=0.0)
    # Works in the laboratory are reported at the scene's times; in between they may be far larger.
    reported = samples.s[np.isin(samples.t, layout.times)]
    work = max(largest(top * weights), _work_of_impulses(layout, reported))
    # Where nothing does work, the change of an energy is round-off.
    energy = max(work, change) if work > 0.0 or top.size == 0 else highest
    potential = max(largest(samples.contact), largest(samples.field)) / layout.scene.count
    inertia = float(np.max(batch.asperites.inertia))
    return ToleranceScales(
        velocity=velocity,
        energy=float(_resolved(energy, potential)) or guess.energy,
        impulse=largest(top[weights == 0.0]) or guess.impulse,
        rate=float(_resolved(max(spin, turn), np.sqrt(potential / inertia))) or guess.rate,
        spin=spin or guess.spin,
        twist=twist or guess.twist,
    )


def largest(values: np.ndarray) -> float:
    """The largest magnitude; 0 of an empty array."""
    return float(np.max(np.abs(values), initial=0.0))


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
# Places of integrals that have no factor of the arm's length yet.
WITHOUT_ARM = {"acc_contact": (2, 3), "acc_drive": (2,)}


def _account_weights(layout: Layout) -> np.ndarray:
    """The factor that makes a work of each account; 0 for impulses. Shape (accounts,)."""
    weights = np.ones(layout.accounts)
    a = layout.accounted.asperites
    length = a.l1 + a.l2
    for name, offsets in IMPULSES.items():
        present = getattr(a, name) >= 0
        for k in offsets:
            weights[(getattr(a, name) + k * a.stride)[present]] = 0.0
        for k in WITHOUT_ARM.get(name, ()):
            weights[(getattr(a, name) + k * a.stride)[present]] = length[present]
    return weights


def _work_of_impulses(layout: Layout, s: np.ndarray) -> float:
    """The largest V . J of an impulse J, where V is relative to the surfaces' mean velocity."""
    a = layout.accounted.asperites
    velocity = _relative_velocity(layout, layout.accounted)
    highest = 0.0
    for name, offsets in IMPULSES.items():
        present = getattr(a, name) >= 0
        stride, (vx, vy) = a.stride[present], velocity[present].T
        for k in offsets[::2]:
            jx, jy = (s[:, getattr(a, name)[present] + m * stride] for m in (k, k + 1))
            highest = max(highest, largest(vx * jx + vy * jy))
    return highest


def tolerances(layout: Layout, scales: ToleranceScales, level: float, near: float) -> Tolerance:
    """Local tolerances of all coordinates, rates and accounts for an accuracy of about `level`.

    A coordinate's tolerance is the smaller of two: `level` times its own scale, and the change
    that alters an energy by `level` times the scale of energies.  The second governs weakly
    coupled scenes, whose works are tiny.

    Parameters
    ----------
    layout
        the scene
    scales
        of a run of the scene, or a first guess
    level
        relative to the scales, at least ``FLOOR``
    near
        the largest step, as a fraction of the time to the next encounter
    """
    level = max(level, FLOOR)
    a = layout.together.asperites
    energy = level * scales.energy
    speed = level * scales.velocity
    q = np.full(layout.coordinates, level * _longest_rod(layout))
    v = np.full(layout.coordinates, speed)
    swing = slice(0, layout.scene.count)
    # An error of a rate matters to the energy by the rate itself, or else by its own square.
    spin = np.maximum(scales.spin, np.sqrt(energy / a.inertia))
    with np.errstate(over="ignore"):  # infinite where a torsion or a rate is tiny
        q[swing] = np.minimum(level, energy / _positive(a.kappa * scales.twist))
        v[swing] = np.minimum(level * scales.rate, energy / _positive(a.inertia * spin))
    turning = a.dof_phi >= 0
    q[a.dof_phi[turning]] = q[swing][turning]
    v[a.dof_phi[turning]] = np.minimum(level * scales.rate, energy / (a.i2[turning] * scales.rate))
    for slots in (a.dof_x, a.dof_y):
        live = slots >= 0
        v[slots[live]] = np.minimum(speed, energy / (a.mass[live] * scales.velocity))
    weights = _account_weights(layout)
    # An impulse whose work is a small difference has no digits beyond its own round-off.
    impulse = level * min(scales.impulse, scales.energy / scales.velocity)
    impulse = max(impulse, FLOOR * scales.impulse)
    s = np.where(weights > 0.0, energy / np.where(weights > 0.0, weights, 1.0), impulse)
    return Tolerance(np.concatenate([q, v]), s, level, near)


def _positive(values: np.ndarray) -> np.ndarray:
    return np.maximum(values, np.finfo(float).tiny)


def first_step(layout: Layout) -> float:
    """The first step: short against the run and the period of every pendulum and oscillator."""
    a = layout.together.asperites
    pendulum = float(np.max(np.sqrt(a.kappa * np.maximum(1.0 / a.inertia, 1.0 / a.i2))))
    fastest = max(pendulum, bath_frequency(layout))
    return min(0.05 / fastest if fastest > 0.0 else np.inf, 1e-3 * layout.scene.duration)


def unit_step(layout: Layout) -> float:
    """The unit of equal steps: the time in which the fastest pendulum turns by one radian."""
    fastest = pendulum_frequency(layout)
    return min(1.0 / fastest if fastest > 0.0 else np.inf, 0.01 * layout.scene.duration)


def kind_of(name: str) -> str:
    """The kind of a quantity, "w1" or "upper.w1"."""
    return KINDS[name.rpartition(".")[2]]
