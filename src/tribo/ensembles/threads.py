"""A function of many parts, computed by threads, with the values in the order of the parts."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import islice
from typing import TypeVar

Part = TypeVar("Part")
Value = TypeVar("Value")

# Parts under way for each thread: one more than it computes, so that it never waits.
AHEAD = 2


def in_threads(
    function: Callable[[Part], Value], parts: Iterable[Part], threads: int
) -> Iterator[Value]:
    """The values of a function, in the order of the parts; few parts are under way at a time."""
    if threads == 1:
        yield from map(function, parts)
        return
    rest = iter(parts)
    with ThreadPoolExecutor(threads) as pool:
        waiting: list[Future[Value]] = []
        try:
            for part in islice(rest, AHEAD * threads):
                waiting.append(pool.submit(function, part))
            while waiting:
                yield waiting.pop(0).result()
                for part in islice(rest, 1):
                    waiting.append(pool.submit(function, part))
        finally:
            for future in waiting:
                future.cancel()
