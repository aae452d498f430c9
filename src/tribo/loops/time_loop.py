"""What all time loops of single runs have in common: to advance, to remember, and their samples."""

from abc import ABC, abstractmethod
from typing import Any

import numpy as np

from tribo.layout.elastic_body import ElasticBodies
from tribo.layout.layout import Layout
from tribo.ledger.samples import Samples
from tribo.loops.stiffness import Stiffness
from tribo.potentials.from_ase import Call

Columns = tuple[np.ndarray, ...]  # raw samples of a time loop; the first axis of each is time
Memory = dict[str, np.ndarray]  # all that a time loop needs to continue bit for bit


class TimeLoop(ABC):
    """A compiled time loop, and the state of its run."""

    layout: Layout
    adaptive: bool  # whether it chooses its steps
    step: float | None = None  # the length of its steps, if they are equal [time]
    calls: tuple[Call | ElasticBodies, ...] = ()  # ASE calculators and elastic bodies it calls
    before: Samples | None = None  # the first sample of the run that it goes on with
    clocks: Any  # (1,) of CLOCK: how far the run has come

    @abstractmethod
    def room(self, samples: int) -> Columns:
        """Arrays for so many samples."""

    @abstractmethod
    def advance(self, times: np.ndarray, columns: Columns, budget: int) -> int:
        """Take at most `budget` steps, and record the samples at `times`; a code of a status."""

    def forget_neighbours(self) -> None:  # noqa: B027 (a pair has none)
        """Let the next call make its neighbour list, if it has one, from the bobs' places."""

    @abstractmethod
    def memory(self) -> Memory:
        """All that another loop of this kind needs to continue, until this one goes on."""

    @abstractmethod
    def restore(self, memory: Memory) -> None:
        """Continue where another loop of this kind was."""

    def stiffness(self) -> Stiffness | None:
        """What equal steps have met of the stiffness of forces; None without reservoirs."""
        return None

    @abstractmethod
    def samples(self, times: np.ndarray, columns: Columns) -> Samples:
        """The first samples in `columns`, which were recorded at `times`."""
