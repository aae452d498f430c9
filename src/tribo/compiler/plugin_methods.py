"""numba's types of plug-ins, which are NamedTuples of numbers with methods that kernels call.

numba gives every NamedTuple class a type, but all these types are of one kind, and methods are
registered for a kind.  Here each class of plug-ins has a kind of its own, from :func:`recognize`
on.  A kernel finds its methods when it is compiled, and inlines them; NamedTuples of other programs
are not touched.

Of numbers, numba compiles ``np.where`` to an array without dimensions, and of `Lanes` not at all.
Formulas are therefore compiled with `choose` in its place.  A class of plug-ins that a formula
calls makes instances whose methods kernels know.  The functions of their authors, and these names
in the functions of other programs, stay as they are.
"""

import functools
import inspect
from collections.abc import Callable, Iterable
from types import CellType, FunctionType, ModuleType
from typing import Any

import numpy as np
from numba import extending, jit, njit, typeof, types

from tribo.compiler.jit import COUNTED, KERNEL, LINKED, OVERLOAD
from tribo.compiler.lanes import LanesType, where_less
from tribo.compiler.numba_private import cgutils, own_reference

# Methods of plug-ins, each with its number of arguments after self.
METHOD_ARGUMENTS = {
    # Potentials: at r, of two charges.
    "energy": 1,
    "force": 1,
    "coupling": 2,
    "energy_between": 3,
    "force_between": 3,
    "acts_between": 2,
    "clearance_between": 3,
    "range_between": 2,
    "feature": 0,
    "clearance": 1,
    "range": 0,
    # Tables: what energy and force share, at r.
    "interval": 1,
    "defined": 1,
    # Fields: at x, y.
    "energy_at": 2,
    "force_at": 2,
    # Drives: at t, x, y, vx, vy, fx, fy.
    "force_on_bar": 7,
    # Ends of bars: at t, phi, nu, twist.
    "end_forces": 4,
}
# How they are compiled, since they may call functions that make arrays; and the methods of
# integration methods: see :mod:`tribo.integrators.time_loops`.
_OPTIONS = {name: {**LINKED, **COUNTED} for name in METHOD_ARGUMENTS}
_OPTIONS |= {"step": KERNEL, "trial": KERNEL}

# Classes that :func:`recognize` has seen.
_recognized: set[Any] = set()


class PluginType:
    """The type of instances of a plug-in's class, beside numba's of that NamedTuple."""

    instance_class: Any
    types: Any

    def __reduce__(self) -> Any:
        """Each process makes its own kinds: the disk cache keeps a class, or what makes it."""
        cls = self.instance_class
        return _type_of, (vars(cls).get("made_by", cls), self.types)


def _type_of(cls: Any, members: Iterable[types.Type]) -> Any:
    """The type of instances of a class, or of that which a function makes from another."""
    if isinstance(cls, tuple):
        make, plain = cls
        cls = make(plain)
    return plugin_type(cls, members)


def plugin_type(cls: Any, members: Iterable[types.Type]) -> Any:
    """The type of instances of a plug-in's class whose members have these types."""
    plain = types.BaseTuple.from_types(tuple(members), cls)
    if isinstance(plain, types.NamedUniTuple):
        return _kind(cls, types.NamedUniTuple)(plain.dtype, plain.count, cls)
    return _kind(cls, types.NamedTuple)(plain.types, cls)


def recognize(plugin: Any) -> None:
    """Let kernels call the methods of a plug-in, and of those among its fields."""
    for item in plugin:
        if hasattr(item, "_fields"):
            recognize(item)
    recognize_class(type(plugin))


def recognize_class(cls: Any) -> None:
    """The same for all instances of a class."""
    if cls in _recognized:
        return
    _recognized.add(cls)
    for base in (types.NamedTuple, types.NamedUniTuple):
        _kind(cls, base)

    @extending.typeof_impl.register(cls)
    def find_type(value: Any, context: Any) -> Any:
        return plugin_type(cls, [extending.typeof_impl(item, context) for item in value])


def type_of(plugin: Any) -> Any:
    recognize(plugin)
    return typeof(plugin)


def like(kind: Any, number: types.Type) -> Any:
    """The type of a NamedTuple of numbers with numbers of another type."""
    if isinstance(kind, PluginType):
        return plugin_type(kind.instance_class, [number] * len(kind.types))
    return types.NamedUniTuple(number, len(kind.types), kind.instance_class)


@functools.cache
def _kind(cls: Any, base: type) -> Any:
    """The kind of types of a class, with the methods that the class has beside its fields."""
    kind = type(f"{cls.__name__}Type", (PluginType, base), {})
    models, uniform = extending.models, base is types.NamedUniTuple
    extending.register_model(kind)(models.UniTupleModel if uniform else models.TupleModel)
    for name, options in _OPTIONS.items():
        if name not in cls._fields and callable(getattr(cls, name, None)):
            find = _finder(formula(getattr(cls, name)))
            extending.overload_method(kind, name, jit_options=options, strict=False)(find)
    return kind


@functools.cache
def constructor(cls: Any) -> Any:
    """What makes an instance of a class in compiled code; the class itself if it is no plug-in."""
    if not any(callable(getattr(cls, name, None)) for name in METHOD_ARGUMENTS):
        return cls

    @extending.intrinsic
    def build(typing_context, members):  # type: ignore[no-untyped-def]
        kinds = [types.unliteral(kind) for kind in members.types]
        kind = plugin_type(cls, kinds)

        def code(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
            given = cgutils.unpack_tuple(builder, arguments[0])
            each = zip(given, signature.args[0].types, kinds, strict=True)
            made = context.make_tuple(builder, kind, [context.cast(builder, *one) for one in each])
            return own_reference(context, builder, kind, made)

        return kind(members), code

    names = ", ".join(cls._fields)
    scope = {"build": build}
    exec(f"def make({names}):\n    return build(({names},))", scope)
    make: Any = scope["make"]
    make.__defaults__ = tuple(cls._field_defaults.values())
    return njit(**KERNEL)(make)


def _finder(method: FunctionType) -> Callable[..., Any]:
    """A function of the types of self and arguments, which returns the method."""

    def find(*kinds: Any) -> FunctionType:
        return method

    find.__signature__ = inspect.signature(method)  # type: ignore[attr-defined]
    return find


def choose(condition, x, y):
    """np.where, of numbers a number."""
    return np.where(condition, x, y)


@extending.overload(choose, **OVERLOAD)
def _choose(condition, x, y):
    if isinstance(condition, LanesType):
        return lambda condition, x, y: where_less(0.5, condition, x, y)
    if isinstance(condition, types.Boolean):
        if isinstance(x, LanesType) or isinstance(y, LanesType):
            return lambda condition, x, y: where_less(0.5, 1.0 if condition else 0.0, x, y)
        if isinstance(x, types.Number) and isinstance(y, types.Number):
            return lambda condition, x, y: x if condition else y
    return lambda condition, x, y: np.where(condition, x, y)


# numpy for formulas.
_numpy = ModuleType("numpy")
vars(_numpy).update(vars(np), where=choose)


@functools.cache
def formula(function: Any, callers: frozenset[Any] = frozenset()) -> Any:
    """A method of a plug-in, or a function that others call, as kernels compile it.

    It has other names for np.where and for classes of plug-ins, and is the same if it uses neither.
    """
    callers |= {function}
    names = function.__code__.co_names
    known = {name: value for name, value in function.__globals__.items() if name in names}

    def in_formulas(value: Any) -> Any:
        """What stands for a global value."""
        if value is np.where:
            return choose
        if value is np and "where" in names:
            return _numpy
        if extending.is_jitted(value) and value.py_func not in callers:
            inner = formula(value.py_func, callers)
            return value if inner is value.py_func else jit(**value.targetoptions)(inner)
        if isinstance(value, type) and issubclass(value, tuple) and hasattr(value, "_fields"):
            return constructor(value)
        return value

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
