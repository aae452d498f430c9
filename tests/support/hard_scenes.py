"""Runs with a limit of steps, changed cases of the paper, and plug-ins that fail on purpose."""

import itertools
import math
import time
from dataclasses import replace
from typing import NamedTuple

import pytest

import tribo
from tribo import (
    Asperite,
    Coulomb,
    Morse,
    Output,
    Scene,
    Surface,
)
from tribo.loops import integrate
from tribo.paper import scene as case

# Most steps of all runs of a simulation: the longest here takes 4.6 million.
MOST_STEPS = 20_000_000


def simulate(scene, **how):
    """Like tribo.simulate, but fails if the runs take more than MOST_STEPS steps together.

    It sees a clock by which every chunk of steps takes the same time, so that all chunks have as
    many steps as the first.
    """
    chunks = 0

    def watch(t):
        nonlocal chunks
        chunks += 1
        assert chunks * integrate.FIRST_CHUNK < MOST_STEPS, (
            f"still at t = {t} after {MOST_STEPS} steps"
        )

    with pytest.MonkeyPatch.context() as patch:
        ticks = itertools.count()
        patch.setattr(integrate, "CHUNK_SECONDS", 1.0)
        patch.setattr(time, "perf_counter", lambda: next(ticks))
        return tribo.simulate(scene, progress=watch, **how)


def stopped(status, scene, **how):
    """The result of a run that must end with a status other than completed, and warn of it."""
    with pytest.warns(tribo.TriboWarning, match=status):
        result = simulate(scene, **how)
    assert result.status == status
    return result


def changed(name, duration=40.0, potential=None, start=None, gap=None, speed=None, kappa=None):
    """A case of the paper with some changes; only its start and its end are recorded."""
    scene = case(name)
    upper, lower = scene.surfaces
    if start is not None:
        upper = replace(upper, bob=(start, 0.0))
    if speed is not None:
        upper = replace(upper, velocity=(speed, 0.0))
    if gap is not None:
        lower = replace(lower, bob=(0.0, -gap))
    if kappa is not None:
        upper, lower = (replace(s, asperite=Asperite(kappa=kappa)) for s in (upper, lower))
    return Scene(
        (upper, lower),
        scene.interactions if potential is None else potential,
        duration,
        output=Output(samples=2),
    )


class Well(NamedTuple):
    """The potential of Morse, which is nan below a distance of `end`."""

    D: float
    alpha: float
    r0: float
    end: float = 0.0

    def energy(self, r):
        """U(r)."""
        return Morse(self.D, self.alpha, self.r0).energy(r) if r > self.end else math.nan

    def force(self, r):
        """-dU/dr."""
        return Morse(self.D, self.alpha, self.r0).force(r) if r > self.end else math.nan

    def feature(self):
        """As the potential of Morse."""
        return Morse(self.D, self.alpha, self.r0).feature()


def broken(end):
    """A case of the paper with a weak well, whose force is nan below a distance."""
    return changed("A", potential=Well(0.2, 1.0, 0.0, end))


def side_by_side(drive):
    """Two asperites side by side that attract each other and collide head on."""
    surfaces = (
        Surface(name, bob=(x, 0.0), drive=drive) for name, x in (("left", -1.0), ("right", 1.0))
    )
    return Scene(tuple(surfaces), Coulomb(-1.0), 20.0, output=Output(samples=201))
