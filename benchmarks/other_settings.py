"""The theorems and closed forms at temperatures, speeds, masses and potentials of their own.

    python benchmarks/other_settings.py

The first part prints, for unlike pendulums that pass each other, the slope of the detailed theorem
by maximum likelihood; where the surfaces have temperatures of their own, w / T is the sum of gains
over these.  The second prints weak-coupling energies of forced pendulums over their closed forms,
and the amplitude at which the mean gain at one energy changes its sign.
"""

import argparse
import json
from dataclasses import replace

import numpy as np
from direction_of_energy import encounter, keep_numbers, slope_of
from scipy.optimize import brentq
from scipy.special import jv, jvp

import tribo

LIGHT = tribo.Asperite(m1=0.6, m2=1.7, kappa=1.1, length=1.6)
STIFF = tribo.Asperite(m1=1.4, m2=0.9, kappa=3.0, length=1.2)
MEMBERS, FEWER = 1_000_000, 100_000
# Weak coupling: rods so long that bobs rise by 1e-6, and the exact turns of a splitting.
LENGTH, WAY, GAP, STRENGTH = 1e6, 40.0, 0.7, 0.002
STEPS = {"method": "kahan-li-8", "step": 0.05}
# Masses of bob and bar, l1 / length, frequency; speed of the runs at one energy.
MASS, BAR, LEVER, FREQUENCY, SPEED = 0.6, 1.7, 1.7 / 2.3, 1.3, 1.7
POTENTIALS = {"Yukawa": tribo.Yukawa(1.0, 0.9), "Morse": tribo.Morse(1.0, 1.4, 1.1)}


def unlike(potential, speed: float, gap: float, drive) -> tribo.Scene:
    """Unlike pendulums from -D to +D."""
    way = 10.0
    top = tribo.Surface(
        "upper",
        bob=(-way, gap),
        velocity=(speed, 0.0),
        asperite=LIGHT,
        drive=drive,
    )
    bottom = tribo.Surface("lower", facing="up", asperite=STIFF, drive=drive)
    return tribo.Scene((top, bottom), potential, 2.0 * way / speed)


FORCED, DRIVEN = tribo.Forced(), tribo.DrivenBars()
# Scenes, temperatures of the upper and the lower surface, members, seeds.
SETTINGS = {
    "Gaussian, forced": (
        unlike(tribo.Gaussian(0.9, 0.8), 0.8, 0.2, FORCED),
        (0.7, 0.7),
        MEMBERS,
        3,
    ),
    "Yukawa, forced": (unlike(tribo.Yukawa(0.6, 1.2), 1.1, 0.4, FORCED), (1.2, 0.5), MEMBERS, 4),
    "Morse, driven": (unlike(tribo.Morse(1.5, 1.5, 0.8), 0.6, 0.3, DRIVEN), (0.4, 0.4), MEMBERS, 5),
    "Hertz, driven": (unlike(tribo.Hertz(2.0, 1.5), 0.5, 0.5, DRIVEN), (0.3, 0.6), FEWER, 6),
    "case A again": (encounter("A"), (0.5, 0.5), MEMBERS, 77),
    "case B again": (encounter("B"), (0.5, 0.5), 2 * MEMBERS, 77),
}


def theorem(scene: tribo.Scene, temperatures: tuple, members: int, seed: int) -> dict:
    """The slope, and the mean of exp(-w / T), of one setting."""
    names = [s.name for s in scene.surfaces]
    vary = {
        f"{name}.swing_state": tribo.Canonical(value)
        for name, value in zip(names, temperatures, strict=True)
    }
    keep = [f"{name}.swing_energy" for name in names]
    ends, numerics = tribo.Output(samples=2), tribo.Numerics(accuracy=1e-6)
    scene = replace(scene, output=ends, numerics=numerics)
    data = tribo.ensemble(scene, members, vary, seed=seed, keep=keep, at="samples")
    x = np.zeros(members)
    for name, temperature in zip(keep, temperatures, strict=True):
        energy = data[name].values.reshape(members, data.sizes["time"], -1).sum(axis=2)
        x += (energy[:, -1] - energy[:, 0]) / temperature
    good = np.isfinite(x)
    x = x[good]
    slope, error = slope_of(x)
    average = tribo.exponential_average(x, 1.0)
    return {
        "temperatures": temperatures,
        "members": json.loads(data.attrs["members"]),
        "slope": slope,
        "standard_error": error,
        "standard_errors_from_1": (slope - 1.0) / error,
        "mean": float(x.mean()),
        "least": float(x.min()),
        "share_that_cools": float(np.mean(x < 0.0)),
        "exponential_average": str(average),
        "tail_index": average.tail_index,
        "trusted": average.trusted,
    }


def theorems() -> dict:
    """All settings of the exact theorems."""
    found = {}
    for name, (scene, temperatures, members, seed) in SETTINGS.items():
        found[name] = theorem(scene, temperatures, members, seed)
        print(name, found[name], flush=True)
    return found


def transform(potential, k: np.ndarray) -> np.ndarray:
    """The Fourier transform of the potential along x at the gap: a sum that converges fast."""
    x = np.arange(-WAY, WAY, 0.02)
    energy = np.array([potential.energy(r) for r in np.hypot(x, GAP)])
    return 0.02 * np.cos(np.multiply.outer(k, x)) @ energy


def weak(potential, strength: float, speed: float) -> tribo.Scene:
    """A forced pendulum over one whose bob and bar are so heavy that it stays at rest."""
    inertia = LEVER * MASS * LENGTH**2
    upper = tribo.Surface(
        "upper",
        bob=(-WAY, GAP),
        velocity=(speed, 0.0),
        asperite=tribo.Asperite(m1=MASS, m2=BAR, kappa=inertia * FREQUENCY**2, length=LENGTH),
    )
    heavy = tribo.Asperite(m1=1e8, m2=1e8, kappa=0.5e8 * LENGTH**2, length=LENGTH)
    lower = tribo.Surface("lower", facing="up", asperite=heavy)
    output = tribo.Output(samples=2)
    scaled = strength * potential
    return tribo.Scene((upper, lower), scaled, 2.0 * WAY / speed, output=output)


def gains(potential, speed: float, amplitude: float, strength: float, count: int = 64) -> float:
    """Mean gain lambda e over s^2 over phases and both signs; q = l1 theta has the amplitude."""
    phase = 2.0 * np.pi * (np.arange(count) + 0.5) / count
    swing = amplitude / (LEVER * LENGTH)
    vary = {
        "upper.swing": swing * np.cos(phase),
        "upper.omega": FREQUENCY * swing * np.sin(phase),
    }
    total = 0.0
    for sign in (1.0, -1.0):
        scene = weak(potential, sign * strength, speed)
        data = tribo.ensemble(scene, vary=vary, keep=["upper.swing_energy"], **STEPS)
        start = 0.5 * MASS * (FREQUENCY * amplitude) ** 2
        total += LEVER * data["upper.swing_energy"].values.mean() - start
    return 0.5 * total / strength**2


def extrapolated(potential, speed: float, amplitude: float, count: int = 64) -> float:
    """The same as the strength goes to zero, from two strengths."""
    one, half = (gains(potential, speed, amplitude, s, count) for s in (STRENGTH, 0.5 * STRENGTH))
    return (4.0 * half - one) / 3.0


def closed_drift(potential, speed: float, amplitude: float, most: int = 30) -> float:
    """The same, to second order in U."""
    n = np.arange(-most, most + 1)
    k = n * FREQUENCY / speed
    power = n**2 * transform(potential, k) ** 2 * 2.0 * k
    slope = jv(n, k * amplitude) * jvp(n, k * amplitude)
    return float(np.sum(power * slope)) / (2.0 * MASS * amplitude * speed**2)


def energies() -> dict:
    """Energies from rest over the closed form, and the change of sign at one energy."""
    found = {}
    for name, potential in POTENTIALS.items():
        ratios = {}
        for speed in (0.6, 1.1, 2.3):
            power = transform(potential, np.array([FREQUENCY / speed]))[0] ** 2
            closed = FREQUENCY**2 * power / (2.0 * MASS * speed**4)
            ratios[str(speed)] = extrapolated(potential, speed, 0.0, count=2) / closed
        zero = brentq(
            lambda x, p=potential: closed_drift(p, SPEED, x * SPEED / FREQUENCY), 1.0, 3.0
        )
        near = zero + np.array([-0.001, 0.001])
        low, high = (extrapolated(potential, SPEED, x * SPEED / FREQUENCY) for x in near)
        found[name] = {
            "energy_from_rest_over_closed_form": ratios,
            "speed": SPEED,
            "predicted_change_of_sign": zero,
            "measured_change_of_sign": float(near[0] - low * (near[1] - near[0]) / (high - low)),
        }
        print(name, found[name], flush=True)
    return found


PARTS = {"theorems": theorems, "energies": energies}


def main() -> None:
    """Print some parts, or all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("parts", nargs="*", choices=[*PARTS, []], default=[])
    options = parser.parse_args()
    for name in options.parts or PARTS:
        keep_numbers(f"other settings: {name}", PARTS[name]())


if __name__ == "__main__":
    main()
