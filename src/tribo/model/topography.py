"""Heights from measured surfaces, by the library SurfaceTopography.

T. D. B. Jacobs et al., Surf. Topogr.: Metrol. Prop. 10 (2022) 035034.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Protocol, TypeGuard

import numpy as np

from tribo.validation import InputError, choice, known_keys, must_be, number, vector

# Keys of the table of a topography.
KEYS = ("topography", "format", "unit", "scale", "detrend", "origin")
# What is subtracted from a scan, with the degree of its polynomial in x and z.
DETREND = {"none": -1, "mean": 0, "plane": 1, "curvature": 2}
# By how much asperites may lie beyond a scan, in pixels: less than rounding can shift them.
ROUNDING = 1e-6


class Scan(Protocol):
    """What is used of a topography of SurfaceTopography."""

    unit: str | None
    is_periodic: bool
    is_uniform: bool
    physical_sizes: tuple[float, ...]

    def heights(self) -> np.ndarray: ...
    def to_unit(self, unit: str) -> Scan: ...


def is_topography(value: object) -> bool:
    """Whether the `heights` of a surface are a topography, or the table of one."""
    return _is_scan(value) or (isinstance(value, Mapping) and "topography" in value)


def with_folder(value: object, folder: Path) -> object:
    """The `heights` of a scene file in a folder, to which its topography is relative."""
    if isinstance(value, Mapping) and isinstance(value.get("topography"), str):
        return {**value, "topography": str(folder / value["topography"])}
    return value


def resampled(value: object, points: np.ndarray) -> np.ndarray:
    """Heights at the asperites of a surface, interpolated linearly in a scan.

    Parameters
    ----------
    value : topography of SurfaceTopography, or mapping
        ``topography`` (a file or a topography); ``format`` of a file; ``unit``, the scene's unit of
        length, as "nm"; ``scale``, a factor on the heights; ``detrend``; ``origin``.
    points : ndarray, (n, 2)
        x and z of the asperites [length].

    Returns
    -------
    ndarray, (n,)
        [length]

    Raises
    ------
    InputError
        A key or a file cannot be used, the library is missing, or the scan does not cover the
        asperites.
    """
    table = known_keys(value if isinstance(value, Mapping) else {"topography": value}, KEYS)
    scan = _in_unit(_scan(table["topography"], table.get("format")), table.get("unit"))
    degree = DETREND[choice("detrend", table.get("detrend", "plane"), DETREND)]
    scale = number("scale", table.get("scale", 1.0))
    heights: np.ndarray = np.ma.filled(np.ma.asarray(scan.heights(), float), np.nan)
    if heights.ndim == 1:
        heights = heights[:, None]
    pixels = np.array([*scan.physical_sizes, 1.0][:2]) / heights.shape
    places = _places(points, heights.shape, pixels, scan.is_periodic, table.get("origin"))
    found = scale * _interpolated(_detrended(heights, degree), places, scan.is_periodic)
    if np.any(np.isnan(found)):
        count = int(np.sum(np.isnan(found)))
        raise InputError("topography", f"is undefined at {count} asperites; fill its gaps before")
    return found


def _is_scan(value: object) -> TypeGuard[Scan]:
    return all(hasattr(value, name) for name in ("heights", "physical_sizes", "is_uniform"))


def _scan(source: object, file_format: object) -> Scan:
    """The topography itself, or that of a file."""
    if isinstance(source, (str, Path)):
        source = _read(Path(source), file_format)
    elif file_format is not None:
        raise InputError("format", "is that of a file; leave it out where topography is none")
    if not _is_scan(source):
        raise must_be("topography", "a file, or a topography of SurfaceTopography", source)
    if not source.is_uniform:
        raise InputError("topography", "must be on a uniform grid; to_uniform() makes one")
    return source


def _read(path: Path, file_format: object) -> Any:
    try:
        from SurfaceTopography import read_topography
    except ImportError:
        problem = 'needs SurfaceTopography; install it by pip install "tribo[topography]"'
        raise InputError("topography", problem) from None
    try:
        return read_topography(str(path), format=file_format)
    except Exception as error:  # each reader raises its own
        raise InputError("topography", f"{path} cannot be read: {error}") from None


def _in_unit(scan: Scan, unit: object) -> Scan:
    """The scan in the scene's unit of length; as it is where the scene gives none."""
    if unit is None:
        return scan
    if scan.unit is None:
        raise InputError("unit", "cannot be used: the topography has no unit; use scale")
    try:
        return scan.to_unit(str(unit))
    except Exception:
        raise must_be("unit", 'a unit of length, as "nm"', unit) from None


def _detrended(heights: np.ndarray, degree: int) -> np.ndarray:
    """The heights less their best polynomial in x and z, of a total degree; -1: none."""
    x, z = (np.linspace(-1.0, 1.0, n) if n > 1 else np.zeros(1) for n in heights.shape)
    powers = [(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]
    if not powers:
        return heights
    terms = np.array([np.outer(x**i, z**j) for i, j in powers])
    known = np.isfinite(heights)
    factors = np.linalg.lstsq(terms[:, known].T, heights[known])[0]
    return np.asarray(heights - np.tensordot(factors, terms, 1))


def _places(
    points: np.ndarray,
    shape: tuple[int, ...],
    pixels: np.ndarray,
    periodic: bool,
    origin: object,
) -> np.ndarray:
    """The asperites in a scan, (n, 2) in pixels; `origin` is the first one's, else centred."""
    last = np.array(shape) - 1.0
    if origin is None:
        middle = 0.5 * (np.min(points, axis=0) + np.max(points, axis=0))
        places = (points - middle) / pixels + 0.5 * last
    else:
        first = vector("origin", origin, size=2, unit="length")
        places = (points - points[0] + first) / pixels
    if periodic:
        return np.asarray(places % np.array(shape))
    beyond = np.max(np.maximum(-places, places - last) * pixels, axis=0)
    if np.any(beyond > ROUNDING * pixels):
        size, span = last * pixels, np.ptp(points, axis=0)
        raise InputError(
            "topography",
            f"has {size[0]:.4g} by {size[1]:.4g} [length] along x and z, and the asperites span "
            f"{span[0]:.4g} by {span[1]:.4g}; change spacing, unit or origin",
        )
    return np.clip(places, 0.0, last)


def _interpolated(heights: np.ndarray, places: np.ndarray, periodic: bool) -> np.ndarray:
    """Heights at places in pixels, (n,), linear between pixels."""
    from scipy.ndimage import map_coordinates

    mode = "grid-wrap" if periodic else "nearest"
    return np.asarray(map_coordinates(heights, places.T, order=1, mode=mode))
