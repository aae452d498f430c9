"""Every reported quantity against an independent solver: SciPy, and no shared code."""

import numpy as np
import pytest

import reference
import tribo
from tribo.accuracy.scales import KINDS
from tribo.integrators.methods import METHODS
from tribo.model.scene_file import scene_from

ACCURACY = 1e-8
AGREEMENT = 1e-7  # of the scale of each kind

POTENTIALS = {
    "coulomb": {"potential": "coulomb", "strength": 0.2},
    "morse": {"potential": "morse", "D": 0.4, "alpha": 1.6, "r0": 0.7},
    "lennard-jones": {"potential": "lennard-jones", "epsilon": 0.3, "sigma": 0.45},
}
RANGES = {
    "m1": (0.5, 3.0),
    "m2": (0.5, 4.0),
    "kappa": (0.5, 3.0),
    "length": (1.0, 2.0),
    "bar_length": (1.0, 3.0),
    "i2": (2.0, 6.0),
    "charge": (-1.0, 1.5),
}
DRIVES = (
    "forced",
    "free",
    {"kind": "free", "rigid": True},
    {"kind": "pulled", "stiffness": 0.6, "speed": 0.4},
    {"kind": "forced", "load": 0.01},
    {"kind": "free", "rigid": True, "load": 0.01},
)


def pick(rng, options):
    """One of the options."""
    return options[rng.integers(len(options))]


def parameters(rng, count: int) -> dict:
    """Some parameters, each for all asperites or one for each."""
    table = {}
    for name, (low, high) in RANGES.items():
        kind = rng.integers(3)
        if kind:
            values = rng.uniform(low, high, count)
            table[name] = values.tolist() if kind == 1 else float(values[0])
    return table


def random_surface(rng, name: str, place: tuple[float, float], speed: float) -> dict:
    """A row of one to three asperites with any drive, bars and start."""
    count = int(rng.integers(1, 4))
    facing = "down" if name == "upper" else "up"
    rest = 0.0 if name == "upper" else np.pi
    bars = pick(rng, ("clamped", "clamped", "free"))
    initial = {"theta": (rest + rng.uniform(-0.3, 0.3, count)).tolist()}
    if rng.random() < 0.5:
        initial |= {"omega": float(rng.uniform(-0.3, 0.3)), "phi": float(rng.uniform(-0.2, 0.2))}
        initial |= {"nu": float(rng.uniform(-0.1, 0.1))}
    return {
        "name": name,
        "facing": facing,
        "bob": list(place),
        "velocity": [speed, float(pick(rng, (0.0, 0.02)))],
        "shape": [count, 1],
        "spacing": [float(rng.uniform(0.8, 1.5)), 0.0],
        "heights": rng.uniform(-0.1, 0.1, count).tolist(),
        "drive": pick(rng, DRIVES),
        "bars": bars,
        "asperite": parameters(rng, count),
        "initial": initial,
    }


def random_scene(seed: int, potential: str) -> dict:
    """Two surfaces that meet."""
    rng = np.random.default_rng(seed)
    gap = float(rng.uniform(0.5, 0.8))
    return {
        "duration": 9.0,
        "interaction": dict(POTENTIALS[potential]),
        "surface": [
            random_surface(rng, "upper", (-2.5, gap), float(rng.uniform(0.3, 0.8))),
            random_surface(rng, "lower", (0.0, 0.0), float(pick(rng, (0.0, -0.1)))),
        ],
        "output": {"samples": 3},
    }


def rich_scene(seed: int) -> dict:
    """Grids with springs, baths, a field, a cutoff and a period, all at once."""
    rng = np.random.default_rng(seed)
    scene = random_scene(seed, "morse")
    scene["interaction"] |= {"cutoff": 2.6, "at_cutoff": "switch"}
    scene["periodic"] = {"x": 8.0, "z": 6.0}
    scene["field"] = [{"on": ["upper"], "kind": "corrugation", "amplitude": 0.05, "period": 1.1}]
    for surface in scene["surface"]:
        count = surface["shape"][0]
        surface["shape"] = [count, 2]
        surface["spacing"][1] = 0.9
        for table in (surface["asperite"], surface["initial"]):
            table |= {k: v * 2 for k, v in table.items() if isinstance(v, list)}
        surface["heights"] = surface["heights"] * 2
        surface["springs"] = {"stiffness": float(rng.uniform(0.5, 4.0)), "wrap": seed % 2 == 0}
        surface["bath"] = {
            "oscillators": [
                {"mass": float(rng.uniform(0.05, 0.3)), "frequency": float(rng.uniform(0.5, 4.0))}
                for _ in range(2)
            ]
        }
    return scene


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


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
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
