"""Time and memory against the number of asperites, at fixed density: flat is linear.

Two square grids of Lennard-Jones bobs with a cutoff slide over one another by Verlet.  Prints the
nanoseconds per asperite and step, their ratio to the smallest size, and the peak memory.

    python benchmarks/scale.py [--json] [--most 1000000]
"""

import argparse
import json
import resource

import numpy as np

import tribo

SIZES = (1_000, 10_000, 100_000, 1_000_000)
STEP = 0.01


def scene(asperites: int, duration: float) -> tribo.Scene:
    """Two grids of half the asperites each, rough by a tenth of the potential's length."""
    side = round((asperites / 2) ** 0.5)
    heights = np.random.default_rng(0).uniform(-0.1, 0.1, side * side)
    grid = {"shape": (side, side), "spacing": (1.5, 1.5), "asperite": tribo.Asperite(kappa=20.0)}
    upper = tribo.Surface("upper", bob=(0.3, 1.2), velocity=(0.5, 0.0), heights=heights, **grid)
    lower = tribo.Surface("lower", facing="up", heights=-heights[::-1], **grid)
    potential = tribo.with_cutoff(tribo.LennardJones(0.05, 1.0), 2.5)
    return tribo.Scene((upper, lower), potential, duration, output=tribo.Output(samples=2))


def measure(asperites: int) -> dict[str, float]:
    """One size; small ones take more steps, so that each is timed over a second or so."""
    steps = int(np.clip(3e6 / asperites, 20, 2000))
    simulation = tribo.prepare(scene(asperites, steps * STEP), method="verlet", step=STEP)
    result = min((simulation.run() for _ in range(3)), key=lambda r: r.cost.wall_seconds)
    count = result.scene.count
    return {
        "asperites": count,
        "steps": result.cost.steps,
        "nanoseconds": 1e9 * result.cost.wall_seconds / result.cost.steps / count,
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
            f"{row['asperites']:>9} asperites {row['steps']:>6} steps "
            f"{row['nanoseconds']:8.1f} ns each ({ratio:.2f} of the smallest) "
            f"{row['peak_gigabytes']:6.2f} GB"
        )


if __name__ == "__main__":
    main()
