"""Why compiled code could not be made of a plug-in: which of its lines it is, and what is wrong."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numba import njit
from numba.core.errors import NumbaError, UnsupportedBytecodeError

from tribo import plugins
from tribo.errors import InputError
from tribo.kernels.compiled import METHODS
from tribo.layout import Layout
from tribo.sources import is_own

Refusals = (NumbaError, UnsupportedBytecodeError)  # what the compiler raises


def complaint(layout: Layout, error: Exception) -> InputError:
    """What to say when the loop for a scene does not compile: whose fault it is, and why."""
    for field, plugin in _own(layout):
        for method in METHODS:
            reason = _fault(plugin, method)
            if reason is not None:
                return InputError(field, reason)
    names = ", ".join(type(plugin).__name__ for _, plugin in _own(layout))
    return InputError("plug-in", f"{names or 'the scene'} does not compile: {_reason(error)}")


def _own(layout: Layout) -> list[tuple[str, Any]]:
    """Every plug-in of the user's own, those inside others too, and its field in the scene."""
    contacts = layout.model.contacts
    places = [(f"interaction[{i}].potential", c.potential) for i, c in enumerate(contacts)]
    within = [(field, part) for field, item in places for part in _parts(item)]
    rest = [("plug-in", item) for item in layout.plugins[len(contacts) :]]
    return [(field, item) for field, item in within + rest if not is_own(type(item))]


def _parts(plugin: Any) -> list[Any]:
    """A plug-in and all that it holds."""
    held = [part for item in plugin if hasattr(item, "_fields") for part in _parts(item)]
    return [plugin, *held]


def _fault(plugin: Any, method: str) -> str | None:
    """What is wrong with a method, found by calling it and then by compiling it alone."""
    function = getattr(type(plugin), method, None)
    if function is None or function.__module__.startswith("tribo."):
        return None
    arguments = (1.0,) * METHODS[method]
    try:
        with np.errstate(all="ignore"):
            value = function(plugin, *arguments)
    except Exception as error:
        return plugins.failed(plugin, method, error)
    for item in value if isinstance(value, tuple) else (value,):
        if not isinstance(item, (int, float, np.integer, np.floating)):
            reason = f"gives {type(item).__name__} where a number is wanted"
            return plugins.at_line(plugin, method, None, reason)
    try:
        njit(error_model="numpy")(function)(plugin, *arguments)
    except Refusals as error:
        return plugins.at_line(plugin, method, _line(function, error), _reason(error))
    return None


def _line(function: Any, error: Exception) -> int | None:
    """The line of a function's source that the compiler complains about, if it says so."""
    place = getattr(error, "loc", None)
    file = function.__code__.co_filename
    if place is not None and place.filename == file:
        return int(place.line)
    missing = re.search(r"NameError: name '(\w+)'", str(error))
    if missing:
        return None
    found = re.search(r'File ".*", line (\d+)|\((\d+)\)\s*$', str(error), re.MULTILINE)
    return int(found[1] or found[2]) if found else None


def _reason(error: Exception) -> str:
    """What a compiler's message says is wrong, on one line."""
    noise = ("Failed in nopython", "During", "- Resolution failure")
    lines = [line.strip() for line in str(error).splitlines()]
    lines = [line for line in lines if line and not line.startswith(noise)]
    reason = lines[0] if lines else type(error).__name__
    if reason.endswith(":") and len(lines) > 1:
        reason += " " + lines[1].removeprefix(">>>").strip()
    reason = re.sub(r"\.*\s*Raised from .*", "", reason)
    if "type of <class 'function'>" in reason:
        reason += "; a function that it calls must be compiled too, by @numba.njit"
    return reason
