"""Errors that plug-ins raise in units, which compiled code calls and no error leaves.

numba gives such an error to `sys.unraisablehook`, which prints it, and the unit returns zero: the
run would go on with wrong numbers.  Here the error is kept, and raised by the call of compiled
code.
"""

import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

# `errors` is the list for those of units that a thread calls, while it runs compiled code.
_thread = threading.local()
# The hook that was there before ours; empty as long as no unit can raise an error.
hooks_before: list[Callable[[Any], Any]] = []


def watch() -> None:
    """Keep the errors of units from now on, which those of this package do not raise."""
    if sys.unraisablehook is not _keep:
        hooks_before[:] = [sys.unraisablehook]
        sys.unraisablehook = _keep


def _keep(found: Any) -> None:
    """Keep an error of numba's wrapper for C where a thread runs compiled code; leave others."""
    errors = getattr(_thread, "errors", None)
    if errors is None or not str(found.object).startswith("<numba."):
        hooks_before[0](found)
    else:
        errors.append(found.exc_value)


@contextmanager
def keeping(errors: list[Exception]) -> Iterator[None]:
    """Append the errors of units to a list, in a block in which this thread runs compiled code."""
    before = getattr(_thread, "errors", None)
    _thread.errors = errors
    try:
        yield
    finally:
        _thread.errors = before


def raising(function: Callable[..., Any], *arguments: Any) -> Any:
    """Call compiled code, and raise the first error of its units."""
    if not hooks_before:
        return function(*arguments)
    errors: list[Exception] = []
    before = getattr(_thread, "errors", None)
    _thread.errors = errors  # as `keeping` does, which takes as long as a short run
    try:
        result = function(*arguments)
    finally:
        _thread.errors = before
    if errors:
        raise errors[0]
    return result


def raise_first(errors: list[Exception]) -> None:
    """Raise the first of some errors, if there is one."""
    if errors:
        raise errors[0]
