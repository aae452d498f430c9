"""What a scene calls for is simulated, and nothing else: an absent effect has no variable."""

from dataclasses import replace

import numpy as np
import pytest

import tribo
from tribo import (
    Asperite,
    Coulomb,
    DrivenBars,
    Field,
    Forced,
    Free,
    Interaction,
    Langevin,
    Output,
    Periodic,
    Pulled,
    Scene,
    Springs,
    Surface,
)
from tribo.layout.layout import lay_out
from tribo.model.effects import Effect

PLAIN = {"swing", "contact", "clamped ends"}  # of the paper's forced sliding


COULOMB = Coulomb(0.2)


def pair(potential=COULOMB, scene=None, lower=None, **upper):
    """A short pass of two asperites with some things changed; its steps are of equal length."""
    surfaces = (
        Surface("upper", **({"bob": (-1.0, 0.0), "velocity": (0.5, 0.0)} | upper)),
        Surface("lower", **({"facing": "up"} | (lower or {}))),
    )
    return Scene(surfaces, potential, 4.0, output=Output(samples=9), **(scene or {}))


def end(scene):
    """Every series of a run in equal steps."""
    result = tribo.simulate(scene, method="midpoint", step=0.01)
    assert result.status == "completed"
    return {name: dict(result[name]) for name in result.ledger.surfaces}


def assert_same(one, other):
    """The same series, to the last bit."""
    assert set(one) == set(other)
    for key, values in one.items():
        assert np.array_equal(values, other[key]), key


ROW = {"shape": (3, 1), "spacing": (1.0, 0.0)}
FIELD = {"fields": [Field(tribo.Corrugation(0.1, 1.0), on=("upper",))]}
# A scene, and the effects that it has more or less than the plain one.
SCENES = {
    "plain": (pair(), set(), set()),
    "no interaction": (pair(potential=()), set(), {"contact"}),
    "no springs in the bars": (
        pair(asperite=Asperite(kappa=0.0), lower={"asperite": Asperite(kappa=0.0)}),
        set(),
        {"clamped ends"},
    ),
    "free": (pair(drive=Free()), {"sliding"}, set()),
    "rigid": (pair(drive=Free(rigid=True)), {"sliding"}, set()),
    "block": (pair(drive=Free(block=True)), {"sliding", "block", "block of pendulums"}, set()),
    "damped block": (
        pair(
            asperite=Asperite(kappa=np.inf),
            drive=Pulled(stiffness=1.0, speed=0.1, damping=0.2, block=True),
        ),
        {"sliding", "pull", "block", "damped block", "rigid asperites"},
        set(),
    ),
    "pulled": (pair(drive=Pulled(stiffness=1.0, speed=0.1)), {"sliding", "pull"}, set()),
    "loaded": (pair(drive=Forced(load=0.1)), {"sliding", "load"}, set()),
    "no load": (pair(drive=Forced(load=0.0)), {"sliding", "load"}, set()),
    "one bar free": (pair(bars="free"), {"turning bars"}, set()),
    "bars free": (
        pair(bars="free", lower={"bars": "free"}),
        {"turning bars"},
        {"clamped ends"},
    ),
    "driven bars": (pair(drive=DrivenBars()), {"driven bars"}, set()),
    "driven rows": (
        pair(drive=DrivenBars(), **ROW, springs=Springs(1.0)),
        {"driven bars", "springs"},
        set(),
    ),
    "damped swing": (pair(langevin=Langevin(0.1, on="swing")), {"swing langevin"}, set()),
    "one rigid": (pair(asperite=Asperite(kappa=np.inf)), {"rigid asperites"}, set()),
    "both rigid": (
        pair(asperite=Asperite(kappa=np.inf), lower={"asperite": Asperite(kappa=np.inf)}),
        {"rigid asperites"},
        {"swing"},
    ),
    "springs": (pair(**ROW, springs=Springs(1.0)), {"springs", "sliding"}, set()),
    "slack springs": (pair(**ROW, springs=Springs(0.0)), set(), set()),
    "reservoir": (pair(langevin=Langevin(0.1)), {"langevin", "sliding"}, set()),
    "reservoir without hold": (pair(langevin=Langevin(0.0)), set(), set()),
    "field": (pair(scene=FIELD), {"field", "sliding"}, set()),
    "cutoff": (pair(potential=Coulomb(0.2).with_cutoff(2.0)), {"cutoff"}, set()),
    "periodic": (
        pair(
            potential=Coulomb(0.2).with_cutoff(2.0),
            scene={"periodic": Periodic(x=9.0)},
        ),
        {"cutoff", "periodic"},
        set(),
    ),
}


@pytest.mark.parametrize("name", SCENES)
def test_effects(name):
    """A scene says what it calls for, by names that are explained."""
    scene, more, less = SCENES[name]
    assert scene.effects == PLAIN - less | more
    assert scene.effects <= set(Effect)


# How many coordinates a scene has: a swing each, and what is free to move beside.
SIZES = {
    "plain": 2,  # the two swings
    "no interaction": 2,
    "reservoir without hold": 2,
    "slack springs": 4,  # four swings
    "cutoff": 2,
    "one bar free": 3,
    "bars free": 4,
    "free": 3,
    "rigid": 3,
    "pulled": 3,
    "loaded": 3,
}


@pytest.mark.parametrize("name", SIZES)
def test_only_what_can_move_has_a_coordinate(name):
    """A forced pair with clamped bars has its two swings, and each freedom adds one."""
    assert lay_out(SCENES[name][0]).coordinates == SIZES[name]


def test_absent_effects_have_no_account():
    """What is kept of a run grows with what is asked for."""
    plain, free, pulled = (
        lay_out(SCENES[name][0]).accounts for name in ("plain", "free", "pulled")
    )
    assert plain < free < pulled
    slack = lay_out(pair(asperite=Asperite(kappa=0.0), lower={"asperite": Asperite(kappa=0.0)}))
    assert slack.accounts < plain


# Two ways to say the same physics.
SAME = {
    "one rigid asperite is a free one": (pair(drive=Free()), pair(drive=Free(rigid=True))),
    "a row of one": (pair(), pair(shape=(1, 1), spacing=(3.0, 1.0))),
    "a list of one": (pair(), pair(bob=(0.0, 0.0), positions=[[-1.0, 0.0, 0.0]])),
    "heights of zero": (pair(), pair(heights=[0.0])),
    "one number each": (pair(), pair(asperite=Asperite(m1=[1.0], kappa=[2.0]))),
    "springs between none": (pair(), pair(springs=Springs(0.0))),
    "a reservoir without hold": (pair(), pair(langevin=Langevin(0.0, velocity=(3.0, 0.0)))),
    "between the two there are": (pair(), pair(Interaction(Coulomb(0.2), ("lower", "upper")))),
}


@pytest.mark.parametrize("name", SAME)
def test_same_physics(name):
    """The same numbers, to the last bit: nothing is computed for what is not there."""
    one, other = (end(scene) for scene in SAME[name])
    for surface in one:
        assert_same(one[surface], other[surface])


def test_bystanders_change_nothing():
    """Surfaces that interact with none leave the others as they were, to the last bit."""
    between = (Interaction(Coulomb(0.2), ("upper", "lower")),)
    scene = replace(pair(), interactions=between)
    others = (
        Surface("near", bob=(0.0, 1.0), velocity=(0.3, 0.0)),
        Surface("far", facing="up", bob=(1e6, -1e6), initial=tribo.Initial(omega=1.0)),
    )
    alone = end(scene)
    together = end(replace(scene, surfaces=(*scene.surfaces, *others)))
    for surface in alone:
        assert_same(alone[surface], together[surface])
    for name in ("near", "far"):
        for work in ("w1", "w2", "w_ps"):
            assert np.all(together[name][work] == 0.0)


def test_no_interaction():
    """Without one the pendulums swing on their own, and no work is done on them."""
    scene = pair(potential=(), initial=tribo.Initial(theta=0.3))
    result = tribo.simulate(scene, accuracy=1e-10)
    frequency = np.sqrt(2.0 / (1.0 * (4.0 / 3.0) ** 2 + 2.0 * (2.0 / 3.0) ** 2))
    assert result["upper"].theta[:, 0] == pytest.approx(
        0.3 * np.cos(frequency * result.t), abs=1e-9
    )
    assert np.all(result["upper"].w1 == 0.0)
    assert np.all(result.system["contact_energy"] == 0.0)


def test_one_surface():
    """A surface alone is a scene, whatever would act between two."""
    scene = Scene((Surface("only", initial=tribo.Initial(omega=0.1)),), Coulomb(0.2), 1.0)
    assert "contact" not in scene.effects
    assert tribo.simulate(scene).status == "completed"
