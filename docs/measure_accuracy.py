"""The cost of accuracy: the diagrams of accuracy_benchmark.md, and the runs behind its tables.

    python docs/measure_accuracy.py [--choices] [SCENE ...]

Runs ``tribo accuracy`` on each scene, for at most a minute once the methods are compiled, then the
methods that tribo chooses.  The figure and the runs are kept in docs/measured, and the tables are
made from them when the pages are built.  With --choices only the chosen methods are measured again.
Run it on a machine that does nothing else.
"""

import json
import math
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import tribo
from tribo import paper
from tribo.integrators.methods import METHODS
from tribo.work_precision import Reference, Row, WorkPrecision, work_precision
from tribo.work_precision.measure import TIMES

HERE = Path(__file__).resolve().parent
FOLDER = HERE / "measured"
SECONDS = 60.0  # for all runs of a scene together
CHOSEN_AT = (1e-3, 1e-6, 1e-9, 1e-11)  # accuracies of the table of choices
REPEATED = 0.1  # seconds for runs of one setting, of which the shortest counts
COUNTED_AT = (1e-3, 1e-6, 1e-9, 1e-12)  # errors of the table of evaluations


def rows() -> tribo.Scene:
    """Two rows of 64 that bind, dragged over each other by two spacings."""
    row = {"shape": (64, 1), "asperite": tribo.Asperite(kappa=8.0)}
    upper = tribo.Surface("upper", bob=(0.3, 0.9), velocity=(0.5, 0.0), spacing=(1.1, 0.0), **row)
    lower = tribo.Surface("lower", facing="up", spacing=(1.0, 0.0), **row)
    return tribo.Scene((upper, lower), tribo.Morse(0.1, 2.5, 0.8), 4.0, "rows of 64")


def grid() -> tribo.Scene:
    """Two grids of 12 by 12, where each bob reaches a few others."""
    grid = {"shape": (12, 12), "spacing": (1.5, 1.5), "asperite": tribo.Asperite(kappa=20.0)}
    upper = tribo.Surface("upper", bob=(0.3, 1.2), velocity=(0.5, 0.0), drive="free", **grid)
    lower = tribo.Surface("lower", facing="up", **grid)
    potential = tribo.LennardJones(0.05, 1.0).with_cutoff(2.5)
    return tribo.Scene((upper, lower), potential, 3.0, "grids of 12 by 12")


def bath() -> tribo.Scene:
    """Case A with two hundred oscillators on every bar."""
    bath = {"spectrum": "drude", "gamma": 0.2, "cutoff": 2.0, "n": 200}
    upper = tribo.Surface("upper", bob=(-10.0, 0.0), velocity=(0.5, 0.0), bath=bath)
    lower = tribo.Surface("lower", facing="up", bath=bath)
    return tribo.Scene((upper, lower), tribo.Coulomb(0.2), 40.0, "a pair with baths")


SCENES: dict[str, Callable[[], tribo.Scene]] = {
    "A": lambda: paper.scene("A"),
    "B": lambda: paper.scene("B"),
    "C": lambda: paper.scene("C"),
    "D": lambda: paper.scene("D"),
    "rows": rows,
    "grid": grid,
    "bath": bath,
}
NAMES = {
    **{letter: f"case {letter}" for letter in "ABCD"},
    "rows": "rows of 64, Morse",
    "grid": "grids of 144, Lennard-Jones with a switch",
    "bath": "a pair with 2 \N{MULTIPLICATION SIGN} 200 oscillators",
}


def measure(name: str, choices_alone: bool) -> None:
    """Run all methods on a scene, and the chosen ones; keep the figure and the runs."""
    if choices_alone:
        found = kept(name)
    else:
        found = work_precision(SCENES[name](), seconds=SECONDS, progress=print)
        FOLDER.mkdir(exist_ok=True)
        found.save_figure(FOLDER / f"accuracy_{name}.png")
    runs = json.loads(found.to_json()) | {"chosen": list(choices(name))}
    text = json.dumps(runs).replace("}, ", "},\n")  # a line for each run
    (FOLDER / f"accuracy_{name}.json").write_text(text + "\n", encoding="utf-8")
    print(f"{name}\n{found}", *runs["chosen"], sep="\n", flush=True)


def choices(name: str) -> Iterator[dict[str, Any]]:
    """The method chosen for each accuracy, and the time of a run of a prepared scene by it."""
    scene = replace(SCENES[name](), output=tribo.Output(samples=TIMES))
    for wanted in CHOSEN_AT:
        simulation = tribo.prepare(scene, accuracy=wanted)
        seconds = _loop_seconds(simulation)
        for _ in range(max(2, int(REPEATED / seconds))):
            seconds = min(seconds, _loop_seconds(simulation))
        yield {
            "accuracy": wanted,
            "method": simulation.method.name,
            "met": simulation.first_result().met,
            "seconds": seconds,
        }


def _loop_seconds(simulation: tribo.Simulation) -> float:
    """Time of one run of the compiled loop, which is how the runs of the diagrams are timed."""
    return simulation.run(estimate=False).cost.wall_seconds


def kept(name: str) -> WorkPrecision:
    """The runs measured on a scene."""
    return _kept(name)[0]


def _kept(name: str) -> tuple[WorkPrecision, list[dict[str, Any]]]:
    """The runs measured on a scene, and the chosen methods."""
    table = json.loads((FOLDER / f"accuracy_{name}.json").read_text(encoding="utf-8"))
    own = table.pop("chosen")
    runs = tuple(Row(**row) for row in table["rows"])
    automatic = {item["error"]: item["automatic_method"] for item in table["cheapest"]}
    reference = Reference(**table["reference"])
    return WorkPrecision(runs, reference, table["compile_seconds"], automatic), own


def chosen() -> Iterator[list[str]]:
    """The chosen methods, and their times beside the fastest runs of the diagrams."""
    yield ["scene", "accuracy", "chosen", "a run", "fastest by hand", "a run", "ratio"]
    for name, title in NAMES.items():
        found, picks = _kept(name)
        for own in picks:
            best = found.best(own["accuracy"])
            cells = [title, f"{own['accuracy']:.0e}", f"`{own['method']}`", _time(own["seconds"])]
            if best is not None:
                ratio = f"{own['seconds'] / best.seconds:.2f}"
                cells += [f"`{best.method}`", _time(best.seconds), ratio]
            yield cells + ["-"] * (7 - len(cells))


def _time(seconds: float) -> str:
    """A time in µs, ms or s."""
    if seconds < 1e-3:
        return f"{1e6 * seconds:.3g} µs"
    return f"{1e3 * seconds:.3g} ms" if seconds < 1.0 else f"{seconds:.3g} s"


def evaluations() -> Iterator[list[str]]:
    """Evaluations of all forces in a single run for a given error, method by method."""
    found = {letter: kept(letter) for letter in "AC"}
    yield ["method", *(f"{letter}, {e:.0e}" for letter in found for e in COUNTED_AT)]
    for method in METHODS:
        cells = []
        for runs in found.values():
            curve = [(r.error, r.force_evaluations) for r in runs.rows if r.method == method]
            cells += [_at(curve, wanted) for wanted in COUNTED_AT]
        yield [f"`{method}`", *cells]


def _at(curve: list[tuple[float, int]], wanted: float) -> str:
    """Evaluations from which on the error stays below `wanted`, interpolated between runs."""
    above = [k for k, (error, _) in enumerate(curve) if error > wanted]
    last = above[-1] if above else -1
    if last == len(curve) - 1:
        return "-"
    if last < 0:
        return f"< {_short(curve[0][1])}"
    (e0, n0), (e1, n1) = curve[last], curve[last + 1]
    share = math.log(e0 / wanted) / math.log(e0 / e1)
    return _short(n0 * (n1 / n0) ** share)


def _short(n: float) -> str:
    """A number with two digits."""
    if n < 1000:
        return f"{float(f'{n:.2g}'):.0f}"
    return f"{n / 1000:.1f}k" if n < 10_000 else f"{float(f'{n / 1000:.2g}'):.0f}k"


if __name__ == "__main__":
    names = [name for name in sys.argv[1:] if name != "--choices"]
    for name in names or SCENES:
        measure(name, "--choices" in sys.argv)
