"""All that tribo uses of numba and llvmlite without their documentation, and the tested versions.

NATIVE says which of two ways of compiling is taken.  The native way uses the undocumented names
below.  The plain way uses documented ones alone: it compiles more slowly, and its loops run more
slowly, but it does not depend on numba's internals.  It is taken with a version that was not
tested, and with TRIBO_NUMBA=plain in the environment.
"""

import os
import warnings

import llvmlite
import numba
from llvmlite.binding import get_host_cpu_features

# numba's manual uses these in its examples of extensions, so both ways do.
from numba.core import cgutils as cgutils
from numba.core.typing.templates import AttributeTemplate as AttributeTemplate
from numba.extending import type_callable

from tribo.validation import InputError, TriboWarning

# Versions of numba with which the native way was tested, and that of llvmlite beside each.
TESTED = {"0.68": "0.50"}

# The environment variable that avoids undocumented names.
VARIABLE = "TRIBO_NUMBA"
# Its only value.
PLAIN = "plain"


def _is_native() -> bool:
    """Whether undocumented names are used; warns where the version forbids it."""
    wanted = os.environ.get(VARIABLE, "")
    if wanted not in ("", PLAIN):
        raise InputError(VARIABLE, f'must be "{PLAIN}" or absent, got "{wanted}"')
    if wanted == PLAIN:
        return False
    tested = TESTED.get(_minor(numba.__version__)) == _minor(llvmlite.__version__)
    if not tested:
        warnings.warn(
            f"numba {numba.__version__} with llvmlite {llvmlite.__version__} was not tested; "
            f"compilation takes longer than with numba {', '.join(TESTED)}",
            TriboWarning,
            stacklevel=2,
        )
    return tested


def _minor(version: str) -> str:
    return ".".join(version.split(".")[:2])


NATIVE = _is_native()


def cpu_features() -> set[str]:
    """Features of the processor for which code is compiled."""
    given = numba.config.CPU_FEATURES  # type: ignore[attr-defined]
    if given is not None:
        return set(given.split(","))
    try:
        found = get_host_cpu_features().flatten()
    except RuntimeError:  # of a processor that LLVM does not know
        return set()
    return set(found.split(",")) if numba.config.ENABLE_AVX else set()  # type: ignore[attr-defined]


def own_reference(context, builder, kind, value):  # type: ignore[no-untyped-def]
    """What an intrinsic returns of its arguments: the caller releases the arrays in it.

    Native kernels do not count references.
    """
    if context.enable_nrt:
        context.nrt.incref(builder, kind, value)
    return value


def typed_first(operation):  # type: ignore[no-untyped-def]
    """Let a function of the types of arguments tell the signature of an operation, or None.

    The native way asks it before numba's own functions.  After them, as with type_callable, each of
    up to a dozen that fail for a register takes some 0.1 ms.
    """

    def register(find):  # type: ignore[no-untyped-def]
        if not NATIVE:
            type_callable(operation)(lambda context: find)
            return find

        def generic(self, args, kws):  # type: ignore[no-untyped-def]
            return find(*args)

        # Functions for a processor come before those for all targets.
        fields = {"key": operation, "metadata": {"target": "cpu"}, "generic": generic}
        infer_global(operation)(type(f"First_{operation.__name__}", (AbstractTemplate,), fields))
        return find

    return register


def pickled(value: object) -> bytes:
    """A value with the classes in it by their contents, so that a process without them reads it."""
    return dumps(value)  # type: ignore[no-any-return, no-untyped-call]


def overloads_of(function: object) -> list[object] | None:
    """What numba compiles where a function of Python is called; None if that cannot be told."""
    if not NATIVE:
        return None
    context = cpu_target.typing_context
    context.refresh()
    templates = getattr(context._lookup_global(function), "templates", ())
    return [each._overload_func for each in templates if hasattr(each, "_overload_func")]


if NATIVE:
    from numba import _dynfunc as _dynfunc  # type: ignore[attr-defined]
    from numba.core import caching as caching
    from numba.core import compiler as compiler
    from numba.core import compiler_machinery as compiler_machinery
    from numba.core import typed_passes as typed_passes
    from numba.core import untyped_passes as untyped_passes
    from numba.core.ccallback import CFunc as CFunc
    from numba.core.codegen import JITCodeLibrary as JITCodeLibrary
    from numba.core.environment import Environment as Environment
    from numba.core.lowering import Lower as Lower
    from numba.core.registry import cpu_target
    from numba.core.runtime import rtsys as rtsys  # type: ignore[attr-defined]
    from numba.core.serialize import dumps as dumps
    from numba.core.typing.templates import AbstractTemplate, infer_global
