"""Error bars that can be trusted: true error <= estimate <= request, on scenes at random.

The method is left to choose itself; the truth is that of another family, at a hundredth of the
accuracy.  What the truth does not know itself, by its own estimate, is taken off the error.
"""

from statistics import median

import numpy as np
import pytest

import tribo
from test_reference import random_scene, rich_scene
from tribo import accuracy as acc
from tribo.layout import laid_out
from tribo.scene_file import scene_from

ACCURACIES = (1e-3, 1e-5, 1e-7, 1e-9, 1e-11)
KINDS = ("coulomb", "morse", "lennard-jones", "everything")
FEW = 12  # scenes of each kind; the slow set has more
MANY = 50
GENEROUS = 300.0  # the median estimate of a kind is at most so many times the error


def scene_of(kind: str, seed: int) -> tribo.Scene:
    """Drives, bars, starts and parameters at random; or with every effect at once."""
    table = rich_scene(seed) if kind == "everything" else random_scene(seed, kind)
    return scene_from(table | {"output": {"samples": 33}})


def judged(kind: str, seed: int) -> list[float]:
    """Error over estimate of every quantity of one scene; complains about what is not honest."""
    scene = scene_of(kind, seed)
    wanted = ACCURACIES[seed % len(ACCURACIES)]
    result = tribo.simulate(scene, accuracy=wanted)
    other = "dop853" if result.method == "gauss-radau-15" else "gauss-radau-15"
    if kind == "everything" and result.method != "dop853":
        other = "dop853"  # its switch has kinks, for which short steps are better
    truth = tribo.simulate(scene, accuracy=max(0.01 * wanted, 1e-13), method=other)
    assert result.status == truth.status == "completed"
    scales = acc.reported_scales(laid_out(scene), truth.ledger)
    ratios = []
    for name, bound in result.error_estimate.items():
        if not result.met:  # then it must say so
            assert any("out of reach" in note for note in result.notes)
        else:
            assert bound <= wanted * scales.of(acc.kind_of(name)) * (1.0 + 1e-6), name
        pairs = zip(result.ledger.series(name), truth.ledger.series(name), strict=True)
        error = max(float(np.max(np.abs(one - other))) for one, other in pairs)
        unknown = truth.error_estimate[name]
        assert error <= bound + unknown, (name, wanted, result.method, error, bound, unknown)
        if error > 3.0 * unknown and bound > 0.0:
            ratios.append(bound / error)
    return ratios


@pytest.mark.parametrize("kind", KINDS)
def test_error_bars(kind):
    """A dozen scenes of each kind."""
    ratios = [ratio for seed in range(FEW) for ratio in judged(kind, 100 + seed)]
    assert median(ratios) <= GENEROUS


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_error_bars_of_two_hundred_scenes(kind):
    """Two hundred in all."""
    ratios = [ratio for seed in range(MANY) for ratio in judged(kind, 200 + seed)]
    assert median(ratios) <= GENEROUS
