"""Kernels on disk that only other kernels call: compiled once, not again in each process.

A time loop or a unit on disk is machine code, with all kernels that it calls in it.  The next one
calls many of the same kernels.  Each of them is therefore kept as its front end leaves it: LLVM's
code of the kernel itself, its types, and the files of the kernels that it calls.

Kept are kernels whose sources are in :func:`tribo.compiler.source_stamps.code_stamp`, for types of
this package, numba and Python alone.  Those for the class of a plug-in from elsewhere are not, and
neither is what contains their code.
"""

import hashlib
import io
import pickle
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from types import FunctionType
from typing import Any

from llvmlite import binding

from tribo.compiler.cache import KernelCache, whole_parts
from tribo.compiler.linking import LinkedLibrary, marked
from tribo.compiler.numba_private import Environment, compiler
from tribo.compiler.source_stamps import is_stamped

# Where classes and functions in the types of a kernel may come from.
KNOWN = ("_operator", "builtins", "collections", "copyreg", "llvmlite", "numba", "numpy", "tribo")
# How numba's names of addresses in this process begin.
DYNAMIC = "numba.dynamic.globals"
# How those of the globals of a function in Python begin.
ENVIRONMENT = "_ZN08NumbaEnv"

# Name of a file, and hash of the code in it -> this code, from disk or compiled here.
_libraries: dict[tuple[str, bytes], LinkedLibrary] = {}


class LinkedCache(KernelCache):
    """Compiled forms of one kernel on disk."""

    def __init__(self, name: Callable[[], str]) -> None:
        """`name` gives the kernel's name there.  Nothing is looked for before it is needed."""
        self._make_name = name
        self._can_be_written: bool | None = None

    @property
    def cache_path(self) -> str | None:
        """The folder of its files; None if none can be written."""
        return self._cache_path if self._is_found() else None

    def load_overload(self, signature: Any, target: Any) -> Any:
        """The kernel for these types as if it had been compiled; None if it must be."""
        if not self._is_found():
            return None
        key = self._index_key(signature, target.codegen())
        stored = self._cache_file.load(key)
        if stored is None:
            return None
        code, types = stored
        path = self._cache_file.path(key)
        library = _library(path, code, target.codegen())
        if library is None:
            return None
        found, library.description = pickle.loads(types)
        library.description.mangled_name = _symbol_of(path)
        environment = Environment.from_fndesc(library.description)
        return compiler.compile_result(
            target_context=target,
            typing_context=target.typing_context,
            library=library,
            environment=environment,
            entry_point=marked(library, environment),
            fndesc=library.description,
            signature=found,
            objectmode=False,
            lifted=(),
            reload_init=[],
        )

    def save_overload(self, signature: Any, result: Any) -> None:
        """Write a kernel, if nothing in it can differ in another process."""
        library = result.library
        if not self._is_found() or result.reload_init:
            return
        description = library.description
        description.typemap = description.calltypes = None  # as numba does
        types = _known_content((result.signature, description))
        if types is None:
            return
        key = self._index_key(signature, result.codegen)
        path = self._cache_file.path(key)
        library.rename(_symbol_of(path))
        code = _code_of(library)
        if code is None:
            return
        with suppress(OSError):  # the code is in memory; another process compiles it again
            self._cache_file.save(key, (code, types))
            library.kept = path.name, _hash(code)
            _libraries[library.kept] = library

    def _is_found(self) -> bool:
        """Whether there is a folder that can be written."""
        if self._can_be_written is None:
            self._can_be_written = False
            with suppress(RuntimeError):
                super().__init__(_in_one_folder(self._make_name()))
                self._can_be_written = True
        return self._can_be_written


def _in_one_folder(name: str) -> FunctionType:
    """A function of this file, so that numba finds one folder for all kernels."""
    clone = FunctionType(_symbol_of.__code__, globals(), name)
    clone.__qualname__ = name
    return clone


def _symbol_of(path: Path) -> str:
    """The name of a kernel in LLVM's code, the same in all processes.

    numba's names have numbers in them that each process counts for itself.
    """
    return f"tribo.{path.stem}"


class _Known(pickle.Unpickler):
    """Reads what refers to known modules alone; raises LookupError elsewhere."""

    def find_class(self, module: str, name: str) -> Any:
        if module.partition(".")[0] not in KNOWN:
            raise LookupError(f"{module}.{name}")
        return super().find_class(module, name)


def _known_content(types: object) -> bytes | None:
    """What is written of types; None if they refer to other modules than the known ones.

    Python writes classes by their names, and refuses those that no module has.
    """
    try:
        content = pickle.dumps(types)
        _Known(io.BytesIO(content)).load()
    except (AttributeError, LookupError, TypeError, pickle.PicklingError):
        return None
    return content


def _code_of(library: LinkedLibrary) -> bytes | None:
    """A kernel without those that are kept by themselves; None if it cannot be kept."""
    whole = library._final_module.clone()
    calls = []
    for each in dict.fromkeys(library._linking_libraries):
        if isinstance(each, LinkedLibrary):
            if each.kept:
                calls.append(each.kept)
                continue
            if not _is_own(each):
                return None
        whole.link_in(each._get_module_for_linking(), preserve=True)
    # Another process may have given the names of others to other functions.
    own = library.description.mangled_name
    inner = [each for each in whole.functions if not each.is_declaration and each.name != own]
    for number, function in enumerate(inner):
        function.name = f"{own}.{number}"
        function.linkage = "internal"
    for variable in whole.global_variables:
        if variable.name.startswith(ENVIRONMENT):
            variable.linkage = "internal"
    kernel = whole.get_function(own)
    kernel.linkage = "external"
    _remove_unused(whole, library.codegen)
    kernel.linkage = "linkonce_odr"  # as numba sets it in a copy
    if any(each.name.startswith((DYNAMIC, ENVIRONMENT)) for each in whole.global_variables):
        return None
    return pickle.dumps((library.name, whole.as_bitcode(), calls))


def _remove_unused(module: binding.ModuleRef, codegen: Any) -> None:
    """Remove what has no effect, such as the addresses of kernels in Python."""
    options = binding.create_pipeline_tuning_options(speed_level=0)
    builder = binding.create_pass_builder(codegen._tm, options)
    passes = binding.create_new_module_pass_manager()
    passes.add_dead_code_elimination_pass()
    passes.add_global_dead_code_eliminate_pass()
    passes.run(module, builder)


def _is_own(library: LinkedLibrary) -> bool:
    """Whether a kernel is compiled from stamped sources, for known types."""
    described = library.description
    return is_stamped(described.modname) and _known_content(described.argtypes) is not None


def _hash(code: bytes) -> bytes:
    return hashlib.blake2b(code, digest_size=16).digest()


def _library(path: Path, code: bytes, codegen: Any) -> LinkedLibrary | None:
    """The code that was read from a file; None if a kernel that it calls is no longer there."""
    kept = path.name, _hash(code)
    if kept in _libraries:
        return _libraries[kept]
    name, bitcode, calls = pickle.loads(code)
    library = LinkedLibrary(codegen, name)
    for called in calls:
        found = _libraries.get(called) or _read(path.with_name(called[0]), called[1], codegen)
        if found is None:
            return None
        library.add_linking_library(found)
    library._final_module = binding.parse_bitcode(bitcode)
    library._finalized = True
    library.kept = kept
    _libraries[kept] = library
    return library


def _read(path: Path, expected: bytes, codegen: Any) -> LinkedLibrary | None:
    """The code in a file; None if it is another than that which its caller was kept with."""
    try:
        _, (code, _) = whole_parts(path)
    except Exception:  # a class that it names is no longer there
        return None
    return _library(path, code, codegen) if _hash(code) == expected else None
