"""numba's types of plug-ins, which are NamedTuples of numbers with methods that kernels call.

numba gives every NamedTuple class a type, but all these types are of one kind, and methods are
registered for a kind.  Here each class of plug-ins has a kind of its own, from :func:`recognize`
on.  A kernel finds its methods when it is compiled, and inlines them; NamedTuples of other programs
are not touched.

Of numbers, numba compiles ``np.where`` to an array without dimensions, and of `Lanes` not at all.
Formulas are therefore compiled with `choose` in its place.  A class of plug-ins that a formula
calls makes instances whose methods kernels know.  The functions of their authors, and these names
in the functions of other programs, stay as they are.

Compiled code keeps the values that functions take from elsewhere.  A class gets another kind once
these have changed, and so do all kernels that take its instances.  Formulas are copies, with copies
of the compiled functions that they call: numba would go on with what those were compiled to before.
"""

import functools
import inspect
from collections.abc import Callable, Iterable
from types import CellType, FunctionType, ModuleType
from typing import Any

import numpy as np
from numba import extending, jit, njit, typeof, types

from tribo.compiler.frozen_values import (
    Frozen,
    closure_of,
    frozen_in,
    is_as_written,
    is_known,
    module_of,
    names_in,
    python_function,
)
from tribo.compiler.jit import COUNTED, KERNEL, LINKED, OVERLOAD
from tribo.compiler.lanes import LanesType, where_less
from tribo.compiler.numba_private import cgutils, overloads_of, own_reference

# Methods of plug-ins, each with its number of arguments after self.
METHOD_ARGUMENTS = {
    # Potentials: at r, of two charges.
    "energy": 1,
    "force": 1,
    "coupling": 2,
    "energy_between": 3,
    "force_between": 3,
    "acts_at_all": 0,
    "acts_between": 2,
    "clearance_between": 3,
    "range_between": 2,
    "range_of_all": 0,
    "feature": 0,
    "clearance": 1,
    "range": 0,
    # Tables: what energy and force share, at r.
    "interval": 1,
    "defined": 1,
    # Fields: at x, y.
    "energy_at": 2,
    "force_at": 2,
    # Fields that depend on time: at t, x, y.
    "energy_at_time": 3,
    "force_at_time": 3,
    "power_at_time": 3,
    # Drives: at t, x, y, vx, vy, fx, fy.
    "force_on_bar": 7,
    # Ends of bars: at t, phi, nu, twist.
    "end_forces": 4,
}
# How they are compiled, since they may call functions that make arrays; and the methods of
# integration methods: see :mod:`tribo.integrators.time_loops`.
_OPTIONS = {name: {**LINKED, **COUNTED} for name in METHOD_ARGUMENTS}
_OPTIONS |= dict.fromkeys(("begin", "step", "arrive", "stays_finite", "trial"), KERNEL)

# Classes whose instances numba types by :func:`plugin_type`.
_recognized: set[Any] = set()
# What compilation freezes of the classes that :func:`recognize` has seen, when it saw them last.
_frozen: dict[Any, Frozen] = {}


class PluginType:
    """The type of instances of a plug-in's class, beside numba's of that NamedTuple."""

    instance_class: Any
    types: Any
    version: str  # what compilation freezes of the class; of this package's it is always the same
    formulas: dict[str, FunctionType]  # its methods as kernels compile them

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self.name += self.version  # type: ignore[attr-defined]

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
    version = _version(cls)
    if isinstance(plain, types.NamedUniTuple):
        return _kind(cls, types.NamedUniTuple, version)(plain.dtype, plain.count, cls)
    return _kind(cls, types.NamedTuple, version)(plain.types, cls)


def recognize(plugin: Any) -> None:
    """Let kernels call the methods of a plug-in, and of those among its fields."""
    for item in plugin:
        if hasattr(item, "_fields"):
            recognize(item)
    recognize_class(type(plugin))


def recognize_class(cls: Any) -> None:
    """The same for all instances of a class, with the values that its methods take now."""
    if cls not in _recognized:
        _recognized.add(cls)

        @extending.typeof_impl.register(cls)
        def find_type(value: Any, context: Any) -> Any:
            return plugin_type(cls, [extending.typeof_impl(item, context) for item in value])

    _freeze(cls)


def _freeze(cls: Any) -> Frozen:
    """What compilation freezes of a class now, also of those that its methods make or refer to.

    Those of this package stay as they are.
    """
    if cls in _frozen and is_known(cls.__module__):
        return _frozen[cls]
    found = frozen_in(cls, METHOD_ARGUMENTS)
    for each in found.classes:
        _frozen[each] = found if each is cls else frozen_in(each, METHOD_ARGUMENTS)
    return found


def _version(cls: Any) -> str:
    """The stamp of what compilation freezes of a class, as it was when it was last recognized."""
    if is_known(cls.__module__):
        return ""
    return (_frozen.get(cls) or _freeze(cls)).stamp


def frozen_of(plugin: Any) -> Frozen:
    """What compilation freezes of a plug-in's class now, for which kernels compile from now on."""
    recognize(plugin)
    return _frozen[type(plugin)]


def type_of(plugin: Any) -> Any:
    recognize(plugin)
    return typeof(plugin)


def like(kind: Any, number: types.Type) -> Any:
    """The type of a NamedTuple of numbers with numbers of another type."""
    if isinstance(kind, PluginType):
        return plugin_type(kind.instance_class, [number] * len(kind.types))
    return types.NamedUniTuple(number, len(kind.types), kind.instance_class)


@functools.cache
def _kind(cls: Any, base: type, version: str) -> Any:
    """The kind of types of a class, with the methods that the class has beside its fields."""
    formulas = _formulas(cls, version)
    namespace = {"version": version, "formulas": formulas}
    kind = type(f"{cls.__name__}Type", (PluginType, base), namespace)
    models = extending.models
    uniform = base is types.NamedUniTuple
    extending.register_model(kind)(models.UniTupleModel if uniform else models.TupleModel)
    for name, method in formulas.items():
        find = _finder(method)
        extending.overload_method(kind, name, jit_options=_OPTIONS[name], strict=False)(find)
    return kind


@functools.cache
def _formulas(cls: Any, version: str) -> dict[str, FunctionType]:
    """The methods of a class as kernels compile them, with the values of its `version`."""
    names = [name for name in _OPTIONS if name not in cls._fields]
    formulas = Formulas()
    methods = {name: getattr(cls, name, None) for name in names}
    return {name: formulas.of(each) for name, each in methods.items() if callable(each)}


def constructor(cls: Any) -> Any:
    """What makes an instance of a class in compiled code; the class itself if it is no plug-in."""
    if not any(callable(getattr(cls, name, None)) for name in METHOD_ARGUMENTS):
        return cls
    return _constructor(cls, _version(cls))


@functools.cache
def _constructor(cls: Any, version: str) -> Any:
    """The same for a plug-in with the values of its `version`."""

    @extending.intrinsic
    def build(typing_context, members):  # type: ignore[no-untyped-def]
        """Type and code of a function that makes the tuple of a class from a plain tuple."""
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
    # As text, since numba finds the names of arguments, and their defaults, in the function itself.
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
    """The implementation for registers, for floats, and elsewhere for arrays."""
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


class Formulas:
    """Functions as kernels compile them, with the values that they refer to now.

    They have other names for np.where and for classes of plug-ins.  Functions of a user are copied,
    with the compiled functions that they call, each once.  This package's own are the same unless
    they use such names.
    """

    def __init__(self) -> None:
        self._made: dict[Any, Any] = {}  # what stands for functions of Python
        self._compiled: dict[Any, Any] = {}  # and for those that numba has compiled

    def of(self, function: Any) -> Any:
        """A method of a plug-in, or a function that others call."""
        if function in self._made:
            return self._made[function]
        own = is_known(module_of(function))
        scope = dict(function.__globals__)
        cells = closure_of(function)
        copy = FunctionType(
            function.__code__,
            scope,
            function.__name__,
            function.__defaults__,
            tuple(CellType() for _ in function.__closure__ or ()),
        )
        copy.__kwdefaults__ = function.__kwdefaults__
        copy.__qualname__ = function.__qualname__
        copy.__module__ = function.__module__
        self._made[function] = function if own else copy  # also for those that call themselves
        attributes: dict[str, list[tuple[str, ...]]] = {}
        for name, *rest in names_in(function.__code__):
            attributes.setdefault(name, []).append(tuple(rest))
        changed = False
        for values in (scope, cells):
            for name in attributes.keys() & values.keys():
                new = self._in_formulas(values[name], attributes[name])
                changed |= new is not values[name]
                values[name] = new
        for name, cell in zip(function.__code__.co_freevars, copy.__closure__ or (), strict=True):
            if name in cells:
                cell.cell_contents = cells[name]
        if changed:
            self._made[function] = copy
        return self._made[function]

    def _in_formulas(self, value: Any, attributes: list[tuple[str, ...]]) -> Any:
        """What stands for a value, of which functions read `attributes` one after another."""
        if value is np.where:
            return choose
        if value is np:
            return _numpy if any(rest[:1] == ("where",) for rest in attributes) else value
        if isinstance(value, ModuleType):
            return value if is_known(value.__name__) else self._module(value, attributes)
        if isinstance(value, np.ndarray):
            return value.copy()
        if isinstance(value, type) and issubclass(value, tuple) and hasattr(value, "_fields"):
            return constructor(value)
        return self._function(value)

    def _module(self, module: ModuleType, attributes: list[tuple[str, ...]]) -> ModuleType:
        """A module with what stands for its members."""
        copy = ModuleType(module.__name__)
        vars(copy).update(vars(module))
        for name in {rest[0] for rest in attributes if rest} & vars(module).keys():
            rests = [rest[1:] for rest in attributes if rest[:1] == (name,)]
            setattr(copy, name, self._in_formulas(getattr(module, name), rests))
        return copy

    def _function(self, value: Any) -> Any:
        """What stands for a compiled function; any other value itself."""
        if isinstance(value, FunctionType):
            function = value
            compiler = jit(nopython=True)
            if is_known(module_of(value)) or not overloads_of(value) or not is_as_written(value):
                return value
        elif (function := python_function(value)) is None:
            return value
        else:
            compiler = jit(**value.targetoptions)
        made = self.of(function)
        if made is not function and value not in self._compiled:
            self._compiled[value] = compiler(made)
        return self._compiled.get(value, value)


def formula(function: Any) -> Any:
    """A function as kernels compile it, with the values that it refers to now."""
    return Formulas().of(function)
