"""Measure time and memory against the number of asperites, at fixed density.

Two square grids of Lennard-Jones bobs with a cutoff slide over one another by Verlet.  Each size is
run for few and for more steps.  The difference gives the time of a step; the rest (layout, first
neighbour list, two samples) is reported apart.  It prints nanoseconds per asperite and step, their
ratio to those of the smallest size, the seconds that building and laying out the scene take, and
the peak memory.  A constant ratio means that the time is linear in the number of asperites.

With --inactive it slides a grid of 10 × 10 over one of 100 × 100 instead, most of which is out of
reach, and over one of 10 × 10.  It prints the microseconds of a step of both, and their ratio.

    python benchmarks/scale.py [--json] [--most 1000000]
    python benchmarks/scale.py --inactive [--json]
    python benchmarks/scale.py --once 10000000      # one run, to see how far one machine goes
"""

import argparse
import json
import resource
import time

import numpy as np

import tribo
from tribo.layout.layout import lay_out

# Numbers of asperites.
SIZES = (1_000, 10_000, 100_000, 1_000_000)

# Step of Verlet [time].
STEP = 0.01

# Distance of neighbours in a grid [length].
SPACING = 1.5

# Asperites along each side of a small grid, and of one that is large beside it.
SMALL, LARGE = 10, 100

# Steps of a short and of a long run over a grid, which slides by a third of the small one.
FEW, SLIDE = 10, 1_000

# Times that runs over the grids are measured in turn; the shortest counts.
ROUNDS = 9


def scene(asperites: int, duration: float) -> tribo.Scene:
    """Two grids of half the asperites each, with random heights of up to a tenth of sigma."""
    side = round((asperites / 2) ** 0.5)
    heights = np.random.default_rng(0).uniform(-0.1, 0.1, side * side)
    grid = {
        "shape": (side, side),
        "spacing": (SPACING, SPACING),
        "asperite": tribo.Asperite(kappa=20.0),
    }
    upper = tribo.Surface("upper", bob=(0.3, 1.2), velocity=(0.5, 0.0), heights=heights, **grid)
    lower = tribo.Surface("lower", facing="up", heights=-heights[::-1], **grid)
    potential = tribo.LennardJones(0.05, 1.0).with_cutoff(2.5)
    return tribo.Scene((upper, lower), potential, duration, output=tribo.Output(samples=2))


def seconds(asperites: int, steps: int) -> float:
    """Seconds of a run: the shortest of three."""
    simulation = tribo.prepare(scene(asperites, steps * STEP), method="verlet", step=STEP)
    results = [simulation.run() for _ in range(3)]
    assert results[0].cost.steps == steps
    return min(result.cost.wall_seconds for result in results)


def building(asperites: int) -> float:
    """Seconds to build the scene and lay it out for the kernels: the shortest of three."""
    taken = []
    for _ in range(3):
        began = time.perf_counter()
        lay_out(scene(asperites, 1.0))
        taken.append(time.perf_counter() - began)
    return min(taken)


def measure(asperites: int) -> dict[str, float]:
    """Measure one size: many steps for small ones, but they slide only as far as they overlap."""
    few = int(np.clip(3e5 / asperites, 4, 200))
    more = few + int(np.clip(3e7 / asperites, 100, 600))
    short, long = seconds(asperites, few), seconds(asperites, more)
    step = (long - short) / (more - few)
    count = scene(asperites, 1.0).count
    return {
        "asperites": count,
        "steps": more - few,
        "nanoseconds": 1e9 * step / count,
        "fixed_nanoseconds": 1e9 * (short - few * step) / count,
        "build_seconds": building(asperites),
        "peak_gigabytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6,
    }


def small_over(side: int, steps: int) -> tribo.Scene:
    """A small grid in the middle of another with so many asperites along each side."""
    rng = np.random.default_rng(0)
    middle = 0.5 * SPACING * (side - SMALL)
    grid = {"spacing": (SPACING, SPACING), "asperite": tribo.Asperite(kappa=20.0)}
    upper = tribo.Surface(
        "upper",
        bob=(middle + 0.3, 1.2),
        depth=middle,
        velocity=(0.5, 0.0),
        shape=(SMALL, SMALL),
        heights=rng.uniform(-0.1, 0.1, SMALL**2),
        **grid,
    )
    heights = rng.uniform(-0.1, 0.1, side**2)
    lower = tribo.Surface("lower", facing="up", shape=(side, side), heights=heights, **grid)
    potential = tribo.LennardJones(0.05, 1.0).with_cutoff(2.5)
    return tribo.Scene((upper, lower), potential, steps * STEP, output=tribo.Output(samples=2))


def measure_inactive() -> dict[str, float]:
    """Microseconds of a step over a small and a large grid, without the first steps of a run."""
    runs = {
        (side, steps): tribo.prepare(small_over(side, steps), method="verlet", step=STEP)
        for side in (SMALL, LARGE)
        for steps in (FEW, SLIDE)
    }
    shortest = dict.fromkeys(runs, np.inf)
    for _ in range(ROUNDS):
        for key, run in runs.items():
            shortest[key] = min(shortest[key], run.run().cost.wall_seconds)
    alone, beside = (
        1e6 * (shortest[side, SLIDE] - shortest[side, FEW]) / (SLIDE - FEW)
        for side in (SMALL, LARGE)
    )
    return {"alone_microseconds": alone, "beside_microseconds": beside, "ratio": beside / alone}


def once(asperites: int) -> dict[str, float]:
    """Seconds and memory of one run of few steps, with the sums of its works."""
    began = time.perf_counter()
    simulation = tribo.prepare(scene(asperites, FEW * STEP), method="verlet", step=STEP)
    built = time.perf_counter()
    result = simulation.run(estimate=False)
    return {
        "asperites": result.scene.count,
        "build_seconds": built - began,
        "run_seconds": result.cost.wall_seconds,
        "peak_gigabytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6,
    }


def main() -> None:
    """Measure every size in one process, smallest first."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--most", type=int, default=SIZES[-1])
    parser.add_argument("--inactive", action="store_true")
    parser.add_argument("--once", type=int, metavar="ASPERITES")
    options = parser.parse_args()
    if options.once:
        print(json.dumps(once(options.once)))
        return
    if options.inactive:
        found = measure_inactive()
        print(json.dumps(found) if options.json else found)
        return
    rows = [measure(size) for size in SIZES if size <= options.most]
    if options.json:
        print(json.dumps(rows, indent=1))
        return
    for row in rows:
        ratio = row["nanoseconds"] / rows[0]["nanoseconds"]
        print(
            f"{row['asperites']:>9} asperites {row['nanoseconds']:8.1f} ns a step and asperite "
            f"({ratio:.2f} of the smallest), {row['fixed_nanoseconds']:8.0f} ns per asperite once, "
            f"built in {row['build_seconds']:.3f} s, {row['peak_gigabytes']:6.2f} GB"
        )


if __name__ == "__main__":
    main()
