"""The tables and the picture of hard_cases.md, from what benchmarks/atlas.py measured."""

import json
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from tribo import atlas
from tribo.integrators.methods import METHODS, Method
from tribo.plotting.style import CYCLE, WIDE, drawing_on, save

MEASURED = Path(__file__).resolve().parent / "measured" / "atlas.json"
# Errors below this are drawn here: log scales have no zero.
LEAST = 1e-16
ERROR_COLOUR, BOUND_COLOUR = CYCLE[:2]
# How the outcomes of runs by a method are shown; a completed run shows its evaluations.
SHOWN = {
    "completed, accuracy not met": "not met",
    "completed, error above its estimate": "wrong",
    "NoProgress": "costly",
}

# Which methods each table of methods has: few enough for the width of a page.
KINDS: dict[str, Callable[[Method], bool]] = {
    "adaptive": lambda method: method.adaptive,
    "equal": lambda method: not method.adaptive and not method.splits,
    "splitting": lambda method: method.splits,
}


def measured() -> dict[str, Any]:
    """Scene -> its row, and its runs by every method."""
    data: dict[str, Any] = json.loads(MEASURED.read_text(encoding="utf-8"))
    return data


def outcomes() -> Iterator[list[str]]:
    """Every scene: its outcome, its error beside its estimate, and how simple integrators fail."""
    yield ["scene", "outcome", "error", "estimate", "how a simple integrator fails"]
    for name, data in measured().items():
        row = data["row"]
        (entry,) = atlas.chosen([name])
        outcome = row["outcome"] if row["as_declared"] else f"**{row['outcome']}**"
        numbers = (_power(row["error"]), _power(row["estimate"]))
        yield [f"`{name}`: {entry.scene().title}", outcome, *numbers, entry.failure]


def by_method(kind: str) -> Iterator[list[str]]:
    """Every scene by every method of a kind: force evaluations, or why there is no number."""
    methods = [name for name, method in METHODS.items() if KINDS[kind](method)]
    yield ["scene", *(f"`{method}`" for method in methods)]
    for name, data in measured().items():
        cells = {cell["method"]: _cell(cell) for cell in data["methods"]}
        if cells:
            yield [f"`{name}`", *(cells[method] for method in methods)]


def stability() -> Iterator[list[str]]:
    """Every method: how many scenes it completes, refuses, stops at, or leaves unfinished."""
    kinds = ("completed", "not met", "stopped", "costly", "refused", "wrong")
    yield ["method", *kinds]
    runs = [cell for data in measured().values() for cell in data["methods"]]
    for method in METHODS:
        found = [_kind(cell) for cell in runs if cell["method"] == method]
        yield [f"`{method}`", *(str(found.count(kind)) for kind in kinds)]


def _kind(cell: dict[str, Any]) -> str:
    """The outcome of a run by a method in one word."""
    outcome = _outcome(cell)
    known = {"completed", "refused", "costly"}
    return SHOWN.get(outcome, outcome if outcome in known else "stopped")


def _outcome(cell: dict[str, Any]) -> str:
    """The outcome of a run; a refusal of too many steps is one of cost, as `NoProgress` is."""
    too_many = cell["outcome"] == "refused" and cell["why"].startswith("accuracy: would take")
    return "costly" if too_many else cell["outcome"]


def _cell(cell: dict[str, Any]) -> str:
    """Force evaluations of a run that completed, or its outcome."""
    outcome = _outcome(cell)
    if outcome == "completed":
        return _power(cell["evaluations"])
    return SHOWN.get(outcome, outcome)


def _power(value: float | None) -> str:
    """A number to two digits."""
    return "" if value is None else f"{value:.1e}".replace("e+0", "e").replace("e-0", "e-")


def figure(path: Path) -> None:
    """Errors, estimates and bounds of all scenes that have a reference of their end."""
    rows = [(name, data["row"]) for name, data in measured().items()]
    rows = [(name, row) for name, row in rows if row["error"] is not None]
    with drawing_on(None, WIDE, 0.17 * len(rows) + 0.7) as ax:
        for y, (name, row) in enumerate(reversed(rows)):
            (entry,) = atlas.chosen([name])
            error = max(row["error"], LEAST)
            if row["estimate"] is not None and math.isfinite(row["estimate"]):
                ax.plot([error, max(row["estimate"], LEAST)], [y, y], color="0.7", linewidth=3)
            ax.plot(error, y, "o", color=ERROR_COLOUR, markersize=3.5)
            ax.plot(entry.bound, y, "|", color=BOUND_COLOUR, markersize=6)
        ax.set_xscale("log")
        ax.set_yticks(range(len(rows)), [name for name, _ in reversed(rows)])
        ax.tick_params(axis="y", which="both", length=0)
        ax.set_ylim(-1, len(rows))
        ax.set_xlabel("error (dot), its estimate (end of the line), declared bound (tick)")
        save(ax, path)
