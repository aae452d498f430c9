"""Where the work goes when one rough surface is dragged over another.

Two surfaces of asperites with self-affine heights, their bars tied to neighbours by lattice
springs, repel where their tips meet.  The upper one is dragged at constant speed.  On every bar
a reservoir at T = 0 damps what vibrates; it travels with its surface.

The budget: the work that the drive puts in (with what moves the reservoirs along) is kinetic and
internal energy of the surfaces, or energy of the contact, or heat that has left.  The one side is
booked as the forces work; the other is read off where everything is, and has gone.

B. N. J. Persson et al., J. Phys.: Condens. Matter 17 (2005) R1.
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from tribo import Asperite, LennardJones, Output, Scene, Surface, plotting, simulate
from tribo.model.bath import Langevin
from tribo.model.roughness import Roughness
from tribo.potentials.cutoff import Shifted

REPULSION = Shifted(LennardJones(epsilon=0.05, sigma=1.0), cutoff=2.0 ** (1.0 / 6.0))
SPEED, TRAVEL = 0.3, 24.0
COLOURS = ("#117a5d", "#7fadd0", "#eaa879")  # of the contact, of the surfaces, of heat


def surface(name, n, **settings):
    """A row of n asperites."""
    return Surface(
        name,
        shape=(n, 1),
        spacing=(1.5, 0.0),
        asperite=Asperite(kappa=4.0, length=2.0, bar_length=1.2),
        springs={"stiffness": 5.0},
        langevin=Langevin(gamma=2.0),
        **settings,
    )


def scene():
    """Fourteen asperites over 32."""
    upper, lower = (Roughness(rms=0.35, hurst=0.8, seed=seed) for seed in (10, 11))
    surfaces = (
        surface("upper", 14, facing="down", bob=(0.75, 1.6), velocity=(SPEED, 0.0), heights=upper),
        surface("lower", 32, facing="up", bob=(-1.5, 0.0), heights=lower),
    )
    return Scene(surfaces, REPULSION, TRAVEL / SPEED, output=Output(samples=1201))


def budget(result):
    """Work put in over time, and where it went, layer by layer."""
    both = [result[s.name] for s in result.scene.surfaces]
    contact = result.system["contact_energy"]
    went = {
        "contact energy": contact - contact[0],
        "kinetic and internal energy": sum(s.delta_K + s.delta_E_int for s in both),
        "heat": sum(s.heat.sum(axis=1) for s in both),
    }
    # The reservoirs' forces do the work w_T: what moves them along puts in w_T + heat.
    put_in = sum((s.w2 + s.wL + s.wR + s.w_T + s.heat).sum(axis=1) for s in both)
    return put_in, went


def draw(path, result, work, went):
    """The surfaces half-way, and the budget over time."""
    with plotting.style():
        figure = Figure(figsize=(6.9, 4.0), layout="constrained")
        above, below = figure.subplots(2, height_ratios=(1.0, 1.7))
        plotting.snapshot(above, result, 0.5 * result.t[-1])
        above.set_axis_off()
        below.stackplot(result.t, *went.values(), colors=COLOURS, labels=went)
        below.plot(result.t, work, color=plotting.INK, label="work put in")
        below.set(xlabel="$t$", ylabel="energy", xlim=(0.0, result.t[-1]), ylim=(0.0, None))
        below.legend(loc="upper left", frameon=False, reverse=True)
        figure.savefig(path)


def main(folder=None):
    """The budget at the end, how well it closes, and the friction that it means.

    That a ledger closes says that nothing is forgotten, not that the run is exact; how far the
    work may be off is the run's own estimate.
    """
    result = simulate(scene(), accuracy=1e-6)
    work, went = budget(result)
    if folder is not None:
        draw(Path(folder) / "rough_surface.png", result, work, went)
    gap = np.abs(work - sum(went.values())).max() / work[-1]
    return {
        "work put in": work[-1],
        **{layer: values[-1] for layer, values in went.items()},
        "friction: work / way": work[-1] / TRAVEL,
        "largest gap in the budget / work": gap,
        "estimated error of the work / work": result.error_estimate["applied_work"] / work[-1],
    }


if __name__ == "__main__":
    for name, value in main(".").items():
        print(f"{name:40} {value:.6g}")
