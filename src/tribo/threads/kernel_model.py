"""The model that kernels read, from the tables of a scene, with the units of its plug-ins."""

from typing import Any

import numpy as np
from numba import config, types

from tribo.compiler.kept import kept_type
from tribo.compiler.lanes import lanes
from tribo.compiler.lanes_memory import room
from tribo.compiler.plugin_methods import type_of
from tribo.compiler.pointers import PointerType, type_of_pointers
from tribo.compiler.team import NO_TEAM, Team
from tribo.compiler.units import WordsInLanesType, WordsType, address_of, memory_of
from tribo.integrators import bath_substep, inactive, kicks, reservoirs, splitting
from tribo.integrators.splitting import Work
from tribo.kernels import (
    baths,
    contact,
    contact_forces,
    encounters,
    equations_of_motion,
    fields,
    neighbours,
    potential_units,
    powers,
    records,
    rigid_block,
    samples,
    speeds,
    user_forces,
)
from tribo.kernels import elastic as body
from tribo.kernels import model as parts
from tribo.kernels.model import Box, Contacts, Customs, Fields, Model, Tables
from tribo.kernels.samples import State
from tribo.layout.contacts import NO_NEIGHBOURS
from tribo.layout.elastic_body import NO_BODIES
from tribo.model.fields import depends_on_time
from tribo.model.identity import plugins_of
from tribo.model.scene import Scene
from tribo.plugins.compile_errors import compiling_units
from tribo.plugins.stamps import code_stamp_of, version_of

# Tables of the kernels that are written, one column an asperite, and their numbers of rows.  In the
# tables of a layout they are True where a loop needs them.
SCRATCH = {
    **dict.fromkeys(("bobs", "directions", "f1", "drive", "inner", "external", "internal"), 2),
    **dict.fromkeys(("displaced", "friction", "left", "right", "bath_momentum"), 2),
    "turned": 2,
    **dict.fromkeys(("swing_friction", "couples"), 1),
}
VECTOR = PointerType(types.float64, 1)
TABLE = PointerType(types.float64, 2)
NO_SPRINGS = parts.Springs(np.recarray(0, records.CHAIN), np.zeros((3, 0)))


def model_of(
    scene: Scene,
    tables: Tables,
    listed: bool = False,
    team: Team | None = None,
    elastic: parts.Elastic = NO_BODIES,
) -> Model:
    """The model of one loop, with scratch that no other loop writes.

    Units of plug-ins are compiled, or loaded from the disk, if they are not known yet.  There are
    lists of neighbours if it is `listed`.  Raises InputError.
    """
    columns = tables.each.shape[1]
    scratch = {
        name: room((count, columns if getattr(tables, name) is not None else 0))
        for name, count in SCRATCH.items()
    }
    contacts = tables.contacts
    acting = tables.fields or ()
    model = Model(
        constants=tables.constants,
        each=tables.each,
        surfaces=tables.surfaces,
        core=tables.core,
        units=_addresses(len(records.UNITS)),
        contacts=_contacts(contacts),
        fields=_fields(acting),
        drives=_customs(tables.drives or ()),
        ends=_customs(tables.ends or ()),
        **scratch,
        found=room((encounters.FOUND,)),
        ledger=tables.ledger is not None,
        sums=tables.sums is not None,
        shared=tables.ledger is not None and _has_shared_accounts(tables.surfaces, acting),
        rigid=bool(np.any(tables.surfaces.drive == records.RIGID)),
        on_bobs=any(scratch[name].size for name in ("inner", "external")),
        on_bars=any(scratch[name].size for name in ("internal", "friction", "left", "right")),
        species=room((0,)) if tables.species is None else tables.species,
        elastic=elastic,
        bodies=bool(np.any(tables.surfaces.elastic > 0)),
        blocks=bool(np.any(tables.surfaces.block > 0)),
        pivots=room((1, 0)) if tables.pivots is None else tables.pivots,
        arms=room((2, 0)) if tables.arms is None else tables.arms,
        box=tables.box or Box(0.0, 0.0),
        springs=tables.springs or NO_SPRINGS,
        bath=room((2, 0)) if tables.bath is None else tables.bath,
        torsional=room((2, 0)) if tables.torsional is None else tables.torsional,
        team=team or NO_TEAM,
        calculators=tables.calculators,
        members=room((0,)) if tables.members is None else tables.members,
        own=room((1, 0)) if tables.own is None else tables.own,
        schedules=_copied(tables.schedules),
    )
    units = Units(scene, model)
    units.set_own(listed)
    for n, each in enumerate(contacts):
        units.set_contact(model.contacts, n, each, team is not None)
    for n, each in enumerate(acting):
        units.set_field(model.fields, n, each.potential)
    for customs, unit, forces in (
        (model.drives, user_forces.custom_drive_unit, tables.drives),
        (model.ends, user_forces.custom_ends_unit, tables.ends),
    ):
        for n, each in enumerate(forces or ()):
            units.set_custom(customs, n, unit, each.plugin)
    return model


def with_own_memory(model: Model) -> Model:
    """The same model, with memory that no other loop writes; but for threads and calculators."""
    used = [name for name in SCRATCH if getattr(model, name).size > 0]
    scratch: Any = {name: room(getattr(model, name).shape) for name in used}
    body = model.elastic
    if model.bodies:
        own = {"grid": room(body.grid.shape), "waves": room(body.waves.shape)}
        body = body._replace(**own, calls=body.calls.copy())
    return model._replace(
        **scratch,
        found=room(model.found.shape),
        units=model.units.copy(),
        surfaces=model.surfaces.copy(),
        schedules=_copied(model.schedules),
        elastic=body,
    )


def _has_shared_accounts(surfaces: Any, fields: tuple[parts.FieldOn, ...]) -> bool:
    """Whether works are kept of surfaces as a whole, of stages, or of moving fields."""
    of_surfaces = np.any(surfaces.acc_block >= 0) or np.any(surfaces.acc_stage >= 0)
    return bool(of_surfaces) or any(each.account >= 0 for each in fields)


class Units:
    """Sets the addresses of a scene's units in its model.  Raises InputError."""

    def __init__(self, scene: Scene, model: Model) -> None:
        self._scene = scene
        self.model = model
        self._model = _kind(model)
        self._neighbours = _kind(NO_NEIGHBOURS)

    def set_own(self, listed: bool) -> None:
        """Those of this package that do not depend on the method."""
        model = self.model
        at = self._model
        energies = types.float64, VECTOR, VECTOR, TABLE, TABLE, types.int64
        bathed = model.bath.size > 0
        turned = model.torsional.size > 0
        own = {
            records.REBUILD: (listed, neighbours.rebuild, (self._neighbours,)),
            records.BATH_FORCES: (bathed, baths.bath_forces, (VECTOR, VECTOR)),
            records.BATH_MOMENTA: (bathed, baths.bath_momenta, (VECTOR,)),
            records.BATH_SAMPLES: (bathed or turned, samples.bath_samples, energies),
            records.TORSIONAL_ACCELERATIONS: (
                turned,
                baths.torsional_accelerations,
                (lanes, VECTOR, VECTOR),
            ),
            records.TORSIONAL_POWERS: (
                turned,
                powers.torsional_powers,
                (lanes, VECTOR, VECTOR, VECTOR),
            ),
            records.JOIN_BLOCKS: (model.blocks, rigid_block.join_blocks, (lanes, VECTOR, VECTOR)),
            records.ELASTIC_FORCES: (model.bodies, body.elastic_forces, ()),
            records.ELASTIC_ENERGIES: (model.bodies, body.elastic_energies, (TABLE, types.int64)),
            records.SHARE_CONTACTS: (
                model.team.counters.size > 0,
                contact_forces.share_contacts,
                (self._neighbours,),
            ),
        }
        _set_units(model, at, own)

    def set_contact(self, contacts: Contacts, n: int, each: parts.Contact, shared: bool) -> None:
        """Those of the nth interaction; with pieces where threads are to share it."""
        known = Known(self._scene, each.potential, each.numbers is not None)
        at = (self._model, self._neighbours, known.kind, types.int64)
        number = types.int64
        is_open = self.model.box == Box(0.0, 0.0) and self.model.species.size == 0
        forces = contact.contact_forces_unit
        pieces = contact_forces.contact_piece_unit
        if self.model.members.size > 0:
            forces = contact.contact_forces_of_members_unit
        elif is_open:
            forces = contact.open_contact_forces_unit
            pieces = contact_forces.open_contact_piece_unit
        contacts.forces[n] = known.unit(forces, at)
        at_distance = known.kind, types.float64, types.float64, types.float64, number
        contacts.energy[n] = known.unit(potential_units.energy_unit, at_distance)
        at_each = known.kind, lanes, types.float64, lanes
        contacts.clearances[n] = known.unit(potential_units.clearances_unit, at_each, lanes)
        if shared:
            contacts.pieces[n] = known.unit(pieces, (*at, number))

    def set_field(self, found: Fields, n: int, potential: Any) -> None:
        """Those of the nth field, which may depend on time."""
        known = Known(self._scene, potential)
        at = self._model, known.kind, types.int64
        units = fields.field_forces_unit, fields.field_energy_unit, powers.field_power_unit
        if depends_on_time(potential):
            units = fields.timed_forces_unit, fields.timed_energy_unit, powers.timed_power_unit
        forces, energy, power = units
        found.forces[n] = known.unit(forces, (*at, lanes))
        found.energy[n] = known.unit(energy, (*at, types.float64, types.int64))
        if found.account[n] >= 0:
            kinds = *at, lanes, VECTOR, types.float64
            found.power[n] = known.unit(power, kinds)

    def set_custom(self, customs: Customs, n: int, unit: Any, plugin: Any) -> None:
        known = Known(self._scene, plugin)
        kinds = self._model, known.kind, types.int64, lanes, VECTOR, VECTOR
        customs.forces[n] = known.unit(unit, kinds)


def set_loop_units(model: Model) -> None:
    """Those of this package that all time loops need."""
    lists = _kind(NO_NEIGHBOURS)
    number = types.int64
    kept = _kind(samples.EXAMPLE_OF_STATE), _kind(samples.EXAMPLE_OF_RECORD)
    own = {
        records.SPEEDS: (
            True,
            speeds.speeds_unit,
            (lists, lanes, VECTOR, VECTOR, TABLE),
        ),
        records.ENCOUNTERS: (True, encounters.encounters_unit, (lists, TABLE, number)),
        records.SAMPLE: (
            True,
            samples.sample_unit,
            (lists, types.float64, *kept, number, number),
        ),
    }
    _set_units(model, _kind(model), own)


def set_rate_units(model: Model) -> None:
    """Those of this package that methods need which are given rates of change."""
    own = {
        records.RATES: (
            True,
            equations_of_motion.rates_unit,
            (_kind(NO_NEIGHBOURS), lanes, VECTOR, VECTOR, VECTOR),
        ),
        records.POWERS: (
            model.ledger,
            powers.powers_unit,
            (lanes, VECTOR, VECTOR, VECTOR),
        ),
    }
    _set_units(model, _kind(model), own)


def set_step_units(model: Model, state: State, work: Any, noise: Any) -> None:
    """Those of this package that splitting methods need, whose argument `noise` is like this."""
    if not isinstance(work, Work):
        return
    at = _kind(model)
    lists = _kind(NO_NEIGHBOURS)
    number = types.float64
    moving = number, _kind(state)
    within = _kind(state), _kind(work)
    step = number, number, *within
    listed = bool(model.units[records.REBUILD])
    customs = len(model.drives.forces) + len(model.ends.forces)
    bathed = model.bath.size + model.torsional.size > 0
    own = {
        records.DRIFT: (True, splitting.drift_unit, (lists, *step)),
        records.KICK: (True, splitting.kick_unit, (lists, types.int64, *step)),
        records.MAKE_LISTS: (listed, inactive.make_lists_unit, (lists, *moving)),
        records.ADVANCE_INACTIVE: (listed, inactive.advance_inactive_unit, (lists, *moving)),
        records.KICK_AROUND: (
            work.substep,
            splitting.kick_around_substep,
            (lists, types.int64, *step, types.int64, _kind_of_noise(noise)),
        ),
        records.ROTATE_BATHS: (
            bathed,
            bath_substep.rotate_baths,
            (number, number, *within, types.int64),
        ),
        records.DAMP: (
            work.before.size > 0,
            reservoirs.damp,
            (number, number, *within, _kind_of_noise(noise)),
        ),
        records.SETTLE_CUSTOM_FORCES: (
            customs > 0,
            kicks.settle_custom_forces,
            (lists, lanes, number, VECTOR, VECTOR, _kind(work)),
        ),
        records.SHARE_STEP: (
            model.team.counters.size > 0,
            splitting.share_step,
            (lists, types.int64, *step),
        ),
    }
    _set_units(model, at, own)


def _set_units(model: Model, at: Any, own: dict[int, tuple[bool, Any, tuple[Any, ...]]]) -> None:
    """Set the units that are needed; none depends on a plug-in."""
    for place, (needed, function, kinds) in own.items():
        if needed:
            model.units[place] = address_of(function, (at, *kinds), "", "")


def _kind(item: Any) -> Any:
    """The type of a tuple that is kept; None where nothing is compiled."""
    return None if config.DISABLE_JIT else kept_type(item)  # type: ignore[attr-defined]


def _kind_of_noise(noise: Any) -> Any:
    """The type of random numbers for kicks: the address of a generator, or deviates."""
    return types.int64 if isinstance(noise, int) else type_of_pointers(noise)


class Known:
    """A plug-in for units: its type, and what tells its code apart."""

    def __init__(self, scene: Scene, plugin: Any, in_lanes: bool = False) -> None:
        self._scene = scene
        self._stamp = code_stamp_of([plugin])
        self._version = version_of([plugin])
        self.kind: Any = None
        if not config.DISABLE_JIT:  # type: ignore[attr-defined]
            self.kind = (WordsInLanesType if in_lanes else WordsType)(type_of(plugin))

    def unit(
        self, function: Any, kinds: tuple[Any, ...], returns: types.Type = types.float64
    ) -> Any:
        """The address of a unit of the plug-in.  Raises InputError."""
        with compiling_units(plugins_of(self._scene)):
            return address_of(function, kinds, self._stamp, self._version, returns)


def _copied(table: np.ndarray) -> np.ndarray:
    """A table in memory of its own."""
    own = room(table.shape)
    own[:] = table
    return own


def _addresses(count: int) -> np.ndarray:
    """Room for addresses, which are functions where nothing is compiled."""
    compiled = not config.DISABLE_JIT  # type: ignore[attr-defined]
    return np.zeros(count, np.int64 if compiled else object)


def _places(parts: list[np.ndarray]) -> np.ndarray:
    """Where each of some parts of an array begins, and where the last one ends."""
    return np.cumsum([0, *map(len, parts)])


def _contacts(contacts: tuple[parts.Contact, ...]) -> Contacts:
    """The arrays of all contacts; addresses of what is compiled are still zero."""
    count = len(contacts)
    memory, numbers = memory_of(tuple(each.potential for each in contacts))
    for n, each in enumerate(contacts):
        if each.numbers is not None and numbers.dtype != object:
            numbers[n] = each.numbers.ctypes.data
    species = [(-1, -1) if each.species is None else each.species for each in contacts]
    return Contacts(
        forces=_addresses(count),
        pieces=_addresses(count),
        energy=_addresses(count),
        clearances=_addresses(count),
        numbers=numbers,
        memory=memory,
        feature=np.array([float(each.potential.feature()[0]) for each in contacts]),
        within=np.array([1 if each.within else 0 for each in contacts]),
        species=np.array(species, np.int64).reshape(-1, 2),
        first=_places([each.pairs for each in contacts]),
        pairs=np.concatenate([each.pairs for each in contacts]),
        rows=np.concatenate([each.rows for each in contacts]),
    )


def _fields(found: tuple[parts.FieldOn, ...]) -> Fields:
    """The arrays of all fields; addresses of what is compiled are still zero."""
    count = len(found)
    memory, numbers = memory_of(tuple(each.potential for each in found))
    none: list[np.ndarray] = [np.empty(0, np.int64)]
    return Fields(
        forces=_addresses(count),
        energy=_addresses(count),
        power=_addresses(count),
        numbers=numbers,
        memory=memory,
        first=_places([each.surfaces for each in found]),
        surfaces=np.concatenate([*none, *(each.surfaces for each in found)]),
        origin=np.array([each.origin for each in found]).reshape(-1, 2),
        velocity=np.array([each.velocity for each in found]).reshape(-1, 2),
        drift=np.array([each.drift for each in found]).reshape(-1, 2),
        account=np.array([each.account for each in found], np.int64),
        modulation=np.array([each.modulation for each in found], np.int64),
        begun=np.array([each.begun for each in found], float),
    )


def _customs(found: tuple[parts.Custom, ...]) -> Customs:
    """The arrays of plug-ins for bars or ends; addresses are still zero."""
    memory, numbers = memory_of(tuple(each.plugin for each in found))
    return Customs(
        forces=_addresses(len(found)),
        numbers=numbers,
        memory=memory,
        surface=np.array([each.surface for each in found], np.int64),
        origin=np.array([each.origin for each in found], float).reshape(-1, 2),
        velocity=np.array([each.velocity for each in found], float).reshape(-1, 2),
        begun=np.array([each.begun for each in found], float),
    )
