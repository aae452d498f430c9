"""Options of numba.njit for kernels, in the native and in the plain way."""

from typing import Any

from tribo.compiler.numba_private import NATIVE

# Division by zero gives inf or nan, as in numpy; the time loops turn both into a named status.
NUMPY_ERRORS: dict[str, Any] = {"error_model": "numpy"}

# Functions that only kernels call.
LINKED: dict[str, Any] = {}
# Without reference counting a kernel can neither make nor return arrays, and a pair of asperites
# runs more than twice as fast.
UNCOUNTED: dict[str, Any] = {}
COUNTED: dict[str, Any] = {}
INLINED: dict[str, Any] = {}
# Time loops, which Python calls.
LOOP: dict[str, Any] = {**NUMPY_ERRORS, "nogil": True}

if NATIVE:
    from tribo.compiler.linking import KernelCompiler, LoopCompiler

    LINKED = {  # no wrappers for calls from Python
        "no_cpython_wrapper": True,
        "no_cfunc_wrapper": True,
        "pipeline_class": KernelCompiler,
    }
    UNCOUNTED = {"_nrt": False}
    COUNTED = {"_nrt": True}
    INLINED = {"forceinline": True}
    LOOP |= {**UNCOUNTED, "pipeline_class": LoopCompiler}

# Kernels, and kernels that make or return arrays.
KERNEL: dict[str, Any] = {**NUMPY_ERRORS, **LINKED, **UNCOUNTED}
OWNING_KERNEL: dict[str, Any] = {**NUMPY_ERRORS, **LINKED, **COUNTED}
# Functions of Python that kernels compile in another way, as arguments of numba.extending.overload.
OVERLOAD: dict[str, Any] = {"jit_options": KERNEL, "strict": False}
