"""A run with all velocities reversed returns to its start.

Two asperites pass each other, and their pendulums swing afterwards.  A second run starts from the
end with all velocities reversed.  In this run the pendulums return their energy to the drives and
come to rest.  Without a reservoir, friction is reversible, but no experiment can prepare the second
start.

J. Loschmidt, Sitzungsber. Akad. Wiss. Wien 73 (1876) 128.
"""

from dataclasses import replace

import numpy as np

import tribo
from tribo import paper


def reversed_scene(result):
    """The scene that begins at the end of a run, with all velocities reversed."""
    surfaces = []
    for surface in result.scene.surfaces:
        series, velocity = result[surface.name], np.array(surface.velocity)
        surfaces.append(
            replace(
                surface,
                bob=surface.bob + velocity * result.t[-1],  # forced: it moves uniformly
                velocity=-velocity,
                initial=tribo.Initial(theta=series.theta[-1], omega=-series.omega[-1]),
            )
        )
    return replace(result.scene, surfaces=tuple(surfaces))


def main(folder="."):
    """Internal energy after the pass and at the end, and the last angle."""
    forward = tribo.simulate(paper.scene("A"))
    back = tribo.simulate(reversed_scene(forward))
    with tribo.plotting.style():
        ax = tribo.plotting.axes(tribo.plotting.WIDE, 2.2)
        ax.plot(forward.t, forward["upper"].theta, color="#0b62a4", label="forward")
        time = forward.t[-1] + back.t
        ax.plot(time, back["upper"].theta, color="#d55e00", label="reversed")
        ax.set(xlabel="$t$", ylabel=r"$\theta$ (rad)")
        ax.legend()
    tribo.plotting.save(ax, f"{folder}/time_reversal.png")
    gained, lost = (run["upper"].delta_e_int[-1, 0] for run in (forward, back))
    return {
        "internal energy after the pass": gained,
        "internal energy at the end": gained + lost,
        "angle at the end": back["upper"].theta[-1, 0],
    }


if __name__ == "__main__":
    print(main())
