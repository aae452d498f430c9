"""The module of a page: the program, compiled for the class of a potential.

A process of its own compiles it for a generic processor (NUMBA_CPU_NAME), whose code has no
instruction that a browser lacks; a process that runs already cannot change its processor.  Modules
are kept beside numba's machine code, so that a page takes seconds only once.
"""

import hashlib
import os
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np

from tribo.compiler.jit import LOOP, cache_folder
from tribo.compiler.numba_private import NATIVE, pickled
from tribo.compiler.plugin_methods import recognize
from tribo.compiler.source_stamps import COMPILED, stamp_of
from tribo.files import replace_file
from tribo.kernels.records import CLOCK
from tribo.live_pages import program
from tribo.live_pages.inputs import INPUTS
from tribo.live_pages.link import linked
from tribo.live_pages.quantities import QUANTITIES
from tribo.live_pages.retarget import object_of
from tribo.pair import step_rows
from tribo.pair.loop import COLUMNS, pair_collocation
from tribo.plugins.sources import load, loaded_in
from tribo.plugins.stamps import code_stamp_of
from tribo.system import THREADS_VARIABLE
from tribo.validation import InputError

# What to do where a scene cannot go in.
ELSEWHERE = (
    "`tribo view --slider KEY=LOW:HIGH` writes a page with runs of the scene, and `tribo play` "
    "simulates while values change"
)
GENERIC = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}
# Sources that a module is made of.
SOURCES = (
    *COMPILED,
    "model/asperite.py",
    *(
        f"live_pages/{name}.py"
        for name in (
            "inputs",
            "setup",
            "accounts",
            "quantities",
            "limits",
            "program",
            "retarget",
            "link",
        )
    ),
)
# The arrays of the program behind the potential, those of its tuples one after another: the shape
# of each, where -1 is the number of samples and -2 one more; the clock is a record.
ARRAYS: dict[str, tuple[int, ...]] = {
    "numbers": (INPUTS,),
    "options": (program.OPTIONS,),
    "memory": (step_rows.ROWS, 8),
    "clocks": (1,),
    "start": (4,),
    "times": (-1,),
    "record": (-2, COLUMNS),
    "coarse": (-2, COLUMNS),
    "series": (QUANTITIES, -1),
    "other": (QUANTITIES, -1),
    "errors": (QUANTITIES,),
}


def module_of(potential: Any) -> bytes:
    """The module for potentials of this class.

    Raises InputError if it cannot be compiled, and OSError if no process can be started.
    """
    stamp = code_stamp_of([potential])
    kind = None if stamp is None else f"{stamp} {_shape(potential)}"
    place = "tribo.live_pages.compile.main"
    key = "interaction.potential"
    return kept_or_made(kind, SOURCES, lambda: compiled_apart(place, potential, key))


def kept_or_made(stamp: str | None, sources: tuple[str, ...], make: Callable[[], bytes]) -> bytes:
    """A module that is kept on disk by a stamp and by its sources; with None it is made again."""
    folder = cache_folder(pair_collocation)
    if stamp is None or folder is None:
        return make()
    kind = hashlib.blake2b(stamp.encode(), digest_size=8).hexdigest()
    place = folder / f"live-{stamp_of(sources)}-{kind}.wasm"
    with suppress(OSError):
        return place.read_bytes()
    content = make()
    with suppress(OSError):
        replace_file(place, content)
    return content


def _shape(value: Any) -> str:
    """The classes in a potential."""
    if isinstance(value, tuple):
        return f"{type(value).__qualname__}({','.join(map(_shape, value))})"
    return type(value).__name__


def compiled_apart(main: str, given: Any, key: str, folder: str | None = None) -> bytes:
    """The module that `main`, "module.function", of another process makes of what is `given`.

    Numba's machine code is in a `folder`, if it is given.  Raises InputError at `key`.
    """
    if not NATIVE:
        raise InputError("numba", "must be a version that tribo was tested with, for live pages")
    module, _, function = main.rpartition(".")
    command = [sys.executable, "-c", f"from {module} import {function}; {function}()"]
    paths = os.pathsep.join(str(each) for each in sys.path if each)
    environment = os.environ | GENERIC | {"PYTHONPATH": paths}
    if folder is not None:
        # What other processes compile is machine code alone.
        environment |= {"NUMBA_CACHE_DIR": folder, THREADS_VARIABLE: "1"}
    content = for_process(given)
    done = subprocess.run(command, input=content, capture_output=True, env=environment, check=False)
    if done.returncode == 0:
        return done.stdout
    said = done.stderr.decode(errors="replace").strip().splitlines() or ["no message"]
    raise InputError(key, f"does not compile for a page ({said[-1]}); {ELSEWHERE}")


def for_process(given: Any) -> bytes:
    """Something for `given_to_process` of another process, with the sources of its classes."""
    content = pickled(given)
    return pickled((sys.path, loaded_in(content), content))


def given_to_process() -> Any:
    """What :func:`for_process` has written to the standard input of this process."""
    import pickle

    path, modules, given = pickle.loads(sys.stdin.buffer.read())
    sys.path[:] = path
    for source, place in modules:
        load(source, place)
    return pickle.loads(given)


def main() -> None:
    """Compile the potential that stands in the standard input, and write the module."""
    sys.stdout.buffer.write(compiled(given_to_process()))


def arguments_of(potential: Any, samples: int) -> tuple[Any, ...]:
    """Arguments of the program for so many samples."""
    count = {-1: samples, -2: samples + 1}
    kinds = {"clocks": CLOCK}
    arrays = []
    for name, shape in ARRAYS.items():
        sizes = [count.get(each, each) for each in shape]
        arrays.append(np.zeros(sizes, kinds.get(name, float)))
    numbers, options, memory, clocks, start, times, record, coarse, series, other, errors = arrays
    loop = memory, clocks, start
    return potential, numbers, options, loop, times, (record, coarse), (series, other), errors


def compiled(potential: Any) -> bytes:
    """The module, compiled in this process, whose processor should be generic."""
    from numba import njit, typeof

    recognize(potential)
    loop = njit(**LOOP)(program.live_pair)
    kinds = tuple(map(typeof, arguments_of(potential, 2)))
    loop.compile(kinds)
    name = loop.overloads[kinds].fndesc.llvm_func_name
    return linked(object_of({name: loop.inspect_llvm(kinds)}), {"run": name})
