"""Kernels are compiled for the parts of a model that they use, and shared by all other models.

Each kind of scene has a type of `Model` of its own, and numba compiles a kernel for each type of
its arguments.  Most kernels read a few fields.  Here a caller hands over the model with None in
place of the fields that the kernel and those it calls do not use, so that a second kind of scene
finds most kernels compiled.  The conversion costs no instruction: kernels are inlined, and LLVM
removes what is not read.
"""

import ast
import functools
import inspect
import textwrap
from collections.abc import Sequence
from types import FunctionType
from typing import Any

from numba import types
from numba.core.imputils import lower_cast

# The parameter that is narrowed.
NAME = "model"


def give_narrowing(dispatcher: Any) -> Any:
    """Let a compiled kernel be compiled for narrowed models; returns it."""
    whole = dispatcher.get_call_template
    places = [k for k, name in enumerate(_parameters(dispatcher.py_func)) if name == NAME]

    def get_call_template(args: Sequence[types.Type], kws: dict[str, types.Type]) -> Any:
        if not kws and places and places[0] < len(args):
            args = list(args)
            args[places[0]] = narrowed(dispatcher.py_func, args[places[0]])
        return whole(tuple(args), kws)

    dispatcher.get_call_template = get_call_template
    return dispatcher


def narrowed(function: FunctionType, model: types.Type) -> types.Type:
    """The type of a model without the fields that a function does not use."""
    fields = fields_used(function)
    if fields is None or not isinstance(model, types.NamedTuple):
        return model
    kept = [
        kind if name in fields else types.none
        for name, kind in zip(model.fields, model, strict=True)
    ]
    return type(model)(kept, model.instance_class)


@functools.cache
def fields_used(function: FunctionType) -> frozenset[str] | None:
    """Fields of its model that a function uses, or those it calls; None: all of them."""
    found: set[str] = set()
    waiting, seen = [function], {function}
    while waiting:
        current = waiting.pop()
        uses = _uses(current)
        if uses.escapes:
            return None
        found |= uses.fields
        for name, place in uses.calls:
            callee = _kernel(current, name)
            if callee is None or _parameters(callee)[place : place + 1] != (NAME,):
                return None
            if callee not in seen:
                seen.add(callee)
                waiting.append(callee)
    return frozenset(found)


def _parameters(function: FunctionType) -> tuple[str, ...]:
    code = function.__code__
    return code.co_varnames[: code.co_argcount]


def _kernel(caller: FunctionType, name: str) -> FunctionType | None:
    """The kernel of a name in its caller's module, as Python; None if it is something else."""
    return getattr(caller.__globals__.get(name), "py_func", None)


class _Uses(ast.NodeVisitor):
    """The uses of the parameter in a function."""

    def __init__(self) -> None:
        self.fields: set[str] = set()
        self.calls: list[tuple[str, int]] = []  # name of the function, and which argument it is
        self.escapes = False  # whether it is used in any other way

    def visit_Attribute(self, node: ast.Attribute) -> None:
        """A field."""
        if isinstance(node.value, ast.Name) and node.value.id == NAME:
            self.fields.add(node.attr)
        else:
            self.visit(node.value)

    def visit_Call(self, node: ast.Call) -> None:
        """A call of another kernel, perhaps with the whole model."""
        for place, argument in enumerate(node.args):
            if not isinstance(argument, ast.Name) or argument.id != NAME:
                self.visit(argument)
            elif isinstance(node.func, ast.Name):
                self.calls.append((node.func.id, place))
            else:
                self.escapes = True
        for keyword in node.keywords:
            self.visit(keyword.value)
        self.visit(node.func)

    def visit_Name(self, node: ast.Name) -> None:
        """Any other use."""
        self.escapes |= node.id == NAME


@functools.cache
def _uses(function: FunctionType) -> _Uses:
    """The uses of the model in the source of a function."""
    uses = _Uses()
    uses.visit(ast.parse(textwrap.dedent(inspect.getsource(function))))
    return uses


@lower_cast(types.BaseNamedTuple, types.BaseNamedTuple)
def _narrow(context: Any, builder: Any, given: Any, wanted: Any, value: Any) -> Any:
    """The same tuple with None in place of some members."""
    members = [
        context.get_dummy_value() if kind == types.none else builder.extract_value(value, k)
        for k, kind in enumerate(wanted)
    ]
    return context.make_tuple(builder, wanted, members)
