"""Baths of oscillators on the bars turn the energy of the pendulums into heat.

A continuum of oscillators with Drude's damping kernel gamma w_c exp(-w_c t) exerts on a bar a force
p with p' = -w_c p - gamma w_c v_bar, so small swings obey linear equations.  A finite bath follows
their exact solution for some time, and then returns energy to the swing.  tribo estimates this
time.

R. Zwanzig, J. Stat. Phys. 9 (1973) 215.
"""

import numpy as np
from matplotlib.figure import Figure
from scipy.linalg import expm

import tribo
from tribo.model.spectrum import valid_until

GAMMA, CUTOFF = 1.0, 2.0  # [mass / time], [rad / time]
START, ASPERITE, TIMES = 1e-3, tribo.Asperite(), np.linspace(0.0, 260.0, 1301)
MASS, INERTIA, L2 = (ASPERITE.for_each(1)[name][0] for name in ("mass", "inertia", "l2"))
FREQUENCY = np.sqrt(ASPERITE.kappa / INERTIA)


def swing_energy(spectrum):
    """Energy of the swing over time, relative to its first value."""
    bath, initial = tribo.Bath(spectrum=spectrum), tribo.Initial(omega=START)
    surface = tribo.Surface("one", asperite=ASPERITE, initial=initial, bath=bath)
    scene = tribo.Scene([surface], [], TIMES[-1], output=tribo.Output(samples=TIMES.size))
    result = tribo.simulate(scene, method="verlet", step=0.01)
    return 1.0 + result["one"].delta_e_int[:, 0] / (0.5 * INERTIA * START**2)


def continuum():
    """The same with a continuum: linear equations for theta, omega, velocity and p."""
    swing, k = [-(FREQUENCY**2), 0, 0, -L2 / INERTIA], GAMMA * CUTOFF
    rates = [[0, 1, 0, 0], swing, [0, 0, 0, 1.0 / MASS], [0, L2 * k, -k, -CUTOFF]]
    theta, omega = np.array([expm(np.multiply(rates, t))[:2, 1] for t in TIMES]).T
    return omega**2 + (FREQUENCY * theta) ** 2


def main(folder="."):
    """Time for which each bath acts as a continuum, and its largest error until then."""
    shown, exact = {}, continuum()
    with tribo.plotting.style():
        figure = Figure(figsize=(tribo.plotting.PAGE, 2.5), layout="constrained")
        swing, error = figure.subplots(1, 2)
        for n, colour in ((40, "#0b62a4"), (160, "#d55e00")):
            spectrum = tribo.Spectrum("drude", GAMMA, CUTOFF, n)
            energy, end = swing_energy(spectrum), valid_until(spectrum, ASPERITE.m2, FREQUENCY)
            shown[f"{n} oscillators act as a continuum until t"] = end
            shown[f"largest error of {n} until then"] = np.abs(energy - exact)[end > TIMES].max()
            swing.plot(TIMES, energy, color=colour, label=f"{n} oscillators")
            error.semilogy(TIMES, np.abs(energy - exact), color=colour)
            error.axvline(end, color=colour, lw=0.8, ls=":")
        swing.plot(TIMES, exact, color=tribo.plotting.INK, lw=0.8, ls="--", label="continuum")
        swing.set(xlabel="$t$", ylabel="energy of the swing", xlim=(0, 260))
        error.set(xlabel="$t$", ylabel="difference from the continuum", ylim=(1e-8, 2))
        swing.legend()
    tribo.plotting.save(figure, f"{folder}/heat_into_baths.png")
    return shown


if __name__ == "__main__":
    print(main())
