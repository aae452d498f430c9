"""The memory that a time loop may write, and loops and probes with memory of their own.

A layout is only read, so that several threads can run it.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from tribo.compiler.jit import LoopJob, time_loop
from tribo.compiler.kept import keep
from tribo.compiler.lanes import LANES
from tribo.compiler.lanes_memory import room
from tribo.compiler.pointers import map_arrays
from tribo.compiler.unit_errors import raising
from tribo.kernels.model import Model
from tribo.layout import contacts
from tribo.layout.elastic_body import NO_BODIES, ElasticBodies, bodies_of
from tribo.layout.layout import Layout, once_per_layout
from tribo.model.identity import plugins_of
from tribo.plugins.compile_errors import compiling
from tribo.potentials.from_ase import Call
from tribo.threads.kernel_model import model_of, with_own_memory
from tribo.threads.model_units import Wanted, fulfil, units_of
from tribo.threads.shared_run import new_team
from tribo.validation import InputError


def shared_loop(function: Any) -> Any:
    """A time loop that knows plug-ins by their units alone: the same for all scenes."""
    return time_loop(function)


class Common(NamedTuple):
    """What all loops of a layout have in common."""

    model: Model  # whose scratch no loop writes
    kept: Any  # the model, as loops are given it
    wanted: list[Wanted]  # the units that it lacks; empty once it has them
    units: dict[str, np.ndarray]  # name of a method -> addresses of all units that its loops need

    def fulfil(
        self, more: Sequence[Wanted] = (), loop: Callable[[], LoopJob] | None = None
    ) -> None:
        """Find the units that the model lacks, together with `more`, and the loop that calls them.

        Raises InputError.
        """
        fulfil([*self.wanted, *more], loop)
        self.wanted.clear()


@once_per_layout
def common_of(layout: Layout) -> Common:
    """What all loops of a layout have in common."""
    tables = layout.model._replace(surfaces=layout.model.surfaces.copy())
    elastic = NO_BODIES
    if any(surface.elastic is not None for surface in layout.scene.surfaces):
        columns = dict(enumerate(layout.places.columns[part] for part in layout.parts.values()))
        elastic = bodies_of(layout.scene, tables.surfaces, columns, tables.each.shape[1])
    team = None if tables.team is None else new_team(layout.scene, tables)
    model = model_of(tables, team, elastic)
    wanted = units_of(layout.scene, tables, model, layout.rows > 0)
    return Common(model, keep(model), wanted, {})


def own_model(layout: Layout) -> tuple[Model, tuple[Call | ElasticBodies, ...]]:
    """The model of a scene for one loop, with arrays and calculators that no other loop uses.

    It has the units that it needs for any method.  Raises InputError if a plug-in does not compile.
    """
    common_of(layout).fulfil()
    return with_memory(layout)


def with_memory(layout: Layout) -> tuple[Model, tuple[Call | ElasticBodies, ...]]:
    """The same with the units that are known already."""
    model = with_own_memory(common_of(layout).model)
    calls: tuple[Call | ElasticBodies, ...] = ()
    if layout.calculator_calls:
        depths = [layout.depths[part] for part in layout.parts.values()]
        calculators, calls = contacts.calculators(layout.scene, depths, model.surfaces.start)
        model = model._replace(calculators=calculators)
    if layout.model.team is not None:
        model = model._replace(team=new_team(layout.scene, layout.model))
    if model.elastic.columns.size > 0:
        calls = (*calls, ElasticBodies(layout.scene, model.elastic))
    return model, calls


def together(item: Any) -> tuple[Any, np.ndarray]:
    """Nested tuples whose arrays are parts of one array, and that array, restored at once."""
    numbers = room((sum(map(_size, arrays_in(item))),))
    place = 0

    def move(array: np.ndarray) -> np.ndarray:
        nonlocal place
        new = numbers[place : place + array.size].reshape(array.shape)
        new[...] = array
        place += _size(array)
        return new

    return map_arrays(move, item), numbers


def _size(array: np.ndarray) -> int:
    """Numbers that an array takes, to the end of a pack."""
    return -(-array.size // LANES) * LANES


def arrays_in(item: object) -> Iterator[np.ndarray]:
    """The arrays in nested tuples, in order."""
    if isinstance(item, np.ndarray):
        yield item
    elif isinstance(item, tuple):
        for each in item:
            yield from arrays_in(each)


class Probe:
    """A kernel that computes something of arrangements of a scene's bobs, one after another.

    Its first arguments are the model, the neighbour list, and the first arrangement.  It returns
    the number of those that are done: fewer than all where the list needs more room.
    """

    def __init__(
        self, layout: Layout, kernel: Any, units: Callable[[Model], list[Wanted]] | None = None
    ) -> None:
        """Prepare for a layout; `units` names those that the kernel needs beyond plug-ins."""
        self._layout = layout
        self._units = units
        self._neighbours = layout.neighbours()
        self._kernel = shared_loop(kernel)

    @cached_property
    def _model(self) -> tuple[Model, tuple[Call | ElasticBodies, ...]]:
        """The model, whose units are compiled with the first arrangements."""
        model, calls = own_model(self._layout)
        if self._units is not None:
            fulfil(self._units(model))
        return model, calls

    def set_schedules(self, table: np.ndarray) -> None:
        """Let numbers that follow schedules be those of a leg, a table of `Legs`."""
        self._model[0].schedules[...] = table

    def __call__(self, count: int, *arguments: Any, begin: int = 0) -> None:
        """Compute the arrangements from `begin` up to `count`.

        Raises InputError if a plug-in or a calculator fails.
        """
        done = begin
        model, calls = self._model
        with compiling(self._kernel, plugins_of(self._layout.scene)):
            while done < count:
                self._neighbours = contacts.with_room(self._neighbours)
                done = raising(self._kernel, keep(model), keep(self._neighbours), done, *arguments)
        for call in calls:
            if call.error is not None:
                raise InputError("potential", f"the calculator raises {call.failure}")
