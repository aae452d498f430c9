"""Sweeps whose points are ensembles of their own: their statistics, or means to a half-width."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.ensembles.kept_values import NOT_RUN, REFUSED
from tribo.ensembles.stores import Target
from tribo.files import netcdf_image
from tribo.interrupts import answer
from tribo.loops.frames import Arrays, as_bytes
from tribo.model.parameters import with_values
from tribo.model.scene import Scene
from tribo.results.result_file import Variable
from tribo.sweeps.dataset import key_coordinates
from tribo.sweeps.grid import Grid
from tribo.validation import InputError, inside

if TYPE_CHECKING:
    import xarray


def point_by_point(
    grid: Grid,
    ensemble_at: Callable[[Scene], xarray.Dataset],
    target: Target,
    report: Callable[[int], None] | None,
) -> xarray.Dataset:
    """An ensemble at each point, side by side.  Raises KeyboardInterrupt if none is complete."""
    import xarray

    # "data" of the data set, or a "note" on why there is none
    frames = target.frames
    points: list[Arrays] = [] if frames is None else [arrays for _, arrays in frames.read()]
    interrupted = False
    try:
        for index in range(len(points), grid.size):
            try:
                data = ensemble_at(with_values(grid.scene, grid.point(index)))
                points.append({"data": as_bytes(netcdf_image(data))})
            except InputError as error:
                points.append({"note": as_bytes(str(error))})
            if frames is not None:
                frames.append(index, points[-1])
            if report is not None:
                report(len(points))
    except KeyboardInterrupt:
        answer()
        interrupted = True
    found = {}
    notes = []
    statuses = [NOT_RUN] * grid.size
    for index, arrays in enumerate(points):
        if "data" in arrays:
            found[index] = xarray.load_dataset(arrays["data"].tobytes(), engine="h5netcdf")
            statuses[index] = found[index].attrs["status"]
            own = json.loads(found[index].attrs.get("notes", "[]"))
            notes += [f"{grid.label(index)}: {note}" for note in own]
        else:
            statuses[index] = REFUSED
            notes.append(f"{grid.label(index)}: {arrays['note'].tobytes().decode()}")
    if not found:
        if interrupted:
            raise KeyboardInterrupt
        with inside(grid.label(0)):
            raise InputError("", points[0]["note"].tobytes().decode())
    variables, coordinates = _side_by_side(grid, found)
    about = {"long_name": "end of the ensemble"}
    variables["point_status"] = tuple(grid.names), np.reshape(statuses, grid.shape), about
    names = [str(name) for name in found[min(found)].data_vars]
    attributes = target.attributes(interrupted, notes)
    attributes["keep"] = json.dumps(names)
    coordinates |= key_coordinates(grid)
    return target.saved(xarray.Dataset(variables, coordinates, attributes))


def _side_by_side(
    grid: Grid, found: Mapping[int, xarray.Dataset]
) -> tuple[dict[str, Variable], dict[str, Variable]]:
    """All variables and coordinates; NaN, or 0 in a histogram, where a point has no value."""
    first = next(iter(found.values()))
    variables: dict[str, Variable] = {}
    for name in map(str, [*first.data_vars, *({"status"} & {*first.coords})]):
        arrays = {index: data[name].values for index, data in found.items()}
        shape = np.max([each.shape for each in arrays.values()], axis=0).astype(int)
        empty: Any = {"i": 0, "U": NOT_RUN, "O": NOT_RUN}.get(first[name].dtype.kind, np.nan)
        dtype = np.result_type(*arrays.values(), np.array(empty))
        table = np.full((grid.size, *shape), empty, dtype)
        for index, values in arrays.items():
            places: tuple[Any, ...] = (index, *map(slice, values.shape))
            table[places] = values
        dimensions = (*grid.names, *map(str, first[name].dims))
        table = table.reshape(*grid.shape, *table.shape[1:])
        variables[name] = dimensions, table, dict(first[name].attrs)
    largest = max(found.values(), key=lambda data: data.sizes.get("member", 0))
    coordinates: dict[str, Variable] = {
        str(name): (each.dims, each.values, dict(each.attrs))
        for name, each in largest.coords.items()
        if name != "status" and name not in grid.keys
    }
    return variables, coordinates
