"""The file of many runs: complete, or beside it the frames of those that are done."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import h5py
import numpy as np

from tribo.files import netcdf_target, replace_file, replaced
from tribo.interrupts import Interrupted
from tribo.kernels.status import Status
from tribo.loops.frames import PART, Frames
from tribo.model.identity import Identity, refuse_other
from tribo.progress import Shown, reported
from tribo.validation import InputError, as_path, boolean

if TYPE_CHECKING:
    import xarray

# The attribute that says what a file is of.
IDENTITY = "identity"


class Target(NamedTuple):
    """The file of many runs, what it is of, and the frames beside it; None without a file."""

    path: Path | None
    identity: Identity
    frames: Frames | None

    def saved(self, data: xarray.Dataset) -> xarray.Dataset:
        """The data set; if it is complete it is in its file too, in place of the frames."""
        if self.path is not None and data.attrs["status"] == Status.COMPLETED:
            data.attrs[IDENTITY] = json.dumps(self.identity)
            replace_file(self.path, bytes(data.to_netcdf(engine="h5netcdf")))
            assert self.frames is not None
            self.frames.remove()
        return data

    def saved_in_parts(self, parts: Iterable[xarray.Dataset]) -> xarray.Dataset:
        """Members that memory need not hold at once, from their file.  Raises InputError."""
        assert self.path is not None and self.frames is not None
        with replaced(self.path) as new:
            for data in parts:
                _append(new, data.assign_attrs({IDENTITY: json.dumps(self.identity)}))
        self.frames.remove()
        return opened(self.path, self.identity)


def _append(path: Path, data: xarray.Dataset) -> None:
    """Append members to a file; a part that begins with member 0 replaces the file."""
    first = int(data["member"][0])
    if first == 0:
        bytes_of_text = {"dtype": "S1"}  # a fixed number for each, in place of objects
        encoding = {"status": bytes_of_text}
        data.to_netcdf(path, engine="h5netcdf", unlimited_dims=["member"], encoding=encoding)
        return
    with h5py.File(path, "r+") as file:
        for name, variable in data.variables.items():
            if variable.dims[:1] == ("member",):
                array = file[str(name)]
                values, letters = variable.values, array.shape[1:]
                if values.dtype.kind == "U":
                    values = np.char.encode(values, "utf-8").astype(f"S{letters[0]}").view("S1")
                    values = values.reshape(-1, *letters)
                array.resize(first + len(variable), axis=0)
                array[first:] = values


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
