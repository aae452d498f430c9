"""Jumps, kinks and bends: what is left of a difference when one looks closer and closer.

A cell of the scan is looked at in nine points.  Of a smooth function the largest fourth difference
shrinks sixteenfold when the cell is halved; where the function jumps it stays, where its slope
does it halves, and where its second derivative does it shrinks fourfold.  So the half that has the
largest is looked at again, down to the spacing of floating-point numbers, and

    jump  the least over all levels of  fourth difference
    kink  the least over all levels of  fourth difference / distance between points
    bend  the least over all levels of  fourth difference / (distance between points)^2

are what is there beyond doubt.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy import differentiate

from tribo.report_card.card import Check
from tribo.report_card.specimen import Specimen

LEVELS = 32  # of looking closer: a cell of one percent ends as 1e-12
JUMP, KINK, BEND = 1e-9, 1e-4, 1e-2  # relative to the scale around
LENGTH = 60.0  # cells: about r, or less where cells are finer
AT_END = {"energy": 1e-10, "force": 1e-10, "slope": 1e-6}  # relative to the typical scale
INWARD = 1e-3  # of the cutoff: how far inside of it the force's slope is looked at
STENCIL = np.array([1.0, -4.0, 6.0, -4.0, 1.0])
NOT_PROMISED = "; smoothness() promises none"
LARGEST = (3.0, 2.0, 1.0)  # fourth difference of a jump, of a kink, of a bend of 1

Function = Callable[[np.ndarray], np.ndarray]


def check_smoothness(specimen: Specimen) -> list[Check]:
    """Nearer than its end, the potential has as many continuous derivatives as it declares."""
    promised = float(specimen.potential.smoothness_within())
    inside = specimen.edges[2:] < specimen.cutoff
    energy = strengths(specimen, lambda r: specimen.compiled(r)[0], 1)[:, inside]
    force = strengths(specimen, lambda r: specimen.compiled(r)[1], 0)[:, inside]
    lines = []
    for least, (name, found, bound) in enumerate(
        [
            ("jumps of energy", energy[0], JUMP),
            ("jumps of force", force[0], JUMP),
            ("kinks of force", force[1], KINK),
        ]
    ):
        worst = int(np.argmax(found))
        kept = promised >= least
        lines.append(
            Check(
                name,
                f"{len(found)} cells, zoomed into" + ("" if kept else NOT_PROMISED),
                float(found[worst]),
                bound if kept else None,
                float(specimen.edges[worst + 1]),
            )
        )
    return lines


def smooth_stretch(specimen: Specimen) -> tuple[float, float]:
    """Distances between which, the typical one among them, the force has no jump, kink or bend."""
    force = strengths(specimen, lambda r: specimen.compiled(r)[1], 0)
    rough = (force[0] > JUMP) | (force[1] > KINK) | (force[2] > BEND)
    nearer = specimen.edges[2:][rough & (specimen.edges[2:] <= specimen.length)]
    farther = specimen.edges[:-2][rough & (specimen.edges[2:] > specimen.length)]
    low = max(nearer, default=specimen.low)
    return float(low), float(min(farther, default=specimen.high))


def strengths(specimen: Specimen, function: Function, power: int) -> np.ndarray:
    """(3, cells) jump, kink and bend beyond doubt, relative to the scale around times r^power.

    Distances are in units of LENGTH cells.  Cells overlap by half, so that no place is on the edge
    of all that contain it.
    """
    begin, end = specimen.edges[:-2], specimen.edges[2:]
    middle = specimen.edges[1:-1]
    length = 0.5 * LENGTH * (end - begin)
    scale = specimen.scale(middle) * middle**power
    least = np.full((3, begin.size), np.inf)
    rows = np.arange(begin.size)
    for _ in range(LEVELS):
        points = begin[:, None] + (end - begin)[:, None] * np.linspace(0.0, 1.0, 9)
        with np.errstate(all="ignore"):
            values = np.lib.stride_tricks.sliding_window_view(function(points), 5, axis=1)
            fourth = np.abs(values @ STENCIL)
        fourth = np.where(np.isfinite(fourth), fourth, 0.0)
        first = np.argmax(fourth, axis=1)
        spacing = (end - begin) / (8.0 * length)
        left = fourth[rows, first] / scale
        least = np.minimum(least, [left / (size * spacing**k) for k, size in enumerate(LARGEST)])
        begin, end = points[rows, first], points[rows, first + 4]
    return least


def check_cutoff(specimen: Specimen) -> list[Check]:
    """What energy, force and the force's slope drop from to nothing where the potential ends."""
    end = specimen.cutoff
    if not math.isfinite(end):
        return []
    promised = float(specimen.potential.smoothness())
    last = np.nextafter(end, 0.0)
    energy, force = (float(x[0]) for x in specimen.compiled(np.array([last])))
    with np.errstate(all="ignore"):
        slope = differentiate.derivative(
            np.vectorize(specimen.written_force, otypes=[np.float64]),
            last,
            initial_step=INWARD * end,
            step_direction=-1,
        ).df
    unit, length = specimen.typical_energy, specimen.length
    jumps = {
        "energy": abs(energy) / unit,
        "force": abs(force) * length / unit,
        "slope": abs(float(slope)) * length**2 / unit,
    }
    return [
        Check(
            f"{name} at the cutoff",
            "drop to zero, in typical units" + ("" if promised >= least else NOT_PROMISED),
            jump,
            AT_END[name] if promised >= least else None,
            end,
        )
        for least, (name, jump) in enumerate(jumps.items())
    ]
