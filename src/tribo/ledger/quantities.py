"""The tables of the reported quantities, an entry each; see :mod:`tribo.ledger.quantity`."""

from collections.abc import Mapping
from functools import partial

import numpy as np

from tribo.kernels.samples import SPRINGS, WITHIN
from tribo.ledger import accounts
from tribo.ledger.accounts import APPLIED, EXTERNAL, OfAccounts
from tribo.ledger.forces import FORCES, Has, always
from tribo.ledger.quantity import (
    ANGLE,
    CHANGE,
    ENERGY,
    LENGTH,
    PART,
    POTENTIAL,
    RATE,
    TOTAL,
    VELOCITY,
    Quantity,
    Summary,
    accounted,
    energy,
    moving,
    works_of,
)
from tribo.ledger.separation import has_contact_distance
from tribo.ledger.totals import Linear, Summed, SurfaceSeries, SystemSeries
from tribo.model.scene import Scene
from tribo.model.surface import Surface


def _has_reservoir(scene: Scene, surface: Surface) -> bool:
    return bool(surface.reservoirs)


# Of each asperite, in the order in which they are reported.
ASPERITE_QUANTITIES = {
    "theta": moving("angle", "pendulum angle", lambda e: e.theta, ANGLE),
    "phi": moving("angle", "bar angle", lambda e: e.phi, ANGLE),
    "omega": moving("rate", "angular velocity of the pendulum", lambda e: e.omega, RATE),
    "nu": moving("rate", "angular velocity of the bar", lambda e: e.nu, RATE),
    "x_cm": moving("length", "x of the centre of mass", lambda e: e.centre[0], LENGTH),
    "y_cm": moving("length", "y of the centre of mass", lambda e: e.centre[1], LENGTH),
    "vx_cm": moving(
        "velocity", "x velocity of the centre of mass", lambda e: e.velocity[0], VELOCITY
    ),
    "vy_cm": moving(
        "velocity", "y velocity of the centre of mass", lambda e: e.velocity[1], VELOCITY
    ),
    "x_bob": moving("length", "x of the bob", lambda e: e.bob[0], LENGTH),
    "y_bob": moving("length", "y of the bob", lambda e: e.bob[1], LENGTH),
    "x_bar": moving("length", "x of the bar's centre", lambda e: e.bar[0], LENGTH),
    "y_bar": moving("length", "y of the bar's centre", lambda e: e.bar[1], LENGTH),
    **works_of(
        {
            "w1": "the contact force",
            "w2": "the drive",
            "wL": "the force on the bar's left end",
            "wR": "the force on the bar's right end",
            "w_int": "internal forces of the surface",
            "w": "all forces",
        }
    ),
    "delta_k_trans": moving(
        "energy", "change of translational kinetic energy", lambda e: e.kinetic, CHANGE
    ),
    "delta_e_int": moving("energy", "change of internal energy", lambda e: e.internal, CHANGE),
    "swing_energy": moving(
        "energy",
        "internal energy; on driven bars, of the motion about the bar",
        lambda e: e.swinging,
        ENERGY,
    ),
}
# Of each asperite of a surface with a field, with a reservoir, or with one on its swings.
OPTIONAL_QUANTITIES = {
    **works_of({"w_field": "external fields"}, Scene.has_field),
    **works_of({"w_T": "the reservoir"}, _has_reservoir),
    "heat": accounted(
        OfAccounts(("w_T",), accounts.HEAT),
        "heat given to the reservoirs",
        _has_reservoir,
        CHANGE,
        is_summed=True,
    ),
    "heat_swing": accounted(
        OfAccounts(("w_T",), accounts.HEAT_OF_SWING),
        "heat given to the reservoir on the swing",
        lambda scene, surface: surface.reservoir("swing") is not None,
        CHANGE,
        is_summed=True,
    ),
}
# Of each surface as a whole.
BLOCK_QUANTITIES = {
    "W": energy(
        "work of external forces on the surface",
        Linear(SurfaceSeries.work),
        role=TOTAL,
        terms=OfAccounts(EXTERNAL, accounts.WORK),
        summary=Summary("work", " .6g"),
    ),
    "W_ps": energy(
        "pseudowork of external forces on the surface",
        Linear(SurfaceSeries.pseudowork),
        role=TOTAL,
        terms=OfAccounts(EXTERNAL, accounts.WORK),
        summary=Summary("pseudowork", " .6g"),
    ),
    "delta_K": energy(
        "change of the surface's bulk kinetic energy",
        Summed(lambda whole: whole.change_of_kinetic),
        role=TOTAL,
        summary=Summary("bulk kinetic energy"),
    ),
    "delta_E_int": energy(
        "change of the surface's internal energy",
        Summed(lambda whole: whole.change_of_internal),
        role=TOTAL,
        summary=Summary("internal energy", "+.6g"),
    ),
    "friction_work": energy(
        "minus the initial velocity times the impulse of the contact forces",
        Linear(SurfaceSeries.friction),
        role=PART,
        terms=OfAccounts(("w1",), accounts.BOOST),
    ),
}
# Of the whole system.
SYSTEM_QUANTITIES = {
    "contact_energy": energy(
        "potential energy of contacts between surfaces",
        lambda system: system.samples.contact,
        role=POTENTIAL,
    ),
    "total_energy_change": energy(
        "change of the total energy", Summed(SystemSeries.change_of_energy), role=TOTAL
    ),
    "applied_work": energy(
        "work of drives, ends, reservoirs and moving fields",
        Linear(SystemSeries.applied),
        role=TOTAL,
        terms=OfAccounts(APPLIED, accounts.WORK),
    ),
}
# Those that have an accuracy.
QUANTITIES = ASPERITE_QUANTITIES | OPTIONAL_QUANTITIES | BLOCK_QUANTITIES | SYSTEM_QUANTITIES


def _along_x(force: str, *names: str, present: Has = always) -> Quantity:
    """The x component of the sum of some forces on a surface."""

    def of(whole: SurfaceSeries) -> np.ndarray:
        return np.asarray(np.sum(sum(whole.force(name, 0) for name in names), axis=1))

    return Quantity("force", f"x of {force} on the surface", of, present)


def _is_pulled(scene: Scene, surface: Surface) -> bool:
    return surface.drive.stage is not None


def _has_bath(scene: Scene, surface: Surface) -> bool:
    return bool(surface.bath)


# Of each asperite on request, without an accuracy.
FURTHER_OF_ASPERITES = {
    f"{name}_{along}": Quantity(
        "force",
        f"{along} of the {force.meaning}",
        partial(SurfaceSeries.force, name=name, axis=axis),
        force.is_known,
    )
    for name, force in FORCES.items()
    for axis, along in enumerate("xy")
} | {
    "in_contact": Quantity(
        "share",
        "1 where the bob and one of another surface repel each other, else 0",
        lambda whole: whole.in_contact,
        has_contact_distance,
    ),
    "k_trans": moving("energy", "translational kinetic energy", lambda e: e.translation),
    "k_swing": moving(
        "energy", "kinetic energy of the pendulum's rotation", lambda e: e.energies[0]
    ),
    "k_bar": moving("energy", "kinetic energy of the bar's rotation", lambda e: e.energies[1]),
    "e_torsion": moving("energy", "energy of the torsion spring", lambda e: e.energies[2]),
}
# Of each surface as a whole, likewise.
FURTHER_OF_SURFACES = {
    "friction_force": _along_x("contact and fields", "f1", "f_field"),
    "contact_force": _along_x("the contact force", "f1", present=Scene.has_field),
    "field_force": _along_x("the fields' force", "f_field", present=Scene.has_field),
    "pull_force": _along_x("the drive's force", "f2", present=FORCES["f2"].is_known),
    "time_without_contact": Quantity(
        "share",
        "share of time without contact: 1 where no two bobs repel each other, else 0",
        lambda whole: whole.without_contact,
        has_contact_distance,
    ),
    "normal_force": Quantity(
        "force",
        "contact force on the surface along y, away from what it faces",
        lambda whole: np.sum(whole.normal_forces, axis=1),
    ),
    "load_bearing_share": Quantity(
        "share",
        "share of asperites whose contact force points away from what the surface faces",
        lambda whole: np.mean(whole.normal_forces > 0.0, axis=1),
    ),
    "contact_number": Quantity(
        "number",
        "number of pairs of a bob and one of another surface that repel each other",
        lambda whole: whole.contact_number,
        has_contact_distance,
    ),
    "contact_share": Quantity(
        "share",
        "share of asperites in contact",
        lambda whole: np.mean(whole.in_contact, axis=1),
        has_contact_distance,
    ),
    "e_springs": energy(
        "energy of the lattice springs",
        lambda whole: whole.stored[:, SPRINGS],
        FORCES["f_spring"].acts,
    ),
    "e_within": energy(
        "energy of contact within the surface",
        lambda whole: whole.stored[:, WITHIN],
        Scene.has_contact_within,
    ),
    "k_bath": energy("kinetic energy of the bath", lambda w: w.kinetic_of_bath, _has_bath),
    "e_bath": energy("potential energy of the bath", lambda w: w.potential_of_bath, _has_bath),
    "heat_bath": energy("heat given to the bath", Summed(lambda w: w.heat_of_bath), _has_bath),
}
# Those that follow from the places of bobs alone.
CONTACTS = ("in_contact", "contact_number", "contact_share")
# Of each pulled surface as a whole, without an accuracy.
PULLED_QUANTITIES = {
    "stage_work": energy(
        "work of the stage on the pulling springs",
        Linear(SurfaceSeries.work_of_stage),
        lambda scene, surface: _is_pulled(scene, surface) and scene.output.ledger != "none",
    ),
    "e_pull": energy(
        "energy of the pulling springs", lambda whole: whole.energy_of_pull, _is_pulled
    ),
}
# Those of which the average over time is kept at the end of a run, not the value at that time.
AVERAGED = tuple(
    name
    for name, each in FURTHER_OF_SURFACES.items()
    if each.kind == "force" or name in ("load_bearing_share", *CONTACTS)
)
# Of the whole system, likewise.
FURTHER_OF_SYSTEM = {
    "field_energy": energy(
        "potential energy in fields",
        lambda system: system.samples.field,
        lambda scene, surface: bool(scene.fields),
    )
}
ON_REQUEST = (FURTHER_OF_ASPERITES, FURTHER_OF_SURFACES, FURTHER_OF_SYSTEM)
# Those beside the ones that have an accuracy: of asperites, of surfaces, and of the system.
WITHOUT_ACCURACY = (
    FURTHER_OF_ASPERITES,
    PULLED_QUANTITIES | FURTHER_OF_SURFACES,
    FURTHER_OF_SYSTEM,
)
# What a quantity is of, in this order.
OF = ASPERITE, SURFACE, SYSTEM = ("asperite", "surface", "system")
EVERY_QUANTITY = QUANTITIES | {k: v for table in WITHOUT_ACCURACY for k, v in table.items()}
OF_SYSTEM = frozenset((*SYSTEM_QUANTITIES, *FURTHER_OF_SYSTEM))
# Those that a user has added, see `own_quantity`, and the names of what each is computed from.
OWN_SERIES: dict[str, Quantity] = {}
INPUTS: dict[str, frozenset[str]] = {}


def _on_request(*kinds: str) -> dict[str, Quantity]:
    """The quantities of some kinds that are recorded on request."""
    found: dict[str, Quantity] = {}
    for table in ON_REQUEST:
        found |= {name: each for name, each in table.items() if each.kind in kinds}
    return found


_FORCES = _on_request("force", "share")
# The groups in ``output.series``.
FURTHER: dict[str, Mapping[str, Quantity]] = {
    "forces": {n: each for n, each in _FORCES.items() if n not in CONTACTS},
    "energies": _on_request("energy"),
    "contacts": {n: each for n, each in EVERY_QUANTITY.items() if n in CONTACTS},
    "own": OWN_SERIES,
}
