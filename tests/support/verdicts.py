"""Verdicts on runs of scenes, by a reference that shares no code, at every recorded time."""

from __future__ import annotations

import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np

import tribo
from support.reference import SMALL, STOPS, Solution, Tables, UnsolvedError, kind_of, solve
from tribo.accuracy.comparison import LOST
from tribo.model.scene_file import scene_from

# What may happen to a scene: the first four are allowed.
OUTCOMES = (
    "right",  # completed, every error is within its bar
    "stopped",  # a named status
    "refused",  # an InputError of one line
    "unjudged",  # completed, but the reference cannot solve the scene
    "slow",  # interrupted after a time
    "silent",  # an error exceeds its bar
    "boast",  # a bar exceeds the request, which is called met
    "warning",  # a warning other than a TriboWarning
    "traceback",  # an exception other than an InputError
)
# Scenes with their solutions, for the default tests.
STORED = Path(__file__).with_name("random_scenes.json")
# Work of one solution of the reference after which it gives up: evaluations times the asperites and
# their pairs; 2 to 5 s.
MOST = 2e6
# Work of the second solution of a scene whose run seems wrong: the first one may be wrong by more
# than the difference of its tolerances, and jump an encounter.
SECOND = 20.0 * MOST
SECOND_STOPS = 2049
# Largest error of the reference, relative to the accuracy of the run, that needs no more precision.
SURER = 1e-5
# Error of the reference, relative to the scales, above which nothing is known of a scene.
UNKNOWN = 0.01
# Scales are the largest over a run, which the package and the reference see at other times: a
# hundredth is the most that they differ by for a sine at 33 times a period.
SCALE_ERROR = 0.05
# The spacing of doubles near 1.
EPSILON = 2.2e-16
# Roundings of an internal energy by which works may be wrong.
ROUNDINGS = 4.0


def truth_of(table: dict, work: float = MOST, stops: int = STOPS) -> Solution | str:
    """The reference's solution of a scene with so much work, or why there is none."""
    try:
        rows = Tables(table).rows
        most = work / (len(rows["asperites"]) + len(rows["pair"]))
        accuracy = table.get("numerics", {}).get("accuracy", 1e-8)
        solution = solve(table, most=most, wanted=max(SURER * accuracy, SMALL), stops=stops)
    except (UnsolvedError, NotImplementedError) as problem:
        return str(problem)
    error = solution.relative_error() if solution.has_work else 0.0
    return solution if error <= UNKNOWN else f"known to {error:.0e} of the scale alone"


def judged(table: dict) -> dict[str, Any]:
    """The verdict on a scene and its cost; a scene that seems wrong is solved more precisely."""
    began = time.perf_counter()
    truth = truth_of(table)
    cost = {"reference": truth if isinstance(truth, str) else truth.info.evaluations}
    cost["reference_seconds"] = time.perf_counter() - began
    row = verdict(table, truth)
    if row["outcome"] == "silent":
        row = verdict(table, truth_of(table, SECOND, SECOND_STOPS))
    return row | cost


def verdict(table: dict, truth: Solution | str, seconds: float = 15.0) -> dict[str, Any]:
    """What a run of a scene gives: the outcome, and the figures behind it.

    It is interrupted after `seconds` of the processor, without the time to compile.
    """
    began: list[float] = []

    def watch(t: float) -> None:
        began.append(time.process_time())
        if began[-1] - began[0] > seconds:
            raise KeyboardInterrupt

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            result = tribo.simulate(scene_from(table), progress=watch)
        except tribo.InputError as problem:
            lines = len(str(problem).splitlines())
            return {"outcome": "refused" if lines == 1 else "traceback", "message": str(problem)}
        except KeyboardInterrupt as interrupt:
            if not hasattr(interrupt, "result"):
                return {"outcome": "slow", "message": "interrupted outside a run"}
            result = interrupt.result
        except Exception as problem:
            return {"outcome": "traceback", "message": repr(problem)}
    found: dict[str, Any] = {
        "status": str(result.status),
        "met": result.met,
        "method": result.method,
        "evaluations": result.cost.force_evaluations,
        "seconds": result.cost.wall_seconds,
        "compile_seconds": result.cost.compile_seconds,
    }
    odd = [str(w.message) for w in caught if not issubclass(w.category, tribo.TriboWarning)]
    if odd:
        return found | {"outcome": "warning", "message": odd[0]}
    if result.status == "Interrupted":
        return found | {"outcome": "slow"}
    if result.status != "completed":
        return found | {"outcome": "stopped", "t": float(result.t[-1])}
    if isinstance(truth, str):
        return found | {"outcome": "unjudged", "message": truth}
    return found | compared(result, truth)


# Quantities that the reference does not compute: tests/ledger compares them with others.
WITHOUT_REFERENCE = ("swing_energy", "friction_work", "heat_swing", "stage_work", "e_pull")


def compared(result: tribo.Result, truth: Solution) -> dict[str, Any]:
    """Whether every error is within its bar, and the bars within the request where it is met."""
    found: dict[str, Any] = {"outcome": "right", "ratio": 0.0}
    bars = {
        name: bar for name, bar in result.error_estimate.items() if name not in WITHOUT_REFERENCE
    }
    for name, bar in bars.items():
        error = excess(result, truth, name)
        if bar is None:
            return found | {"outcome": "silent", "quantity": name, "error": error, "bar": None}
        ratio = error / bar if bar > 0.0 else np.inf if error > 0.0 else 0.0
        if not ratio <= found["ratio"]:
            found |= {"ratio": float(ratio), "quantity": name, "error": error, "bar": bar}
            found["scale"] = truth.scales[kind_of(name)]
            if not ratio <= 1.0:
                found["outcome"] = "silent"
    if found["outcome"] == "right" and result.met:
        noted = any(LOST in note for note in result.notes)
        smallest = EPSILON * truth.scales["internal"]
        if truth.scales["energy"] <= smallest and truth.has_work and not noted:
            return found | {"outcome": "boast", "message": "works below rounding have no note"}
        # A run compares its own works with that, which are wrong by some such roundings there.
        lost = truth.scales["energy"] <= (ROUNDINGS * smallest if noted else smallest)
        for name, bar in bars.items():
            scale = truth.scales[kind_of(name)]
            if lost and kind_of(name) in ("energy", "total"):
                scale = max(scale, truth.scales["internal"])
            allowed = result.accuracy * scale * (1.0 + SCALE_ERROR)
            worked = kind_of(name) not in ("energy", "total") or truth.has_work
            if worked and not bar <= allowed:
                boast = {"outcome": "boast", "quantity": name, "bar": bar, "scale": allowed}
                return found | boast
    return found


def excess(result: tribo.Result, truth: Solution, name: str) -> float:
    """The largest error of a quantity that the reference is sure of."""
    worst = 0.0
    for ours, theirs in zip(result.ledger.series(name), truth.series(name), strict=True):
        unknown = truth.error[name] + EPSILON * np.abs(theirs)
        with np.errstate(invalid="ignore"):
            errors = np.abs(ours - theirs) - unknown
        worst = float(np.max(errors, initial=worst)) if np.all(np.isfinite(ours)) else np.inf
    return worst
