"""The driver of all compiled time loops: it calls a loop until that has ended.

A loop takes a budget of steps, and is paused where they do not suffice.  What happens between two
calls differs: a single run shows its progress, answers interrupts and is guarded
(:mod:`tribo.loops.integrate`), a member is guarded alone, and lanes with noise draw deviates.  Each
of these is a kind of :class:`Chunks`.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable

from tribo.kernels.status import PAUSED


class Chunks(ABC):
    """How many steps the calls of a loop take, and whether another one follows."""

    @abstractmethod
    def steps(self) -> int:
        """Steps of the next call, at most."""

    def goes_on(self, code: int) -> bool:
        """Look at the loop after a call, which returned `code`; whether a paused one goes on."""
        return True


class OfSize(Chunks):
    """Chunks of one size, with nothing between them."""

    def __init__(self, size: int) -> None:
        self._size = size

    def steps(self) -> int:
        return self._size


def drive(advance: Callable[[int], int], chunks: Chunks) -> int:
    """Call a loop, by `advance` with a budget of steps, until it has ended or may not go on.

    Returns the code of its status; PAUSED where `chunks` have ended it.
    """
    code = PAUSED
    goes_on = True
    while code == PAUSED and goes_on:
        code = advance(chunks.steps())
        goes_on = chunks.goes_on(code)
    return code
