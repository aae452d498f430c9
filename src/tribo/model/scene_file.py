"""Scene files: from TOML to a Scene.

The names of the keys are a contract: scene files of older versions stay valid.
"""

import difflib
import tomllib
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from tribo.files import NETCDF, read_file
from tribo.model import bars, drive_tables
from tribo.model.drawn import column, is_column, with_columns
from tribo.model.fields import from_table as field_of
from tribo.model.initial import Initial
from tribo.model.interaction import from_table as interaction_of
from tribo.model.scene import Scene
from tribo.model.settings import Numerics, Output
from tribo.model.surface import Surface
from tribo.model.tables import field_names, from_table, part
from tribo.model.toml_errors import toml_problem
from tribo.model.topography import as_topography, is_topography
from tribo.validation import InputError, as_path, known_keys, must_be

KEYS = (
    *("title", "duration", "seed", "periodic"),
    *("interaction", "field", "surface", "output", "numerics"),
)


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
    if path.suffix == NETCDF and path.is_file():
        raise InputError(
            str(path),
            "is a NetCDF file, and a scene file is needed; tribo view shows the run in it, "
            "and in Python tribo.load_result(file).scene.save writes its scene",
        )
    try:
        content = read_file(path)
    except InputError as error:
        raise InputError(error.field, f"{error.problem}{_similar(path)}") from None
    try:
        text = content.decode("utf-8-sig")  # Notepad begins with a mark
    except UnicodeDecodeError:
        raise InputError(str(path), "is not a text file in UTF-8") from None
    try:
        table = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(str(path), toml_problem(error, text)) from None
    return scene_from(table, path.parent)


def _similar(path: Path) -> str:
    """The scene file whose name is most similar to that of a missing one, as part of a message."""
    if path.exists() or not path.parent.is_dir():
        return ""
    names = [each.name for each in path.parent.glob("*.toml")]
    near = difflib.get_close_matches(path.name, names, n=1)
    return f'; did you mean "{path.with_name(near[0])}"?' if near else ""


def scene_from(table: dict[str, Any], folder: Path = Path()) -> Scene:
    """The scene that the table of a file describes; `folder` is that of its plug-ins."""
    if place := _place_of("duration", table):
        problem = f"must stand above the first table, as duration = 40.0; it stands under {place}"
        raise InputError("duration", problem)
    table = known_keys(table, KEYS, ["duration", "surface"])
    for key, kind in (("output", Output), ("numerics", Numerics)):
        table[key] = part(partial(from_table, kind))(key, table.get(key, {}))
    table["surfaces"] = _each("surface", table.pop("surface"), partial(_surface, folder=folder))
    table["fields"] = _each("field", table.pop("field", []), partial(field_of, folder=folder))
    given = table.pop("interaction", [])
    read = partial(interaction_of, folder=folder)
    one = isinstance(given, dict)
    found = part(read)("interaction", given) if one else _each("interaction", given, read)
    return Scene(interactions=found, **table)


def _place_of(key: str, table: object) -> str:
    """The heading of a table that contains a key, as "[[surface]]"; "" if its place is right."""
    if not isinstance(table, dict) or key in table:
        return ""
    for name, value in table.items():
        if name in ("interaction", "field"):  # whose classes may have fields of any name
            continue
        if isinstance(value, dict) and key in value:
            return f"[{name}]"
        if isinstance(value, list) and any(isinstance(v, dict) and key in v for v in value):
            return f"[[{name}]]"
    return ""


def _each(key: str, value: object, read: Callable[[Any], object]) -> tuple[Any, ...]:
    if not isinstance(value, list):
        several = f"[[{key}]] tables, one for each {key}"
        raise must_be(key, "a table" if key == "interaction" else several, value)
    return tuple(part(read)(f"{key}[{i}]", item) for i, item in enumerate(value))


def _surface(table: object, folder: Path) -> Surface:
    """The surface that a table of a scene file describes; files are relative to `folder`."""
    table = known_keys(table, field_names(Surface), ["name"])
    readers: dict[str, Callable[[Any], object]] = {
        # Surfaces draw from distributions, and check the rest.
        "asperite": partial(with_columns, folder=folder),
        "initial": partial(from_table, Initial),
        "drive": partial(drive_tables.as_drive, folder=folder),
        "bars": partial(bars.as_bars, folder=folder),
    }
    if is_topography(table.get("heights")):
        readers["heights"] = partial(as_topography, folder=folder)
    if is_column(table.get("heights")):
        readers["heights"] = partial(column, folder=folder)
    parts = {key: part(read)(key, table[key]) for key, read in readers.items() if key in table}
    return Surface(**table | parts)
