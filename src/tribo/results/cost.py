"""What a run cost."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Cost:
    """Steps, evaluations and times of a run.

    Attributes
    ----------
    steps : int
        Steps of the run that gave the result.
    force_evaluations : int
        Evaluations of all forces, in that run and in those that estimate its error.
    wall_seconds : float
        Time that these runs took [s].
    compile_seconds : float
        Time to compile the time loop, or to load it from disk [s].
    digit_more, digit_fewer : float or None
        Estimated times of a run with an accuracy ten times better or worse [s]; None if unknown.
    """

    steps: int
    force_evaluations: int  # of the run delivered and of those made to estimate its error
    wall_seconds: float
    compile_seconds: float
    digit_more: float | None = None  # seconds that one more digit would take; None: unknown
    digit_fewer: float | None = None  # and one fewer
