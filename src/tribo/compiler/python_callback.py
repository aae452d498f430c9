"""Calls from compiled code to calculators that are not compiled."""

from llvmlite import ir
from numba import types
from numba.extending import intrinsic


@intrinsic
def call_at(typing_context, address):
    """Call the function ``void f(void)`` at an address, as ctypes makes one from Python.

    The address is an argument, a number, so a kernel that calls it can be cached on disk.
    """

    def build(context, builder, signature, arguments):
        function = ir.FunctionType(ir.VoidType(), [])
        builder.call(builder.inttoptr(arguments[0], function.as_pointer()), [])
        return context.get_dummy_value()

    return types.void(types.int64), build
