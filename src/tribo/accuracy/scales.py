"""The scales that errors are relative to, and the local tolerances made from them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from tribo.kernels.kinematics import bob_velocity
from tribo.layout.layout import Layout
from tribo.layout.span import Span
from tribo.ledger.ledger import Ledger
from tribo.ledger.motion import Motion, internal_energies, swing_direction
from tribo.ledger.quantities import (
    ASPERITE_QUANTITIES,
    BLOCK_QUANTITIES,
    OPTIONAL_QUANTITIES,
    QUANTITIES,
    SYSTEM_QUANTITIES,
)

# The distance from 1 to the next double.
EPSILON = float(np.finfo(float).eps)
# The kind of every reported quantity, which selects its scale; energies of a surface as a whole and
# of the system have one of their own.
KINDS = {name: quantity.kind for name, quantity in QUANTITIES.items()}
KINDS |= dict.fromkeys(BLOCK_QUANTITIES | SYSTEM_QUANTITIES, "total")
# Energies by which no others are measured: that of contacts has an arbitrary origin, those of
# swings are no changes, and the work against friction is a part of other works.
NOT_MEASURED = ("contact_energy", "swing_energy", "friction_work")
# The quantities of asperites by which rates and energies are measured.
ENERGIES = tuple(
    name
    for name, quantity in (ASPERITE_QUANTITIES | OPTIONAL_QUANTITIES).items()
    if quantity.kind == "energy" and name not in NOT_MEASURED
)
# The works and pseudoworks among them.
WORKS = tuple(name for name in ENERGIES if name.startswith("w"))
# The quantities of surfaces and of the system by which their energies are measured.
TOTALS = tuple(n for n, kind in KINDS.items() if kind == "total" and n not in NOT_MEASURED)
# Energies of a position, with which those of the motion are compared.
POTENTIALS = ("contact_energy", "field_energy")
MEASURED = ("omega", "nu", *ENERGIES, *TOTALS, *POTENTIALS)
# Motion with less energy than this fraction of the energy of contacts and fields is made of
# round-off.  Two rows of five in an equilibrium have works of 1e-15 of that energy, and a total of
# 1e-14.
UNRESOLVED = 256.0 * EPSILON


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
    work
        the largest work or pseudowork of an asperite; no errors are relative to it [energy]
    angle
        1 radian
    """

    rate: float
    length: float
    velocity: float
    energy: float
    total: float
    work: float = 0.0
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
    a = layout.view.together.asperites
    by_kind = motion_scales(
        tops, speed, internal, np.max(a.inertia), np.max(a.mass), layout.scene.count
    )
    scales = {kind: float(x) for kind, x in by_kind.items()}
    return Scales(length=longest_rod(layout), **scales)


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
    works = [tops[name] for name in WORKS if name in tops]
    work = _highest(works or [highest])
    potential = _highest([tops[name] for name in POTENTIALS if name in tops] or [0.0]) / asperites
    measured = np.where(are_lost(work, internal), internal, highest)
    energy = resolved(measured, potential)
    return {
        "rate": resolved(_highest([tops["omega"], tops["nu"]]), np.sqrt(potential / inertia)),
        "velocity": resolved(speed, np.sqrt(potential / mass)),
        "energy": energy,
        "total": _highest([energy, *(tops[name] for name in TOTALS if name in tops)]),
        "work": work if works else np.zeros_like(work),
    }


def are_lost(work: Values, energy: Values) -> np.ndarray:
    """Whether works lie below the rounding of an energy that they change."""
    return ~(work > EPSILON * np.asarray(energy))


def _highest(values: Iterable[Values]) -> np.ndarray:
    return np.asarray(np.max(np.broadcast_arrays(*values), axis=0))


def resolved(measured: Values, possible: Values) -> np.ndarray:
    """What was measured, or what is possible where only round-off was."""
    possible = np.where(np.isfinite(possible), possible, 0.0)
    return np.where(measured > UNRESOLVED * possible, measured, possible)


def mean_velocity(layout: Layout) -> np.ndarray:
    """The mean of the surfaces' initial velocities, (2,)."""
    velocities = np.array([layout.view.velocity_of(k) for k in range(len(layout.parts))])
    return np.asarray(velocities.sum(axis=0) / len(velocities))


def _internal_energy(layout: Layout, ledger: Ledger) -> float:
    """The largest internal energy of an asperite."""
    highest = 0.0
    for surface in layout.scene.surfaces:
        table = ledger.surfaces[surface.name]
        a = layout.asperites[layout.parts[surface.name]]
        twist = table["theta"] - surface.rest - table["phi"]
        swing, bar, spring = internal_energies(a, table["omega"], table["nu"], twist)
        highest = max(highest, largest(swing + bar + spring))
    return highest


def longest_rod(layout: Layout) -> float:
    a = layout.view.together.asperites
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


def fastest_of(span: Span, m: Motion, velocity: np.ndarray) -> float:
    """The largest speed of a bob, where `velocity` are those of the surfaces (2, asperites)."""
    a = span.asperites
    direction = swing_direction(a.facing, m.swing)
    vx, vy = bob_velocity(m.vx + velocity[0], m.vy + velocity[1], m.omega, a.l1, *direction)
    return float(np.max(np.hypot(vx, vy)))


def kind_of(name: str) -> str:
    """The kind of a quantity, "w1" or "upper.w1"."""
    return KINDS[name.rpartition(".")[2]]


def largest(values: np.ndarray) -> float:
    """The largest magnitude; 0 of an empty array."""
    return float(np.max(np.abs(values), initial=0.0))
