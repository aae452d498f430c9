"""Averages over time of each asperite, and of each surface: maps and profiles."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from tribo.results.averages import Average, average_from
from tribo.results.run_result import RunResult, begin_or_auto
from tribo.validation import InputError

if TYPE_CHECKING:
    import xarray


def friction_map(
    result: RunResult, surface: str, after: float | str | None = None
) -> xarray.Dataset:
    """The mean friction and normal force of each asperite of a surface.

    The friction force is that of :meth:`friction_force`, x of contact and fields; their sum over
    the asperites is its mean.  The normal force is the contact force along y away from what the
    surface faces.  The scene's output must ask for the series "forces".

    Parameters
    ----------
    surface : str
        Name of the surface.
    after : float or "auto", optional
        When the averages begin, as in :func:`tribo.time_average`; by default at the scene's
        ``output.run_in`` [time].

    Returns
    -------
    xarray.Dataset
        ``friction`` and ``normal`` (asperite,) with ``friction_half_width`` and
        ``normal_half_width`` of their 95 % intervals [force], NaN where the series is too short
        for one; and where each bob rests: ``x``, ``y``, ``z`` (asperite,) [length].

    Raises
    ------
    InputError
        If there is no such surface, the forces of single asperites were not recorded, `after` is
        neither "auto" nor a time of the run before its end, or there are fewer than two samples.
    """
    import xarray

    index = result.scene.index_of(surface)
    series = result[surface]
    if "f1_x" not in series or series["f1_x"].shape[0] != result.t.size:
        raise InputError(
            "output.series",
            'must contain "forces", and few enough samples to keep those of single asperites',
        )
    friction = series["f1_x"]
    if "f_field_x" in series:
        friction = friction + series["f_field_x"]
    part = result.scene.surfaces[index]
    normal = part.facing_sign * series["f1_y"]
    begin = begin_or_auto(result, after)
    variables = {}
    for name, values in (("friction", friction), ("normal", normal)):
        found = [_average(result.t, own, begin) for own in values.T]
        about = {"units": "force", "long_name": f"mean {name} force"}
        variables[name] = ("asperite", [each.mean for each in found], about)
        width = about | {"long_name": f"half-width of the 95 % interval of: mean {name} force"}
        variables[f"{name}_half_width"] = ("asperite", [each.half_width for each in found], width)
    places = part.resting_bobs(seed=[result.scene.seed, index, 0]).T
    where = {
        axis: ("asperite", row, {"units": "length"})
        for axis, row in zip("xyz", places, strict=True)
    }
    return xarray.Dataset(variables, where, {"surface": surface})


def velocity_profile(result: RunResult, after: float | str | None = None) -> xarray.Dataset:
    """The mean velocity of each surface along x over its height, and the slip between them.

    Velocities are those of the centre of mass of all asperites.  Surfaces are in the order of their
    mean height; the slip of one is its velocity less that of the next one below.

    Parameters
    ----------
    after : float or "auto", optional
        As for :meth:`friction_map`.

    Returns
    -------
    xarray.Dataset
        ``velocity`` and ``slip`` (surface,) with their ``_half_width`` of 95 % [length / time], and
        the mean height ``y`` (surface,) of the centres of mass [length].  The lowest surface has
        no slip, NaN.

    Raises
    ------
    InputError
        If the velocities of single asperites were not kept, `after` is neither "auto" nor a time of
        the run before its end, or there are fewer than two samples.
    """
    import xarray

    begin = begin_or_auto(result, after)
    velocities = {}
    heights = {}
    for surface in result.scene.surfaces:
        series = result[surface.name]
        if "vx_cm" not in series or series["vx_cm"].shape[0] != result.t.size:
            raise InputError(
                "output.samples", "must be fewer, to keep the velocities of single asperites"
            )
        mass = surface.each["m1"] + surface.each["m2"]
        weights = mass / np.sum(mass)
        velocities[surface.name] = series["vx_cm"] @ weights
        heights[surface.name] = _average(result.t, series["y_cm"] @ weights, begin).mean
    names = sorted(heights, key=lambda name: -heights[name])
    own = [_average(result.t, velocities[name], begin) for name in names]
    steps = [
        _average(result.t, velocities[name] - velocities[below], begin)
        for name, below in pairwise(names)
    ]
    nothing = Average(np.nan, np.nan, np.nan, np.nan, np.nan, np.nan)
    about = {"units": "length time^-1"}
    variables = {}
    for word, found in (("velocity", own), ("slip", [*steps, nothing])):
        variables[word] = ("surface", [each.mean for each in found], about)
        variables[f"{word}_half_width"] = ("surface", [each.half_width for each in found], about)
    ordered = [heights[name] for name in names]
    coordinates = {"surface": names, "y": ("surface", ordered, {"units": "length"})}
    return xarray.Dataset(variables, coordinates)


def _average(t: np.ndarray, values: np.ndarray, begin: float | str) -> Average:
    """The average of a series over time, of the samples at which it is known."""
    known = np.isfinite(values)
    return average_from(t[known], values[known], begin)
