"""Measured heights: a scan, read by SurfaceTopography, and its heights at the asperites.

A peak of the scan points toward the other surface: a surface that faces down has the scan's
heights with the opposite sign.  x of the scan is x of the surface, and y of the scan is z.
"""

from __future__ import annotations

import codecs
import io
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tribo import validation as check
from tribo.decimal_commas import decimal_comma
from tribo.model.tables import ComparedByValue, table_of
from tribo.validation import InputError, inside, must_be

# Metres in a unit of length, by the names that SurfaceTopography gives the units of files.
METRES = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "nm": 1e-9}
METRES |= {"A": 1e-10, "Å": 1e-10, "pm": 1e-12}
# SurfaceTopography's name of each trend that is subtracted; None leaves the heights unchanged.
TRENDS = {"plane": "height", "mean": "center", "curvature": "curvature", "none": None}
# Spreads of most heights beyond which one is noted: of -9999, say, where there is none.
OUTLYING = 100.0
# The characters of rows of numbers.
NUMERIC = frozenset("0123456789+-.eE,; \t")
# Bytes of a file that tell which separators it has.
BEGINNING = 100_000
# Coordinates and height of a point, which may have commas or semicolons between them.
POINT = 3
# Ratio up to which two lengths are the same, in spite of rounding.
ROUNDING = 1.0 + 1e-9


class Grid(NamedTuple):
    """The places of the asperites at which a scan is sampled."""

    shape: tuple[int, int]
    spacing: tuple[float, float]
    facing_sign: float  # +1 for a surface that faces down


class Sampled(NamedTuple):
    grid: Grid
    heights: np.ndarray  # (n,) shifts in y, x running fastest [length]
    undefined: int  # points of the scan that have no height, or one that is not finite
    points: int  # all of them
    outliers: int  # points so far from the others that their heights may stand for none


@dataclass(frozen=True, eq=False)
class Topography(ComparedByValue):
    """A measured topography, from which the heights of a surface are interpolated.

    Each asperite has the scan's height at its place, by linear interpolation.  Details of the scan
    that are smaller than the spacing are not averaged.

    Attributes
    ----------
    topography : str or path or object
        A file in a format that SurfaceTopography reads, or one of its topographies or line scans.
        Each line of a matrix as text runs along x; of an array of numpy, the first index is that
        of x.
    unit : str or float, optional
        The scene's unit of length: "m", "mm", "um", "nm", "A" or "pm", or a number of metres.
        Required if the scan has a unit of its own; without one, its lengths are the scene's.
    detrend : str, optional
        The trend that is subtracted from the whole scan: "plane" (fitted by least squares), "mean",
        "curvature" (a polynomial of degree 2) or "none".  None stands for "mean" if the scan is
        periodic, since a plane would make a step where it repeats, and for "plane" otherwise.
    origin : (float, float), optional
        Place on the scan of the grid's corner with the lowest x and z [length].  None for the
        scan's own corner, where the grid covers the whole scan.
    channel : str or int, optional
        Name or number, from 0, of the channel of the file; None for its default.
    size : float or (float, float), optional
        Size of the scan along x, or along x and z [length], of a file that has none, as a matrix of
        numbers; its heights are then lengths of the scene.
    sampled : Sampled, optional
        The heights at the asperites; set by the surface that has this topography.

    Raises
    ------
    InputError
        If a value is out of range, SurfaceTopography is not installed, the file cannot be read, or
        the scan does not cover the surface.
    """

    topography: Any  # a path, or a topography or line scan of SurfaceTopography
    unit: str | float | None = None
    detrend: str | None = None
    origin: tuple[float, float] | None = None
    channel: str | int | None = None
    size: float | tuple[float, float] | None = None
    sampled: Sampled | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        """Check the settings; a file is read later, when heights are needed."""
        if isinstance(self.topography, (str, PathLike)):
            with inside("topography"):
                file = str(check.as_path(self.topography).absolute())
            object.__setattr__(self, "topography", file)
        elif isinstance(self.topography, np.ndarray):
            problem = "must be a file or a topography, got an array; SurfaceTopography makes one of"
            raise InputError("topography", f"{problem} it: Topography(heights, (size_x, size_z))")
        elif not hasattr(self.topography, "positions_and_heights"):
            raise must_be("topography", "a file or a topography", self.topography)
        if isinstance(self.unit, str):
            check.choice("unit", self.unit, METRES)
        elif self.unit is not None:
            check.fields(self, unit=check.one(check.POSITIVE, "m"))
        if self.detrend is not None:
            check.choice("detrend", self.detrend, TRENDS)
        for name in ("channel", "size"):
            if getattr(self, name) is not None and not isinstance(self.topography, str):
                raise InputError(name, "needs a file as the topography")
        if not isinstance(self.channel, str | None):
            check.integer("channel", self.channel, 0)
        kind = check.pair if check.is_list(self.size) else check.one
        check.fields(self, size=kind(check.POSITIVE, "length"))
        check.fields(self, origin=check.pair(unit="length"))

    @property
    def heights(self) -> np.ndarray:
        """(n,) shifts in y of the asperites of its surface [length]."""
        assert self.sampled is not None
        return self.sampled.heights

    def on(self, grid: Grid) -> Topography:
        """The same topography, sampled at the asperites of a grid."""
        if self.sampled is not None and self.sampled.grid == grid:
            return self
        scan = self._scan()
        undefined = _undefined(scan)
        if np.all(undefined):
            raise InputError("topography", "must have finite heights: no point of the scan has one")
        heights = -grid.facing_sign * self._heights(scan, grid.shape, grid.spacing)
        heights.flags.writeable = False
        number = int(np.count_nonzero(undefined))
        sampled = Sampled(grid, heights, number, undefined.size, _outliers(scan))
        return replace(self, sampled=sampled)

    def _scan(self) -> Any:
        """The scan, read from its file if it is in one."""
        if not isinstance(self.topography, str):
            return self.topography
        given: dict[str, Any] = {"channel": self.channel, "size": self.size}
        return _read(
            self.topography, **{key: each for key, each in given.items() if each is not None}
        )

    def _heights(
        self, scan: Any, shape: tuple[int, int], spacing: tuple[float, float]
    ) -> np.ndarray:
        """(nx nz,) heights of the scan at the asperites, x running fastest [length]."""
        from scipy.interpolate import RegularGridInterpolator

        length = self._length_of(scan.unit)
        scan = _defined(scan)
        is_periodic = getattr(scan, "is_periodic", False)
        trend = TRENDS[self.detrend or ("mean" if is_periodic else "plane")]
        if trend is not None:
            scan = scan.detrend(trend)
        axes, heights = _axes_and_heights(scan)
        axes = [length * (axis - axis[0]) for axis in axes]
        places = self._places(axes, shape, spacing)
        at = np.stack(np.meshgrid(*places, indexing="ij"), axis=-1)
        return length * RegularGridInterpolator(axes, heights)(at).T.ravel()

    def _length_of(self, unit: str | None) -> float:
        """The scan's unit [length]."""
        if unit is None:
            if self.unit is not None:
                raise InputError(
                    "unit",
                    "has no meaning for a scan without a unit; leave it out [length], and write "
                    "its numbers in the scene's unit",
                )
            return 1.0
        if unit not in METRES:
            raise InputError("topography", f'must have a unit of length, got "{unit}"')
        if self.unit is None:
            raise InputError(
                "unit",
                f'is missing; the scan is in {unit}: give the scene\'s unit of length, as "nm" '
                "or as a number of metres",
            )
        return METRES[unit] / (METRES[self.unit] if isinstance(self.unit, str) else self.unit)

    def _places(
        self, axes: list[np.ndarray], shape: tuple[int, int], spacing: tuple[float, float]
    ) -> list[np.ndarray]:
        """The asperites' places on each axis of the scan [length]."""
        if any(n > 1 and s == 0.0 for n, s in zip(shape, spacing, strict=True)):
            raise InputError(
                "topography", "needs a spacing along every direction with more than one asperite"
            )
        directions = [0, 1]
        if len(axes) == 1:
            if min(shape) > 1:
                raise InputError(
                    "topography", f"is a line scan; the surface must be a row, got {shape}"
                )
            directions = [int(shape[1] > 1)]
        places = []
        for axis, k in zip(axes, directions, strict=True):
            place = np.arange(shape[k]) * abs(spacing[k])
            room = axis[-1] * ROUNDING - place[-1]
            first = 0.0 if self.origin is None else self.origin[k]
            if not 0.0 <= first <= max(room, 0.0) or room < 0.0:
                raise InputError(
                    "topography",
                    f"must cover the surface along {'xz'[k]}: the scan reaches to {axis[-1]:g}, "
                    f"the asperites from {first:g} to {first + place[-1]:g} [length]",
                )
            if self.origin is None and abs(spacing[k]) <= room * ROUNDING:
                raise InputError(
                    "origin",
                    f"is missing: the surface is smaller than the scan along {'xz'[k]}, "
                    f"{place[-1]:g} of {axis[-1]:g} [length]; give the place [x, z] on the scan "
                    "of its corner",
                )
            if spacing[k] < 0.0:
                place = place[::-1]
            places.append(np.minimum(first + place, axis[-1]))
        return places


def _axes_and_heights(scan: Any) -> tuple[list[np.ndarray], np.ndarray]:
    """The coordinates along each axis, and the heights on their grid [unit of the scan]."""
    *positions, heights = (np.asarray(each, float) for each in scan.positions_and_heights())
    if heights.ndim != len(positions) or min(heights.shape) < 2:
        raise InputError("topography", "must have two or more points along each axis")
    axes = [positions[0]] if len(positions) == 1 else [positions[0][:, 0], positions[1][0]]
    if any(np.any(np.diff(axis) <= 0.0) for axis in axes):
        raise InputError("topography", "must have positions that increase, without overhangs")
    if not np.all(np.isfinite(heights)):
        raise InputError("topography", "must have finite heights")
    return axes, heights


def _undefined(scan: Any) -> np.ndarray:
    """Which points of a scan have no finite height."""
    heights = np.ma.masked_invalid(scan.positions_and_heights()[-1])
    return np.ma.getmaskarray(heights)


def _outliers(scan: Any) -> int:
    """How many points are farther from most of the others than these are from one another.

    Most are eight of ten: a peak or a step on a flat surface is none.
    """
    heights = np.ma.masked_invalid(scan.positions_and_heights()[-1]).compressed()
    low, high = np.percentile(heights, [10.0, 90.0])
    beyond = np.maximum(low - heights, heights - high)
    return int(np.count_nonzero(beyond > OUTLYING * (high - low)))


def _defined(scan: Any) -> Any:
    """The scan with values that are interpolated where it has none."""
    if scan.has_undefined_data:
        return scan.interpolate_undefined_data()
    if scan.dim > 1:
        return scan
    # Undefined points of line scans with unequal steps are nan, of which the library says nothing.
    x, heights = (np.asarray(each, float) for each in scan.positions_and_heights())
    known = np.isfinite(heights)
    if np.all(known) or np.count_nonzero(known) < 2:
        return scan
    from SurfaceTopography import NonuniformLineScan

    return NonuniformLineScan(x, np.interp(x, x[known], heights[known]), unit=scan.unit)


def _read(path: str, channel: str | int | None = None, size: Any = None) -> Any:
    """A topography of SurfaceTopography from a file; wrong settings and files raise InputError."""
    if not Path(path).is_file():
        raise InputError("topography", f"{path} cannot be read (no such file)")
    try:
        from SurfaceTopography import open_topography
        from SurfaceTopography.Exceptions import (
            CannotDetectFileFormat,
            MetadataAlreadyFixedByFile,
        )
    except ImportError:
        raise InputError(
            "topography", "needs SurfaceTopography: pip install '.[topography]' in the checkout"
        ) from None
    _check_separators(path)
    settings: dict[str, Any] = {}
    if size is not None:
        settings["physical_sizes"] = tuple(np.atleast_1d(size).tolist())
    try:
        with np.errstate(all="ignore"), open_topography(_without_mark(path)) as reader:
            if channel is not None:
                settings["channel_index"] = _index_of(channel, [c.name for c in reader.channels])
            number = settings.get("channel_index", reader.default_channel.index)
            chosen = reader.channels[number]
            if size is not None:
                _check_sizes(size, chosen.dim)
            if chosen.physical_sizes is None:
                # Without a size, so that those of points are not told to give one.
                scan = reader.topography(**{"physical_sizes": (1.0,) * chosen.dim} | settings)
                _check_no_points(scan)
                if size is not None:
                    return scan
            return reader.topography(**settings)
    except InputError:
        raise
    except MetadataAlreadyFixedByFile:
        raise InputError("size", "must be left out: the file states the size of the scan") from None
    except CannotDetectFileFormat:
        raise InputError(
            "topography",
            f"{path} cannot be read: it has no format that SurfaceTopography knows; a matrix of "
            "heights may be text with blanks between numbers and points in them, or a .npy file",
        ) from None
    # Each of its readers of some forty formats raises errors of its own.
    except Exception as error:
        problem = str(error).strip().split("\n")[0]
        raise InputError(
            "topography",
            f"{path} cannot be read ({problem}); in Python, give the object "
            "that SurfaceTopography reads from it; the key size gives a size that is missing",
        ) from None


def _check_separators(path: str) -> None:
    """Refuse text of numbers with decimal commas, or a matrix with commas.  Raises InputError.

    Of its size, a reader of binary heights may take such a text for its own.
    """
    with open(path, "rb") as file:
        start = file.read(BEGINNING)
    lines = start.decode("utf-8-sig", errors="replace").splitlines()
    if len(start) == BEGINNING:
        lines = lines[:-1]  # which may end anywhere
    rows = [line.strip() for line in lines if line.strip() and line.lstrip()[0] != "#"]
    if not rows or not NUMERIC.issuperset("".join(rows)):
        return
    comma = decimal_comma(rows)
    if comma is not None:
        problem = f"a decimal comma in the line {check.short_repr(comma)}; write 0.5 for 0,5"
    elif rows[0].count(";") >= POINT:
        problem = "semicolons between numbers; write blanks"
    elif rows[0].count(",") >= POINT:
        problem = "commas between numbers; write blanks"
    else:
        return
    raise InputError(
        "topography", f"{path} must have decimal points and blanks between numbers, got {problem}"
    )


def _check_no_points(scan: Any) -> None:
    """Refuse a matrix of three columns, which may be places and heights.  Raises InputError.

    Readers take points that are no whole grid for a matrix of heights.
    """
    columns = np.asarray(scan.positions_and_heights()[-1], float)
    if columns.ndim != 2 or columns.shape[0] != 3 or columns.shape[1] <= 3:
        return
    x, y = (np.unique(column).size for column in columns[:2])
    rows = columns.shape[1]
    if max(x, y) < rows <= x * y:
        raise InputError(
            "topography",
            f"has three columns, of which the first two are places: {rows} of {x} x {y} points; "
            "give those that are missing too, with the height nan",
        )
    raise InputError(
        "topography",
        f"has three columns of {rows} numbers, which may be places and heights: points must be a "
        "whole grid, each of them once, with the height nan where there is none; heights of three "
        "lines go in as an object of SurfaceTopography",
    )


def _check_sizes(size: Any, axes: int) -> None:
    """Refuse sizes that are not one for each axis of a scan.  Raises InputError."""
    if np.size(size) != axes:
        wanted = "one length, of a line scan" if axes == 1 else "two lengths, [x, z], of a grid"
        raise must_be("size", wanted, size)


def _without_mark(path: str) -> str | io.BytesIO:
    """The file, or its content behind a byte order mark, with which readers of text lose a row."""
    with open(path, "rb") as file:
        marked = file.read(len(codecs.BOM_UTF8)) == codecs.BOM_UTF8
        return io.BytesIO(file.read()) if marked else path


def _index_of(channel: str | int, names: list[str]) -> int:
    """The number of a channel of a file.  Raises InputError."""
    if isinstance(channel, int) and channel < len(names):
        return channel
    if channel in names:
        return names.index(str(channel))
    known = check.shortened(f'"{name}"' for name in names)
    raise must_be("channel", f"one of {known}, or a number below {len(names)}", channel)


KEYS = [each.name for each in fields(Topography) if each.name != "sampled"]


def is_topography(value: object) -> bool:
    """Whether the `heights` of a surface are a topography, its table or SurfaceTopography's."""
    if isinstance(value, Mapping):
        return "topography" in value
    return isinstance(value, Topography) or hasattr(value, "positions_and_heights")


def as_topography(value: object, folder: Path = Path()) -> Topography:
    """A topography from its table in a scene file; relative paths are relative to `folder`."""
    if isinstance(value, Topography):
        return check.as_parent(value, [Topography])  # type: ignore[no-any-return]
    if not isinstance(value, Mapping):
        return Topography(value)
    settings = check.known_keys(value, KEYS)
    if isinstance(settings["topography"], str):
        settings["topography"] = folder / settings["topography"]
    return Topography(**settings)


def as_table(topography: Topography, folder: Path) -> dict[str, object]:
    """The table in a scene file in `folder`; paths of files below the folder are relative."""
    path = Path(topography.topography)
    home = folder.absolute()
    place = path.relative_to(home) if path.is_relative_to(home) else path
    table = table_of(topography) | {"topography": place.as_posix()}
    return {key: table[key] for key in KEYS if key in table}
