"""The result of a fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from tribo.files import strict_json
from tribo.fitting.data import Trace
from tribo.model.scene import Scene

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes


@dataclass(eq=False)
class Fit:
    """Parameters of a scene that fit a measured series best.

    Attributes
    ----------
    values : dict of str to float
        The values of the parameters, by their keys.
    half_width : dict of str to float
        Half-widths of their 95 % intervals, from the curvature of chi^2; inf where the data do not
        determine a parameter.
    covariance : ndarray, (parameters, parameters)
        Of the values, in their order and units.
    chi2 : float
        The sum of the squares of residuals over noise; with unknown noise, over that found.
    noise : float or ndarray
        The standard deviation of the data: given, or found from the residuals.
    residuals : xarray.DataArray, (time,)
        Measured less simulated values.
    profiles : dict of str to xarray.Dataset
        For each key ``chi2`` (value,), the smallest one over all other parameters; the 95 %
        interval is where it exceeds that of the fit by less than 3.84.
    notes : tuple of str
        What to know: parameters that are not determined, other minima, correlated residuals.
    scene : Scene
        The scene with the values.
    trace : Trace
        The measured series, with `t` and `values`.
    quantity : str
        The quantity that was measured.
    runs : int
        Number of points that were simulated.
    ranges : mapping of str to (float, float)
        The ranges of the parameters.
    """

    values: dict[str, float]
    half_width: dict[str, float]
    covariance: np.ndarray
    chi2: float
    noise: float | np.ndarray
    residuals: xarray.DataArray
    profiles: dict[str, xarray.Dataset]
    notes: tuple[str, ...]
    scene: Scene
    trace: Trace
    quantity: str
    runs: int
    ranges: Mapping[str, tuple[float, float]] = field(repr=False)

    def __str__(self) -> str:
        lines = [
            f"{key} = {value:.6g} +- {self.half_width[key]:.2g}"
            for key, value in self.values.items()
        ]
        degrees = self.trace.t.size - len(self.values)
        lines.append(f"chi^2 = {self.chi2:.5g} with {degrees} degrees of freedom, {self.runs} runs")
        return "\n".join([*lines, *self.notes])

    __repr__ = __str__

    def to_json(self) -> str:
        """Values, half-widths, covariance, chi^2, noise and notes as one object of strict JSON."""
        noise = self.noise
        return strict_json(
            {
                "values": self.values,
                "half_width": self.half_width,
                "covariance": self.covariance.tolist(),
                "chi2": self.chi2,
                "noise": noise.tolist() if isinstance(noise, np.ndarray) else noise,
                "degrees_of_freedom": self.trace.t.size - len(self.values),
                "runs": self.runs,
                "notes": list(self.notes),
            }
        )

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the measured and the fitted series, and the residuals below zero of their own."""
        from tribo.fitting.figure import draw

        return draw(self.trace, self.residuals.values, self.quantity, ax)
