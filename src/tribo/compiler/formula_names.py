"""Names in the formulas of plug-ins that tribo compiles in another way than numba.

Of numbers, numba compiles ``np.where`` to an array without dimensions, and of `Lanes` not at all.
Formulas are therefore compiled with `choose` in its place.  A class of plug-ins that a formula
calls makes instances whose methods kernels know.  The functions of their authors, and these names
in the functions of other programs, stay as they are.
"""

import functools
from collections.abc import Callable
from types import CellType, FunctionType, ModuleType
from typing import Any

import numpy as np
from numba import jit, types
from numba.extending import is_jitted, overload

from tribo.compiler.jit import OVERLOAD
from tribo.compiler.lanes import LanesType, where_less


def choose(condition, x, y):
    """np.where, of numbers a number."""
    return np.where(condition, x, y)


@overload(choose, **OVERLOAD)
def _choose(condition, x, y):
    if isinstance(condition, LanesType):
        return lambda condition, x, y: where_less(0.5, condition, x, y)
    numbers = isinstance(x, types.Number) and isinstance(y, types.Number)
    if isinstance(condition, types.Boolean) and numbers:
        return lambda condition, x, y: x if condition else y
    return lambda condition, x, y: np.where(condition, x, y)


# numpy for formulas.
_numpy = ModuleType("numpy")
vars(_numpy).update(vars(np), where=choose)


# What makes the instances of a class in compiled code.
Constructors = Callable[[Any], Any]


@functools.cache
def compilable(function: Any, constructor: Constructors) -> Any:
    """A function as Python, with other names for np.where and for classes of plug-ins.

    It is the same function if it uses neither.
    """
    return _compilable(function, constructor, frozenset())


def _compilable(function: Any, constructor: Constructors, callers: frozenset[Any]) -> Any:
    """The same for a function that others call."""
    callers |= {function}
    names = function.__code__.co_names
    known = {name: value for name, value in function.__globals__.items() if name in names}

    def in_formulas(value: Any) -> Any:
        return _in_formulas(value, names, constructor, callers)

    changed = {name: in_formulas(value) for name, value in known.items()}
    cells = function.__closure__ or ()
    inner = [in_formulas(cell.cell_contents) for cell in cells]
    if all(changed[name] is known[name] for name in known) and all(
        new is cell.cell_contents for new, cell in zip(inner, cells, strict=True)
    ):
        return function
    made = FunctionType(
        function.__code__,
        function.__globals__ | changed,
        function.__name__,
        function.__defaults__,
        tuple(map(CellType, inner)),
    )
    made.__qualname__, made.__module__ = function.__qualname__, function.__module__
    return made


def _in_formulas(
    value: Any, names: tuple[str, ...], constructor: Constructors, callers: frozenset[Any]
) -> Any:
    """What stands for a global value in a function that uses these names."""
    if value is np.where:
        return choose
    if value is np and "where" in names:
        return _numpy
    if is_jitted(value) and value.py_func not in callers:
        function = _compilable(value.py_func, constructor, callers)
        return value if function is value.py_func else jit(**value.targetoptions)(function)
    if isinstance(value, type) and issubclass(value, tuple) and hasattr(value, "_fields"):
        return constructor(value)
    return value
