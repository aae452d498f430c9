"""A NetCDF file that takes members while they are computed, and that a later call continues.

The file has its full size from the beginning.  All its arrays are contiguous, so values are written
at known places and nothing else in the file changes: it can be read at any time, also after a kill.
A member is complete once its status is written, which happens after its values are on disk.
"""

from __future__ import annotations

import json
import os
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, NamedTuple

import h5py
import numpy as np

from tribo.ensembles.kept_values import (
    STATUS_TYPE,
    KeptValues,
    Tally,
    coordinates_of,
    of_members,
    times_of,
)
from tribo.ensembles.members import Members
from tribo.ensembles.stores import About, Target
from tribo.files import NEW, locked, not_written
from tribo.loops.journal import INTERVAL
from tribo.model.identity import Identity, refuse_other
from tribo.results.dataset import Variable
from tribo.system import replace
from tribo.validation import InputError

if TYPE_CHECKING:
    import h5netcdf
    import xarray

# The attribute that says which ensemble a file is of.
IDENTITY = "identity"
STATUS = "status"
# Letters of a status: numpy's text as bytes.
LETTERS = "status_letter"
# Members that are read at a time to count them.
READ = 2**20


class Place(NamedTuple):
    """Where an array stands in the file: its first byte, the type and shape of a member's part."""

    offset: int
    dtype: np.dtype[Any]
    shape: tuple[int, ...]

    @property
    def size(self) -> int:
        """Bytes of one member."""
        return int(self.dtype.itemsize * np.prod(self.shape, dtype=int))


class MemberFile:
    """A store of members in a file; see :class:`tribo.ensembles.stores.Store`.

    Parameters
    ----------
    about : About
        What is known of the ensemble.
    target : Target
        The files.
    resume : bool
        Whether to continue the part, if there is one; else it is replaced.

    Raises
    ------
    InputError
        The part is of another ensemble, is no such file, or another process writes it.
    """

    def __init__(self, about: About, target: Target, resume: bool) -> None:
        self._about = about
        self._path, self._part, identity = target
        self._identity = json.dumps(identity)
        self._places: dict[str, Place] = {}
        self._file: BinaryIO | None = None
        self._waiting: list[tuple[int, np.ndarray]] = []  # statuses of members, with the first
        self._written = time.perf_counter()
        self._tally = Tally()
        self.done = 0
        if not self._part.exists():
            return
        locked(self._part).close()
        if resume:
            refuse_other(self._part, identity_in(self._part), json.loads(self._identity))
            self._open()
            self.done = self._complete()
            self._count()

    def add(self, members: Members, found: KeptValues) -> None:
        """Write the next members; their statuses once a second, after all else is on disk."""
        variables = of_members(self._about.kept, members, found)
        coordinates = coordinates_of(members, found)
        try:
            if self._file is None:
                self._create(variables, coordinates)
                self._open()
            rows = variables | coordinates
            for name, place in self._places.items():
                if name != STATUS:
                    self._write(place, self.done, np.asarray(rows[name][1]))
        except OSError as error:
            raise not_written(self._part, error) from None
        self._waiting.append((self.done, found.status))
        self._tally.add(found.status, found.level, found.error, self._about.common_level)
        self.done += members.numbers.size
        if time.perf_counter() - self._written > INTERVAL:
            self._flush()

    def dataset(self, interrupted: bool, seconds: float) -> xarray.Dataset:
        """The data set, whose values are read from the file when they are used."""
        if self._file is None:
            raise KeyboardInterrupt
        self._flush()
        self._file.close()
        attributes = self._about.attributes_at_end(self._tally, interrupted, seconds)
        with h5py.File(self._part, "r+") as file:
            file.attrs.update(attributes)
        if interrupted:
            return opened(self._part).isel(member=slice(0, self.done))
        replace(self._part, self._path)
        return opened(self._path)

    def _create(self, variables: dict[str, Variable], coordinates: dict[str, Variable]) -> None:
        """Write the file without members; the variables are those of some of them."""
        import h5netcdf

        about, new = self._about, self._part.with_name(self._part.name + NEW)
        coordinates = coordinates | times_of(about.kept, about.simulation)
        names = " ".join(name for name in coordinates if name not in ("member", "axis"))
        with h5netcdf.File(new, "w") as file:
            for name, variable in (variables | coordinates).items():
                _create_variable(file, name, variable, about.count)
            file.attrs.update(about.attributes)
            file.attrs.update({IDENTITY: self._identity, "coordinates": names})
        replace(new, self._part)

    def _open(self) -> None:
        """Open the file for this process alone, and find its arrays."""
        with h5py.File(self._part) as file:
            for name, array in file.items():
                if array.shape[:1] == (self._about.count,) and array.id.get_offset():
                    if "member" not in (array.dims[0].keys() or [name]):
                        continue
                    self._places[name] = Place(array.id.get_offset(), array.dtype, array.shape[1:])
        self._file = locked(self._part)

    def _write(self, place: Place, first: int, values: np.ndarray) -> None:
        assert self._file is not None
        self._file.seek(place.offset + first * place.size)
        self._file.write(np.ascontiguousarray(values, place.dtype).tobytes())

    def _read(self, name: str, first: int, last: int) -> np.ndarray:
        """The values of one array in some members."""
        assert self._file is not None
        place = self._places[name]
        self._file.seek(place.offset + first * place.size)
        content = self._file.read((last - first) * place.size)
        return np.frombuffer(content, place.dtype).reshape(-1, *place.shape)

    def _flush(self) -> None:
        """Write the statuses that wait, once all values are on disk."""
        assert self._file is not None
        try:
            os.fsync(self._file.fileno())
            for first, status in self._waiting:
                self._write(self._places[STATUS], first, _letters(status))
            os.fsync(self._file.fileno())
        except OSError as error:
            raise not_written(self._part, error) from None
        self._waiting.clear()
        self._written = time.perf_counter()

    def _complete(self) -> int:
        """The number of complete members in the file."""
        count = self._about.count
        for first in range(0, count, READ):
            letters = self._read(STATUS, first, min(first + READ, count))[:, 0]
            if not letters.all():
                return first + int(np.argmax(letters == b""))
        return count

    def _count(self) -> None:
        """Take the members that the file has into the tally."""
        for first in range(0, self.done, READ):
            last = min(first + READ, self.done)
            level, error = (self._read(name, first, last) for name in ("level", "error"))
            letters = self._read(STATUS, first, last)
            status = letters.view(f"S{letters.shape[1]}")[:, 0].astype(STATUS_TYPE)
            self._tally.add(status, level, error, self._about.common_level)


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
    if dimensions[:1] == ("member",):
        array[:1] = np.zeros_like(values[:1])  # takes the place of all members
    else:
        array[...] = values
    array.attrs.update(attributes)


def _letters(status: np.ndarray) -> np.ndarray:
    """Statuses as letters, (members, longest status)."""
    size = np.dtype(STATUS_TYPE).itemsize // np.dtype("U1").itemsize
    text = np.ascontiguousarray(status.astype(f"S{size}"))
    return text.view("S1").reshape(status.size, size)


def identity_in(path: Path) -> Identity:
    """What a file is of.  Raises InputError if it is of no ensemble."""
    try:
        with h5py.File(path) as file:
            found: Identity = json.loads(file.attrs[IDENTITY])
    except (OSError, KeyError, ValueError):
        raise InputError(
            str(path), "is not the file of an ensemble; start again without resume"
        ) from None
    return found


def opened(path: Path) -> xarray.Dataset:
    """The data set in a file, whose values are read when they are used."""
    import xarray

    # A file object, since HDF5 would not let this process write to a file that it has open.
    return xarray.open_dataset(open(path, "rb"), engine="h5netcdf")
