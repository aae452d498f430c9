"""Points of a table that stand out from what their neighbours predict.

Each point is compared with the cubic through the two points on either side of it.  A smooth
function has differences that change slowly from point to point.  One wrong value changes those of
five points, in proportions that the distances fix: 1, -4, 6, -4, 1 where these are equal.  A point
stands out if a change of its value alone would remove nearly all of the differences around it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from tribo.plugins.classes import parts
from tribo.report_card.card import Check
from tribo.report_card.scan import SMALLEST_SCALE, PotentialScan
from tribo.validation import shortened

# Points on either side from which a point is predicted.
SIDE = 2
# Smallest number of points that are judged: three neighbourhoods.
FEWEST = 12
# Largest acceptable difference from the neighbours, of a point that stands out [typical energy];
# and smallest one that counts, relative to the energies around: rounded values differ by less.
LARGEST = 1e-2
# Factor by which the differences around a wrong point decrease when its value is changed: at least
# 16 where it is a hundred times the others; a kink at a point gives 5.
REMOVED = 16.0
# Largest ratio of the distances between points near one that is judged.
UNEVEN = 3.0
# Points on either side whose differences are compared with that of a point that stands out.
NEAR = 8


def check_points(scan: PotentialScan) -> list[Check]:
    """Check that no point of a table stands out from its neighbours."""
    tables = (
        part.tabulated_points()
        for part in parts(scan.potential)
        if hasattr(part, "tabulated_points")
    )
    return [_check_table(scan, r, values) for r, values in tables if r.size >= FEWEST]


def _check_table(scan: PotentialScan, r: np.ndarray, values: np.ndarray) -> Check:
    off = deviations(r, values) / max(scan.typical_energy, SMALLEST_SCALE)
    text = f"{r.size} points of the table and the cubics through their neighbours"
    line = Check.of_worst("points", text, np.abs(off), LARGEST, r)
    if line.passed:
        return line
    worst = int(np.argmax(np.abs(off)))
    value = values[worst]
    expected = value - off[worst] * scan.typical_energy
    note = f"point {worst + 1} has U = {value:.6g}; its neighbours give about {expected:.3g}"
    others = [k + 1 for k in np.flatnonzero(np.abs(off) > LARGEST).tolist() if k != worst]
    more = f"; point {shortened(others)} stands out too" if others else ""
    return replace(line, note=note + more)


def deviations(r: np.ndarray, values: np.ndarray) -> np.ndarray:
    """By how much each point is off (n,) [energy], if it stands out; 0 elsewhere."""
    offsets = np.array([*range(-SIDE, 0), *range(1, SIDE + 1)])
    inner = np.arange(SIDE, r.size - SIDE)
    weights = _weights(r[inner[:, None] + offsets], r[inner])
    differences = np.zeros(r.size)
    differences[inner] = values[inner] - np.sum(weights * values[inner[:, None] + offsets], axis=1)
    # How the difference at point k + j changes with the value at point k, for j from -SIDE to SIDE.
    change = np.zeros((r.size, 2 * SIDE + 1))
    change[inner, SIDE] = 1.0
    for column, offset in enumerate(offsets):
        change[inner + offset, SIDE - offset] = -weights[:, column]
    padded = np.pad(differences, SIDE)
    near = np.lib.stride_tricks.sliding_window_view(padded, 2 * SIDE + 1)
    along = np.sum(near * change, axis=1)
    own = np.sum(change**2, axis=1)
    whole = np.sum(near**2, axis=1)
    off = along / own  # the change of the value that leaves least of the differences
    left = np.maximum(whole - along * off, 0.0)
    lone = (whole > REMOVED**2 * left) & (np.count_nonzero(change, axis=1) > SIDE)
    around = maximum_filter1d(np.abs(values), 2 * SIDE + 1, mode="nearest")
    large = np.abs(off) > np.maximum(REMOVED * _usual(differences), LARGEST * around)
    return np.where(lone & _even(r) & large, off, 0.0)


def _even(r: np.ndarray) -> np.ndarray:
    """Whether the distances around each point are about equal, which its cubics need."""
    spacings = np.diff(r)
    longest = maximum_filter1d(spacings, 4 * SIDE, mode="nearest", origin=-1)
    shortest = minimum_filter1d(spacings, 4 * SIDE, mode="nearest", origin=-1)
    return np.append(longest <= UNEVEN * shortest, False)


def _usual(differences: np.ndarray) -> np.ndarray:
    """The median size of the differences near each point, without those that it changes."""
    far = np.pad(np.abs(differences[SIDE:-SIDE]), SIDE + NEAR, constant_values=np.nan)
    windows = np.lib.stride_tricks.sliding_window_view(far, 2 * NEAR + 1)
    beyond = np.abs(np.arange(-NEAR, NEAR + 1)) > SIDE
    return np.nanmedian(windows[:, beyond], axis=1)


def _weights(r: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Weights (n, m) of the values at r (n, m) in the n polynomials through them, at one r each."""
    weights = np.ones_like(r)
    for one in range(r.shape[1]):
        for other in range(r.shape[1]):
            if other != one:
                weights[:, one] *= (at - r[:, other]) / (r[:, one] - r[:, other])
    return weights
