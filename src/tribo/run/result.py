"""What a run gives back: time series, the end, the error estimate, and what it cost."""

from __future__ import annotations

import json
import math
import os
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.kernels.status import MEANINGS
from tribo.model.scene import Scene
from tribo.model.scene_file import scene_from
from tribo.model.scene_writer import scene_text
from tribo.run.ledger import Ledger, Table
from tribo.validation import InputError

if TYPE_CHECKING:
    import xarray


class Series(Mapping[str, np.ndarray]):
    """The series of one surface: asperite by asperite (times, asperites), and as a block (times,).

    ``series.theta`` is ``series["theta"]``.
    """

    def __init__(self, asperites: Table, block: Table) -> None:
        self._tables = asperites | block

    def __getitem__(self, name: str) -> np.ndarray:
        return self._tables[name]

    def __iter__(self) -> Any:
        return iter(self._tables)

    def __len__(self) -> int:
        return len(self._tables)

    def __getattr__(self, name: str) -> np.ndarray:
        try:
            return self.__dict__["_tables"][name]
        except KeyError:
            raise AttributeError(f"no quantity {name!r}; there are {', '.join(self)}") from None

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._tables]


@dataclass(frozen=True)
class Cost:
    """What a run took."""

    steps: int
    force_evaluations: int  # of the run delivered and of those made to estimate its error
    wall_seconds: float
    compile_seconds: float
    digit_more: float | None = None  # seconds that one more digit would take; None: not known
    digit_fewer: float | None = None  # and one fewer


@dataclass(frozen=True, eq=False)
class Result:
    """A run: ``result["upper"].theta`` is (times, asperites), ``result.end`` what --json prints."""

    scene: Scene
    t: np.ndarray  # (times,)
    ledger: Ledger
    status: str  # "completed", or the name of what stopped it
    method: str
    cost: Cost
    error_estimate: dict[str, float | None]
    # None of these has a default, which a result put together later would show instead of its own.
    accuracy: Any  # what was asked for: a number, or one by the name of each observable
    met: bool | None  # whether every estimate is within it; None where there is none
    notes: tuple[str, ...]
    why: str  # the method was chosen; empty where it was given

    @classmethod
    def later(cls, make: Callable[[], Result]) -> Result:
        """A result that is put together when it is first looked at."""
        result = object.__new__(cls)
        result.__dict__["_make"] = make
        return result

    def __getattr__(self, name: str) -> Any:
        """Only asked for what is not there: all of it, if it has not been put together yet."""
        make = self.__dict__.pop("_make", None)
        if make is None:
            raise AttributeError(f"a result has no {name!r}")
        self.__dict__.update(make().__dict__)
        return getattr(self, name)

    def __getstate__(self) -> dict[str, Any]:
        """What is pickled or copied is whole."""
        _ = self.status
        return self.__dict__

    def __getitem__(self, surface: str) -> Series:
        if surface not in self.ledger.surfaces:
            names = ", ".join(self.ledger.surfaces)
            raise KeyError(f"there is no surface {surface!r}; there are {names}")
        return Series(self.ledger.surfaces[surface], self.ledger.blocks[surface])

    @property
    def system(self) -> Table:
        """The system's ledger: quantity -> (times,)."""
        return self.ledger.system

    @property
    def end(self) -> dict[str, Any]:
        """The end state and the price, as ``tribo run --json`` prints it."""
        books = self.ledger
        return {
            "status": self.status,
            "t": float(self.t[-1]),
            "method": self.method,
            "steps": self.cost.steps,
            "force_evaluations": self.cost.force_evaluations,
            "wall_seconds": self.cost.wall_seconds,
            "compile_seconds": self.cost.compile_seconds,
            "seconds_for_digit_more": self.cost.digit_more,
            "seconds_for_digit_fewer": self.cost.digit_fewer,
            "why": self.why,
            "accuracy": self.accuracy,
            "accuracy_met": self.met,
            "notes": list(self.notes),
            "surfaces": {
                name: {key: values[-1].tolist() for key, values in table.items()}
                for name, table in books.surfaces.items()
            },
            "blocks": {
                name: {key: float(values[-1]) for key, values in table.items()}
                for name, table in books.blocks.items()
            },
            "system": {key: float(values[-1]) for key, values in books.system.items()},
            "error_estimate": dict(self.error_estimate),
        }

    def to_json(self) -> str:
        """`end` as strict JSON: what is not a number is null."""
        return json.dumps(without_nan(self.end), indent=1, allow_nan=False)

    def __str__(self) -> str:
        cost = self.cost
        worst = [value for value in self.error_estimate.values() if value is not None]
        error = f"errors up to {max(worst):.1e}" if worst else "errors not estimated"
        lines = [
            f"{self.scene.title or 'scene'}: {self.status} at t = {self.t[-1]:g}; {self.method}, "
            f"{cost.steps} steps, {cost.force_evaluations} force evaluations, "
            f"{cost.wall_seconds:.3g} s{self._digits()}; {error}"
        ]
        if self.status != "completed":
            lines.append(f"  {MEANINGS[self.status]}")
        for name, block in self.ledger.blocks.items():
            lines.append(
                f"  {name:>10}: work {block['W'][-1]: .6g}, pseudowork {block['W_ps'][-1]: .6g}, "
                f"internal energy {block['delta_E_int'][-1]:+.6g}"
            )
        return "\n".join(lines + [f"  note: {note}" for note in self.notes])

    def _digits(self) -> str:
        """What a digit more or fewer would take."""
        if self.cost.digit_more is None or self.cost.digit_fewer is None:
            return ""
        more, fewer = self.cost.digit_more, self.cost.digit_fewer
        return f" (one digit more {more:.2g} s, one fewer {fewer:.2g} s)"

    def to_xarray(self) -> xarray.Dataset:
        """All series as a labelled data set; names are ``surface.quantity``."""
        return _dataset(self)

    def save(self, path: Any) -> None:
        """Write everything to a NetCDF file that :func:`tribo.load_result` reads."""
        _save(self, path)


def without_nan(value: Any) -> Any:
    """The same nested data with None for every float that JSON has no word for."""
    if isinstance(value, dict):
        return {key: without_nan(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [without_nan(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def _dataset(result: Result) -> xarray.Dataset:
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


def _save(result: Result, path: Any) -> None:
    """Write a NetCDF file; it appears whole or not at all."""
    path = Path(path)
    partial = path.with_name(path.name + ".partial")
    try:
        _dataset(result).to_netcdf(partial, engine="h5netcdf")
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
