"""A friction loop: the stage turns back, and the area is the heat.

A stage pulls a tip over a corrugation -A cos(q x), forth and back, by a schedule of its speed.  The
tip sticks until the force of the pull reaches F_c = A q, and slips.  In a slow pull the largest
force is F_c both ways.  The work of the stage is the area of the loop; it becomes heat of the
reservoir and stored energy.

G. A. Tomlinson, Phil. Mag. 7 (1929) 905.
"""

import numpy as np

import tribo

# Corrugation: amplitude [energy] and period [length]; speed of the stage, and how far it goes.
AMPLITUDE, PERIOD, SPEED, WAY = 1.0, 1.0, 0.01, 4.0
Q = 2.0 * np.pi / PERIOD
STIFFNESS = Q**2 * AMPLITUDE / 4.0


def loop():
    """A run in which the stage goes forth, rests, and comes back."""
    turn = WAY / SPEED
    there_and_back = [[0, SPEED], [turn, SPEED], [turn, 0.0]]
    there_and_back += [[1.2 * turn, 0.0], [1.2 * turn, -SPEED]]
    tip = tribo.Surface(
        "tip",
        asperite=tribo.Asperite(m1=1.0, m2=1.0, kappa=np.inf),
        drive=tribo.Pulled(stiffness=STIFFNESS, speed=there_and_back),
        langevin=tribo.Langevin(gamma=2.0 * STIFFNESS**0.5),
    )
    corrugation = tribo.Field(tribo.Corrugation(AMPLITUDE, PERIOD), on=["tip"])
    output = tribo.Output(samples=2201, series=["forces", "energies"])
    scene = tribo.Scene([tip], [], 2.2 * turn, fields=[corrugation], output=output)
    return tribo.simulate(scene, accuracy=1e-8), tribo.Schedule(there_and_back)


def main(folder="."):
    """The largest forces of both ways over the static friction, and the gap of the energy."""
    result, speed = loop()
    series = result["tip"]
    force = series.pull_force
    stage = speed.integral(result.t)
    stored = series.k_trans[:, 0] + series.e_pull + result.system["field_energy"]
    heat = series.heat[:, 0]
    gap = series.stage_work - heat - (stored - stored[0])
    with tribo.plotting.style():
        ax = tribo.plotting.axes(tribo.plotting.COLUMN, 2.4)
        ax.plot(stage / PERIOD, force / (AMPLITUDE * Q), color="#d55e00")
        ax.axhline(1.0, color=tribo.plotting.INK, lw=0.6)
        ax.axhline(-1.0, color=tribo.plotting.INK, lw=0.6)
        ax.set(xlabel="position of the stage / period", ylabel="force of the pull / $F_c$")
    tribo.plotting.save(ax, f"{folder}/friction_loop.png")
    return {
        "largest force / F_c": np.max(force) / (AMPLITUDE * Q),
        "smallest force / F_c": np.min(force) / (AMPLITUDE * Q),
        "largest gap of the energy": float(np.round(np.max(np.abs(gap)), 6)),
    }


if __name__ == "__main__":
    print(main())
