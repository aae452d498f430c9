"""Asperites that are alike share their constants, which changes no bit of a run."""

from dataclasses import replace

import numpy as np
import pytest

import tribo
from support.inactive import STEP, crossing
from support.inactive import inactive as not_stepped
from tribo.integrators.methods import METHODS
from tribo.run import contacts
from tribo.run.general_loop import GeneralLoop
from tribo.run.layout import lay_out


@pytest.fixture(autouse=True)
def lists(monkeypatch):
    """Neighbour lists for few bobs too."""
    monkeypatch.setattr(contacts, "UNLISTED_PAIRS", 0)


def recorded(loop):
    """All that a run records."""
    times = loop.layout.times
    columns = loop.room(times.size)
    loop.advance(times, columns, 10**6)
    return columns


def same_with_own_constants(scene, alike):
    """The loop after a run that has the same bits if each asperite has constants of its own.

    `alike` names the surfaces whose asperites share them.
    """
    shared, own = (lay_out(scene) for _ in range(2))
    masks = shared.model.surfaces.constants_mask
    assert [s.name for s, mask in zip(scene.surfaces, masks, strict=True) if mask == 0] == alike
    own.model.surfaces.constants_mask[:] = -1
    loops = [
        GeneralLoop(layout, METHODS["verlet"], STEP, layout.start, 0.0) for layout in (shared, own)
    ]
    one, other = (recorded(loop) for loop in loops)
    for mine, theirs in zip(one, other, strict=True):
        assert np.all(np.isfinite(mine)) and np.array_equal(mine, theirs)
    return loops[0]


def test_surfaces_of_every_drive():
    """Bars that are clamped, free or turn, drives and springs, the last blocks partly filled."""
    grids = {"shape": (6, 3), "spacing": (0.9, 0.9), "heights": 0.01 * np.arange(18.0)}
    kinds = {
        "forced": {},
        "loaded": {"drive": tribo.Forced(load=0.1)},
        "rigid": {"drive": tribo.Free(rigid=True)},
        "pulled": {"drive": tribo.Pulled(stiffness=1.0, speed=0.4)},
        "free": {"drive": "free", "bars": "free"},
        "bars": {"drive": "bars"},
        "fixed": {"drive": "free", "asperite": tribo.Asperite(kappa=np.inf)},
        "sprung": {"drive": "free", "springs": tribo.Springs(1.0)},
        "turning": {"initial": tribo.Initial(swing=0.1, nu=0.1)},
        "tilted": {"initial": tribo.Initial(swing=0.1, phi=0.1)},
        "unlike": {"asperite": tribo.Asperite(m1=np.linspace(0.5, 1.0, 18))},
    }
    surfaces = [
        tribo.Surface(
            name,
            facing="up" if n % 2 else "down",
            bob=(0.3 * n, 0.4 * (n % 2)),
            depth=0.2 * n,
            velocity=(0.3 * (-1) ** n, 0.0),
            **({"initial": tribo.Initial(swing=0.1)} | grids | kind),
        )
        for n, (name, kind) in enumerate(kinds.items())
    ]
    potential = tribo.with_cutoff(tribo.LennardJones(0.02, 0.4), 1.0)
    names = list(kinds)
    pairs = [(one, other) for one in names[::2] for other in names[1::2]]
    interactions = [tribo.Interaction(potential, pair) for pair in pairs]
    scene = tribo.Scene(surfaces, interactions, 2.0, output=tribo.Output(samples=3))
    unlike = ("turning", "tilted", "unlike")
    same_with_own_constants(scene, [name for name in names if name not in unlike])


def test_surface_whose_first_block_is_inactive():
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
