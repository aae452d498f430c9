"""Compiled code for a scene: its time loops, and probes, in which nothing moves."""

from __future__ import annotations

from typing import Any

from tribo.compiler.jit import EntryPoint, time_loop
from tribo.layout.contacts import with_room
from tribo.layout.layout import Layout
from tribo.layout.loop_memory import own_model
from tribo.plugins.compile_errors import compiling
from tribo.plugins.sources import source_stamp
from tribo.validation import InputError


def loop_of(layout: Layout, function: Any) -> Any:
    """A time loop for a scene, compiled at its first call."""
    return time_loop(function, source_stamp(layout.plugins))


def entry_point(
    layout: Layout, function: Any, fixed: tuple[Any, ...], examples: tuple[Any, ...]
) -> EntryPoint:
    """A time loop for a scene, compiled or loaded for arguments `fixed` and like `examples`.

    Raises InputError if a plug-in does not compile.
    """
    loop = loop_of(layout, function)
    with compiling(loop, layout.named_plugins):
        return EntryPoint(loop, fixed, examples)


class Probe:
    """A kernel that computes something of arrangements of a scene's bobs, one after another.

    Its first arguments are the model, the neighbour list, and the first arrangement.  It returns
    the number of those that are done: fewer than all where the list needs more room.
    """

    def __init__(self, layout: Layout, kernel: Any) -> None:
        self.model, self._calls = own_model(layout)
        self._layout, self._neighbours = layout, layout.neighbours()
        self._kernel = loop_of(layout, kernel)

    def __call__(self, count: int, *arguments: Any) -> None:
        """Compute so many arrangements with further arguments.

        Raises InputError if a plug-in does not compile, or a calculator fails.
        """
        done = 0
        with compiling(self._kernel, self._layout.named_plugins):
            while done < count:
                self._neighbours = with_room(self._neighbours)
                done = self._kernel(self.model, self._neighbours, done, *arguments)
        for call in self._calls:
            if call.error is not None:
                raise InputError("potential", f"the calculator raises {call.failure}")
