"""Progress on a terminal or in a notebook: how far a computation is, and the time left."""

import math
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from tribo.validation import must_be

# Seconds before a progress bar appears: shorter computations show none.
DELAY = 1.0
# How a bar looks: six digits of what is reached, the time spent and the time left.
FORMAT = "{desc}{percentage:3.0f}%|{bar}| {n:.6g}/{total:.6g} {unit} [{elapsed}<{remaining}]"
# A function that is called with what is reached; or whether a bar is shown: None on a terminal and
# in a notebook alone, True in any case, False never.
Shown = Callable[[float], None] | bool | None


class ProgressBar:
    """A bar that appears on stderr after a second, and disappears at the end."""

    def __init__(self, total: float, unit: str) -> None:
        self._how = {"total": total, "unit": unit, "bar_format": FORMAT, "leave": False}
        self._total = total
        self._bar: Any = None
        self._runs = ""

    def __call__(self, reached: float) -> None:
        if self._bar is None:
            from tqdm.auto import tqdm

            # The rate is that from now on: what was done before may have been read from a file.
            always = {"mininterval": 0.0, "miniters": 0, "delay": DELAY}
            self._bar = tqdm(initial=reached, desc=self._runs, **always, **self._how)
        self._bar.update(reached - self._bar.n)

    def of_runs(self, reached: float) -> None:
        """Show what is reached in one of many runs, at whose end the bar disappears."""
        self(reached)
        if reached >= self._total:
            self.close()

    def announce(self, number: int, runs: int, seconds: float | None) -> None:
        """Begin run `number` of `runs`; print the `seconds` predicted from here, if over DELAY."""
        self.close()
        self._runs = f"run {number} of {runs}: "
        if seconds is not None and DELAY <= seconds < math.inf:
            left = runs - number + 1
            plan = f"{left} run{'s' if left > 1 else ''} planned, about {seconds:.2g} s"
            print(plan, file=sys.stderr, flush=True)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
            self._bar = None


def shown(progress: Shown, total: float, unit: str) -> Callable[[float], None] | None:
    """The function to call with what is reached; see :data:`Shown`.  Raises InputError."""
    if progress is True or (progress is None and _is_watched()):
        return ProgressBar(total, unit)
    if callable(progress) or progress in (None, False):
        return progress if callable(progress) else None
    raise must_be("progress", "a function, True, False or None", progress)


@contextmanager
def reported(progress: Shown, total: float, unit: str) -> Iterator[Callable[[float], None] | None]:
    """The same, with a bar that disappears at the end of the block."""
    report = shown(progress, total, unit)
    try:
        yield report
    finally:
        if isinstance(report, ProgressBar):
            report.close()


# When the last block ended whose text was printed, by text.
_said: dict[str, float] = {}


@contextmanager
def announced(text: str, is_true: Callable[[], bool] = lambda: True) -> Iterator[None]:
    """Print a text on a terminal after a second of the block, if it is true then.

    Blocks with the same text that follow one another within a second are one: it is printed once.
    """
    if not (sys.stderr and sys.stderr.isatty()):
        yield
        return
    goes_on = time.monotonic() - _said.get(text, -math.inf) < DELAY

    def say() -> None:
        nonlocal goes_on
        if is_true():
            print(text, file=sys.stderr, flush=True)
            goes_on = True

    timer = threading.Timer(DELAY, say)
    timer.daemon = True
    if not goes_on:
        timer.start()
    try:
        yield
    finally:
        timer.cancel()
        if goes_on:
            _said[text] = time.monotonic()


def _is_watched() -> bool:
    """Whether stderr is a terminal, or this is a notebook."""
    ipython = sys.modules.get("IPython")
    if ipython is not None and getattr(ipython.get_ipython(), "kernel", None) is not None:
        return True
    return bool(sys.stderr and sys.stderr.isatty())
