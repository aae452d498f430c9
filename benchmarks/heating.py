"""How long the swings of a row take to reach the temperature of its reservoir: for many.md.

    python benchmarks/heating.py            # 2 CPU minutes

The row is that of docs/how-to/many.md, at rest and without a pull.  It starts from its equilibrium,
without motion.  The kinetic temperature of the swings is averaged over runs, asperites, and times
within a factor of 1.25 of each other.  The program prints it at 50, and the time from which it is
above 0.9 T.
"""

from dataclasses import replace

import numpy as np

import tribo

TEMPERATURE = 0.05
# Runs of a row; their end [time]; times within this ratio are averaged.
RUNS, END, RATIO = 32, 4000.0, 1.25
SAMPLES = 4001

# What the reservoir acts on, the stiffness of the lattice springs, the corrugation.
ROWS = (
    ("swing", 0.0, 0.2),
    ("bar", 0.0, 0.2),
    ("bar", 5.0, 0.2),
    ("bar", 100.0, 0.2),
    ("bar", 20.0, 0.0),
)


def scene(on: str, stiffness: float, corrugation: float) -> tribo.Scene:
    """A row of eight on springs to a stage at rest, with a reservoir on its swings or its bars."""
    row = tribo.Surface(
        "row",
        shape=(8, 1),
        spacing=(1.1, 0.0),
        drive=tribo.Pulled(stiffness=1.0, speed=0.0),
        springs=tribo.Springs(stiffness) if stiffness else None,
        langevin=tribo.Langevin(gamma=0.5, temperature=TEMPERATURE, on=on),
    )
    fields = [tribo.Field(tribo.Corrugation(corrugation, 1.0), on=["row"])] if corrugation else []
    output = tribo.Output(samples=SAMPLES, keep=["row.omega"])
    return tribo.Scene([row], [], END, fields=fields, output=output)


def temperatures(on: str, stiffness: float, corrugation: float) -> tuple[np.ndarray, np.ndarray]:
    """The ends of bins of time, and the kinetic temperature of the swings in each, over T."""
    cold = scene(on, stiffness, corrugation)
    start, squares = tribo.relax(cold), np.zeros(SAMPLES)
    for seed in range(RUNS):
        run = tribo.simulate(replace(cold, seed=seed), method="verlet", start=start)
        squares += (run["row"].omega ** 2).mean(axis=1) / RUNS
    energy, times = tribo.Asperite().for_each(1)["inertia"] * squares, run.t
    edges = 5.0 * RATIO ** np.arange(int(np.log(END / 5.0) / np.log(RATIO)) + 1)
    inside = np.digitize(times, edges)
    means = np.array([energy[inside == k].mean() for k in range(1, edges.size)])
    return edges, means / TEMPERATURE


def main() -> None:
    """Print the times of all rows."""
    for on, stiffness, corrugation in ROWS:
        edges, found = temperatures(on, stiffness, corrugation)
        below = np.flatnonzero(found < 0.9)
        reached = edges[below[-1] + 1] if below.size else edges[0]
        early = found[np.searchsorted(edges, 50.0) - 1]
        print(
            f"reservoir on the {on}, springs {stiffness:g}, corrugation {corrugation:g}: "
            f"0.9 T from {reached:.0f} on, {early:.2f} T at 50, {found[-1]:.2f} T at the end",
            flush=True,
        )


if __name__ == "__main__":
    main()
