"""Pictures of periodic scenes show one period, and fill the room that they are given."""

import numpy as np
import pytest

import tribo
from tribo.plotting.pose import pose
from tribo.plotting.snapshots import _in_a_column, _in_two_columns


@pytest.fixture(scope="module")
def result():
    """A row of springs that slides by two of its three periods over another one."""
    upper = tribo.Surface(
        "upper",
        shape=(4, 1),
        spacing=(1.5, 0.0),
        bob=(0.2, 3.0),
        velocity=(1.0, 0.0),
        springs=tribo.Springs(stiffness=1.0, wrap=True),
    )
    lower = tribo.Surface("lower", facing="up", shape=(6, 1), spacing=(1.0, 0.0))
    potential = tribo.LennardJones(0.01, 1.0).with_cutoff(2.0)
    periodic = tribo.Periodic(x=6.0)
    scene = tribo.Scene((upper, lower), potential, 4.0, periodic=periodic)
    return tribo.simulate(scene, accuracy=1e-3)


def test_asperites_stay_in_one_period(result):
    """Each is moved by whole periods, with its bob; lattice springs do not cross the picture."""
    for t in (0.0, 1.3, 4.0):
        plain = pose(result, t)
        wrapped = pose(result, t, wrap=True)
        turns = (wrapped.bars - plain.bars)[:, 0] / 6.0
        assert np.allclose(turns, np.round(turns), atol=1e-12)
        assert np.allclose(wrapped.bobs - wrapped.bars, plain.bobs - plain.bars)
        assert np.ptp(wrapped.bars[:, 0]) < 6.0
        lengths = np.abs(np.diff(wrapped.bars[wrapped.joined, 0], axis=1))
        assert np.all(lengths < 3.0)
    assert np.max(np.abs(turns)) == 1.0
    assert len(wrapped.joined) < len(plain.joined) + 1


def test_wide_grids_fill_the_room():
    """Of four wide boxes in a wide place, two columns make the largest pictures."""
    boxes = np.tile([0.0, 22.0, 0.0, 5.0], (4, 1))
    assert (
        _in_two_columns(boxes, 500.0, 150.0).point < 0.6 * _in_a_column(boxes, 500.0, 150.0).point
    )
