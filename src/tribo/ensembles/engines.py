"""Engines that compute the parts of an ensemble: threads, executors, and clients of Dask."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from itertools import islice
from typing import Any, Protocol, TypeVar

Job = TypeVar("Job")
Found = TypeVar("Found")

# Jobs under way for each thread: one more than it computes, so that it never waits.
AHEAD = 2
# Jobs under way on an engine, which is the largest number of workers that it keeps busy.  Their
# results wait in memory for their turn, some 1 MB each.
UNDER_WAY = 256


class Mapper(Protocol):
    """An engine that has no more than ``map``."""

    def map(self, function: Callable[[Job], Found], jobs: Iterable[Job], /) -> Iterable[Found]:
        """The function's values, in the order of the jobs."""


class Pending(Protocol):
    """A job that was submitted."""

    def result(self) -> Any:
        """The function's value, once it is known."""

    def cancel(self) -> object:
        """Drop the job if it has not begun."""


class Submitter(Protocol):
    """An engine that has ``submit``, as a client of dask.distributed."""

    def submit(self, function: Callable[[Job], Found], job: Job, /) -> Pending:
        """Let the engine compute the function's value."""


Engine = Executor | Submitter | Mapper


def run_jobs(
    engine: Engine,
    function: Callable[[Job], Found],
    jobs: Iterable[Job],
    under_way: int = UNDER_WAY,
) -> Iterator[Found]:
    """The function's values in the order of the jobs, of which few are under way at a time."""
    if not hasattr(engine, "submit"):
        yield from engine.map(function, jobs)
        return
    rest = iter(jobs)
    waiting: list[Pending] = [engine.submit(function, job) for job in islice(rest, under_way)]
    try:
        while waiting:
            yield waiting.pop(0).result()
            waiting.extend(engine.submit(function, job) for job in islice(rest, 1))
    finally:
        for pending in waiting:
            pending.cancel()


def in_threads(
    function: Callable[[Job], Found], jobs: Iterable[Job], threads: int
) -> Iterator[Found]:
    """The function's values in the order of the jobs, computed by threads of this process."""
    if threads == 1:
        yield from map(function, jobs)
        return
    with ThreadPoolExecutor(threads) as pool:
        yield from run_jobs(pool, function, jobs, AHEAD * threads)
