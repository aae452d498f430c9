"""How numba compiles a kernel that only other kernels call: once, as part of their code.

By default numba optimises every function together with all the functions that it calls, and
generates machine code for it, then does so again in each of its callers.  A kernel at depth five
is optimised five times, and most of its machine code is never run.  Here a kernel stays as its
front end leaves it until the time loop that contains it is optimised.
"""

import ctypes
from types import FunctionType
from typing import Any

from llvmlite import ir

from tribo.compiler.numba_private import CFunc, JITCodeLibrary, Lower, _dynfunc, compiler
from tribo.compiler.numba_private import compiler_machinery as machinery
from tribo.compiler.numba_private import typed_passes as typed
from tribo.compiler.numba_private import untyped_passes as untyped
from tribo.compiler.tuple_types import Module


class TupleLibrary(JITCodeLibrary):
    """Code whose functions may have named tuples of kernels as arguments."""

    def create_ir_module(self, name: str) -> Any:
        """An empty module that declares what it uses."""
        plain = super().create_ir_module(name)
        module = Module(plain.name)
        module.triple = plain.triple
        module.data_layout = plain.data_layout
        return module


class LinkedLibrary(TupleLibrary):
    """The code of one kernel without that of those it calls; neither optimised nor machine code.

    Were each kernel linked with all that it calls, as numba does, the deepest one would be copied
    once for every path to it.
    """

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout

    # "alwaysinline" or "noinline", if LLVM has to copy the kernel into its callers, or must not.
    inlining: str | None = None
    # What numba knows of the kernel: its name, and the types of its arguments and result.
    description: Any = None
    # The name of its file on disk, and the hash of what is there; None if it is not kept.
    kept: tuple[str, bytes] | None = None

    def finalize(self) -> None:
        """Link and optimise nothing: a library that machine code is made of does."""
        self._raise_if_finalized()
        for library in self._linking_libraries:
            self._reload_init.update(library._reload_init)
        self._finalize_dynamic_globals()
        for function in self._final_module.functions:
            if not function.is_declaration:
                function.linkage = "linkonce_odr"  # as numba sets it in a copy
                if self.inlining is not None:
                    function.add_function_attribute(self.inlining)
        self._finalized = True

    def rename(self, name: str) -> None:
        """Give the kernel another name in LLVM's code, before its first caller is compiled."""
        self._final_module.get_function(self.description.mangled_name).name = name
        self.description.mangled_name = name

    def _get_module_for_linking(self) -> Any:
        """The code of this kernel and of all that it calls, each once."""
        whole = None
        # Callers first: LLVM leaves out functions without a caller.
        for library in self._called():
            own = JITCodeLibrary._get_module_for_linking(library)
            if whole is None:
                whole = own.clone()
            else:
                whole.link_in(own, preserve=True)
        return whole

    def _called(self) -> list[JITCodeLibrary]:
        """This library and those of all kernels that it calls, each after its first caller."""
        found: dict[JITCodeLibrary, None] = {self: None}
        waiting: list[JITCodeLibrary] = [self]
        for library in waiting:  # also those that are appended here
            if isinstance(library, LinkedLibrary):
                new = [each for each in library._linking_libraries if each not in found]
                found.update(dict.fromkeys(new))
                waiting += dict.fromkeys(new)
        return list(found)


class LoopLibrary(TupleLibrary):
    """The code of a time loop, optimised once.

    numba optimises twice, so that the first pass brings together the reference counts that the
    second removes.  Kernels count none.
    """

    def _optimize_final_module(self) -> None:
        passes, builder = self._codegen._module_pass_manager()
        passes.run(self._final_module, builder)


class UnitLibrary(LoopLibrary):
    """The code of a unit, which is called by the address of its wrapper for C.

    The wrapper contains the unit: a call of one by the other, with results in memory, would take as
    long as a small unit.
    """

    def add_ir_module(self, ir_module: Any) -> None:
        """Add a module, of which calls may be replaced by what they call."""
        for function in ir_module.functions:
            for block in function.blocks:
                for instruction in block.instructions:
                    if isinstance(instruction, ir.CallInstr):
                        instruction.attributes.discard("noinline")
        super().add_ir_module(ir_module)

    def _optimize_final_module(self) -> None:
        functions = {each.name: each for each in self._final_module.functions}
        for name, function in functions.items():
            if f"{WRAPPER}{name}" in functions:
                function.linkage = "internal"
                function.add_function_attribute("alwaysinline")
        super()._optimize_final_module()


# What numba puts before the name of a function in that of its wrapper for C.
WRAPPER = "cfunc."
# What a call of a kernel from Python leads to: a function of CPython that raises TypeError.
WRONG_CALL = ctypes.cast(ctypes.pythonapi.PyErr_BadArgument, ctypes.c_void_p).value


class KernelLower(Lower):
    """numba's lowering without the sizes of arguments, which only debuggers need.

    LLVM has to parse a module of its own for each of them.
    """

    def storevar(self, value: Any, name: str, argidx: int | None = None) -> None:
        super().storevar(value, name, argidx if self.context.enable_nrt else None)


@machinery.register_pass(mutates_CFG=False, analysis_only=False)
class LinkedLowering(typed.NativeLowering):
    """Lower a kernel to code for its callers."""

    _name = "linked_lowering"
    lowering_class = KernelLower
    inlining: str | None = None

    def run_pass(self, state: compiler.StateDict) -> bool:
        """Lower into a :class:`LinkedLibrary`, with an entry point that only marks it."""
        context = state.targetctx
        state.library = library = LinkedLibrary(context.codegen(), state.func_id.func_qualname)
        library.inlining = self.inlining
        state.flags.no_compile = True
        super().run_pass(state)
        library.finalize()
        lowered = state["cr"]
        library.description = lowered.fndesc
        mark = marked(library, lowered.env)
        context.insert_user_function(mark, lowered.fndesc, [library])
        state["cr"] = lowered._replace(cfunc=mark)
        return True


def marked(library: LinkedLibrary, environment: Any) -> Any:
    """An entry point that stands for a kernel and cannot be called."""
    described = library.description
    return _dynfunc.make_function(
        described.lookup_module(), described.qualname, "", WRONG_CALL, environment, (library,)
    )


@machinery.register_pass(mutates_CFG=False, analysis_only=False)
class ApartLowering(LinkedLowering):
    """Lower a kernel that stays a function of its own."""

    _name = "apart_lowering"
    inlining = "noinline"


@machinery.register_pass(mutates_CFG=False, analysis_only=False)
class InlinedLowering(LinkedLowering):
    """Lower a kernel that becomes a part of its callers.

    numba's own option for this is one of its flags, which functions without a choice take from
    their callers: numba would compile these twice, for callers with and without it.
    """

    _name = "inlined_lowering"
    inlining = "alwaysinline"


@machinery.register_pass(mutates_CFG=False, analysis_only=False)
class LoopLowering(typed.NativeLowering):
    """Lower a time loop to machine code."""

    _name = "loop_lowering"
    library: type[LoopLibrary] = LoopLibrary

    def run_pass(self, state: compiler.StateDict) -> bool:
        state.library = self.library(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library.enable_object_caching()
        return super().run_pass(state)


@machinery.register_pass(mutates_CFG=False, analysis_only=False)
class UnitLowering(LoopLowering):
    """Lower a unit to machine code."""

    _name = "unit_lowering"
    library = UnitLibrary


# Passes for `with` blocks, closures, generator expressions, arithmetic of whole arrays, overloads
# that are expanded in their callers, and reports of types and of parallel loops.
UNNEEDED = (
    untyped.WithLifting,
    untyped.InlineClosureLikes,
    untyped.MakeFunctionToJitFunction,
    typed.NopythonRewrites,
    typed.InlineOverloads,
    typed.AnnotateTypes,
    typed.DumpParforDiagnostics,
)


class KernelCompiler(compiler.CompilerBase):
    """numba's compiler of kernels (numba.njit takes it as pipeline_class)."""

    lowering: type[typed.NativeLowering] = LinkedLowering

    def define_pipelines(self) -> list[machinery.PassManager]:
        """numba's passes without those for what kernels do not have; the last one is ours."""
        passes = compiler.DefaultPassBuilder.define_nopython_pipeline(self.state)
        changed = machinery.PassManager("kernel")
        for each, description in passes.passes:
            if each not in UNNEEDED:
                changed.add_pass(
                    self.lowering if each is typed.NativeLowering else each, description
                )
        changed.finalize()
        return [changed]


class ApartCompiler(KernelCompiler):
    """numba's compiler of kernels that stay functions of their own."""

    lowering = ApartLowering


class InlinedCompiler(KernelCompiler):
    """numba's compiler of kernels that become parts of their callers."""

    lowering = InlinedLowering


class LoopCompiler(KernelCompiler):
    """numba's compiler of time loops."""

    lowering = LoopLowering


class UnitCompiler(KernelCompiler):
    """numba's compiler of units."""

    lowering = UnitLowering


def unit_of(function: FunctionType, kinds: Any, result: Any, options: dict[str, Any]) -> Any:
    """A function that is called by its address."""
    return CFunc(function, (kinds, result), {}, options, pipeline_class=UnitCompiler)  # type: ignore[arg-type]
