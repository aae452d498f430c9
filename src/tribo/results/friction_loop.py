"""The loop of the lateral force over a position that goes forth and back, as of a cantilever."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from tribo.results.averages import SampleMean, sample_mean
from tribo.results.run_result import RunResult, begin_of, stop_of
from tribo.results.stage import Leg, Pull, legs_of, pull_of, table_of
from tribo.validation import InputError, number

if TYPE_CHECKING:
    import xarray

# Part of the longer one of two legs that both must pass, at least, to make a cycle: the first and
# the last leg of a run may be incomplete.
COMMON = 0.9
# Relative difference of a cycle's area by samples and its work in the ledger that a note names.
COARSE = 0.02
# Columns of the table of cycles: unit and meaning.
COLUMNS = {
    "begin": ("time", "time at which the cycle begins"),
    "end": ("time", "time at which it ends"),
    "stroke": ("length", "positions that both legs pass"),
    "area": ("energy", "integral of the force over the position, forth and back"),
    "forward": ("force", "mean force over the positions of the leg in which they grow"),
    "backward": ("force", "mean force over the positions of the other leg"),
    "dissipation": ("energy", "work of the stage in the cycle; of held bars, the area"),
}


class Loop(NamedTuple):
    """A friction loop: means over its cycles, each with the half-width of its 95 % interval.

    Half-widths are those of independent cycles, and NaN where there is one.

    Attributes
    ----------
    area : SampleMean
        Integral of the drive's force over the position in a cycle [energy].
    forward, backward : SampleMean
        Mean force, over the position, on the way to larger x and back [force].
    dissipation : SampleMean
        Work of the stage in a cycle, from the ledger where it has it, else the area [energy].
    stroke : SampleMean
        Length of the positions that both ways have in common [length].
    cycles : xarray.Dataset
        The same of each cycle, with its times.
    position, force : ndarray, (times,)
        The position of the stage or of the held bars [length], and the force [force].
    note : str
        What to know of the loop; else empty.
    """

    area: SampleMean
    forward: SampleMean
    backward: SampleMean
    dissipation: SampleMean
    stroke: SampleMean
    cycles: xarray.Dataset
    position: np.ndarray
    force: np.ndarray
    note: str = ""


def loop(
    result: RunResult,
    surface: str,
    after: float | None = None,
    margin: float = 0.0,
    position: object = None,
) -> Loop:
    """The friction loop of a surface whose stage or bars go forth and back along x.

    The force is that of the drive, as for :meth:`pull_force`, over the position of the stage, or of
    the bars where they are held.  Each cycle is two consecutive legs, over the positions that both
    of them pass, which must be nine tenths of the longer one: incomplete legs are left out.

    Parameters
    ----------
    surface : str
        Name of the surface, which a stage pulls or whose bars are driven.  Undamped springs to a
        stage need no further series; with other drives, the scene's output asks for the series
        "forces".
    after : float, optional
        Time at which the first cycle may begin; by default the scene's ``output.run_in`` [time].
    margin : float
        Part of the stroke, from 0 to 0.45, that the mean forces leave out at either end, where the
        springs are still being stretched the other way.  Without it, the forward less the backward
        force is the area over the stroke.
    position : array_like, (times,), optional
        The position of the stage of a drive of one's own [length].

    Returns
    -------
    Loop
        Area, mean forces both ways, and dissipation of a cycle.

    Raises
    ------
    InputError
        If there is no such surface, `after` is no time of the run before its end, the position does
        not turn back, forces or places were not recorded, or the drive has no position.
    """
    begin = begin_of(result, after)
    margin = number("margin", margin)
    if not 0.0 <= margin <= 0.45:
        raise InputError("margin", f"must be from 0 to 0.45, got {margin:g}")
    pull = pull_of(result, surface, position)
    legs = legs_of(pull.position, begin, result.t)
    if len(legs) < 2:
        raise InputError(
            "surface",
            f'must be one whose stage or bars go forth and back; the position of "{surface}" does '
            f"not turn back after t = {begin:g}",
        )
    work = _work_of_stage(result, surface) if position is None else None
    cycles = _cycles(result.t, pull, work, legs, margin)
    if not cycles.sizes["cycle"]:
        raise InputError(
            "surface",
            f'must go forth and back over the same positions; no two legs of "{surface}" in a row '
            f"have {COMMON:.0%} of them in common",
        )
    mean = {str(name): sample_mean(each.values) for name, each in cycles.items()}
    return Loop(
        area=mean["area"],
        forward=mean["forward"],
        backward=mean["backward"],
        dissipation=mean["dissipation"],
        stroke=mean["stroke"],
        cycles=cycles,
        position=pull.position,
        force=pull.force,
        note=_note(result, cycles),
    )


def _cycles(
    t: np.ndarray, pull: Pull, work: np.ndarray | None, legs: Sequence[Leg], margin: float
) -> xarray.Dataset:
    """The cycles, each of two legs in a row; a leg belongs to one of them."""
    rows = []
    place = 0
    while place < len(legs) - 1:
        row = _cycle(t, pull, work, (legs[place], legs[place + 1]), margin)
        if row is not None:
            rows.append(row)
            place += 1
        place += 1
    return table_of(COLUMNS, "cycle", rows)


def _note(result: RunResult, cycles: xarray.Dataset) -> str:
    """What to know of the loop: that it stopped, or that areas depend on the samples."""
    notes = [stop_of(result)]
    area = cycles["area"].values
    gap = np.max(np.abs(area - cycles["dissipation"].values))
    if gap > COARSE * np.max(np.abs(area)):
        notes.append(
            f"areas differ by up to {gap:.2g} from the work of the stage, which is exact: samples "
            "are too far apart for the slips; record more"
        )
    return "; ".join(filter(None, notes))


def _work_of_stage(result: RunResult, surface: str) -> np.ndarray | None:
    series = result[surface]
    return np.asarray(series["stage_work"]) if "stage_work" in series else None


def _cycle(
    t: np.ndarray, pull: Pull, work: np.ndarray | None, legs: tuple[Leg, Leg], margin: float
) -> list[float] | None:
    """The row of a cycle; None where its legs have too few positions in common."""
    ends = [np.sort(pull.position[[leg.first, leg.last]]) for leg in legs]
    low = max(end[0] for end in ends)
    high = min(end[1] for end in ends)
    stroke = high - low
    if stroke < COMMON * max(end[1] - end[0] for end in ends):
        return None
    within = low + margin * stroke, high - margin * stroke
    area = 0.0
    dissipation = 0.0
    means = {}
    times = []
    for leg in legs:
        columns = [t, pull.position, pull.force] + ([] if work is None else [work])
        path = _between(np.array(columns)[:, leg.first : leg.last + 1], leg.along, low, high)
        area += float(np.trapezoid(path[2], path[1]))
        if work is not None:
            dissipation += float(path[3, -1] - path[3, 0])
        inner = _between(path, leg.along, *within)
        means[leg.along] = float(np.trapezoid(inner[2], inner[1]) / (inner[1, -1] - inner[1, 0]))
        times += [path[0, 0], path[0, -1]]
    if work is None:
        dissipation = area
    return [min(times), max(times), stroke, area, means[1.0], means[-1.0], dissipation]


def _between(path: np.ndarray, along: float, low: float, high: float) -> np.ndarray:
    """The part of a leg between two positions; rows are linear between samples.

    It begins where the leg last enters these positions, and ends where it first leaves them.
    """
    forward = path[1] if along > 0.0 else -path[1]
    start, stop = (low, high) if along > 0.0 else (-high, -low)
    before = np.flatnonzero(forward <= start)
    first = int(before[-1]) if before.size else 0
    beyond = np.flatnonzero(forward[first + 1 :] >= stop)
    last = first + 1 + int(beyond[0]) if beyond.size else forward.size - 1
    part = path[:, first : last + 1].copy()
    for end, near, value in ((0, 1, start), (-1, -2, stop)):
        reached = forward[first : last + 1]
        step = reached[near] - reached[end]
        share = 0.0 if step == 0.0 else float(np.clip((value - reached[end]) / step, 0.0, 1.0))
        part[:, end] += share * (part[:, near] - part[:, end])
    return part
