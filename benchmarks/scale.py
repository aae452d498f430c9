"""Measure time and memory against the number of asperites, at fixed density.

Two square grids of Lennard-Jones bobs with a cutoff slide over one another by Verlet.  Each size is
run for few and for more steps.  The difference gives the time of a step; the rest (layout, first
neighbour list, two samples) is reported apart.  It prints nanoseconds per asperite and step, their
ratio to those of the smallest size, the seconds that building and laying out the scene take, and
the peak memory.  A constant ratio means that the time is linear in the number of asperites.

    python benchmarks/scale.py [--json] [--most 1000000]
"""

import argparse
import json
import resource
import time

import numpy as np

import tribo
from tribo.run.layout import lay_out

# Numbers of asperites.
SIZES = (1_000, 10_000, 100_000, 1_000_000)

# Step of Verlet [time].
STEP = 0.01


def scene(asperites: int, duration: float) -> tribo.Scene:
    """Two grids of half the asperites each, with random heights of up to a tenth of sigma."""
    side = round((asperites / 2) ** 0.5)
    heights = np.random.default_rng(0).uniform(-0.1, 0.1, side * side)
    grid = {"shape": (side, side), "spacing": (1.5, 1.5), "asperite": tribo.Asperite(kappa=20.0)}
    upper = tribo.Surface("upper", bob=(0.3, 1.2), velocity=(0.5, 0.0), heights=heights, **grid)
    lower = tribo.Surface("lower", facing="up", heights=-heights[::-1], **grid)
    potential = tribo.with_cutoff(tribo.LennardJones(0.05, 1.0), 2.5)
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
    """Measure one size; small ones take more steps, so that each run takes about a second."""
    few = int(np.clip(3e5 / asperites, 4, 200))
    more = few + int(np.clip(3e6 / asperites, 24, 2000))
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


def main() -> None:
    """Measure every size in one process, smallest first."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--most", type=int, default=SIZES[-1])
    options = parser.parse_args()
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
