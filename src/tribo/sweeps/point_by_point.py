"""Sweeps to a half-width of a mean: each point is an ensemble with its own number of members."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from tribo.ensembles.stores import Target
from tribo.files import netcdf_image, netcdf_in
from tribo.interrupts import answer
from tribo.loops.frames import Arrays, as_bytes
from tribo.model.parameters import with_values
from tribo.model.scene import Scene
from tribo.sweeps.dataset import points_dataset
from tribo.sweeps.grid import Grid
from tribo.validation import InputError

if TYPE_CHECKING:
    import xarray


def point_by_point(
    grid: Grid,
    ensemble_at: Callable[[Scene], xarray.Dataset],
    target: Target,
    report: Callable[[int], None] | None,
) -> xarray.Dataset:
    """An ensemble at each point, side by side.  Raises KeyboardInterrupt if none is complete."""
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
    refused = {}
    for index, arrays in enumerate(points):
        if "data" in arrays:
            found[index] = netcdf_in(arrays["data"].tobytes())
        else:
            refused[index] = arrays["note"].tobytes().decode()
    return points_dataset(grid, target, found, refused, interrupted)
