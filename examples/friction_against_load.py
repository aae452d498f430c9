"""A sphere that interlocks with a row of spheres must climb: friction is load times slope.

A hard sphere rests between two spheres of a row with spacing a.  If the centres of touching spheres
are at a distance d, it must climb a slope alpha with sin(alpha) = a / (2 d).  Under a load N, the
static friction is therefore

    F = N tan(alpha) ,

although the contact itself is frictionless.  This example checks the program; interlocking does not
explain the friction of surfaces that do not fit.

C. A. Coulomb, Theorie des machines simples (Paris 1821).
"""

import numpy as np

import tribo

# Spacing of the row and distance between touching centres [length].
SPACING, DISTANCE = 1.0, 2.0
SLOPE = np.tan(np.arcsin(SPACING / (2.0 * DISTANCE)))
LOADS, RIGID = np.array([0.1, 0.2, 0.3, 0.4]), tribo.Asperite(m1=0.5, m2=0.5, kappa=np.inf)
# Stiffness of the pull [force / length]; time in which the pull can reach 1.2 N tan(alpha).
STIFFNESS, DURATION = 1.0, 60.0


def static_friction(load):
    """Largest pull, which the slider needs to pass a sphere of the row."""
    speed = 1.2 * SLOPE * load / STIFFNESS / DURATION
    slider = tribo.Surface(
        "slider",
        bob=(0.5 * SPACING, np.sqrt(DISTANCE**2 - 0.25 * SPACING**2)),
        asperite=RIGID,
        drive=tribo.Pulled(stiffness=STIFFNESS, speed=speed, load=load),
        langevin=tribo.Langevin(gamma=2.0, velocity=(speed, 0.0)),
    )
    place = {"bob": (-2.0 * SPACING, 0.0), "shape": (6, 1), "spacing": (SPACING, 0.0)}
    row = tribo.Surface("row", facing="up", drive=tribo.DrivenBars(), asperite=RIGID, **place)
    scene = tribo.Scene(
        [slider, row], tribo.Hertz(1e5, DISTANCE), DURATION, output=tribo.Output(samples=501)
    )
    result = tribo.simulate(scene, method="verlet", step=0.01)
    moved = result["slider"].x_bar[:, 0] - result["slider"].x_bar[0, 0]
    return np.max(STIFFNESS * (speed * result.t - moved))


def main(folder="."):
    """Slope of the static friction against the load, and that of the spheres."""
    found = np.array([static_friction(load) for load in LOADS])
    with tribo.plotting.style():
        ax = tribo.plotting.axes(tribo.plotting.COLUMN, 2.4)
        ax.plot([0.0, 0.45], [0.0, 0.45 * SLOPE], color="#d55e00", label="slope of the spheres")
        ax.plot(LOADS, found, "o", ms=4, color=tribo.plotting.INK, label="simulation")
        ax.set(xlabel="load", ylabel="static friction", xlim=(0, None), ylim=(0, None))
        ax.legend()
    tribo.plotting.save(ax, f"{folder}/friction_against_load.png")
    return {"friction / load": np.polyfit(LOADS, found, 1)[0], "slope of the spheres": SLOPE}


if __name__ == "__main__":
    print(main())
