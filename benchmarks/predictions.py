"""How well `tribo explain` predicts: its numbers beside those of the run.

Scenes are those of the documents, each with several accuracies or a step.  Evaluations are the same
on every machine; seconds and bytes are measured.  A ratio is predicted over taken; the memory of a
run is the peak of what numpy allocates.

    python benchmarks/predictions.py [--json] [--scenes NAME ...]
"""

import argparse
import json
import sys
import tracemalloc
import warnings
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import tribo
from tribo import paper

DOCS = Path(__file__).resolve().parents[1] / "docs"
sys.path.insert(0, str(DOCS))

import measure  # noqa: E402
import measure_accuracy  # noqa: E402

# Accuracies of every scene.
ACCURACIES = (1e-4, 1e-8, 1e-11)

# Method and step of every scene once more.
STEPPED = tribo.Numerics(method="verlet", step=0.01)


def scenes() -> dict[str, tribo.Scene]:
    """The scenes of the documents."""
    cases = {f"case {letter}": paper.scene(letter) for letter in "ABCDE"}
    large = {name: measure_accuracy.SCENES[name]() for name in ("rows", "grid", "bath")}
    return cases | measure.hard_scenes() | large


def row(name: str, scene: tribo.Scene) -> dict[str, Any]:
    """One scene: predicted and taken."""
    predicted = tribo.explain(scene).predicted
    taken = tribo.simulate(scene).cost
    tracemalloc.start()
    _ = tribo.simulate(scene).end
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    numerics = scene.numerics
    return {
        "scene": name,
        "numerics": "verlet" if numerics.step else f"{numerics.accuracy:.0e}",
        "basis": predicted.basis,
        "force_evaluations": taken.force_evaluations,
        "evaluations_ratio": predicted.force_evaluations / taken.force_evaluations,
        "seconds": taken.wall_seconds,
        "seconds_ratio": predicted.seconds / taken.wall_seconds,
        "memory_bytes": peak,
        "memory_ratio": predicted.memory_bytes / peak,
    }


def rows(names: list[str] | None) -> Iterator[dict[str, Any]]:
    """All scenes with all settings."""
    settings = [*(tribo.Numerics(accuracy=accuracy) for accuracy in ACCURACIES), STEPPED]
    for name, scene in scenes().items():
        for numerics in settings if names is None or name in names else ():
            yield row(name, replace(scene, numerics=numerics))


def main() -> None:
    """Predict and run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--scenes", nargs="*")
    options = parser.parse_args()
    warnings.simplefilter("ignore", tribo.TriboWarning)
    found = []
    for each in rows(options.scenes):
        found.append(each)
        if not options.json:
            print(
                f"{each['scene'][:32]:<32} {each['numerics']:>7} {each['basis']:<12} "
                f"{each['force_evaluations']:>9} x {each['evaluations_ratio']:<5.2f} "
                f"{each['seconds']:>8.2g} s x {each['seconds_ratio']:<5.2f} "
                f"{each['memory_bytes'] / 1e6:>8.2f} MB x {each['memory_ratio']:<5.2f}",
                flush=True,
            )
    if options.json:
        print(json.dumps({"rows": found}, indent=1))


if __name__ == "__main__":
    main()
