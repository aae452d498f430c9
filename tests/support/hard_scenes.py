"""Scenes on which simple integrators fail, and plug-ins that fail on purpose."""

import math
import time
from dataclasses import replace
from typing import NamedTuple

import tribo
import tribo.run.integrate
from tribo import (
    Asperite,
    Coulomb,
    Output,
    Scene,
    Surface,
)
from tribo.paper import scene as case

PATIENCE = 10.0  # seconds that a run may take before it is taken for one that hangs


def simulate(scene, **how):
    """Like tribo.simulate, but for a run that would not end: that fails."""
    began = None

    def watch(t):
        nonlocal began
        began = began or time.monotonic()
        assert time.monotonic() - began < PATIENCE, f"still at t = {t} after {PATIENCE:g} s"

    return tribo.simulate(scene, progress=watch, **how)


def changed(name, duration=40.0, potential=None, start=None, gap=None, speed=None, kappa=None):
    """A case of the paper with some things changed; only its end is recorded."""
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


class Broken(NamedTuple):
    """Repulsion that has no value nearer than `end`."""

    strength: float
    end: float

    def energy(self, r):
        """U(r)."""
        return self.strength / r if r > self.end else math.nan

    def force(self, r):
        """-dU/dr."""
        return self.strength / (r * r) if r > self.end else math.nan


def side_by_side(drive):
    """Two that hang side by side and attract each other collide head on."""
    surfaces = (
        Surface(name, bob=(x, 0.0), drive=drive) for name, x in (("left", -1.0), ("right", 1.0))
    )
    return Scene(tuple(surfaces), Coulomb(-1.0), 20.0, output=Output(samples=201))
