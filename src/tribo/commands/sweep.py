"""The command `tribo sweep`."""

from __future__ import annotations

import argparse
import json
import re
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.commands.scene_options import by_key, check_figure, draw_to, load, parsed_list
from tribo.files import strict_json
from tribo.interrupts import COMPLETED, STOPPED, also_in_part
from tribo.validation import InputError

if TYPE_CHECKING:
    import xarray

    from tribo.sweeps.grid import Keys

# Most points that a summary shows.
LINES = 20
# Most quantities that it shows.
COLUMNS = 5
# Most notes that it prints.
MOST_NOTES = 6
# Characters of a column, of which long headings take more.
WIDTH = 18
# The heading of the intervals of means over members, or of averages over time.
HALF_WIDTH = "half-width"


def run_sweep(options: argparse.Namespace) -> int:
    """Run a sweep, print a summary of its points and draw the figure.

    Errors name the option of the command that has the value.
    """
    from tribo.commands.ensemble import settings_of, workers
    from tribo.sweeps import sweep
    from tribo.sweeps.figure import ends, with_single_asperites_as_numbers

    check_figure(options.figure)
    values = _values_of(options.set)
    scene = load(options)
    settings = settings_of(options, scene)
    with workers(options) as engine:
        try:
            data = also_in_part(sweep, scene, values, engine=engine, **settings)
        except InputError as error:
            option, _, key = error.field.partition(".")
            field = f"--set {key}" if option == "values" else error.field
            raise InputError(field, error.problem) from None
    found = with_single_asperites_as_numbers(data)
    print(_as_json(found) if options.json else _summary(found, options.out))
    draw_to(options.figure, partial(_draw, data))
    return COMPLETED if set(ends(data).values.flat) == {"completed"} else STOPPED


def _draw(data: xarray.Dataset, path: Path) -> None:
    """Draw the first quantity.  Raises InputError if there is none."""
    from tribo.plotting import save
    from tribo.sweeps.figure import quantities, sweep_lines

    names = quantities(data)
    if not names:
        raise InputError("--figure", "needs a quantity with one value at each point, as upper.W")
    save(sweep_lines(data, names[0]), path)


def _values_of(texts: list[str]) -> dict[Keys, list[object]]:
    """The values of each key, from texts as "upper.drive.load=0.1,0.2".  Raises InputError.

    Keys with commas between them are swept together: "upper.velocity,duration=[0.5,40],[0.25,80]".
    """
    return {
        tuple(name.split(",")) if "," in name else name: parsed_list("--set", listed)
        for name, listed in by_key("--set", texts).items()
    }


def _as_json(data: xarray.Dataset) -> str:
    """A sweep as JSON: for each point its values, quantities, and status or statuses of members."""
    dimensions, keys, scalars = _layout(data)
    points = []
    for at in np.ndindex(tuple(data.sizes[name] for name in dimensions)):
        places = dict(zip(dimensions, at, strict=True))
        values = {key: data[key].isel(places, missing_dims="ignore").item() for key in keys}
        point: dict[str, Any] = {"values": values}
        for name in scalars:
            point[name] = data[name].isel(places).item()
        if "status" not in scalars:
            point["members"] = _statuses(data, places)
        points.append(point)
    whole = {"status": data.attrs["status"], "points": points}
    rest = {"notes": json.loads(data.attrs["notes"]), "seconds": data.attrs["seconds"]}
    return strict_json(whole | rest)


def _layout(data: xarray.Dataset) -> tuple[list[str], list[str], list[str]]:
    """The dimensions of the points, the keys, and the names with one value at each point."""
    from tribo.sweeps.figure import keys_of, keys_on

    dimensions = keys_of(data)
    scalars = [str(n) for n in data.data_vars if data[n].dims == tuple(dimensions)]
    keys = [key for name in dimensions for key in keys_on(data, name)]
    return dimensions, keys, scalars


def _statuses(data: xarray.Dataset, places: dict[str, int]) -> dict[str, int]:
    """How many members of a point have each status; points may have different numbers of them."""
    from tribo.ensembles.kept_values import NOT_RUN

    if "status" not in data:
        return {}
    names, counts = np.unique(data["status"].isel(places).values, return_counts=True)
    found = dict(zip(names.tolist(), counts.tolist(), strict=True))
    return {name: n for name, n in found.items() if name != NOT_RUN or "point_status" not in data}


def _summary(data: xarray.Dataset, out: Path | None) -> str:
    """The statuses of the runs, and some values of the points."""
    from tribo.sweeps.figure import ends

    statuses, counts = np.unique(ends(data).values, return_counts=True)
    lines = [", ".join(f"{n} {status}" for status, n in zip(statuses, counts, strict=True))]
    lines += _table(data)
    if out is not None and data.attrs["status"] != "completed":
        lines.append(f"the finished points are in {out}.part; --resume goes on")
    notes = json.loads(data.attrs["notes"])
    lines += [f"note: {note}" for note in notes[:MOST_NOTES]]
    if len(notes) > MOST_NOTES:
        lines.append(f"{len(notes) - MOST_NOTES} more notes: --json prints them")
    lines.append(f"{data.attrs['seconds']:.2f} s")
    return "\n".join(lines)


def _table(data: xarray.Dataset) -> list[str]:
    """A line for each point, with the keys and some quantities; lines about the rest."""
    from tribo.ensembles.dataset import COUNTS, EXCESS
    from tribo.ensembles.kept_values import INTERVAL
    from tribo.sweeps.figure import ends

    dimensions, keys, scalars = _layout(data)
    hidden = (*COUNTS, *EXCESS, "status", "point_status")
    names = [n for n in scalars if n not in hidden and not n.endswith(("_error", "_half_width"))]
    # A mean of the members' intervals over time is no interval of their mean.
    names = [name for name in names if INTERVAL not in name]
    columns = {}  # variable -> its heading
    for name in names[:COLUMNS]:
        columns[name] = name
        ending = "_half_width" if name.endswith("_mean") else INTERVAL
        half_width = name.removesuffix("_mean") + ending
        if half_width in scalars:
            columns[half_width] = HALF_WIDTH
    headings = [*keys, *columns.values()]
    widths = [max(WIDTH, len(heading)) for heading in headings]

    def aligned(cells: list[str], end: str) -> str:
        pairs = zip(cells, widths, strict=True)
        return "  ".join([*(f"{cell:>{width}}" for cell, width in pairs), end])

    lines = [aligned(headings, "status")]
    points = list(np.ndindex(tuple(data.sizes[name] for name in dimensions)))
    for point in points[:LINES]:
        at = dict(zip(dimensions, point, strict=True))
        row = [str(data[key].isel(at, missing_dims="ignore").item()) for key in keys]
        row += [f"{float(data[name].isel(at)):.6g}" for name in columns]
        found = ", ".join(dict.fromkeys(map(str, np.atleast_1d(ends(data).isel(at).values))))
        lines.append(aligned(row, found))
    if len(points) > LINES:
        lines.append(f"... and {len(points) - LINES} more points")
    if len(names) > COLUMNS:
        lines.append(f"... and {len(names) - COLUMNS} more quantities")
    if any(name.endswith(INTERVAL) for name in columns):
        lines.append(f"{HALF_WIDTH}: of the 95 % interval of the average over time")
    elif HALF_WIDTH in headings:
        lines.append(f"{HALF_WIDTH}: of the 95 % interval of the mean over members")
    if others := _without_a_column(data, scalars):
        lines.append(f"several values at each point, only in the file of --out: {others}")
    return lines


def _without_a_column(data: xarray.Dataset, scalars: list[str]) -> str:
    """The kept quantities with more than one value at each point, as of several asperites."""
    from tribo.ensembles.kept_values import is_interval

    kept = json.loads(data.attrs["keep"])
    if "point_status" in data:  # all variables of its ensembles
        kept = [name.removesuffix("_mean") for name in kept if name.endswith("_mean")]
    of_points = {re.sub("_(mean|end)$", "", name) for name in scalars}
    return ", ".join(n for n in kept if n not in of_points and not is_interval(n))
