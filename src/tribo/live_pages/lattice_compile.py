"""The module of a page with a row or grid: the time loop, its units and its quantities, as one.

Units of other scenes of the same kind are the same, so that a module is kept for each kind.
"""

import sys
import tempfile
from typing import Any

from tribo.compiler.jit import LOOP
from tribo.compiler.source_stamps import COMPILED
from tribo.layout.layout import lay_out
from tribo.live_pages.compile import compiled_apart, given_to_process, kept_or_made
from tribo.live_pages.lattice import FULL, Program, known_units, program_of
from tribo.live_pages.link import linked
from tribo.live_pages.retarget import UNIT, object_of
from tribo.model.scene import Scene
from tribo.plugins.stamps import code_stamp_of

SOURCES = (
    *COMPILED,
    "model/asperite.py",
    *(f"live_pages/{n}.py" for n in ("accounts", "quantities", "program", "retarget")),
    *(f"live_pages/{n}.py" for n in ("lattice_asperite", "lattice_quantities")),
    *(
        f"live_pages/{n}.py"
        for n in ("link", "lattice", "lattice_compile", "lattice_loop", "lattice_setup", "setup")
    ),
)


def module_of(scene: Scene, program: Program, plugins: list[Any]) -> bytes:
    """The module for a scene, of which this process has a program.

    Raises InputError if it cannot be compiled, and OSError if no process can be started.
    """
    stamp = code_stamp_of(plugins)
    kind = None if stamp is None else " ".join([stamp, program.method, *program.names])
    with tempfile.TemporaryDirectory() as folder:
        given = scene, program.method, program.names
        place = "tribo.live_pages.lattice_compile.main"
        # Numba keeps machine code on disk, of which no other can be made: nothing is taken from it.
        return kept_or_made(kind, SOURCES, lambda: compiled_apart(place, given, "scene", folder))


def main() -> None:
    """Compile the scene that stands in the standard input, and write the module."""
    sys.stdout.buffer.write(compiled(*given_to_process()))


def compiled(scene: Scene, method: str, names: tuple[str, ...]) -> bytes:
    """The module with units in this order, compiled in this process, as generic code."""
    from numba import njit, typeof

    program = program_of(lay_out(scene), 1.0, method)
    exported = {UNIT: UNIT}
    codes = {}
    for call in program.calls[FULL]:
        function = njit(**LOOP)(call.function)
        kinds = tuple(map(typeof, call.arguments))
        function.compile(kinds)
        name = function.overloads[kinds].fndesc.llvm_func_name
        codes[name] = function.inspect_llvm(kinds)
        exported[call.name] = name
    made = dict(known_units().values())
    units = []
    for each in names:
        library = made[each]._library
        units.append(made[each]._wrapper_name)
        codes[units[-1]] = library.get_llvm_str()
    return linked(object_of(codes, units), exported)
