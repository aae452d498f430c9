"""The paper's cases A to E: their scenes, and results from which numbers at any time are taken.

J. David Brown, *Work Done by Sliding Friction*.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache, cached_property
from typing import TYPE_CHECKING

import numpy as np

from tribo.model.asperite import Asperite
from tribo.model.drives import Forced, Free
from tribo.model.interaction import Interaction
from tribo.model.scene import Scene
from tribo.model.settings import Output
from tribo.model.surface import Surface
from tribo.paper.published_values import agrees, published
from tribo.potentials import Coulomb
from tribo.result import Result
from tribo.simulation import simulate

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

CASES = {
    "A": "forced sliding, repulsive",
    "B": "forced sliding, attractive",
    "C": "free sliding, repulsive",
    "D": "free sliding, attractive",
    "E": "free sliding from rest on a moving table",
}

# End of each case [time].  The paper does not print when its runs end; these are round times at
# which every number that it gives "at the end" agrees.  `Run.ends` finds all whole ones.
END = {"A": 40.0, "B": 26.0, "C": 50.0, "D": 50.0, "E": 50.0}
# Time to which every case is computed.
LAST = 60.0
# Relative error of the computed numbers: well below half a unit of the last digit printed.
ACCURACY = 1e-11
# Spacing of the samples [time].  Splines of order 7 between them are accurate to 1e-9.
SPACING = 0.05


def scene(case: str, attractive: bool = False) -> Scene:
    """A case of the paper, up to its end.

    Parameters
    ----------
    case : str
        "A" to "E".
    attractive : bool
        Sign of the force in case E, which the paper gives with both.
    """
    forced = case in "AB"
    pulls = case in "BD" or (case == "E" and attractive)
    parameters = {
        "A": Asperite(m1=1.0, m2=2.0, kappa=2.0),
        "B": Asperite(m1=5.0, m2=3.0, kappa=1.0),
    }.get(case, Asperite(m1=4.0, m2=8.0, kappa=2.0))
    upper_speed, lower_speed = (0.0, -0.5) if case == "E" else (0.5, 0.0)
    upper = Surface(
        "upper",
        facing="down",
        bob=(-10.0, 0.0),
        velocity=(upper_speed, 0.0),
        drive=Forced() if forced else Free(),
        asperite=parameters,
    )
    lower = Surface(
        "lower",
        facing="up",
        bob=(0.0, -0.3 if pulls else 0.0),
        velocity=(lower_speed, 0.0),
        asperite=parameters,
    )
    potential = Coulomb(-0.2 if pulls else 0.2)
    title = f"{case}: {CASES[case]}"
    return Scene((upper, lower), (Interaction(potential),), END[case], title=title)


class Run:
    """A case and its densely sampled result, from which numbers at any time are taken.

    Quantities are named as in the paper's table: "Theta" is the theta of the lower asperite, "wL +
    wR" the sum of the works on the ends, and all others are of the upper asperite.
    """

    def __init__(self, case: str, result: Result) -> None:
        self.case = case
        self.result = result
        self._splines: dict[str, BSpline] = {}

    @classmethod
    @cache
    def extended(cls, case: str, attractive: bool = False) -> Run:
        """A case computed beyond its end, to LAST, at ACCURACY."""
        times = np.round(np.arange(0.0, LAST + SPACING / 2, SPACING), 2)
        dense = replace(scene(case, attractive), duration=LAST, output=Output(times=tuple(times)))
        return cls(case, simulate(dense, accuracy=ACCURACY))

    @classmethod
    @cache
    def by_midpoint(cls, case: str, times: tuple[float, ...], step: float) -> Run:
        """A case by the paper's own method, recorded at the given times."""
        short = replace(scene(case), duration=times[-1], output=Output(times=times))
        return cls(case, simulate(short, method="midpoint", step=step))

    def series(self, quantity: str) -> np.ndarray:
        """A printed quantity at all recorded times, (times,)."""
        table = self.result["lower" if quantity == "Theta" else "upper"]
        parts = _parts(quantity).items()
        return np.sum([sign * table[name][:, 0] for name, sign in parts], axis=0)

    def error(self, quantity: str) -> float:
        """The error estimate of a printed quantity, in its unit: the sum of those of its parts."""
        twice = 2.0 if quantity.startswith("delta x") else 1.0
        return twice * sum(self.result.error_estimate[name] or 0.0 for name in _parts(quantity))

    def at(self, quantity: str, t: float | np.ndarray) -> np.ndarray:
        """A printed quantity at any times, by a spline that is accurate to 1e-9."""
        return np.asarray(self._spline(quantity)(t))

    def _spline(self, quantity: str) -> BSpline:
        from scipy.interpolate import make_interp_spline

        if quantity not in self._splines:
            self._splines[quantity] = make_interp_spline(self.result.t, self.series(quantity), k=7)
        return self._splines[quantity]

    def root(self, values: np.ndarray, near: float) -> float:
        """The time at which a series (times,) changes sign: that nearest to `near`, if several."""
        from scipy.interpolate import make_interp_spline
        from scipy.optimize import brentq

        t = self.result.t
        changes = np.flatnonzero(values[:-1] * values[1:] < 0.0)
        k = int(changes[np.argmin(np.abs(t[changes] - near))])
        spline = make_interp_spline(t, values, k=7)
        return float(brentq(spline, t[k], t[k + 1], xtol=1e-12))

    def derivative(self, quantity: str) -> np.ndarray:
        """The time derivative of a printed quantity, (times,)."""
        return np.asarray(self._spline(quantity).derivative()(self.result.t))

    def event(self, name: str, near: float) -> float:
        """The computed time of an event, as "time the bobs pass"; the paper prints `near`."""
        upper = self.result["upper"]
        lower = self.result["lower"]
        if name == "time the bobs pass":
            return self.root((upper.x_bob - lower.x_bob)[:, 0], near)
        if name == "time the centres of mass pass":
            # Shifted by half a spacing: a sample at the event itself would be zero, without sign.
            shift = 0.5 * SPACING * (upper.vx_cm - lower.vx_cm)[0, 0]
            return self.root((upper.x_cm - lower.x_cm)[:, 0] + shift, near) + 0.5 * SPACING
        quantity = "w" if name.startswith("net work") else "w1"
        return self.root(self.derivative(quantity), near)

    @cached_property
    def ends(self) -> list[int]:
        """Whole times at which every number that the paper gives "at the end" agrees."""
        rows = [r for r in published(self.case) if r["t"] == "end" and r["quantity"][:4] != "sign"]

        def all_agree(t: float) -> bool:
            return all(agrees(float(self.at(r["quantity"], t)), r["printed"]) for r in rows)

        return [t for t in range(20, int(LAST) + 1) if all_agree(t)]


def _parts(quantity: str) -> dict[str, float]:
    """The series of the ledger whose sum is a printed quantity, each with its sign."""
    several = {
        "Theta": {"theta": 1.0},
        "wL + wR": {"wL": 1.0, "wR": 1.0},
        "w - w_ps": {"w": 1.0, "w_ps": -1.0},
        "delta e_int": {"delta_e_int": 1.0},
        "delta k_trans": {"delta_k_trans": 1.0},
    }
    return several.get(quantity, {quantity.removeprefix("delta "): 1.0})
