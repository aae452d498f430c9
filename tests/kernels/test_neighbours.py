"""Neighbour lists: the same pairs as all pairs, and the same sums to round-off."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import tribo
from support.kernels import shared_kernel
from support.sliding import CUTOFF, long_slide, scene
from tribo.compiler.kept import keep
from tribo.compiler.lanes import LANES
from tribo.kernels.neighbours import refresh
from tribo.kernels.records import X, Y
from tribo.layout import contacts
from tribo.layout import layout as layouts
from tribo.loops import general
from tribo.threads.writable_memory import own_model


def listed_packs(neighbours, row: int) -> np.ndarray:
    """The packs in a row."""
    return neighbours.index[neighbours.start[row] : neighbours.start[row + 1]]


def assert_same(plain, by_list):
    """Sums of lists and of all pairs are in different orders; the slide magnifies round-off."""
    for name in ("upper", "lower"):
        for quantity in plain[name]:
            one = plain[name][quantity]
            other = by_list[name][quantity]
            assert np.max(np.abs(one - other)) <= 1e-9 * np.max(np.abs(one)), quantity


def distances(upper: np.ndarray, lower: np.ndarray, box: tuple) -> np.ndarray:
    """Distance of each upper bob from the nearest image of each lower bob."""
    difference = upper[:, None] - lower[None]
    for axis, length in ((0, box[0]), (2, box[1])):
        if length:
            difference[..., axis] -= length * np.round(difference[..., axis] / length)
    return np.sqrt(np.sum(difference**2, axis=-1))


def distance_of_box(bob: np.ndarray, bobs: np.ndarray, box: tuple) -> float:
    """Distance of a bob from the box around others."""
    low = np.min(bobs, axis=0)
    high = np.max(bobs, axis=0)
    away = np.abs(bob - 0.5 * (low + high))
    for axis, length in ((0, box[0]), (2, box[1])):
        if length:
            away[axis] = abs(away[axis] - length * np.round(away[axis] / length))
    return float(np.sqrt(np.sum(np.maximum(away - 0.5 * (high - low), 0.0) ** 2)))


@st.composite
def places(draw):
    """Random places of upper and lower bobs, from dense to far apart, and a box or none."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    extent = draw(st.sampled_from([0.5, 4.0, 30.0, 1e4]))
    counts = draw(st.tuples(st.integers(1, 40), st.integers(1, 40)))
    upper, lower = (rng.uniform(-extent, extent, (n, 3)) * [1.0, 0.05, 1.0] for n in counts)
    box = draw(st.sampled_from([(0, 0), (3.1, 0), (0, 7.5), (12.0, 3.0)]))
    return upper, lower, box


@shared_kernel
def update(model, neighbours):
    """What a time loop does before it computes contact."""
    refresh(model, neighbours)


@settings(max_examples=60)
@given(places(), st.floats(-100.0, 100.0))
def test_a_list_has_every_pair_within_reach(given_places, slide):
    """After any slide the list has the packs within cutoff and skin, in order, and no others."""
    upper, lower, box = given_places
    periodic = {key: value for key, value in zip("xz", box, strict=True) if value}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(contacts, "UNLISTED_PAIRS", 0)
        layout = layouts.lay_out(scene(upper, lower, periodic))
        model = own_model(layout)[0]
        neighbours = layout.neighbours()
    columns = layout.places.columns
    world = np.concatenate([upper, lower])
    for shift in (0.0, slide):
        model.bobs[[[X], [Y]], columns] = world[:, :2].T
        model.bobs[X, columns[: len(upper)]] += shift
        update(keep(model), keep(neighbours))
        neighbours = general.with_room(neighbours)
        update(keep(model), keep(neighbours))
        now = np.column_stack([*model.bobs[[[X], [Y]], columns], layout.depths])
        above = now[: len(upper)]
        below = now[len(upper) :]
        pack = columns[len(upper) :] // LANES
        near = distances(above, below, box) < CUTOFF
        for i, bob in enumerate(above):
            found = listed_packs(neighbours, columns[i])
            assert np.all(np.diff(found) > 0)
            assert set(pack[near[i]]) <= set(found.tolist())
            for n in found:
                wide = distance_of_box(bob, below[pack == n], box)
                assert wide < CUTOFF + 2.01 * layout.skin


@pytest.mark.parametrize(
    "periodic",
    [
        pytest.param({}, marks=pytest.mark.slow, id="open"),
        pytest.param({"x": 6.0, "z": 3.0}, id="periodic"),
    ],
)
def test_lists_give_all_pairs(periodic, monkeypatch):
    """A long slide with bobs that loop: every series is the same to round-off."""
    wanted = replace(long_slide(periodic), output=tribo.Output(samples=7))
    plain = tribo.simulate(wanted, method="verlet", step=0.003)
    monkeypatch.setattr(contacts, "UNLISTED_PAIRS", 0)
    by_list = tribo.simulate(wanted, method="verlet", step=0.003)
    assert plain.status == by_list.status == "completed"
    assert np.max(np.abs(plain["upper"].theta)) > np.pi
    assert np.max(np.abs(plain["lower"].w1)) > 0.0
    assert_same(plain, by_list)


@pytest.mark.parametrize(
    "method",
    [
        "verlet",
        *(pytest.param(m, marks=pytest.mark.slow) for m in ("dop853", "rkn8", "gauss-radau-15")),
    ],
)
def test_a_list_that_outgrows_its_room(method, monkeypatch):
    """All pairs are computed for rows without room, until the list is given more."""
    wanted = replace(long_slide({}), duration=4.0, output=tribo.Output(samples=5))
    how = {"step": 0.003} if method == "verlet" else {"accuracy": 1e-3}
    monkeypatch.setattr(contacts, "UNLISTED_PAIRS", 0)
    plain = tribo.simulate(wanted, method=method, **how)
    grown = []

    def exactly(neighbours):
        """Exactly the room that the list needed."""
        if neighbours is None or neighbours.start[-1] <= neighbours.index.size:
            return neighbours
        grown.append(int(neighbours.start[-1]))
        nowhere = np.full_like(neighbours.place, np.nan)
        return neighbours._replace(index=np.zeros(grown[-1], np.int32), place=nowhere)

    def cramped(self, splits):
        """A list with room for one."""
        return whole(self, splits)._replace(index=np.zeros(1, np.int32))

    whole = layouts.Layout.neighbours
    monkeypatch.setattr(general, "with_room", exactly)
    monkeypatch.setattr(layouts.Layout, "neighbours", cramped)
    by_list = tribo.simulate(wanted, method=method, **how)
    assert len(set(grown)) >= 2, "the room must run out on the way, not at the start alone"
    assert_same(plain, by_list)
