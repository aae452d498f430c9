"""Runs leave nothing in memory: no object stays of one that has ended and was deleted."""

import gc
import tracemalloc
from collections import Counter
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy import stats

import tribo
from support.continued import chain, pair

MEMBERS = {"vary": {"upper.theta": stats.norm(0.0, 0.1)}, "keep": ["upper.W"]}


def noisy(k):
    """Another scene with noise for each k."""
    return replace(chain(times=(0.0, 0.1, 0.2)), seed=k)


CALLS = {
    "equal steps": lambda k: tribo.simulate(noisy(k), method="verlet", step=0.02),
    "an accuracy": lambda k: tribo.simulate(pair(1.0 + 0.01 * k), accuracy=1e-4),
    "an ensemble": lambda k: tribo.ensemble(
        noisy(k), 3, **MEMBERS, method="verlet", step=0.02, progress=False
    ),
    "a state": lambda k: tribo.simulate(noisy(k), method="verlet", step=0.02).state(),
}


@pytest.fixture
def frozen():
    """What exists before is left out of collections and counts, which take a tenth of the time."""
    gc.collect()
    gc.freeze()
    yield
    gc.unfreeze()


@pytest.fixture
def traced():
    """A function from which on memory is traced: compilation would take ten times as long."""
    yield tracemalloc.start
    tracemalloc.stop()


def census():
    """The number of objects of each type, and of arrays, which the collector does not list."""
    gc.collect()
    found = Counter(type(each).__name__ for each in gc.get_objects())
    arrays = tracemalloc.DomainFilter(True, np.lib.tracemalloc_domain)
    found["memory of an array"] = len(tracemalloc.take_snapshot().filter_traces([arrays]).traces)
    return found


@pytest.mark.usefixtures("frozen")
@pytest.mark.parametrize("name", CALLS)
def test_no_objects_stay(name, traced):
    """Of six runs, repeated with others, fewer objects stay than one a run, whatever they are."""

    def six(first):
        for k in range(first, first + 6):
            CALLS[name](k)
        return census()

    # What is loaded at first, and caches of classes, grow once; what stays of runs, each time.
    CALLS[name](30)
    traced()
    counts = [six(6 * k) for k in range(4)]
    growth = [after - before for before, after in pairwise(counts)]
    kinds = set.intersection(*(set(each) for each in growth))
    assert not {kind for kind in kinds if min(each[kind] for each in growth) >= 6}
