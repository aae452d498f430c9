"""The normal force on a surface over its distance from the others: indentation and retraction."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from tribo.results.run_result import RunResult, begin_of
from tribo.results.stage import legs_of
from tribo.validation import InputError

if TYPE_CHECKING:
    import xarray


def force_distance(result: RunResult, surface: str, after: float | None = None) -> xarray.Dataset:
    """The normal force on a surface over its distance from the others, along y.

    The distance is that of the mean heights of the bars of the surface and of all others, positive
    on the side to which the surface keeps when it faces them.  The force is the contact force on
    the bobs away from the others, so that an attraction is negative.

    Parameters
    ----------
    surface : str
        Name of the surface; the scene's output asks for the series "forces".
    after : float, optional
        When the curve begins; by default the scene's ``output.run_in`` [time].

    Returns
    -------
    xarray.Dataset
        ``distance`` [length], ``force`` [force] and ``leg`` (time,): -1 on an approach, +1 on a
        retraction.  Attributes: ``pull_off`` is the largest attraction on retractions [force], and
        ``hysteresis`` the work that the last approach and the retraction after it take, over the
        distances that both pass [energy]; NaN where there is no retraction.

    Raises
    ------
    InputError
        If there is no such surface or no other one, `after` is no time of the run before its end,
        the distance does not change, or forces or places were not recorded.
    """
    import xarray

    index = result.scene.index_of(surface)
    scene = result.scene
    begin = begin_of(result, after)
    others = [each.name for each in scene.surfaces if each.name != surface]
    if not others:
        raise InputError("surface", "must have another surface to approach; there is none")
    if "normal_force" not in result[surface]:
        raise InputError("output.series", 'does not contain "forces"; add it, and run again')
    heights = {}
    for name in (surface, *others):
        series = result[name]
        if "y_bar" not in series or len(series["y_bar"]) != result.t.size:
            raise InputError("output.series", f'leaves out the heights of the bars of "{name}"')
        heights[name] = series["y_bar"]
    ground = np.concatenate([heights[name] for name in others], axis=1).mean(axis=1)
    facing = scene.surfaces[index].facing_sign
    distance = facing * (heights[surface].mean(axis=1) - ground)
    force = np.asarray(result[surface]["normal_force"])
    legs = legs_of(distance, begin, result.t)
    if not legs:
        raise InputError(
            "surface", f'must approach or retract after t = {begin:g}; "{surface}" keeps its height'
        )
    first = legs[0].first
    way = np.zeros(result.t.size, int)
    for leg in legs:
        way[leg.first : leg.last + 1] = int(leg.along)
    back = [leg for leg in legs if leg.along > 0.0]
    pull_off = max(
        (-float(np.min(force[leg.first : leg.last + 1])) for leg in back), default=np.nan
    )
    hysteresis = np.nan
    for one, other in pairwise(legs):
        if one.along < 0.0 < other.along:
            down = slice(one.first, one.last + 1)
            up = slice(other.first, other.last + 1)
            hysteresis = _between_both(distance, force, down, up)
    later = slice(first, None)
    about = {"long_name": f"distance of {surface} from the others", "units": "length"}
    variables = {
        "distance": ("time", distance[later], about),
        "force": ("time", force[later], {"long_name": "normal force", "units": "force"}),
        "leg": ("time", way[later], {"long_name": "-1 approaches, +1 retracts", "units": "1"}),
    }
    coordinates = {"time": ("time", result.t[later], {"units": "time"})}
    attributes = {"surface": surface, "pull_off": pull_off, "hysteresis": hysteresis}
    return xarray.Dataset(variables, coordinates, attributes)


def _between_both(distance: np.ndarray, force: np.ndarray, down: slice, up: slice) -> float:
    """The integral of the approach's force less the retraction's, where both have distances."""
    curves = [(distance[down][::-1], force[down][::-1]), (distance[up], force[up])]
    low = max(float(x.min()) for x, _ in curves)
    high = min(float(x.max()) for x, _ in curves)
    areas = []
    for x, values in curves:
        monotone = np.maximum.accumulate(x)
        grid = np.unique(np.concatenate([[low, high], monotone]))
        grid = grid[(grid >= low) & (grid <= high)]
        areas.append(float(np.trapezoid(np.interp(grid, monotone, values), grid)))
    return areas[0] - areas[1]
