"""Wrong equations do not pass: mutants of the physics and of the integrators are caught.

A mutant is the package with one small change in one function, made in the syntax tree:
support/mutants.py.  The checks that catch it compare runs with independent solutions, and run
uncompiled: support/judge.py.  The default set is a sample; the slow set has all mutants.
"""

import multiprocessing
from concurrent.futures import ProcessPoolExecutor

import pytest

from support import judge
from support.mutants import mutants
from support.package import SOURCE
from support.survivors import EQUIVALENT, NEEDS_COMPILER

PATTERNS = [
    "integrators/*.py",
    "kernels/baths.py",
    "kernels/blocks.py",
    "kernels/cells.py",
    "kernels/contact.py",
    "kernels/encounters.py",
    "kernels/equations_of_motion.py",
    "kernels/fields.py",
    "kernels/kinematics.py",
    "kernels/langevin.py",
    "kernels/levers.py",
    "kernels/neighbours.py",
    "kernels/powers.py",
    "kernels/samples.py",
    "kernels/springs.py",
    "kernels/user_forces.py",
    "model/fields.py",
    "pair/forces.py",
    "pair/loop.py",
    "pair/step.py",
    "pair/step_sums.py",
    "ledger/accounts.py",
    "layout/span.py",
    "layout/contacts.py",
    "layout/layout.py",
    "ledger/ledger.py",
    "layout/tables.py",
    "ledger/motion.py",
    "layout/scene_records.py",
    "layout/start.py",
    "ledger/totals.py",
]
FILES = [
    path.relative_to(SOURCE).as_posix()
    for pattern in PATTERNS
    for path in sorted(SOURCE.glob(pattern))
    # Coefficients have tests of their own; members side by side need the compiler, and are tested
    # against single runs in tests/ensembles/test_lanes.py.
    if not path.stem.endswith(("__init__", "tableaux", "_members"))
]
# Part of all mutants that the default set has.
SAMPLE = 0.003


def candidates(file):
    """The mutants of a file that can be run uncompiled."""
    return [mutant for mutant in mutants(file) if mutant.function not in NEEDS_COMPILER]


def sampled():
    """The sample without equivalents: these cost all checks, and are in the slow set only."""
    for file in FILES:
        for mutant in candidates(file):
            if mutant.draw <= SAMPLE and str(mutant) not in EQUIVALENT:
                yield mutant


@pytest.fixture(scope="module")
def worker():
    """A process in which nothing is compiled."""
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=context, initializer=judge.uncompiled) as pool:
        yield pool


def caught(worker, mutant, without=frozenset()):
    """What the first check says that finds the mutant, of all but some; empty if none does."""
    arguments = mutant.file, mutant.function, mutant.source(), frozenset(without)
    return worker.submit(judge.verdict, *arguments).result()


def test_sampled_mutants_are_caught(worker):
    """In one test: every process that judges mutants first runs its checks without one."""
    missed = [str(mutant) for mutant in sampled() if not caught(worker, mutant, judge.LONG)]
    assert missed == []


@pytest.mark.slow
def test_the_package_itself_passes(worker):
    """No check complains about the equations as they are, nor about the cost of a run."""
    assert worker.submit(judge.complaints).result() == []


@pytest.mark.slow
@pytest.mark.parametrize("file", FILES)
def test_all_mutants_are_caught(worker, file):
    """The mutants that are left are those of the tables."""
    left = {str(mutant) for mutant in candidates(file) if not caught(worker, mutant)}
    known = {text for text in EQUIVALENT if text.startswith(f"{file}: ")}
    assert left == known


def test_tables_name_mutants():
    """No entry of a table has been left behind by a change of the source."""
    texts = {str(mutant) for file in FILES for mutant in mutants(file)}
    assert set(EQUIVALENT) <= texts
    functions = {mutant.function for file in FILES for mutant in mutants(file)}
    assert NEEDS_COMPILER.keys() <= functions
