"""Scenes to TOML: the inverse of :mod:`tribo.model.scene_file`."""

from __future__ import annotations

from dataclasses import fields as fields_of
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.files import replace_file
from tribo.model import bath, drives, fields, topography
from tribo.model.roughness import Roughness
from tribo.model.surface import Surface
from tribo.model.topography import Topography
from tribo.potentials import tables as potentials
from tribo.validation import as_path

if TYPE_CHECKING:
    from tribo.model.scene import Scene


def save_scene(scene: Scene, path: object) -> None:
    """Write the TOML file that `load_scene` reads; it names the files of topographies."""
    path = as_path(path)
    table = scene_table(scene)
    for item, surface in zip(table["surface"], scene.surfaces, strict=True):
        if isinstance(surface.heights, Topography):
            item["heights"] = topography.as_table(surface.heights, path.parent)
    replace_file(path, _toml(table))


def scene_text(scene: Scene) -> str:
    """The scene as TOML that needs no files of topographies: their heights are numbers."""
    return _toml(scene_table(scene)).decode("utf-8")


def _toml(table: dict[str, Any]) -> bytes:
    import tomli_w

    return tomli_w.dumps(table).encode("utf-8")


def scene_table(scene: Scene) -> dict[str, Any]:
    """The scene as the nested table of its file, with the heights of topographies as numbers."""
    table: dict[str, Any] = {"title": scene.title} if scene.title else {}
    table |= {"duration": scene.duration, "seed": scene.seed}
    table["output"] = _table_of(scene.output)
    if scene.output.times is not None:
        del table["output"]["samples"]
    if not scene.output.series:
        del table["output"]["series"]
    if not scene.output.run_in:
        del table["output"]["run_in"]
    if scene.output.keep is not None:
        table["output"]["keep"] = list(scene.output.keep)
    table["numerics"] = _table_of(scene.numerics)
    table["periodic"] = _table_of(scene.periodic)
    table["interaction"] = [
        potentials.as_table(i.potential)
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
    table = _table_of(surface)
    table["drive"] = drives.as_table(surface.drive)
    table["bars"] = drives.bars_as_table(surface.bars)
    table["springs"] = _table_of(surface.springs)
    table["bath"] = bath.as_table(surface.bath)
    if surface.langevin is not None:
        table["langevin"] = _table_of(surface.langevin)
    if isinstance(surface.heights, Roughness):
        table["heights"] = _table_of(surface.heights)
    elif isinstance(surface.heights, Topography):
        table["heights"] = surface.heights.heights.tolist()
    table["asperite"] = _table_of(surface.asperite)
    table["initial"] = _table_of(surface.initial)
    if surface.positions is not None:
        for key in ("bob", "shape", "spacing", "depth"):
            del table[key]
    return table


def _table_of(item: Any) -> dict[str, Any]:
    """The fields of a dataclass that are not None, as values of TOML."""
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
