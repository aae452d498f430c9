"""How Python functions become kernels: compiled, cached on disk, and never stale.

numba's disk cache looks at one file only.  A kernel whose potential, or whose helper in another
file, has been edited since would be served from it with the *old physics*.  So the kernels that
are cached carry a stamp, the hash of every source they are built from, in their name: another
source is another kernel.
"""

import functools
import hashlib
from collections.abc import Callable
from pathlib import Path
from types import FunctionType
from typing import Any

from numba import njit, types
from numba.extending import overload_method

# What kernels are made of.  Division by zero gives inf or nan, as in numpy, which the time loops
# turn into a named status.  Most are called by other kernels only: the wrappers by which Python
# would call them cost a quarter of the compile time.
#
# Most kernels neither make arrays nor hand any on, and do without the counting of references: for
# a pair of asperites that is more than half of the time.
kernel = njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True, _nrt=False)
inlined = njit(
    error_model="numpy",
    no_cpython_wrapper=True,
    no_cfunc_wrapper=True,
    forceinline=True,
    _nrt=False,
)
# Expanded in its caller before that is typed: it adds no function that LLVM has to optimise.  Every
# other kernel is optimised together with all that it calls, and again in each of its callers.
expanded = njit(error_model="numpy", inline="always")
shared_kernel = njit(error_model="numpy", _nrt=False)
owning_kernel = njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True, _nrt=True)
shared_owning_kernel = njit(error_model="numpy", _nrt=True)


@functools.cache
def package_stamp() -> str:
    """Hash of the sources of this package [16 hex digits]."""
    digest = hashlib.blake2b(digest_size=8)
    root = Path(__file__).resolve().parents[1]
    for path in sorted(root.rglob("*.py")):
        digest.update(path.relative_to(root).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


@functools.cache
def time_loop(loop: FunctionType, stamp: str | None) -> Callable[..., Any]:
    """The function `loop` compiled and cached on disk under its own name and `stamp`.

    Without a stamp it is not kept on disk.
    """
    if stamp is None:
        return njit(error_model="numpy")(loop)
    name = f"{loop.__name__}_{package_stamp()}_{stamp}"
    clone = FunctionType(loop.__code__, loop.__globals__, name, loop.__defaults__)
    clone.__qualname__ = name
    return njit(error_model="numpy", cache=True)(clone)


def entry(loop: Any, *arguments: Any) -> Callable[..., Any]:
    """The machine code of a compiled loop for arguments like these, and no others.

    To look at the types of a dozen arguments takes longer than a short run.
    """
    kinds = tuple(loop.typeof_pyval(argument) for argument in arguments)
    loop.compile(kinds)
    found: Callable[..., Any] = loop.overloads[kinds].entry_point
    return found


# A plug-in is a NamedTuple: numba types it by its class, so its methods are found, and inlined,
# when the kernel is compiled.
def _found_by_class(method: str, arguments: int) -> None:
    def find(plugin: Any) -> Any:
        return getattr(plugin.instance_class, method)

    finders: dict[int, Callable[..., Any]] = {
        0: lambda self: find(self),
        1: lambda self, a: find(self),
        2: lambda self, a, b: find(self),
        3: lambda self, a, b, c: find(self),
        4: lambda self, a, b, c, d: find(self),
        7: lambda self, a, b, c, d, e, f, g: find(self),
    }
    # Plug-ins may use what makes arrays on the way, as numpy.where does even of numbers.
    options = {"_nrt": True}
    found = overload_method(types.BaseNamedTuple, method, jit_options=options, strict=False)
    found(finders[arguments])


METHODS = {  # of plug-ins, and how many arguments each has after self
    "energy": 1,  # of potentials, at r
    "force": 1,
    "coupling": 2,  # of two charges
    "energy_between": 3,  # at r, of two charges
    "force_between": 3,
    "feature": 0,
    "clearance": 1,  # at r
    "range": 0,
    "interval": 1,  # of tables, at r: what energy and force share has to be a method too,
    "defined": 1,  # since potentials know nothing of a compiler that could be shown a function
    "energy_at": 2,  # of fields, at x, y
    "force_at": 2,
    "force_on_bar": 7,  # of drives, at t, x, y, vx, vy, fx, fy
    "end_forces": 4,  # on ends, at t, phi, nu, twist
}
for _method, _arguments in METHODS.items():
    _found_by_class(_method, _arguments)
