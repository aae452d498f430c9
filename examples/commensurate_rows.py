"""Static friction of a row of N asperites vanishes if its spacing does not fit the row below.

A commensurate row has the spacing a of the row below.  All asperites climb together, and each has
the friction F_1 of a single one.  In an incommensurate row, of spacing g a with the golden mean g,
some asperites descend while others climb.  If the row is rigid and the contact force has the single
harmonic 2 pi / a, the friction per asperite is

    F_N = F_1 |sin(pi N g) / (N sin(pi g))| ,

so that the friction of the whole row does not grow with N.

Here the row is pulled so slowly that it stays in equilibrium: every bar is tied by a spring to a
stage that moves slowly, lattice springs tie neighbours, and reservoirs damp vibrations.  The
reservoir of the upper row moves with the stage, so that it exerts no mean force.  The static
friction is the largest pull per asperite over the second of two periods.  All springs are stiff
against the contact, so that no asperite jumps, and the pull is the contact force.

M. Peyrard, S. Aubry, J. Phys. C 16 (1983) 1593; M. Hirano, K. Shinjo, Phys. Rev. B 41 (1990) 11837.
"""

from pathlib import Path

import numpy as np

from tribo import Asperite, Morse, Output, Pulled, Scene, plotting, simulate
from tribo.model.langevin import Langevin
from tribo.model.rows import GOLDEN_MEAN, commensurate_rows, incommensurate_rows
from tribo.potentials.cutoff import Switched

# Numbers of asperites.
SIZES = (1, 2, 4, 8, 16, 32, 64, 128, 256, 512)

# Contact between bobs; the corrugation of its force has a stiffness of 0.2 [force / length].
CONTACT = Switched(Morse(D=0.1, alpha=3.0, r0=1.0), cutoff=3.0, switch_from=2.5)

# Stiffness of the springs to the stage [force / length].
STIFF = 20.0

# Speed of the stage [length / time].
SPEED = 0.04

# Samples in each of the two periods.
SAMPLES = 200

BLUE, RED = plotting.WORKS["w1"][1], plotting.WORKS["w2"][1]


def rows(n, spacing):
    """A row of n asperites with a spacing over a row of spacing 1 that extends beyond it."""
    each = {
        "asperite": Asperite(m1=1.0, m2=1.0, length=10.0, kappa=1000.0 * STIFF),
        "langevin": Langevin(gamma=5.0),  # moves with the initial velocity of the surface
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
    """Largest pull per asperite in the second period [force]."""
    output = Output(samples=2 * SAMPLES + 1)
    scene = Scene(rows(n, spacing), CONTACT, duration=2.0 / SPEED, output=output)
    result = simulate(scene, method="verlet", step=0.04)
    bars = result["upper"].x_bar
    pull = STIFF * (bars[0] + SPEED * result.t[:, None] - bars)
    return pull.mean(axis=1)[SAMPLES:].max()


def rigid(n):
    """F_N / F_1 of a rigid row with the golden mean."""
    return np.abs(np.sin(np.pi * n * GOLDEN_MEAN) / (n * np.sin(np.pi * GOLDEN_MEAN)))


def draw(path, commensurate, incommensurate):
    """Friction per asperite against N, log-log."""
    with plotting.style():
        ax = plotting.axes(plotting.COLUMN, 2.6)
        n = np.arange(1, 701)
        ax.plot(n, commensurate[0] * rigid(n), ".", ms=1.8, mew=0.0, color=RED, zorder=1)
        ax.plot(SIZES, commensurate, "o", ms=4, color=BLUE, clip_on=False)
        ax.plot(SIZES, incommensurate, "s", ms=4, color=RED)
        ax.axhline(commensurate[0], color=BLUE, lw=0.5, zorder=0)
        ax.set(xscale="log", yscale="log", xlim=(0.8, 700.0), ylim=(1e-5, 0.1))
        ax.set(xlabel="asperites $N$", ylabel="static friction per asperite")
        plotting.note(ax, (30.0, commensurate[0]), "commensurate", (0.0, 7.0), color=BLUE)
        plotting.note(ax, (1.0, 1.3e-4), "golden mean;\npoints: rigid rows", ha="left", color=RED)
    plotting.save(ax, path)


def main(folder=None):
    """Compute the friction per asperite of 1 to 512, and compare it with that of rigid rows."""
    spacings = (1.0, GOLDEN_MEAN)
    commensurate, incommensurate = (np.array([friction(n, s) for n in SIZES]) for s in spacings)
    theory = commensurate[0] * rigid(np.array(SIZES))
    print("   N   commensurate   golden mean    rigid row")
    for row in zip(SIZES, commensurate, incommensurate, theory, strict=True):
        print("{:4d}   {:12.6f}   {:11.6f}   {:10.6f}".format(*row))
    if folder is not None:
        draw(Path(folder) / "commensurate_rows.png", commensurate, incommensurate)
    return {
        "friction of one asperite": commensurate[0],
        "commensurate, per asperite of 512": commensurate[-1],
        "golden mean, per asperite of 512": incommensurate[-1],
        "golden mean, whole row of 512": SIZES[-1] * incommensurate[-1],
        "largest difference from a rigid row": np.max(SIZES * np.abs(incommensurate - theory)),
    }


if __name__ == "__main__":
    for name, value in main(".").items():
        print(f"{name:44} {value:.6g}")
