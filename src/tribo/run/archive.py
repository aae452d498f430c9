"""Results on disk: NetCDF, by xarray and h5netcdf."""

from __future__ import annotations

import json
import os
import tomllib
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.model.scene_file import scene_from, scene_text
from tribo.run.ledger import Ledger
from tribo.run.result import Cost, Result
from tribo.validation import InputError

if TYPE_CHECKING:
    import xarray


def dataset(result: Result) -> xarray.Dataset:
    """All series as a labelled data set, with everything else that is known in its attributes."""
    import xarray

    from tribo import __version__

    variables: dict[str, Any] = {}
    for name, table in result.ledger.surfaces.items():
        for key, values in table.items():
            variables[f"{name}.{key}"] = (("time", f"{name}_asperite"), values)
        for key, values in result.ledger.blocks[name].items():
            variables[f"{name}.{key}"] = (("time",), values)
    for key, values in result.system.items():
        variables[key] = (("time",), values)
    about = {
        "tribo_version": __version__,
        "scene": scene_text(result.scene),
        "status": result.status,
        "method": result.method,
        "cost": json.dumps(asdict(result.cost)),
        "error_estimate": json.dumps(result.error_estimate),
        "accuracy": json.dumps(result.accuracy),
        "met": json.dumps(result.met),
        "notes": json.dumps(result.notes),
        "why": result.why,
    }
    return xarray.Dataset(variables, coords={"time": result.t}, attrs=about)


def save(result: Result, path: Any) -> None:
    """Write a NetCDF file; it appears whole or not at all."""
    path = Path(path)
    partial = path.with_name(path.name + ".partial")
    try:
        dataset(result).to_netcdf(partial, engine="h5netcdf")
        os.replace(partial, path)
    except OSError as error:
        partial.unlink(missing_ok=True)
        raise InputError(str(path), f"cannot be written ({error.strerror or error})") from None


def load_result(path: Any) -> Result:
    """The result that `Result.save` wrote."""
    import xarray

    path = Path(path)
    try:
        data = xarray.load_dataset(path, engine="h5netcdf")
    except OSError as error:
        raise InputError(str(path), f"cannot be read ({error.strerror or error})") from None
    if "scene" not in data.attrs:
        raise InputError(str(path), "is not a result that tribo has written")
    scene = scene_from(tomllib.loads(data.attrs["scene"]), path.parent)
    surfaces: dict[str, dict[str, np.ndarray]] = {s.name: {} for s in scene.surfaces}
    blocks: dict[str, dict[str, np.ndarray]] = {s.name: {} for s in scene.surfaces}
    system = {}
    for name, values in data.data_vars.items():
        surface, _, key = str(name).rpartition(".")
        if not surface:
            system[key] = values.values
        elif values.ndim == 2:
            surfaces[surface][key] = values.values
        else:
            blocks[surface][key] = values.values
    return Result(
        scene=scene,
        t=data["time"].values,
        ledger=Ledger(surfaces, blocks, system),
        status=data.attrs["status"],
        method=data.attrs["method"],
        cost=Cost(**json.loads(data.attrs["cost"])),
        error_estimate=json.loads(data.attrs["error_estimate"]),
        accuracy=json.loads(data.attrs["accuracy"]),
        met=json.loads(data.attrs["met"]),
        notes=tuple(json.loads(data.attrs["notes"])),
        why=data.attrs.get("why", ""),  # which older files do not say
    )
