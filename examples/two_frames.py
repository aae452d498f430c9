"""The work of friction depends on the observer; the internal energy does not.

An observer who moves with the velocity -u adds u to all velocities.  The work and the pseudowork of
each force both grow by u times its impulse.  Their difference, summed over all forces on an
asperite, is the change of its internal energy, and all observers agree on it.  The paper prints
0.520 for its case A.

J. D. Brown, Work Done by Sliding Friction, section on forced sliding.
"""

from dataclasses import replace

import numpy as np

import tribo
from tribo import paper

# Velocities u that are added to all velocities of case A.
VELOCITIES = np.linspace(-1.0, 1.0, 9)


def works(velocity):
    """Work and pseudowork of the contact on the upper asperite; its internal energy."""
    case = paper.scene("A")
    surfaces = [replace(s, velocity=np.add(s.velocity, (velocity, 0.0))) for s in case.surfaces]
    upper = tribo.simulate(replace(case, surfaces=tuple(surfaces)))["upper"]
    return upper.w1[-1, 0], upper.w1_ps[-1, 0], upper.w[-1, 0] - upper.w_ps[-1, 0]


def main(folder="."):
    """Internal energy, and the ranges over observers of it and of the work of the contact."""
    work, pseudowork, internal = np.transpose([works(u) for u in VELOCITIES])
    with tribo.plotting.style():
        ax = tribo.plotting.axes(tribo.plotting.COLUMN, 2.4)
        ax.plot(VELOCITIES, work, "o-", ms=3, color="#0b62a4", label="work of the contact")
        ax.plot(VELOCITIES, pseudowork, "s--", ms=3, color="#1f8a70", label="its pseudowork")
        ax.plot(VELOCITIES, internal, "^-", ms=3, color="#d55e00", label="internal energy")
        ax.set(xlabel="velocity $u$ of all surfaces", ylabel="energy")
        ax.legend()
    tribo.plotting.save(ax, f"{folder}/two_frames.png")
    return {
        "internal energy": internal[0],
        "its range over observers": np.ptp(internal),
        "range of the work of the contact": np.ptp(work),
    }


if __name__ == "__main__":
    print(main())
