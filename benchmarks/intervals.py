"""How often the 95 % intervals of ensembles contain the exact mean: for averages.md.

    python benchmarks/intervals.py          # seconds

The mean is that of the internal energy of a warm surface without contact.  In equilibrium this
energy is half of the temperature times a sum of squares of independent normal numbers, one for each
degree of freedom: two of each swing, and two of each velocity relative to the mean.  It is drawn
from this distribution.  Members in groups of 8 or 16 make Student's intervals; by Stein's rule the
first 16 of a group determine how many more are drawn.
"""

import numpy as np

from tribo.results.averages import interval, members_needed

# Groups of members; half-widths of Stein's intervals, relative to the mean.
GROUPS, HALF_WIDTHS, FIRST = 20_000, (0.02, 0.05), 16


def energies(rng: np.random.Generator, asperites: int, *shape: int) -> np.ndarray:
    """Energies of surfaces with so many asperites, relative to their mean."""
    degrees = 2 * asperites + 2 * (asperites - 1)
    return rng.chisquare(degrees, shape) / degrees


def student(rng: np.random.Generator, asperites: int, members: int) -> float:
    """The share of intervals of so many members that contain the mean."""
    found = interval(energies(rng, asperites, members, GROUPS))
    return float(np.mean(np.abs(found.mean - 1.0) < found.half_width))


def stein(rng: np.random.Generator, asperites: int, wanted: float) -> tuple[float, int, int]:
    """The share of intervals by Stein's rule, and the fewest and most members of a group."""
    right, members = 0, []
    for _ in range(GROUPS):
        first = energies(rng, asperites, FIRST)
        count = int(members_needed(first, wanted))
        values = np.append(first, energies(rng, asperites, count - FIRST))
        found = interval(values, first_stage=FIRST)
        right += bool(abs(found.mean - 1.0) < found.half_width)
        members.append(count)
    return right / GROUPS, min(members), max(members)


def main() -> None:
    """Print both."""
    rng = np.random.default_rng(1)
    for asperites in (1, 20):
        for members in (8, 16):
            share = student(rng, asperites, members)
            print(f"{asperites} asperites, {members} members: {share:.3f}")
    for wanted in HALF_WIDTHS:
        share, fewest, most = stein(rng, 20, wanted)
        print(f"20 asperites, Stein's rule for {wanted:g}: {share:.3f}, {fewest} to {most} members")


if __name__ == "__main__":
    main()
