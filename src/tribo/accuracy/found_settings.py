"""What a search for settings finds, and its cost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from tribo.accuracy.scales import Scales
from tribo.kernels.status import Status
from tribo.loops.integrate import Integration, Setting
from tribo.results.run_result import Cost


class Errors(NamedTuple):
    """Error estimates of a run.

    Attributes
    ----------
    run
        whose errors they are
    amplification
        that was known when they were made
    bounds
        on the errors, by quantity
    scales
        which errors are relative to
    excess
        the largest bound in units of the accuracy
    """

    run: Integration
    amplification: float | None
    bounds: dict[str, float]
    scales: Scales
    excess: float


@dataclass(frozen=True)
class FoundSettings:
    """Settings that a search found.

    Attributes
    ----------
    coarse, fine
        setting of the runs that estimate the error, and of the run that is delivered
    level
        of the fine setting, relative to the scales
    runs
        of the search, in order; the last is the one to deliver, and the two before it those that it
        was compared with, if it was
    amplification
        of a small change of the start; None where it was not measured
    met
        whether the fine run kept the accuracy
    evaluations
        of all forces, in all runs of the search
    seconds
        wall time of the search
    costly
        whether a further round would have cost too much
    stopped
        the status of runs with finer settings, if these stopped
    errors
        of the run to deliver; None if it was compared with no other
    """

    coarse: Setting
    fine: Setting
    level: float
    runs: tuple[Integration, ...]
    amplification: float | None
    met: bool
    evaluations: int
    seconds: float
    costly: bool = False
    stopped: Status | None = None
    errors: Errors | None = None


def cost_of(
    runs: Sequence[Integration],
    compile_seconds: float,
    ratio: float | None,
    search: FoundSettings | None = None,
    delivered: Integration | None = None,
) -> Cost:
    """What the runs or the search cost, and what a digit more or less would cost, by `ratio`.

    `delivered` is the run that the result is of, where it is none of these.
    """
    seconds = sum(run.seconds for run in runs) if search is None else search.seconds
    evaluations = sum(run.evaluations for run in runs) if search is None else search.evaluations
    if delivered is not None:
        seconds, evaluations = seconds + delivered.seconds, evaluations + delivered.evaluations
    return Cost(
        steps=(delivered or runs[-1]).steps,
        force_evaluations=evaluations,
        wall_seconds=seconds,
        compile_seconds=compile_seconds,
        digit_more=None if ratio is None else seconds * ratio,
        digit_fewer=None if ratio is None else seconds / ratio,
    )
