"""Calls from compiled code to calculators that are not compiled."""

import ctypes

from llvmlite import ir
from numba import types

from tribo.compiler.lanes import instruction


@instruction(
    lambda address: types.void(types.int64),
    lambda address: ctypes.CFUNCTYPE(None)(int(address))(),
)
def call_at(builder, address):
    """Call the function ``void f(void)`` at an address, as ctypes makes one from Python.

    The address is an argument, a number, so a kernel that calls it can be cached on disk.
    """
    function = ir.FunctionType(ir.VoidType(), [])
    builder.call(builder.inttoptr(address, function.as_pointer()), [])
