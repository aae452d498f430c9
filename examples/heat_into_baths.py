"""Baths of oscillators on the bars turn the energy of the pendulums into heat.

In case A of the paper two asperites repel each other as they pass, and then swing for ever.  Here
every bar also has a bath of n oscillators with Drude's damping kernel gamma w_c exp(-w_c t), and
the swing decays.  A finite bath returns the energy later; tribo estimates the time until which the
bath acts as a continuum.

The exact solution has a continuum of oscillators.  For this kernel its force p on the bar obeys one
more equation of motion in each direction,

    p' = -w_c p - gamma w_c (v_bar - V) .

R. Zwanzig, J. Stat. Phys. 9 (1973) 215.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from tribo import Output, paper, plotting, simulate
from tribo.model.bath import Bath
from tribo.model.spectrum import Spectrum, valid_until

# Friction of the bath at low frequency [mass / time], and its cutoff w_c [rad / time].
GAMMA, CUTOFF = 1.0, 2.0

# Numbers of oscillators on every bar.
FEW, MANY = 40, 160

CASE = replace(paper.scene("A"), duration=120.0, output=Output(samples=1201))
UPPER = CASE.surfaces[0]
KAPPA, BAR, MASS, INERTIA, LENGTH, L1, L2 = (
    UPPER.asperite.for_each(1)[name].item()
    for name in ("kappa", "m2", "mass", "inertia", "length", "l1", "l2")
)


def internal_energy(n):
    """e_int of the upper asperite over time, with n oscillators on every bar [energy]."""
    bath = Bath(spectrum=Spectrum("drude", GAMMA, CUTOFF, n)) if n else Bath()
    bathed = tuple(replace(surface, bath=bath) for surface in CASE.surfaces)
    result = simulate(replace(CASE, surfaces=bathed), method="verlet", step=0.01)
    return result["upper"].delta_e_int[:, 0]


def continuum(t):
    """The same with a continuum of oscillators, by the equations of motion of the upper asperite.

    The lower asperite is its image under a rotation by pi about the point between them, which is
    the origin here.
    """
    strength, speed = CASE.interactions[0].potential.strength, 0.5 * UPPER.velocity[0]

    def rates(t, state):
        theta, omega = state[:2]
        shift, velocity, pull = state[2:].reshape(3, 2)  # in the frame of V
        across = np.array([np.cos(theta), np.sin(theta)])
        bob = np.array([0.5 * UPPER.bob[0] + speed * t, 0.0]) + shift
        bob += L1 * np.array([np.sin(theta), 1.0 - np.cos(theta)])
        contact = strength * 2.0 * bob / np.hypot(*(2.0 * bob)) ** 3
        torque = (LENGTH * contact - L2 * pull) @ across - KAPPA * theta
        memory = -CUTOFF * (pull + GAMMA * (velocity - L2 * omega * across))
        return np.concatenate([[omega, torque / INERTIA], velocity, pull / MASS, memory])

    swing = solve_ivp(rates, (0.0, t[-1]), np.zeros(8), "DOP853", t, rtol=1e-9, atol=1e-12).y
    return 0.5 * (INERTIA * swing[1] ** 2 + KAPPA * swing[0] ** 2)


def end_of_validity(n):
    """Time until which n oscillators act as a continuum from the encounter on."""
    spectrum = Spectrum("drude", GAMMA, CUTOFF, n)
    encounter = -UPPER.bob[0] / UPPER.velocity[0]
    return encounter + valid_until(spectrum, BAR, np.sqrt(KAPPA / INERTIA))


def draw(path, t, runs, exact):
    """Draw e_int over time."""
    grey, blue, red = "0.55", "#0b62a4", "#d55e00"
    with plotting.style():
        ax = plotting.axes(plotting.WIDE, 2.6)
        for n, colour in zip(runs, (grey, blue, red), strict=True):
            ax.plot(t, runs[n], color=colour)
        ax.plot(t, exact, color=plotting.INK, lw=0.8, ls=(0, (3, 3)))
        ax.axvline(end_of_validity(FEW), color=blue, lw=0.8, ls=":")
        for position, text, colour in (
            ((48.0, 0.54), "no bath", grey),
            ((36.0, 0.17), f"{MANY} oscillators\n(dashed: the continuum)", red),
            ((84.0, 0.33), f"{FEW} oscillators on each bar", blue),
            ((end_of_validity(FEW) + 1.0, 0.47), f"limit of {FEW} oscillators", blue),
        ):
            plotting.note(ax, position, text, color=colour, ha="left")
        ax.set(xlabel="$t$", ylabel=r"$e_{\rm int}$", xlim=(t[0], t[-1]), ylim=(0.0, 0.6))
    plotting.save(ax, path)


def main(folder=None):
    """Compute the internal energy that is left, and compare the baths with the continuum."""
    t = CASE.times
    runs, exact = {n: internal_energy(n) for n in (0, FEW, MANY)}, continuum(t)
    if folder is not None:
        draw(Path(folder) / "heat_into_baths.png", t, runs, exact)
    errors = {
        n: np.abs(runs[n] - exact)[t < end_of_validity(n)].max() / exact.max() for n in (FEW, MANY)
    }
    return {
        "e_int without a bath at the end": runs[0][-1],
        "its change since t = 60": np.ptp(runs[0][t > 60.0]),
        f"e_int with {MANY} oscillators at the end": runs[MANY][-1],
        f"largest error of {MANY} oscillators / largest e_int": errors[MANY],
        f"{FEW} oscillators act as a continuum until t": end_of_validity(FEW),
        f"largest error of {FEW} oscillators until then": errors[FEW],
    }


if __name__ == "__main__":
    for name, value in main(".").items():
        print(f"{name:64} {value:.6g}")
