"""Static friction of a row of N asperites that fits the row below, and of one that does not.

A stiff row is pulled over a longer one of spacing a, so slowly that it is at rest all the time:
every bar hangs on a spring to a stage that creeps along, neighbours are tied by lattice springs,
and a reservoir that moves with the stage damps what vibrates without dragging on the row.  The
static friction is the largest pull per asperite on the way over one period, when a first period
has settled the row.  All springs are stiff against the contact, so nothing jumps and the pull is
the contact force itself.

Upper asperites a apart climb together, and each has the friction of one alone, F_1.  Where they
are (golden mean) a apart, one climbs as another descends: the harmonic of the contact force with
period a leaves a rigid row

    F_N = F_1 |sin(pi N g)| / (N sin(pi g)) ,    g = golden mean,

so that the sum over the row does not grow with N.

M. Peyrard, S. Aubry, J. Phys. C 16 (1983) 1593; M. Hirano, K. Shinjo, Phys. Rev. B 41 (1990) 11837.
"""

from pathlib import Path

import numpy as np

from tribo import Asperite, Morse, Output, Pulled, Scene, plotting, simulate
from tribo.langevin import Langevin
from tribo.potentials.cutoff import Switched
from tribo.rows import GOLDEN_MEAN, commensurate_rows, incommensurate_rows

SIZES = (1, 8, 16, 32, 64, 128, 256, 512)
CONTACT = Switched(Morse(D=0.1, alpha=2.0, r0=1.0), cutoff=2.5, switch_from=2.0)
STIFF = 10.0  # springs, where the contact has 0.2 [force / length]
SPEED, SAMPLES = 0.02, 200  # of the stage, and in each of two periods


def rows(n, ratio):
    """The lower row has spacing 1, the upper one's n asperites are `ratio` apart."""
    asperite = Asperite(m1=1.0, m2=1.0, length=10.0, kappa=100.0 * STIFF)
    upper = {
        "bob": (3.0, 1.0),  # no end of the lower row within reach
        "velocity": (SPEED, 0.0),
        "asperite": asperite,
        "drive": Pulled(stiffness=STIFF, speed=SPEED),
        "springs": {"stiffness": 4.0 * STIFF},
        "langevin": Langevin(gamma=5.0),
    }
    settings = {"slide": 8.0, "upper": upper, "lower": {"asperite": asperite, "langevin": Langevin(gamma=5.0)}}
    if ratio == 1.0:
        return commensurate_rows(n, **settings)
    return incommensurate_rows(n, ratio, ratio, **settings)


def friction(n, ratio):
    """Largest pull per asperite in the second period."""
    upper, lower = rows(n, ratio)
    output = Output(samples=2 * SAMPLES + 1)
    result = simulate(
        Scene([upper, lower], CONTACT, 2.0 / SPEED, output=output), method="verlet", step=0.04
    )
    bars = result["upper"].x_bar
    reach = bars[0] + SPEED * result.t[:, None] - bars
    return STIFF * np.mean(reach[SAMPLES:], axis=1).max()


def rigid(n):
    """F_N / F_1 of a rigid row, golden mean."""
    return np.abs(np.sin(np.pi * n * GOLDEN_MEAN) / (n * np.sin(np.pi * GOLDEN_MEAN)))


def draw(path, fits, does_not):
    """Friction per asperite against N, log-log."""
    with plotting.style():
        ax = plotting.axes(plotting.COLUMN, 2.7)
        n = np.arange(1, 600)
        ax.plot(n, fits[0] * rigid(n), color="#d55e00", lw=0.3, alpha=0.6)
        ax.plot(SIZES, fits, "o-", ms=4, lw=0.7, color="#0b62a4")
        ax.plot(SIZES, does_not, "s", ms=4, color="#d55e00")
        ax.set(xscale="log", yscale="log", xlim=(0.8, 700), ylim=(1e-5, 0.1))
        ax.set(xlabel="asperites $N$", ylabel="static friction per asperite")
        ax.get_figure().savefig(path)


def main(folder=None):
    """Friction per asperite of the shortest and the longest row, and how it differs from a rigid one."""
    fits, does_not = (np.array([friction(n, r) for n in SIZES]) for r in (1.0, GOLDEN_MEAN))
    if folder is not None:
        draw(Path(folder) / "commensurate_rows.png", fits, does_not)
    print("   N   commensurate  incommensurate  (a rigid row)")
    for n, one, other in zip(SIZES, fits, does_not, strict=True):
        print(f"{n:4d} {one:14.6f} {other:15.6f} {fits[0] * rigid(n):14.6f}")
    return {"x": 0}


if __name__ == "__main__":
    for name, value in main(".").items():
        print(f"{name:40} {value:.6g}")
