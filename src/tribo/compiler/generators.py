"""Random generators as arguments of time loops: the address of their functions and their state.

numba takes generators as arguments too.  But it makes objects of ctypes for each call, and loops
that count no references never release them: 6 kB stayed in memory for each run.
"""

import ctypes
from typing import Any

import numpy as np
from llvmlite import ir
from numba import config, types

from tribo.compiler.lanes import in_kernels
from tribo.compiler.numba_private import cgutils

# What a loop takes that draws nothing.
NO_NOISE = 0
_COMPILED = not config.DISABLE_JIT  # type: ignore[attr-defined]
# The members of numpy's C structure `bitgen_t` that numba uses, in its order.
_MEMBERS = ("state", "fnptr_next_uint64", "fnptr_next_uint32", "fnptr_next_double")
# The address in a capsule of Python.
_address_in = ctypes.PYFUNCTYPE(ctypes.c_void_p, ctypes.py_object, ctypes.c_char_p)(
    ("PyCapsule_GetPointer", ctypes.pythonapi)
)


def as_argument(generator: np.random.Generator) -> Any:
    """What a time loop takes for a generator, which its caller keeps as long as the loop runs."""
    if not _COMPILED:
        return generator
    return _address_in(generator.bit_generator.capsule, b"BitGenerator")  # type: ignore[attr-defined]


def _same(argument: Any) -> Any:
    return argument


@in_kernels(_same)
def generator_at(typing_context, address):
    """The generator of an argument made by :func:`as_argument`; other sources of noise as they are.

    It draws and is never released.
    """
    if not isinstance(address, types.Integer):
        return address(address), lambda context, builder, sig, args: args[0]
    kind = types.NumPyRandomGeneratorType("NumPyRandomGeneratorType")

    def build(context, builder, sig, args):
        """Fill numba's record of a generator with the pointers at an address."""
        made = cgutils.create_struct_proxy(kind)(context, builder)
        source = context.data_model_manager[kind].get_member_fe_type("bit_generator")
        draws = cgutils.create_struct_proxy(source)(context, builder)
        number = context.get_value_type(types.uintp)
        pointers = builder.inttoptr(args[0], number.as_pointer())
        for place, name in enumerate(_MEMBERS):
            item = builder.gep(pointers, [ir.Constant(number, place)])
            setattr(draws, name, builder.load(item))
        draws.state_address = draws.state
        made.bit_generator = draws._getvalue()
        return made._getvalue()

    return kind(address), build
