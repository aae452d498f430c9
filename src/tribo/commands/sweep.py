"""The command `tribo sweep`."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tribo.commands.scene_options import by_key, check_figure, load, parsed_list
from tribo.files import strict_json
from tribo.interrupts import COMPLETED, STOPPED, also_in_part
from tribo.validation import InputError

if TYPE_CHECKING:
    import xarray

    from tribo.sweeps.grid import Keys

# Most points, and quantities, that a summary shows.
LINES, COLUMNS = 20, 5


def run_sweep(options: argparse.Namespace) -> int:
    from tribo.commands.ensemble import settings_of, workers
    from tribo.plotting import save
    from tribo.sweeps import sweep
    from tribo.sweeps.figure import ends, quantities, sweep_lines

    check_figure(options.figure)
    values, scene = _values_of(options.set), load(options)
    settings = settings_of(options, scene)
    with workers(options) as engine:
        try:
            data = also_in_part(sweep, scene, values, engine=engine, **settings)
        except InputError as error:
            option, _, key = error.field.partition(".")
            field = f"--set {key}" if option == "values" else error.field
            raise InputError(field, error.problem) from None
    if options.figure is not None:
        names = quantities(data)
        if not names:
            problem = "needs a quantity with one value at each point, as upper.W"
            raise InputError("--figure", problem)
        save(sweep_lines(data, names[0]), options.figure)
    print(_as_json(data) if options.json else _summary(data, options.out))
    return COMPLETED if set(ends(data).values.flat) == {"completed"} else STOPPED


def _values_of(texts: list[str]) -> dict[Keys, list[object]]:
    """The values of each key, from texts as "upper.drive.load=0.1,0.2".  Raises InputError.

    Keys with commas between them are swept together: "upper.velocity,duration=[0.5,40],[0.25,80]".
    """
    return {
        tuple(name.split(",")) if "," in name else name: parsed_list("--set", listed)
        for name, listed in by_key("--set", texts).items()
    }


def _as_json(data: xarray.Dataset) -> str:
    dimensions, keys, scalars = _layout(data)
    points = []
    for at in np.ndindex(tuple(data.sizes[name] for name in dimensions)):
        places = dict(zip(dimensions, at, strict=True))
        values = {key: data[key].isel(places, missing_dims="ignore").item() for key in keys}
        points.append(
            {"values": values, **{name: data[name].isel(places).item() for name in scalars}}
            | ({} if "status" in scalars else {"members": _statuses(data, places)})
        )
    whole = {"status": data.attrs["status"], "points": points}
    rest = {"notes": json.loads(data.attrs["notes"]), "seconds": data.attrs["seconds"]}
    return strict_json(whole | rest)


def _layout(data: xarray.Dataset) -> tuple[list[str], list[str], list[str]]:
    """The dimensions of the points, the keys, and the names with one value at each point."""
    from tribo.sweeps.figure import keys_of

    dimensions = keys_of(data)
    scalars = [str(n) for n in data.data_vars if data[n].dims == tuple(dimensions)]
    keys = [key for name in dimensions for key in name.split(",")]
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
    from tribo.ensembles.dataset import COUNTS
    from tribo.sweeps.figure import ends

    statuses, counts = np.unique(ends(data).values, return_counts=True)
    lines = [", ".join(f"{n} {status}" for status, n in zip(statuses, counts, strict=True))]
    dimensions, keys, scalars = _layout(data)
    hidden = (*COUNTS, "status", "point_status")
    names = [n for n in scalars if n not in hidden and not n.endswith(("_error", "_half_width"))]
    shown = names[:COLUMNS]
    lines.append("  ".join(f"{name:>18}" for name in [*keys, *shown]) + "  status")
    points = list(np.ndindex(tuple(data.sizes[name] for name in dimensions)))
    for point in points[:LINES]:
        at = dict(zip(dimensions, point, strict=True))
        row = [f"{data[key].isel(at, missing_dims='ignore').item()!s:>18}" for key in keys]
        row += [f"{float(data[name].isel(at)):>18.6g}" for name in shown]
        found = ", ".join(dict.fromkeys(map(str, np.atleast_1d(ends(data).isel(at).values))))
        lines.append("  ".join(row) + f"  {found}")
    if len(points) > LINES:
        lines.append(f"... and {len(points) - LINES} more points")
    if len(names) > COLUMNS:
        lines.append(f"... and {len(names) - COLUMNS} more quantities")
    if out is not None and data.attrs["status"] != "completed":
        lines.append(f"the finished points are in {out}.part; --resume goes on")
    lines.append(f"{data.attrs['seconds']:.2f} s")
    return "\n".join(lines)
