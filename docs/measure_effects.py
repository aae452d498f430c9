"""What each effect costs, and loops written by hand beside tribo's: the tables of effects.md.

    python docs/measure_effects.py [ARGUMENT OF benchmarks/effects.py ...]

Runs ``python benchmarks/effects.py --json`` and keeps what it prints in docs/measured/effects.json;
the tables and the figure are made from it when the pages are built.  It takes half an hour,
most of which is compiling.  Run it on a machine that does nothing else.
"""

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tribo.plotting import INK, WIDE, save, style
from tribo.plotting.style import CYCLE

HERE = Path(__file__).resolve().parent
FILE = HERE / "measured" / "effects.json"
PROGRAM = HERE.parent / "benchmarks" / "effects.py"
ALONE_COLOUR, TOGETHER_COLOUR = CYCLE[:2]


def measure(arguments: list[str]) -> None:
    """Run the benchmark and keep its tables."""
    command = [sys.executable, str(PROGRAM), "--json", *arguments]
    text = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout
    json.loads(text)
    FILE.write_text(text, encoding="utf-8")


def kept() -> dict[str, list[dict[str, Any]]]:
    """The tables that were measured."""
    return json.loads(FILE.read_text(encoding="utf-8"))


def by_hand() -> Iterator[list[str]]:
    """Nanoseconds a step of tribo's general loop and of loops by hand."""
    yield ["scene", "tribo, ns a step", "by hand, ns a step", "ratio"]
    for row in kept()["rows"]:
        ratio = row["tribo_ns"] / row["by_hand_ns"]
        yield [row["scene"], f"{row['tribo_ns']:.0f}", f"{row['by_hand_ns']:.0f}", f"{ratio:.2f}"]


def costs() -> Iterator[list[str]]:
    """What each effect costs."""
    yield [
        "effect",
        "alone, ns",
        "share",
        "together, ns",
        "share",
        "bytes an asperite",
        "compiling, s",
    ]
    for row in kept()["effects"]:
        cells = [row["effect"], f"{row.get('alone_ns', row.get('ns')):.1f}"]
        cells += [_percent(row, "alone"), _number(row, "together_ns"), _percent(row, "together")]
        yield [*cells, f"{row['bytes']:.0f}", f"{row['compile_seconds']:.1f}"]


def _number(row: dict[str, Any], key: str) -> str:
    return f"{row[key]:.1f}" if key in row else ""


def _percent(row: dict[str, Any], key: str) -> str:
    share = row.get(f"{key}_share")
    return "" if share is None else f"{100.0 * share:.0f} %"


def figure(path: Path) -> None:
    """Draw the cost of each effect, alone and together with all others."""
    import matplotlib.pyplot as plt

    rows = [row for row in kept()["effects"] if "alone_ns" in row][::-1]
    with style():
        _, ax = plt.subplots(figsize=(WIDE, 0.19 * len(rows) + 0.7), layout="constrained")
        for shift, key, colour in (
            (0.2, "alone", ALONE_COLOUR),
            (-0.2, "together", TOGETHER_COLOUR),
        ):
            shown = [(k, row[f"{key}_ns"]) for k, row in enumerate(rows) if f"{key}_ns" in row]
            places = [k + shift for k, _ in shown]
            ax.barh(places, [ns for _, ns in shown], 0.38, color=colour, label=key)
        ax.axvline(0.0, color=INK, linewidth=0.6)
        ax.set_yticks(range(len(rows)), [row["effect"] for row in rows])
        ax.tick_params(axis="y", which="both", length=0)
        ax.minorticks_off()
        ax.set_xlabel("time per asperite and step (ns)")
        ax.legend()
    save(ax, path)


if __name__ == "__main__":
    measure(sys.argv[1:])
