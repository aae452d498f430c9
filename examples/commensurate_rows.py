"""Static friction per asperite vanishes in a long row that does not fit the row below.

If the rows fit, all asperites climb together, and each adds the friction F_1 of a single one.  If
the ratio of the spacings is the golden mean g, some descend while others climb.  The friction per
asperite of a rigid row is then F_1 |sin(pi N g) / (N sin(pi g))|.  Here stiff springs pull the row
slowly.

M. Hirano, K. Shinjo, Phys. Rev. B 41 (1990) 11837.
"""

import numpy as np

import tribo
from tribo.model.rows import GOLDEN_MEAN, incommensurate_rows

SIZES = np.array([1, 2, 4, 8, 16, 32, 64, 128, 256])
CONTACT = tribo.Morse(D=0.1, alpha=3.0, r0=1.0).with_cutoff(cutoff=3.0, switch_from=2.5)
# Stiffness of the springs to the stage [force / length], and its speed [length / time].
STIFF, SPEED = 20.0, 0.04


def rows(n, spacing):
    """A row of n asperites over a row of spacing 1 that extends beyond it."""
    asperite = tribo.Asperite(m1=1.0, m2=1.0, length=10.0, kappa=1000.0 * STIFF)
    each = {"asperite": asperite, "langevin": tribo.Langevin(gamma=5.0)}
    drive, springs = tribo.Pulled(stiffness=STIFF, speed=SPEED), {"stiffness": 4.0 * STIFF}
    upper = each | {"bob": (4.0, 1.0), "velocity": (SPEED, 0.0), "drive": drive, "springs": springs}
    return incommensurate_rows(n, spacing, spacing, slide=9.0, upper=upper, lower=each)


def friction(n, spacing):
    """Largest pull per asperite in the second of two periods [force]."""
    scene = tribo.Scene(rows(n, spacing), CONTACT, 2.0 / SPEED, output=tribo.Output(samples=401))
    result = tribo.simulate(scene, method="verlet", step=0.04)
    bars = result["upper"].x_bar.mean(axis=1)
    return np.max(STIFF * (bars[0] + SPEED * result.t - bars)[len(bars) // 2 :])


def rigid(n):
    """F_N / F_1 of a rigid row with the golden mean."""
    return np.abs(np.sin(np.pi * n * GOLDEN_MEAN) / (n * np.sin(np.pi * GOLDEN_MEAN)))


def main(folder="."):
    """Friction per asperite of a row that fits, and of a whole row that does not, over F_1."""
    fits, misfits = (np.array([friction(n, s) for n in SIZES]) for s in (1.0, GOLDEN_MEAN))
    with tribo.plotting.style():
        ax, n = tribo.plotting.axes(tribo.plotting.COLUMN, 2.6), np.arange(1, 257)
        most = fits[0] / (n * np.abs(np.sin(np.pi * GOLDEN_MEAN)))
        low = [np.min(fits[0] * rigid(n[: k + 1])) for k in range(n.size)]
        ax.fill_between(n, low, most, color="#d55e00", alpha=0.2, lw=0.0)
        ax.loglog(SIZES, fits[0] * rigid(SIZES), color="#d55e00", lw=0.8)
        ax.axhline(fits[0], color="#0b62a4", lw=0.8)
        ax.loglog(SIZES, fits, "o", ms=4, color="#0b62a4", label="fits")
        ax.loglog(SIZES, misfits, "s", ms=4, color="#d55e00", label="does not fit")
        ax.set(xlabel="asperites $N$", ylabel="static friction per asperite")
        ax.legend(loc="lower left")
    tribo.plotting.save(ax, f"{folder}/commensurate_rows.png")
    ratios = np.array([fits[-1], SIZES[-1] * misfits[-1]]) / fits[0]
    return dict(zip(("F_N / F_1 of 256 that fit", "N F_N / F_1 of 256"), ratios, strict=True))


if __name__ == "__main__":
    print(main())
