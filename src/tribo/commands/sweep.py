"""The command `tribo sweep`."""

from __future__ import annotations

import argparse
import json
from concurrent.futures import ProcessPoolExecutor
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tribo.commands.scene_options import (
    as_number,
    check_figure,
    load,
    parsed_list,
    split,
)
from tribo.files import strict_json
from tribo.interrupts import COMPLETED, STOPPED, also_in_part
from tribo.validation import InputError, integer

if TYPE_CHECKING:
    import xarray

# Most points, and quantities, that a summary shows.
LINES, COLUMNS = 20, 5


def run_sweep(options: argparse.Namespace) -> int:
    """Run the sweep and print its points; the exit status."""
    check_figure(options.figure)
    data = found_by(options)
    if options.figure is not None:
        _draw(data, options.figure)
    print(as_json(data) if options.json else summary(data, options.out))
    return COMPLETED if set(data["status"].values.flat) == {"completed"} else STOPPED


def values_of(texts: list[str]) -> dict[str, list[object]]:
    """The values of each key, from texts as "upper.drive.load=0.1,0.2".  Raises InputError."""
    values: dict[str, list[object]] = {}
    for text in texts:
        key, listed = split("--set", text)
        if key in values:
            raise InputError(f"--set {key}", "is given twice; give all values of a key at once")
        values[key] = parsed_list("--set", listed)
    return values


def found_by(options: argparse.Namespace) -> xarray.Dataset:
    """The data set of the sweep that the options describe.  Raises InputError."""
    from tribo.commands.ensemble import varied
    from tribo.sweeps import sweep

    values = values_of(options.set)
    vary = varied(options.vary)
    accuracy, step = (as_number(f"--{n}", getattr(options, n)) for n in ("accuracy", "step"))
    processes = integer("--processes", options.processes, 1)
    if options.resume and options.out is None:
        raise InputError("--resume", "needs --out FILE")
    pool = ProcessPoolExecutor(processes) if processes > 1 else nullcontext()
    with pool as engine:
        try:
            return also_in_part(
                sweep,
                load(options),
                values,
                options.members,
                None if options.keep is None else options.keep.split(","),
                vary,
                options.seed,
                accuracy,
                options.method,
                step,
                engine,
                options.out,
                options.resume,
            )
        except InputError as error:
            option, _, key = error.field.partition(".")
            raise InputError(
                f"--set {key}" if option == "values" else error.field, error.problem
            ) from None


def _draw(data: xarray.Dataset, path: Path) -> None:
    """Draw the first quantity against the first key."""
    from tribo.plotting import save
    from tribo.sweeps.figure import quantities, sweep_lines

    names = quantities(data)
    if not names:
        raise InputError("--figure", "needs a quantity with one value at each point, as upper.W")
    save(sweep_lines(data, names[0]), path)


def as_json(data: xarray.Dataset) -> str:
    """The points as one JSON object."""
    keys = list(map(str, data["status"].dims))
    scalars = [str(name) for name in data.data_vars if data[name].dims == tuple(keys)]
    points = [
        {
            "values": {key: data[key].values[k].item() for key, k in zip(keys, at, strict=True)},
            **{name: data[name].values[at].item() for name in scalars},
        }
        for at in np.ndindex(data["status"].shape)
    ]
    whole = {"status": data.attrs["status"], "points": points}
    rest = {"notes": json.loads(data.attrs["notes"]), "seconds": data.attrs["seconds"]}
    return strict_json(whole | rest)


def summary(data: xarray.Dataset, out: Path | None) -> str:
    """The statuses of the points, and some of their values."""
    statuses, counts = np.unique(data["status"].values, return_counts=True)
    lines = [", ".join(f"{n} {status}" for status, n in zip(statuses, counts, strict=True))]
    keys = list(map(str, data["status"].dims))
    names = [str(n) for n in data.data_vars if data[n].dims == tuple(keys) and _is_shown(str(n))]
    shown = names[:COLUMNS]
    lines.append("  ".join(f"{name:>18}" for name in [*keys, *shown]) + "  status")
    points = list(np.ndindex(data["status"].shape))
    for point in points[:LINES]:
        at = dict(zip(keys, point, strict=True))
        row = [f"{data[key].values[place]!s:>18}" for key, place in at.items()]
        row += [f"{float(data[name][at]):>18.6g}" for name in shown]
        lines.append("  ".join(row) + f"  {data['status'][at].item()}")
    if len(points) > LINES:
        lines.append(f"... and {len(points) - LINES} more points")
    if len(names) > COLUMNS:
        lines.append(f"... and {len(names) - COLUMNS} more quantities")
    if out is not None and data.attrs["status"] != "completed":
        lines.append(f"the finished points are in {out}.part; --resume goes on")
    lines.append(f"{data.attrs['seconds']:.2f} s")
    return "\n".join(lines)


def _is_shown(name: str) -> bool:
    """Whether a variable is a quantity, not a count or an error."""
    return name not in ("steps", "seconds", "force_evaluations", "status") and not name.endswith(
        ("_error", "_half_width")
    )
