"""The loop for pairs without a compiler, which otherwise takes the general loop."""

import importlib
from contextlib import ExitStack
from copy import copy
from types import SimpleNamespace
from unittest import mock

import numpy as np


def with_fields(loop):
    """The loop, told of fields by name, as compiled code is."""

    def call(*arguments):
        return loop(*map(told, arguments))

    def told(x):
        if type(x) is tuple:
            return tuple(map(told, x))
        is_record = isinstance(x, np.ndarray) and x.dtype.names is not None
        return x.view(np.recarray) if is_record else x

    return call


class EntryPoint:
    """Uncompiled, in place of tribo.compiler.jit.EntryPoint."""

    def __init__(self, loop, fixed, examples, made=()):
        self._loop = with_fields(loop)
        self._fixed = fixed

    def with_fixed(self, *fixed):
        other = copy(self)
        other._fixed = fixed
        return other

    def __call__(self, *arguments):
        return self._loop(*self._fixed, *arguments)


def registers_as_arrays():
    """The loop for pairs without a compiler."""
    stack = ExitStack()
    importlib.import_module("tribo.loops.pair")
    config = SimpleNamespace(DISABLE_JIT=False)
    stack.enter_context(mock.patch("tribo.loops.pair_records.config", config))
    stack.enter_context(mock.patch("tribo.loops.pair.EntryPoint", EntryPoint))
    # Where nothing is compiled, the numbers of a potential are the potential itself.
    itself = mock.patch("tribo.pair.loop.with_numbers", lambda units, numbers: numbers)
    stack.enter_context(itself)
    return stack
