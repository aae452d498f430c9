"""Every reported quantity against an independent solver, and the solver against closed forms."""

import math
from decimal import Decimal

import mpmath
import numpy as np
import pytest

import tribo
from support import reference
from support.random_scenes import (
    POTENTIALS,
    constrained_scene,
    driven,
    random_scene,
    rich_scene,
    rigid,
)
from support.scene_tables import scene_from
from support.verdicts import WITHOUT_REFERENCE
from tribo.accuracy.scales import scale_of
from tribo.integrators.methods import METHODS

ACCURACY = 1e-8
# Largest difference, in units of the accuracy and of the scale of each kind.
AGREEMENT = 10.0
pytestmark = pytest.mark.skipif(reference.compiler() is None, reason="there is no C compiler")


def assert_agrees(scene: dict, method: str | None = None, accuracy: float = ACCURACY) -> None:
    """Surfaces, blocks and system, every quantity that either reports."""
    end = tribo.simulate(scene_from(scene), accuracy=accuracy, method=method).end
    truth = reference.solve(scene).end
    assert end["status"] == "completed"
    for part in ("surfaces", "blocks"):
        assert end[part].keys() == truth[part].keys()
        for name, table in truth[part].items():
            assert end[part][name].keys() - set(WITHOUT_REFERENCE) == table.keys()
            for quantity, values in table.items():
                compare(quantity, end[part][name][quantity], values, truth["scales"], accuracy)
    for quantity, value in truth["system"].items():
        compare(quantity, end["system"][quantity], value, truth["scales"], accuracy)


# Random scenes of each kind; those after the third are in the slow set.
SEEDS = [0, 1, 2, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(3, 6))]


def compare(quantity: str, ours, theirs, scales: dict, accuracy: float) -> None:
    """Within the agreement asked for, on the scale of the quantity's kind."""
    bound = AGREEMENT * accuracy * scales[scale_of(quantity)]
    assert np.max(np.abs(np.subtract(ours, theirs))) <= bound, quantity


@pytest.mark.parametrize("potential", POTENTIALS)
@pytest.mark.parametrize("seed", SEEDS)
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


# Explicit or implicit; the other two are in the slow set.
ADAPTIVE = ["rkn8", "gauss-radau-15"]
ADAPTIVE += [pytest.param(m, marks=pytest.mark.slow) for m in ("dop853", "rkn12")]


@pytest.mark.parametrize("method", ADAPTIVE)
def test_methods_that_choose_their_steps(method):
    """Each of them, on a scene with every effect at once."""
    assert_agrees(rich_scene(1), method)


# One of each time loop, and one whose equations are implicit; the others are in the slow set.
FOR_ALL = ("verlet", "midpoint", "dop853", "gauss-radau-15")
SLOW = [pytest.param(m, marks=pytest.mark.slow) for m in METHODS if m not in FOR_ALL]


@pytest.mark.parametrize("method", [*FOR_ALL, *SLOW])
def test_driven_bars_and_rigid_asperites(method):
    """By each method; damped, on bars and on swings, where the method takes reservoirs."""
    scene = constrained_scene(1, damping=0.2)
    if "langevin" in METHODS[method].refuses:
        scene = constrained_scene(1)
    if "bath" in METHODS[method].refuses:
        for surface in scene["surface"]:
            del surface["bath"]
    assert_agrees(scene, method, ACCURACY if METHODS[method].order > 4 else 1e-5)


@pytest.mark.parametrize("seed", SEEDS)
def test_random_scenes_with_driven_bars(seed):
    """Bars of both surfaces are driven, free to turn or clamped; swings of one are damped."""
    scene = random_scene(seed, "coulomb")
    upper, lower = scene["surface"]
    scene["surface"] = [driven(upper, 0.3), driven(lower)]
    assert_agrees(scene)


@pytest.mark.parametrize("seed", SEEDS)
def test_random_scenes_with_rigid_asperites(seed):
    """Below any drive, and on driven bars, where nothing moves but uniformly."""
    scene = random_scene(seed, "coulomb")
    upper, lower = scene["surface"]
    scene["surface"] = [rigid(upper), rigid(driven(lower))]
    assert_agrees(scene)


# --- the solver -----------------------------------------------------------------------------------


def pair(interaction: dict, start: float, gap: float, duration: float, **asperite: float) -> dict:
    """One asperite that passes over another at a speed of 0.5."""
    surfaces = [
        {"name": "upper", "bob": [start, 0.0], "velocity": [0.5, 0.0], "asperite": asperite},
        {"name": "lower", "facing": "up", "bob": [0.0, -gap], "asperite": asperite},
    ]
    return {"duration": duration, "interaction": interaction, "surface": surfaces}


COULOMB = {"potential": "coulomb", "strength": 0.2}
ATTRACTIVE = COULOMB | {"strength": -0.2}
DEEP = {"potential": "morse", "D": 50.0, "alpha": 20.0, "r0": 0.3}
# Digits by other integrators in higher precision.
DIGITS = (
    (pair(COULOMB, -10.0, 0.0, 40.0), "theta", "0.261760416587400463"),
    (pair(DEEP, -10.0, 0.25, 40.0), "delta_e_int", "2.06392267"),
    (pair(ATTRACTIVE, -10.0, 0.0, 40.0, m1=5.0, m2=3.0, kappa=1.0), "delta_e_int", "1.62892284"),
    (pair(COULOMB, -5.0, 0.3, 20.0, kappa=1e4), "delta_e_int", "4.7557e-8"),
)


@pytest.mark.parametrize(("scene", "quantity", "digits"), DIGITS)
def test_known_digits(scene, quantity, digits):
    """All digits that are known of hard scenes."""
    solution = reference.solve(scene | {"output": {"samples": 2}})
    last_place = 10.0 ** Decimal(digits).as_tuple().exponent
    found = solution.surfaces["upper"][quantity][-1, 0]
    assert found == pytest.approx(float(digits), rel=1e-16, abs=last_place)
    assert solution.error[quantity] <= 1e-12 * abs(float(digits))


def scene_of_rare_effects() -> dict:
    """Effects that random scenes lack."""
    scene = rich_scene(2) | {"periodic": {}}
    for surface in scene["surface"]:
        surface["bars"] = "free"
        surface["springs"] = {"stiffness": 1.0, "pairs": [[0, 1]], "turned": 0.2}
        surface["bath"] = {"spectrum": "drude", "gamma": 0.2, "cutoff": 1.0, "n": 2}
        surface["bath"] |= {"torsional": [{"inertia": 0.7, "frequency": 1.3}]}
        surface["langevin"] = {"gamma": 0.1, "velocity": [0.1, -0.1]}
    scene["field"][0] |= {"velocity": [0.2, 0.0], "origin": [0.1, 0.0]}
    parts = [{"potential": "yukawa", "strength": 0.2, "screening": 1.1}]
    parts += [{"potential": "weeks-chandler-andersen", "epsilon": 0.2, "sigma": 0.6}]
    scene["interaction"] = {"potential": "scaled", "factor": 0.5}
    scene["interaction"]["of"] = {"potential": "sum", "of": parts}
    return scene


def assert_ledger_closes(solution, tolerance: float) -> None:
    """The identities between works, pseudoworks and energies, all of which are integrated."""
    scale = tolerance * solution.scales["total"]
    for name, table in solution.surfaces.items():
        block = solution.blocks[name]
        for one, other in (
            (table["w"] - table["w_ps"], table["delta_e_int"]),
            (table["w_ps"], table["delta_k_trans"]),
            (block["W_ps"], block["delta_K"]),
            (block["W"] - block["W_ps"], block["delta_E_int"]),
        ):
            assert np.max(np.abs(one - other)) <= scale
    system = solution.system
    assert np.max(np.abs(system["total_energy_change"] - system["applied_work"])) <= scale


def test_ledger_of_rare_effects_closes():
    """Reservoirs, moving fields, spectra, torsional baths, listed springs, sums of potentials."""
    assert_ledger_closes(reference.solve(scene_of_rare_effects()), 1e-14)


@pytest.mark.parametrize("seed", range(3))
def test_ledger_of_constraints_closes(seed):
    """The reaction f2 follows from the acceleration, and its power is integrated like any other."""
    assert_ledger_closes(reference.solve(constrained_scene(seed, damping=0.2)), 1e-14)


def alone(**settings) -> reference.Solution:
    """One asperite without contact."""
    table = {"name": "one", "drive": "bars"} | settings
    return reference.solve({"duration": 10.0, "surface": [table], "output": {"samples": 9}})


@pytest.mark.parametrize("gamma", [0.0, 0.4])
def test_pendulum_on_a_driven_bar(gamma):
    """theta'' = -(kappa theta + gamma theta') / (m1 length^2), and the bar moves uniformly."""
    langevin = {"gamma": gamma, "on": "swing"}
    solution = alone(velocity=[0.3, -0.2], initial={"swing": 0.7, "omega": 0.3}, langevin=langevin)
    table, t = solution.surfaces["one"], solution.t
    inertia = 1.0 * 2.0**2
    decay = gamma / (2.0 * inertia)
    frequency = np.sqrt(2.0 / inertia - decay**2)
    sine = (0.3 + decay * 0.7) / frequency
    swing = np.exp(-decay * t) * (0.7 * np.cos(frequency * t) + sine * np.sin(frequency * t))
    assert table["theta"][:, 0] == pytest.approx(swing, abs=1e-14)
    for name, speed in (("x_bar", 0.3), ("y_bar", -0.2)):
        assert np.ptp(table[name][:, 0] - speed * t) <= 1e-14
    assert_ledger_closes(solution, 1e-14)


def test_rigid_asperite_in_a_corrugation():
    """A point mass M: its energy is kept, and it turns where that is all potential."""
    amplitude, period, mass, speed = 0.3, 1.3, 3.0, 0.2
    surface = {"name": "one", "drive": "free", "velocity": [speed, 0.0]}
    surface |= {"asperite": {"kappa": math.inf}, "initial": {"swing": 0.4, "phi": 0.3}}
    start = 2.0 * math.sin(0.4) * 2.0 / 3.0  # the bob's x, where the field has its minimum
    field = {"on": ["one"], "kind": "corrugation", "amplitude": amplitude, "period": period}
    scene = {"surface": [surface], "field": [field | {"origin": [start, 0.0]}]}
    q = 2.0 * math.pi / period
    modulus = mass * speed**2 / (4.0 * amplitude)  # of (1 - cos q x) / 2 at the turning point
    quarter = float(mpmath.ellipk(modulus)) / (q * math.sqrt(amplitude / mass))
    scene |= {"duration": 4.0 * quarter, "output": {"samples": 5}}
    table = reference.solve(scene).surfaces["one"]
    farthest = 2.0 * math.asin(math.sqrt(modulus)) / q
    path = [0.0, farthest, 0.0, -farthest, 0.0]
    assert table["x_cm"][:, 0] == pytest.approx(path, abs=1e-14)
    assert table["delta_e_int"] == pytest.approx(0.0, abs=0.0)


@pytest.mark.parametrize("ending", ["switch", "shift", "force-shift"])
def test_ledger_closes_over_cutoffs(ending):
    """Steps end where a formula changes: a kink or a jump of the force costs no digit."""
    scene = random_scene(1, "morse")
    scene["interaction"] |= {"cutoff": 1.1, "at_cutoff": ending}
    assert_ledger_closes(reference.solve(scene), 1e-14)


@pytest.mark.parametrize("kind", reference.POTENTIALS)
def test_potentials_of_the_solver(kind):
    """Every built-in potential: the force is minus the slope of the energy, as the ledger shows."""
    numbers = {"strength": 0.2, "screening": 1.1, "D": 0.4, "alpha": 1.6, "r0": 0.7}
    numbers |= {"epsilon": 0.3, "sigma": 0.6, "n": 10.5, "m": 4.5, "softening": 0.3}
    numbers |= {"A": 20.0, "rho": 0.2, "C": 1e-3}
    names = reference.POTENTIALS[kind]
    interaction = {"potential": kind} | {name: numbers[name] for name in names}
    scene = pair(interaction, -2.0, 0.4, 8.0) | {"output": {"samples": 3}}
    solution = reference.solve(scene)
    assert_ledger_closes(solution, 1e-14)
    energy = tribo.potentials.named(kind, **{name: numbers[name] for name in names}).energy
    upper, lower = (solution.surfaces[name] for name in ("upper", "lower"))
    r = np.hypot(upper["x_bob"] - lower["x_bob"], upper["y_bob"] - lower["y_bob"])[:, 0]
    assert solution.system["contact_energy"] == pytest.approx(energy(r), rel=1e-13, abs=0.0)


def test_quadruple_precision():
    """It differs from long double by no more than the error of that."""
    scene = random_scene(2, "coulomb")
    one, other = (reference.solve(scene, p) for p in ("long double", "quad"))
    for quantity, error in other.error.items():
        scale = one.scales[reference.kind_of(quantity)]
        assert error <= 1e-16 * scale
        for mine, theirs in zip(one.series(quantity), other.series(quantity), strict=True):
            assert np.max(np.abs(mine - theirs)) <= 2.0 * one.error[quantity] + 1e-15 * scale


def test_bobs_at_one_place_are_refused():
    """And so are plug-ins."""
    scene = pair(COULOMB, 0.0, 0.0, 1.0)
    with pytest.raises(reference.UnsolvedError, match="bobs coincide"):
        reference.solve(scene)
    with pytest.raises(NotImplementedError):
        reference.solve(pair({"potential": "own.py:Own"}, -1.0, 0.3, 1.0))
