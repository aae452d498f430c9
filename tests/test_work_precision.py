"""Error against cost: which runs are on the front, and what errors are measured against."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

import tribo
from tribo.work_precision import Row, with_front, work_precision

FLOOR = 1e-9
ERRORS = st.sampled_from([1e-11, 1e-10, 1e-9, 1e-6, 1e-3, 1.0])  # some cannot be told apart
SECONDS = st.sampled_from([0.1, 0.2, 0.5, 1.0])
ROWS = st.lists(st.builds(Row, st.just("m"), st.just(1.0), ERRORS, st.just(1), SECONDS), min_size=1)


@given(ROWS)
def test_the_front(rows):
    """Along the front, more time buys less error; every other run is beaten by one on it."""
    marked = list(with_front(rows, FLOOR))
    told = [(row.seconds, max(row.error, FLOOR)) for row in marked]
    front = sorted({pair for pair, row in zip(told, marked, strict=True) if row.front})
    assert front
    for (time, error), (longer, better) in pairwise(front):
        assert time < longer and better < error
    for (time, error), row in zip(told, marked, strict=True):
        if not row.front:
            beating = [(t, e) for t, e in front if t <= time and e <= error]
            assert beating and (time, error) not in front


@pytest.mark.parametrize(("cutoff", "expected"), [(None, "gauss-radau-15"), (2.5, "dop853")])
def test_a_reference_is_good_where_potentials_are_rough(cutoff, expected):
    """A switch takes digits from one method, and the other is asked."""
    row = {"shape": (3, 1), "spacing": (1.1, 0.0), "asperite": tribo.Asperite(kappa=4.0)}
    upper = tribo.Surface("upper", bob=(-3.0, 0.9), velocity=(0.8, 0.0), **row)
    lower = tribo.Surface("lower", facing="up", **row)
    jones = tribo.LennardJones(0.1, 1.0)
    scene = tribo.Scene(
        (upper, lower), jones if cutoff is None else tribo.with_cutoff(jones, cutoff), 6.0
    )
    found = work_precision(scene, ["rkn8"], seconds=5.0)
    assert found.reference["method"] == expected
    assert found.reference["error"] < 1e-11
    errors = [row.error for row in found.rows]
    assert min(errors) < 1e-10
    assert found.best(1e-6).error <= 1e-6
    assert found.best(0.0) is None or min(errors) == 0.0
