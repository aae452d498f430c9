"""The work of dragging one rough surface over another becomes heat.

Two surfaces of asperites with self-affine heights repel each other where their bobs meet.  Lattice
springs connect the bars of neighbours.  On every bar a reservoir at T = 0, which moves with its
surface, damps vibrations.  The drives and the moving reservoirs do work, integrated along the run.
This work equals the change of the kinetic, internal and contact energies plus the heat given to the
reservoirs.

B. N. J. Persson et al., J. Phys.: Condens. Matter 17 (2005) R1.
"""

import numpy as np
from matplotlib.figure import Figure

import tribo

REPULSION = tribo.WeeksChandlerAndersen(epsilon=0.05, sigma=1.0)
SPEED, TRAVEL = 0.3, 24.0  # of the upper surface [length / time], [length]


def surface(name, n, seed, **settings):
    """A row of n asperites with heights drawn from a seed."""
    return tribo.Surface(
        name,
        shape=(n, 1),
        spacing=(1.5, 0.0),
        heights=tribo.Roughness(rms=0.35, hurst=0.8, seed=seed),
        asperite=tribo.Asperite(kappa=4.0, length=2.0, bar_length=1.2),
        springs={"stiffness": 5.0},
        langevin=tribo.Langevin(gamma=2.0),
        **settings,
    )


def main(folder="."):
    """Heat, and the largest gap of the balance, relative to the work at the end."""
    upper = surface("upper", 14, 10, bob=(0.75, 1.6), velocity=(SPEED, 0.0))
    lower = surface("lower", 32, 11, facing="up", bob=(-1.5, 0.0))
    scene = tribo.Scene((upper, lower), REPULSION, TRAVEL / SPEED)
    result = tribo.simulate(scene, accuracy=1e-5)
    both, contact = (result["upper"], result["lower"]), result.system["contact_energy"]
    work = sum((s.w2 + s.wL + s.wR + s.w_T + s.heat).sum(axis=1) for s in both)
    heat = sum(s.heat.sum(axis=1) for s in both)
    parts = (contact - contact[0], sum(s.delta_K + s.delta_E_int for s in both), heat)
    with tribo.plotting.style():
        figure = Figure(figsize=(tribo.plotting.PAGE, 4.2), layout="constrained")
        above, below = figure.subplots(2, height_ratios=(1.0, 1.4))
        result.plot.snapshots([0.5 * result.t[-1]], ax=above)
        above.set(xlim=(10.0, 35.0), xlabel="$x$", ylabel="$y$")
        below.stackplot(result.t, *parts, labels=("contact", "surfaces", "heat in the reservoirs"))
        below.plot(result.t, work, color=tribo.plotting.INK, label="work of drives and reservoirs")
        below.set(xlabel="$t$", ylabel="energy", xlim=(0.0, result.t[-1]), ylim=(0.0, None))
        below.legend(loc="upper left", reverse=True)
    tribo.plotting.save(figure, f"{folder}/rough_surface.png")
    gap = np.abs(work - sum(parts)).max() / work[-1]
    return {"heat / work": heat[-1] / work[-1], "largest gap / work": gap}


if __name__ == "__main__":
    print(main())
