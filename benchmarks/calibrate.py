"""Measure the costs of methods: `Cost` in tribo.integrators.methods, PAIR in its cost model.

Evaluations for an error of 1e-6, and their growth with every digit, are medians over a few small
scenes, of the runs of tribo.work_precision.  For methods that integrate bath oscillators exactly
they are also measured with fast baths.  Nanoseconds of an evaluation are those of a pair, of a grid
and of a pair with a large bath: the smallest of several rounds, with the methods interleaved.

    python benchmarks/calibrate.py [--json]

It prints one line for each method, as the table of methods has them, then
`fast_bath` of methods and the first numbers of PAIR.
"""

import argparse
import json
from dataclasses import replace
from statistics import median

import numpy as np

import tribo
import tribo.loops.select
from tribo import paper
from tribo.accuracy.levels import first_guess, setting_at
from tribo.integrators import methods
from tribo.integrators.methods import METHODS
from tribo.layout.layout import lay_out
from tribo.loops.resolution import unit_step
from tribo.loops.select import Integrator
from tribo.work_precision import WorkPrecision, work_precision

# Relative errors at which evaluations are counted.
COARSE, FINE = 1e-6, 1e-11

# Rounds in which nanoseconds are measured.
ROUNDS = 5

# Duration of the pair of which nanoseconds are measured, in units of the paper's.
LONG = 50.0

# Evaluations of a step by each method.
STEP = {name: method.cost.step for name, method in METHODS.items() if method.cost}


def small_scenes() -> list[tribo.Scene]:
    """Cases A to D of the paper, and a short row with a Morse potential."""
    row = {"shape": (4, 1), "spacing": (1.1, 0.0)}
    upper = tribo.Surface("upper", bob=(-6.0, 0.9), velocity=(0.8, 0.0), **row)
    lower = tribo.Surface("lower", facing="up", **row)
    bond = tribo.Morse(0.3, 2.0, 0.8)
    return [*(paper.scene(c) for c in "ABCD"), tribo.Scene((upper, lower), bond, 14.0)]


def evaluations(found: WorkPrecision, method: str, error: float) -> float:
    """Evaluations for an error, interpolated between runs."""
    rows = [row for row in found.rows if row.method == method and row.error > 0.0]
    x = np.log([row.error for row in rows])[::-1]
    y = np.log([row.force_evaluations for row in rows])[::-1]
    return float(np.exp(np.interp(np.log(error), x, y)))


def fast_baths() -> list[tribo.Scene]:
    """Pairs with oscillators that are much faster than the pendulums."""
    scenes = []
    for case, n in (("A", 100), ("A", 200), ("C", 100)):
        bath = {"spectrum": "drude", "gamma": 0.2, "cutoff": 2.0, "n": n}
        scene = paper.scene(case)
        bathed = tuple(replace(surface, bath=bath) for surface in scene.surfaces)
        scenes.append(replace(scene, surfaces=bathed))
    return scenes


def evaluation_rates(
    scenes: list[tribo.Scene], names: list[str], seconds: float
) -> dict[str, tuple[float, float]]:
    """Evaluations per radian at 1e-6 and the slope of their growth, by method."""
    counts: dict[str, list[tuple[float, float]]] = {name: [] for name in names}
    for scene in scenes:
        found = work_precision(scene, names, seconds=seconds)
        radians = scene.duration / unit_step(tribo.prepare(scene, method="rkn8").layout)
        for name in {row.method for row in found.rows}:
            best = min(row.error for row in found.rows if row.method == name)
            coarse = evaluations(found, name, COARSE)
            order = METHODS[name].order
            slope = float(order)
            if best < FINE:
                slope = np.log(COARSE / FINE) / np.log(evaluations(found, name, FINE) / coarse)
            elif best > COARSE:
                coarse *= (best / COARSE) ** (1.0 / order)
            counts[name].append((coarse / radians, float(slope)))
    return {
        name: (median(c for c, _ in found), median(s for _, s in found))
        for name, found in counts.items()
        if found
    }


def pair() -> tribo.Scene:
    """Case C of the paper, so long that the call of the loop takes no part of the time."""
    return replace(paper.scene("C"), duration=LONG * paper.scene("C").duration)


def grid() -> tribo.Scene:
    """A thousand asperites, each within the cutoff of a few."""
    surface = {"shape": (23, 23), "spacing": (1.5, 1.5), "asperite": tribo.Asperite(kappa=20.0)}
    upper = tribo.Surface("upper", bob=(0.3, 1.2), velocity=(0.5, 0.0), drive="free", **surface)
    lower = tribo.Surface("lower", facing="up", **surface)
    potential = tribo.LennardJones(0.05, 1.0).with_cutoff(2.5)
    return tribo.Scene((upper, lower), potential, 1.0)


def bathed() -> tribo.Scene:
    """A pair with a thousand oscillators on every bar."""
    bath = {"oscillators": [{"mass": 1e-3, "frequency": 1.0 + 1e-3 * k} for k in range(1000)]}
    upper = tribo.Surface("upper", bob=(-10.0, 0.0), velocity=(0.5, 0.0), bath=bath)
    lower = tribo.Surface("lower", facing="up", bath=bath)
    return tribo.Scene((upper, lower), tribo.Coulomb(0.2), 40.0)


def nanoseconds(scene: tribo.Scene, names: list[str]) -> dict[str, float]:
    """Nanoseconds of an evaluation by method: the smallest of several rounds."""
    few = tribo.Output(samples=2)
    scene = tribo.Scene(scene.surfaces, scene.interactions, scene.duration, output=few)
    runs = {name: Integrator(lay_out(scene), METHODS[name]) for name in names}
    least = dict.fromkeys(names, np.inf)
    for _ in range(ROUNDS):
        for name, run_by in runs.items():
            layout, method = run_by.layout, METHODS[name]
            level = 1e-8 if method.adaptive else 0.1**method.order
            setting = setting_at(layout, method, first_guess(layout), level)
            run = run_by(setting, scene.times)
            if run.status == "completed":
                least[name] = min(least[name], 1e9 * run.seconds / run.evaluations)
    return least


def main() -> None:
    """Measure, and print the lines of the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--seconds", type=float, default=20.0, help="for the runs of each scene")
    options = parser.parse_args()
    pairs = evaluation_rates(small_scenes()[:4], ["gauss-radau-15"], options.seconds)
    tribo.loops.select.has_pair_loop = lambda *scene: False  # pairs by the general loops too
    general = evaluation_rates(small_scenes(), list(METHODS), options.seconds)
    exact = [m.name for m in METHODS.values() if m.splits and not methods.refusal(m, bathed())]
    with_bath = evaluation_rates(fast_baths(), exact, options.seconds)
    names = list(general)
    of_pair, of_grid = nanoseconds(pair(), names), nanoseconds(grid(), names)
    taking_baths = [name for name in names if name != "blanes-moan-6"]
    of_bath = nanoseconds(bathed(), taking_baths)
    count, oscillators = grid().count, 2 * 2 * 1000
    rows = {}
    for name, (each, slope) in general.items():
        asperite = (of_grid[name] - of_pair[name]) / (count - 2)
        oscillator = max(0.0, (of_bath.get(name, np.nan) - of_pair[name]) / oscillators)
        fixed = max(0.0, of_pair[name] - 2.0 * asperite)
        rows[name] = [each, slope, fixed, asperite, oscillator]
    if options.json:
        print(json.dumps({"rates": rows, "bathed": with_bath, "pairs": pairs}, indent=1))
        return
    for name, numbers in rows.items():
        print(f"    {name}: Cost({', '.join(f'{x:.3g}' for x in numbers)}, {STEP[name]})")
    for name, (each, slope) in [*with_bath.items(), *pairs.items()]:
        print(f'    "{name}": ({each:.3g}, {slope:.3g}),')


if __name__ == "__main__":
    main()
