"""The arrays of a time loop that runs eight members of an ensemble side by side."""

from __future__ import annotations

from typing import Any

import numpy as np

from tribo.compiler.jit import EntryPoint, time_loop
from tribo.compiler.lanes import LANES
from tribo.integrators.methods import Method
from tribo.kernels.samples import STORED, Record, initial_state
from tribo.layout.interleaved import interleaved
from tribo.layout.lane_numbers import LaneNumbers
from tribo.layout.layout import Layout
from tribo.layout.loop_memory import together
from tribo.layout.member_numbers import MemberNumbers
from tribo.loops.integrate import Columns
from tribo.plugins.compile_errors import compiling
from tribo.plugins.sources import source_stamp


class LaneLoop:
    """A scene for eight members of an ensemble, and memory of its own for their loop.

    Parameters
    ----------
    layout : Layout
        That of all members, but for their starts and seeds.
    method : Method
        How time advances.
    own_numbers : bool
        Whether members differ in numbers too.
    """

    def __init__(self, layout: Layout, method: Method, own_numbers: bool) -> None:
        self.layout = layout
        eight = interleaved(layout, own_numbers)
        self._memory, self._places_of_numbers = np.empty(0), np.empty((LANES, 0), np.int64)
        self._numbers: LaneNumbers | None = None
        if own_numbers:
            self._numbers = own = LaneNumbers(layout, eight.model)
            eight = eight._replace(model=own.model)
            self._memory, self._places_of_numbers = own.memory, own.places
        self.eight = eight
        self.coefficients: Any = method.coefficients
        coordinates, accounts = eight.room
        start = np.zeros(2 * coordinates)
        self._state = initial_state(start, accounts, method.remembers, method.splits)
        self._work = self.coefficients.workspace(eight.model, self._state)
        core = eight.q[0, : layout.core]
        self._recorded = np.concatenate([core, coordinates + core]), eight.s
        self._places = np.concatenate([eight.q, coordinates + eight.q], axis=1)
        self._own: list[np.ndarray] = []
        self._fresh: list[np.ndarray] = []

    def room(self, members: int) -> Columns:
        """Arrays for the samples of so many members, one after another."""
        layout, rows = self.layout, members * self.layout.times.size
        surfaces = len(layout.scene.surfaces)
        return (
            np.empty((rows, 2 * layout.core)),
            np.empty((rows, layout.accounts)),
            np.empty(rows),
            np.empty(rows),
            np.zeros((rows, surfaces, STORED)),
            np.empty((rows, *layout.sampled_baths)),
        )

    def rows_of(self, numbers: MemberNumbers | None, members: int) -> np.ndarray:
        """The numbers of members, (members, numbers); none where members do not differ in them."""
        if self._numbers is None:
            return np.empty((members, 0))
        assert numbers is not None
        return self._numbers.rows(numbers)

    def record(self, columns: Columns) -> Record:
        """These arrays for the loop."""
        return Record(*columns, *self._recorded)  # type: ignore[call-arg]

    def compile(self, loop: Any, arguments: tuple[Any, ...]) -> EntryPoint:
        """Compile the loop, or load it, for arguments like these behind the model.

        Raises InputError if a plug-in does not compile.
        """
        layout = self.layout
        compiled = time_loop(loop, source_stamp(layout.plugins))
        with compiling(compiled, layout.named_plugins):
            return EntryPoint(compiled, (self.eight.model,), arguments)

    def keep(self, items: tuple[Any, ...], others: list[np.ndarray]) -> Any:
        """Nested tuples in memory that :meth:`forget` restores, as it does some other arrays."""
        moved, numbers = together(items)
        self._own = [numbers, *others]
        self._fresh = [array.copy() for array in self._own]
        return moved

    def forget(self) -> None:
        """Forget the members that were run before."""
        for array, fresh in zip(self._own, self._fresh, strict=True):
            array[...] = fresh


def padded(members: int) -> int:
    """So many members, rounded up to whole blocks."""
    return -(-members // LANES) * LANES
