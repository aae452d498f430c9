"""How numba compiles a kernel that only other kernels call: once, as part of their code.

By default numba optimises every function together with all the functions that it calls, and
generates machine code for it, then does so again in each of its callers.  A kernel at depth five
is optimised five times, and most of its machine code is never run.  Here a kernel stays as its
front end leaves it until the time loop that contains it is optimised.
"""

from typing import Any

from numba import _dynfunc  # type: ignore[attr-defined]
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder, StateDict
from numba.core.compiler_machinery import PassManager, register_pass
from numba.core.typed_passes import NativeLowering


class LinkedLibrary(JITCodeLibrary):
    """Code that is linked into its callers, neither optimised nor turned into machine code."""

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout

    def _optimize_final_module(self) -> None:
        """Nothing: the caller optimises it."""

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True


@register_pass(mutates_CFG=True, analysis_only=False)
class LinkedLowering(NativeLowering):
    """Lower a kernel to code for its callers."""

    _name = "linked_lowering"

    def run_pass(self, state: StateDict) -> bool:
        """Lower into a :class:`LinkedLibrary`, with an entry point that only marks it."""
        context = state.targetctx
        state.library = library = LinkedLibrary(context.codegen(), state.func_id.func_qualname)
        state.flags.no_compile = True
        super().run_pass(state)
        library.finalize()
        lowered = state["cr"]
        description = lowered.fndesc
        mark = _dynfunc.make_function(
            description.lookup_module(), description.qualname, "", 0, lowered.env, (library,)
        )
        context.insert_user_function(mark, description, [library])
        state["cr"] = lowered._replace(cfunc=mark)
        return True


class KernelCompiler(CompilerBase):
    """numba's compiler with :class:`LinkedLowering` (pass it to numba.njit as pipeline_class)."""

    def define_pipelines(self) -> list[PassManager]:
        """numba's passes, of which the last but one is replaced."""
        passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
        linked = PassManager("kernel")
        for each, description in passes.passes:
            linked.add_pass(LinkedLowering if each is NativeLowering else each, description)
        linked.finalize()
        return [linked]


# Options of numba.njit for functions that only kernels call: no wrappers for calls from Python.
LINKED: dict[str, Any] = {
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
    "pipeline_class": KernelCompiler,
}
