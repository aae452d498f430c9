"""How Python functions become kernels: compiled, cached on disk, and never stale.

numba's disk cache looks at the file of the compiled function only.  If a potential, or a helper in
another file, is edited, the cache would still serve the machine code of the old physics.  Kernels
that are cached therefore have a stamp in their name: the hash of all sources they are built from.
Other sources make another kernel.
"""

import functools
import gc
import re
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from copy import copy
from pathlib import Path
from types import FunctionType
from typing import Any, NamedTuple

import numpy as np
from numba import config, from_dtype, njit, typeof, types
from numba.core.event import RecordingListener, install_recorder

from tribo.compiler.numba_private import NATIVE
from tribo.compiler.source_stamps import code_stamp, is_stamped
from tribo.compiler.unit_errors import hooks_before, raising
from tribo.interrupts import held
from tribo.progress import announced

# Division by zero gives inf or nan, as in numpy; the time loops turn both into a named status.
NUMPY_ERRORS: dict[str, Any] = {"error_model": "numpy"}

if NATIVE:
    from tribo.compiler.cache import KernelCache
    from tribo.compiler.linked_cache import LinkedCache
    from tribo.compiler.linking import ApartCompiler, InlinedCompiler, KernelCompiler, LoopCompiler

    # Functions that only kernels call: no wrappers for calls from Python.
    LINKED: dict[str, Any] = {
        "no_cpython_wrapper": True,
        "no_cfunc_wrapper": True,
        "pipeline_class": KernelCompiler,
    }
    # Without reference counting a kernel can neither make nor return arrays, and a pair of
    # asperites runs more than twice as fast.
    UNCOUNTED: dict[str, Any] = {"_nrt": False}
    COUNTED: dict[str, Any] = {"_nrt": True}
    INLINED: dict[str, Any] = {"pipeline_class": InlinedCompiler}
    APART: dict[str, Any] = {"pipeline_class": ApartCompiler}
    OF_LOOPS: dict[str, Any] = {"pipeline_class": LoopCompiler}
else:
    LINKED = UNCOUNTED = COUNTED = INLINED = APART = OF_LOOPS = {}

# Time loops, which Python calls.
LOOP: dict[str, Any] = {**NUMPY_ERRORS, "nogil": True, **UNCOUNTED, **OF_LOOPS}
# Kernels, and kernels that make or return arrays.
KERNEL: dict[str, Any] = {**NUMPY_ERRORS, **LINKED, **UNCOUNTED}
OWNING_KERNEL: dict[str, Any] = {**NUMPY_ERRORS, **LINKED, **COUNTED}
# Functions of Python that kernels compile in another way, as arguments of numba.extending.overload.
OVERLOAD: dict[str, Any] = {"jit_options": KERNEL, "strict": False}


def _compiler(way: str, **options: Any) -> Callable[[Callable[..., Any]], Any]:
    """What makes kernels of functions in one way, and keeps those of modules on disk."""
    plain = njit(**options)

    def compiled(function: Callable[..., Any]) -> Any:
        made: Any = plain(function)
        of_module = "<" not in function.__qualname__ and is_stamped(function.__module__)
        if NATIVE and of_module and not config.DISABLE_JIT:  # type: ignore[attr-defined]
            made._cache = LinkedCache(functools.partial(_name_on_disk, function, way))
        return made

    return compiled


def _name_on_disk(function: Callable[..., Any], way: str) -> str:
    return f"{function.__name__}_{code_stamp()}_{function.__module__.replace('.', '_')}_{way}"


kernel = _compiler("kernel", **KERNEL)
# One that LLVM does not copy into its callers: large, or seldom called.
apart = _compiler("apart", **{**KERNEL, **APART})
inlined = _compiler("inlined", **{**KERNEL, **INLINED})
# Expanded in its caller before that is typed.
expanded = njit(**NUMPY_ERRORS, inline="always")
# Kernels that make or return arrays.
owning_kernel = _compiler("owning", **OWNING_KERNEL)
_loop = njit(**LOOP)

# A file of the disk cache with the code of a time loop: source, name, the stamps of package and
# plug-ins, line, and version of Python.
FILE_NAME = re.compile(r"\w+\.\w+_[0-9a-f]{16}_\w*-\d+\.py.*\.nb[ic]")


@functools.cache
def time_loop(loop: FunctionType, kept: bool = True) -> Callable[..., Any]:
    """Compile a time loop at its first call, and keep it on disk if it is `kept`.

    Machine code that earlier versions of the package left there is removed.  Threads can run the
    loop at the same time, each with arrays of its own.
    """
    if not kept or config.DISABLE_JIT:  # type: ignore[attr-defined]
        return _loop(loop)
    # The underscore ends the stamp, by which `remove_stale` finds it; each way has its own files.
    compiled = _kept(loop, f"{code_stamp()}_{'' if NATIVE else '_plain'}")
    remove_stale(loop)
    return compiled


class LoopJob(NamedTuple):
    """A time loop to compile, for arguments of some types."""

    function: Any
    kinds: tuple[Any, ...]

    def is_missing(self) -> bool:
        """Whether it is neither in memory nor on disk, where it belongs."""
        if config.DISABLE_JIT or not NATIVE:  # type: ignore[attr-defined]
            return False
        loop: Any = time_loop(self.function)
        if self.kinds in loop.overloads or not isinstance(loop._cache, KernelCache):
            return False
        return not loop._cache.has_file(self.kinds, loop.targetctx)

    def is_shared(self) -> bool:
        """Whether other processes know its types: it names no plug-ins."""
        return True

    def compile(self) -> None:
        """Compile it, or load it from disk.  Raises numba's errors."""
        loop: Any = time_loop(self.function)
        with undisturbed():
            loop.compile(self.kinds)


def named(function: FunctionType, stamps: str) -> FunctionType:
    """The function under a name of its own, by which the disk cache finds it."""
    name = f"{function.__name__}_{stamps}"
    clone = FunctionType(function.__code__, function.__globals__, name, function.__defaults__)
    clone.__qualname__ = name
    return clone


def _kept(loop: FunctionType, stamps: str) -> Any:
    """The loop, compiled at its first call and kept on disk."""
    clone = named(loop, stamps)
    compiled: Any = _loop(clone)
    # With no folder that can be written, each process compiles.
    with suppress(RuntimeError):
        if NATIVE:
            compiled._cache = KernelCache(clone)
        else:
            compiled = njit(**LOOP, cache=True)(clone)
    return compiled


def cached_files(loop: FunctionType) -> list[Path]:
    """Machine code on disk of all loops from the same folder, of all versions and plug-ins."""
    folder = cache_folder(loop)
    if folder is None:
        return []
    return sorted(path for path in folder.glob("*.nb?") if FILE_NAME.fullmatch(path.name))


def cache_folder(loop: Any) -> Path | None:
    """The folder of the machine code of a loop; None if none can be written."""
    if config.DISABLE_JIT:  # type: ignore[attr-defined]
        return None
    folder = _kept(loop, code_stamp()).stats.cache_path
    return None if folder is None else Path(folder)


def is_compiled(loop: Any) -> bool:
    """Whether a loop made by :func:`time_loop` has been compiled, in this process or on disk."""
    if config.DISABLE_JIT or loop.overloads:  # type: ignore[attr-defined]
        return True
    folder = loop.stats.cache_path
    return folder is not None and any(Path(folder).glob(f"*.{loop.__name__}-*.nbc"))


def remove_stale(loop: FunctionType) -> None:
    """Remove the machine code that other versions of the package left in the folder of a loop.

    numba has one folder for the sources of one folder, by its full path, so these are earlier
    versions of the package in the same place.  A process that still runs one of them has its code
    in memory, and compiles again what it does not find.
    """
    for path in cached_files(loop):
        if f"_{code_stamp()}_" not in path.name:
            with suppress(OSError):  # another process has removed it, uses it, or owns it
                path.unlink()


@contextmanager
def undisturbed() -> Iterator[None]:
    """Compile without interrupts, and without Python's cyclic garbage collector.

    The collector takes 10 to 20 % of the time: numba allocates millions of small objects, nearly
    all of which live until it has finished.
    """
    enabled = gc.isenabled()
    gc.disable()
    try:
        # To load machine code may take a second too, on a busy machine.
        with (
            held(),
            compilations() as compiled,
            announced("compiling ...", lambda: bool(compiled.buffer)),
        ):
            yield
    finally:
        if enabled:
            gc.enable()


def compilations() -> AbstractContextManager[RecordingListener]:
    """Records what is compiled in a block, in its attribute `buffer`."""
    return install_recorder("numba:compile")


class EntryPoint:
    """The machine code of a compiled loop, called without looking up the types of arguments.

    To look up the types of a dozen arguments takes longer than a short run.  Its first arguments
    are `fixed`; the others have the types of `examples` in each call.  Arguments at the places
    `made` are not checked, as the caller makes them itself as it has made the examples; none are
    where nothing is compiled.
    """

    def __init__(
        self,
        loop: Any,
        fixed: tuple[Any, ...],
        examples: tuple[Any, ...],
        made: tuple[int, ...] = (),
    ) -> None:
        """Compile the loop, or load it from disk.  Raises numba's errors."""
        self._code = _code_for(loop, (*fixed, *examples))
        self._fixed = fixed
        compiled = not config.DISABLE_JIT  # type: ignore[attr-defined]
        checked = [each for each in enumerate(examples) if compiled and each[0] not in made]
        self._arrays = tuple(
            (place, example.dtype, example.strides)
            for place, example in checked
            if isinstance(example, np.ndarray)
        )
        # Tuples that are kept have one type object for each of their types.
        self._kept = tuple(
            (place, example.kind) for place, example in checked if hasattr(example, "kind")
        )
        self._tuples = tuple(
            (place, example) for place, example in checked if isinstance(example, tuple)
        )

    def with_fixed(self, *fixed: Any) -> "EntryPoint":
        """The same code with other first arguments, of the same types."""
        other = copy(self)
        other._fixed = fixed
        return other

    def __call__(self, *arguments: Any) -> Any:
        """Call the loop with `fixed` and these arguments; TypeError if their types differ."""
        for place, dtype, strides in self._arrays:
            array = arguments[place]
            if array.dtype is not dtype or array.strides != strides:
                _refuse_other(place, array, dtype, len(strides))
        for place, kind in self._kept:
            if arguments[place].kind is not kind:
                raise TypeError(f"argument {place} must be a {kind}")
        for place, example in self._tuples:
            if arguments[place] is not example:  # which needs no search
                _compare(place, arguments[place], example)
        if not hooks_before:
            return self._code(*self._fixed, *arguments)
        return raising(self._code, *self._fixed, *arguments)


def _code_for(loop: Any, arguments: tuple[Any, ...]) -> Any:
    """The machine code of a loop for arguments of these types; the loop by other means."""
    if config.DISABLE_JIT:  # type: ignore[attr-defined]
        return loop
    kinds = tuple(map(kind_of, arguments))
    if kinds not in loop.overloads:
        with undisturbed():
            loop.compile(kinds)
    return loop.overloads[kinds].entry_point if NATIVE else loop


def kind_of(argument: Any) -> Any:
    """numba's type of an argument."""
    if type(argument) is np.ndarray and argument.flags.c_contiguous:
        return _array_kind(argument.dtype, argument.ndim, argument.flags.writeable)
    if type(argument) is tuple:  # numba would import numpy.ma for arrays in it
        return types.BaseTuple.from_types(tuple(map(kind_of, argument)))
    return typeof(argument)


@functools.cache
def _array_kind(dtype: np.dtype, ndim: int, writeable: bool) -> Any:
    """numba's type of an array in C's order, which takes long to find where it is of records."""
    return types.Array(from_dtype(dtype), ndim, "C", readonly=not writeable)


def _compare(place: int, given: Any, example: Any) -> None:
    """Raise TypeError where numba's types of two arguments with their members would differ."""
    if type(given) is not type(example) and _class_of(given) is not _class_of(example):
        kinds = type(example).__name__, type(given).__name__
        raise TypeError(f"argument {place} must contain a {kinds[0]}, got a {kinds[1]}")
    if isinstance(example, np.ndarray):
        _refuse_other(place, given, example.dtype, example.ndim)
    elif hasattr(example, "kind"):  # a tuple that is kept
        if given.kind is not example.kind:
            raise TypeError(f"argument {place} must contain a {example.kind}")
    elif isinstance(example, tuple):
        if len(given) != len(example):
            raise TypeError(f"argument {place} must have {len(example)} members, got {len(given)}")
        for one, other in zip(given, example, strict=True):
            _compare(place, one, other)


def _class_of(value: Any) -> type:
    """The class of a value; numba does not tell a float of numpy from one of Python."""
    return float if isinstance(value, float) else type(value)


def _refuse_other(place: int, array: np.ndarray, dtype: np.dtype, ndim: int) -> None:
    if array.dtype != dtype or array.ndim != ndim or not array.flags.c_contiguous:
        raise TypeError(
            f"argument {place} must be a C-contiguous array of {dtype} with {ndim} dimension(s), "
            f"got {array.dtype} with shape {array.shape} and strides {array.strides}"
        )
