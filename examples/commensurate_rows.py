"""Static friction of a row of N asperites that fits the row below, and of one that does not.

A stiff row is pulled over a longer one of spacing a, so slowly that it is at rest all the time:
every bar hangs on a spring to a stage that creeps along, neighbours are tied by lattice springs,
and reservoirs damp what vibrates; the upper one moves with the stage, so that it does not drag.
The static friction is the largest pull per asperite on the way over one period, after another
period in which the row settles.  All springs are stiff against the contact, so that nothing jumps
and the pull is the contact force itself.

Asperites a apart climb together, and each has the friction of one alone, F_1.  Where they are
g a apart, g the golden mean, one descends as another climbs, and a rigid row is left with

    F_N = F_1 |sin(pi N g) / (N sin(pi g))|

of a contact force with the single harmonic 2 pi / a: the sum over the row does not grow with N.

M. Peyrard, S. Aubry, J. Phys. C 16 (1983) 1593; M. Hirano, K. Shinjo, Phys. Rev. B 41 (1990) 11837.
"""

from pathlib import Path

import numpy as np

from tribo import Asperite, Morse, Output, Pulled, Scene, plotting, simulate
from tribo.model.bath import Langevin
from tribo.model.rows import GOLDEN_MEAN, commensurate_rows, incommensurate_rows
from tribo.potentials.cutoff import Switched

SIZES = (1, 2, 4, 8, 16, 32, 64, 128, 256, 512)
CONTACT = Switched(Morse(D=0.1, alpha=3.0, r0=1.0), cutoff=3.0, switch_from=2.5)
STIFF = 20.0  # springs; the contact has 0.2 [force / length]
SPEED, SAMPLES = 0.04, 200  # of the stage, and in each of the two periods
BLUE, RED = plotting.WORKS["w1"][1], plotting.WORKS["w2"][1]


def rows(n, spacing):
    """n asperites, `spacing` apart, over a row of spacing 1 that nowhere ends within reach."""
    each = {
        "asperite": Asperite(m1=1.0, m2=1.0, length=10.0, kappa=1000.0 * STIFF),
        "langevin": Langevin(gamma=5.0),  # with the surface's own velocity
    }
    upper = each | {
        "bob": (4.0, 1.0),
        "velocity": (SPEED, 0.0),
        "drive": Pulled(stiffness=STIFF, speed=SPEED),
        "springs": {"stiffness": 4.0 * STIFF},
    }
    settings = {"slide": 9.0, "upper": upper, "lower": each}
    if spacing == 1.0:
        return commensurate_rows(n, **settings)
    return incommensurate_rows(n, spacing, ratio=spacing, **settings)


def friction(n, spacing):
    """Largest pull per asperite in the second period."""
    output = Output(samples=2 * SAMPLES + 1)
    scene = Scene(rows(n, spacing), CONTACT, duration=2.0 / SPEED, output=output)
    result = simulate(scene, method="verlet", step=0.04)
    bars = result["upper"].x_bar
    pull = STIFF * (bars[0] + SPEED * result.t[:, None] - bars)
    return pull.mean(axis=1)[SAMPLES:].max()


def rigid(n):
    """F_N / F_1 of a rigid row, golden mean."""
    return np.abs(np.sin(np.pi * n * GOLDEN_MEAN) / (n * np.sin(np.pi * GOLDEN_MEAN)))


def draw(path, fits, does_not):
    """Friction per asperite against N, log-log."""
    with plotting.style():
        ax = plotting.axes(plotting.COLUMN, 2.6)
        n = np.arange(1, 701)
        ax.plot(n, fits[0] * rigid(n), ".", ms=1.8, mew=0.0, color=RED, zorder=1)
        ax.plot(SIZES, fits, "o", ms=4, color=BLUE, clip_on=False)
        ax.plot(SIZES, does_not, "s", ms=4, color=RED)
        ax.axhline(fits[0], color=BLUE, lw=0.5, zorder=0)
        ax.set(xscale="log", yscale="log", xlim=(0.8, 700.0), ylim=(1e-5, 0.1))
        ax.set(xlabel="asperites $N$", ylabel="static friction per asperite")
        plotting.note(ax, (30.0, fits[0]), "commensurate", (0.0, 7.0), color=BLUE)
        plotting.note(ax, (1.0, 1.3e-4), "golden mean;\npoints: rigid rows", ha="left", color=RED)
        ax.get_figure().savefig(path)


def main(folder=None):
    """How friction per asperite falls from one to 512, and how far it is from a rigid row's."""
    fits, does_not = (np.array([friction(n, s) for n in SIZES]) for s in (1.0, GOLDEN_MEAN))
    theory = fits[0] * rigid(np.array(SIZES))
    print("   N   commensurate   golden mean    rigid row")
    for row in zip(SIZES, fits, does_not, theory, strict=True):
        print("{:4d}   {:12.6f}   {:11.6f}   {:10.6f}".format(*row))
    if folder is not None:
        draw(Path(folder) / "commensurate_rows.png", fits, does_not)
    return {
        "friction of one asperite": fits[0],
        "commensurate, of each of 512": fits[-1],
        "golden mean, of each of 512": does_not[-1],
        "the same, all 512 together": SIZES[-1] * does_not[-1],
        "largest distance from the rigid row's sum": np.max(SIZES * np.abs(does_not - theory)),
    }


if __name__ == "__main__":
    for name, value in main(".").items():
        print(f"{name:44} {value:.6g}")
