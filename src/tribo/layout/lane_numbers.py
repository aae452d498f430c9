"""Numbers in which eight members of an ensemble differ, side by side in one array."""

from __future__ import annotations

import numpy as np

from tribo.compiler.lanes import LANES
from tribo.kernels.records import CHARGE, X_START, Y_START, Model
from tribo.layout.layout import Layout
from tribo.layout.loop_memory import together
from tribo.layout.member_numbers import MemberNumbers
from tribo.layout.tables import constants_of


class LaneNumbers:
    """The tables of a scene for eight members that differ in numbers.

    The tables of `model`, laid out for such members, become parts of one array, `memory`; `places`
    (8, numbers) is where each lane has its numbers in it.
    """

    def __init__(self, layout: Layout, model: Model) -> None:
        self._scene = layout.scene
        of_contacts = tuple(contact.numbers for contact in model.contacts)
        tables = model.constants, model.each, model.own, of_contacts
        (constants, each, own, of_contacts), self.memory = together(tables)
        contacts = zip(model.contacts, of_contacts, strict=True)
        self.model = model._replace(
            constants=constants,
            each=each,
            own=own,
            contacts=tuple(contact._replace(numbers=table) for contact, table in contacts),
        )
        columns = LANES * np.arange(layout.scene.count) + np.arange(LANES)[:, None]
        of_asperites = (
            self._indices(constants),
            self._indices(each)[[X_START, Y_START, CHARGE]],
            self._indices(own),
        )
        places = [table[:, columns].swapaxes(0, 1).reshape(LANES, -1) for table in of_asperites]
        places += [self._indices(table).T for table in of_contacts if table is not None]
        self.places = np.concatenate(places, axis=1)

    def _indices(self, table: np.ndarray) -> np.ndarray:
        """Where the array has each number of a table."""
        first = (table.ctypes.data - self.memory.ctypes.data) // table.itemsize
        return first + np.arange(table.size).reshape(table.shape)

    def rows(self, numbers: MemberNumbers) -> np.ndarray:
        """The numbers of members, in the order of `places`, (members, numbers)."""
        a = numbers.asperites
        members = len(a)
        constants = constants_of(self._scene, a.ravel()).reshape(-1, *a.shape)
        y = a["y"] + a["facing"] * a["pivot"]
        others = np.stack([a["x"], y, numbers.charges])
        of_surfaces = np.moveaxis(numbers.of_surfaces[:, a["surface"][0]], 2, 0)
        tables = np.concatenate([constants, others, of_surfaces]).swapaxes(0, 1)
        return np.concatenate([tables.reshape(members, -1), numbers.potential], axis=1)
