"""The units that a model needs: those of its plug-ins, of its effects, and of its method."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numba import config, types

from tribo.compiler.helpers import compile_together
from tribo.compiler.jit import LoopJob
from tribo.compiler.kept import kept_type
from tribo.compiler.lanes import lanes
from tribo.compiler.plugin_methods import type_of
from tribo.compiler.pointers import PointerType, type_of_pointers
from tribo.compiler.units import UnitJob, WordsInLanesType, WordsType
from tribo.integrators import bath_substep, inactive, kicks, reservoirs, splitting
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
from tribo.model.fields import depends_on_time
from tribo.model.identity import plugins_of
from tribo.model.scene import Scene
from tribo.plugins.compile_errors import compiling_units
from tribo.plugins.stamps import code_stamp_of, version_of

VECTOR = PointerType(types.float64, 1)
TABLE = PointerType(types.float64, 2)


class Wanted(NamedTuple):
    """A unit whose address belongs at a place in an array."""

    array: np.ndarray
    place: int
    job: UnitJob
    plugins: Any = ()  # of the scene, each with its field, for messages of errors


def fulfil(wanted: Sequence[Wanted], loop: Callable[[], LoopJob] | None = None) -> None:
    """Compile units, or load them from disk, and set their addresses.

    If some must be compiled, the time loop that calls them is compiled beside them.  Raises
    InputError if a plug-in does not compile.
    """
    missing = [each.job for each in wanted if each.job.is_missing()]
    if missing:
        compile_together([*([] if loop is None else [loop()]), *missing])
    for each in wanted:
        with compiling_units(each.plugins):
            each.array[each.place] = each.job.address()


def units_of(scene: Scene, tables: Tables, model: Model, listed: bool) -> list[Wanted]:
    """The units that a model needs for any method: those of its plug-ins and effects.

    It is the model of these tables, with lists of neighbours if it is `listed`.
    """
    units = Units(scene, model)
    for n, each in enumerate(tables.contacts):
        units.add_contact(model.contacts, n, each)
    for n, each in enumerate(tables.fields or ()):
        units.add_field(model.fields, n, each.potential)
    for n, each in enumerate(tables.drives or ()):
        units.add_custom(model.drives, n, user_forces.custom_drive_unit, each.plugin)
    for n, each in enumerate(tables.ends or ()):
        units.add_custom(model.ends, n, user_forces.custom_ends_unit, each.plugin)
    return [*effect_units(model, listed), *units.wanted]


def effect_units(model: Model, listed: bool) -> list[Wanted]:
    """Those of the effects of a scene, and of threads."""
    lists = _kind(NO_NEIGHBOURS)
    energies = types.float64, VECTOR, VECTOR, TABLE, TABLE, types.int64
    bathed = model.bath.size > 0
    turned = model.torsional.size > 0
    own = {
        records.REBUILD: (listed, neighbours.rebuild, (lists,)),
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
            (lists,),
        ),
    }
    return _of_package(model, own)


class Units:
    """Finds the units of a scene's plug-ins that its model needs."""

    def __init__(self, scene: Scene, model: Model) -> None:
        self._plugins = plugins_of(scene)
        self._is_open = model.box == Box(0.0, 0.0) and model.species.size == 0
        self._of_members = model.members.size > 0
        self._is_shared = model.team.counters.size > 0
        self._model = _kind(model)
        self._neighbours = _kind(NO_NEIGHBOURS)
        self.wanted: list[Wanted] = []

    def _add(self, array: np.ndarray, n: int, job: UnitJob) -> None:
        self.wanted.append(Wanted(array, n, job, self._plugins))

    def add_contact(self, contacts: Contacts, n: int, each: parts.Contact) -> None:
        """Those of the nth interaction; with pieces where threads are to share it."""
        known = Known(each.potential, each.numbers is not None)
        at = (self._model, self._neighbours, known.kind, types.int64)
        number = types.int64
        forces = contact.contact_forces_unit
        pieces = contact_forces.contact_piece_unit
        if self._of_members:
            forces = contact.contact_forces_of_members_unit
        elif self._is_open:
            forces = contact.open_contact_forces_unit
            pieces = contact_forces.open_contact_piece_unit
        self._add(contacts.forces, n, known.job(forces, at))
        at_distance = known.kind, types.float64, types.float64, types.float64, number
        self._add(contacts.energy, n, known.job(potential_units.energy_unit, at_distance))
        at_each = known.kind, lanes, types.float64, lanes
        clearances = known.job(potential_units.clearances_unit, at_each, lanes)
        self._add(contacts.clearances, n, clearances)
        if self._is_shared:
            self._add(contacts.pieces, n, known.job(pieces, (*at, number)))

    def add_field(self, found: Fields, n: int, potential: Any) -> None:
        """Those of the nth field, which may depend on time."""
        known = Known(potential)
        at = self._model, known.kind, types.int64
        units = fields.field_forces_unit, fields.field_energy_unit, powers.field_power_unit
        if depends_on_time(potential):
            units = fields.timed_forces_unit, fields.timed_energy_unit, powers.timed_power_unit
        forces, energy, power = units
        self._add(found.forces, n, known.job(forces, (*at, lanes)))
        self._add(found.energy, n, known.job(energy, (*at, types.float64, types.int64)))
        if found.account[n] >= 0:
            kinds = *at, lanes, VECTOR, types.float64
            self._add(found.power, n, known.job(power, kinds))

    def add_custom(self, customs: Customs, n: int, unit: Any, plugin: Any) -> None:
        """That of the nth force on bars or their ends."""
        known = Known(plugin)
        kinds = self._model, known.kind, types.int64, lanes, VECTOR, VECTOR
        self._add(customs.forces, n, known.job(unit, kinds))


def loop_units(model: Model) -> list[Wanted]:
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
    return _of_package(model, own)


def rate_units(model: Model) -> list[Wanted]:
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
    return _of_package(model, own)


def step_units(model: Model, state: State, work: Any, noise: Any, listed: bool) -> list[Wanted]:
    """Those of this package that splitting methods need, whose argument `noise` is like this.

    There are lists of neighbours if it is `listed`.
    """
    lists = _kind(NO_NEIGHBOURS)
    number = types.float64
    moving = number, _kind(state)
    within = _kind(state), _kind(work)
    step = number, number, *within
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
    return _of_package(model, own)


def _of_package(model: Model, own: dict[int, tuple[bool, Any, tuple[Any, ...]]]) -> list[Wanted]:
    """The units that are needed, none of which depends on a plug-in."""
    at = _kind(model)
    return [
        Wanted(model.units, place, UnitJob(function, (at, *kinds)))
        for place, (needed, function, kinds) in own.items()
        if needed
    ]


def _kind(item: Any) -> Any:
    """The type of a tuple that is kept; None where nothing is compiled."""
    return None if config.DISABLE_JIT else kept_type(item)  # type: ignore[attr-defined]


def _kind_of_noise(noise: Any) -> Any:
    """The type of random numbers for kicks: the address of a generator, or deviates."""
    return types.int64 if isinstance(noise, int) else type_of_pointers(noise)


class Known:
    """A plug-in for units: its type, and what tells its code apart."""

    def __init__(self, plugin: Any, in_lanes: bool = False) -> None:
        self._stamp = code_stamp_of([plugin])
        self._version = version_of([plugin])
        self.kind: Any = None
        if not config.DISABLE_JIT:  # type: ignore[attr-defined]
            self.kind = (WordsInLanesType if in_lanes else WordsType)(type_of(plugin))

    def job(
        self, function: Any, kinds: tuple[Any, ...], returns: types.Type = types.float64
    ) -> UnitJob:
        """A unit of the plug-in."""
        return UnitJob(function, kinds, self._stamp, self._version, returns)
