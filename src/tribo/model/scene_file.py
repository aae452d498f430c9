"""Scene files: TOML to Scene and back.

The names are a contract with everyone who keeps scene files.
"""

from __future__ import annotations

import tomllib
from dataclasses import fields as fields_of
from pathlib import Path
from typing import Any

import numpy as np

from tribo.model import bath, drives, fields
from tribo.model.asperite import Asperite
from tribo.model.fields import Field
from tribo.model.roughness import Roughness
from tribo.model.scene import Interaction, Numerics, Output, Scene, as_periodic
from tribo.model.surface import Initial, Surface
from tribo.potentials import tables as written
from tribo.validation import InputError, as_path, inside, known_keys, shown

SURFACE_KEYS = [f.name for f in fields_of(Surface)]


def load_scene(path: Any) -> Scene:
    """The scene in a TOML file; raises InputError with one sentence that names the key."""
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
    """The scene that a file's table describes; plug-ins are looked for from `folder`."""
    table = known_keys(
        table,
        [
            *("title", "duration", "seed", "periodic"),
            *("interaction", "field", "surface", "output", "numerics"),
        ],
        ["duration", "surface"],
    )
    surfaces = table["surface"]
    if not isinstance(surfaces, list):
        raise InputError("surface", "must be [[surface]] tables, one for each surface")
    with inside("output"):
        output = Output(**known_keys(table.get("output", {}), ["samples", "times"]))
    with inside("numerics"):
        numerics = Numerics(**known_keys(table.get("numerics", {}), ["accuracy", "method", "step"]))
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


def _interactions(value: Any, folder: Path) -> tuple[Interaction, ...]:
    if isinstance(value, dict):
        with inside("interaction"):
            return (_interaction(value, folder),)
    if not isinstance(value, list):
        raise InputError("interaction", f"must be a table, got {shown(value)}")
    interactions = []
    for i, table in enumerate(value):
        with inside(f"interaction[{i}]"):
            interactions.append(_interaction(table, folder))
    return tuple(interactions)


def _fields(value: Any, folder: Path) -> tuple[Field, ...]:
    if not isinstance(value, list):
        raise InputError("field", "must be [[field]] tables, one for each field")
    items = []
    for i, table in enumerate(value):
        with inside(f"field[{i}]"):
            items.append(fields.from_table(table, folder))
    return tuple(items)


def _interaction(table: Any, folder: Path) -> Interaction:
    if not isinstance(table, dict):
        raise InputError("", f"must be a table, got {shown(table)}")
    parameters = dict(table)
    between, species = parameters.pop("between", None), parameters.pop("species", None)
    return Interaction(written.from_table(parameters, folder), between, species)


def _surface(index: int, table: Any, folder: Path) -> Surface:
    with inside(f"surface[{index}]"):
        table = known_keys(table, SURFACE_KEYS, ["name"])
        with inside("asperite"):
            parameters = known_keys(
                table.get("asperite", {}), [f.name for f in fields_of(Asperite)]
            )
            table["asperite"] = Asperite(**parameters)
        with inside("initial"):
            start = known_keys(table.get("initial", {}), [f.name for f in fields_of(Initial)])
            table["initial"] = Initial(**start)
        with inside("drive"):
            table["drive"] = drives.as_drive(table.get("drive", "forced"), folder)
        with inside("bars"):
            table["bars"] = drives.as_bars(table.get("bars", "clamped"), folder)
        return Surface(**table)


def save_scene(scene: Scene, path: Any) -> None:
    """Write the TOML file that `load_scene` reads."""
    path = as_path(path)
    text = scene_text(scene).encode("utf-8")
    try:
        path.write_bytes(text)
    except OSError as error:
        raise InputError(str(path), f"cannot be written ({error.strerror})") from None


def scene_text(scene: Scene) -> str:
    """The scene as TOML."""
    import tomli_w

    return tomli_w.dumps(scene_table(scene))


def scene_table(scene: Scene) -> dict[str, Any]:
    """The scene as the nested table of its file."""
    table: dict[str, Any] = {"title": scene.title} if scene.title else {}
    table |= {"duration": scene.duration, "seed": scene.seed}
    table["output"] = _given(scene.output)
    if scene.output.times is not None:
        del table["output"]["samples"]
    table["numerics"] = _given(scene.numerics)
    table["periodic"] = _given(scene.periodic)
    table["interaction"] = [
        written.as_table(i.potential)
        | {
            key: list(names)
            for key, names in (("between", i.between), ("species", i.species))
            if names
        }
        for i in scene.interactions
    ]
    table["field"] = [fields.as_table(item) for item in scene.fields]
    table["surface"] = [_surface_table(surface) for surface in scene.surfaces]
    return table


def _surface_table(surface: Surface) -> dict[str, Any]:
    table = _given(surface)
    table["drive"] = drives.as_table(surface.drive)
    table["bars"] = drives.bars_as_table(surface.bars)
    table["springs"] = _given(surface.springs)
    table["bath"] = bath.as_table(surface.bath)
    if surface.langevin is not None:
        table["langevin"] = _given(surface.langevin)
    if isinstance(surface.heights, Roughness):
        table["heights"] = _given(surface.heights)
    table["asperite"] = _given(surface.asperite)
    table["initial"] = _given(surface.initial)
    if surface.positions is not None:
        for key in ("bob", "shape", "spacing", "depth"):
            del table[key]
    return table


def _given(item: Any) -> dict[str, Any]:
    """The fields of a dataclass that are set, as TOML can hold them."""
    table = {}
    for f in fields_of(item):
        value = getattr(item, f.name)
        if isinstance(value, np.ndarray):
            value = value.tolist()
        elif isinstance(value, tuple):
            value = [list(item) if isinstance(item, tuple) else item for item in value]
        if value is not None:
            table[f.name] = value
    return table
