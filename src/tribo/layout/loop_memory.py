"""The arrays that belong to a time loop: those that kernels write, and its memory in one array.

A layout is only read, so that several threads can run it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from tribo.compiler.lanes import LANES
from tribo.compiler.lanes_memory import room
from tribo.compiler.pointers import map_arrays
from tribo.kernels.records import BOB_ROWS, Model
from tribo.layout import contacts
from tribo.layout.layout import Layout
from tribo.layout.threads import new_team
from tribo.potentials.from_ase import Call

# Tables of the kernels that are written, one column an asperite, and their numbers of rows.  In the
# model of a layout they are True where a loop needs them.
SCRATCH = {
    **dict.fromkeys(("drive", "inner", "external", "internal", "displaced", "friction"), 2),
    "bobs": BOB_ROWS,
    "swing_friction": 1,
    "end_forces": 4,
    "bath_momentum": 2,
}


def own_model(layout: Layout) -> tuple[Model, tuple[Call, ...]]:
    """The model of a scene for one loop, with arrays and calculators that no other loop uses."""
    model = with_scratch(layout.model, layout.model.each.shape[1])
    calls: tuple[Call, ...] = ()
    if layout.calculator_calls:
        depths = [layout.depths[part] for part in layout.parts.values()]
        calls = contacts.calculator_calls(layout.scene, depths)
        model = model._replace(calculators=contacts.calculators(layout.scene, calls))
    team = None if model.team is None else new_team(layout.scene, model)
    return model._replace(surfaces=model.surfaces.copy(), team=team), calls


def with_scratch(model: Model, columns: int) -> Model:
    """The model of a layout with the tables that a loop writes, with so many columns."""
    tables: dict[str, Any] = {name: room((SCRATCH[name], columns)) for name in _needed(model)}
    return model._replace(**tables)


def _needed(model: Model) -> list[str]:
    """The names of the tables that loops of a layout write."""
    return [name for name in SCRATCH if getattr(model, name) is not None]


def together(item: Any) -> tuple[Any, np.ndarray]:
    """Nested tuples whose arrays are parts of one array, and that array, restored at once."""
    numbers, place = room((sum(map(_size, arrays_in(item))),)), 0

    def move(array: np.ndarray) -> np.ndarray:
        nonlocal place
        new = numbers[place : place + array.size].reshape(array.shape)
        new[...] = array
        place += _size(array)
        return new

    return map_arrays(move, item), numbers


def _size(array: np.ndarray) -> int:
    """Numbers that an array takes, to the end of a block."""
    return -(-array.size // LANES) * LANES


def arrays_in(item: object) -> Iterator[np.ndarray]:
    """All arrays in nested tuples."""
    if isinstance(item, np.ndarray):
        yield item
    elif isinstance(item, tuple):
        for each in item:
            yield from arrays_in(each)
