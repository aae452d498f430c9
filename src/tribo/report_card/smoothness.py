"""Jumps, kinks and bends of a function, from differences on ever smaller cells.

A cell is evaluated at nine points.  When it is halved, the largest fourth difference of a smooth
function decreases by a factor of 16; at a jump of the function it stays, at a jump of the slope it
decreases by 2, and at a jump of the second derivative by 4.  The half with the largest difference
is halved again, down to the spacing of floating-point numbers.  Over all these levels,

    jump  is the smallest  fourth difference
    kink  is the smallest  fourth difference / distance between points
    bend  is the smallest  fourth difference / (distance between points)^2

so that a smooth function has none of them.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from tribo.report_card.card import Check
from tribo.report_card.scan import PotentialScan

# Number of halvings: a cell of one percent of r ends at 1e-12 of r.
LEVELS = 32
# Largest acceptable jumps of energy and force, and kinks, relative to the scale of the potential.
LARGEST_JUMPS = (1e-9, 1e-9, 1e-3)
# Largest relative distance between two errors that are one: halved cells are much shorter.
SAME_PLACE = 1e-7
# Unit of distance of kinks and bends [cells]: about r, or less where cells are finer.
LENGTH = 60.0
# Largest acceptable jumps at the cutoff, in typical units.
AT_END = {"energy": 1e-10, "force": 1e-10, "slope": 1e-6}
# Jump of the energy from which on a note says what it does to runs [typical energy].
NOTICED = 1e-3
# Distances inside the cutoff over which the slope of the force is taken [cutoff].
INWARD = (1e-5, 1e-6, 1e-7)
# Fourth difference.
STENCIL = np.array([1.0, -4.0, 6.0, -4.0, 1.0])

NOT_PROMISED = "; smoothness() promises none"
# Row of the place of a jump, kink or bend [length].
PLACE = 3
# Largest fourth difference of a jump, of a kink and of a bend of 1.
LARGEST = (3.0, 2.0, 1.0)

Function = Callable[[np.ndarray], np.ndarray]


def check_smoothness(scan: PotentialScan) -> Iterator[Check]:
    """Check that the potential has as many continuous derivatives within its cutoff as declared."""
    promised = float(scan.potential.smoothness_within())
    inside = scan.cells[1] < scan.cutoff
    energy = strengths(scan, lambda r: scan.compiled(r)[0], 1)[:, inside]
    force = strengths(scan, lambda r: scan.compiled(r)[1], 0)[:, inside]
    found = {"jumps of energy": energy[0], "jumps of force": force[0], "kinks of force": force[1]}
    cause: Check | None = None  # the first line that fails: each jump makes the next ones
    for least, (name, strength) in enumerate(found.items()):
        kept = promised >= least
        text = f"{len(strength)} cells, each halved {LEVELS} times" + NOT_PROMISED * (not kept)
        bound = LARGEST_JUMPS[least] if kept else None
        places = energy[PLACE] if name == "jumps of energy" else force[PLACE]
        line = Check.of_worst(name, text, strength, bound, places)
        if not line.passed and cause is None:
            cause = line
        elif not line.passed and cause is not None and _same_place(line, cause):
            line = replace(line, remedy=f"see {cause.name}, which has its cause at the same r")
        yield line


def _same_place(one: Check, other: Check) -> bool:
    """Whether two lines have their largest errors at one distance."""
    if one.where is None or other.where is None:
        return False
    return math.isclose(one.where, other.where, rel_tol=SAME_PLACE)


def strengths(scan: PotentialScan, function: Function, power: int) -> np.ndarray:
    """Jump, kink and bend of a function in every cell, and where they are, (4, cells).

    Values are relative to the scale of the force times r^power, and distances are in units of
    LENGTH cells.
    """
    begin, end = scan.cells
    middle = 0.5 * (begin + end)
    length = 0.5 * LENGTH * (end - begin)
    scale = scan.scale(middle) * middle**power
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
        begin = points[rows, first]
        end = points[rows, first + 4]
    return np.vstack([least, 0.5 * (begin + end)])


def check_cutoff(scan: PotentialScan) -> Iterator[Check]:
    """Check the jumps of energy, force and slope of the force at the cutoff."""
    end = scan.cutoff
    if not math.isfinite(end):
        return
    promised = float(scan.potential.smoothness())
    # What ends as a root is far from zero at the last distance; others are better known there.
    energy, force = (
        min(abs(_limit(values)), abs(float(values[3]))) for values in scan.compiled(_below(end))
    )
    slope = _slope_below(scan, end)
    unit = scan.typical_energy
    length = scan.length
    jumps = {
        "energy": energy / unit,
        "force": force * length / unit,
        "slope": abs(slope) * length**2 / unit,
    }
    for least, (name, jump) in enumerate(jumps.items()):
        kept = promised >= least
        text = "jump to zero, in typical units" + NOT_PROMISED * (not kept)
        bound = AT_END[name] if kept else None
        note = ""
        if name == "energy" and not kept and jump > NOTICED:
            note = (
                f"U jumps to zero by {jump:.2g} typical energies at r = {end:g}, where runs do "
                "not conserve energy; .with_cutoff() removes the jump"
            )
        yield Check(f"{name} at the cutoff", text, jump, bound, end, note)


def _below(end: float) -> np.ndarray:
    """Three distances just below a cutoff, and the last one."""
    return np.nextafter(end, 0.0) - end * np.array([*INWARD, 0.0])


def _slope_below(scan: PotentialScan, end: float) -> float:
    """Slope of the force just below `end`, extrapolated from three short distances."""
    r = _below(end)
    force = scan.compiled(r)[1]
    return _limit((force[:3] - force[3]) / (r[:3] - r[3]))


def _limit(values: np.ndarray) -> float:
    """The limit of values at the first three distances below a cutoff.

    Aitken's formula is exact for what approaches its limit as any power of the distance, as the
    square root at the end of a Hertz contact.
    """
    first, second, third = values[:3].tolist()
    change = (third - second) - (second - first)
    return float(third - (third - second) ** 2 / change if change != 0.0 else third)
