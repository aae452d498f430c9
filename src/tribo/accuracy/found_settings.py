"""What a search for settings finds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from tribo.kernels.status import Status
from tribo.run.integrate import Integration, Setting


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
    excess
        the largest bound in units of the accuracy
    """

    run: Integration
    amplification: float | None
    bounds: dict[str, float]
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
