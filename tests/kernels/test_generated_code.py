"""What the compiler makes of a scene: no code of absent effects, and contact by vectors."""

import platform
import re
from dataclasses import replace
from typing import NamedTuple

import numba
import numpy as np
import pytest

import tribo
from support.kernels import shared_kernel
from tribo.compiler.jit import LOOP
from tribo.compiler.lanes import FAST_INVERSE_ROOTS
from tribo.compiler.numba_private import NATIVE
from tribo.integrators.methods import METHODS
from tribo.kernels.contact_forces import contact_forces
from tribo.layout.layout import lay_out
from tribo.loops.general import GeneralLoop
from tribo.potentials import as_potential
from tribo.threads.writable_memory import own_model

NO_LEDGER = tribo.Output(ledger="none")
ROW = {"shape": (9, 1), "spacing": (1.0, 0.0)}
# Kernels that compute powers, and those with the oscillators of a bath, in the loop of verlet.
OF_LEDGERS = {"set_contact_powers", "set_drive_powers", "field_powers"}
OF_BATHS = {"rotate_oscillators", "oscillator_energy", "oscillator_momentum"}


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


def kernels_of(scene: tribo.Scene) -> set[str]:
    """The names of all kernels that the machine code of a scene's time loop is made of."""
    layout, method = lay_out(scene), METHODS["verlet"]
    loop = GeneralLoop(layout, method, 1.0, layout.start, 0.0)
    # Not from the disk cache, which keeps machine code alone.
    loop.compiled = numba.njit(**LOOP)(method.loop)
    loop.advance(np.ones(1), loop.room(1), 0)
    (result,) = loop.compiled.overloads.values()
    linked = [each for each in result.library._linking_libraries if hasattr(each, "_called")]
    return {library.name for each in linked for library in each._called()}


@pytest.mark.skipif(not NATIVE, reason="numba links kernels in its own way")
def test_no_code_of_an_absent_bath_or_ledger():
    """Each of two loops has the kernels of what its scene calls for, and none of the other's."""
    bath = kernels_of(replace(rows(bath=tribo.Bath([0.1], [2.0])), output=NO_LEDGER))
    ledger = kernels_of(rows())
    assert "place_block" in bath & ledger
    assert bath >= OF_BATHS and not OF_LEDGERS & bath
    assert ledger >= OF_LEDGERS and not OF_BATHS & ledger


@shared_kernel
def all_contact(model, neighbours):
    """The contact forces of a scene."""
    contact_forces(model, neighbours)


class Ripple(NamedTuple):
    """A formula that is computed one pair after another."""

    a: float

    def energy(self, r):
        """A ripple."""
        return self.a * np.sin(r) / r


def code_of(potential) -> tuple[str, dict[str, int]]:
    """The code of the contact loop, and how many of its instructions work on vectors or numbers."""
    model = own_model(lay_out(rows(potential)))[0]
    all_contact(model, None)
    kinds = numba.typeof(model), numba.typeof(None)
    found = re.findall(
        r"^\s+v?(?:mul|add|sub|div|sqrt)([ps])d\b", all_contact.inspect_asm(kinds), re.M
    )
    return all_contact.inspect_llvm(kinds), {kind: found.count(kind) for kind in "ps"}


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


def test_other_formulas_are_computed_one_pair_after_another():
    """With a sine there are calls for single pairs, and more scalar arithmetic than in lanes."""
    code, instructions = code_of(as_potential(Ripple(0.1)))
    assert re.search(r"call double @(llvm\.)?sin", code)
    if platform.machine() == "x86_64":
        assert instructions["s"] > code_of(tribo.Coulomb(0.1))[1]["s"]
