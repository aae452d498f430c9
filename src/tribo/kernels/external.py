"""Calling out of compiled code: the way to calculators that are not kernels."""

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic


@intrinsic
def call_at(typing_context: Any, address: Any) -> Any:
    """Call the function ``void f(void)`` at an address, as ctypes makes one from Python.

    The address is a number like any other, so that a kernel that calls it is cached on disk.
    """

    def build(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        function = ir.FunctionType(ir.VoidType(), [])
        builder.call(builder.inttoptr(arguments[0], function.as_pointer()), [])
        return context.get_dummy_value()

    return types.void(types.int64), build
