"""Encounters of bobs, found eight at a time, against a loop over pairs in Python."""

import math

import numpy as np
import pytest

import tribo
from support.kernels import shared_kernel
from tribo.compiler.kept import keep
from tribo.compiler.lanes_memory import room
from tribo.kernels.encounters import NEGLIGIBLE, PROBES, next_encounter
from tribo.kernels.packs import ONE_RUN
from tribo.kernels.records import CHARGE, X, Y
from tribo.layout.layout import lay_out
from tribo.threads.model_units import fulfil, loop_units
from tribo.threads.writable_memory import own_model


@shared_kernel
def find(model, neighbours, speeds, found):
    """The numbers of the next encounter."""
    encounter = next_encounter(model, neighbours, speeds, ONE_RUN)
    found[0] = encounter.rate
    found[1] = encounter.closest
    found[2] = encounter.clearance
    found[3] = encounter.ignored


MORSE = tribo.Morse(0.1, 1.0, 1.5)
REPELLING = tribo.LennardJones(0.1, 1.0).with_cutoff(2.5)


def scene(counts=(11, 5), interactions=MORSE, periodic=None, upper=None, lower=None):
    """Two rows whose numbers of asperites fill no pack."""
    rows = [{"shape": (n, 1), "spacing": (0.9, 0.0)} for n in counts]
    surfaces = (
        tribo.Surface("upper", bob=(0.0, 1.2), velocity=(0.5, 0.0), **rows[0], **(upper or {})),
        tribo.Surface("lower", facing="up", **rows[1], **(lower or {})),
    )
    return tribo.Scene(surfaces, interactions, 1.0, periodic=periodic or {})


def mixed():
    """Two species on each surface, with an interaction of their own for each two."""
    between = [
        tribo.Interaction(MORSE, species=("a", "a")),
        tribo.Interaction(REPELLING, species=("a", "b")),
    ]
    species = [{"species": ["ab"[i % 2] for i in range(n)]} for n in (11, 5)]
    return scene(interactions=between, upper=species[0], lower=species[1])


def charged():
    """Charges of which some are zero, so that no force acts."""
    charges = [{"asperite": {"charge": [float(i % 3) for i in range(n)]}} for n in (11, 5)]
    return scene(interactions=tribo.Coulomb(0.2), upper=charges[0], lower=charges[1])


SCENES = {
    "one pack": scene((3, 2)),
    "several packs": scene((19, 26)),
    "cutoff": scene(interactions=REPELLING),
    "box": scene(interactions=REPELLING, periodic={"x": 11.3}),
    "within": scene(
        interactions=[
            tribo.Interaction(MORSE),
            tribo.Interaction(REPELLING, between=("upper", "upper")),
        ]
    ),
    "species": mixed(),
    "charges": charged(),
    "noise": scene(upper={"langevin": tribo.Langevin(0.1, 5.0)}),
    "much noise": scene(upper={"langevin": tribo.Langevin(0.1, 1e3)}),
    "noise and a cutoff": scene(
        interactions=REPELLING, upper={"langevin": tribo.Langevin(0.1, 0.1)}
    ),
}


def can_matter(potential, r, one, other, thermal):
    """Whether the energy at some distance up to r is not far below k_B T."""
    probes = [potential.energy_between(k / PROBES * r, one, other) for k in range(1, PROBES + 1)]
    return thermal <= 0.0 or any(not abs(each) < NEGLIGIBLE * thermal for each in probes)


def in_python(layout, model, speeds, thermal):
    """Rate, closest, clearance and ignored rate of all pairs, one after another."""
    rate = ignored = 0.0
    closest = clearance = math.inf
    box = layout.scene.periodic.x or 0.0
    charges = model.each[CHARGE]
    for contact in layout.model.contacts:
        for k, m in contact.pairs.tolist():
            s, u = model.surfaces[k], model.surfaces[m]
            for i in range(s.start, s.end):
                for j in range(u.start if m != k else i + 1, u.end):
                    if contact.species is not None:
                        kinds = sorted([model.species[i], model.species[j]])
                        if kinds != sorted(contact.species):
                            continue
                    dx = model.bobs[X, i] - model.bobs[X, j]
                    if box:
                        dx -= box * np.round(dx / box)
                    r = math.hypot(dx, model.bobs[Y, i] - model.bobs[Y, j])
                    pair = charges[i], charges[j]
                    own = contact.potential.clearance_between(r, *pair)
                    if own == math.inf:
                        continue
                    closest = min(closest, r)
                    clearance = min(clearance, own)
                    faster = math.hypot(*(speeds[:2, i] - speeds[:2, j]))
                    faster += speeds[2, i] + speeds[2, j]
                    if can_matter(contact.potential, r, *pair, thermal):
                        rate = max(rate, faster / own)
                    else:
                        ignored = max(ignored, faster / own)
    return rate, closest, clearance, ignored


@pytest.mark.parametrize("name", SCENES)
def test_the_same_as_pair_by_pair(name):
    layout = lay_out(SCENES[name])
    model = own_model(layout)[0]
    fulfil(loop_units(model))
    rng = np.random.default_rng(1)
    surfaces = layout.scene.surfaces
    thermal = max(
        (s.reservoir("bar").temperature if s.reservoir("bar") else -1.0 for s in surfaces),
        default=-1.0,
    )
    for _ in range(5):
        model.bobs[:] = rng.uniform(-4.0, 4.0, model.bobs.shape)
        speeds = room((3, model.each.shape[1]))
        speeds[:] = rng.uniform(0.0, 1.0, speeds.shape)
        found = np.zeros(4)
        find(keep(model), keep(layout.neighbours()), speeds, found)
        rate, closest, clearance, ignored = in_python(layout, model, speeds, thermal)
        assert found[:3] == pytest.approx([rate, closest, clearance], rel=1e-13, abs=0.0)
        # Rates that matter replace all slower ones, whichever come first.
        assert found[3] <= ignored * (1 + 1e-13)
        if ignored > rate:
            assert found[3] == pytest.approx(ignored, rel=1e-13, abs=0.0)
