"""How often the 95 % intervals of ensembles contain the exact mean: for averages.md.

    python benchmarks/intervals.py          # 2 CPU minutes

The mean is that of the internal energy of a warm surface, which starts without motion and ends in
equilibrium: half of the temperature for each degree of freedom.  Members in groups of 8 or 16 make
Student's intervals.  With a half-width, `tribo.ensemble` chooses their number by Stein's rule.
"""

import numpy as np

import tribo
from tribo.results.averages import interval

TEMPERATURE, DURATION, STEP = 0.3, 60.0, 0.05
# Groups of members, and ensembles by Stein's rule with their half-width.
GROUPS, ENSEMBLES, HALF_WIDTH = 400, 200, 0.1


def scene(asperites: int) -> tribo.Scene:
    """A warm surface without contact."""
    warm = tribo.Surface(
        "warm",
        shape=(asperites, 1),
        spacing=(5.0, 0.0),
        langevin=tribo.Langevin(1.0, TEMPERATURE),
    )
    return tribo.Scene((warm,), (), DURATION, output=tribo.Output(samples=2))


def exact(asperites: int) -> float:
    """Swings have two degrees of freedom each, velocities relative to the mean two for each."""
    return 0.5 * TEMPERATURE * (2 * asperites + 2 * (asperites - 1))


def covered(asperites: int, members: int) -> float:
    """The share of intervals of so many members that contain the mean."""
    keep = ["warm.delta_E_int"]
    data = tribo.ensemble(scene(asperites), GROUPS * members, keep=keep, step=STEP, seed=members)
    groups = data[keep[0]].values.reshape(GROUPS, members)
    found = np.array([interval(group) for group in groups])
    return float(np.mean(np.abs(found[:, 0] - exact(asperites)) < found[:, 1]))


def stein(asperites: int) -> tuple[int, int, int]:
    """How many intervals by Stein's rule contain the mean, and their fewest and most members."""
    right, members = 0, []
    for seed in range(ENSEMBLES):
        data = tribo.ensemble(
            scene(asperites), half_width={"warm.delta_E_int": HALF_WIDTH}, step=STEP, seed=seed
        )
        found = data["warm.delta_E_int_mean"][-1], data["warm.delta_E_int_half_width"][-1]
        right += bool(abs(found[0] - exact(asperites)) < found[1])
        members.append(data.sizes["member"])
    return right, min(members), max(members)


def main() -> None:
    """Print both."""
    for asperites in (1, 20):
        for members in (8, 16):
            print(f"{asperites} asperites, {members} members: {covered(asperites, members):.3f}")
    right, fewest, most = stein(20)
    print(f"Stein's rule: {right} of {ENSEMBLES}, {fewest} to {most} members")


if __name__ == "__main__":
    main()
