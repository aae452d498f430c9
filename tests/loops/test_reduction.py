"""What is absent, empty or out of reach leaves the paper's pair as it is, bit for bit."""

from dataclasses import replace

import numpy as np
import pytest

import tribo
from tribo import paper

CASES = ("A", "C")


def series_of(result: tribo.Result, asperite: int = 0) -> dict[str, np.ndarray]:
    """Every series of one asperite of each surface."""
    return {
        f"{name}.{quantity}": values[:, asperite]
        for name, table in result.ledger.surfaces.items()
        for quantity, values in table.items()
    }


def assert_same(one: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> None:
    """Equal to the last bit, series by series."""
    assert one.keys() == other.keys()
    for name, values in one.items():
        assert np.array_equal(values, other[name]), name


def run(scene: tribo.Scene, method: str) -> tribo.Result:
    """By the adaptive method, or in equal steps."""
    if method == "dop853":
        return tribo.simulate(scene, accuracy=1e-8)
    return tribo.simulate(scene, method=method, step=0.05)


EMPTY = {
    "a grid of one": {"shape": (1, 1), "spacing": (2.0, 3.0)},
    "springs of zero stiffness": {"springs": tribo.Springs(0.0, wrap=True)},
    "a bath of no oscillators": {"bath": {"oscillators": []}},
    "a reservoir that does not damp": {"langevin": tribo.Langevin(gamma=0.0, temperature=2.0)},
    "heights of zero": {"heights": [0.0]},
}


@pytest.mark.parametrize("method", ["dop853", "midpoint"])
@pytest.mark.parametrize("case", CASES)
def test_empty_effects_are_the_bare_scene(case, method):
    """Each empty effect, and all of them together."""
    scene = replace(paper.scene(case), output=tribo.Output(samples=9))
    bare = series_of(run(scene, method))
    everything = {key: value for effect in EMPTY.values() for key, value in effect.items()}
    for effect in (*EMPTY.values(), everything):
        surfaces = tuple(replace(surface, **effect) for surface in scene.surfaces)
        changed = replace(scene, surfaces=surfaces)
        assert changed.effects == scene.effects
        assert_same(bare, series_of(run(changed, method)))


def pairs_in_a_row(n: int) -> tuple[tribo.Scene, tribo.Scene]:
    """One pair with a cutoff, and n of them displaced in z by more than it."""
    cutoff = tribo.Morse(0.5, 2.0, 0.6).with_cutoff(3.0)
    single = replace(
        paper.scene("A"),
        interactions=(tribo.Interaction(cutoff),),
        duration=26.0,
        output=tribo.Output(samples=5),
    )
    many = replace(
        single,
        surfaces=tuple(
            replace(surface, shape=(1, n), spacing=(0.0, 4.0)) for surface in single.surfaces
        ),
    )
    return single, many


@pytest.mark.parametrize("method", ["midpoint", "verlet", "kahan-li-6"])
def test_pairs_out_of_each_others_reach(method):
    """In equal steps, each of n pairs is the single pair, to the last bit."""
    n = 5
    single, many = pairs_in_a_row(n)
    alone, together = run(single, method), run(many, method)
    assert np.max(np.abs(alone["upper"].delta_e_int)) > 1e-3
    for asperite in range(n):
        assert_same(series_of(alone), series_of(together, asperite))


def test_pairs_out_of_each_others_reach_with_chosen_steps():
    """The surfaces as wholes weigh on the choice of steps: then it is so within the estimates."""
    single, many = pairs_in_a_row(3)
    alone, together = run(single, "dop853"), run(many, "dop853")
    bounds = {k: alone.error_estimate[k] + together.error_estimate[k] for k in alone.error_estimate}
    for asperite in range(3):
        other = series_of(together, asperite)
        for name, values in series_of(alone).items():
            assert np.max(np.abs(values - other[name])) <= bounds[name.partition(".")[2]], name
