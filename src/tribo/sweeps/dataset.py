"""A sweep as a labelled data set."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tribo.ensembles.kept_values import about_kept
from tribo.kernels.status import Status
from tribo.ledger.quantities import SUMMED_QUANTITIES
from tribo.results.dataset import Variable
from tribo.sweeps.grid import Grid
from tribo.sweeps.points import Found, mean_and_half_width
from tribo.validation import InputError

if TYPE_CHECKING:
    import xarray

# The status of a point that an interrupt left out.
NOT_RUN = "not run"
# Meanings of the counts of each point.
COUNTS = {
    "steps": "steps of the run, or of all members",
    "force_evaluations": "evaluations of all forces, with those that estimate the error",
    "seconds": "time of the runs",
}


def dataset(
    grid: Grid, found: Mapping[int, Found], members: bool, identity: str, seconds: float
) -> xarray.Dataset:
    """The data set of a sweep that took `seconds`, of points with members or without."""
    import xarray

    from tribo import __version__

    keys = tuple(grid.values)
    complete = {index: item for index, item in found.items() if item.values}
    variables: dict[str, Variable] = {}
    for name in next((item.values for item in complete.values()), {}):
        variables |= _quantity(grid, name, complete, members)
    for name, meaning in COUNTS.items():
        given = {i: np.array(f.counts[name], float) for i, f in found.items() if name in f.counts}
        if given:
            about = {"long_name": meaning} | ({"units": "s"} if name == "seconds" else {})
            variables[name] = keys, _filled(grid, given), about
    statuses = [found[i].status if i in found else NOT_RUN for i in range(grid.size)]
    about = {"long_name": "end of the run"}
    variables["status"] = keys, np.array(statuses).reshape(grid.shape), about
    coordinates = {key: ((key,), np.array(v), {"long_name": key}) for key, v in grid.values.items()}
    notes = [f"{grid.label(i)}: {item.note}" for i, item in sorted(found.items()) if item.note]
    whole = len(found) == grid.size
    attributes = {
        "tribo_version": __version__,
        "scene": grid.scene_before.to_toml(),
        "status": str(Status.COMPLETED if whole else Status.INTERRUPTED),
        "notes": json.dumps(notes),
        "seconds": seconds,
        "sweep": identity,
    }
    return xarray.Dataset(variables, coordinates, attributes)


def _quantity(
    grid: Grid, name: str, complete: Mapping[int, Found], members: bool
) -> dict[str, Variable]:
    """The variables of one quantity: its values, and errors or means with their intervals."""
    keys = tuple(grid.values)
    surface, _, kind = name.rpartition(".")
    values = _filled(grid, {i: np.array(item.values[name]) for i, item in complete.items()})
    rest = values.shape[len(keys) :]
    own = ("member",) * members + (f"{surface}_asperite",)
    dimensions = (*keys, *own[: len(rest)])
    whole = len(rest) == int(members) and kind in SUMMED_QUANTITIES
    about = about_kept(name, at_end=True)
    if whole:
        about["long_name"] = f"{SUMMED_QUANTITIES[kind].long_name}, at the end"
    variables: dict[str, Variable] = {name: (dimensions, values, about)}
    if members:
        per_point = values.reshape(grid.size, *rest)
        pairs = [mean_and_half_width(each) for each in per_point]
        of_all = (*keys, *own[1 : len(rest)])
        for k, word in enumerate(("mean", "half_width")):
            table = np.array([pair[k] for pair in pairs]).reshape(*grid.shape, *rest[1:])
            what = about | {"long_name": f"{word.replace('_', '-')} of: {about['long_name']}"}
            variables[f"{name}_{word}"] = of_all, table, what
    bounds = {i: np.array(f.errors[name]) for i, f in complete.items() if name in f.errors}
    if bounds:
        what = about | {"long_name": f"bound on the error of: {about['long_name']}"}
        variables[f"{name}_error"] = keys, _filled(grid, bounds), what
    return variables


def _filled(grid: Grid, given: Mapping[int, np.ndarray]) -> np.ndarray:
    """An array over the grid, NaN at points without a value."""
    shape = next(iter(given.values())).shape
    table = np.full((grid.size, *shape), np.nan)
    for index, value in given.items():
        table[index] = value
    return table.reshape(*grid.shape, *shape)


def opened(path: Path, identity: str) -> xarray.Dataset:
    """The data set in the file of a complete sweep.

    Raises InputError if the file is of another sweep.
    """
    import xarray

    try:
        data = xarray.load_dataset(path, engine="h5netcdf")
    except (OSError, ValueError) as error:
        raise InputError(str(path), f"cannot be read ({error})") from None
    if data.attrs.get("sweep") != identity:
        raise InputError(
            str(path), "is of another sweep, or of another version of tribo; give another file"
        )
    return data
