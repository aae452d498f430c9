"""Arrays in plug-ins: compiled code keeps their reference counts, by either way of compiling."""

import sys

import numpy as np
import pytest

import tribo
from tribo.potentials import from_points

R = np.linspace(0.5, 3.0, 40)
ROW = {"shape": (3, 1), "spacing": (1.5, 0.0)}


@pytest.mark.parametrize("row", [ROW, {}], ids=["rows", "pair"])
def test_runs_keep_the_arrays_of_a_table(row):
    """As many references as before, after runs and an ensemble of a scene with a table."""
    table = from_points(R, 1.0 / R)
    upper = tribo.Surface("upper", bob=(-1.0, 0.5), velocity=(0.5, 0.0), **row)
    scene = tribo.Scene([upper, tribo.Surface("lower", facing="up", **row)], table, 1.0)
    method = {"method": "verlet", "step": 0.05} if row else {"accuracy": 1e-6}

    def counts():
        return [sys.getrefcount(each) for each in table if isinstance(each, np.ndarray)]

    before = counts()
    runs = [tribo.simulate(scene, **method) for _ in range(3)]
    assert {str(run.status) for run in runs} == {"completed"}
    del runs
    assert len(before) == 4 and counts() == before
