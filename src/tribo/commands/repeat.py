"""Runs that are repeated from their files, and how the two differ."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from tribo.model.identity import plain_table
from tribo.model.scene_file import scene_from
from tribo.plugins.unloaded import Code, code
from tribo.result import Result
from tribo.simulation import simulate
from tribo.validation import InputError


class Difference(NamedTuple):
    """A series of two runs that is not the same bit for bit."""

    name: str  # as "upper.w1"; "status" if the runs ended differently
    # largest difference in the unit of the series; inf where times differ, nan where values are
    size: float


def repeat(
    result: Result,
    plugins: bool = True,
    out: str | Path | None = None,
    resume: bool = False,
    threads: int | None = None,
) -> Result:
    """Run the scene of a result again with its settings; without `plugins` it may name no code.

    Code that the scene names is loaded from where the scene says, beside the file of the result.
    Raises InputError if the code has changed, or if the run began from the state of another run.
    """
    settings = result.settings
    if settings["start"] is not None:
        raise InputError(
            "start",
            "is the state of another run, which the file does not hold; repeat that run, and "
            "continue from its state with simulate(scene, start=state)",
        )
    if not plugins:
        with code(Code.REFUSE):
            scene_from(plain_table(result.scene))
    step = settings["step"]
    return simulate(
        result.scene,
        accuracy=result.accuracy,
        method=result.method,
        step=step if isinstance(step, float) else None,
        out=out,
        resume=resume,
        threads=threads,
    )


def differences(before: Result, after: Result) -> list[Difference]:
    """The series and error estimates that differ in any bit, the largest difference first."""
    if before.status != after.status:
        return [Difference("status", np.inf)]
    one, other, none = _series(before), _series(after), np.empty(0)
    pairs = {name: (one.get(name, none), other.get(name, none)) for name in one | other}
    found = []
    for name, (a, b) in pairs.items():
        if a.tobytes() != b.tobytes():
            gap = np.abs(a - b) if a.shape == b.shape else np.inf
            found.append(Difference(name, float(np.max(gap, initial=0.0))))
    return sorted(found, key=lambda difference: -difference.size)


def sentence(before: Result, after: Result, found: list[Difference]) -> str:
    """What differs between a run and its repetition, and why it may."""
    if not found:
        return "repeated, bit for bit"
    worst = f"{found[0].name} by {found[0].size:.1e}"
    text = f"not repeated bit for bit: {len(found)} series or values differ, {worst}"
    if before.version != after.version:
        return f"{text}; the file is by tribo {before.version}, and this is {after.version}"
    return f"{text}; other versions of numpy and numba, or another CPU, may round differently"


def _series(result: Result) -> dict[str, np.ndarray]:
    """All series, times and error estimates of a result by name."""
    return {str(name): each.values for name, each in result.to_xarray().variables.items()}
