"""Ctrl-C: an answer within half a second, whatever the program does at that time.

Python raises KeyboardInterrupt between two of its own instructions.  A compiler that runs for
seconds delays it, code that is called back from a compiler loses it, and between a call of LLVM and
the note that it has freed a module, it makes the module be freed twice.  While loops are compiled,
interrupts are therefore held, and a thread ends the program if nothing has answered in time.  Files
are complete at any time.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from contextlib import contextmanager

from tribo.system import pipe_of_signals

# As in `typing`, whose import would delay the answer.
TYPE_CHECKING = False

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from typing import Any, ParamSpec, TypeVar

    P = ParamSpec("P")
    R = TypeVar("R")

# Seconds for an answer before the program is ended.
PATIENCE = 0.25
# Seconds in which the thread that waits for interrupts notices one.
NOTICE = 0.05
# The exit status of a run that completed, and of a check that passed.
COMPLETED = 0
# The exit status of a run that stopped early, and of a check that failed.
STOPPED = 1

_MAIN = threading.main_thread()
_arrived = threading.Event()
_answered = threading.Event()
# Prints what a command that is ended has reached.
_report: list[Callable[[], None]] = []
# Files that have what a command has reached, from which it can go on.
_parts: list[str] = []


class Interrupted(KeyboardInterrupt):
    """An interrupt that ended a computation, with the partial `result`: a Result or a data set."""

    def __init__(self, result: Any) -> None:
        super().__init__("the attribute `result` of this exception has what was computed before")
        self.result = result

    def __reduce__(self) -> tuple[type[KeyboardInterrupt], tuple[()]]:
        """Pickle the interrupt alone: not all results can be sent to another process."""
        return KeyboardInterrupt, ()


def also_in_part(function: Callable[P, R], *args: P.args, **kwargs: P.kwargs) -> R:
    """Call a function; what it returns, or its partial result if it is interrupted."""
    try:
        return function(*args, **kwargs)
    except Interrupted as interrupt:
        return interrupt.result


def watch(json: bool) -> None:
    """Answer each interrupt of this program; `json` tells whether its command was given --json."""
    reader, writer = pipe_of_signals()
    signal.signal(signal.SIGINT, signal.default_int_handler)
    sys.unraisablehook = _report_lost
    signal.set_wakeup_fd(writer, warn_on_full_buffer=False)
    threading.Thread(target=_end_unanswered, args=(reader, json), daemon=True).start()


@contextmanager
def held() -> Iterator[None]:
    """Raise an interrupt that arrives in this block at its end."""
    usual = signal.getsignal(signal.SIGINT)
    received = []
    if usual is not signal.default_int_handler or threading.current_thread() is not _MAIN:
        yield
        return
    signal.signal(signal.SIGINT, lambda *_: received.append(True))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, usual)
    if received:
        raise KeyboardInterrupt


def answer() -> None:
    """Tell that an interrupt was received, and that what it stopped comes to an end."""
    _answered.set()


def report_by(function: Callable[[], None]) -> None:
    """Let a function print what the command has reached, if an interrupt ends the program."""
    _report[:] = [function]


def part_is_kept_in(path: str) -> None:
    """Name a file, which has what a command has reached, if an interrupt ends the program."""
    _parts.append(path)


def report(json: bool) -> None:
    """Print what a command has reached when it is ended, or its status, with `json` as JSON too."""
    if _report:
        _report[0]()
        return
    if json:
        os.write(1, b'{"status": "Interrupted"}\n')
    problem = "tribo: Interrupted: the command was interrupted before it had a result"
    for part in _parts:
        if os.path.exists(part):
            problem += f"; the same command with --resume goes on from {part}"
    os.write(2, f"{problem}\n".encode())


def _report_lost(lost: sys.UnraisableHookArgs) -> None:
    """Report an exception that Python cannot raise, unless it is of an interrupt.

    Objects that were not complete when it was raised fail when they are deleted.
    """
    if not (issubclass(lost.exc_type, KeyboardInterrupt) or _arrived.wait(NOTICE)):
        sys.__unraisablehook__(lost)


def _end_unanswered(reader: int, json: bool) -> None:
    """End the program after an interrupt that nothing answers."""
    while os.read(reader, 1) != signal.SIGINT.to_bytes():
        pass
    _arrived.set()
    if not _answered.wait(PATIENCE):
        report(json)
        os._exit(STOPPED)
