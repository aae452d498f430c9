"""The module of a page: the program, compiled for the class of a potential.

A process of its own compiles it for a generic processor (NUMBA_CPU_NAME), whose code has no
instruction that a browser lacks; a process that runs already cannot change its processor.  Modules
are kept beside numba's machine code, so that a page takes seconds only once.
"""

import hashlib
import os
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from tribo.compiler.jit import COMPILED, LOOP, cache_folder, stamp_of
from tribo.compiler.numba_private import NATIVE, pickled
from tribo.compiler.plugin_methods import recognize
from tribo.files import replace_file
from tribo.kernels.records import CLOCK
from tribo.live_pages import program
from tribo.live_pages.inputs import INPUTS
from tribo.live_pages.link import linked
from tribo.live_pages.quantities import QUANTITIES
from tribo.live_pages.retarget import object_of
from tribo.pair import step_rows
from tribo.pair.loop import COLUMNS, pair_collocation
from tribo.plugins.stamps import code_stamp_of
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
        for name in ("inputs", "setup", "quantities", "limits", "program", "retarget", "link")
    ),
)
# The arrays of the program behind the potential: the shape of each, where -1 is the number of
# samples and -2 one more; the clock is a record.
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
    place = _kept_at(potential)
    if place is not None:
        with suppress(OSError):
            return place.read_bytes()
    content = _compiled_apart(potential)
    if place is not None:
        with suppress(OSError):
            replace_file(place, content)
    return content


def _kept_at(potential: Any) -> Path | None:
    """The file of the module; None for a class whose sources are not known."""
    stamp = code_stamp_of([potential])
    folder = cache_folder(pair_collocation)
    if stamp is None or folder is None:
        return None
    kind = hashlib.blake2b(f"{stamp} {_shape(potential)}".encode(), digest_size=8).hexdigest()
    return folder / f"live-{stamp_of(SOURCES)}-{kind}.wasm"


def _shape(value: Any) -> str:
    """The classes in a potential."""
    if isinstance(value, tuple):
        return f"{type(value).__qualname__}({','.join(map(_shape, value))})"
    return type(value).__name__


def _compiled_apart(potential: Any) -> bytes:
    """The module, compiled by another process."""
    if not NATIVE:
        raise InputError("numba", "must be a version that tribo was tested with, for live pages")
    given = pickled((sys.path, potential))
    command = [sys.executable, "-c", "from tribo.live_pages.compile import main; main()"]
    paths = os.pathsep.join(str(each) for each in sys.path if each)
    environment = os.environ | GENERIC | {"PYTHONPATH": paths}
    done = subprocess.run(command, input=given, capture_output=True, env=environment, check=False)
    if done.returncode == 0:
        return done.stdout
    said = done.stderr.decode(errors="replace").strip().splitlines() or ["no message"]
    problem = f"does not compile for a page ({said[-1]}); {ELSEWHERE}"
    raise InputError("interaction.potential", problem)


def main() -> None:
    """Compile the potential that stands in the standard input, and write the module."""
    import pickle

    path, potential = pickle.loads(sys.stdin.buffer.read())
    sys.path[:] = path
    sys.stdout.buffer.write(compiled(potential))


def arguments_of(potential: Any, samples: int) -> tuple[Any, ...]:
    """Arguments of the program for so many samples."""
    count = {-1: samples, -2: samples + 1}
    kinds = {"clocks": CLOCK}
    arrays = []
    for name, shape in ARRAYS.items():
        sizes = [count.get(each, each) for each in shape]
        arrays.append(np.zeros(sizes, kinds.get(name, float)))
    return (potential, *arrays)


def compiled(potential: Any) -> bytes:
    """The module, compiled in this process, whose processor should be generic."""
    from numba import njit, typeof

    recognize(potential)
    loop = njit(**LOOP)(program.live_pair)
    kinds = tuple(map(typeof, arguments_of(potential, 2)))
    loop.compile(kinds)
    name = loop.overloads[kinds].fndesc.llvm_func_name
    return linked(object_of(loop.inspect_llvm(kinds), name), name, "run")
