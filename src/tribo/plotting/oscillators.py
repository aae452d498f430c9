"""Where the dots of bath oscillators are drawn: in a row behind the bar, each displaced.

The order in the row is that of frequencies.  One factor magnifies all displacements of a result, so
that the largest is seen.  Torsional oscillators are not drawn: results do not record their angles.
"""

import numpy as np

from tribo.model.surface import Surface
from tribo.results.run_result import RunResult
from tribo.validation import InputError

# Most dots of a bar: of more oscillators, evenly spaced ones are drawn.
MOST = 12
# Distance of the row from the bar [rod length].
DISTANCE = 0.4
# The largest displacement in the drawing [rod length].
REACH = 0.25


def oscillator_dots(result: RunResult, samples: np.ndarray) -> dict[str, np.ndarray]:
    """The places of the dots at some samples: surface -> x and y, (n, asperites, dots, 2) [length].

    Raises InputError if there are no oscillators, or their displacements are not recorded.
    """
    factor = magnification(result)
    dots = {}
    for surface in _with_bath(result):
        values = surface.each
        series = result[surface.name]
        order = np.argsort(surface.bath.frequencies, kind="stable")
        shown = order[np.unique(np.linspace(0, order.size - 1, MOST).round().astype(int))]
        displacements = result.oscillators(surface.name)[samples][:, :, shown]
        spaced = np.linspace(-0.5, 0.5, shown.size + 2)[1:-1]
        along = values["bar_length"][:, None] * spaced * 0.9  # the row is a little shorter
        behind = DISTANCE * _rod(surface) * surface.facing_sign
        phi = series["phi"][samples][:, :, None]
        cos = np.cos(phi)
        sin = np.sin(phi)
        row = np.stack([cos * along - sin * behind, sin * along + cos * behind], axis=-1)
        bars = np.stack([series[f"{axis}_bar"][samples] for axis in "xy"], axis=-1)
        dots[surface.name] = np.asarray(bars[:, :, None] + row + factor * displacements)
    return dots


def magnification(result: RunResult) -> float:
    """The factor of all displacements in the drawing.  Raises InputError as above."""
    surfaces = _with_bath(result)
    if not surfaces:
        raise InputError(
            "bath", "no surface has bath oscillators along x and y; torsional ones are not drawn"
        )
    largest = max(float(np.abs(result.oscillators(each.name)).max()) for each in surfaces)
    return REACH * _rod(surfaces[0]) / largest if largest > 0.0 else 1.0


def _with_bath(result: RunResult) -> list[Surface]:
    return [each for each in result.scene.surfaces if each.bath.masses.size]


def _rod(surface: Surface) -> float:
    """The median length of the rods of a surface."""
    return float(np.median(surface.each["length"]))
