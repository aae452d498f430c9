"""Jumps and kinks: what is left of a difference when one looks closer and closer.

A cell of the scan is looked at in nine points.  Of a smooth function the largest fourth difference
shrinks sixteenfold when the cell is halved; of a kink it halves, and of a jump it stays.  So the
half that has the largest is looked at again, down to the spacing of floating-point numbers, and

    jump  the least over all levels of (fourth difference)
    kink  the least over all levels of (fourth difference) / (distance between points)

are what is there beyond doubt.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from tribo.report_card.card import Check
from tribo.report_card.derivatives import limit
from tribo.report_card.specimen import Specimen

LEVELS = 32  # of looking closer: a cell of one percent ends as 1e-12
JUMP, KINK = 1e-9, 1e-4  # relative to the scale around; a kink's is the scale over r
AT_END = {"energy": 1e-10, "force": 1e-10, "slope": 1e-6}  # relative to the typical scale
INWARD = 1e-3  # of the cutoff: how far inside of it the force's slope is looked at
STENCIL = np.array([1.0, -4.0, 6.0, -4.0, 1.0])
NOT_PROMISED = "; smoothness() promises none"
OF_JUMP, OF_KINK = 3.0, 2.0  # the largest fourth difference of a jump, of a kink of 1

Function = Callable[[np.ndarray], np.ndarray]


def check_smoothness(specimen: Specimen) -> list[Check]:
    """Energy and force have as many continuous derivatives as the potential declares."""
    promised = float(specimen.potential.smoothness())

    def line(name: str, least: int, strengths: np.ndarray, bound: float) -> Check:
        worst = int(np.argmax(strengths))
        kept = promised >= least
        return Check(
            name,
            f"{len(strengths)} cells, zoomed into" + ("" if kept else NOT_PROMISED),
            float(strengths[worst]),
            bound if kept else None,
            float(specimen.edges[worst + 1]),
        )

    energy_jumps, _ = strengths(specimen, lambda r: specimen.compiled(r)[0], 1)
    force_jumps, force_kinks = strengths(specimen, lambda r: specimen.compiled(r)[1], 0)
    return [
        line("jumps of energy", 0, energy_jumps, JUMP),
        line("jumps of force", 1, force_jumps, JUMP),
        line("kinks of force", 2, force_kinks, KINK),
    ]


def strengths(specimen: Specimen, function: Function, power: int) -> tuple[np.ndarray, np.ndarray]:
    """The jump and the kink beyond doubt in each cell, relative to the scale around times r^power.

    Cells overlap by half, so that no place is on the edge of all that contain it.
    """
    begin, end = specimen.edges[:-2], specimen.edges[2:]
    jump = np.full(begin.size, np.inf)
    kink = np.full(begin.size, np.inf)
    middle = specimen.edges[1:-1]
    scale = specimen.scale(middle) * middle**power
    rows = np.arange(begin.size)
    for _ in range(LEVELS):
        points = begin[:, None] + (end - begin)[:, None] * np.linspace(0.0, 1.0, 9)
        with np.errstate(all="ignore"):
            values = np.lib.stride_tricks.sliding_window_view(function(points), 5, axis=1)
            fourth = np.abs(values @ STENCIL)
        fourth = np.where(np.isfinite(fourth), fourth, 0.0)
        first = np.argmax(fourth, axis=1)
        left = fourth[rows, first] / scale
        jump = np.minimum(jump, left / OF_JUMP)
        kink = np.minimum(kink, left / OF_KINK * 8.0 * middle / (end - begin))
        begin, end = points[rows, first], points[rows, first + 4]
    return jump, kink


def check_cutoff(specimen: Specimen) -> list[Check]:
    """What energy, force and the force's slope drop from to nothing where the potential ends."""
    end = specimen.cutoff
    if not math.isfinite(end):
        return []
    promised = float(specimen.potential.smoothness())
    last = np.nextafter(end, 0.0)
    energy, force = (float(x[0]) for x in specimen.compiled(np.array([last])))
    inner = np.longdouble(last)
    with np.errstate(all="ignore"):
        edge = specimen.written_force(inner)
        slope, _ = limit(
            lambda h: (edge - specimen.written_force(inner - h)) / h,
            np.longdouble(INWARD * end),
            2.0,
        )
    unit, length = specimen.typical_energy, specimen.length
    jumps = {
        "energy": abs(energy) / unit,
        "force": abs(force) * length / unit,
        "slope": abs(slope) * length**2 / unit,
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
