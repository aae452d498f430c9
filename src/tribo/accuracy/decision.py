"""What follows a round of a search, a fine run and two coarse ones: the next level, or a stop.

The functions see the numbers of rounds alone, and run nothing.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from itertools import pairwise

import numpy as np

from tribo.accuracy.comparison import FROM_OUTSIDE, Errors, rounding
from tribo.accuracy.scales import EPSILON
from tribo.kernels.status import Status
from tribo.loops.integrate import Integration
from tribo.loops.setting import Setting

# A round stalls if its estimate exceeds this fraction of the one before.
STALLED = 0.5
# Stalled rounds in a row, after which round-off is taken for the limit.
MOST_STALLS = 2
# The next level is at most this times the last one; its square if the error is unknown.
LOWER = 0.1
# The next level aims at this fraction of the request.
AIM = 0.3
# The next round takes this fraction of equal steps that are too long.
SHORTER = 0.25
# Statuses of runs whose equal steps are too long.
TOO_LONG = (Status.ENCOUNTER_JUMPED, Status.NOT_FINITE, Status.NOT_CONVERGED)
# Levels closer than this are not told apart.
CLOSE = 3.0
# Largest error, relative to the scales, of a run that is delivered where finer ones stop.
KNOWN = 0.01
# Estimates below this many times the effect of rounding gain too little from finer settings.
MOST_ROUNDED = 3.0
# Work of a long run [force evaluations x asperites], which is refused early if its request is out
# of reach, and of all tries of `single_setting`: 5 to 10 s, by benchmarks/calibrate.py.
LONG_RUN = 1.5e8

# Of rounds that have made no run.
UNSET = Setting(step=np.nan)


@dataclass
class Round:
    """A round of a search, with its runs: two coarse ones, and the fine one last."""

    level: float  # of the errors of its coarse runs, relative to the scales
    stopped: Status | None = None  # the status of a run that stopped, if one did
    estimate: float = np.inf  # the largest error in units of the request, as first made
    excess: float = np.inf  # the same, with the amplification if it was measured after that
    steps: int = 0  # of the fine run
    work: float = 0.0  # of the fine run [force evaluations x asperites]
    coarse: Setting = UNSET
    fine: Setting = UNSET
    runs: list[Integration] = field(default_factory=list)
    errors: Errors | None = None  # of the fine run
    rough: bool = False  # whether its tolerances are below the rounding of forces


@dataclass
class Limits:
    """What bounds a search, as far as it is known."""

    wanted: float  # the smallest error of the request, relative to the scales
    order: int  # of the method
    adaptive: bool
    finest: float  # the finest level of coarse runs
    reached: float = np.inf  # the level of a pilot run that completed; infinite without one
    exhausted: bool = False  # whether the evaluations of any run are spent
    amplification: float | None = None  # of a small change of the start, where it was measured


class Stop(StrEnum):
    ENDED = "a run was ended from outside"
    EXHAUSTED = "the evaluations are spent"
    MET = "the request is met"
    FINEST = "no finer level exists"
    STALLED = "finer settings gain nothing"
    OUT_OF_REACH = "rounding, amplified, exceeds the request"
    BRACKETED = "slightly finer runs stop"


def decide(rounds: Sequence[Round], limits: Limits) -> float | Stop:
    """The level of the next round, or why there is none."""
    last = rounds[-1]
    if last.stopped in FROM_OUTSIDE:
        return Stop.ENDED
    if is_too_long(rounds, limits):
        return last.level * SHORTER**limits.order
    if limits.exhausted:
        return Stop.EXHAUSTED
    if limits.adaptive and last.stopped is not None:
        return _looser(rounds, limits)
    if last.estimate <= 1.0:
        return Stop.MET
    if last.level <= limits.finest:
        return Stop.FINEST
    if _stalls(rounds) >= MOST_STALLS:
        return Stop.STALLED
    if last.stopped is None and _is_out_of_reach(rounds, limits):
        return Stop.OUT_OF_REACH
    lower = AIM / last.estimate if np.isfinite(last.estimate) else LOWER**2
    lower = max(last.level * min(LOWER, lower), limits.finest)
    return lower if lower > too_fine(rounds, limits) else _looser(rounds, limits)


def is_too_long(rounds: Sequence[Round], limits: Limits) -> bool:
    """Whether equal steps are so long that the errors of the last round say nothing."""
    last = rounds[-1]
    if limits.adaptive or last.work >= SHORTER * LONG_RUN:
        return False
    return last.stopped in TOO_LONG or (len(rounds) == 1 and last.excess * limits.wanted > 1.0)


def best(rounds: Sequence[Round], limits: Limits) -> Round:
    """The finest round of about the smallest excess; the finest that stopped, if none is close."""
    known = [item for item in rounds if item.excess * limits.wanted <= KNOWN]
    candidates: Sequence[Round] = rounds
    if known or too_fine(rounds, limits) == 0.0:
        candidates = known or rounds
        least = min(item.excess for item in candidates)
        candidates = [item for item in candidates if STALLED * item.excess <= least]
    return min(candidates, key=lambda item: item.level)


def too_fine(rounds: Sequence[Round], limits: Limits) -> float:
    """The loosest level at which adaptive runs stopped; zero if none did."""
    levels = [item.level for item in rounds if item.stopped not in (None, *FROM_OUTSIDE)]
    return max(levels, default=0.0) if limits.adaptive else 0.0


def _stalls(rounds: Sequence[Round]) -> int:
    """How many rounds in a row, up to the last, gained little on the one before."""
    count = 0
    for before, after in pairwise(rounds):
        count = count + 1 if after.estimate > STALLED * before.excess else 0
    return count


def _is_out_of_reach(rounds: Sequence[Round], limits: Limits) -> bool:
    """Whether amplified rounding keeps finer settings from the request, or it is unknown."""
    last = rounds[-1]
    grown = limits.amplification
    if grown is None:
        return True
    error = last.excess * limits.wanted
    if too_fine(rounds, limits) > 0.0 and error > KNOWN:
        return False
    if grown * EPSILON > limits.wanted:
        return True
    rounded = rounding(grown, last.steps)
    return rounded > limits.wanted and error < MOST_ROUNDED * rounded


def _looser(rounds: Sequence[Round], limits: Limits) -> float | Stop:
    """A level between one at which runs stop and one at which they do not, if these are apart."""
    stop = too_fine(rounds, limits)
    completed = [item.level for item in rounds if item.stopped is None]
    level = (stop * (completed[-1] if completed else limits.reached)) ** 0.5
    return float(level) if np.isfinite(level) and level > CLOSE * stop else Stop.BRACKETED
