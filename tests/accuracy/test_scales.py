"""The scales of tolerances are those of the ledger, where bars turn too."""

from dataclasses import replace

import numpy as np
import pytest

import tribo
from tribo import paper
from tribo.accuracy.scales import first_guess, reported_scales, tolerance_scales
from tribo.run.layout import lay_out
from tribo.run.ledger import assemble

TURNING = {
    "a free bar": {"bars": "free", "initial": tribo.Initial(theta=0.4, phi=-0.7, nu=0.9)},
    "a clamped bar that turns": {"initial": tribo.Initial(theta=0.4, phi=1.5, nu=0.9)},
    "a clamped bar at rest": {},
}


def scene(bars: str) -> tribo.Scene:
    """Case A with another upper bar."""
    case = paper.scene("A")
    upper, lower = case.surfaces
    output = tribo.Output(samples=17)
    return replace(
        case, surfaces=(replace(upper, **TURNING[bars]), lower), duration=8.0, output=output
    )


@pytest.mark.parametrize("bars", TURNING)
def test_tolerance_scales_are_those_of_the_ledger(bars):
    """Rate, torsion and internal energy as the ledger of the same samples has them."""
    simulation = tribo.prepare(scene(bars), method="dop853", step=None, accuracy=1e-6)
    samples, layout = simulation.finest.samples, simulation.layout
    scales, books = tolerance_scales(layout, samples), assemble(layout, samples)
    assert scales.rate == reported_scales(layout, books).rate
    torsion = [
        np.max(np.abs(books.surfaces[s.name]["theta"] - s.rest - books.surfaces[s.name]["phi"]))
        for s in layout.scene.surfaces
    ]
    assert scales.twist == pytest.approx(max(torsion), rel=1e-14)
    change = max(np.max(np.abs(series)) for series in books.series("delta_e_int"))
    works = max(np.max(np.abs(series)) for name in ("w1", "w2") for series in books.series(name))
    assert change <= scales.energy <= 3.0 * max(change, works)


@pytest.mark.parametrize("bars", TURNING)
def test_the_first_guess_of_the_rate(bars):
    """At least the rates of the scene's start, those of bars among them."""
    start = TURNING[bars].get("initial", tribo.Initial())
    assert first_guess(lay_out(scene(bars))).rate >= (start.nu or 0.0)
