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
# turn into a named status.
kernel = njit(error_model="numpy")


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
def time_loop(loop: FunctionType, stamp: str) -> Callable[..., Any]:
    """The function `loop` compiled and cached on disk under its own name and `stamp`."""
    name = f"{loop.__name__}_{package_stamp()}_{stamp}"
    clone = FunctionType(loop.__code__, loop.__globals__, name, loop.__defaults__)
    clone.__qualname__ = name
    return njit(error_model="numpy", cache=True)(clone)


# A plug-in is a NamedTuple: numba types it by its class, so its methods are found, and inlined,
# when the kernel is compiled.
@overload_method(types.BaseNamedTuple, "energy", strict=False)
def _energy(self: Any, r: Any) -> Any:
    return self.instance_class.energy


@overload_method(types.BaseNamedTuple, "force", strict=False)
def _force(self: Any, r: Any) -> Any:
    return self.instance_class.force


@overload_method(types.BaseNamedTuple, "feature", strict=False)
def _feature(self: Any) -> Any:
    return self.instance_class.feature


@overload_method(types.BaseNamedTuple, "coupling", strict=False)
def _coupling(self: Any, one: Any, other: Any) -> Any:
    return self.instance_class.coupling
