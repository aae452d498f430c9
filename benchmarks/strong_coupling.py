"""Mean gains at one energy, and of a free block, at the paper's strong coupling.

    python benchmarks/strong_coupling.py

The figures and their numbers are written to docs/measured/; intervals are those of independent
shifts of the phases, or of members.
"""

import argparse
from dataclasses import replace

import numpy as np
from direction_of_energy import (
    COLOURS,
    FOLDER,
    GAINS,
    SEED,
    encounter,
    gain_of,
    keep_numbers,
    plain_ticks,
)
from scipy.optimize import brentq
from scipy.stats import t

import tribo
from tribo import paper, plotting

# Phases of a grid, and grids that are shifted at random.
PHASES, SHIFTS = 128, 6


def scale_of(scene: tribo.Scene) -> tuple[float, float, float]:
    """Frequency and l1 of the upper pendulum, and the speed."""
    upper = scene.surfaces[0]
    each = {name: float(value[0]) for name, value in upper.each.items()}
    lever = each["length"] * each["m2"] / (each["m1"] + each["m2"])
    return float(np.sqrt(each["kappa"] / each["inertia"])), lever, upper.velocity[0]


def mean_gain(scene: tribo.Scene, reduced: float) -> tuple[float, float]:
    """Mean gain of the pair, the upper pendulum with omega a / v and the lower at rest.

    With the half-width of its 95 % interval.
    """
    frequency, lever, speed = scale_of(scene)
    swing = reduced * speed / (frequency * lever)
    rng, means = np.random.default_rng(SEED), []
    for _ in range(SHIFTS):
        phase = 2.0 * np.pi * (np.arange(PHASES) + rng.random()) / PHASES
        vary = {
            "upper.swing": swing * np.cos(phase),
            "upper.omega": frequency * swing * np.sin(phase),
        }
        gain = gain_of(tribo.ensemble(scene, vary=vary, keep=GAINS))
        means.append(gain[np.isfinite(gain)].mean())
    half = t.ppf(0.975, SHIFTS - 1) * np.std(means, ddof=1) / np.sqrt(SHIFTS)
    return float(np.mean(means)), float(half)


def change_of_sign(x: np.ndarray, mean: np.ndarray, half: np.ndarray) -> list[list[float]]:
    """Where a series changes sign, by straight lines, with the range that its intervals allow."""
    found = []
    for i in np.flatnonzero(mean[:-1] * mean[1:] < 0.0):
        slope = (mean[i + 1] - mean[i]) / (x[i + 1] - x[i])
        width = max(half[i], half[i + 1]) / abs(slope)
        found.append([float(x[i] - mean[i] / slope), float(width)])
    return found


def one_energy() -> dict:
    """Figure 7: the paper's cases at one energy of the upper pendulum."""
    found: dict = {}
    with plotting.style():
        ax = plotting.axes()
        for (case, last), colour in zip((("A", 3.0), ("B", 1.6)), COLOURS, strict=False):
            scene, reduced = encounter(case), np.linspace(0.1, last, 16)
            mean, half = np.array([mean_gain(scene, x) for x in reduced]).T
            look = {"color": colour, "marker": ".", "linewidth": 0.7, "elinewidth": 0.7}
            ax.errorbar(reduced, mean, half, label=f"case {case}", **look)
            found[case] = {
                "omega_a_over_v": reduced.tolist(),
                "mean": mean.tolist(),
                "half_width": half.tolist(),
                "changes_of_sign": [
                    brentq(lambda x, s=scene: mean_gain(s, x)[0], *reduced[i : i + 2], xtol=1e-3)
                    for i in np.flatnonzero(mean[:-1] * mean[1:] < 0.0)
                ],
            }
        ax.axhline(0.0, color=plotting.INK, linewidth=0.5)
        ax.set(xlabel="$\\omega a/v$", ylabel="mean gain of the pair", ylim=(-0.1, 1.2))
        ax.legend()
    plotting.save(ax, FOLDER / "statistics_one_energy_strong.png")
    return found


# Cases, whether the force attracts, and temperatures of the table in figure 4.
KINDS = (("C", False, 0.5), ("C", False, 2.0), ("E", False, 2.0), ("E", True, 2.0))


def name_of(case: str, attractive: bool, temperature: float) -> str:
    """A kind of encounter."""
    return f"{case}, {'attractive' if attractive else 'repulsive'}, T = {temperature:g}"


def block_scene(case: str, speed: float, attractive: bool, way: float = 100.0) -> tribo.Scene:
    """Case C with another speed, or case E: the same block at rest over a table that moves."""
    scene = (
        paper.scene(case, attractive) if case == "E" else paper.scene("D" if attractive else "C")
    )
    upper, lower = scene.surfaces
    moves = {"upper": speed, "lower": 0.0} if case == "C" else {"upper": 0.0, "lower": -speed}
    upper = replace(upper, bob=(-way, 0.0), velocity=(moves["upper"], 0.0))
    lower = replace(lower, velocity=(moves["lower"], 0.0))
    numerics = tribo.Numerics(accuracy=1e-5)
    return replace(scene, surfaces=(upper, lower), duration=2.0 * way / speed, numerics=numerics)


def losses(case: str, speed: float, attractive: bool, temperature: float, members: int):
    """Loss of the block in the frame of the table, and gain in that where it starts at rest."""
    scene = block_scene(case, speed, attractive)
    vary = {"lower.swing_state": tribo.Canonical(temperature)}
    data = tribo.ensemble(scene, members, vary, seed=SEED, keep=["upper.vx_cm"])
    upper = scene.surfaces[0]
    mass = upper.asperite.m1 + upper.asperite.m2
    change = data["upper.vx_cm"].values[:, 0] - upper.velocity[0]
    change = change[np.isfinite(change)]
    return -0.5 * mass * ((speed + change) ** 2 - speed**2), 0.5 * mass * change**2


def block(members: int = 1000) -> dict:
    """Figure 4: a free block and a table at a temperature, cases C and E."""
    found: dict = {"members": members}
    speeds = np.array([0.2, 0.26, 0.32, 0.36, 0.4, 0.5, 0.7, 1.0, 1.5])
    for case, attractive, temperature in KINDS:
        each = [losses(case, v, attractive, temperature, members) for v in speeds.tolist()]
        mean = np.array([loss.mean() for loss, _ in each])
        half = np.array([1.96 * loss.std() / np.sqrt(loss.size) for loss, _ in each])
        found[name_of(case, attractive, temperature)] = {
            "speed": speeds.tolist(),
            "mean_loss": mean.tolist(),
            "half_width": half.tolist(),
            "mean_gain_in_the_frame_of_the_block": [float(own.mean()) for _, own in each],
            "changes_of_sign": change_of_sign(speeds, mean, half),
            "members_that_ended": [loss.size for loss, _ in each],
        }
    draw_block(found)
    return found


def draw_block(found: dict) -> None:
    """Draw figure 4."""
    with plotting.style():
        ax = plotting.axes(plotting.WIDE, 0.6 * plotting.WIDE)
        colours = (COLOURS[0], COLOURS[1], plotting.INK, COLOURS[2])
        for kind, colour in zip(KINDS, colours, strict=True):
            name = name_of(*kind)
            of = found[name]
            line = "none" if name.startswith("E, repulsive") else "-"
            look = {"color": colour, "marker": "x" if line == "none" else ".", "linestyle": line}
            mean, half = of["mean_loss"], of["half_width"]
            label = name.replace("T = ", "$T=$")
            look |= {"label": label, "markersize": 4, "elinewidth": 0.7}
            ax.errorbar(of["speed"], mean, half, **look)
            gain = np.array(of["mean_gain_in_the_frame_of_the_block"])
            if line == "-":
                ax.plot(of["speed"], -gain, color=colour, linewidth=0.7, linestyle="--")
        ax.axhline(0.0, color=plotting.INK, linewidth=0.5)
        ax.set(xscale="log", xlabel="speed", ylabel="mean loss of the block", ylim=(-5.0, 8.0))
        ax.set_yscale("symlog", linthresh=0.05)
        ax.set_yticks((-1.0, -0.1, 0.0, 0.1, 1.0), ("$-1$", "$-0.1$", "0", "0.1", "1"))
        plain_ticks(ax, (0.2, 0.3, 0.4, 0.5, 0.7, 1.0, 1.5))
        ax.legend()
    plotting.save(ax, FOLDER / "statistics_block.png")


FIGURES = {"one_energy_strong": one_energy, "block": block}


def main() -> None:
    """Draw some figures, or all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("figures", nargs="*", choices=[*FIGURES, []], default=[])
    options = parser.parse_args()
    for name in options.figures or FIGURES:
        keep_numbers(name, FIGURES[name]())


if __name__ == "__main__":
    main()
