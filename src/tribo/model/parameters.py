"""Values of a scene by dotted keys, as "upper.asperite.kappa" and "interaction.strength".

The keys are those of scene files, with the name of a surface in place of its number:

    duration, seed, title, output.KEY, numerics.KEY, periodic.KEY
    SURFACE.theta (and the other initial values), SURFACE.velocity, SURFACE.bob, SURFACE.drive, ...
    SURFACE.bob.1           one of two numbers, 0 along x or 1 along y; also of velocity, spacing
    SURFACE.asperite.KEY, and the same for drive, langevin, bath and springs
    SURFACE.drive.speed.1.0     of a schedule: time (0) or value (1) of a point, from 0 on; mean,
                            amplitude, period or phase of a sine
    SURFACE.langevin.bar.KEY, SURFACE.langevin.swing.KEY    where a surface has both reservoirs
    interaction.KEY, field.KEY      where the scene has one interaction, or one field
    interaction.first.KEY, interaction.of.KEY               of parts of sums, of scaled potentials

The key of a part without a KEY, as SURFACE.asperite or output, takes the table of the whole part.
A star in place of the name of a surface means all surfaces; `tribo.model.binding` has its rules.
"""

import operator
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from tribo.model.asperite import Asperite
from tribo.model.bath import Bath, as_bath
from tribo.model.bath import as_table as bath_table
from tribo.model.binding import bound
from tribo.model.drive_tables import as_drive
from tribo.model.drive_tables import as_table as drive_table
from tribo.model.elastic import as_elastic
from tribo.model.fields import Field
from tribo.model.initial import Initial
from tribo.model.keys import (
    FIELD,
    INITIAL,
    INTERACTION,
    OF_FIELD,
    OF_SCENE,
    OF_SURFACE,
    OF_TWO,
    PARTS_OF_SCENE,
    WITHOUT_POINT,
    keys_of_surface,
    meant_key,
    parts_of,
    parts_of_scene,
    unknown_key,
    values_of_only,
)
from tribo.model.langevin import PLACES, as_langevin
from tribo.model.own_drive import Custom
from tribo.model.scene import Scene
from tribo.model.schedule import Schedule, component_of, with_component
from tribo.model.springs import as_springs
from tribo.model.surface import Surface
from tribo.model.tables import changed, from_table, table_of
from tribo.plugins.classes import instance
from tribo.potentials import by_key
from tribo.validation import InputError, inside, is_list, known_keys, number

# What reads a part of a surface from its table, or from a word.
READ: dict[str, Any] = {"drive": as_drive, "bath": as_bath}
READ |= {"langevin": as_langevin, "springs": as_springs, "elastic": as_elastic}
READ |= {"asperite": partial(from_table, Asperite), "initial": partial(from_table, Initial)}


def is_parameter(scene: Scene, key: str) -> bool:
    """Whether one number may take the place of what a key names.

    That is a number of a part of a surface, of the interaction or of the field, or a parameter of
    asperites, also where each of them has its own.
    """
    part, _, parameter = key.partition(".")
    if part in (INTERACTION, FIELD):
        return _is_number(values_of_only(scene, part).get(parameter))
    if (point := _point(scene, key)) is not None:
        return component_of(point.present, point.place) is not None
    name, _, parameter = key.rpartition(".")
    surface, _, part = name.partition(".")
    found = scene.surface_named(surface)
    if found is None or part not in parts_of(found):
        return False
    without_load = key.endswith(".drive.load") and found.drive.load is None
    value = _value_of_part(found, part, parameter)
    of_each = part == "asperite" and isinstance(value, np.ndarray)
    return without_load or of_each or _is_number(value)


def with_values(scene: Scene, values: Mapping[str, Any]) -> Scene:
    """The scene with other values by keys; a number sets a velocity's x.  Raises InputError."""
    of_parts: dict[str, dict[str, Any]] = {}
    known = parts_of_scene(scene)
    for key, value in _whole(scene, bound(scene, values)).items():
        part, _, name = key.rpartition(".")
        outer, _, inner = key.partition(".")
        if outer in (INTERACTION, FIELD) and inner:
            part = outer
            name = inner
        if part not in known or (part == outer and not _has_one(scene, part)):
            raise unknown_key(scene, key)
        of_parts.setdefault(part, {})[name] = value
    whole = of_parts.pop("", {})
    for name in whole:
        if name not in WITHOUT_POINT:
            raise unknown_key(scene, name)
    own = {name: whole[name] for name in OF_SCENE if name in whole}
    for part in PARTS_OF_SCENE:
        if part in whole or part in of_parts:
            own[part] = _changed_settings(scene, part, whole, of_parts.get(part, {}))
    changed_names = {part.partition(".")[0] for part in of_parts}
    surfaces = tuple(
        _changed_surface(surface, of_parts) if surface.name in changed_names else surface
        for surface in scene.surfaces
    )
    if any(map(operator.is_not, surfaces, scene.surfaces)):
        own["surfaces"] = surfaces
    for part, name in ((INTERACTION, "interactions"), (FIELD, "fields")):
        if part in whole:
            own[name] = whole[part]
    if whole.keys() & {INTERACTION, FIELD}:  # of which parts may change too
        scene = replace(scene, **own)
        own = {}
    if INTERACTION in of_parts:
        (interaction,) = scene.interactions
        with inside(INTERACTION):
            potential = by_key.with_values(interaction.potential, of_parts[INTERACTION])
            own["interactions"] = (replace(interaction, potential=potential),)
    if FIELD in of_parts:
        with inside(FIELD):
            own["fields"] = (_changed_field(scene.fields[0], of_parts[FIELD]),)
    return replace(scene, **own) if own else scene


def _has_one(scene: Scene, part: str) -> bool:
    """Whether a part of keys, if it is `interaction` or `field`, is one of the scene.

    A surface may have its name.
    """
    items = {INTERACTION: scene.interactions, FIELD: scene.fields}
    return len(items.get(part, (None,))) == 1


def component(key: str) -> tuple[str, int] | None:
    """The key of two numbers and the place of one of them, of a key as "upper.bob.1"; else None."""
    whole, _, place = key.rpartition(".")
    is_one = place in ("0", "1") and whole.rpartition(".")[2] in OF_TWO and whole.count(".") == 1
    return (whole, int(place)) if is_one else None


def _whole(scene: Scene, values: Mapping[str, Any]) -> dict[str, Any]:
    """The values with both numbers in place of a key of one of them.  Raises InputError."""
    found: dict[str, Any] = {}
    for key, value in values.items():
        point = _point(scene, key)
        if point is not None:
            _set_point(found, values, key, point, value)
            continue
        one = component(key)
        name, _, of = (key if one is None else one[0]).partition(".")
        surface = scene.surface_named(name)
        if one is None or surface is None:
            found[key] = value
            continue
        whole, place = one
        if whole in values:
            raise InputError(key, f"cannot go with {whole}; give one or the other")
        both = list(found.get(whole, getattr(surface, of)))
        both[place] = number(key, value)
        found[whole] = tuple(both)
    return found


class _Point(NamedTuple):
    """A number of a schedule in a part of a surface, as of "upper.drive.speed.1.0"."""

    whole: str  # the key of the number that follows the schedule
    both: tuple[Any, Any] | None  # of a push, of which `axis` follows it
    axis: int
    present: Any  # the schedule
    place: list[str]  # in the schedule


def _point(scene: Scene, key: str) -> _Point | None:
    """The number of a schedule that a key names; None of any other key."""
    name, _, inner = key.partition(".")
    surface = scene.surface_named(name)
    for part in () if surface is None else parts_of(surface):
        whole, _, rest = inner.removeprefix(f"{part}.").partition(".")
        if not (inner.startswith(f"{part}.") and rest):
            continue
        assert surface is not None
        present = _value_of_part(surface, part, whole)
        place = rest.split(".")
        both = None
        axis = 0
        if isinstance(present, tuple) and place[0] in ("0", "1"):
            both = present
            axis = int(place.pop(0))
            present = both[axis]
        if isinstance(present, Schedule):
            return _Point(f"{name}.{part}.{whole}", both, axis, present, place)
    return None


def _set_point(
    found: dict[str, Any], values: Mapping[str, Any], key: str, point: _Point, value: Any
) -> None:
    """Set a number of a schedule in `found`, where others of it may have been set."""
    whole = point.whole
    for other in (whole, whole.rpartition(".")[0]):
        if other in values:
            raise InputError(key, f"cannot go with {other}; give one or the other")
    with inside(whole if point.both is None else f"{whole}.{point.axis}"):
        if point.both is None:
            found[whole] = with_component(found.get(whole, point.present), point.place, value)
            return
        both = list(found.get(whole, point.both))
        both[point.axis] = with_component(both[point.axis], point.place, value)
        found[whole] = tuple(both)


def value_of(scene: Scene, key: str) -> object:
    """The value of a key as in a file, or None; of a velocity its x, of a drive its kind."""
    outer, _, inner = key.partition(".")
    if outer in (INTERACTION, FIELD) and "." in inner:
        return values_of_only(scene, outer).get(inner)
    if (point := _point(scene, key)) is not None:
        return component_of(point.present, point.place)
    if (one := component(key)) is not None:
        whole, place = one
        name, _, of = whole.partition(".")
        surface = scene.surface_named(name)
        return None if surface is None else getattr(surface, of)[place]
    part, _, name = key.rpartition(".")
    table = scene.to_table()
    if part in (INTERACTION, FIELD):
        items = table.get(part, [])
        return items[0].get(name) if len(items) == 1 else None
    if part in ("", *PARTS_OF_SCENE):
        return (table.get(part, {}) if part else table).get(name)
    value = _value_in(table, part, name)
    if name == "velocity" and isinstance(value, list):
        return value[0]
    return value.get("kind") if name == "drive" and isinstance(value, dict) else value


def _value_in(table: Mapping[str, Any], part: str, name: str) -> Any:
    """The value of a surface, or of a part of it as "upper.langevin.bar", in a table; or None."""
    surface, _, inner = part.partition(".")
    own: dict[str, Any] = next((s for s in table["surface"] if s["name"] == surface), {})
    inner, _, on = inner.partition(".")
    values: Any = own.get(inner) if inner else own.get("initial", {}) | own
    if on:
        both = isinstance(values, list) and on in PLACES
        values = values[list(PLACES).index(on)] if both else None
    return values.get(name) if isinstance(values, dict) else None


def _changed_settings(
    scene: Scene, part: str, whole: Mapping[str, Any], own: dict[str, Any]
) -> Any:
    """The output, numerics or periods with other values; what one excludes is replaced."""
    present = getattr(scene, part)
    own = dict(own)
    if part in whole:
        with inside(part):
            present = from_table(PARTS_OF_SCENE[part], whole[part])
    for one, other in (("accuracy", "step"), ("step", "accuracy"), ("samples", "times")):
        if part != "periodic" and one in own:
            own = {other: None} | own
    own = {key: value for key, value in own.items() if value is not None or hasattr(present, key)}
    with inside(part):
        return changed(present, own)


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _value_of_part(surface: Surface, part: str, name: str) -> object:
    """The value of a key of a part, as "drive" or "langevin.bar"; None if it is absent."""
    key, _, on = part.partition(".")
    present = getattr(surface, key)
    values = dict[str, Any]()
    if on:
        present = present[list(PLACES).index(on)]
    elif isinstance(present, Bath):
        values = bath_table(present)
    elif isinstance(present, Custom):
        values = by_key.values_by_key(present.force)
    return values.get(name, getattr(present, name, None))


def _changed_surface(surface: Surface, of_parts: Mapping[str, dict[str, Any]]) -> Surface:
    """A surface with other values of its own and of its parts.

    `of_parts` has the values by the name of the surface, for example "upper", or its part,
    "upper.drive".  Its own values are set first, so that they may replace a part.
    """
    with inside(surface.name):
        given = of_parts.get(surface.name, {})
        for key in given:
            if key not in OF_SURFACE and (hint := meant_key(key, keys_of_surface(surface))):
                raise InputError(key, f"is not a known key; {hint}")
        own = known_keys(given, OF_SURFACE)
        if "velocity" in own and not is_list(own["velocity"]):
            velocity = number("velocity", own["velocity"], unit="length / time")
            own["velocity"] = (velocity, surface.velocity[1])
        initial = {name: own.pop(name) for name in INITIAL if name in own}
        if "theta" in initial or "swing" in initial:  # one replaces the other
            initial = {"theta": None, "swing": None, **initial}
        changes: dict[str, Any] = own
        if initial:
            with inside("initial"):
                present = READ["initial"](own.get("initial", surface.initial))
            changes["initial"] = replace(present, **initial)
    for part in parts_of(surface):
        own = of_parts.get(f"{surface.name}.{part}", {})
        if own:
            name, _, on = part.partition(".")
            with inside(f"{surface.name}.{part}"):
                whole = changes.get(name, getattr(surface, name))
                whole = READ[name](whole) if name in READ else whole
                new = _changed_part(whole[list(PLACES).index(on)] if on else whole, name, own)
            changes[name] = [new if each.on == on else each for each in whole] if on else new
    with inside(surface.name):
        return replace(surface, **changes) if changes else surface


def _changed_part(present: Any, part: str, own: dict[str, Any]) -> Any:
    """A part with other values, read as from the table of a scene file."""
    if isinstance(present, Custom):
        of_drive = {name: getattr(present, name) for name in ("load", "block", "tilt")}
        of_drive = {name: own.get(name, value) for name, value in of_drive.items()}
        own = {name: value for name, value in own.items() if name not in of_drive}
        parameters = present.force._asdict() | own
        return Custom(**of_drive, force=instance(type(present.force), parameters))
    if part == "drive":
        return as_drive(drive_table(present) | own)
    if part == "bath":
        # Without oscillators, a spectrum can take their place.
        table = {key: value for key, value in bath_table(present).items() if value != []}
        return as_bath(table | own)
    if part == "langevin":
        return as_langevin(({} if present is None else table_of(present)) | own)
    return changed(present, own)


def _changed_field(field: Field, own: Mapping[str, Any]) -> Field:
    settings = {key: value for key, value in own.items() if key in OF_FIELD}
    rest = {key: value for key, value in own.items() if key not in OF_FIELD}
    potential = instance(type(field.potential), field.potential._asdict() | rest)
    return replace(field, potential=potential, **settings)
