"""What the compiler makes of scenes: one loop for all of them, and contact by vectors."""

import platform
import re
from dataclasses import replace
from typing import NamedTuple

import numba
import numpy as np
import pytest
from numba.core.compiler_lock import global_compiler_lock

import tribo
from tribo.compiler import units
from tribo.compiler.jit import LOOP
from tribo.compiler.kept import kept_type
from tribo.compiler.lanes import FAST_INVERSE_ROOTS
from tribo.compiler.numba_private import NATIVE
from tribo.compiler.plugin_methods import type_of
from tribo.integrators.methods import METHODS
from tribo.kernels import records
from tribo.kernels.contact import open_contact_forces_unit
from tribo.layout.layout import lay_out
from tribo.loops.general import GeneralLoop
from tribo.loops.interleaved import interleaved
from tribo.loops.setting import Setting
from tribo.potentials import as_potential
from tribo.threads.model_units import fulfil, loop_units, rate_units
from tribo.threads.writable_memory import own_model

NO_LEDGER = tribo.Output(ledger="none")
ROW = {"shape": (9, 1), "spacing": (1.0, 0.0)}
# Of LLVM, in the loop of verlet; it was 27,000 when this was written, and 52,000 with all kernels
# copied into their callers.
MOST_INSTRUCTIONS = 33_000


def rows(potential=(), **upper) -> tribo.Scene:
    """Two rows."""
    return tribo.Scene(
        (
            tribo.Surface("upper", bob=(0.3, 0.8), **ROW, **upper),
            tribo.Surface("lower", facing="up", **ROW),
        ),
        potential,
        1.0,
    )


def scenes() -> dict[str, tribo.Scene]:
    """Scenes with one effect after another."""
    reservoir = tribo.Langevin(gamma=0.5, temperature=0.1)
    turning = tribo.Initial(nu=0.3)
    cut_off = tribo.LennardJones(0.1, 0.6).with_cutoff(3.0)
    field = tribo.Field(tribo.Corrugation(0.1, 1.0), ["upper"])
    return {
        "nothing": rows(),
        "no ledger": replace(rows(), output=NO_LEDGER),
        "contact": rows(tribo.Coulomb(0.1)),
        "another contact": rows(cut_off),
        "contact within": rows([tribo.Interaction(cut_off, between=("upper", "upper"))]),
        "bath": rows(bath=tribo.Bath([0.1], [2.0])),
        "reservoir": rows(langevin=reservoir),
        "springs": rows(springs=tribo.Springs(1.0)),
        "pulled": rows(drive=tribo.Pulled(stiffness=1.0, speed=0.1, load=0.1)),
        "driven": rows(drive="bars"),
        "turning": rows(initial=turning),
        "field": replace(rows(), fields=[field]),
        "periodic": replace(rows(cut_off), periodic=tribo.Periodic(x=12.0)),
    }


@pytest.mark.skipif(not NATIVE, reason="numba links kernels in its own way")
def test_one_loop_for_all_kinds_of_scenes():
    """An effect, or a potential, that is new does not compile the loop again."""
    loops = set()
    compiled = set()  # how often after each scene; methods of other classes may have been before
    for name, scene in scenes().items():
        layout = lay_out(scene)
        method = METHODS["verlet"]
        loop = GeneralLoop(layout, method, Setting(step=1e-3), layout.start, 0.0)
        loop.advance(np.array([0.0, 1.0]), loop.room(2), 1)
        loops.add(loop.compiled)
        compiled.add(len(loop.compiled.signatures))
        assert len(compiled) == 1, name
    assert len(loops) == 1


@pytest.mark.skipif(not NATIVE, reason="numba links kernels in its own way")
def test_a_loop_does_not_grow():
    """Kernels that are copied into their callers make code that takes long to compile."""
    layout = lay_out(rows())
    method = METHODS["verlet"]
    loop = GeneralLoop(layout, method, Setting(step=1.0), layout.start, 0.0)
    # Not from the disk cache, which keeps machine code alone.
    loop.compiled = numba.njit(**LOOP)(method.loop)
    loop.advance(np.ones(1), loop.room(1), 0)
    (result,) = loop.compiled.overloads.values()
    whole = re.findall(r"^  ", result.library.get_llvm_str(), re.M)
    assert len(whole) < MOST_INSTRUCTIONS


def test_members_side_by_side_share_the_units_of_single_runs():
    layout = lay_out(rows(tribo.Coulomb(0.1)))
    alone, _ = own_model(layout)
    eight = interleaved(layout, True).model
    assert kept_type(eight) is kept_type(alone)
    for model in (alone, eight):
        fulfil(loop_units(model) + rate_units(model))
    for place in (records.RATES, records.POWERS, records.SPEEDS, records.SAMPLE):
        assert eight.units[place] == alone.units[place] != 0


class Ripple(NamedTuple):
    """A formula that is computed one pair after another."""

    a: float

    def energy(self, r):
        """A ripple."""
        return self.a * np.sin(r) / r


def code_of(potential) -> tuple[str, dict[str, int]]:
    """The unit of a contact's forces, and how many instructions work on vectors or numbers."""
    own_model(lay_out(rows(potential)))
    kind = type_of(as_potential(potential))
    (unit,) = (
        each
        for (function, kinds, _), each in units._units.items()
        if function is open_contact_forces_unit and kinds[2].kind == kind
    )
    with global_compiler_lock:  # not from the disk cache, which keeps machine code alone
        code = unit._compile_uncached().library
        code.finalize()
    found = re.findall(r"^\s+v?(?:mul|add|sub|div|sqrt)([ps])d\b", code.get_asm_str(), re.M)
    return code.get_llvm_str(), {kind: found.count(kind) for kind in "ps"}


FORMULAS = {
    "coulomb": tribo.Coulomb(0.1),
    "morse": tribo.Morse(0.1, 2.0, 0.6),
    "lennard-jones with a cutoff": tribo.LennardJones(0.1, 0.6).with_cutoff(3.0),
}


@pytest.mark.parametrize("name", FORMULAS)
def test_contact_is_computed_by_vector_instructions(name):
    """Of eight pairs at once, without a call for one of them; roots and exponentials too."""
    code, instructions = code_of(FORMULAS[name])
    root = "x86.avx512.rsqrt14.pd.512" if FAST_INVERSE_ROOTS else "sqrt.v8f64"
    assert f"call <8 x double> @llvm.{root}" in code
    if FAST_INVERSE_ROOTS and name == "coulomb":  # whose formula needs 1 / r, but not r
        assert not re.search(r"fdiv .*<8 x double>", code)
    assert not re.search(r"call double @(llvm\.)?(exp|pow|sin)", code)
    if platform.machine() == "x86_64":
        assert instructions["p"] > instructions["s"], instructions


@pytest.mark.thorough
def test_other_formulas_are_computed_one_pair_after_another():
    """With a sine there are calls for single pairs, and more scalar arithmetic than in lanes."""
    code, instructions = code_of(as_potential(Ripple(0.1)))
    assert re.search(r"call double @(llvm\.)?sin", code)
    if platform.machine() == "x86_64":
        assert instructions["s"] > code_of(tribo.Coulomb(0.1))[1]["s"]
