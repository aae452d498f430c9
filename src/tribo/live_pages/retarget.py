"""From the code that numba makes to a WebAssembly object, by the LLVM in llvmlite."""

import re
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


def object_of(code: str, function: str) -> bytes:
    """The object with one function of a module of LLVM, and with what this calls."""
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    code = REFERENCES.sub(UNCOUNTED, OF_HOST.sub("", code))
    module = llvm.parse_assembly(code)
    machine = llvm.Target.from_triple(TARGET).create_target_machine(opt=3, features=FEATURES)
    module.triple = TARGET
    module.data_layout = str(machine.target_data)
    for each in module.functions:
        if not each.is_declaration:
            each.linkage = "external" if each.name == function else "internal"
    for each in module.global_variables:
        if not each.is_declaration:
            each.linkage = "internal"
    _drop_unused(module, machine)
    return bytes(machine.emit_object(module))


def _drop_unused(module: Any, machine: Any) -> None:
    """Remove what the function does not call, as numba's wrappers for Python."""
    options = llvm.create_pipeline_tuning_options(speed_level=3)
    builder = llvm.create_pass_builder(machine, options)
    passes = builder.getModulePassManager()
    passes.add_global_dead_code_eliminate_pass()
    passes.run(module, builder)
