"""The atlas by every method: which stay right, which refuse, and what each costs.

    python benchmarks/atlas.py [--seconds S] [NAME ...]

Writes docs/measured/atlas.json, from which docs/hard_cases.md is made.  Each scene is run as its
file says, and then by every method at the accuracy of METHODS_AT, for at most S seconds a run after
compilation.  Scenes that are about a step of their own, or about noise, have no rows by method.
Runs that are in the file already are kept, unless their scenes are named.
"""

import argparse
import json
import time
import warnings
from dataclasses import asdict
from pathlib import Path

import tribo
from tribo import atlas
from tribo.integrators.methods import METHODS
from tribo.simulation import prepare

FILE = Path(__file__).resolve().parents[1] / "docs" / "measured" / "atlas.json"
# The accuracy of the runs by method: methods of order 2 reach it on easy scenes.
METHODS_AT = 1e-6


class Watch:
    """Ends a run, as Ctrl-C does, some seconds after its first steps."""

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self.end: float | None = None

    def __call__(self, t: float) -> None:
        now = time.perf_counter()
        self.end = now + self.seconds if self.end is None else self.end
        if now > self.end:
            raise KeyboardInterrupt


def by_method(entry: atlas.Entry, method: str, seconds: float) -> dict[str, object]:
    """Outcome, error, estimate and cost of a scene by a method."""
    cell: dict[str, object] = {"scene": entry.name, "method": method}
    try:
        simulation = prepare(
            entry.scene(), accuracy=METHODS_AT, method=method, progress=Watch(seconds)
        )
    except tribo.InputError as error:
        return cell | {"outcome": "refused", "why": str(error)}
    result = simulation.compute_first()
    row = atlas.judge(entry, result, 0.0)
    return cell | {
        "outcome": row.outcome,
        "error": row.error,
        "estimate": row.estimate,
        "evaluations": result.cost.force_evaluations,
    }


def measure(names: list[str], seconds: float) -> None:
    """Run what is missing in the file, or what is named, and write the file scene by scene."""
    kept = json.loads(FILE.read_text(encoding="utf-8")) if FILE.exists() else {}
    for entry in atlas.chosen(names):
        if entry.name in kept and not names:
            continue
        numerics = entry.scene().numerics
        methods = METHODS if numerics.step is None else ()
        cells = [by_method(entry, method, seconds) for method in methods]
        kept[entry.name] = {"row": asdict(atlas.row(entry)), "methods": cells}
        FILE.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
        print(kept[entry.name]["row"], *(c["outcome"] for c in cells), flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--seconds", type=float, default=1.0)
    options = parser.parse_args()
    warnings.simplefilter("ignore", tribo.TriboWarning)
    measure(options.names, options.seconds)
