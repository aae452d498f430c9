"""From encounters to friction: pendulums in reservoirs slide over rows of bumps.

    python benchmarks/friction_of_rows.py

Bars are driven over rigid bumps whose Gaussian potential is so weak that second order in U holds.
Works of both signs of U, from the same noise, are averaged: what is odd in U cancels.  The figure
and its numbers are written to docs/measured/.
"""

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
from direction_of_energy import COLOURS, FOLDER, keep_numbers, plain_ticks
from scipy.integrate import trapezoid
from scipy.special import ive
from scipy.stats import qmc, t
from weak_coupling import LENGTH, STEPS, WIDTH, gaussian, pair

import tribo
from tribo import plotting

# Bob mass, frequency and width of the bumps are 1.  Mean distance of bumps; damping rate of swings.
SPACING, DAMPING, TEMPERATURE, STRENGTH = 8.0, 0.05, 0.1, 0.03
# Upper pendulums, bumps, independent rows; slides until the friction is steady, then this far.
PENDULUMS, BUMPS, ROWS = 64, 2048, 4
STEADY, DISTANCE = 8.0 / DAMPING, 240.0
SPEEDS = np.array([0.5, 0.6366, 0.8, 1.0, 1.2732, 1.6, 2.2])


def row(places: np.ndarray, strength: float, speed: float, seed: int) -> tribo.Scene:
    """Pendulums at a temperature over bumps at some places of a period."""
    period = SPACING * BUMPS
    drive = tribo.DrivenBars()
    upper = tribo.Surface(
        "upper",
        shape=(PENDULUMS, 1),
        spacing=(period / PENDULUMS, 0.0),
        velocity=(speed, 0.0),
        drive=drive,
        asperite=tribo.Asperite(m1=1.0, m2=1.0, kappa=LENGTH**2, length=LENGTH),
        langevin=tribo.Langevin(DAMPING * LENGTH**2, TEMPERATURE, on="swing"),
        initial=tribo.Initial(temperature=TEMPERATURE),
    )
    lower = tribo.Surface(
        "lower",
        facing="up",
        positions=np.column_stack([places, np.zeros((BUMPS, 2))]),
        drive=drive,
        asperite=tribo.Asperite(kappa=np.inf),
    )
    potential = tribo.Gaussian(strength, WIDTH).with_cutoff(6.0 * WIDTH)
    output = tribo.Output(times=[STEADY, STEADY + DISTANCE / speed])
    end = STEADY + DISTANCE / speed
    return tribo.Scene(
        (upper, lower), potential, end, periodic={"x": period}, output=output, seed=seed
    )


def friction(speed: float, regular: bool, seed: int) -> float:
    """Mean friction force on a pendulum over s^2, and over the number of bumps a length."""
    if regular:
        places = SPACING * np.arange(BUMPS)
    else:
        places = np.random.default_rng(seed).uniform(0.0, SPACING * BUMPS, BUMPS)
    works = []
    for sign in (1.0, -1.0):
        scene = row(places, sign * STRENGTH, speed, seed)
        work = tribo.simulate(scene, method="verlet", step=0.1 / max(1.0, speed))[
            "upper"
        ].friction_work
        works.append(work[-1] - work[-2])
    return float(np.mean(works)) * SPACING / (PENDULUMS * DISTANCE * STRENGTH**2)


def run(point: tuple[str, float, int]) -> float:
    """One value of a point: what is measured, the speed, and a seed."""
    name, speed, seed = point
    if name == "one encounter":
        return one_encounter(speed, seed)
    return friction(speed, name == "regular row", seed)


def interval(values: np.ndarray) -> tuple[float, float]:
    """The mean of a few independent values, and the half-width of its 95 % interval."""
    half = t.ppf(0.975, values.size - 1) * values.std(ddof=1) / np.sqrt(values.size)
    return float(values.mean()), float(half)


def one_encounter(speed: float, scramble: int) -> float:
    """Mean gain of one pendulum at the temperature from one bump, over s^2, by quasi-random starts.

    The gain of the lower pendulum, of a mass of 1e8, is negligible.
    """
    gains = []
    for sign in (1.0, -1.0):
        potential = tribo.Gaussian(sign * STRENGTH, WIDTH)
        scene = pair(potential, speed, (1.0, 1.0), 12.0, heavy=1e8)
        vary = {"upper.swing_state": tribo.Canonical(TEMPERATURE)}
        sampler, keep = qmc.Sobol(2, rng=scramble), ["upper.swing_energy"]
        data = tribo.ensemble(scene, 512, vary, sampler=sampler, keep=keep, **STEPS)
        swing, omega = (data[f"upper.{part}"].values for part in ("swing", "omega"))
        start = 0.5 * LENGTH**2 * (swing**2 + omega**2).mean()
        gains.append(data["upper.swing_energy"].values.mean() - start)
    return float(np.mean(gains)) / STRENGTH**2


def closed_encounter(speed: float, most: int = 20) -> float:
    """The same, to second order in U."""
    n = np.arange(-most, most + 1)
    k = n / speed
    return float(np.sum(n**2 * gaussian(k) ** 2 * ive(n, k**2 * TEMPERATURE))) / (
        2.0 * TEMPERATURE * speed**2
    )


def damped(speed: float, wave_numbers: np.ndarray) -> np.ndarray:
    """Friction by each wave number of a potential of unit amplitude, to second order.

    The power is half of the correlation of its fluctuations in equilibrium, divided by T.
    """
    times = np.linspace(0.0, 30.0 / DAMPING, 8_001)
    swing = np.sqrt(1.0 - 0.25 * DAMPING**2)
    decay = np.exp(-0.5 * DAMPING * times)
    correlation = decay * (np.cos(swing * times) + 0.5 * DAMPING / swing * np.sin(swing * times))
    found = []
    for k in wave_numbers:
        spread = k**2 * TEMPERATURE
        excess = np.exp(-spread) * np.expm1(spread * correlation)
        integral = 2.0 * trapezoid(np.cos(k * speed * times) * excess, times)
        found.append(0.5 * speed / TEMPERATURE * k**2 * integral)
    return np.array(found)


def closed_random(speed: float) -> float:
    """Friction of a random row over the number of bumps a length: all wave numbers, damped."""
    k = np.linspace(1e-3, 5.0, 600)
    return float(trapezoid(gaussian(k) ** 2 * damped(speed, k), k) / np.pi)


def closed_regular(speed: float) -> float:
    """Friction of a regular row over the same: the wave numbers of its period alone."""
    k = 2.0 * np.pi / SPACING * np.arange(1, 8)
    return float(np.sum(gaussian(k) ** 2 * damped(speed, k)) * 2.0 / SPACING)


def draw(found: dict) -> None:
    """Figure 10."""
    with plotting.style():
        ax = plotting.axes(plotting.WIDE, 0.5 * plotting.WIDE)
        # The resonances of a regular row are narrow.
        lines = ((closed_encounter, "-", 40), (closed_random, ":", 40), (closed_regular, "-", 400))
        labels = ("one encounter, closed form", "random row, with damping", "regular row")
        for (line, dash, count), label, colour in zip(lines, labels, COLOURS, strict=True):
            fine = np.geomspace(0.45, 2.4, count)
            ax.plot(fine, [line(v) for v in fine], dash, color=colour, linewidth=0.9, label=label)
        points = (("one encounter", "x"), ("random row", "."), ("regular row", "s"))
        for (name, marker), colour in zip(points, COLOURS, strict=True):
            mean, half = np.array(found[name]["mean"]), np.array(found[name]["half_width"])
            look = {"color": colour, "marker": marker, "markersize": 4, "linestyle": "none"}
            ax.errorbar(SPEEDS, mean, half, label=f"{name}, runs", elinewidth=0.7, **look)
        ax.set(xscale="log", xlabel="$v/\\omega\\sigma$", ylabel="friction force / $n s^2$")
        ax.set(yscale="log", ylim=(0.01, 20.0))
        plain_ticks(ax, (0.5, 0.7, 1.0, 1.4, 2.0))
        ax.legend(ncol=2)
    plotting.save(ax, FOLDER / "statistics_rows.png")


def main() -> None:
    """Run and draw figure 10."""
    closed = {
        "one encounter": closed_encounter,
        "random row": closed_random,
        "regular row": closed_regular,
    }
    found: dict = {"speed": SPEEDS.tolist(), "rows": ROWS}
    points = [(name, float(v), k) for name in closed for v in SPEEDS for k in range(ROWS)]
    with ProcessPoolExecutor(2, get_context("spawn")) as workers:
        values = list(workers.map(run, points))
    for name, each in zip(closed, np.reshape(values, (3, SPEEDS.size, ROWS)), strict=True):
        mean, half = zip(*map(interval, each), strict=True)
        exact = [closed[name](float(v)) for v in SPEEDS]
        found[name] = {"mean": mean, "half_width": half, "closed": exact}
    encounter, random = found["one encounter"], found["random row"]
    found["random row over one encounter"] = [
        [a / b, h / b]
        for a, h, b in zip(random["mean"], random["half_width"], encounter["closed"], strict=True)
    ]
    draw(found)
    keep_numbers("rows", found)


if __name__ == "__main__":
    main()
