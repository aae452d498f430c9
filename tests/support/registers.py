"""The loop for pairs without a compiler: arrays of eight numbers in place of vector registers."""

import importlib
from contextlib import ExitStack
from types import SimpleNamespace
from unittest import mock

import numpy as np


def _put(x, i, value):
    new = np.array(x)
    new[i] = value
    return new


def _store(rows, k, x):
    rows[k] = x


ARRAYS = {
    "sqrt": np.sqrt,
    "absolute": np.abs,
    "sum_of_lanes": lambda x: float(np.sum(x)),
    "sums_of_lanes": lambda xs: np.array([np.sum(x) for x in xs]),
    "maximum": lambda x: float(np.max(x)),
    "where_less": lambda x, y, one, other: np.where(x < y, one, other),
    "broadcast": lambda x: np.full(8, x),
    "lane": lambda x, i: float(x[i]),
    "with_lane": _put,
    "rows_of": lambda array: array,
    "load": lambda rows, k: rows[k].copy(),
    "store": _store,
}


def with_fields(loop):
    """The loop, told of fields by name, as compiled code is."""

    def call(*arguments):
        return loop(*(x.view(np.recarray) if named(x) else x for x in arguments))

    def named(x):
        return isinstance(x, np.ndarray) and x.dtype.names is not None

    return call


def entry_point(loop, fixed, _):
    """Uncompiled, in place of tribo.kernels.compiled.EntryPoint."""
    return lambda *arguments: with_fields(loop)(*fixed, *arguments)


def registers_as_arrays():
    """The loop for pairs without a compiler."""
    stack = ExitStack()
    for name in ("kernels.simd", "pair.forces", "pair.step", "pair.loop"):
        module = importlib.import_module(f"tribo.{name}")
        own = {key: value for key, value in ARRAYS.items() if hasattr(module, key)}
        stack.enter_context(mock.patch.multiple(module, **own))
    adapter = "tribo.run.pair_adapter"
    importlib.import_module(adapter)
    config = SimpleNamespace(DISABLE_JIT=False)
    stack.enter_context(mock.patch(f"{adapter}.config", config))
    stack.enter_context(mock.patch(f"{adapter}.EntryPoint", entry_point))
    return stack
