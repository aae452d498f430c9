"""The atlas by every method: which stay right, which refuse, and what each costs.

    python benchmarks/atlas.py [NAME ...]

Writes docs/measured/atlas.json, from which docs/reference/hard_cases.md is made.  Each scene is
run as its file says, and then by every method at the accuracy of METHODS_AT, with at most MOST
evaluations of all forces a run.  Scenes that give a step, and those with noise, have no rows by
method.  Runs that are in the file already are kept, unless their scenes are named.
"""

import argparse
import json
import warnings
from dataclasses import asdict, replace
from pathlib import Path

import tribo
from tribo import atlas
from tribo.integrators.methods import METHODS
from tribo.simulation import prepare

FILE = Path(__file__).resolve().parents[1] / "docs" / "measured" / "atlas.json"
# The accuracy of the runs by method: methods of order 2 reach it on easy scenes.
METHODS_AT = 1e-6
# Evaluations of all forces that a run may take: a pair's take 0.1 to 1 s.
MOST = 3e6


def by_method(entry: atlas.HardScene, method: str) -> dict[str, object]:
    """Outcome, error, estimate and cost of a scene by a method."""
    cell: dict[str, object] = {"scene": entry.name, "method": method}
    scene = entry.scene()
    scene = replace(scene, numerics=replace(scene.numerics, max_evaluations=MOST))
    try:
        simulation = prepare(scene, accuracy=METHODS_AT, method=method)
        result = simulation.compute_first()
    except tribo.InputError as error:
        return cell | {"outcome": "refused", "why": str(error)}
    row = atlas.judge(entry, result, 0.0)
    return cell | {
        "outcome": row.outcome,
        "error": row.error,
        "estimate": row.estimate,
        "evaluations": result.cost.force_evaluations,
    }


def measure(names: list[str]) -> None:
    """Run what is missing in the file, or what is named, and write the file scene by scene."""
    kept = json.loads(FILE.read_text(encoding="utf-8")) if FILE.exists() else {}
    for entry in atlas.chosen(names):
        if entry.name in kept and not names:
            continue
        numerics = entry.scene().numerics
        methods = METHODS if numerics.step is None else ()
        cells = [by_method(entry, method) for method in methods]
        kept[entry.name] = {"row": asdict(atlas.row(entry)), "methods": cells}
        FILE.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
        print(kept[entry.name]["row"], *(c["outcome"] for c in cells), flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME")
    options = parser.parse_args()
    warnings.simplefilter("ignore", tribo.TriboWarning)
    measure(options.names)
