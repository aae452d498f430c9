"""Neighbour lists, against a comparison of all bobs."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import tribo
from support.scene_tables import scene_from
from support.sliding import POTENTIAL, scene
from support.uncompiled.ledger import lowered
from tribo.compiler.team import COUNTERS, NO_TEAM, PAIR
from tribo.kernels.equations_of_motion import place_bobs
from tribo.kernels.neighbours import (
    have_moved,
    is_partner,
    join_chunks,
    list_chunk,
    list_pair,
    partner_species,
    rebuild,
    refresh,
)
from tribo.kernels.records import X, Y
from tribo.layout.layout import lay_out
from tribo.threads.writable_memory import own_model


@pytest.mark.parametrize(
    ("count", "extent", "box"),
    [
        (70, 12.0, {}),
        (70, 12.0, {"x": 12.0}),
        (70, 12.0, {"z": 11.0}),
        (70, 12.0, {"x": 5.0, "z": 3.5}),
        (400, 40.0, {}),
        (400, 40.0, {"x": 40.0, "z": 0.7 * 40.0}),
    ],
)
def test_rows_of_two_clouds(count, extent, box):
    """A list has exactly the pairs within its reach, sorted, whether cells are many or one."""
    rng = np.random.default_rng(3)
    places = rng.uniform(0.0, extent, (count, 3)) * [1.0, 0.08, 0.7] + [0.0, 0.0, 5.0]
    with lowered({"layout.contacts.UNLISTED_PAIRS": 0}):
        layout = lay_out(scene_from(two_clouds(places, box)))
    model = own_model(layout)[0]
    neighbours = layout.neighbours()
    neighbours = neighbours._replace(index=np.zeros(60 * count, np.int32))
    near = 0.49 * layout.skin
    far = 0.51 * layout.skin
    for slide, rise, lists_made in (
        (0.0, 0.0, 1),
        (0.0, near, 1),
        (near, 0.0, 1),
        (0.75 * far, 0.75 * far, 2),
        (0.75 * far, -0.5 * far, 3),
        (5.3, 0.0, 4),
    ):
        moves = np.arange(count) < UPPER
        place = places[:, 0] + slide * moves, places[:, 1] + rise * moves
        model.bobs[[[X], [Y]], layout.places.columns] = place
        refresh(model, neighbours)
        assert neighbours.made[0] == lists_made, f"slide {slide}, rise {rise}"
        if near in (slide, rise):
            continue  # the list is the one before
        now = np.column_stack([*place, layout.depths])
        for k in range(len(neighbours.pairs)):
            compare_rows(layout, neighbours, k, now, box)


# Bobs of the upper cloud: one more than fills packs of eight.
UPPER = 33


def two_clouds(places: np.ndarray, box: dict) -> dict:
    """A scene of UPPER bobs and the rest, with contact between and within."""
    potential = {"potential": "lennard-jones", "epsilon": 0.1, "sigma": 0.5}
    species = ["A" if k % 3 else "B" for k in range(len(places))]
    return {
        "duration": 1.0,
        "periodic": box,
        "interaction": [
            potential | {"cutoff": 1.5, "between": ["upper", "lower"], "species": ["A", "B"]},
            potential | {"cutoff": 1.2, "between": ["upper", "upper"], "species": ["A", "A"]},
        ],
        "surface": [
            {"name": "upper", "positions": places[:UPPER].tolist(), "species": species[:UPPER]},
            {
                "name": "lower",
                "facing": "up",
                "positions": places[UPPER:].tolist(),
                "species": species[UPPER:],
            },
        ],
    }


def compare_rows(layout, neighbours, k, places, box):
    """Compare the rows of the kth pair of surfaces with all bobs."""
    one, other, row = neighbours.pairs[k].tolist()
    kinds = sorted(neighbours.species[k])
    parts = list(layout.parts.values())
    columns = layout.places.columns
    theirs = np.arange(parts[other].start, parts[other].stop)
    for i in range(parts[one].start, parts[one].stop):
        expected = []
        for n in np.unique(columns[theirs] // 8):
            own = places[theirs[columns[theirs] // 8 == n]]
            away = places[i] - 0.5 * (np.min(own, axis=0) + np.max(own, axis=0))
            for axis, name in ((0, "x"), (2, "z")):
                if name in box:
                    away[axis] -= box[name] * np.round(away[axis] / box[name])
            beyond = np.maximum(abs(away) - 0.5 * np.ptp(own, axis=0), 0.0)
            is_near = np.sum(beyond**2) < neighbours.reach[k] ** 2
            if is_near and layout.model.species[columns[i]] in kinds and 8 * n + 7 > columns[i]:
                expected.append(int(n))
        at = row + columns[i] - layout.model.surfaces.start[one]
        found = neighbours.index[neighbours.start[at] : neighbours.start[at + 1]].tolist()
        assert found == expected, f"bob {i}"


def test_lists_in_chunks():
    """Rows of a list that are filled in chunks, and moved together, are those of one thread."""
    rng = np.random.default_rng(3)
    upper, lower = (rng.uniform(-6.0, 6.0, (n, 3)) * [1.0, 0.05, 1.0] for n in (70, 90))
    contacts = [tribo.Interaction(POTENTIAL, ("upper", name)) for name in ("lower", "upper")]
    layout = lay_out(replace(scene(upper, lower, {}), interactions=contacts))
    model, _ = own_model(layout)
    place_bobs(model, 0.0, np.zeros(layout.room[0]))
    alone = layout.neighbours()
    shared = layout.neighbours()
    rebuild(model, alone)
    stops = [*alone.pairs[1:, 2], alone.start.size - 1]
    team = SimpleNamespace(counters=np.zeros(COUNTERS, np.int64), lengths=np.zeros(5, np.int64))
    team.begins = np.zeros(6, np.int64)
    end = 0
    for k, stop in enumerate(stops):
        list_pair(model, NO_TEAM, shared, k, end)  # for its boxes and cells
        rows = slice(shared.pairs[k, 2], stop)
        shared.start[rows] = -1
        shared.index[end:] = -1
        team.counters[PAIR] = k
        team.begins[:] = end + (shared.index.size - end) // 5 * np.arange(6)
        for chunk in (3, 0, 4, 2, 1):
            list_chunk(model, team, shared, chunk)
        assert np.min(team.lengths) >= 10, "chunks without rows show nothing"
        end = join_chunks(model, team, shared, k, end)
        assert np.array_equal(shared.start[rows], alone.start[rows])
    assert end == alone.start[-1]
    assert np.array_equal(shared.index[:end], alone.index[:end])


@pytest.mark.parametrize(("far", "crossed"), [(0.0, 0.0), (0.249, 0.0), (0.251, 1.0)])
def test_one_bob_that_crosses(far, crossed):
    """A bob has crossed as soon as it has moved by half the skin, and not before."""
    bobs = np.zeros((2, 8))
    bobs[:, 5] = 0.6 * far, -0.8 * far
    found = have_moved(SimpleNamespace(bobs=bobs), np.zeros((2, 8)), 0.5, 0)
    assert np.array_equal(found, crossed * (np.arange(8) == 5))


@pytest.mark.parametrize("kinds", [(-1, -1), (0, 1), (1, 0), (1, 1), (2, 1)])
def test_partners(kinds):
    """Bobs of the two kinds of a contact are partners of one another; without kinds, all are."""
    species = np.array([0, 1, 2, 1])
    for i, j in np.ndindex(4, 4):
        found = is_partner(species, partner_species(species, kinds, i), j)
        pair = sorted((species[i], species[j]))
        assert found == (kinds == (-1, -1) or pair == sorted(kinds)), (i, j)


def test_partners_without_species():
    """All bobs of a scene without species are partners."""
    none = np.zeros(0)
    assert is_partner(none, partner_species(none, (0, 1), 2), 3)
