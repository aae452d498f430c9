"""Energies of weak encounters beside their closed forms: second order in U, linear swings.

    python benchmarks/weak_coupling.py

Bars are driven and rods are so long that bobs move along x; energies are those of the pendulums
about their bars.  The figures and their numbers are written to docs/measured/.
"""

import argparse
import warnings

import numpy as np
from direction_of_energy import COLOURS, FOLDER, keep_numbers, plain_ticks
from scipy.optimize import brentq, minimize_scalar
from scipy.special import ive, jv, jvp, k0
from scipy.stats import qmc, t

import tribo
from tribo import plotting
from tribo.plotting.style import NOTE_SIZE

# Rods so long that a bob's height changes by less than 1e-5 of the width of the potential.
LENGTH = 1e4
WIDTH = 1.0
# Pendulums turn exactly between the kicks of this method, so that weak kicks have small errors.
STEPS = {"method": "kahan-li-8", "step": 0.1}


def coulomb(k, b=1.0):
    """The Fourier transform of 1 / sqrt(x^2 + b^2)."""
    return 2.0 * k0(np.abs(k) * b)


def gaussian(k, width=WIDTH):
    """The Fourier transform of exp(-x^2 / (2 width^2))."""
    return width * np.sqrt(2.0 * np.pi) * np.exp(-0.5 * (k * width) ** 2)


def pair(potential, speed, frequencies, way, gap=0.0, heavy=1.0):
    """One pendulum over another on driven bars; the bobs' mass is 1, the lower one's `heavy`."""
    drive, each = tribo.DrivenBars(), []
    for mass, frequency in zip((1.0, heavy), frequencies, strict=True):
        stiffness = mass * (LENGTH * frequency) ** 2
        each.append(tribo.Asperite(m1=mass, m2=1.0, kappa=stiffness, length=LENGTH))
    upper = tribo.Surface(
        "upper", bob=(-way, gap), velocity=(speed, 0.0), drive=drive, asperite=each[0]
    )
    lower = tribo.Surface("lower", facing="up", drive=drive, asperite=each[1])
    output = tribo.Output(samples=2)
    return tribo.Scene((upper, lower), potential, 2.0 * way / speed, output=output)


def from_rest(potential, speed, way, gap):
    """The gain of one pendulum from rest."""
    scene = pair(potential, speed, (1.0, 1.0), way, gap)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", tribo.TriboWarning)  # the finest that can be had
        run = tribo.simulate(scene, accuracy=1e-12)
    return run["upper"].swing_energy[-1, 0]


def signs(potential, transform, way, gap):
    """Strengths of both signs at the speed 1, and the gain from rest over the closed form."""
    sizes = 0.2 * 0.5 ** np.arange(6)
    strengths = np.concatenate([-sizes, sizes[::-1]])
    closed = transform(1.0) ** 2 / 2.0
    ratios = [from_rest(potential(s), 1.0, way, gap) / (s**2 * closed) for s in strengths]
    return strengths.tolist(), ratios


def speeds(_members: int) -> dict:
    """Figure 5: the gain from rest against speed over 1.5 decades."""
    found, rates = {}, np.geomspace(0.4, 12.6, 13)
    kinds = {
        "Gaussian": (lambda s: tribo.Gaussian(s, WIDTH), gaussian, 12.0, 0.0, 0.005),
        "Coulomb": (tribo.Coulomb, coulomb, 9000.0, 1.0, 0.02),
    }
    with plotting.style():
        ax = plotting.axes(plotting.WIDE, 0.6 * plotting.WIDE)
        inset = ax.inset_axes((0.15, 0.15, 0.4, 0.4))
        for (name, (potential, transform, way, gap, weak)), colour in zip(
            kinds.items(), COLOURS, strict=False
        ):
            worst, ratio_of = 0.0, {}
            known = np.array([transform(1.0 / v) ** 2 / (2.0 * v**4) for v in rates])
            ratios = []
            for v, closed in zip(rates, known, strict=True):
                even = []
                for s in (weak, 0.5 * weak):
                    both = [from_rest(potential(sign * s), v, way, gap) for sign in (1, -1)]
                    even.append(np.mean(both) / s**2)
                    ratio_of.setdefault(s, []).append([b / (s**2 * closed) for b in both])
                ratios.append((4.0 * even[1] - even[0]) / 3.0 / closed)
            worst = float(np.max(np.abs(np.array(ratios) - 1.0)))
            best = minimize_scalar(
                lambda v, f=transform: -(f(1.0 / v) ** 2) / v**4,
                bounds=(0.3, 3.0),
                method="bounded",
            )
            fine = np.geomspace(0.3, 13.0, 200)
            ax.loglog(fine, transform(1.0 / fine) ** 2 / (2.0 * fine**4), color=colour, label=name)
            ax.loglog(rates, known * ratios, color=colour, marker=".", linestyle="none")
            of_signs = signs(potential, transform, way, gap)
            inset.plot(*of_signs, color=colour, marker=".", linewidth=0.7)
            found[name] = {
                "strength_and_ratio_at_speed_1": of_signs,
                "speed": rates.tolist(),
                "ratio_after_extrapolation": ratios,
                "largest_deviation": worst,
                "strength": weak,
                "ratios_of_both_signs": ratio_of[weak],
                "speed_of_the_largest_gain": float(best.x),
            }
        ax.set(
            xlabel="$v/\\omega b$ or $v/\\omega\\sigma$", ylabel="gain / $s^2$", ylim=(5e-5, None)
        )
        inset.set(xlabel="$s$ at $v=1$", ylabel="gain / closed form")
        inset.tick_params(labelsize=NOTE_SIZE)
        plain_ticks(ax, (0.3, 0.5, 1.0, 2.0, 5.0, 10.0))
        ax.legend()
    plotting.save(ax, FOLDER / "statistics_speeds.png")
    return found


def drift(amplitude: float, speed: float, most: int = 40) -> float:
    """The mean gain of a pendulum with one amplitude, over s^2; mass and frequency are 1."""
    n = np.arange(-most, most + 1)
    k = n / speed
    slope = 2.0 * k * jv(n, k * amplitude) * jvp(n, k * amplitude) / amplitude
    return float(0.5 * np.sum(n**2 * gaussian(k) ** 2 * slope) / speed**2)


def phases(amplitude: float, speed: float, strength: float, count: int = 64) -> float:
    """The mean gain of the upper pendulum over phases and both signs, over s^2."""
    phase = 2.0 * np.pi * (np.arange(count) + 0.5) / count
    vary = {
        "upper.swing": amplitude / LENGTH * np.cos(phase),
        "upper.omega": amplitude / LENGTH * np.sin(phase),
    }
    gains = []
    for sign in (1.0, -1.0):
        scene = pair(tribo.Gaussian(sign * strength, WIDTH), speed, (1.0, 1.0), 12.0, heavy=1e8)
        data = tribo.ensemble(scene, vary=vary, keep=["upper.swing_energy"], **STEPS)
        gains.append(data["upper.swing_energy"].values.mean() - 0.5 * amplitude**2)
    return float(np.mean(gains)) / strength**2


def one_energy(_members: int) -> dict:
    """Figure 6: the mean gain at one energy against amplitude over speed, and its sign."""
    speed, strength = 1.5, 0.01
    reduced = np.linspace(0.3, 4.2, 14)
    closed = np.array([drift(x * speed, speed) for x in reduced])
    measured = np.array([phases(x * speed, speed, strength) for x in reduced])
    zero = brentq(lambda x: drift(x * speed, speed), 1.0, 3.0)
    at = brentq(lambda x: phases(x * speed, speed, strength), zero - 0.2, zero + 0.2, xtol=1e-4)
    strong = [phases(x * speed, speed, 0.5) for x in reduced]
    with plotting.style():
        ax = plotting.axes()
        fine = np.linspace(0.2, 4.3, 200)
        exact = [drift(x * speed, speed) for x in fine]
        ax.plot(fine, exact, color=plotting.INK, linewidth=0.8, label="second order")
        ax.plot(reduced, measured, ".", color=COLOURS[0], label=f"$s={strength}$")
        ax.plot(reduced, strong, "x", markersize=4, color=COLOURS[1], label="$s=0.5$")
        ax.axhline(0.0, color=plotting.INK, linewidth=0.5)
        ax.set(xlabel="$\\omega a/v$", ylabel="mean gain / $s^2$")
        ax.legend()
    plotting.save(ax, FOLDER / "statistics_one_energy.png")
    scale = float(np.max(np.abs(closed)))
    return {
        "largest_deviation_of_the_largest": float(np.max(np.abs(measured - closed)) / scale),
        "predicted_change_of_sign": zero,
        "measured_change_of_sign": at,
        "predicted_for_the_first_harmonic_alone": 1.841184,
    }


def engine_terms(ratio, speed, frequencies, hot, most=12):
    """Mean gains of both pendulums, over s^2, at temperatures `hot` and `ratio` times that."""
    first, second = frequencies
    n1, n2 = np.meshgrid(np.arange(-most, most + 1), np.arange(-most, most + 1))
    k = (n1 * first + n2 * second) / speed
    power = gaussian(k) ** 2 / speed**2
    for n, frequency, temperature in ((n1, first, hot), (n2, second, ratio * hot)):
        power = power * ive(n, k**2 * temperature / frequency**2)
    drive = n1 * first / hot + n2 * second / (ratio * hot)
    return [0.5 * np.sum(n * w * drive * power) for n, w in ((n1, first), (n2, second))]


def engine_runs(ratio, speed, frequencies, hot, strength, scramble, count=512):
    """Mean work against friction and gains of both pendulums over s^2, by quasi-random starts."""
    vary = {
        "upper.swing_state": tribo.Canonical(hot),
        "lower.swing_state": tribo.Canonical(float(ratio * hot)),
    }
    keep = ["upper.friction_work", "upper.swing_energy", "lower.swing_energy"]
    sums = np.zeros(3)
    for sign in (1.0, -1.0):  # the first order has both signs
        scene = pair(tribo.Gaussian(sign * strength, WIDTH), speed, frequencies, 12.0)
        sampler = qmc.Sobol(4, rng=scramble)
        data = tribo.ensemble(scene, count, vary, sampler=sampler, keep=keep, **STEPS)
        sums += [data[name].values.mean() for name in keep]
    start = []
    for name, frequency in zip(("upper", "lower"), frequencies, strict=True):
        swing, omega = (data[f"{name}.{part}"].values for part in ("swing", "omega"))
        start.append(0.5 * LENGTH**2 * np.mean((frequency * swing) ** 2 + omega**2))
    return (0.5 * sums - [0.0, *start]) / strength**2


def change_of_sign(near: float, setting, strength: float, scrambles: int = 8):
    """Where the work changes its sign near a ratio, and the half-width of its 95 % interval.

    Each scramble has the same starts at both ratios beside it, and so a change of its own.
    """
    beside = near + np.array([-0.01, 0.01])
    work = np.array(
        [[engine_runs(r, *setting, strength, 100 + k)[0] for r in beside] for k in range(scrambles)]
    )
    each = beside[0] - work[:, 0] * (beside[1] - beside[0]) / (work[:, 1] - work[:, 0])
    half = t.ppf(0.975, scrambles - 1) * each.std(ddof=1) / np.sqrt(scrambles)
    return float(each.mean()), float(half)


def two_temperatures(_members: int) -> dict:
    """Figure 9: the mean work against friction between surfaces at two temperatures."""
    frequencies, hot, speed, strength = (1.0, 0.6), 0.5, 0.25, 0.02
    setting = speed, frequencies, hot
    cold = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.85, 1.0])
    closed = np.array([engine_terms(r, *setting) for r in cold])
    runs = np.array([[engine_runs(r, *setting, strength, k) for k in range(6)] for r in cold])
    mean, half = runs.mean(axis=1), 2.571 * runs.std(axis=1, ddof=1) / np.sqrt(6)
    work, half, gains = mean[:, 0], half[:, 0], mean[:, 1:].tolist()
    total = closed.sum(axis=1)
    zero = brentq(lambda r: sum(engine_terms(r, *setting)), 0.12, 0.99)
    crossing, width = change_of_sign(zero, setting, strength)
    with plotting.style():
        ax = plotting.axes()
        fine = np.linspace(0.08, 1.0, 150)
        exact = [sum(engine_terms(r, *setting)) for r in fine]
        ax.plot(fine, exact, color=plotting.INK, linewidth=0.8, label="second order")
        ax.errorbar(cold, work, half, color=COLOURS[0], marker=".", linestyle="none", label="runs")
        ax.axhline(0.0, color=plotting.INK, linewidth=0.5)
        ax.axvline(frequencies[1], color=plotting.INK, linewidth=0.5, linestyle=":")
        ax.set(xlabel="$T_2/T_1$", ylabel="mean work against friction / $s^2$")
        ax.legend()
    plotting.save(ax, FOLDER / "statistics_two_temperatures.png")
    return {
        "temperature_ratio": cold.tolist(),
        "work": [float(x) for x in work],
        "half_width": [float(x) for x in half],
        "closed": total.tolist(),
        "gains": gains,
        "closed_gains": closed.tolist(),
        "predicted_change_of_sign": float(zero),
        "measured_change_of_sign": crossing,
        "half_width_of_the_change_of_sign": width,
        "efficiency": [
            float(-w / -g[0]) if g[0] < 0 else None for w, g in zip(work, gains, strict=True)
        ],
        "efficiency_of_the_term": 1.0 - frequencies[1] / frequencies[0],
    }


FIGURES = {"speeds": speeds, "one_energy": one_energy, "two_temperatures": two_temperatures}


def main() -> None:
    """Draw some figures, or all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("figures", nargs="*", choices=[*FIGURES, []], default=[])
    parser.add_argument("--members", type=int, default=20_000)
    options = parser.parse_args()
    for name in options.figures or FIGURES:
        keep_numbers(name, FIGURES[name](options.members))


if __name__ == "__main__":
    main()
