"""The reported quantities: the kind, the units, the meaning and the formula of each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np

from tribo.kernels.samples import SPRINGS, WITHIN
from tribo.layout.contact_distance import has_contact_distance
from tribo.ledger.forces import FORCES
from tribo.ledger.motion import Motion
from tribo.ledger.totals import AsperiteSeries, Linear, SurfaceSeries, SystemSeries
from tribo.model.scene import Scene
from tribo.model.surface import Surface

Table = Mapping[str, np.ndarray]  # quantity -> its series

# The units of each kind, in the scene's own units of length, time and energy.
UNITS = {
    "angle": "rad",
    "rate": "time^-1",
    "length": "length",
    "velocity": "length time^-1",
    "energy": "energy",
    "force": "force",
    "share": "1",
}


@dataclass(frozen=True)
class Quantity:
    """What a reported quantity is.

    Attributes
    ----------
    kind : str
        A key of `UNITS`; accuracies are relative to one scale per kind.
    long_name : str
        Its meaning in a few words.
    of : callable
        Its series, from some asperites, a surface or the system.
    present : callable
        Whether it can be asked for, of a surface of a scene.
    """

    kind: str
    long_name: str
    of: Callable[..., np.ndarray]
    present: Callable[[Scene, Surface], bool] = lambda scene, surface: True

    @property
    def units(self) -> str:
        """The units of its kind."""
        return UNITS[self.kind]


def _each(value: Callable[[Motion], np.ndarray]) -> Callable[[AsperiteSeries], np.ndarray]:
    return lambda group: group.each(value)


def _accounted(name: str) -> Linear:
    return Linear(lambda group, integrals: group.accounted(integrals, name))


def _summed(name: str) -> Linear:
    return Linear(lambda whole, integrals: whole.summed(integrals, name))


# Of each asperite, in the order in which they are reported.
ASPERITE_QUANTITIES = {
    "theta": Quantity("angle", "pendulum angle", _each(lambda e: e.theta)),
    "phi": Quantity("angle", "bar angle", _each(lambda e: e.phi)),
    "omega": Quantity("rate", "angular velocity of the pendulum", _each(lambda e: e.omega)),
    "nu": Quantity("rate", "angular velocity of the bar", _each(lambda e: e.nu)),
    "x_cm": Quantity("length", "x of the centre of mass", _each(lambda e: e.centre[0])),
    "y_cm": Quantity("length", "y of the centre of mass", _each(lambda e: e.centre[1])),
    "vx_cm": Quantity(
        "velocity", "x velocity of the centre of mass", _each(lambda e: e.velocity[0])
    ),
    "vy_cm": Quantity(
        "velocity", "y velocity of the centre of mass", _each(lambda e: e.velocity[1])
    ),
    "x_bob": Quantity("length", "x of the bob", _each(lambda e: e.bob[0])),
    "y_bob": Quantity("length", "y of the bob", _each(lambda e: e.bob[1])),
    "x_bar": Quantity("length", "x of the bar's centre", _each(lambda e: e.bar[0])),
    "y_bar": Quantity("length", "y of the bar's centre", _each(lambda e: e.bar[1])),
    "w1": Quantity("energy", "work of the contact force", _accounted("w1")),
    "w2": Quantity("energy", "work of the drive", _accounted("w2")),
    "wL": Quantity("energy", "work of the force on the bar's left end", _accounted("wL")),
    "wR": Quantity("energy", "work of the force on the bar's right end", _accounted("wR")),
    "w_int": Quantity("energy", "work of internal forces of the surface", _accounted("w_int")),
    "w": Quantity("energy", "work of all forces", _accounted("w")),
    "w1_ps": Quantity("energy", "pseudowork of the contact force", _accounted("w1_ps")),
    "w2_ps": Quantity("energy", "pseudowork of the drive", _accounted("w2_ps")),
    "w_int_ps": Quantity(
        "energy", "pseudowork of internal forces of the surface", _accounted("w_int_ps")
    ),
    "w_ps": Quantity("energy", "pseudowork of all forces", _accounted("w_ps")),
    "delta_k_trans": Quantity(
        "energy", "change of translational kinetic energy", _each(lambda e: e.kinetic)
    ),
    "delta_e_int": Quantity("energy", "change of internal energy", _each(lambda e: e.internal)),
    "swing_energy": Quantity(
        "energy",
        "internal energy; on driven bars, of the motion about the bar",
        _each(lambda e: e.swinging),
    ),
}
# Of each asperite of a surface with a field.
FIELD_QUANTITIES = {
    "w_field": Quantity("energy", "work of external fields", _accounted("w_field")),
    "w_field_ps": Quantity("energy", "pseudowork of external fields", _accounted("w_field_ps")),
}
# Of each asperite of a surface with a reservoir.
RESERVOIR_QUANTITIES = {
    "w_T": Quantity("energy", "work of the reservoir", _accounted("w_T")),
    "w_T_ps": Quantity("energy", "pseudowork of the reservoir", _accounted("w_T_ps")),
    "heat": Quantity("energy", "heat given to the reservoirs", _accounted("heat")),
}
# Of each asperite of a surface with reservoirs at its bars and on its swings.
SECOND_RESERVOIR_QUANTITIES = {
    "heat_swing": Quantity(
        "energy", "heat given to the reservoir on the swing", _accounted("heat_swing")
    ),
}
OPTIONAL_QUANTITIES = FIELD_QUANTITIES | RESERVOIR_QUANTITIES | SECOND_RESERVOIR_QUANTITIES
# Of each surface as a whole.
BLOCK_QUANTITIES = {
    "W": Quantity("energy", "work of external forces on the surface", Linear(SurfaceSeries.work)),
    "W_ps": Quantity(
        "energy", "pseudowork of external forces on the surface", Linear(SurfaceSeries.pseudowork)
    ),
    "delta_K": Quantity(
        "energy",
        "change of the surface's bulk kinetic energy",
        lambda whole: whole.change_of_kinetic,
    ),
    "delta_E_int": Quantity(
        "energy", "change of the surface's internal energy", lambda whole: whole.change_of_internal
    ),
    "friction_work": Quantity(
        "energy",
        "work against the contact force at the surface's velocity",
        Linear(SurfaceSeries.friction),
    ),
}
# Of the whole system.
SYSTEM_QUANTITIES = {
    "contact_energy": Quantity(
        "energy", "potential energy of contacts between surfaces", SystemSeries.contact_energy
    ),
    "total_energy_change": Quantity(
        "energy", "change of the total energy", SystemSeries.change_of_energy
    ),
    "applied_work": Quantity(
        "energy", "work of drives, ends, reservoirs and moving fields", Linear(SystemSeries.applied)
    ),
}
# Those that have an accuracy.
QUANTITIES = ASPERITE_QUANTITIES | OPTIONAL_QUANTITIES | BLOCK_QUANTITIES | SYSTEM_QUANTITIES


def needs_accounts(name: str) -> bool:
    """Whether a quantity is a work, a pseudowork or the heat."""
    return name in QUANTITIES and isinstance(QUANTITIES[name].of, Linear)


def _force(name: str, axis: int) -> Callable[[SurfaceSeries], np.ndarray]:
    return lambda whole: whole.force(name, axis)


def _along_x(*names: str) -> Callable[[SurfaceSeries], np.ndarray]:
    return lambda whole: whole.force_along_x(*names)


def _has_bath(scene: Scene, surface: Surface) -> bool:
    return bool(surface.bath)


# Of each asperite on request, without an accuracy.
FURTHER_OF_ASPERITES = {
    f"{name}_{along}": Quantity(
        "force", f"{along} of the {force.meaning}", _force(name, axis), force.is_known
    )
    for name, force in FORCES.items()
    for axis, along in enumerate("xy")
} | {
    "k_trans": Quantity("energy", "translational kinetic energy", _each(lambda e: e.translation)),
    "k_swing": Quantity(
        "energy", "kinetic energy of the pendulum's rotation", _each(lambda e: e.energies[0])
    ),
    "k_bar": Quantity(
        "energy", "kinetic energy of the bar's rotation", _each(lambda e: e.energies[1])
    ),
    "e_torsion": Quantity("energy", "energy of the torsion spring", _each(lambda e: e.energies[2])),
}
# Of each surface as a whole, likewise.
FURTHER_OF_SURFACES = {
    "friction_force": Quantity(
        "force", "x of contact and fields on the surface", _along_x("f1", "f_field")
    ),
    "contact_force": Quantity(
        "force", "x of the contact force on the surface", _along_x("f1"), Scene.has_field
    ),
    "field_force": Quantity(
        "force", "x of the fields' force on the surface", _along_x("f_field"), Scene.has_field
    ),
    "pull_force": Quantity(
        "force", "x of the drive's force on the surface", _along_x("f2"), FORCES["f2"].is_known
    ),
    "time_without_contact": Quantity(
        "share",
        "share of time without contact: 1 where no bob is in contact, else 0",
        lambda whole: whole.without_contact,
        has_contact_distance,
    ),
    "e_springs": Quantity(
        "energy",
        "energy of the lattice springs",
        lambda whole: whole.stored(SPRINGS),
        FORCES["f_spring"].acts,
    ),
    "e_within": Quantity(
        "energy",
        "energy of contact within the surface",
        lambda whole: whole.stored(WITHIN),
        Scene.has_contact_within,
    ),
    "k_bath": Quantity(
        "energy", "kinetic energy of the bath", lambda whole: whole.kinetic_of_bath, _has_bath
    ),
    "e_bath": Quantity(
        "energy", "potential energy of the bath", lambda whole: whole.potential_of_bath, _has_bath
    ),
    "heat_bath": Quantity(
        "energy", "heat given to the bath", lambda whole: whole.heat_of_bath, _has_bath
    ),
}
# Those of which the average over time is kept at the end of a run, not the value at that time.
AVERAGED = tuple(name for name, each in FURTHER_OF_SURFACES.items() if each.kind == "force")
# Of the whole system, likewise.
FURTHER_OF_SYSTEM = {
    "field_energy": Quantity(
        "energy",
        "potential energy in fields",
        SystemSeries.field_energy,
        lambda scene, surface: bool(scene.fields),
    )
}
# The groups in ``output.series``.
FURTHER: dict[str, Mapping[str, Quantity]] = {
    "forces": {
        name: each
        for name, each in (FURTHER_OF_ASPERITES | FURTHER_OF_SURFACES).items()
        if each.kind in ("force", "share")
    },
    "energies": {
        name: each
        for name, each in (FURTHER_OF_ASPERITES | FURTHER_OF_SURFACES | FURTHER_OF_SYSTEM).items()
        if each.kind == "energy"
    },
}


def further_series(scene: Scene, surface: Surface) -> frozenset[str]:
    """The names of the series of a surface, and of the system, that the scene's output asks for."""
    groups = (FURTHER.get(name, {}) for name in scene.output.series)
    return frozenset(
        name for group in groups for name, each in group.items() if each.present(scene, surface)
    )


EVERY_QUANTITY = QUANTITIES | FURTHER_OF_ASPERITES | FURTHER_OF_SURFACES | FURTHER_OF_SYSTEM


# The sums over the asperites of a surface, by the names of what is summed.
SUMMED_QUANTITIES = {
    name: Quantity(quantity.kind, f"{quantity.long_name}, all asperites", _summed(name))
    for name, quantity in (ASPERITE_QUANTITIES | OPTIONAL_QUANTITIES).items()
    if needs_accounts(name)
}


@dataclass(frozen=True)
class Reported:
    """The quantities that a scene reports, by name.

    Attributes
    ----------
    asperites, blocks, system : dict
        Of each asperite, of each surface as a whole, and of the system.
    """

    asperites: Mapping[str, Quantity]
    blocks: Mapping[str, Quantity]
    system: Mapping[str, Quantity]


@cache
def reported(
    ledger: str, field: bool, reservoirs: int, further: frozenset[str] = frozenset()
) -> Reported:
    """The quantities that are reported.

    Parameters
    ----------
    ledger : str
        Of what works are kept: "asperites", "surfaces" or "none".
    field : bool
        Whether a field acts on the surface.
    reservoirs : int
        How many reservoirs it has.
    further : frozenset of str
        The names of those that are reported on request.
    """
    usual = _usual(ledger, field, reservoirs)
    asked = (
        {name: each for name, each in table.items() if name in further}
        for table in (FURTHER_OF_ASPERITES, FURTHER_OF_SURFACES, FURTHER_OF_SYSTEM)
    )
    tables = zip((usual.asperites, usual.blocks, usual.system), asked, strict=True)
    return Reported(*({**table, **more} for table, more in tables))


def _usual(ledger: str, field: bool, reservoirs: int) -> Reported:
    """The quantities that are reported without being asked for."""
    own = ASPERITE_QUANTITIES | (FIELD_QUANTITIES if field else {})
    own |= RESERVOIR_QUANTITIES if reservoirs else {}
    own |= SECOND_RESERVOIR_QUANTITIES if reservoirs == 2 else {}
    if ledger == "asperites":
        return Reported(own, BLOCK_QUANTITIES, SYSTEM_QUANTITIES)
    motion, whole, system = (
        {name: each for name, each in table.items() if not needs_accounts(name)}
        for table in (own, BLOCK_QUANTITIES, SYSTEM_QUANTITIES)
    )
    if ledger == "none":
        return Reported(motion, whole, system)
    sums = {name: each for name, each in SUMMED_QUANTITIES.items() if name in own}
    return Reported(motion, BLOCK_QUANTITIES | sums, SYSTEM_QUANTITIES)
