"""Files that are written whole or not at all."""

from __future__ import annotations

import json
import math
import os
import stat
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, Literal

from tribo import system
from tribo.system import longest_name, replace
from tribo.validation import InputError

if TYPE_CHECKING:
    import netCDF4
    import xarray


def checked_target(field: str, path: Path) -> Path:
    """The file that a path names, behind links.

    Raises InputError about `field` where no file could be written: a folder, a pipe or a device, or
    in a folder that does not exist or cannot be written.
    """
    try:
        path = Path(os.path.realpath(path))
        folder = path.parent
        kind = path.lstat().st_mode if os.path.lexists(path) else stat.S_IFREG
        exists = folder.is_dir()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(field, f"must be the name of a file ({reason})") from None
    if not exists:
        raise InputError(field, f"must be in a folder that exists, got {folder}")
    if stat.S_ISDIR(kind):
        raise InputError(field, f"must be the name of a file, got the folder {path}")
    if not stat.S_ISREG(kind):
        raise InputError(field, f"must be a regular file, got the pipe or device {path}")
    if not os.access(folder, os.W_OK):
        raise InputError(field, f"must be in a folder that can be written, got {folder}")
    limit = longest_name(folder)
    if len(os.fsencode(path.name)) + len(NEW) > limit:
        raise InputError(field, f"must be a name of at most {limit - len(NEW)} bytes")
    return path


def netcdf_target(field: str, path: Path, others: str = "") -> Path:
    """The NetCDF file that a path names, behind links; for `others` a caller writes other formats.

    Raises InputError about `field`, which says what writes figures and pages.
    """
    target = checked_target(field, path)
    if path.suffix.lower() != NETCDF:
        is_option = field.startswith("--")
        figures = "--figure" if is_option else "tribo.plotting.save"
        page = "tribo view" if is_option else "result.to_html"
        raise InputError(
            field,
            f"must end on .nc{others}, as it is a NetCDF file{others and ' or a table'}, got "
            f"{str(path)!r}; {figures} writes figures, and {page} a page",
        )
    return target


def page_target(field: str, path: Path) -> Path:
    """The page of HTML that a path names, behind links.  Raises InputError about `field`."""
    target = checked_target(field, path)
    if path.suffix.lower() not in PAGES:
        raise InputError(field, f"must end on .html, as it is a page, got {str(path)!r}")
    return target


# The endings of names of pages.
PAGES = (".html", ".htm")
# The ending of names of NetCDF files.
NETCDF = ".nc"
# What follows the name of a file that has what a computation has finished, before it is complete.
PART = ".part"
# What follows the name of a file while it is written; the longest such addition to a name.
NEW = f"{PART}.new"


@contextmanager
def replaced(path: Path) -> Iterator[Path]:
    """A new file that takes the place of another once all is on disk.  Raises InputError."""
    new = path.with_name(path.name + NEW)
    try:
        yield new
        with open(new, "r+b") as file:
            os.fsync(file.fileno())
        replace(new, path)
    except OSError as error:
        new.unlink(missing_ok=True)
        raise not_written(path, error) from None


def replace_file(path: Path, content: bytes) -> None:
    """Write a file whole, or leave the one that was there.  Raises InputError."""
    with replaced(checked_target(str(path), path)) as new:
        new.write_bytes(content)


def replace_netcdf(path: Path, data: xarray.Dataset, sealed: Callable[[bytes], bytes]) -> None:
    """Write a data set to a file whole, its bytes `sealed`.  Raises InputError."""
    with replaced(checked_target(str(path), path)) as new:
        write_netcdf(data, new)
        new.write_bytes(sealed(new.read_bytes()))


@contextmanager
def netcdf_file(
    path: str | Path, mode: Literal["r", "w", "a"] = "r", memory: bytes | None = None
) -> Iterator[netCDF4.Dataset]:
    """An open NetCDF file, on disk or, with its bytes, in memory.

    The NetCDF library is not made for threads: one has it at a time, by the lock that xarray has
    for what it reads later.  Raises OSError.
    """
    import netCDF4
    from xarray.backends.netCDF4_ import NETCDF4_PYTHON_LOCK

    with NETCDF4_PYTHON_LOCK:
        try:
            file = netCDF4.Dataset(path, mode, memory=memory)
            try:
                yield file
            finally:
                if file.isopen():
                    file.close()
        except RuntimeError as error:  # of the NetCDF library, as where a disk is full
            raise OSError(str(error)) from None


def write_netcdf(data: xarray.Dataset, path: Path, **how: Any) -> None:
    """Write a data set as NetCDF; `how` are `encoding` and `unlimited_dims` of xarray.

    Raises OSError.
    """
    with netcdf_file(path, "w") as file:
        _dump(data, file, **how)


def netcdf_image(data: xarray.Dataset) -> bytes:
    """The bytes of a NetCDF file with a data set.  Raises OSError.

    In a file that the library makes in memory, variables lose their order.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "image.nc"
        write_netcdf(data, path)
        return path.read_bytes()


def _dump(data: xarray.Dataset, file: netCDF4.Dataset, **how: Any) -> None:
    """Write a data set into an open file.

    ``data.to_netcdf`` would take a lock of the cluster while a client of Dask is open.  It may wait
    for it without end, and no cluster knows a file in memory.
    """
    from xarray.backends import NetCDF4DataStore

    data.dump_to_store(NetCDF4DataStore(file, lock=False), **how)


def netcdf_in(image: bytes) -> xarray.Dataset:
    """The data set in the bytes of a NetCDF file.  A damaged file may raise anything."""
    import xarray
    from xarray.backends import NetCDF4DataStore

    with netcdf_file("image", memory=image) as file:
        data = xarray.open_dataset(NetCDF4DataStore(file, lock=False)).load()
        data.set_close(None)  # the file is closed here
    return data


def netcdf_attributes(path: str | Path, image: bytes | None = None) -> dict[str, Any]:
    """The attributes of a NetCDF file, whose bytes may be given.  Raises OSError."""
    with netcdf_file(path, memory=image) as file:
        return dict(file.__dict__)


def append_netcdf(path: Path, data: xarray.Dataset, dimension: str, first: int) -> None:
    """Append to the variables of a file along its unlimited dimension, at an index.

    Texts are letters of a fixed number in the file.  Raises OSError.
    """
    import netCDF4

    with netcdf_file(path, "a") as file:
        file.set_auto_chartostring(False)
        for name, variable in data.variables.items():
            if variable.dims[:1] == (dimension,):
                array = file.variables[str(name)]
                values = variable.values
                if values.dtype.kind == "U":
                    values = netCDF4.stringtochar(values.astype(f"S{array.shape[1]}"))
                array[first : first + len(variable)] = values


def read_file(path: Path) -> bytes:
    """The content of a file.  Raises InputError."""
    try:
        return path.read_bytes()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(str(path), f"cannot be read ({reason})") from None


def not_written(path: Path, error: OSError) -> InputError:
    return InputError(str(path), f"cannot be written ({error.strerror or error})")


def lock(file: BinaryIO, path: Path) -> None:
    """Lock an open file for this process.  Raises InputError, and closes it, if another has it."""
    try:
        system.lock(file)
    except BlockingIOError:
        file.close()
        raise InputError(str(path), "is being written by another process") from None


def strict_json(value: object, indent: int | None = 1) -> str:
    """Nested data as JSON, with null for every float that JSON cannot represent."""
    return json.dumps(_without_nan(value), indent=indent, allow_nan=False)


def _without_nan(value: object) -> object:
    if isinstance(value, dict):
        return {key: _without_nan(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_without_nan(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
