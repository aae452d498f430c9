"""The command `tribo bundle`: scenes, plug-ins, results, versions and checksums in one archive.

The archive is a ZIP file whose bits depend on its content alone.  `manifest.json` describes every
file; `SHA256SUMS` is read by ``sha256sum --check`` and ``shasum --check``.
"""

import argparse
import hashlib
import io
import json
import tomllib
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tribo import seals
from tribo.commands.doctor import versions
from tribo.files import (
    NETCDF,
    checked_target,
    netcdf_attributes,
    read_file,
    replace_file,
    strict_json,
)
from tribo.interrupts import COMPLETED
from tribo.model.identity import name_in_folder, renamed
from tribo.model.scene_writer import toml
from tribo.plugins.sources import files_beside
from tribo.validation import InputError

# Files of an archive: what it contains, and the checksums of all others.
MANIFEST = "manifest.json"
SUMS = "SHA256SUMS"
# Attributes of result files that the manifest repeats; those in JSON are decoded.
ATTRIBUTES = ("version", "tribo_version", "status", "method", "seed", "created")
ATTRIBUTES_IN_JSON = ("settings", "plugins", "accuracy", "met", "notes")
# Date of all entries of the archive, the first that the format knows.
NO_DATE = (1980, 1, 1, 0, 0, 0)


def run_bundle(options: argparse.Namespace) -> int:
    """Write the archive of the files that are named.  Raises InputError."""
    checked_target("--out", options.out)
    if options.out.suffix.lower() != ".zip":
        raise InputError("--out", f"must end on .zip, got {str(options.out)!r}")
    contents: dict[str, bytes] = {}
    described: dict[str, Any] = {}
    for path in options.files:
        for name, content in _with_companions(path):
            if contents.setdefault(name, content) != content or name in (MANIFEST, SUMS):
                raise InputError(str(path), f"would be a second {name} in the archive; rename it")
            described[name] = _about(name, content)
    seen: dict[str, str] = {}
    for name in contents:  # some file systems would unpack one file only
        if (other := seen.setdefault(name.lower(), name)) != name:
            raise InputError(name, f"differs from {other} in case alone; rename one of them")
    manifest = {"made_with": versions(), "files": described}
    contents[MANIFEST] = (strict_json(manifest) + "\n").encode()
    sums = [f"{hashlib.sha256(each).hexdigest()}  {name}\n" for name, each in contents.items()]
    contents[SUMS] = "".join(sums).encode()
    image = io.BytesIO()
    with zipfile.ZipFile(image, "w") as archive:
        for name, content in contents.items():
            entry = zipfile.ZipInfo(name, NO_DATE)
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, content, zipfile.ZIP_DEFLATED)
    replace_file(options.out, image.getvalue())
    print(options.out)
    return COMPLETED


def _with_companions(path: Path) -> Iterator[tuple[str, bytes]]:
    """A file under its name in the archive, then the files that its scene names."""
    content = _content(path)
    yield path.name, content
    _, text = _attributes_and_scene(path.name, content)
    if text is None:
        return
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(str(path), f"is no scene file ({error})") from None
    if path.suffix.lower() == NETCDF:
        # Its plug-ins, which are absolute places there, are beside it in the archive.
        yield path.name + ".toml", toml(renamed(table, name_in_folder))
    for place in _strings(table):
        file, _, _ = place.partition(".py:")
        named = Path(file + ".py" if file != place else place)
        found = path.parent / named
        if named.suffix and found.is_file():
            inside = not named.is_absolute() and ".." not in named.parts
            yield named.as_posix() if inside else named.name, _content(found)
            if found.suffix != ".py":
                continue
            for imported in files_beside(found):
                name = imported.relative_to(found.parent)
                yield (named.parent / name if inside else name).as_posix(), read_file(imported)


def _content(path: Path) -> bytes:
    """The content of a file; a NetCDF file is checked before it is parsed.  Raises InputError."""
    content = read_file(path)
    if path.suffix.lower() == NETCDF:
        seals.check(path)
    return content


def _attributes_and_scene(name: str, content: bytes) -> tuple[dict[str, Any], str | None]:
    """The attributes of a NetCDF file, {} of others; the text of the scene in the file, if any."""
    if name.lower().endswith(".toml"):
        return {}, content.decode("utf-8-sig")
    if not name.lower().endswith(NETCDF):
        return {}, None
    try:
        attributes = netcdf_attributes(name, content)
    except OSError as error:
        raise InputError(name, f"is no NetCDF file that tribo has written ({error})") from None
    scene = attributes.get("scene")
    return attributes, scene if isinstance(scene, str) else None


def _about(name: str, content: bytes) -> dict[str, Any]:
    """The entry of a file in the manifest."""
    attributes, scene = _attributes_and_scene(name, content)
    about: dict[str, Any] = {"bytes": len(content), "sha256": hashlib.sha256(content).hexdigest()}
    about |= {key: str(attributes[key]) for key in ATTRIBUTES if key in attributes}
    about |= {key: json.loads(attributes[key]) for key in ATTRIBUTES_IN_JSON if key in attributes}
    if scene is not None:
        about["seed"] = tomllib.loads(scene).get("seed", 0)
    return about


def _strings(value: object) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, (dict, list)):
        for item in value.values() if isinstance(value, dict) else value:
            yield from _strings(item)
