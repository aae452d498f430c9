"""Finding the settings that keep an accuracy: a run, and two coarser ones that agree with it.

A pilot finds the scales, from which local tolerances are made; methods with equal steps need none.
Then the level of the settings is lowered until the estimate meets the request, or until finer
settings gain nothing, or until the scene is seen to amplify round-off beyond the request.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from tribo.accuracy import scales as acc
from tribo.accuracy.estimate import distance, estimate, excess_of_request, rounding
from tribo.integrators.methods import Method
from tribo.run.integrate import Integration
from tribo.run.layout import Layout
from tribo.run.ledger import Ledger, ledger
from tribo.validation import InputError

PILOT = 1e-3  # tolerance level of the first run, which finds out the scales
STALLED = 0.5  # of the estimate before: less gained than that,
PATIENCE = 2  # so many times in a row, and round-off is the limit
ROUNDS = 6  # of tightening, before a request is called out of reach
ALONE = 0.75  # for a step of a run that is compared with none
APART = 0.3  # level of a run, in units of those of the coarser ones that it is compared with
NEAR = 0.5  # of the way to an encounter, for a step of the coarser; errors of the finer fall alike
TIGHT = 1e-9  # requests below, in which rounding may be seen
LOWER = 0.1  # by which a level is lowered at least
AIM = 0.3  # of what was asked for, that a lower level is to come to
PERTURBATION = 1e-11  # of the start, to see what the scene makes of it
LONG = 20.0  # seconds of runs, before which it is found out whether they can be had at all
LOOSER = 16.0  # by which a level is raised at first, for runs that are compared with none
TRIES = 8  # of raising it, less at a time whenever it was too much
SEEN = 1.25  # bars of a looser run in units of the request: the finest run shows its error itself
MORE = 1.05  # of the fewest evaluations yet, that does not tell yet
HALTED = ("Interrupted", "CalculatorFailed")  # what ends a run that another would not mend

PARTS = 32  # equal ones, after which a run stops: its steps are never those of a coarser one
MOST = 256  # stops of a coarser one
SAME = 1e-9  # of the duration: stops no further apart are one

Wanted = float | Mapping[str, float]
Attempt = Callable[..., Integration]  # a run with a setting, through times, from a start


class Stops(NamedTuple):
    """When a run and the two coarser ones stop, so that they share no sequence of steps.

    Every fourth stop is one of the first coarser run, all others of the second, lest a brush of
    one bob with another be seen by one run alone.
    """

    few: np.ndarray
    many: np.ndarray
    all: np.ndarray

    @classmethod
    def among(cls, times: np.ndarray) -> Stops:
        """For a run that is recorded at these times, and stops after PARTS of the whole as well."""
        parts = np.linspace(times[0], times[-1], PARTS + 1)
        k = np.searchsorted(times, parts).clip(1, times.size - 1)
        off = np.minimum(np.abs(parts - times[k - 1]), np.abs(parts - times[k]))
        return cls.at(np.union1d(times, parts[off > SAME * (times[-1] - times[0])]))

    @classmethod
    def at(cls, times: np.ndarray) -> Stops:
        """For a run that stops at these times."""
        inner = times[1:-1]
        fourth = np.arange(inner.size) % 4 == 3
        few, many = (_thinned(times, inner[mine]) for mine in (fourth, ~fourth))
        return cls(few, many, times)


def _thinned(times: np.ndarray, inner: np.ndarray) -> np.ndarray:
    """The inner ones of some times, or so many of them as a coarser run has, and the ends."""
    if inner.size > MOST:
        inner = inner[np.linspace(0, inner.size - 1, MOST).astype(int)]
    return np.concatenate([times[:1], inner, times[-1:]])


@dataclass(frozen=True)
class Tuned:
    """The settings found, and the runs that found them; the last is the one to deliver."""

    coarse: Any
    fine: Any
    level: float  # of the finer
    runs: tuple[Integration, ...]
    amplification: float | None  # of a small change of the start, where it was looked at
    met: bool  # whether the request was kept


def tightest(wanted: Wanted) -> float:
    """The smallest error that is asked for."""
    return min(wanted.values()) if isinstance(wanted, Mapping) else wanted


def named_in(wanted: Wanted) -> tuple[str, ...]:
    """The quantities that an accuracy names; none where it is for all of them."""
    return tuple(wanted) if isinstance(wanted, Mapping) else ()


def setting_at(
    layout: Layout, method: Method, scales: acc.ToleranceScales, level: float, near: float = NEAR
) -> Any:
    """Tolerances for an accuracy of about `level`, or the step whose errors fall as it does.

    `near` is how far of the way to the next encounter a step may go that tolerances leave free.
    """
    if method.adaptive:
        return acc.tolerances(layout, scales, level, near)
    return acc.unit_step(layout) * level ** (1.0 / method.order)


def tune(layout: Layout, method: Method, wanted: Wanted, stops: Stops, attempt: Attempt) -> Tuned:
    """Two settings, one finer, whose runs agree within what is wanted, if such can be found.

    ``attempt(setting, times, start)`` runs with a setting through times, from the scene's start or
    another.  Raises InputError if the request is out of reach and would take long to fail.
    """
    names = named_in(wanted)
    runs: list[Integration] = []
    scales = acc.first_guess(layout)
    level = method.first_level * tightest(wanted)
    if method.adaptive:
        pilot = setting_at(layout, method, scales, PILOT)
        runs.append(attempt(pilot, stops.few))
        _refuse_early(layout, method, wanted, attempt, pilot, runs[0], level)
    before, grown, stalls, excess = np.inf, None, 0, np.inf
    for _ in range(ROUNDS):
        if runs:
            scales = acc.tolerance_scales(layout, runs[-1].samples)
        coarse = setting_at(layout, method, scales, level)
        nearer = NEAR * APART ** (1.0 / method.order)
        fine = setting_at(layout, method, scales, APART * level, nearer)
        for setting, times in zip((coarse, coarse, fine), stops, strict=True):
            if not runs or runs[-1].status not in HALTED:
                runs.append(attempt(setting, times))
        if runs[-1].status in HALTED:
            break
        jumped = any(run.status == "EncounterJumped" for run in runs[-3:])
        if jumped and not method.adaptive:
            level *= LOWER**2
            continue
        halted = False
        if grown is None and tightest(wanted) < TIGHT:
            grown = amplification(layout, attempt, coarse, runs[-3], names)
            halted = grown is None
        excess = excess_of_request(*estimated(layout, runs[-1], runs[-3:-1], grown, names), wanted)
        stalls = stalls + 1 if excess > STALLED * before else 0
        if excess <= 1.0 or level <= acc.FLOOR or stalls == PATIENCE or halted:
            break
        if grown is None:
            grown = amplification(layout, attempt, coarse, runs[-3], names)
        if grown is None or grown * acc.EPSILON > tightest(wanted):
            break
        before = excess
        lower = AIM / excess if np.isfinite(excess) else LOWER**2
        level = max(level * min(LOWER, lower), acc.FLOOR)
    return Tuned(coarse, fine, APART * level, tuple(runs), grown, excess <= 1.0)


def loosest(
    layout: Layout,
    method: Method,
    tuned: Tuned,
    wanted: Wanted,
    attempt: Callable[[Any], Integration],
) -> Any:
    """The cheapest setting whose run agrees with the finest one as well as was asked for.

    None if there is none, or if looking for it would take long.  Runs that are compared keep apart
    from one another, and stop more often; a run alone need not.
    """
    finest = tuned.runs[-1]
    if finest.status != "completed" or finest.seconds > LONG:
        return None
    names, grown = named_in(wanted), tuned.amplification
    scales = acc.tolerance_scales(layout, finest.samples)
    found, least, level, factor, spent = None, np.inf, tuned.level, LOOSER, 0.0
    for _ in range(TRIES):
        if spent > LONG:
            break
        setting = setting_at(layout, method, scales, level, ALONE)
        run = attempt(setting)
        spent += run.seconds
        if run.status == "Interrupted":
            raise KeyboardInterrupt
        good = run.status == "completed" and run.evaluations <= MORE * least
        if (
            good
            and excess_of_request(*estimated(layout, finest, [run], grown, names), wanted) <= SEEN
        ):
            if run.evaluations < least:
                found, least = setting, run.evaluations
        else:
            level, factor = level / factor, factor**0.5
        level *= factor
    return found


def estimated(
    layout: Layout,
    fine: Integration,
    coarser: Sequence[Integration],
    grown: float | None,
    names: Any = (),
) -> tuple[dict[str, float], acc.Scales]:
    """Bounds on a run's errors, and the scales that they are judged by.

    `grown` is what becomes of a small change of the start, where it was looked at.  Nothing is
    known where a coarser run stopped early.  Raises InputError if `names` has what this scene does
    not report.
    """
    books = ledger(layout, fine.samples)
    for name in names:
        if not books.series(name):
            raise InputError(f"accuracy.{name}", "names nothing that this scene reports")
    compared = (_shared(layout, books, fine, coarse) for coarse in coarser)
    scales = acc.reported_scales(layout, books)
    rough, rounded = np.isfinite(layout.scene.smoothness), rounding(grown, fine.steps)
    bounds = estimate(books, compared, scales, bool(rough), rounded, names)
    if any(run.status != "completed" for run in coarser):
        bounds = dict.fromkeys(bounds, np.inf)
    return bounds, scales


def _shared(
    layout: Layout, books: Ledger, one: Integration, other: Integration
) -> tuple[Ledger, Ledger]:
    """Two runs at the times that both recorded; `books` are those of the one."""
    mine, theirs = one.samples.t, other.samples
    kept = theirs.at(mine)
    return books.rows(np.isin(mine, kept.t)), ledger(layout, kept)


def amplification(
    layout: Layout, attempt: Attempt, setting: Any, run: Integration, names: tuple[str, ...] = ()
) -> float | None:
    """What becomes of a small change of the start, in units of the change and of the scales.

    In the quantities named, or in any that has a scale.  None if the run that was to show it was
    halted.
    """
    nudged = layout.start.copy()
    nudged[: layout.model.asperites.size] += PERTURBATION
    other = attempt(setting, run.samples.t, nudged)
    if other.status in HALTED:
        return None
    books = ledger(layout, run.samples)
    scales = acc.reported_scales(layout, books)
    told = [name for name in names or acc.KINDS if scales.of(acc.kind_of(name)) > 0.0]
    return distance(*_shared(layout, books, run, other), scales, told) / PERTURBATION


def out_of_reach(wanted: float, grown: float) -> str:
    """Why a request cannot be met, with both numbers."""
    reason = ""
    if grown * acc.EPSILON < wanted:
        reason = "finer settings gain too little, though "
    return (
        f"accuracy {wanted:.1e} is out of reach: {reason}a change of {PERTURBATION:.0e} in the "
        f"start grows to {grown * PERTURBATION:.1e} of the scale, and round-off of "
        f"{acc.EPSILON:.1e} with it to about {grown * acc.EPSILON:.1e}"
    )


def _refuse_early(
    layout: Layout,
    method: Method,
    wanted: Wanted,
    attempt: Attempt,
    setting: Any,
    pilot: Integration,
    level: float,
) -> None:
    """Complain now, if a long run would end without the digits that are asked for."""
    longer = (PILOT / (APART * level)) ** (1.0 / method.order)
    if pilot.status != "completed" or pilot.seconds * longer < LONG:
        return
    grown = amplification(layout, attempt, setting, pilot, named_in(wanted))
    if grown is not None and grown * acc.EPSILON > tightest(wanted):
        raise InputError(
            "accuracy",
            out_of_reach(tightest(wanted), grown).removeprefix("accuracy ")
            + "; name the observables that matter, or give a method and a step; means over many "
            "starts are had by tribo.ensemble",
        )
