"""What is absent, empty or out of reach leaves the paper's pair as it is, bit for bit."""

from dataclasses import replace
from typing import NamedTuple

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


class NoField(NamedTuple):
    strength: float

    def energy_at(self, x, y):
        return self.strength * (x * x + y * y)


class NoDrive(NamedTuple):
    strength: float

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        return self.strength * x, -fy


class NoTurn(NamedTuple):
    strength: float

    def end_forces(self, t, phi, nu, twist):
        return 0.0, -self.strength * nu, 0.0, self.strength * twist


def beside(strength: float | None = 0.4, fields: tuple = (), **upper: object) -> tribo.Scene:
    """Two asperites that pass another one, with a part of the scene."""
    own = {"drive": tribo.Free(), "initial": tribo.Initial(omega=0.3, theta=0.1)} | upper
    shape = {"shape": (2, 1), "spacing": (1.0, 0.0)}
    surfaces = (
        tribo.Surface("upper", bob=(-1.5, 0.4), velocity=(0.4, 0.0), **(shape | own)),
        tribo.Surface("lower", facing="up", drive="bars"),
    )
    output = tribo.Output(samples=5)
    contact = () if strength is None else tribo.Coulomb(strength)
    return tribo.Scene(surfaces, contact, 4.0, fields=fields, output=output)


def field(potential: object, **how: object) -> dict[str, object]:
    return {"fields": (tribo.Field(potential, on=("upper",), **how),)}


LOADED = {"drive": tribo.Free(load=0.0)}
COLD = {"langevin": tribo.Langevin(0.5, 1e-200)}
SOFT = {"asperite": tribo.Asperite(kappa=1e-250)}
# A part whose number is exactly zero, and a scene that does the same.
ZERO = {
    "amplitude": (field(tribo.Corrugation(0.0, 1.0)), {}),
    "amplitude of a moving field": (field(tribo.Corrugation(0.0, 1.0), velocity=(0.3, 0.0)), {}),
    "field of one's own": (field(NoField(0.0)), {}),
    "drive of one's own": ({"drive": tribo.Custom(force=NoDrive(0.0))}, {}),
    "ends of one's own": ({"bars": tribo.Ends(NoTurn(0.0))}, {"bars": "free"}),
    "damping of swings": ({"langevin": tribo.Langevin(0.0, 1.0, on="swing")}, {}),
    "temperature": ({"langevin": tribo.Langevin(0.5, 0.0)}, COLD),
    "temperature of the start": (
        {"initial": tribo.Initial(omega=0.3, theta=0.1, temperature=0.0)},
        {},
    ),
    "pulling spring": ({"drive": tribo.Pulled(stiffness=0.0, speed=0.5)}, {}),
    "pulling spring and load": (
        {"drive": tribo.Pulled(stiffness=0.0, speed=0.5, load=0.0)},
        LOADED,
    ),
    "push": ({"drive": tribo.Pushed(force=(0.0, 0.0), load=0.0)}, LOADED),
    "rate of a push": ({"drive": tribo.Pushed(rate=(0.0, 0.0), load=0.0)}, LOADED),
    "torsion": ({"asperite": tribo.Asperite(kappa=0.0)}, SOFT),
    "strength": ({"strength": 0.0}, {"strength": None}),
    "charge": ({"asperite": tribo.Asperite(charge=0.0)}, {"strength": None}),
}


@pytest.mark.parametrize("name", ZERO)
def test_zeros_are_scenes_without_the_part(name):
    """To round-off of energies of order 1."""
    ours, others = (run(beside(**parts), "verlet") for parts in ZERO[name])
    assert ours.status == others.status == "completed"
    mine, theirs = series_of(ours), series_of(others)
    for each in mine.keys() & theirs.keys():
        assert np.max(np.abs(mine[each] - theirs[each])) < 1e-15, each


def test_no_noise_at_a_temperature_of_zero():
    """Runs with different seeds have the same bits."""
    scene = beside(langevin=tribo.Langevin(0.5, 0.0), initial=tribo.Initial(temperature=0.0))
    assert_same(*(series_of(run(replace(scene, seed=seed), "verlet")) for seed in (1, 2)))


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
