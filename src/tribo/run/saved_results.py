"""Results read from files."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING

from tribo.kernels.status import Status
from tribo.run import dataset
from tribo.run.cost import Cost
from tribo.run.identity import opened
from tribo.run.result import Known, Result
from tribo.validation import as_path

if TYPE_CHECKING:
    pass


def load_result(path: str | Path) -> Result:
    """Read a result from the file that :meth:`tribo.Result.save` wrote.

    Parameters
    ----------
    path : str or Path
        The file.

    Returns
    -------
    Result

    Raises
    ------
    InputError
        There is no such file, or it holds no result.
    """
    path = as_path(path)
    data = dataset.load(path)
    settings, stamps = (json.loads(data.attrs[name]) for name in ("settings", "plugins"))
    scene = opened(tomllib.loads(data.attrs["scene"]), stamps, path.parent)
    bounds = json.loads(data.attrs["error_estimate"])
    return Result(
        scene=scene,
        status=Status(data.attrs["status"]),
        method=data.attrs["method"],
        why=data.attrs["why"],
        accuracy=json.loads(data.attrs["accuracy"]),
        met=json.loads(data.attrs["met"]),
        notes=tuple(json.loads(data.attrs["notes"])),
        bounds={name: bound for name, bound in bounds.items() if bound is not None},
        assemble=Known(dataset.ledger_of(data, scene)),
        add_up=Known(Cost(**json.loads(data.attrs["cost"]))),
        take_state=Known(dataset.state_in(data, scene)),
        settings=settings,
        version=data.attrs["version"],
    )
