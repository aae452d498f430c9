"""The work of dragging one rough surface over another becomes heat.

Two surfaces of asperites with self-affine heights repel each other where their bobs meet.  Lattice
springs tie the bars of neighbours, and the upper surface is dragged at constant speed.  On every
bar a reservoir at T = 0, which moves with its surface, damps vibrations.

The energy balance has two sides that are computed independently: the work of the drive and of the
moving reservoirs, integrated along the run; and the kinetic and internal energy of the surfaces,
the contact energy, and the heat given to the reservoirs.

B. N. J. Persson et al., J. Phys.: Condens. Matter 17 (2005) R1.
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from tribo import Asperite, LennardJones, Output, Scene, Surface, plotting, simulate
from tribo.model.langevin import Langevin
from tribo.model.roughness import Roughness
from tribo.potentials.cutoff import Shifted

REPULSION = Shifted(LennardJones(epsilon=0.05, sigma=1.0), cutoff=2.0 ** (1.0 / 6.0))
# Speed of the upper surface [length / time], and the distance that it travels [length].
SPEED, TRAVEL = 0.3, 24.0

# Colours of contact energy, energy of the surfaces, and heat.
COLOURS = ("#117a5d", "#7fadd0", "#eaa879")


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
    """A surface of 14 asperites over one of 32."""
    upper, lower = (Roughness(rms=0.35, hurst=0.8, seed=seed) for seed in (10, 11))
    surfaces = (
        surface("upper", 14, facing="down", bob=(0.75, 1.6), velocity=(SPEED, 0.0), heights=upper),
        surface("lower", 32, facing="up", bob=(-1.5, 0.0), heights=lower),
    )
    return Scene(surfaces, REPULSION, TRAVEL / SPEED, output=Output(samples=1201))


def balance(result):
    """Work over time, and the energies and the heat that it became, by name [energy]."""
    both = [result[s.name] for s in result.scene.surfaces]
    contact = result.system["contact_energy"]
    parts = {
        "contact energy": contact - contact[0],
        "kinetic and internal energy": sum(s.delta_K + s.delta_E_int for s in both),
        "heat": sum(s.heat.sum(axis=1) for s in both),
    }
    # The reservoirs do the work w_T, and keeping them in motion takes w_T + heat.
    work = sum((s.w2 + s.wL + s.wR + s.w_T + s.heat).sum(axis=1) for s in both)
    return work, parts


def draw(path, result, work, parts):
    """Draw the surfaces at half the time, and the energy balance over time."""
    with plotting.style():
        figure = Figure(figsize=(6.9, 4.0), layout="constrained")
        above, below = figure.subplots(2, height_ratios=(1.0, 1.7))
        plotting.snapshot(result, 0.5 * result.t[-1], ax=above)
        above.set_axis_off()
        below.stackplot(result.t, *parts.values(), colors=COLOURS, labels=parts)
        below.plot(result.t, work, color=plotting.INK, label="work")
        below.set(xlabel="$t$", ylabel="energy", xlim=(0.0, result.t[-1]), ylim=(0.0, None))
        below.legend(loc="upper left", frameon=False, reverse=True)
    plotting.save(figure, path)


def main(folder=None):
    """Compute the energy balance at the end, the friction, and their errors.

    A closed balance shows that no term is missing, not that the run is accurate.  The error of the
    work is the run's own estimate.
    """
    result = simulate(scene(), accuracy=1e-6)
    work, parts = balance(result)
    if folder is not None:
        draw(Path(folder) / "rough_surface.png", result, work, parts)
    gap = np.abs(work - sum(parts.values())).max() / work[-1]
    return {
        "work": work[-1],
        **{name: values[-1] for name, values in parts.items()},
        "friction: work / distance": work[-1] / TRAVEL,
        "largest gap of the balance / work": gap,
        "estimated error of the work / work": result.error_estimate["applied_work"] / work[-1],
    }


if __name__ == "__main__":
    for name, value in main(".").items():
        print(f"{name:40} {value:.6g}")
