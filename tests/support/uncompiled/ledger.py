"""The end of a run against the laws of its ledger and against an independent solver."""

from contextlib import ExitStack, contextmanager
from dataclasses import replace
from functools import cache
from typing import NamedTuple
from unittest import mock

import numpy as np

import tribo
from support import reference
from support.laws import identities, kind, tables
from support.scene_tables import scene_from
from support.uncompiled.scenes import PAIRS, SCENES

ALL = SCENES | PAIRS
# Scenes that no independent solver has: only the identities of the ledger are compared.
IDENTITIES_ALONE = ("damped twice", "waves", "damped", "block", "tilting")
NO_REFERENCE = {"surfaces": {}, "blocks": {}, "system": {}, "scales": {"energy": 0.5}}
SOLVED = 1e-10  # relative error of the independent solver: tests allow 1e-7


class PulledByHand(NamedTuple):
    """The stage and its spring as a plug-in."""

    stiffness: float
    speed: float
    start: float  # of the bar

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        """f2."""
        return self.stiffness * (self.start + self.speed * t - x), -fy


class ClampedByHand(NamedTuple):
    """What holds the ends of a bar that does not turn, as a plug-in."""

    stiffness: float  # kappa / bar_length

    def end_forces(self, t, phi, nu, twist):
        """f_L and f_R."""
        end = self.stiffness * twist
        x = -end * np.sin(phi)
        y = end * np.cos(phi)
        return x, y, -x, -y


class Pushed(NamedTuple):
    """Forces on the ends of a bar that move it along and across, and turn it."""

    strength: float

    def end_forces(self, t, phi, nu, twist):
        """f_L and f_R."""
        f = self.strength
        return f, 2.0 * f * twist, -3.0 * f * np.cos(t), f + 0.5 * f * nu


def waves(*numbers):
    """A field that depends on both coordinates, as a plug-in of a new class without a force."""

    class Waves(NamedTuple):
        amplitude: float
        kx: float
        ky: float

        def energy_at(self, x, y):
            """U."""
            return -self.amplitude * np.cos(self.kx * x) * np.cos(self.ky * y)

    return Waves(*numbers)


def scene_of(table):
    """The scene of a scene file's table, with plug-ins where `ALL` has them by name."""
    scene = scene_from(table)
    if table is ALL["by hand"]:
        upper, lower = scene.surfaces
        upper = replace(upper, drive=tribo.Custom(force=PulledByHand(1.2, 0.5, -0.6)))
        lower = replace(lower, bars=tribo.Ends(ClampedByHand(1.4 / 1.8)))
        scene = replace(scene, surfaces=(upper, lower))
    if table is ALL["pushed"]:
        upper, lower = scene.surfaces
        scene = replace(scene, surfaces=(upper, replace(lower, bars=tribo.Ends(Pushed(0.3)))))
    if table is ALL["waves"]:
        (field,) = scene.fields
        scene = replace(scene, fields=(replace(field, potential=waves(0.3, 3.1, 2.3)),))
    return scene


def simulate(table, **how):
    """A run of a scene file's table, which must complete."""
    result = tribo.simulate(scene_of(table), **how)
    assert result.status == "completed"
    return result


@contextmanager
def lowered(limits):
    """Limits by their places in the package, lowered so that a small scene counts as large."""
    with ExitStack() as stack:
        for place, limit in limits.items():
            stack.enter_context(mock.patch(f"tribo.{place}", limit))
        yield


@cache
def solution(name):
    """The end of a scene by the independent solver."""
    if name == "pushed":  # the pseudoworks of the ends are not reported, and do not cancel
        return NO_REFERENCE | {"no law": "w_ps is the sum of the pseudoworks"}
    if name in IDENTITIES_ALONE:
        return NO_REFERENCE
    return reference.solve(ALL[name], wanted=SOLVED).end


def ends(result):
    """Every table of the ledger at the end."""
    for surface, table in tables(result):
        yield surface.name if surface else "system", {q: table[q][-1] for q in table}


def limit_of_steps(name, method, step, order):
    """The end of a scene, table by table, extrapolated from runs with a step and half of it."""
    coarse, fine = (simulate(ALL[name], method=method, step=h) for h in (step, 0.5 * step))
    weight = 1.0 / (2**order - 1)
    for (place, one), (_, other) in zip(ends(coarse), ends(fine), strict=True):
        yield place, {q: other[q] + weight * (other[q] - one[q]) for q in other}


def compare(found, truth, tolerance):
    """Compare the ledger's end with its own laws and with the independent solution."""
    allowed = {name: tolerance * scale for name, scale in truth["scales"].items()}
    for place, table in found:
        for law, _, one, other in identities([table]):
            if law != truth.get("no law"):
                assert np.all(np.abs(one - other) <= allowed["energy"]), f"{place}: {law}"
        # Its reservoirs are at temperature 0.
        assert np.all(table.get("heat", 0.0) >= 0.0), place
        known = truth["surfaces"] if "theta" in table else truth["blocks"]
        for name, values in (known | {"system": truth["system"]}).get(place, {}).items():
            error = np.abs(table[name] - values)
            assert np.all(error <= allowed[kind(name)]), f"{place}: {name}"
