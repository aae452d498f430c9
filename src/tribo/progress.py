"""Progress on a terminal or in a notebook: how far a computation is, and the time left."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from tribo.validation import must_be

# Seconds before a bar appears: shorter computations show none.
DELAY = 1.0

# A function that is called with what is reached; or whether a bar is shown: None on a terminal and
# in a notebook alone, True in any case, False never.
Shown = Callable[[float], None] | bool | None


class ProgressBar:
    """A bar that appears on stderr after a second, and disappears at the end.

    Parameters
    ----------
    total : float
        What is to be reached.
    unit : str
        Its unit.
    everywhere : bool
        Whether to show it also where stderr is neither a terminal nor a notebook.
    """

    def __init__(self, total: float, unit: str, everywhere: bool = False) -> None:
        self._total = total
        self._unit = unit
        self._everywhere = everywhere
        self._began = time.perf_counter()
        self._bar: Any = None

    def __call__(self, reached: float) -> None:
        """Show what is reached."""
        if self._bar is None:
            if time.perf_counter() - self._began < DELAY:
                return
            from tqdm.auto import tqdm

            disable = False if self._everywhere else None
            self._bar = tqdm(total=self._total, disable=disable, leave=False, unit=self._unit)
            self._bar.start_t = time.time() - (time.perf_counter() - self._began)
        self._bar.n = reached
        self._bar.refresh()

    def __enter__(self) -> ProgressBar:
        return self

    def __exit__(self, *error: object) -> None:
        if self._bar is not None:
            self._bar.close()


class Reported:
    """A context that gives the function to call with what is reached, or None.

    Parameters
    ----------
    progress : callable, bool or None
        See :data:`Shown`.
    total : float
        What is to be reached.
    unit : str
        Its unit.

    Raises
    ------
    InputError
        `progress` is none of these.
    """

    def __init__(self, progress: Shown, total: float, unit: str) -> None:
        self._bar: ProgressBar | None = None
        self._function: Callable[[float], None] | None = None
        if progress is None or progress is True:
            self._bar = ProgressBar(total, unit, everywhere=progress is True)
        elif callable(progress):
            self._function = progress
        elif progress is not False:
            raise must_be("progress", "a function, True, False or None", progress)

    def __enter__(self) -> Callable[[float], None] | None:
        return self._bar or self._function

    def __exit__(self, *error: object) -> None:
        if self._bar is not None:
            self._bar.__exit__()
