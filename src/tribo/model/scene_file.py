"""Scene files: from TOML to a Scene.

The names of the keys are a contract: scene files of older versions stay valid.
"""

import tomllib
from dataclasses import fields as fields_of
from pathlib import Path
from typing import Any

from tribo.model import drives, fields
from tribo.model.asperite import Asperite
from tribo.model.fields import Field
from tribo.model.initial import Initial
from tribo.model.interaction import Interaction, as_periodic
from tribo.model.scene import Scene
from tribo.model.settings import Numerics, Output
from tribo.model.surface import Surface
from tribo.model.tables import from_table
from tribo.model.topography import as_topography, is_topography
from tribo.potentials import tables as potentials
from tribo.validation import InputError, as_path, inside, known_keys, must_be

KEYS = (
    *("title", "duration", "seed", "periodic"),
    *("interaction", "field", "surface", "output", "numerics"),
)
SURFACE_KEYS = [f.name for f in fields_of(Surface)]


def load_scene(path: object) -> Scene:
    """Read a scene file.

    Parameters
    ----------
    path : str or path-like
        A TOML file.  Plug-ins that it names are looked up relative to its folder.

    Raises
    ------
    InputError
        If the file cannot be read, or a key is unknown, missing or has an invalid value: one
        sentence that names the key.
    """
    path = as_path(path)
    try:
        text = path.read_bytes().decode("utf-8")
    except OSError as error:
        raise InputError(str(path), f"cannot be read ({error.strerror})") from None
    except UnicodeDecodeError:
        raise InputError(str(path), "is not a text file in UTF-8") from None
    try:
        table = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(str(path), f"is not valid TOML: {error}") from None
    return scene_from(table, path.parent)


def scene_from(table: dict[str, Any], folder: Path = Path()) -> Scene:
    """The scene that the table of a file describes; `folder` is that of its plug-ins."""
    table = known_keys(table, KEYS, ["duration", "surface"])
    surfaces = table["surface"]
    if not isinstance(surfaces, list):
        raise must_be("surface", "[[surface]] tables, one for each surface", surfaces)
    with inside("output"):
        output = from_table(Output, table.get("output", {}))
    with inside("numerics"):
        numerics = from_table(Numerics, table.get("numerics", {}))
    return Scene(
        surfaces=tuple(_surface(i, item, folder) for i, item in enumerate(surfaces)),
        periodic=as_periodic(table.get("periodic", {})),
        fields=_fields(table.get("field", []), folder),
        interactions=_interactions(table.get("interaction", []), folder),
        duration=table["duration"],
        title=table.get("title", ""),
        seed=table.get("seed", 0),
        output=output,
        numerics=numerics,
    )


def _interactions(value: object, folder: Path) -> tuple[Interaction, ...]:
    if isinstance(value, dict):
        with inside("interaction"):
            return (_interaction(value, folder),)
    if not isinstance(value, list):
        raise must_be("interaction", "a table", value)
    interactions = []
    for i, table in enumerate(value):
        with inside(f"interaction[{i}]"):
            interactions.append(_interaction(table, folder))
    return tuple(interactions)


def _fields(value: object, folder: Path) -> tuple[Field, ...]:
    if not isinstance(value, list):
        raise must_be("field", "[[field]] tables, one for each field", value)
    items = []
    for i, table in enumerate(value):
        with inside(f"field[{i}]"):
            items.append(fields.from_table(table, folder))
    return tuple(items)


def _interaction(table: object, folder: Path) -> Interaction:
    if not isinstance(table, dict):
        raise must_be("", "a table", table)
    parameters = dict(table)
    between, species = parameters.pop("between", None), parameters.pop("species", None)
    return Interaction(potentials.from_table(parameters, folder), between, species)


def _surface(index: int, table: object, folder: Path) -> Surface:
    with inside(f"surface[{index}]"):
        table = known_keys(table, SURFACE_KEYS, ["name"])
        with inside("asperite"):
            table["asperite"] = from_table(Asperite, table.get("asperite", {}))
        with inside("initial"):
            table["initial"] = from_table(Initial, table.get("initial", {}))
        if is_topography(table.get("heights")):
            with inside("heights"):
                table["heights"] = as_topography(table["heights"], folder)
        with inside("drive"):
            table["drive"] = drives.as_drive(table.get("drive", "forced"), folder)
        with inside("bars"):
            table["bars"] = drives.as_bars(table.get("bars", "clamped"), folder)
        return Surface(**table)
