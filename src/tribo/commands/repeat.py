"""Runs that are repeated from their files, and how the two differ."""

from typing import Any

import numpy as np

from tribo.model.identity import plain_table
from tribo.model.scene_file import scene_from
from tribo.plugins.unloaded import Code, code
from tribo.result import Result
from tribo.simulation import simulate, simulate_prepared
from tribo.validation import InputError


def repeat(result: Result, plugins: bool = True, **others: Any) -> Result:
    """Run the scene of a result again with its settings; without `plugins` it may name no code.

    Code that the scene names is loaded from where the scene says, beside the file of the result.
    `others` are ``out``, ``resume`` and ``threads`` of :func:`tribo.simulate`.  Raises InputError
    if the code has changed, or if the run began from the state of another run.
    """
    settings: dict[str, Any] = result.settings
    step = settings["step"]
    if settings["start"] is not None:
        raise InputError(
            "start",
            "is the state of another run, which the file does not hold; repeat that run, and "
            "continue from its state with simulate(scene, start=state)",
        )
    if not plugins:
        with code(Code.REFUSE):
            scene_from(plain_table(result.scene))
    others |= {"accuracy": result.accuracy, "method": result.method}
    others["step"] = step if isinstance(step, float) else None
    initial = settings.get("initial", {})
    estimate = settings.get("estimate", True)
    if initial or not estimate:  # files of earlier versions do not contain them
        return simulate_prepared(result.scene, (initial, estimate), **others)
    return simulate(result.scene, **others)


def differences(before: Result, after: Result) -> dict[str, float]:
    """The series and error estimates that differ in any bit, and by how much, the largest first.

    "status" if the runs ended differently.  A difference is inf where times differ, nan where
    values are.
    """
    if before.status != after.status:
        return {"status": np.inf}
    one = _series(before)
    other = _series(after)
    none = np.empty(0)
    found = {}
    for name in one | other:
        a = one.get(name, none)
        b = other.get(name, none)
        if a.tobytes() != b.tobytes():
            gap = np.abs(a - b) if a.shape == b.shape else np.inf
            found[name] = float(np.max(gap, initial=0.0))
    return dict(sorted(found.items(), key=lambda item: -item[1]))


def sentence(before: Result, after: Result, found: dict[str, float]) -> str:
    """What differs between a run and its repetition, and why it may."""
    if not found:
        return "repeated, bit for bit"
    name, size = next(iter(found.items()))
    text = f"not repeated bit for bit: {len(found)} series or values differ, {name} by {size:.1e}"
    if before.version != after.version:
        return f"{text}; the file is by tribo {before.version}, and this is {after.version}"
    return f"{text}; other versions of numpy and numba, or another CPU, may round differently"


def _series(result: Result) -> dict[str, np.ndarray]:
    """All series, times and error estimates of a result by name."""
    return {str(name): each.values for name, each in result.to_xarray().variables.items()}
