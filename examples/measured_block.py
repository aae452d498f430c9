"""From a measured scan to a figure: a rough block on an elastic body, pulled by one spring.

The heights of a scan are those of a block of 24 × 6 asperites on an elastic half-space.  One load
presses it onto a table of spheres, and one spring pulls it forth and back.  Lengths are in nm and
energies in eV: forces are in units of 0.16 nN, and the modulus is 16 GPa.  The scan is synthetic.
The pull is the friction and the drag of the reservoir; the loop's area, the work of the stage.
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import tribo
from tribo.sweeps.figure import law_lines

SCAN = Path(__file__).with_name("scan.x3p")


def scene(speed, duration, **output):
    scan = tribo.Topography(SCAN, unit="nm", origin=(0.25, 0.25))
    tips = {"asperite": tribo.Asperite(0.5, 0.5, kappa=1.0, length=1.0), "heights": scan}
    grid = {"shape": (24, 6), "spacing": (1.0, 1.0), "elastic": tribo.Elastic(100.0, 0.3)}
    pull = tribo.Pulled(stiffness=10.0, speed=speed, load=40.0, block=True)
    heat = [tribo.Langevin(0.5, 0.025, on="swing"), tribo.Langevin(0.1, 0.025)]
    block = tribo.Surface("block", bob=(2.0, 1.6), drive=pull, langevin=heat, **grid, **tips)
    flat = {"shape": (44, 8), "spacing": (1.1, 1.1), "depth": -1.0, "facing": "up"}
    table = tribo.Surface("table", asperite=tribo.Asperite(kappa=np.inf), drive="bars", **flat)
    both, contact = [block, table], tribo.Hertz(40.0, 1.0)
    return tribo.Scene(both, contact, duration, output=tribo.Output(**output))


def measured(speed=0.04, way=6.0):
    steps, leg = {"method": "verlet", "step": 0.01}, way / speed
    slow = scene(speed, 400.0, samples=801, run_in=100.0)
    law = tribo.friction_law(slow, [5.0, 10.0, 20.0, 40.0], **steps)
    turns = [[k * leg, speed * (-1) ** j] for k in range(10) for j in (k - 1, k)][1:-1]
    loop = scene(turns, 9 * leg, samples=1351, series=["forces"], run_in=leg)
    return law, tribo.simulate(loop, **steps)


def figure_of(law, result):
    figure = Figure(figsize=(6.2, 6.0), layout="constrained")
    axes = figure.subplots(3, 2, height_ratios=(0.6, 1, 1)).ravel()
    result.plot.map("height", "block", ax=axes[0])
    result.plot.friction_map("block", "normal", ax=axes[1])
    law_lines(law, ax=axes[2])
    result.plot.loop("block", ax=axes[3])
    drops = result.slips("block").distribution("drop", bins=6)
    axes[4].bar(drops.low, drops.share, drops.high - drops.low, align="edge", alpha=0.3)
    axes[4].vlines((drops.low + drops.high) / 2, drops.share_low, drops.share_high)
    axes[4].set(xlabel="drop of the force in a slip", ylabel="share of slips")
    return result.plot.energy_budget(ax=axes[5]).figure


def main(folder="."):
    """Balances of the numbers of the figure."""
    law, result = measured()
    with tribo.plotting.style():
        tribo.plotting.save(figure_of(law, result), f"{folder}/measured_block.png")
    block, loop, t = result["block"], result.loop("block"), result.t
    way = np.where(t > 150.0, np.sign(np.sin(np.pi * t / 150.0)), 0.0)  # -1 on the way back
    resistance = 0.1 * block.vx_cm.sum(axis=1) - block.friction_force  # drag and contact
    gap = result.system["applied_work"] - result.system["total_energy_change"]
    return {
        "mean normal force / load": block.normal_force[t > 150.0].mean() / 40.0,
        "(friction + drag) / pull": way @ resistance / (way @ block.pull_force),
        "area of the loop / work of the stage": loop.area.mean / loop.dissipation.mean,
        "gap of the energy / work of the stage": np.abs(gap).max() / block.stage_work[-1],
    }


if __name__ == "__main__":
    print(main())
