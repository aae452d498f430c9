"""What a run gives back: time series, the end, the error estimate, and what it cost."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.kernels.status import MEANINGS
from tribo.model.scene import Scene
from tribo.run.ledger import Ledger, Table

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
        from tribo.run.archive import dataset

        return dataset(self)

    def save(self, path: Any) -> None:
        """Write everything to a NetCDF file that :func:`tribo.load_result` reads."""
        from tribo.run.archive import save

        save(self, path)


def without_nan(value: Any) -> Any:
    """The same nested data with None for every float that JSON has no word for."""
    if isinstance(value, dict):
        return {key: without_nan(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [without_nan(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
