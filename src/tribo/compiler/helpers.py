"""Compiling by several processes at once, through the machine code that they keep on disk.

numba compiles in one thread, and what a scene needs for the first time takes it ten seconds or
more.  Units and time loops do not depend on one another's machine code, so other processes can
compile some of them meanwhile.  What they have not done, or cannot do, is compiled here when it is
needed, as if there were no helpers.
"""

import os
import pickle
import signal
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Sequence
from contextlib import suppress
from typing import IO, Protocol

from tribo.compiler.numba_private import NATIVE
from tribo.system import THREADS_VARIABLE, allowed_cores

# A helper takes about as long to start as two small units take to compile, so fewer are not shared.
FEWEST_JOBS = 4
# More processes wait for the longest job.
MOST_PROCESSES = 4
# What Python runs in a helper.  It finds modules where this process does.
PROGRAM = "import sys; sys.path[:] = {path!r}; from tribo.compiler.helpers import serve; serve()"


class Job(Protocol):
    """Something to compile, that keeps its machine code on disk."""

    def is_missing(self) -> bool:
        """Whether it is neither in memory nor on disk."""

    def is_shared(self) -> bool:
        """Whether another process finds all classes that it names, and keeps it on disk."""

    def compile(self) -> None:
        """Compile it, or load it from disk.  Raises numba's errors."""


def compile_together(jobs: Sequence[Job]) -> None:
    """Compile jobs that are not on disk, together with helpers if there are many.

    Jobs are begun in their order.  Those that another process cannot do are left alone.
    """
    waiting = deque(job for job in jobs if job.is_missing() and job.is_shared())
    processes = min(_processes(), len(waiting))
    if len(waiting) < FEWEST_JOBS or processes < 2:
        return
    # Daemons, so that a process can end before its helpers; these end when their pipes do.
    helpers = [
        threading.Thread(target=_hand_out, args=(waiting,), daemon=True)
        for _ in range(processes - 1)
    ]
    for helper in helpers:
        helper.start()
    try:
        while True:
            try:
                job = waiting.popleft()
            except IndexError:  # helpers have taken the others
                break
            job.compile()
        for helper in helpers:
            helper.join()
    finally:
        waiting.clear()


def _processes() -> int:
    """How many processes compile at once, this one among them."""
    return min(allowed_cores(), MOST_PROCESSES) if NATIVE else 1


def _hand_out(waiting: deque[Job]) -> None:
    """Let a helper do jobs, the last ones first, until there are no more."""
    program = PROGRAM.format(path=sys.path)
    environment = {**os.environ, THREADS_VARIABLE: "1"}
    # What a helper that fails was given is compiled when it is needed.
    with (
        suppress(OSError, EOFError, IndexError, pickle.PickleError, AttributeError, TypeError),
        subprocess.Popen(
            [sys.executable, "-c", program],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=environment,
        ) as helper,
    ):
        assert helper.stdin is not None and helper.stdout is not None
        _wait_for_byte(helper.stdout)  # it has started
        while True:
            # As bytes, which can be read to their end where a class in them is unknown.
            pickle.dump(pickle.dumps(waiting.pop()), helper.stdin)
            helper.stdin.flush()
            _wait_for_byte(helper.stdout)


def _wait_for_byte(answers: IO[bytes]) -> None:
    """Wait until a helper has done something.  Raises EOFError if it has ended."""
    if not answers.read(1):
        raise EOFError


def serve() -> None:
    """Compile jobs from stdin until it ends; write a byte first, and after each of them."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # which is meant for the process that is helped
    with os.fdopen(os.dup(1), "wb", buffering=0) as answers:
        os.dup2(2, 1)  # nothing else is printed there
        while True:
            answers.write(b".")
            try:
                written = pickle.load(sys.stdin.buffer)
            except EOFError:
                return
            with suppress(Exception):  # it is compiled again where the error is reported
                job: Job = pickle.loads(written)
                job.compile()
