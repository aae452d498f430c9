"""What tells one run from another: the scene, the settings, this package and the plug-ins."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np

from tribo.compiler.source_stamps import package_stamp
from tribo.model.scene import Scene
from tribo.model.scene_file import scene_from
from tribo.plugins import classes
from tribo.plugins.sources import sent, to_send
from tribo.plugins.stamps import is_same, is_unchanged, stamp_of
from tribo.plugins.unloaded import Code, Unloaded, code
from tribo.validation import InputError, short_repr

Identity = dict[str, object]  # as JSON


def settings_of(
    method: str, accuracy: float | Mapping[str, float] | None, step: float | None, start: str | None
) -> Identity:
    """The settings of a run; `start` is the digest of the state where it begins."""
    accuracy = dict(accuracy) if isinstance(accuracy, Mapping) else accuracy
    return {"method": method, "accuracy": accuracy, "step": step, "start": start} | changes({})


def changes(initial: Mapping[str, Any], estimate: bool = True) -> Identity:
    """The settings of a prepared run: initial values that it changed, and whether it has errors."""
    values = {}
    for name in initial:
        value = initial[name]
        values[str(name)] = value if type(value) is float else np.asarray(value, float).tolist()
    return {"initial": values, "estimate": estimate}


def identity_of(scene: Scene, settings: Identity, by: str) -> Identity:
    """What a run depends on; `by` is the version of this package."""
    return {
        "version": by,
        "scene": renamed(plain_table(scene), name_in_folder),
        "settings": settings,
        "plugin": plugin_stamps(scene),
    }


@cache
def version() -> str:
    """The version of this package, and the hash of its sources."""
    from tribo import __version__

    return f"{__version__} ({package_stamp()})"


def plain_table(scene: Scene) -> dict[str, Any]:
    """The scene as the nested table of its file, with TOML's own types."""
    return tomllib.loads(scene.to_toml())


def plugin_stamps(scene: Scene) -> dict[str, str | None]:
    """The hash of the sources of each plug-in that is not this package's, by its field."""
    stamps = {
        place: item.stamp if isinstance(item, Unloaded) else stamp_of(item)
        for place, item in plugins_of(scene)
    }
    return {place: stamp for place, stamp in stamps.items() if stamp != ""}


def plugins_of(scene: Scene) -> list[tuple[str, Any]]:
    """All plug-ins, each with its field in the scene; no calculators."""
    places = [
        (f"interaction[{i}].potential", item.potential) for i, item in enumerate(scene.interactions)
    ]
    places += [(f"field[{i}].kind", item.potential) for i, item in enumerate(scene.fields)]
    for i, surface in enumerate(scene.surfaces):
        for part, plugin in (("drive", surface.drive.plugin), ("bars", surface.plugin_at_ends)):
            if plugin is not None:
                places.append((f"surface[{i}].{part}", plugin))
    return [item for item in places if isinstance(item[1], (tuple, Unloaded))]


def opened(table: dict[str, Any], stamps: Mapping[str, str | None], folder: Path) -> Scene:
    """The scene in a result, without its code; `stamps` are those of :func:`plugin_stamps`."""
    with code(Code.LEAVE):
        scene = scene_from(table, folder)
    for place, item in plugins_of(scene):
        if isinstance(item, Unloaded):
            item.stamp = stamps.get(place)
            item.folder = folder.absolute()
    return scene


def loaded(scene: Scene) -> Scene:
    """The scene with the code of all its plug-ins; InputError if that has changed.

    Files that have left their place, or that have changed there, are those in the folder of the
    result, where they lie in an archive that was unpacked.
    """
    before = {place: item for place, item in plugins_of(scene) if isinstance(item, Unloaded)}
    if not before:
        return scene
    table = plain_table(scene)
    beside = next(iter(before.values())).folder
    moved = renamed(table, partial(_moved, folder=beside, changed=False))
    try:
        return _unchanged(moved, before)
    except InputError:
        elsewhere = renamed(table, partial(_moved, folder=beside, changed=True))
        if elsewhere == moved:
            raise
        with suppress(InputError):
            return _unchanged(elsewhere, before)
        raise


def _moved(name: str, folder: Path, changed: bool) -> str:
    """The name of code, in a folder if it is there and its file has been moved, or `changed`."""
    place, _, cls = name.rpartition(":")
    file = folder / Path(place).name
    use = file.is_file() and (changed or not Path(place).is_file())
    return f"{file}:{cls}" if use else name


def name_in_folder(name: str) -> str:
    """The name of code without its folder: its stamp tells it from other code."""
    place, _, cls = name.rpartition(":")
    return f"{Path(place).name}:{cls}"


def renamed(table: Any, rename: Callable[[str], str]) -> Any:
    """A table of a scene, with other names of classes in files."""
    if isinstance(table, dict):
        return {key: renamed(value, rename) for key, value in table.items()}
    if isinstance(table, list):
        return [renamed(value, rename) for value in table]
    return rename(table) if isinstance(table, str) and ".py:" in table else table


def _unchanged(table: dict[str, Any], before: Mapping[str, Unloaded]) -> Scene:
    """The scene of a table with its code.  Raises InputError if that is not the code `before`."""
    scene = scene_from(table)
    now = dict(plugins_of(scene))
    for place, item in before.items():
        if not is_unchanged(item.stamp, now[place]):
            problem = f"{item.name}, or a value that it reads, has changed since the result was"
            raise InputError(place, f"{problem} computed; load its scene file")
    return scene


def as_sent(scene: Scene) -> tuple[str, dict[str, bytes], dict[str, str | None]]:
    """A scene for a process that may lack its plug-ins: text, their sources, and their stamps."""
    items = [part for _, plugin in plugins_of(scene) for part in classes.parts(plugin)]
    return scene.to_toml(), to_send(map(type, items)), plugin_stamps(scene)


def received(text: str, sources: Mapping[str, bytes], stamps: Mapping[str, str | None]) -> Scene:
    """The scene that another process has sent.  Raises InputError if its code does not fit."""
    try:
        with sent(sources):
            scene = scene_from(tomllib.loads(text))
    except InputError as error:
        if not sources:
            raise
        hint = "a worker needs the modules that a plug-in imports: client.upload_file sends them"
        raise InputError(error.field, f"{error.problem}; {hint}") from None
    now = plugin_stamps(scene)
    for place, before in stamps.items():
        if not is_same(before, now.get(place)):
            raise InputError(place, "is other code, or reads other values, than where it was sent")
    return scene


def first_difference(one: object, other: object, key: str = "") -> str | None:
    """Where two tables of scenes differ first, "duration was 4.0, is 5.0"; None if nowhere."""
    if isinstance(one, dict) and isinstance(other, dict):
        names = dict.fromkeys([*one, *other])
        pairs = [(f"{key}.{name}", one.get(name), other.get(name)) for name in names]
    elif isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        pairs = [(f"{key}[{i}]", *pair) for i, pair in enumerate(zip(one, other, strict=True))]
    else:
        same = one == other
        return None if same else f"{key.removeprefix('.')} was {_shown(one)}, is {_shown(other)}"
    return next((d for name, a, b in pairs if (d := first_difference(a, b, name))), None)


def _shown(value: object) -> str:
    return "missing" if value is None else short_repr(value)


def refuse_other(path: Path, before: Identity, now: Identity) -> None:
    """Raise InputError if a file is of another run, and name the first thing that differs."""
    difference = first_difference(before, now)
    if difference is not None:
        raise InputError(
            str(path), f"is of another run: {difference}; start again without --resume"
        )
