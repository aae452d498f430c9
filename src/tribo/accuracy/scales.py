"""The scales that errors are relative to, and the local tolerances made from them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tribo.integrators.step_control import Tolerance
from tribo.kernels.kinematics import bob_velocity
from tribo.kernels.records import OSCILLATOR_FREQUENCY
from tribo.run.layout import Layout
from tribo.run.ledger import Ledger
from tribo.run.motion import Batch, Motion, internal_energy, motions, swing_direction
from tribo.run.quantities import ASPERITE_QUANTITIES, OPTIONAL_QUANTITIES, QUANTITIES
from tribo.run.resolution import pendulum_frequency
from tribo.run.samples import Samples

# The distance from 1 to the next double.
EPSILON = float(np.finfo(float).eps)
# The kind of every reported quantity, which selects its scale.
KINDS = {name: quantity.kind for name, quantity in QUANTITIES.items()}
# The smallest relative tolerance: nine roundings.  Step control cannot resolve less.
FLOOR = 2e-15


@dataclass(frozen=True)
class Scales:
    """One scale for each kind of quantity, which its errors are relative to.

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
    angle
        1 radian
    """

    rate: float
    length: float
    velocity: float
    energy: float
    angle: float = 1.0

    def of(self, kind: str) -> float:
        """The scale of one kind of quantity."""
        return float(getattr(self, kind))


def reported_scales(layout: Layout, ledger: Ledger) -> Scales:
    """The scales of a run's errors: maxima over asperites and samples, in the laboratory."""

    def top(*names: str) -> float:
        return max(largest(series) for name in names for series in ledger.series(name))

    asperite = ASPERITE_QUANTITIES | OPTIONAL_QUANTITIES
    energies = [name for name in asperite if KINDS[name] == "energy" and ledger.series(name)]
    works = [name for name in energies if name.startswith("w")]
    internal = _internal_energy(layout, ledger)
    return Scales(
        rate=top("omega", "nu"),
        length=_longest_rod(layout),
        velocity=_fastest_bob(layout, ledger),
        energy=top(*energies) if top(*works) > EPSILON * internal else internal,
    )


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
    a = layout.asperites
    return float(np.max(a.l1 + a.l2))


def _fastest_bob(layout: Layout, ledger: Ledger) -> float:
    """The largest |v_cm + l1 omega (cos theta, sin theta)|, less the surfaces' mean velocity."""
    mean = np.mean([surface.velocity for surface in layout.scene.surfaces], axis=0)
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
    """The largest speed of a bob of a surface with an initial `velocity` (2,)."""
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
    a = layout.asperites
    relative = _relative_velocity(layout)
    frequency = np.sqrt(a.kappa / a.inertia)
    omega = np.max(np.abs(layout.start[layout.coordinates :][: a.size]))
    velocity = float(np.max(np.hypot(relative[:, 0], relative[:, 1])) + np.max(a.l1) * omega)
    velocity = velocity or float(np.max(frequency * a.l1)) or 1.0
    rate = float(max(omega, largest(a.nu), np.max(frequency), velocity / np.max(a.l1)))
    energy = float(np.max(a.mass)) * velocity**2
    return ToleranceScales(velocity, energy, energy / velocity, rate, rate, 1.0)


def _relative_velocity(layout: Layout) -> np.ndarray:
    """Initial velocity of each asperite relative to the mean of the surfaces' (asperites, 2)."""
    own = layout.velocity - layout.velocity[0]  # exact where all surfaces move fast
    mean = np.mean([own[part.start] for part in layout.parts.values()], axis=0)
    return np.asarray(own - mean)


def tolerance_scales(layout: Layout, samples: Samples) -> ToleranceScales:
    """Scales measured in a run; `first_guess` replaces those that are zero.

    The works are those in the frame of the surfaces' mean velocity.
    """
    guess = first_guess(layout)
    change = spin = turn = twist = highest = 0.0
    velocity, relative = guess.velocity, _relative_velocity(layout)
    for index in range(len(layout.scene.surfaces)):
        for batch, motion in motions(layout, samples, index):
            velocity = max(velocity, _fastest_of(batch, motion, relative[batch.place.start]))
            torsion = motion.swing - motion.phi
            internal = internal_energy(batch.asperites, motion.omega, motion.nu, torsion)
            highest = max(highest, largest(internal))
            change = max(change, largest(internal - internal[0]))
            spin, turn = max(spin, largest(motion.omega)), max(turn, largest(motion.nu))
            twist = max(twist, largest(torsion))
    weights = _account_weights(layout)
    top = np.max(np.abs(samples.s), axis=0, initial=0.0)
    # Works in the laboratory are reported at the scene's times; in between they may be far larger.
    reported = samples.s[np.isin(samples.t, layout.times)]
    work = max(float(np.max(top * weights)), _work_of_impulses(layout, reported))
    # Where nothing does work, the change of an energy is round-off.
    energy = max(work, change) if work > 0.0 else highest
    return ToleranceScales(
        velocity=velocity,
        energy=energy or guess.energy,
        impulse=float(np.max(top[weights == 0.0])) or guess.impulse,
        rate=max(spin, turn) or guess.rate,
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
    a = layout.asperites
    length = a.l1 + a.l2
    for name, offsets in IMPULSES.items():
        present = a[name] >= 0
        for k in offsets:
            weights[(a[name] + k * a.stride)[present]] = 0.0
        for k in WITHOUT_ARM.get(name, ()):
            weights[(a[name] + k * a.stride)[present]] = length[present]
    return weights


def _work_of_impulses(layout: Layout, s: np.ndarray) -> float:
    """The largest V . J of an impulse J, where V is relative to the surfaces' mean velocity."""
    a, velocity = layout.asperites, _relative_velocity(layout)
    highest = 0.0
    for name, offsets in IMPULSES.items():
        present = a[name] >= 0
        stride, (vx, vy) = a.stride[present], velocity[present].T
        for k in offsets[::2]:
            jx, jy = (s[:, a[name][present] + m * stride] for m in (k, k + 1))
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
    a = layout.asperites
    energy = level * scales.energy
    speed = level * scales.velocity
    q = np.full(layout.coordinates, level * _longest_rod(layout))
    v = np.full(layout.coordinates, speed)
    swing = slice(0, a.size)
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
    a = layout.asperites
    fastest = float(np.max(np.sqrt(a.kappa * np.maximum(1.0 / a.inertia, 1.0 / a.i2))))
    for oscillators in (layout.model.bath, layout.model.torsional):
        if oscillators is not None:
            fastest = max(fastest, float(np.max(oscillators[OSCILLATOR_FREQUENCY])))
    return min(0.05 / fastest if fastest > 0.0 else np.inf, 1e-3 * layout.scene.duration)


def unit_step(layout: Layout) -> float:
    """The unit of equal steps: the time in which the fastest pendulum turns by one radian."""
    fastest = pendulum_frequency(layout)
    return min(1.0 / fastest if fastest > 0.0 else np.inf, 0.01 * layout.scene.duration)


def kind_of(name: str) -> str:
    """The kind of a quantity, "w1" or "upper.w1"."""
    return KINDS[name.rpartition(".")[2]]
