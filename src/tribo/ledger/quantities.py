"""The reported quantities: the kind, the scale, the meaning and the formula of each."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np

from tribo.kernels.samples import SPRINGS, WITHIN
from tribo.ledger import accounts
from tribo.ledger.accounts import APPLIED, EXTERNAL, OfAccounts
from tribo.ledger.forces import FORCES, Has, always
from tribo.ledger.motion import Motion
from tribo.ledger.separation import has_contact_distance
from tribo.ledger.totals import (
    AsperiteSeries,
    Linear,
    Moving,
    Summed,
    SurfaceSeries,
    SystemSeries,
)
from tribo.model.scene import Scene
from tribo.model.surface import Surface

Table = Mapping[str, np.ndarray]  # quantity -> its series

# The scale of a quantity that is its own largest value.
OWN = "own"
# The units of each kind, in the scene's own units of length, time and energy.
UNITS = {
    "angle": "rad",
    "rate": "time^-1",
    "length": "length",
    "velocity": "length time^-1",
    "energy": "energy",
    "power": "energy time^-1",
    "force": "force",
    "share": "1",
    "number": "1",
}


class Role(NamedTuple):
    """What the errors of a quantity are relative to, and which scales are its largest values.

    A quantity of the default role has a scale of its own: it changes no bound of another one.
    """

    scale: str = OWN  # of its errors: a field of `tribo.accuracy.scales.Scales`, or OWN
    measures: tuple[str, ...] = ()  # scales that are at least its largest value


OWN_SCALE = Role()
ANGLE = Role("angle")
RATE = Role("rate", ("rate",))
LENGTH = Role("length")
VELOCITY = Role("velocity")
# A work or pseudowork, and a heat or change of energy, of an asperite.
WORK = Role("energy", ("energy", "work"))
CHANGE = Role("energy", ("energy",))
# An energy by which no others are measured: a swing's is no change.
ENERGY = Role("energy")
# The same of a surface or the system; work against friction is a part of other works, and the
# energy of contacts has an arbitrary origin.
TOTAL = Role("total", ("total",))
PART = Role("total")
POTENTIAL = Role("total", ("potential",))


class Summary(NamedTuple):
    """How a quantity stands in the summary of a result."""

    heading: str  # above it in a notebook's table
    form: str = ""  # format of its value in the text; without one the text leaves it out


@dataclass(frozen=True)
class Quantity:
    kind: str  # a key of `UNITS`
    long_name: str  # its meaning in a few words
    of: Callable[..., np.ndarray]  # its series, from some asperites, a surface or the system
    present: Has = always  # whether it can be asked for
    role: Role = OWN_SCALE
    # The sum of terms of accounts whose rounding it has; None where it is no such sum.
    terms: OfAccounts | None = None
    is_summed: bool = False  # whether ensembles keep its sum over the asperites of a surface
    summary: Summary | None = None  # None: results do not show it in their summary

    @property
    def units(self) -> str:
        return UNITS[self.kind]


def _moving(
    kind: str, long_name: str, value: Callable[[Motion], np.ndarray], role: Role = OWN_SCALE
) -> Quantity:
    return Quantity(kind, long_name, Moving(value), role=role)


def _accounted(
    terms: OfAccounts,
    long_name: str,
    present: Has = always,
    role: Role = WORK,
    is_summed: bool = False,
) -> Quantity:
    """An energy of each asperite that is linear in the accounts of forces."""
    of = Linear(partial(AsperiteSeries.accounted, quantity=terms))
    return _energy(long_name, of, present, role, terms=terms, is_summed=is_summed)


def _works(agents: Mapping[str, str], present: Has = always) -> dict[str, Quantity]:
    """The works of agents, and behind them the pseudoworks but those of single ends."""
    works: dict[str, Quantity] = {}
    pseudoworks: dict[str, Quantity] = {}
    for name, agent in agents.items():
        is_total = name not in accounts.FORCES
        forces = tuple(accounts.FORCES) if is_total else (name,)
        work = OfAccounts(forces, accounts.WORK)
        pseudowork = OfAccounts(forces, accounts.PSEUDOWORK)
        works[name] = _accounted(work, f"work of {agent}", present, is_summed=not is_total)
        if name not in ("wL", "wR"):
            pseudoworks[f"{name}_ps"] = _accounted(pseudowork, f"pseudowork of {agent}", present)
    return works | pseudoworks


def _has_reservoir(scene: Scene, surface: Surface) -> bool:
    return bool(surface.reservoirs)


def _energy(
    long_name: str,
    of: Callable[..., np.ndarray],
    present: Has = always,
    role: Role = OWN_SCALE,
    **others: Any,
) -> Quantity:
    return Quantity("energy", long_name, of, present, role, **others)


# Of each asperite, in the order in which they are reported.
ASPERITE_QUANTITIES = {
    "theta": _moving("angle", "pendulum angle", lambda e: e.theta, ANGLE),
    "phi": _moving("angle", "bar angle", lambda e: e.phi, ANGLE),
    "omega": _moving("rate", "angular velocity of the pendulum", lambda e: e.omega, RATE),
    "nu": _moving("rate", "angular velocity of the bar", lambda e: e.nu, RATE),
    "x_cm": _moving("length", "x of the centre of mass", lambda e: e.centre[0], LENGTH),
    "y_cm": _moving("length", "y of the centre of mass", lambda e: e.centre[1], LENGTH),
    "vx_cm": _moving(
        "velocity", "x velocity of the centre of mass", lambda e: e.velocity[0], VELOCITY
    ),
    "vy_cm": _moving(
        "velocity", "y velocity of the centre of mass", lambda e: e.velocity[1], VELOCITY
    ),
    "x_bob": _moving("length", "x of the bob", lambda e: e.bob[0], LENGTH),
    "y_bob": _moving("length", "y of the bob", lambda e: e.bob[1], LENGTH),
    "x_bar": _moving("length", "x of the bar's centre", lambda e: e.bar[0], LENGTH),
    "y_bar": _moving("length", "y of the bar's centre", lambda e: e.bar[1], LENGTH),
    **_works(
        {
            "w1": "the contact force",
            "w2": "the drive",
            "wL": "the force on the bar's left end",
            "wR": "the force on the bar's right end",
            "w_int": "internal forces of the surface",
            "w": "all forces",
        }
    ),
    "delta_k_trans": _moving(
        "energy", "change of translational kinetic energy", lambda e: e.kinetic, CHANGE
    ),
    "delta_e_int": _moving("energy", "change of internal energy", lambda e: e.internal, CHANGE),
    "swing_energy": _moving(
        "energy",
        "internal energy; on driven bars, of the motion about the bar",
        lambda e: e.swinging,
        ENERGY,
    ),
}
# Of each asperite of a surface with a field, with a reservoir, or with one on its swings.
OPTIONAL_QUANTITIES = {
    **_works({"w_field": "external fields"}, Scene.has_field),
    **_works({"w_T": "the reservoir"}, _has_reservoir),
    "heat": _accounted(
        OfAccounts(("w_T",), accounts.HEAT),
        "heat given to the reservoirs",
        _has_reservoir,
        CHANGE,
        is_summed=True,
    ),
    "heat_swing": _accounted(
        OfAccounts(("w_T",), accounts.HEAT_OF_SWING),
        "heat given to the reservoir on the swing",
        lambda scene, surface: surface.reservoir("swing") is not None,
        CHANGE,
        is_summed=True,
    ),
}
# Of each surface as a whole.
BLOCK_QUANTITIES = {
    "W": _energy(
        "work of external forces on the surface",
        Linear(SurfaceSeries.work),
        role=TOTAL,
        terms=OfAccounts(EXTERNAL, accounts.WORK),
        summary=Summary("work", " .6g"),
    ),
    "W_ps": _energy(
        "pseudowork of external forces on the surface",
        Linear(SurfaceSeries.pseudowork),
        role=TOTAL,
        terms=OfAccounts(EXTERNAL, accounts.WORK),
        summary=Summary("pseudowork", " .6g"),
    ),
    "delta_K": _energy(
        "change of the surface's bulk kinetic energy",
        Summed(lambda whole: whole.change_of_kinetic),
        role=TOTAL,
        summary=Summary("bulk kinetic energy"),
    ),
    "delta_E_int": _energy(
        "change of the surface's internal energy",
        Summed(lambda whole: whole.change_of_internal),
        role=TOTAL,
        summary=Summary("internal energy", "+.6g"),
    ),
    "friction_work": _energy(
        "minus the initial velocity times the impulse of the contact forces",
        Linear(SurfaceSeries.friction),
        role=PART,
        terms=OfAccounts(("w1",), accounts.BOOST),
    ),
}
# Of the whole system.
SYSTEM_QUANTITIES = {
    "contact_energy": _energy(
        "potential energy of contacts between surfaces",
        lambda system: system.samples.contact,
        role=POTENTIAL,
    ),
    "total_energy_change": _energy(
        "change of the total energy", Summed(SystemSeries.change_of_energy), role=TOTAL
    ),
    "applied_work": _energy(
        "work of drives, ends, reservoirs and moving fields",
        Linear(SystemSeries.applied),
        role=TOTAL,
        terms=OfAccounts(APPLIED, accounts.WORK),
    ),
}
# Those that have an accuracy.
QUANTITIES = ASPERITE_QUANTITIES | OPTIONAL_QUANTITIES | BLOCK_QUANTITIES | SYSTEM_QUANTITIES


def needs_accounts(name: str) -> bool:
    """Whether a quantity is a work, a pseudowork or the heat, which not all ledgers have."""
    return name in EVERY_QUANTITY and isinstance(EVERY_QUANTITY[name].of, Linear)


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
    "k_trans": _moving("energy", "translational kinetic energy", lambda e: e.translation),
    "k_swing": _moving(
        "energy", "kinetic energy of the pendulum's rotation", lambda e: e.energies[0]
    ),
    "k_bar": _moving("energy", "kinetic energy of the bar's rotation", lambda e: e.energies[1]),
    "e_torsion": _moving("energy", "energy of the torsion spring", lambda e: e.energies[2]),
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
    "e_springs": _energy(
        "energy of the lattice springs",
        lambda whole: whole.stored[:, SPRINGS],
        FORCES["f_spring"].acts,
    ),
    "e_within": _energy(
        "energy of contact within the surface",
        lambda whole: whole.stored[:, WITHIN],
        Scene.has_contact_within,
    ),
    "k_bath": _energy("kinetic energy of the bath", lambda w: w.kinetic_of_bath, _has_bath),
    "e_bath": _energy("potential energy of the bath", lambda w: w.potential_of_bath, _has_bath),
    "heat_bath": _energy("heat given to the bath", Summed(lambda w: w.heat_of_bath), _has_bath),
}
# Those that follow from the places of bobs alone.
CONTACTS = ("in_contact", "contact_number", "contact_share")
# Of each pulled surface as a whole, without an accuracy.
PULLED_QUANTITIES = {
    "stage_work": _energy(
        "work of the stage on the pulling springs",
        Linear(SurfaceSeries.work_of_stage),
        lambda scene, surface: _is_pulled(scene, surface) and scene.output.ledger != "none",
    ),
    "e_pull": _energy(
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
    "field_energy": _energy(
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


def present_names(scene: Scene, surface: Surface) -> frozenset[str]:
    """The optional quantities that a scene reports, and the series that its output asks for."""
    found = built_in_names(scene, surface)
    if "own" not in scene.output.series:
        return found
    return found.union(n for n, each in OWN_SERIES.items() if each.present(scene, surface))


def with_inputs(names: Collection[str]) -> frozenset[str]:
    """Names of quantities, and of those from which the user's own ones are computed."""
    return frozenset(names).union(*(INPUTS.get(name, ()) for name in names))


def built_in_names(scene: Scene, surface: Surface) -> frozenset[str]:
    """The same without those of the user."""
    asked = (FURTHER.get(name, {}) for name in scene.output.series if name != "own")
    groups = (OPTIONAL_QUANTITIES, PULLED_QUANTITIES, *asked)
    return frozenset(
        name for group in groups for name, each in group.items() if each.present(scene, surface)
    )


# The sums over the asperites of a surface, by the names of what is summed.
SUMMED_QUANTITIES = {
    name: _energy(
        f"{quantity.long_name}, all asperites",
        Linear(partial(SurfaceSeries.summed, quantity=quantity.terms)),
        is_summed=quantity.is_summed,
    )
    for name, quantity in (ASPERITE_QUANTITIES | OPTIONAL_QUANTITIES).items()
    if quantity.terms is not None
}


def quantity_of(name: str, whole: bool) -> Quantity:
    """A quantity by its name; works of a `whole` surface are sums over its asperites."""
    summed = SUMMED_QUANTITIES.get(name) if whole else None
    return summed or EVERY_QUANTITY[name]


@dataclass(frozen=True)
class Reported:
    """The quantities that a scene reports: of asperites, of surfaces as wholes, of the system."""

    asperites: Mapping[str, Quantity]
    blocks: Mapping[str, Quantity]
    system: Mapping[str, Quantity]


@cache
def reported(ledger: str, present: frozenset[str]) -> Reported:
    """The quantities with works kept as `ledger` says, and others whose names are `present`."""
    own = ASPERITE_QUANTITIES | _those_of(OPTIONAL_QUANTITIES, present)
    tables = [own, BLOCK_QUANTITIES, SYSTEM_QUANTITIES]
    if ledger == "surfaces":
        sums = _those_of(SUMMED_QUANTITIES, own.keys())
        tables = [_without_accounts(own), BLOCK_QUANTITIES | sums, SYSTEM_QUANTITIES]
    elif ledger == "none":
        tables = list(map(_without_accounts, tables))
    asked = (_those_of(table, present) for table in WITHOUT_ACCURACY)
    return Reported(*(table | more for table, more in zip(tables, asked, strict=True)))


def _those_of(table: Mapping[str, Quantity], names: Collection[str]) -> dict[str, Quantity]:
    return {name: each for name, each in table.items() if name in names}


def _without_accounts(table: Mapping[str, Quantity]) -> dict[str, Quantity]:
    return {name: each for name, each in table.items() if not needs_accounts(name)}
