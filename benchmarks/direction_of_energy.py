"""Which way the energy goes in the paper's cases: theorems without approximations.

    python benchmarks/direction_of_energy.py --members 1000000

The figures and their numbers are written to docs/measured/; with 10,000 members they take seconds.
`benchmarks/weak_coupling.py` draws the others of docs/studies/direction_of_energy.md.
"""

import argparse
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.special import expit

import tribo
from tribo import paper, plotting
from tribo.plotting.marks import note
from tribo.plotting.style import CYCLE, NOTE_SIZE

FOLDER = Path(__file__).resolve().parents[1] / "docs" / "measured"
NUMBERS = FOLDER / "statistics.json"
TEMPERATURES = (0.5, 1.0, 3.0)
COLOURS = CYCLE[:3]
GAINS = ["upper.delta_e_int", "lower.delta_e_int"]
SEED = 20


def encounter(case: str) -> tribo.Scene:
    """A case of the paper, run from -D to +D."""
    numerics = tribo.Numerics(accuracy=1e-6)
    return replace(paper.scene(case), duration=40.0, numerics=numerics)


def gain_of(data) -> np.ndarray:
    """The energy that the pair gains, (members,)."""
    return sum(data[name].values[:, 0] for name in GAINS)


def canonical(scene: tribo.Scene, temperature: float, members: int, seed: int = SEED):
    """Gains of members that start at a temperature."""
    vary = {"*.swing_state": tribo.Canonical(temperature)}
    return gain_of(tribo.ensemble(scene, members, vary, seed=seed, keep=GAINS))


def slope_of(x: np.ndarray) -> tuple[float, float]:
    """The slope c of ln P(x) / P(-x) = c x by maximum likelihood, and its standard error.

    Given the magnitude, the sign of x is + with the probability 1 / (1 + exp(-c |x|)).
    """
    slope, size = 1.0, np.abs(x)
    for _ in range(20):
        p = expit(slope * size)
        curvature = np.sum(size**2 * p * (1.0 - p))
        slope += np.sum(size * ((x > 0.0) - p)) / curvature
    return slope, curvature**-0.5


def ratios(x: np.ndarray, bins: int = 24) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """|x|, ln P(x) / P(-x) and its standard error, in bins with enough members of both signs."""
    edges = np.linspace(0.0, min(6.0, np.max(-x, initial=0.0)), bins + 1)
    up, down = (np.histogram(sign * x, edges)[0] for sign in (1.0, -1.0))
    known = (up >= 10) & (down >= 10)
    middle = 0.5 * (edges[1:] + edges[:-1])[known]
    return middle, np.log(up[known] / down[known]), np.sqrt(1.0 / up[known] + 1.0 / down[known])


def reversed_run() -> float:
    """The gain of case A from the state that its run from rest ends in, with all rates reversed."""
    scene = replace(encounter("A"), numerics=tribo.Numerics(accuracy=1e-10))
    end = tribo.simulate(scene)
    surfaces = [
        replace(
            s,
            initial=tribo.Initial(
                swing=-(end[s.name].theta[-1, 0] - s.rest), omega=end[s.name].omega[-1, 0]
            ),
        )
        for s in scene.surfaces
    ]
    back = tribo.simulate(replace(scene, surfaces=tuple(surfaces)))
    return sum(back[s.name].delta_e_int[-1, 0] for s in surfaces)


def detailed(members: int) -> dict:
    """Figure 1: ln P(w) / P(-w) is w / T."""
    found, returned = {}, reversed_run()
    with plotting.style():
        ax = plotting.axes(plotting.WIDE, 0.62 * plotting.WIDE)
        line = np.array([0.0, 6.0])
        ax.plot(line, line, color=plotting.INK, linewidth=0.8, label="slope 1")
        for case, marker in (("A", "o"), ("B", "s")):
            for temperature, colour in zip(TEMPERATURES, COLOURS, strict=True):
                gain = canonical(encounter(case), temperature, members)
                x = gain / temperature
                slope, error = slope_of(x)
                both = (x < 0.0) - np.where(x > 0.0, np.exp(-x), 0.0)
                average = tribo.exponential_average(gain, temperature)
                found[f"{case}, T = {temperature:g}"] = {
                    "slope": slope,
                    "standard_error": error,
                    "mean_gain": float(gain.mean()),
                    "share_that_cools": float(np.mean(x < 0.0)),
                    "predicted_share": float(np.mean(np.where(x > 0.0, np.exp(-x), 0.0))),
                    "difference_in_standard_errors": float(
                        both.mean() / both.std() * np.sqrt(x.size)
                    ),
                    "exponential_average": str(average),
                    "trusted": average.trusted,
                }
                middle, ratio, width = ratios(x)
                look = {"color": colour, "marker": marker, "markersize": 3, "linestyle": "none"}
                label = f"{case}, $T={temperature:g}$: {slope:.4f} $\\pm$ {error:.4f}"
                ax.errorbar(middle, ratio, width, elinewidth=0.6, label=label, **look)
        found["reversed run of case A"] = returned
        ax.axvline(-returned, color=plotting.INK, linewidth=0.6, linestyle=":")
        note(ax, (-returned, 5.8), "reversed run, $T=1$", (4, 0), ha="left", fontsize=NOTE_SIZE)
        ax.set(xlabel="$|w|/T$", ylabel="$\\ln P(w)/P(-w)$", xlim=(0, 6), ylim=(-0.3, 6.3))
        ax.legend(loc="lower right")
    plotting.save(ax, FOLDER / "statistics_detailed.png")
    return found


def integral(members: int) -> dict:
    """Figure 2: the mean of exp(-w / T) at every recorded time, with the bobs in contact or not."""
    members = max(1000, members // 10)
    found = {}
    with plotting.style():
        ax = plotting.axes()
        for case, colour in zip("AB", COLOURS, strict=False):
            scene = replace(encounter(case), output=tribo.Output(samples=41))
            vary = {"*.swing_state": tribo.Canonical(1.0)}
            data = tribo.ensemble(scene, members, vary, seed=SEED, keep=GAINS, at="samples")
            gain = sum(data[name].values[:, :, 0] for name in GAINS)
            each = [tribo.exponential_average(gain[:, k], 1.0) for k in range(1, gain.shape[1])]
            mean = np.array([one.mean for one in each])
            half = np.array([one.half_width for one in each])
            t = data["time"].values[1:]
            ax.errorbar(t, mean, half, color=colour, marker=".", linestyle="none", label=case)
            outside = np.abs(mean - 1.0) > half
            found[case] = {
                "members": members,
                "largest_deviation": float(np.max(np.abs(mean - 1.0))),
                "largest_half_width": float(half.max()),
                "times_outside_their_interval": int(outside.sum()),
                "times": int(outside.size),
                "mean_gain_at_the_end": float(gain[:, -1].mean()),
            }
        ax.axhline(1.0, color=plotting.INK, linewidth=0.6)
        ax.set(xlabel="$t$", ylabel="$\\langle e^{-w/T}\\rangle$")
        ax.legend(loc="lower left")
    plotting.save(ax, FOLDER / "statistics_integral.png")
    return found


def tuning(members: int) -> dict:
    """Figure 3: how finely a start must be tuned to cool."""
    found = {}
    with plotting.style():
        ax = plotting.axes()
        fraction = np.geomspace(1e-3, 1.0, 200)
        ax.loglog(fraction, fraction**2, color=plotting.INK, linewidth=0.8, label="bound $(ε/E)^2$")
        for energy, colour in zip((1.0, 1.5, 3.0), COLOURS, strict=True):
            keep = ["upper.swing_energy", "lower.swing_energy"]
            vary = {"*.swing_state": tribo.EnergyBall(energy)}
            data = tribo.ensemble(encounter("A"), members, vary, seed=SEED, keep=keep)
            end = np.sort(sum(data[name].values[:, 0] for name in keep)) / energy
            share = np.searchsorted(end, fraction) / end.size
            ax.loglog(fraction, np.where(share > 0, share, np.nan), color=colour, label=f"{energy}")
            bound = fraction**2
            excess = (share - bound) / np.sqrt(bound * (1.0 - bound) / members + 1e-30)
            tenth = float(np.searchsorted(end, 0.1) / end.size)
            found[f"E = {energy:g}"] = {
                "share_below_a_tenth": tenth,
                "bound": 0.01,
                "largest_excess_in_standard_errors": float(np.max(excess[:-1])),
            }
        ax.set(xlabel="$ε/E$", ylabel="share that ends with $e_1+e_2\\leq ε$")
        ax.legend(title="case A, $E$")
    plotting.save(ax, FOLDER / "statistics_tuning.png")
    return found


def weak_gains(strength: float, members: int) -> np.ndarray:
    """Gains w at T = 1 from the same starts with both signs of the strength, (2, members)."""
    both = []
    for sign in (1.0, -1.0):
        potential = tribo.Coulomb(sign * strength)
        scene = replace(encounter("B"), interactions=(tribo.Interaction(potential),))
        scene = replace(scene, numerics=tribo.Numerics(accuracy=1e-8))
        both.append(canonical(scene, 1.0, members))
    return np.array(both)


def dissipation_ratio(gains: np.ndarray, central: bool) -> tuple[float, float]:
    """2 T <w> over the variance of w, or over its mean square, and the standard error.

    What is odd in the strength cancels between the rows, which have both signs.
    """
    centre = gains.mean(axis=1, keepdims=True) if central else 0.0
    gain, square = gains.mean(axis=0), np.mean((gains - centre) ** 2, axis=0)
    ratio = 2.0 * gain.mean() / square.mean()
    spread = np.std(2.0 * gain - ratio * square)
    return float(ratio), float(spread / np.sqrt(gain.size) / square.mean())


def dissipation(members: int) -> dict:
    """Figure 8: the mean gain over half of its variance divided by T, as coupling falls."""
    members = max(2000, members // 20)
    strengths = 0.4 * 0.5 ** np.arange(8)
    kinds = {"variance": True, "mean square": False}
    weak = [weak_gains(float(strength), members) for strength in strengths]
    paper_gains = {case: canonical(encounter(case), 1.0, members)[None] for case in "AB"}
    found: dict = {"strength": strengths.tolist(), "members": members}
    with plotting.style():
        ax = plotting.axes()
        for (kind, central), fill in zip(kinds.items(), ("full", "none"), strict=True):
            ratio, error = np.array([dissipation_ratio(gains, central) for gains in weak]).T
            own = {case: dissipation_ratio(w, central) for case, w in paper_gains.items()}
            found[kind] = {"ratio": ratio.tolist(), "standard_error": error.tolist(), "paper": own}
            look = {"fillstyle": fill, "markersize": 4}
            label, width = f"both signs, {kind}", 1.96 * error
            ax.errorbar(strengths, ratio, width, color=COLOURS[0], marker="o", label=label, **look)
            for (case, (value, wide)), colour in zip(own.items(), COLOURS[1:], strict=True):
                label = f"case {case}, {kind}"
                style = {"fmt": "s", "color": colour} | look
                ax.errorbar(0.2, value, 1.96 * wide, label=label, **style)
        ax.axhline(1.0, color=plotting.INK, linewidth=0.5)
        ax.set(xscale="log", xlabel="strength", ylabel="$2T\\langle w\\rangle$ / spread")
        ax.legend()
    plotting.save(ax, FOLDER / "statistics_dissipation.png")
    return found


FIGURES = {
    "detailed": detailed,
    "integral": integral,
    "tuning": tuning,
    "dissipation": dissipation,
}


def plain_ticks(ax, places: tuple[float, ...]) -> None:
    """Label a logarithmic axis of x at some places, without powers of ten."""
    ax.set_xticks(places, [f"{x:g}" for x in places])
    ax.set_xticks([], minor=True)


def keep_numbers(name: str, found: dict) -> None:
    """Write the numbers of a figure beside those of the others."""
    known = json.loads(NUMBERS.read_text()) if NUMBERS.exists() else {}
    known[name] = found
    NUMBERS.write_text(json.dumps(known, indent=1, sort_keys=True) + "\n")
    print(json.dumps({name: found}, indent=1))


def main() -> None:
    """Draw some figures, or all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("figures", nargs="*", choices=[*FIGURES, []], default=[])
    parser.add_argument("--members", type=int, default=10_000)
    options = parser.parse_args()
    for name in options.figures or FIGURES:
        keep_numbers(name, {"members": options.members} | FIGURES[name](options.members))


if __name__ == "__main__":
    main()
