"""The keys of the values of a scene: those that it has, and which ones an unknown key may mean.

`tribo.model.parameters` lists their forms, and reads and changes the values.
"""

import difflib
from typing import Any

from tribo.model.bath import Bath
from tribo.model.bath import as_table as bath_table
from tribo.model.fields import SETTINGS
from tribo.model.initial import Initial
from tribo.model.interaction import Periodic
from tribo.model.langevin import PLACES
from tribo.model.own_drive import Custom
from tribo.model.scene import Scene
from tribo.model.settings import Numerics, Output
from tribo.model.surface import Surface
from tribo.model.tables import field_names
from tribo.potentials import by_key
from tribo.validation import InputError, shortened

# The values of the scene itself that have keys.
OF_SCENE = ("duration", "seed", "title")
# The parts of the scene whose values have keys.
PARTS_OF_SCENE = {"output": Output, "numerics": Numerics, "periodic": Periodic}
# The initial values of a surface, and the other values of its own that have keys.
INITIAL = field_names(Initial)
# Those that are two numbers, each of which has a key of its own.
OF_TWO = ("bob", "velocity", "spacing")
OWN = [name for name in field_names(Surface) if name != "name"]
OF_SURFACE = [*INITIAL, *OWN]
# First parts of the keys of a scene's only interaction, and of its only field.
INTERACTION = "interaction"
FIELD = "field"
# Keys without a point.
WITHOUT_POINT = (*OF_SCENE, *PARTS_OF_SCENE, INTERACTION, FIELD)
# The values of a field beside those of its potential.
OF_FIELD = SETTINGS
# How similar the last part of a key in a hint is, 1 being the same.
SIMILAR = 0.75
# Keys in a hint, at most.
MOST_HINTS = 3


def reservoir_part(surface: Surface, on: str) -> str:
    """What stands in a key for a reservoir: its place is given where a surface has both."""
    return f"langevin.{on}" if isinstance(surface.langevin, tuple) else "langevin"


def parts_of(surface: Surface) -> tuple[str, ...]:
    """The parts of a surface whose values have keys."""
    reservoirs = dict.fromkeys(reservoir_part(surface, on) for on in PLACES)
    elastic = () if surface.elastic is None else ("elastic",)
    return ("asperite", "drive", *reservoirs, "bath", "springs", *elastic)


def parts_of_scene(scene: Scene) -> list[str]:
    """What stands before the last point of a key."""
    parts = ["", *PARTS_OF_SCENE]
    for surface in scene.surfaces:
        parts += [surface.name, *(f"{surface.name}.{part}" for part in parts_of(surface))]
    parts += [INTERACTION] if len(scene.interactions) == 1 else []
    return parts + ([FIELD] if len(scene.fields) == 1 else [])


def values_of_only(scene: Scene, part: str) -> dict[str, Any]:
    """The parameters of the only interaction or field by their keys; none of several."""
    items: tuple[Any, ...] = scene.interactions if part == INTERACTION else scene.fields
    return by_key.values_by_key(items[0].potential) if len(items) == 1 else {}


def unknown_key(scene: Scene, key: str) -> InputError:
    """The error of a key whose part the scene does not have."""
    part, _, name = key.rpartition(".")
    outer = key.partition(".")[0]
    for kind, items in ((INTERACTION, scene.interactions), (FIELD, scene.fields)):
        if outer == kind and part:
            return InputError(key, f"needs one {kind}, and the scene has {len(items)}")
    keys = _keys_of(scene)
    own = [each for each in keys if each.startswith(f"{part}.")] if part != outer else []
    if own:
        # A part of a surface that has parts itself, as both reservoirs have.
        hint = meant_key(name, own) or f"known here: {shortened(own)}"
    elif part:
        near = [outer]
        if not any(each.startswith(f"{outer}.") for each in keys):
            near = difflib.get_close_matches(part, parts_of_scene(scene), n=1)
        hint = meant_key(name, [each for each in keys if near and each.startswith(f"{near[0]}.")])
        names = ", ".join(f'"{s.name}"' for s in scene.surfaces)
        example = f'"{scene.surfaces[0].name}.drive.load"'
        hint = hint or f"the surfaces are {names}; keys are as {example}"
    else:
        hint = meant_key(name, keys) or f"known here: {', '.join(WITHOUT_POINT)}"
    return InputError(key, f"is not a known key; {hint}")


def meant_key(name: str, keys: list[str]) -> str:
    """Which keys somebody may mean who gives the last part of one, perhaps misspelt; or ""."""
    last = {key: key.rpartition(".")[2] for key in keys}
    names = list(dict.fromkeys(last.values()))
    near = [name] if name in names else difflib.get_close_matches(name, names, 1, SIMILAR)
    found = [f'"{key}"' for key in keys if last[key] in near]
    if not found:
        return ""
    shown = found[:MOST_HINTS]
    before = f"{', '.join(shown[:-1])} or " if len(shown) > 1 else ""
    return f"did you mean {before}{shown[-1]}?"


def _keys_of(scene: Scene) -> list[str]:
    """The keys of a scene, without those of numbers of schedules and of one of two numbers."""
    found = [*WITHOUT_POINT]
    for part, kind in PARTS_OF_SCENE.items():
        found += [f"{part}.{name}" for name in field_names(kind)]
    for part in (INTERACTION, FIELD):
        found += [f"{part}.{name}" for name in values_of_only(scene, part)]
    for surface in scene.surfaces:
        found += keys_of_surface(surface)
    return found


def keys_of_surface(surface: Surface) -> list[str]:
    """The keys of a surface and of the parts that it has, likewise."""
    found = [f"{surface.name}.{name}" for name in OF_SURFACE]
    for part in parts_of(surface):
        name, _, on = part.partition(".")
        present = getattr(surface, name)
        if on:
            present = present[list(PLACES).index(on)]
        if isinstance(present, Custom):
            names = tuple(by_key.values_by_key(present.force))
        elif isinstance(present, Bath):
            names = tuple(bath_table(present))
        else:
            names = () if present is None else field_names(type(present))
        found += [f"{surface.name}.{part}.{each}" for each in names]
    return found
