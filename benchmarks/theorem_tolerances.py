"""From which step or accuracy on methods fulfil the integral theorem.

    python benchmarks/theorem_tolerances.py

The first part prints by how much each method changes the volume of phase space for a pair in
contact, the determinant of the flow's derivative minus 1.  The second prints the mean of
exp(-w / T) of pairs that pass at a distance, and its difference from that of a collocation from the
same starts: the error of the method, almost without noise.  The tests in tests/ensembles/ and
tests/integrators/ run the same scenes.
"""

import argparse
import sys
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
from direction_of_energy import keep_numbers

import tribo

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from support.flow import volume_ratio
from support.gibbs import PASSING, deviation, gain, rows

COARSE = [{"step": 0.1}, {"step": 0.05}]
REQUESTS = [{"accuracy": 0.1}, {"accuracy": 0.01}]
VOLUMES = {
    **dict.fromkeys(("midpoint", "rk4"), COARSE + REQUESTS),
    **dict.fromkeys(("gauss-8", "verlet", "kahan-li-6", "kahan-li-8", "blanes-moan-6"), COARSE),
    **dict.fromkeys(("dop853", "rkn8", "rkn12", "gauss-radau-15"), REQUESTS),
}
MEANS = (
    ("gauss-8", {"step": 0.1}),
    ("midpoint", {"step": 0.2}),
    ("midpoint", {"step": 0.1}),
    ("midpoint", {"step": 0.05}),
    ("midpoint", {"accuracy": 0.1}),
    ("rk4", {"step": 0.2}),
    ("rk4", {"step": 0.1}),
    ("rk4", {"accuracy": 0.1}),
    ("dop853", {"accuracy": 0.1}),
    ("verlet", {"step": 0.2}),
)
TEMPERATURE, SEED = 1.0, 2
MEMBERS, MEMBERS_WITH_ACCURACY = 8192, 2048


def name_of(method: str, setting: dict) -> str:
    """A method and its step or accuracy."""
    kind, value = next(iter(setting.items()))
    return f"{method}, {kind} {value:g}"


def in_contact() -> tribo.Scene:
    """A pair that starts in contact and swings."""
    scene = rows((1, 1))
    starts = tribo.Initial(swing=0.3, omega=-0.4), tribo.Initial(swing=-0.2, omega=0.1)
    surfaces = [replace(s, initial=i) for s, i in zip(scene.surfaces, starts, strict=True)]
    return replace(scene, surfaces=surfaces, duration=2.0, output=tribo.Output(samples=2))


def volumes() -> dict:
    """The determinant of the flow's derivative, minus 1."""
    found, scene = {}, in_contact()
    for method, settings in VOLUMES.items():
        for setting in settings:
            ratio = volume_ratio(scene, method=method, **setting)
            found[name_of(method, setting)] = ratio - 1.0
    return found


def means() -> dict:
    """Means of exp(-w / T), and their differences from those of the first setting."""
    found, exact = {}, None
    for method, setting in MEANS:
        members = MEMBERS if "step" in setting else MEMBERS_WITH_ACCURACY
        work = gain(PASSING, members, SEED, TEMPERATURE, method=method, **setting)
        weights = np.exp(-work / TEMPERATURE)
        exact = weights if exact is None else exact
        difference = weights - exact[:members]
        found[name_of(method, setting)] = {
            "mean": float(weights.mean()),
            "standard_errors_from_1": deviation(weights),
            "difference": float(difference.mean()),
            "standard_error": float(difference.std() / np.sqrt(members)),
            "members": members,
        }
    return found


PARTS = {"volumes": volumes, "means": means}


def main() -> None:
    """Print some parts, or all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("parts", nargs="*", choices=[*PARTS, []], default=[])
    options = parser.parse_args()
    warnings.simplefilter("ignore", tribo.TriboWarning)  # coarse steps
    for name in options.parts or PARTS:
        keep_numbers(f"tolerances: {name}", PARTS[name]())


if __name__ == "__main__":
    main()
