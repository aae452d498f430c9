"""Results as labelled data sets, and as the NetCDF files that hold them."""

from __future__ import annotations

import hashlib
import io
import json
import re
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo import seals
from tribo.files import NETCDF, PART, netcdf_in, read_file, replace_netcdf
from tribo.ledger.ledger import Ledger
from tribo.ledger.quantities import EVERY_QUANTITY
from tribo.ledger.quantity import UNITS, Table
from tribo.ledger.reported import quantity_of
from tribo.loops.saved_state import State
from tribo.model.identity import plugin_stamps, version
from tribo.model.scene import Scene
from tribo.results.run_result import RunResult
from tribo.validation import InputError

if TYPE_CHECKING:
    import xarray

# Before the names of the arrays of a state, which have no units; series of a surface that is named
# "state" have.
STATE = "state."
# After the name of a surface in that of its bath oscillators' displacements.
OSCILLATORS = ".oscillators"
# Before the hash in a file of version 0.2, which is computed with zeros in its place.
HASH = b"blake2b:"
NO_DIGEST = b"0" * 64
# Attributes of a result that are JSON in a file.
AS_JSON = ("settings", "error_estimate", "accuracy", "met", "notes")
# The note of a file that another program has written again.
REWRITTEN = "the file was written again by another program, with the same values"
# A variable of a data set: its dimensions, its values and its attributes.
Variable = tuple[tuple[str, ...], np.ndarray | float, dict[str, str]]


def dataset(result: RunResult) -> xarray.Dataset:
    """All series as a labelled data set.

    Returns
    -------
    xarray.Dataset
        ``upper.theta`` (time, upper_asperite), ``upper.W`` and ``applied_work`` (time,), each
        with `units` and `long_name`, and, as ``upper.theta_error``, a bound on its error where
        one is known.  Coordinates ``time``, ``upper_asperite``, and the resting bobs as
        ``upper.x_rest``, ``upper.y_rest`` and ``upper.z_rest``.
    """
    import xarray

    variables: dict[str, Variable] = {}
    for name, table in result.ledger.surfaces.items():
        times = "end" if _has_ends_alone(result) else "time"
        variables |= _series(table, result.error_estimate, name, (times, f"{name}_asperite"))
        variables |= _series(result.ledger.blocks[name], result.error_estimate, name, ("time",))
        if name in result.ledger.oscillators:
            displacement = "displacement of the bath oscillator from its bar"
            variables[f"{name}{OSCILLATORS}"] = (
                (times, f"{name}_asperite", f"{name}_oscillator", "axis"),
                result.ledger.oscillators[name],
                {"units": UNITS["length"], "long_name": displacement},
            )
    variables |= _series(result.system, result.error_estimate, "", ("time",))
    return xarray.Dataset(variables, coords=_coordinates(result), attrs=_attributes(result))


def _series(
    table: Table, bounds: dict[str, float | None], surface: str, dimensions: tuple[str, ...]
) -> dict[str, Variable]:
    """The variables of a table, each followed by the estimate of its error."""
    variables: dict[str, Variable] = {}
    for key, values in table.items():
        name = f"{surface}.{key}" if surface else key
        quantity = quantity_of(key, whole=len(dimensions) == 1)
        about = {"units": quantity.units, "long_name": quantity.long_name}
        variables[name] = (dimensions, values, about)
        bound = bounds.get(name, bounds[key])
        if bound is not None:
            about = about | {"long_name": f"bound on the error of: {quantity.long_name}"}
            variables[f"{name}_error"] = ((), bound, about)
    return variables


def _has_ends_alone(result: RunResult) -> bool:
    """Whether the asperites' series have the first and the last time alone."""
    tables = result.ledger.surfaces.values()
    first = next((series for table in tables for series in table.values()), result.t)
    return len(first) != result.t.size


def _coordinates(result: RunResult) -> dict[str, Variable]:
    """The times; and the asperites of each surface, with their resting bobs."""
    coordinates: dict[str, Variable] = {
        "time": (("time",), result.t, {"units": "time", "long_name": "time"})
    }
    if _has_ends_alone(result):
        about = {"units": "time", "long_name": "first and last time"}
        coordinates["end"] = (("end",), result.t[[0, -1]], about)
    for index, surface in enumerate(result.scene.surfaces):
        dimension = f"{surface.name}_asperite"
        about = {"units": "1", "long_name": f'asperite of "{surface.name}"'}
        coordinates[dimension] = ((dimension,), np.arange(surface.count), about)
        resting = surface.resting_bobs(seed=[result.scene.seed, index, 0])
        for k, axis in enumerate("xyz"):
            about = {"units": UNITS["length"], "long_name": f"{axis} of the resting bob"}
            coordinates[f"{surface.name}.{axis}_rest"] = ((dimension,), resting[:, k], about)
    return coordinates


def _attributes(result: RunResult) -> dict[str, str]:
    """The attributes of a result's file, by which a run can be repeated."""
    return {
        "version": version(),
        "plugins": json.dumps(plugin_stamps(result.scene)),
        "scene": result.scene.to_toml(),
        "status": str(result.status),
        "method": result.method,
        "cost": json.dumps(asdict(result.cost)),
        **{name: json.dumps(getattr(result, name)) for name in AS_JSON},
        "why": result.why,
    }


def save(result: RunResult, path: Path) -> None:
    """Write a NetCDF file with the state, complete or not at all.  Raises InputError."""
    data = dataset(result)
    state: dict[str, Variable] = {}
    for name, array in result.state().arrays().items():
        dimensions = tuple(f"{STATE}{name}_{axis}" for axis in range(array.ndim))
        state[f"{STATE}{name}"] = (dimensions, array, {})
    for name in state.keys() & data.variables.keys():
        raise InputError(str(path), f"cannot have both a series and an array of the state {name}")
    data = data.assign(state)
    # xarray warns of coordinates with blanks, whose names it could not list in an attribute.
    blank = [name for name in data.coords if " " in str(name) and name not in data.dims]
    data = data.reset_coords(blank)
    for key, variable in data.variables.items():
        variable.attrs["checksum"] = _checksum(str(key), variable)
    data.attrs["checksum"] = _checksum_of(data.attrs, _names(data))
    replace_netcdf(path, data, seals.sealed)


def _checksum(name: str, variable: xarray.Variable) -> str:
    """Of the name, the dimensions, the values and the attributes of a variable."""
    values = np.ascontiguousarray(variable.values)
    kind = f"{name} {variable.dims} {values.dtype.kind}{values.dtype.itemsize}"
    return _checksum_of({"": kind} | variable.attrs, values.tobytes())


def _checksum_of(attributes: dict[Any, Any], values: bytes = b"") -> str:
    """Of values and of all attributes but checksums."""
    kept = attributes.keys() - {"checksum", "hash", "_NCProperties"}
    known = {k: str(np.ravel(attributes[k])[0]) for k in kept}
    text = json.dumps(known, sort_keys=True).encode()
    return hashlib.blake2b(text + values, digest_size=16).hexdigest()


def load(path: Path) -> xarray.Dataset:
    """The data set that `save` wrote, or another program again.

    Raises InputError if it is damaged, the run has not ended, or it is a scene.
    """
    if path.suffix == ".toml":
        raise InputError(
            str(path),
            f"is a scene, and the file of a run is needed: tribo run {path.name} --out "
            f"{path.with_suffix(NETCDF).name} writes it",
        )
    is_part = path.suffix == PART
    if is_part or (not path.exists() and path.with_name(path.name + PART).exists()):
        part = "it" if is_part else f"{path.name}{PART}"
        raise InputError(
            str(path),
            f"is not complete: {part} has what a run has reached; the command that began the run "
            "completes the file with --resume",
        )
    image = read_file(path)
    whole = seals.is_sealed(io.BytesIO(image), str(path)) or _has_own_hash(image)
    if not whole:
        seals.check_readable(path)
    try:
        data = netcdf_in(image)
        changed = _changed(data)
        kind = _kind_of_many(data)
    except Exception:  # bytes that are no file, or a damaged one, may raise anything
        changed = "it"
        kind = ""
    if changed and kind:
        raise InputError(
            str(path),
            f"is the file of {kind}, and the file of a run is needed: the command that wrote it "
            "prints it with --resume, and draws it with --resume --figure FILE.png; "
            "xarray.open_dataset reads it",
        )
    if changed:
        raise seals.damaged(str(path), changed)
    if whole:
        return data
    data.attrs["notes"] = json.dumps([*json.loads(data.attrs["notes"]), REWRITTEN])
    return data


def _kind_of_many(data: xarray.Dataset) -> str:
    """Whether a data set is that of "a sweep" or "an ensemble"; "" for any other."""
    if "identity" not in data.attrs:
        return ""
    settings = json.loads(data.attrs["identity"])["settings"]
    return "a sweep" if "values" in settings else "an ensemble"


def _changed(data: xarray.Dataset) -> str:
    """The first variable whose checksum does not fit, or what else does not; empty if all do."""
    for name, variable in data.variables.items():
        if variable.attrs.get("checksum") != _checksum(str(name), variable):
            return f"{name}"
    whole = data.attrs.get("checksum") == _checksum_of(data.attrs, _names(data))
    return "" if whole else "its description"


def _names(data: xarray.Dataset) -> bytes:
    """The names of all variables, none of which may be lost."""
    return " ".join(sorted(map(str, data.variables))).encode()


def _has_own_hash(image: bytes) -> bool:
    """Whether the file has the hash that version 0.2 wrote into it."""

    def digest(found: re.Match[bytes]) -> bytes:
        content = image[: found.start(1)] + NO_DIGEST + image[found.end(1) :]
        return hashlib.blake2b(content, digest_size=32).hexdigest().encode()

    hashes = re.finditer(HASH + b"([0-9a-f]{64})", image)
    return any(found[1] == digest(found) for found in hashes)


def state_in(data: xarray.Dataset, scene: Scene) -> State:
    arrays = {
        str(name).removeprefix(STATE): variable.values
        for name, variable in data.data_vars.items()
        if _is_of_state(str(name), variable.attrs)
    }
    return State.of_arrays(arrays, data.attrs["method"], scene, data.attrs["version"])


def _is_of_state(name: str, attributes: dict[Any, Any]) -> bool:
    return name.startswith(STATE) and "units" not in attributes


def ledger_of(data: xarray.Dataset, scene: Scene) -> Ledger:
    """The ledger in a data set, but for error estimates and the state."""
    series = {
        str(name): variable.values
        for name, variable in data.data_vars.items()
        if str(name).rpartition(".")[2] in EVERY_QUANTITY
        and not _is_of_state(str(name), variable.attrs)
    }
    surfaces = [surface.name for surface in scene.surfaces]
    names = [name for name in surfaces if f"{name}{OSCILLATORS}" in data]
    oscillators = {name: data[f"{name}{OSCILLATORS}"].values for name in names}
    kept = tuple(scene.output.keep or ())
    found = Ledger.of_flat(data["time"].values, series, surfaces, kept)
    return replace(found, oscillators=oscillators)
