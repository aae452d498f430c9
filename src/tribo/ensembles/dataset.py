"""Ensembles as labelled data: variables of members, their coordinates, and what all share."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

import h5py
import numpy as np

from tribo.ensembles.kept_values import STATUS_TYPE, Kept, KeptValues, Tally
from tribo.ensembles.members import VELOCITY, Members, Variation
from tribo.ensembles.runner import Policy
from tribo.ensembles.stores import MemberStore, Target
from tribo.files import NEW, netcdf_target, not_written, replace_file
from tribo.interrupts import Interrupted
from tribo.kernels.status import Status
from tribo.ledger.quantities import EVERY_QUANTITY, UNITS
from tribo.loops.frames import PART, Frames
from tribo.model.identity import Identity, refuse_other
from tribo.model.initial import UNITS as UNITS_OF_START
from tribo.model.scene import Scene
from tribo.progress import Shown, reported
from tribo.results.dataset import Variable
from tribo.validation import InputError, as_path, boolean

if TYPE_CHECKING:
    import h5netcdf
    import xarray

# Attributes of a data set.
Attributes = dict[str, str | float]
# The attribute that says what a file is of.
IDENTITY = "identity"
# Of a status in a file: numpy's text as bytes.
STATUS, LETTERS = "status", "status_letter"
# Numbers that each run has beside its values.
COUNTS = {
    "steps": "steps of the run",
    "force_evaluations": "evaluations of all forces in the run",
    "level": "level of the tolerances; NaN where settings were searched for",
    "error": "difference from a finer run, relative; NaN where not checked",
}


def counts_of(found: KeptValues) -> dict[str, np.ndarray]:
    """The numbers that each run has beside its values."""
    return {name: getattr(found, name.removeprefix("force_")) for name in COUNTS}


def variables_of(kept: Kept, members: Members, found: KeptValues) -> dict[str, Variable]:
    """The variables that have a value for each member."""
    variables: dict[str, Variable] = {}
    for name, values in found.values.items():
        # The name of a start that is varied is taken.
        own = f"{name}_end" if name in members.values else name
        variables[own] = ("member", *kept.dimensions(name)), values, kept.about(name)
    return variables | {
        name: (("member",), values, {"long_name": COUNTS[name]})
        for name, values in counts_of(found).items()
    }


def coordinates_of(members: Members, found: KeptValues) -> dict[str, Variable]:
    """The coordinates of each member: its number, seed, status and varied values."""
    return {
        "member": (("member",), members.numbers, {"long_name": "member"}),
        "seed": (("member",), members.seeds, {"long_name": "seed of the member"}),
        STATUS: (("member",), found.status, {"long_name": "end of its run"}),
    } | varied_coordinates(members.values)


def varied_coordinates(varied: Mapping[str, np.ndarray]) -> dict[str, Variable]:
    """The varied values (members, size) of each quantity."""
    coordinates: dict[str, Variable] = {}
    for key, values in varied.items():
        surface, _, kind = key.rpartition(".")
        if kind == VELOCITY:
            about = {"units": UNITS["velocity"], "long_name": "initial velocity of the surface"}
            coordinates[key] = (("member", "axis"), values, about)
            coordinates["axis"] = (("axis",), np.array(["x", "y"]), {"long_name": "axis"})
        elif kind not in UNITS_OF_START:
            coordinates[key] = (("member",), values[:, 0], {"long_name": key})
        else:
            quantity = EVERY_QUANTITY["theta" if kind == "swing" else kind]
            about = {"units": quantity.units, "long_name": f"initial {quantity.long_name}"}
            coordinates[key] = (("member", f"{surface}_asperite"), values, about)
    return coordinates


def times_of(kept: Kept, scene: Scene) -> dict[str, Variable]:
    """The times at which quantities are kept."""
    about = {"units": "time", "long_name": "time" if kept.at_samples else "time of the end"}
    return {
        "time": (("time",), scene.times, about) if kept.at_samples else ((), scene.duration, about)
    }


def kept_dataset(
    runs: Policy, members: Members, found: KeptValues, attributes: Mapping[str, str | float]
) -> xarray.Dataset:
    """The data set of some members."""
    import xarray

    coordinates = coordinates_of(members, found) | times_of(runs.kept, runs.simulation.scene)
    return xarray.Dataset(variables_of(runs.kept, members, found), coordinates, attributes)


def common_attributes(scene: Scene) -> Attributes:
    """Attributes of ensembles and sweeps."""
    from tribo import __version__

    versions: Attributes = {"tribo_version": __version__, "numpy_version": np.__version__}
    return versions | {"scene": scene.to_toml()}


def attributes_of(runs: Policy, variation: Variation) -> Attributes:
    """Properties of the whole ensemble; text is JSON where it is no word."""
    plan = runs.simulation.plan
    return common_attributes(runs.simulation.scene) | {
        "method": plan.method,
        "method_alone": plan.method,
        "step": json.dumps(plan.setting if plan.tuned is None else None),
        "accuracy": json.dumps(plan.accuracy),
        "seed": str(variation.seed),
    }


def attributes_of_members(runs: Policy, variation: Variation, count: int) -> Attributes:
    """Properties of an ensemble of which named quantities are kept."""
    own: Attributes = {
        "n": count,
        "keep": json.dumps(runs.kept.names),
        "own_numbers": json.dumps(variation.own_numbers),
    }
    checked: Attributes = {} if runs.plan is None else runs.plan.attributes
    return attributes_of(runs, variation) | own | checked


def at_end(attributes: Attributes, tally: Tally, interrupted: bool, seconds: float) -> Attributes:
    """All attributes, once the runs have ended."""
    return {
        **attributes,
        "status": str(Status.INTERRUPTED if interrupted else Status.COMPLETED),
        "members": json.dumps(tally.status),
        "notes": json.dumps(tally.notes),
        "seconds": seconds,
    }


def write_members(
    path: Path,
    identity: Identity,
    runs: Policy,
    variation: Variation,
    store: MemberStore,
    attributes: Attributes,
) -> xarray.Dataset:
    """Write all members to a file, part by part, and open it.  Raises InputError."""
    import h5netcdf

    new, first = path.with_name(path.name + NEW), 0
    try:
        with h5netcdf.File(new, "w") as file:
            for found in store.parts():
                last = first + found.status.size
                members = variation.members(np.arange(first, last))
                coordinates = coordinates_of(members, found)
                variables = variables_of(runs.kept, members, found) | coordinates
                if first == 0:
                    shared = times_of(runs.kept, runs.simulation.scene)
                    for name, variable in (variables | shared).items():
                        _create_variable(file, name, variable, store.done)
                    names = [n for n in (*coordinates, *shared) if n not in ("member", "axis")]
                    file.attrs.update(attributes)
                    file.attrs.update(
                        {IDENTITY: json.dumps(identity), "coordinates": " ".join(names)}
                    )
                for name, (dimensions, values, _) in variables.items():
                    if dimensions[0] == "member":
                        file[name][first:last] = (
                            _letters(found.status) if name == STATUS else values
                        )
                first = last
        with open(new, "rb") as written:
            os.fsync(written.fileno())
        os.replace(new, path)
    except OSError as error:
        new.unlink(missing_ok=True)
        raise not_written(path, error) from None
    return opened(path, identity)


def _create_variable(file: h5netcdf.File, name: str, variable: Variable, count: int) -> None:
    """Add an array for `count` members, or one that all members share, with its values."""
    dimensions, values, attributes = variable[0], np.asarray(variable[1]), variable[2]
    dtype: object = values.dtype
    if name == STATUS:
        dimensions, values, dtype = ("member", LETTERS), _letters(values), "S1"
        attributes = {**attributes, "_Encoding": "utf-8"}
    elif values.dtype.kind == "U":
        values, dtype = values.astype(object), h5py.string_dtype()
    for dimension, size in zip(dimensions, values.shape, strict=True):
        if dimension not in file.dimensions:
            file.dimensions[dimension] = count if dimension == "member" else size
    array = file.create_variable(name, dimensions, dtype)
    if dimensions[:1] != ("member",):
        array[...] = values
    array.attrs.update(attributes)


def _letters(status: np.ndarray) -> np.ndarray:
    """Statuses as letters, (members, longest status)."""
    size = np.dtype(STATUS_TYPE).itemsize // np.dtype("U1").itemsize
    text = np.ascontiguousarray(np.asarray(status).astype(f"S{size}"))
    return text.view("S1").reshape(text.size, size)


def in_file(
    out: str | Path | None,
    resume: bool,
    identity: Identity,
    progress: Shown,
    total: int,
    unit: str,
    compute: Callable[[Target, Callable[[float], None] | None], xarray.Dataset],
) -> xarray.Dataset:
    """The data set of many runs from their file, if that is complete; else it is computed.

    Raises KeyboardInterrupt, with the data set so far, if that was interrupted, and InputError if
    the file cannot be used, is of other runs, or is written by another process.
    """
    path = None if out is None else netcdf_target("out", as_path(out))
    if boolean("resume", resume) and path is None:
        raise InputError("resume", "needs out, the file to continue")
    with ExitStack() as stack, reported(progress, total, unit) as report:
        frames = None
        if path is not None:
            part = path.with_name(path.name + PART)
            if resume and path.exists() and not part.exists():
                return opened(path, identity)
            frames = stack.enter_context(Frames(part, identity, resume))
        data = compute(Target(path, identity, frames), report)
    if data.attrs["status"] == Status.INTERRUPTED:
        raise Interrupted(data)
    return data


def saved(data: xarray.Dataset, target: Target) -> xarray.Dataset:
    """The data set; if it is complete it is in its file too, in place of the frames."""
    if target.path is not None and data.attrs["status"] == Status.COMPLETED:
        data.attrs[IDENTITY] = json.dumps(target.identity)
        replace_file(target.path, bytes(data.to_netcdf(engine="h5netcdf")))
        assert target.frames is not None
        target.frames.remove()
    return data


def opened(path: Path, identity: Identity) -> xarray.Dataset:
    """The data set in a file, whose values are read when they are used.

    Raises InputError if the file is of something else.
    """
    import xarray

    try:
        with h5py.File(path) as file:
            before: Identity = json.loads(file.attrs[IDENTITY])
    except (OSError, KeyError, ValueError):
        raise InputError(
            str(path), "is no such file of this version; start again without resume"
        ) from None
    refuse_other(path, before, json.loads(json.dumps(identity)))
    # A file object, since HDF5 would not let this process write to a file that it has open.
    return xarray.open_dataset(open(path, "rb"), engine="h5netcdf")
