"""Every reported quantity against an independent solver: SciPy, and no shared code."""

import numpy as np
import pytest

import tribo
from support import reference
from support.random_scenes import POTENTIALS, random_scene, rich_scene
from tribo.accuracy.scales import KINDS
from tribo.integrators.methods import METHODS
from tribo.model.scene_file import scene_from

ACCURACY = 1e-8
AGREEMENT = 1e-7  # of the scale of each kind


def assert_agrees(scene: dict, method: str | None = None) -> None:
    """Surfaces, blocks and system, every quantity that either reports."""
    end = tribo.simulate(scene_from(scene), accuracy=ACCURACY, method=method).end
    truth = reference.solve(scene)
    assert end["status"] == "completed"
    for part in ("surfaces", "blocks"):
        assert end[part].keys() == truth[part].keys()
        for name, table in truth[part].items():
            assert end[part][name].keys() == table.keys()
            for quantity, values in table.items():
                compare(quantity, end[part][name][quantity], values, truth["scales"])
    for quantity, value in truth["system"].items():
        compare(quantity, end["system"][quantity], value, truth["scales"])


def compare(quantity: str, ours, theirs, scales: dict) -> None:
    """Within the agreement asked for, on the scale of the quantity's kind."""
    scale = scales[KINDS[quantity]]
    assert np.max(np.abs(np.subtract(ours, theirs))) <= AGREEMENT * scale, quantity


@pytest.mark.parametrize("potential", POTENTIALS)
@pytest.mark.parametrize("seed", range(6))
def test_random_scenes(seed, potential):
    """Up to 3 + 3 asperites, all drives, bars and starts."""
    assert_agrees(random_scene(seed, potential))


@pytest.mark.parametrize("seed", range(3))
def test_scenes_with_everything(seed):
    """Up to 6 + 6 asperites with every effect at once."""
    assert_agrees(rich_scene(seed))


def scene_of_species(seed: int) -> dict:
    """Rich, with two species of bobs, and contact among the bobs of each surface as well."""
    scene = rich_scene(seed)
    for surface in scene["surface"]:
        count = surface["shape"][0] * surface["shape"][1]
        surface["species"] = ["A" if i % 3 else "B" for i in range(count)]
    ending = {"cutoff": 2.6, "at_cutoff": "switch"}
    between, weak = {"between": ["lower", "upper"]}, dict(POTENTIALS["lennard-jones"]) | ending
    scene["interaction"] = [
        scene["interaction"] | between | {"species": ["A", "A"]},
        weak | between | {"species": ["A", "B"]},
        weak | {"epsilon": 0.02, "between": ["upper", "upper"]},
        dict(POTENTIALS["coulomb"])
        | {"strength": 0.05, "between": ["lower", "lower"], "species": ["B", "A"]}
        | ending,
    ]
    return scene


@pytest.mark.slow  # four interactions in one loop take a minute to compile
@pytest.mark.parametrize("seed", [0, 1])
def test_species_and_contact_within_a_surface(seed):
    """Each pair of bobs by its own potential; contact within is internal to the surface."""
    assert_agrees(scene_of_species(seed))


def test_contact_within_alone():
    """A forced pair of rows without springs or baths, whose own bobs push each other."""
    scene = random_scene(3, "morse")
    for surface in scene["surface"]:
        surface |= {"shape": [3, 1], "spacing": [0.9, 0.0], "heights": [0.0, 0.05, -0.05]}
        surface |= {"asperite": {}, "initial": {}, "drive": "forced", "bars": "clamped"}
    inner = dict(POTENTIALS["coulomb"]) | {"strength": 0.02}
    scene["interaction"] = [scene["interaction"] | {"between": ["upper", "lower"]}] + [
        inner | {"between": [name, name]} for name in ("upper", "lower")
    ]
    assert_agrees(scene)


@pytest.mark.parametrize("method", [m.name for m in METHODS.values() if m.adaptive])
def test_methods_that_choose_their_steps(method):
    """Each of them, on a scene with every effect at once."""
    assert_agrees(rich_scene(1), method)
