"""The table of the atlas: each scene is run, and its end is compared with its reference."""

import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from tribo.accuracy.scales import EPSILON, reported_scales
from tribo.atlas.entries import STOP_TIME, HardScene
from tribo.kernels.status import Status
from tribo.layout.layout import lay_out
from tribo.result import Result
from tribo.simulation import prepare

# Outcomes of completed runs that fall short.
NOT_MET = "completed, accuracy not met"
NOT_HONEST = "completed, error above its estimate"


@dataclass(frozen=True)
class Row:
    """One line of the table."""

    name: str
    declared: str
    outcome: str
    as_declared: bool  # also the error is within the entry's bound
    # largest at the end, in scales; None where the run did not end as the reference
    error: float | None
    estimate: float | None  # the largest estimate of these errors; None without estimates
    seconds: float  # of all runs, compilation included

    def __str__(self) -> str:
        verdict = "as declared" if self.as_declared else f"NOT AS DECLARED ({self.declared})"
        error, estimate = ("" if x is None else f"{x:.1e}" for x in (self.error, self.estimate))
        return (
            f"{self.name:<28} {error:>8} {estimate:>8} {self.seconds:8.2f} s  "
            f"{self.outcome}, {verdict}"
        )


# The head of the lines that rows print.
HEAD = f"{'scene':<28} {'error':>8} {'estimate':>8} {'time':>10}  outcome"
# The difference from one quantity of a reference, the estimate of this error, and the rounding of
# the reference to a double, all in units of its scale.
Deviation = tuple[float, float | None, float]


def row(entry: HardScene) -> Row:
    """Run one scene, and compare its end with the reference. Raises KeyboardInterrupt."""
    began = time.perf_counter()
    result = prepare(entry.scene(), progress=False).compute_first()
    if result.status == Status.INTERRUPTED:
        raise KeyboardInterrupt
    return judge(entry, result, time.perf_counter() - began)


def judge(entry: HardScene, result: Result, seconds: float) -> Row:
    """Compare a result of an entry's scene, by any method, with the reference."""
    stops = STOP_TIME in entry.reference
    completed = result.status == Status.COMPLETED
    outcome = NOT_MET if completed and result.met is False else str(result.status)
    if stops == completed:  # the reference is of another end
        return Row(entry.name, entry.declared, outcome, False, None, None, seconds)
    found = list(_deviations(entry, result))
    honest = all(estimate is None or error <= estimate + more for error, estimate, more in found)
    outcome = outcome if honest else NOT_HONEST
    error = max(error for error, _, _ in found)
    estimates = [estimate for _, estimate, _ in found if estimate is not None]
    as_declared = outcome == entry.declared and error <= entry.bound
    ends = outcome, as_declared, error, max(estimates, default=None)
    return Row(entry.name, entry.declared, *ends, seconds)


def _deviations(entry: HardScene, result: Result) -> Iterator[Deviation]:
    """The difference of each quantity, asperite by asperite, or of a stop's time, in durations."""
    if STOP_TIME in entry.reference:
        (stop,) = entry.reference[STOP_TIME]
        yield abs(float(result.t[-1]) - float(stop)) / result.scene.duration, None, 0.0
        return
    scales = reported_scales(lay_out(result.scene), result.ledger)
    for key, digits in entry.reference.items():
        surface, _, name = key.partition(".")
        values = np.atleast_1d(result[surface][name][-1])
        for value, true in zip(values, map(float, digits), strict=True):
            bar = result.error_estimate[name]
            yield (
                scales.relative(name, abs(float(value) - true)),
                None if bar is None else scales.relative(name, bar),
                scales.relative(name, EPSILON * abs(true)),
            )
