"""Error estimates on random scenes: true error <= estimate <= request.

The method is chosen by the model of costs.  The true values are those of a method of another
family at a thousandth of the request; their own error estimates are subtracted from the error.
"""

from statistics import median

import numpy as np
import pytest

import tribo
from support.random_scenes import random_scene, rich_scene
from tribo.accuracy import scales as acc
from tribo.model.scene_file import scene_from
from tribo.run.layout import lay_out

ACCURACIES = (1e-3, 1e-5, 1e-7, 1e-9, 1e-11)
KINDS = ("coulomb", "morse", "lennard-jones", "everything")
SAMPLES = (33, 9, 129, 401)
# Scenes of each kind, in the default set and in the slow set.
FEW, MANY = 12, 60
# Errors below this fraction of the request count as this: no estimate need resolve them.
RESOLVED = 1e-3
# The median ratio of estimate to error, of few scenes and of many.
MEDIAN_OF_FEW, MEDIAN_OF_MANY = 100.0, 30.0


def scene_of(kind: str, seed: int) -> tribo.Scene:
    """Random drives, bars, starts and parameters; or every effect at once."""
    table = rich_scene(seed) if kind == "everything" else random_scene(seed, kind)
    return scene_from(table | {"output": {"samples": SAMPLES[seed % len(SAMPLES)]}})


def other_method(kind: str, method: str) -> str:
    """One of another family; one of short steps where potentials are switched off."""
    if kind == "everything":
        return "rkn8" if method == "dop853" else "dop853"
    return "rkn12" if method == "gauss-radau-15" else "gauss-radau-15"


def judged(kind: str, seed: int) -> list[float]:
    """Estimate over error of every quantity of a scene; fails if an estimate is too small."""
    scene = scene_of(kind, seed)
    wanted = ACCURACIES[seed % len(ACCURACIES)]
    result = tribo.simulate(scene, accuracy=wanted)
    other = other_method(kind, result.method)
    truth = tribo.simulate(scene, accuracy=max(1e-3 * wanted, 1e-13), method=other)
    assert result.status == truth.status == "completed"
    scales = acc.reported_scales(lay_out(scene), truth.ledger)
    ratios = []
    for name, bound in result.error_estimate.items():
        if not result.met:  # then a note must say so
            assert any("out of reach" in note for note in result.notes)
        else:
            assert bound <= wanted * scales.of(acc.kind_of(name)) * (1.0 + 1e-6), name
        pairs = zip(result.ledger.series(name), truth.ledger.series(name), strict=True)
        error = max(float(np.max(np.abs(one - other))) for one, other in pairs)
        unknown = truth.error_estimate[name]
        assert error <= bound + unknown, (name, wanted, result.method, error, bound, unknown)
        least = RESOLVED * wanted * scales.of(acc.kind_of(name))
        if bound > 0.0 and least > 0.0:
            ratios.append(bound / max(error, least))
    return ratios


@pytest.mark.parametrize("kind", KINDS)
def test_error_bars(kind):
    """A dozen scenes of one kind."""
    ratios = [ratio for seed in range(FEW) for ratio in judged(kind, 100 + seed)]
    assert median(ratios) <= MEDIAN_OF_FEW


@pytest.mark.slow
def test_error_bars_of_hundreds_of_scenes():
    """No estimate is too small, and half of them are at most 30 times the error."""
    seeds = range(200, 200 + MANY)
    ratios = [ratio for kind in KINDS for seed in seeds for ratio in judged(kind, seed)]
    assert median(ratios) <= MEDIAN_OF_MANY
