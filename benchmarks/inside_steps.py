"""The error of the collocation polynomial inside the steps of a pair, where samples could be read.

    python benchmarks/inside_steps.py

Steps are those of a run without samples between its ends.  At their nodes the polynomial takes the
accelerations of a far more accurate run, so that its error is that of interpolation alone.
"""

from dataclasses import replace

import numpy as np
from numpy.polynomial import polynomial

import tribo
from tribo import paper
from tribo.integrators.tableaux import RADAU_15
from tribo.loops.pair import PairLoop

NODES = RADAU_15.c
INSIDE = np.linspace(0.05, 0.95, 19)


def ends_of_steps(scene: tribo.Scene, accuracy: float) -> np.ndarray:
    """The times at which the steps of the run that is delivered end, and 0."""
    simulation = tribo.prepare(scene, accuracy=accuracy, method="gauss-radau-15")
    pair = simulation.integrator.pair
    loop = PairLoop(pair, pair.beginning(simulation.plan.tuned.fine), simulation.layout.start)
    columns, ends = loop.room(3), [0.0]
    while ends[-1] < scene.duration:
        loop.advance(np.array([0.0, scene.duration]), columns, 1)
        ends.append(float(loop.clocks["t"][0]))
    return np.unique(ends)


def angular_accelerations(scene: tribo.Scene, result: tribo.Result) -> list[np.ndarray]:
    """Those of both pendulums, for bars that are clamped at rest."""
    found = []
    for surface in scene.surfaces:
        table, a = result[surface.name], surface.asperite
        arm = (
            a.length if isinstance(surface.drive, tribo.Forced) else a.length * a.m2 / (a.m1 + a.m2)
        )
        theta = table.theta[:, 0]
        torque = arm * (table.f1_x[:, 0] * np.cos(theta) + table.f1_y[:, 0] * np.sin(theta))
        reduced = a.m1 * a.m2 / (a.m1 + a.m2)
        found.append((torque - a.kappa * (theta - surface.rest)) / (reduced * a.length**2))
    return found


def error_inside(scene: tribo.Scene, accuracy: float) -> tuple[int, float]:
    """The number of steps, and the largest error of omega in them relative to its scale."""
    ends = ends_of_steps(replace(scene, output=tribo.Output(samples=2)), accuracy)
    h = np.diff(ends)[:, None]
    places = ends[:-1, None] + h * np.append(NODES, INSIDE)
    times = np.unique(np.append(places, [0.0, scene.duration]).clip(0.0, scene.duration))
    output = tribo.Output(times=times, series=("forces",))
    result = tribo.simulate(replace(scene, output=output), accuracy=3e-12, method="gauss-radau-15")
    at, worst, scale = np.searchsorted(times, places.clip(0.0, times[-1])), 0.0, 0.0
    for surface, alpha in zip(scene.surfaces, angular_accelerations(scene, result), strict=True):
        omega, n = result[surface.name].omega[:, 0], NODES.size
        scale = max(scale, np.abs(omega).max())
        for row, length in zip(at, h[:, 0], strict=True):
            fitted = polynomial.polyfit(NODES, alpha[row[:n]], n - 1)
            change = length * polynomial.polyval(INSIDE, polynomial.polyint(fitted))
            worst = max(worst, np.abs(omega[row[0]] + change - omega[row[n:]]).max())
    return ends.size - 1, worst / scale


def main() -> None:
    """Print a line for each case and accuracy."""
    print("case  accuracy  steps  error of omega inside them")
    for letter in "AB":
        for accuracy in (1e-4, 1e-6, 1e-8, 1e-10):
            steps, error = error_inside(paper.scene(letter), accuracy)
            print(f"{letter:<5} {accuracy:>8.0e} {steps:>6} {error:>10.1e}")


if __name__ == "__main__":
    main()
