"""Engines that compute the parts of an ensemble: threads, executors, and clients of Dask."""

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import chain, islice
from typing import Any, TypeVar

Task = TypeVar("Task")
Value = TypeVar("Value")

# It has ``submit`` or ``map`` as executors of concurrent.futures, or is a client of Dask.
Engine = Any

# Tasks under way for each thread: one more than it computes, so that it never waits.
AHEAD = 2
# Tasks under way on an engine, which keep as many workers busy; their results of 1 MB wait.
UNDER_WAY = 256


def run_tasks(
    engine: Engine,
    function: Callable[[Task], Value],
    tasks: Iterable[Task],
    under_way: int = UNDER_WAY,
) -> Iterator[Value]:
    """The function's values in the order of the tasks, of which few are under way at a time."""
    if not hasattr(engine, "submit"):
        yield from engine.map(function, tasks)
        return
    rest = iter(tasks)
    waiting = [engine.submit(function, task) for task in islice(rest, under_way)]
    try:
        while waiting:
            yield waiting.pop(0).result()
            waiting.extend(engine.submit(function, task) for task in islice(rest, 1))
    finally:
        for pending in waiting:
            pending.cancel()


def in_threads(
    function: Callable[[Task], Value], tasks: Iterable[Task], threads: int
) -> Iterator[Value]:
    """The function's values in the order of the tasks, computed by threads of this process.

    To start threads takes longer than a single task.
    """
    rest = iter(tasks)
    first = list(islice(rest, 2))
    tasks = chain(first, rest)
    if threads == 1 or len(first) < 2:
        yield from map(function, tasks)
        return
    with ThreadPoolExecutor(threads) as pool:
        yield from run_tasks(pool, function, tasks, AHEAD * threads)
