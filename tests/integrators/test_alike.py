"""Asperites that are alike share their constants, which changes no bit of a run."""

from dataclasses import replace
from unittest import mock

import numpy as np
import pytest

import tribo
from support.crossed import Push, Turn
from support.inactive import STEP, crossing
from support.inactive import inactive as not_stepped
from support.kinds import surfaces_of
from tribo.integrators.methods import METHODS
from tribo.kernels.status import COMPLETED, PAUSED
from tribo.layout import contacts, tables
from tribo.layout.layout import lay_out
from tribo.loops.general import GeneralLoop
from tribo.loops.setting import Setting


@pytest.fixture(autouse=True)
def lists(monkeypatch):
    """Neighbour lists for few bobs too."""
    monkeypatch.setattr(contacts, "UNLISTED_PAIRS", 0)


def recorded(loop):
    """All that a run records."""
    times = loop.layout.times
    columns = loop.room(times.size)
    code = PAUSED  # while the neighbour list needs more room
    while code == PAUSED:
        code = loop.advance(times, columns, 10**6)
    assert code == COMPLETED
    return columns


def same_with_own_constants(scene, alike):
    """The loop after a run that has the same bits if each asperite has constants of its own.

    `alike` names the surfaces whose asperites share them.
    """
    shared = lay_out(scene)
    with mock.patch.object(tables, "are_alike", return_value=False):
        own = lay_out(scene)
    masks = shared.model.surfaces.constants_mask
    assert [s.name for s, mask in zip(scene.surfaces, masks, strict=True) if mask == 0] == alike
    assert np.all(own.model.surfaces.constants_mask == -1)
    loops = [
        GeneralLoop(layout, METHODS["verlet"], Setting(step=STEP), layout.start, 0.0)
        for layout in (shared, own)
    ]
    one, other = (recorded(loop) for loop in loops)
    for mine, theirs in zip(one, other, strict=True):
        assert np.all(np.isfinite(mine)) and np.array_equal(mine, theirs)
    return loops[0]


def scene_of(kinds, series=()):
    """Surfaces of three packs, the last one partly filled, with some settings each."""
    surfaces, pairs = surfaces_of(kinds, (6, 3))
    potential = tribo.LennardJones(0.02, 0.4).with_cutoff(1.0)
    interactions = [tribo.Interaction(potential, pair) for pair in pairs]
    output = tribo.Output(samples=3, series=series)
    return tribo.Scene(surfaces, interactions, 2.0, output=output)


def test_surfaces_of_every_drive():
    """Bars that are clamped, free or turn, drives and springs, the last packs partly filled."""
    kinds = {
        "forced": {},
        "loaded": {"drive": tribo.Forced(load=0.1)},
        "rigid": {"drive": tribo.Free(rigid=True)},
        "pulled": {"drive": tribo.Pulled(stiffness=1.0, speed=0.4)},
        "free": {"drive": "free", "bars": "free"},
        "bars": {"drive": "bars", "initial": tribo.Initial(swing=0.06)},
        "fixed": {"drive": "free", "asperite": tribo.Asperite(kappa=np.inf)},
        "sprung": {"drive": "free", "springs": tribo.Springs(1.0)},
        "turning": {"initial": tribo.Initial(swing=0.1, nu=0.1)},
        "tilted": {"initial": tribo.Initial(swing=0.1, phi=0.1)},
        "unlike": {"asperite": tribo.Asperite(m1=np.linspace(0.5, 1.0, 18))},
    }
    scene = scene_of(kinds)
    unlike = ("turning", "tilted", "unlike")
    same_with_own_constants(scene, [name for name in kinds if name not in unlike])


def test_baths_reservoirs_plugins_and_forces():
    """What is computed asperite by asperite, also of those beyond the first pack."""
    bath = {"masses": (0.1,), "frequencies": (0.8,)}
    torsional = {"inertias": (0.1,), "torsional_frequencies": (0.9,)}
    kinds = {
        "bathed": {"drive": "free", "bath": tribo.Bath(**bath)},
        "turned": {"drive": "free", "bars": "free", "bath": tribo.Bath(**bath, **torsional)},
        "heated": {"drive": "free", "langevin": tribo.Langevin(0.3, 1e-3)},
        "damped": {"langevin": tribo.Langevin(0.3, 1e-3, on="swing")},
        "rigid": {
            "drive": "free",
            "asperite": tribo.Asperite(kappa=np.inf),
            "langevin": tribo.Langevin(0.3, 1e-3),
        },
        "custom": {"drive": tribo.Custom(force=Push(0.1))},
        "ends": {"bars": tribo.Ends(force=Turn(0.1))},
        "driven": {
            "drive": "bars",
            "initial": tribo.Initial(swing=0.06),
            "langevin": tribo.Langevin(0.2, 1e-3, on="swing"),
        },
    }
    scene = scene_of(kinds, ("forces", "energies"))
    same_with_own_constants(scene, list(kinds))
    one = tribo.simulate(scene, method="verlet", step=STEP).to_xarray()
    with mock.patch.object(tables, "are_alike", return_value=False):
        other = tribo.simulate(scene, method="verlet", step=STEP).to_xarray()
    assert one.equals(other) and {"heated.f_T_x", "ends.fL_x", "turned.f_bath_x"} <= set(one)


def test_surface_whose_first_pack_is_inactive():
    """Its constants are those of all others, whether it is stepped or not."""
    scene = crossing()
    lower = next(s for s in scene.surfaces if s.name == "lower")
    swing = tribo.Initial(swing=lower.initial.swing, omega=0.1)
    like = replace(lower, asperite=tribo.Asperite(kappa=2.0), initial=swing)
    scene = replace(scene, surfaces=tuple(like if s.name == "lower" else s for s in scene.surfaces))
    loop = same_with_own_constants(scene, ["lower", "slider"])
    first = loop.layout.parts["lower"].start
    asleep = not_stepped(loop)[loop.layout.parts["lower"]]
    assert first == 0 and asleep[0] and not np.all(asleep)
