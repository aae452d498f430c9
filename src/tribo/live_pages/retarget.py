"""From the code that numba makes to a WebAssembly object, by the LLVM in llvmlite."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

import llvmlite.binding as llvm

TARGET = "wasm32-unknown-unknown"
FEATURES = "+simd128"
# Numba's counts of the references to an array, for which LLVM took an instruction of the processor.
# Arrays of a page have no owner, so that nothing is counted.
REFERENCES = re.compile(r"^define [^\n]*@NRT_(in|de)cref\(.*?^}$", re.MULTILINE | re.DOTALL)
UNCOUNTED = r"define void @NRT_\1cref(ptr %0) {\n  ret void\n}"
# Lines that are of the processor for which numba compiled, and a linkage that objects lack.
OF_HOST = re.compile(r"^target (triple|datalayout) = .*$|\bcommon\b", re.MULTILINE)
# The function that finds the place of a unit in the table of functions, by its number.
UNIT = "unit"


def object_of(codes: Mapping[str, str], units: Sequence[str] = ()) -> bytes:
    """The object with some functions, each with the module of LLVM that has it.

    Of these, `units` are called by their place in a table alone; the function `unit` of the object
    returns the place of the nth.
    """
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    machine = llvm.Target.from_triple(TARGET).create_target_machine(opt=3, features=FEATURES)
    whole = _module("", machine)
    for function, code in codes.items():
        module = _module(REFERENCES.sub(UNCOUNTED, OF_HOST.sub("", code)), machine)
        _keep(module, [function])
        whole.link_in(module)
    kept = [each for each in codes if each not in units]
    if units:
        whole.link_in(_module(_finder(units), machine))
        kept.append(UNIT)
    _keep(whole, kept)
    _drop_unused(whole, machine)
    return bytes(machine.emit_object(whole))


def _module(code: str, machine: Any) -> Any:
    """A module of LLVM for the target."""
    module = llvm.parse_assembly(code)
    module.triple = TARGET
    module.data_layout = str(machine.target_data)
    return module


def _keep(module: Any, names: Sequence[str]) -> None:
    """Let only functions with these names be seen from outside."""
    for each in module.functions:
        if not each.is_declaration:
            each.linkage = "external" if each.name in names else "internal"
    for each in module.global_variables:
        if not each.is_declaration:
            each.linkage = "internal"


def _finder(units: Sequence[str]) -> str:
    """The function that finds units, in LLVM's language."""
    declared = "\n".join(f'declare double @"{name}"()' for name in units)
    listed = ", ".join(f'ptr @"{name}"' for name in units)
    kind = f"[{len(units)} x ptr]"
    return f"""\
{declared}
@units = internal constant {kind} [{listed}]
define i32 @{UNIT}(i32 %number) {{
  %place = getelementptr {kind}, ptr @units, i32 0, i32 %number
  %found = load ptr, ptr %place
  %result = ptrtoint ptr %found to i32
  ret i32 %result
}}
"""


def _drop_unused(module: Any, machine: Any) -> None:
    """Remove what no function calls, as numba's wrappers for Python."""
    options = llvm.create_pipeline_tuning_options(speed_level=3)
    builder = llvm.create_pass_builder(machine, options)
    passes = builder.getModulePassManager()
    passes.add_global_dead_code_eliminate_pass()
    passes.run(module, builder)
