"""Plug-ins that raise an error while they run: no run goes on without their numbers."""

from typing import NamedTuple

import pytest

import tribo

HOW = {"method": "verlet", "step": 0.02}


class Walled(NamedTuple):
    """A repulsion that refuses distances below that of a wall."""

    strength: float
    wall: float

    def energy(self, r):
        if r < self.wall:
            raise ValueError("too near")
        return self.strength / r

    def force(self, r):
        if r < self.wall:
            raise ValueError("too near")
        return self.strength / (r * r)


def scene(wall):
    """A bob that passes another at a distance of 0.5."""
    surfaces = (
        tribo.Surface("upper", bob=(-1.0, 0.5), velocity=(1.0, 0.0)),
        tribo.Surface("lower", facing="up"),
    )
    return tribo.Scene(surfaces, Walled(0.1, wall), 2.0, output=tribo.Output(samples=3))


def single(scene):
    tribo.simulate(scene, **HOW)


def with_accuracy(scene):
    tribo.simulate(scene, accuracy=1e-3)


def members(scene):
    tribo.ensemble(scene, 2, {"upper.theta": [[0.0], [0.1]]}, keep=["upper.W"], **HOW)


@pytest.mark.parametrize(
    "call", [single, with_accuracy, pytest.param(members, marks=pytest.mark.thorough)]
)
def test_an_error_of_a_plugin_ends_the_run(call, capfd):
    """It is raised where the run was called, and printed nowhere; other distances are computed."""
    call(scene(wall=0.3))
    with pytest.raises(ValueError, match="too near"):
        call(scene(wall=0.8))
    assert capfd.readouterr().err == ""
