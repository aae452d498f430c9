"""A scene is laid out for the effects that it calls for, whatever else it spells out.

Kernels are compiled for the types of what a layout holds, and compute with its numbers: scenes
whose layouts are equal have the same machine code and the same bits.
"""

from dataclasses import replace
from itertools import combinations

import numba
import numpy as np
import pytest

import tribo
from support.random_scenes import random_scene
from support.scene_tables import scene_from
from tribo import explanation
from tribo.layout.contacts import are_coupled
from tribo.layout.layout import Layout, lay_out
from tribo.threads.kernel_model import SCRATCH
from tribo.threads.writable_memory import own_model

SEEDS = [0, pytest.param(1, marks=pytest.mark.thorough)]

BATH = {"masses": np.full(3, 0.1), "frequencies": np.linspace(1.0, 3.0, 3)}
TORSIONAL = {"inertias": np.full(2, 0.1), "torsional_frequencies": np.ones(2)}
CUT = tribo.Interaction(tribo.Coulomb(0.2).with_cutoff(2.0), ("upper", "lower"))
# Effects as settings of the upper surface, or of the scene.
EFFECTS = {
    "free": {"drive": tribo.Free()},
    "rigid body": {"drive": tribo.Free(rigid=True)},
    "pulled": {"drive": tribo.Pulled(stiffness=0.6, speed=0.4)},
    "load": {"drive": tribo.Forced(load=0.01)},
    "driven bars": {"drive": tribo.DrivenBars()},
    "rigid asperites": {
        "asperite": tribo.Asperite(kappa=np.inf),
        "bars": "clamped",
        "initial": tribo.Initial(),
    },
    "clamped bars": {"bars": "clamped"},
    "turning bars": {"bars": "free"},
    "springs": {"springs": tribo.Springs(2.0)},
    "bath": {"bath": tribo.Bath(**BATH)},
    "torsional bath": {"bars": "free", "bath": tribo.Bath(**TORSIONAL)},
    "reservoir": {"langevin": tribo.Langevin(0.1, 0.3)},
    "swing reservoir": {"langevin": tribo.Langevin(0.1, 0.3, on="swing")},
    "field": {"fields": [tribo.Field(tribo.Corrugation(0.1, 1.0), on=("upper",))]},
    "moving field": {
        "fields": [tribo.Field(tribo.Corrugation(0.1, 1.0), on=("upper",), velocity=(0.1, 0.0))]
    },
    "cutoff": {"interactions": (CUT,)},
    "period": {"interactions": (CUT,), "periodic": tribo.Periodic(x=9.0)},
    "contact within": {
        "interactions": (
            tribo.Interaction(tribo.Coulomb(0.2), ("upper", "lower")),
            tribo.Interaction(tribo.Morse(0.1, 2.0, 0.6), ("upper", "upper")),
        ),
    },
}
# Settings of a surface, or of the scene, that say that an effect is absent.
EMPTY = {
    "springs of no stiffness": {"springs": tribo.Springs(0.0, wrap=True)},
    "a bath of no oscillators": {"bath": {"oscillators": []}},
    "a bath of nothing": {"bath": tribo.Bath()},
    "a reservoir that does not damp": {
        "langevin": tribo.Langevin(0.0, 2.0, velocity=(3.0, 0.0)),
    },
    "a swing reservoir that does not damp": {"langevin": tribo.Langevin(0.0, 2.0, on="swing")},
    "no fields": {"fields": []},
    "no period": {"periodic": tribo.Periodic()},
}
OF_SCENE = {"fields", "periodic", "interactions"}


def random_rows(seed: int) -> tribo.Scene:
    """Two random rows that meet, on forced clamped bars, with random parameters."""
    scene = scene_from(random_scene(seed, ("coulomb", "morse")[seed % 2]))
    surfaces = (
        replace(surface, drive="forced", bars="clamped", initial=tribo.Initial(theta=theta))
        for surface, theta in zip(scene.surfaces, (0.1, 3.0), strict=True)
    )
    return replace(scene, surfaces=tuple(surfaces))


def with_effects(scene: tribo.Scene, *effects: dict) -> tribo.Scene | None:
    """The scene with some settings, each on the first surface that has none of them yet.

    None where two settings exclude each other.
    """
    whole: dict = {}
    own: tuple[dict, ...] = tuple({} for _ in scene.surfaces)
    for settings in effects:
        mine = {key: value for key, value in settings.items() if key not in OF_SCENE}
        place = next((given for given in own if not given.keys() & mine.keys()), None)
        shared = {key: value for key, value in settings.items() if key in OF_SCENE}
        if place is None or whole.keys() & shared.keys():
            return None
        place |= mine
        whole |= shared
    try:
        pairs = zip(scene.surfaces, own, strict=True)
        return replace(scene, surfaces=tuple(replace(s, **given) for s, given in pairs), **whole)
    except tribo.InputError:
        return None


def with_empty(scene: tribo.Scene, settings: dict) -> tribo.Scene:
    """The scene with settings that spell out an absent effect, wherever it has no such effect."""
    if settings.keys() <= OF_SCENE:
        (name,) = settings
        return scene if getattr(scene, name) else replace(scene, **settings)
    (name,) = settings
    surfaces = (s if getattr(s, name) else replace(s, **settings) for s in scene.surfaces)
    return replace(scene, surfaces=tuple(surfaces))


def crossed(count: int, seed: int) -> dict[tuple[str, ...], tribo.Scene]:
    """Random scenes with each choice of so many effects that do not exclude one another."""
    scenes = {}
    for names in combinations(EFFECTS, count):
        scene = with_effects(random_rows(seed), *(EFFECTS[name] for name in names))
        if scene is not None:
            scenes[names] = scene
    return scenes


def difference(one: object, other: object, where: str = "") -> str | None:
    """Where two values differ in type or in a bit; None if they do not."""
    if type(one) is not type(other):
        return f"{where}: {type(one).__name__} and {type(other).__name__}"
    if isinstance(one, tuple):
        names = getattr(one, "_fields", range(len(one)))
        if len(one) != len(other):
            return f"{where}: of other length"
        found = (
            difference(*pair, f"{where}.{name}")
            for name, *pair in zip(names, one, other, strict=True)
        )
        return next((each for each in found if each), None)
    if isinstance(one, np.ndarray):
        same = one.dtype == other.dtype and one.shape == other.shape
        return None if same and one.tobytes() == other.tobytes() else where
    return None if one == other else where


def compiled_from(layout: Layout) -> tuple:
    """Everything of a layout that a time loop is compiled with, and computes with."""
    placed = tuple(getattr(layout.places, name) for name in ("columns", "q", "s"))
    return layout.model, layout.start, placed, layout.room, layout.rows, layout.skin


@pytest.mark.parametrize("seed", SEEDS)
def test_empty_effects_beside_every_pair(seed):
    """With each pair of other effects, an effect that is spelled out but empty changes no bit."""
    scenes = crossed(2, seed)
    assert len(scenes) > 0.8 * len(list(combinations(EFFECTS, 2)))
    for names, scene in scenes.items():
        bare = lay_out(scene)
        for name, settings in EMPTY.items():
            changed = with_empty(scene, settings)
            assert changed.effects == scene.effects, (names, name)
            other = lay_out(changed)
            assert difference(compiled_from(bare), compiled_from(other)) is None, (names, name)
            assert numba.typeof(bare.model) == numba.typeof(other.model)


def test_effects_change_the_layout():
    """The comparison sees each effect."""
    scene = random_rows(0)
    for name, settings in EFFECTS.items():
        if name != "clamped bars":
            changed = with_effects(scene, settings)
            apart = difference(compiled_from(lay_out(scene)), compiled_from(lay_out(changed)))
            assert apart is not None, name


# Where the arrays of an effect stand in the model.
ARRAYS = {
    "springs": lambda scene, s: bool(s.springs) and s.count > 1,
    "bath": lambda scene, s: s.bath.masses.size > 0,
    "torsional": lambda scene, s: s.bath.inertias.size > 0,
    "friction": lambda scene, s: is_damped(s, "bar"),
    "swing_friction": lambda scene, s: is_damped(s, "swing"),
    "pivots": lambda scene, s: isinstance(s.drive, tribo.DrivenBars),
    "fields": lambda scene, s: bool(scene.fields),
    "external": lambda scene, s: bool(scene.fields),
    "inner": lambda scene, s: len(scene.interactions) > 1,
    "box": lambda scene, s: scene.periodic.x is not None,
    "calculators": lambda scene, s: False,
    "species": lambda scene, s: False,
    "drives": lambda scene, s: False,
    "ends": lambda scene, s: False,
    "left": lambda scene, s: False,
    "right": lambda scene, s: False,
}


def is_damped(surface: tribo.Surface, on: str) -> bool:
    """Whether a reservoir acts there."""
    return surface.langevin is not None and surface.langevin.on == on


@pytest.mark.parametrize("seed", SEEDS)
def test_absent_effects_have_no_array(seed):
    """A table is None exactly where its effect is absent, and has no columns in the kernels."""
    for names, scene in crossed(2, seed).items():
        layout = lay_out(scene)
        model, (own, _) = layout.model, own_model(layout)
        for name, wanted in ARRAYS.items():
            present = any(wanted(scene, surface) for surface in scene.surfaces)
            assert (getattr(model, name) is not None) == present, (names, name)
        pulls = model.springs is not None or model.bath is not None
        assert all((each is not None) == pulls for each in (model.internal, model.displaced))
        for name in SCRATCH:
            assert (getattr(own, name).size > 0) == (getattr(model, name) is not None), name


def counted(scene: tribo.Scene) -> dict[str, int]:
    """The degrees of freedom, from the equations of motion in the documentation."""
    found = dict.fromkeys(("swings", "bars", "x", "y", "baths"), 0)
    for surface in scene.surfaces:
        n, drive = surface.count, surface.drive
        found["swings"] += 0 if np.all(np.isinf(surface.asperite.kappa)) else n
        found["bars"] += n if surface.bars == "free" else 0
        found["baths"] += n * (2 * surface.bath.masses.size + surface.bath.inertias.size)
        # A force that no drive cancels moves the centres of mass in the plane.
        pushed = bool(surface.springs) or surface.bath.masses.size > 0
        pushed |= is_damped(surface, "bar")
        pushed |= any(surface.name in field.on for field in scene.fields)
        pushed |= surface.name == "upper" and len(scene.interactions) > 1
        if isinstance(drive, tribo.DrivenBars):
            continue
        # A rigid body has one coordinate along each axis along which its bars are joined.
        along_x = 1 if surface.moves_as_one or surface.is_rigid_block else n
        along_y = 1 if surface.is_rigid_block else n
        found["x"] += along_x if pushed or not isinstance(drive, tribo.Forced) else 0
        found["y"] += along_y if pushed or drive.load is not None else 0
    return found


@pytest.mark.parametrize("seed", SEEDS)
def test_degrees_of_freedom(seed):
    """Those that an explanation reports are those of the equations, with any two effects."""
    for names, scene in crossed(2, seed).items():
        assert explanation.coordinates(lay_out(scene)) == counted(scene), names
        layout = lay_out(scene)
        # Rigid asperites keep the slots of their swings, and bars of rigid bodies theirs.
        slots = sum(int((layout.asperites[name] >= 0).sum()) for name in ("dof_x", "dof_y"))
        joined = slots - counted(scene)["x"] - counted(scene)["y"]
        held = layout.coordinates - sum(counted(scene).values()) - joined
        rigid = [s.count for s in scene.surfaces if np.all(np.isinf(s.asperite.kappa))]
        assert held == sum(rigid), names


def test_many_unequal_charges_are_coupled():
    """Rows with hundreds of charges each are not tried pair by pair, and keep their contact."""
    charges = np.linspace(0.5, 1.5, 320)
    row = {"shape": (320, 1), "spacing": (1.0, 0.0), "asperite": tribo.Asperite(charge=charges)}
    surfaces = tribo.Surface("a", bob=(0.0, 1.0), **row), tribo.Surface("b", facing="up", **row)
    scene = tribo.Scene(surfaces, tribo.Coulomb(1.0), 1.0)
    assert are_coupled(scene, scene.interactions[0], (0, 1))
