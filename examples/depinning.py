"""A particle in a washboard potential slides if the force exceeds the static friction.

A constant force F pushes an overdamped particle in a corrugation -A cos(2 pi x / a).  The particle
stands still up to the static friction F_c = 2 pi A / a.  Above it, its mean velocity is

    v = sqrt(F^2 - F_c^2) / gamma .

R. L. Stratonovich, Topics in the Theory of Random Noise, vol. 2 (1967).
"""

import numpy as np

import tribo

# The period is 1; the amplitude [energy] makes the largest curvature of the corrugation 1.
AMPLITUDE, STATIC_FRICTION = 1.0 / (2.0 * np.pi) ** 2, 1.0 / (2.0 * np.pi)
# Damping [mass / time] of a mass of 1: inertia changes the velocity by less than 1 %.
GAMMA, POINT = 10.0, tribo.Asperite(m1=0.5, m2=0.5, kappa=np.inf)
# Forces relative to the static friction.
FORCES = np.array([0.5, 0.9, 1.1, 1.25, 1.5, 2.0, 2.5])


def velocities():
    """Mean velocity under each force, over whole periods after the first."""
    surfaces = [
        tribo.Surface(
            f"force {100.0 * force:g} %",
            asperite=POINT,
            drive=tribo.Pushed(force=(force * STATIC_FRICTION, 0.0)),
            langevin=tribo.Langevin(GAMMA),
        )
        for force in FORCES
    ]
    washboard = tribo.Field(tribo.Corrugation(AMPLITUDE, 1.0), on=[s.name for s in surfaces])
    scene = tribo.Scene(surfaces, [], 600.0, fields=[washboard], output=tribo.Output(samples=3001))
    result = tribo.simulate(scene, method="verlet", step=0.02)
    paths = [result[s.name].x_bob[:, 0] for s in surfaces]
    ends = [np.interp([1.0, np.floor(x[-1])], x, result.t) for x in paths]
    return [
        (x[-1] // 1 - 1) / (b - a) if x[-1] > 2 else 0.0
        for x, (a, b) in zip(paths, ends, strict=True)
    ]


def main(folder="."):
    """Velocities below and above the static friction, in units of F_c / gamma."""
    found = np.array(velocities()) * GAMMA / STATIC_FRICTION
    with tribo.plotting.style():
        ax = tribo.plotting.axes(tribo.plotting.COLUMN, 2.4)
        force = np.linspace(0.0, FORCES[-1], 1000)
        ax.plot(
            force, np.sqrt(np.maximum(force**2 - 1.0, 0.0)), color="#d55e00", label="closed form"
        )
        ax.plot(FORCES, found, "o", ms=4, color=tribo.plotting.INK, label="simulation")
        ax.set(xlabel="force / static friction", ylabel=r"velocity $\gamma v / F_c$")
        ax.legend()
    tribo.plotting.save(ax, f"{folder}/depinning.png")
    return {"velocity at 0.9 F_c": found[1], "velocity at 1.25 F_c": found[3]}


if __name__ == "__main__":
    print(main())
