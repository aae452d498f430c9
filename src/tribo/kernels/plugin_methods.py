"""How compiled code finds the methods of plug-ins, which are NamedTuples of numbers.

numba gives every NamedTuple class a type of its own, so a method is found when a kernel is
compiled, and inlined.  All these types share one base, and numba looks up methods by that base:
a method cannot be registered for single classes.  The look-up here therefore applies to a class
only if that class defines the method itself, and leaves fields of the same name alone.
"""

from collections.abc import Callable
from typing import Any

from numba import types
from numba.core.typing.templates import (
    _OverloadMethodTemplate,
    infer_getattr,
    make_overload_attribute_template,
)
from numba.extending import overload

from tribo.kernels.numba_passes import LINKED

# Methods of plug-ins, each with its number of arguments after self.
METHOD_ARGUMENTS = {
    # Potentials: at r, of two charges.
    "energy": 1,
    "force": 1,
    "coupling": 2,
    "energy_between": 3,
    "force_between": 3,
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


class _MethodOfItsClass(_OverloadMethodTemplate):
    """A method of those NamedTuples whose class defines it."""

    def _resolve(self, typ: Any, attr: str) -> Any:
        cls = typ.instance_class
        if attr in cls._fields or not callable(getattr(cls, attr, None)):
            return None
        return super()._resolve(typ, attr)


def method_of_named_tuples(name: str, **options: Any) -> Callable[[Any], Any]:
    """Decorate a function that returns the implementation of a method, given the types.

    Parameters
    ----------
    name : str
        Name of the method.  It exists for those NamedTuples whose class defines it.
    **options
        As of :func:`numba.extending.overload`.
    """

    def register(implementation: Any) -> Any:
        template = make_overload_attribute_template(
            types.BaseNamedTuple, name, implementation, base=_MethodOfItsClass, **options
        )
        infer_getattr(template)
        return overload(implementation, **options)(implementation)

    return register


def _register(name: str, arguments: int) -> None:
    def find(plugin: Any) -> Any:
        return getattr(plugin.instance_class, name)

    # numba compares the signatures of these with those of the methods.
    finders: dict[int, Callable[..., Any]] = {
        0: lambda self: find(self),
        1: lambda self, a: find(self),
        2: lambda self, a, b: find(self),
        3: lambda self, a, b, c: find(self),
        4: lambda self, a, b, c, d: find(self),
        7: lambda self, a, b, c, d, e, f, g: find(self),
    }
    # Plug-ins may call functions that make arrays, as numpy.where does even of numbers.
    options = {**LINKED, "_nrt": True}
    method_of_named_tuples(name, jit_options=options, strict=False)(finders[arguments])


for _name, _arguments in METHOD_ARGUMENTS.items():
    _register(_name, _arguments)
