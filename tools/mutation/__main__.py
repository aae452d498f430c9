"""Change the physics and the integrators, and say which changes no test catches.

    python -m tools.mutation                    # a sample, in a few minutes
    python -m tools.mutation --all [FILE ...]   # every mutant of these files, or of all: hours

Ends with status 1 if a mutant is missed, or if a table of `survivors` is not what was found.
"""

import argparse
import multiprocessing
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor

from tools.mutation import judge
from tools.mutation.mutants import Mutant, mutants
from tools.mutation.survivors import EQUIVALENT, NEEDS_COMPILER

from support.package import SOURCE

# Files that are changed, by folder.  The files of `lanes` are not here, since they need the
# compiler; tests/ensembles/test_lanes.py compares them with single runs.
FILES = {
    "integrators": "*",
    "pair": "forces loop step step_sums",
    "kernels": "accounts baths cells contact encounters equations_of_motion fields "
    "kinematics langevin levers neighbours packs powers samples speeds springs user_forces",
    "model": "fields",
    "layout": "contacts layout scene_records span start tables",
    "ledger": "accounts ledger motion totals",
}
WITHOUT = ("__init__", "tableaux")  # coefficients have tests of their own
# Part of all mutants that the sample has; it depends on the text of the changes alone.
SAMPLE = 0.003


def files() -> list[str]:
    """The files that are changed, below the package."""
    names = [(folder, name) for folder, names in FILES.items() for name in names.split()]
    found = [path for folder, name in names for path in sorted(SOURCE.glob(f"{folder}/{name}.py"))]
    return [p.relative_to(SOURCE).as_posix() for p in found if p.stem not in WITHOUT]


def candidates(file: str) -> list[Mutant]:
    """The mutants of a file that can be run uncompiled."""
    return [mutant for mutant in mutants(file) if mutant.function not in NEEDS_COMPILER]


def sampled(file: str) -> list[Mutant]:
    """A part of them, without equivalents, which cost all tests."""
    return [m for m in candidates(file) if m.draw <= SAMPLE and str(m) not in EQUIVALENT]


def stale() -> Iterator[str]:
    """Entries of the tables that a change of the source has left behind."""
    every = [mutant for file in files() for mutant in mutants(file)]
    yield from sorted(set(EQUIVALENT) - {str(mutant) for mutant in every})
    yield from sorted(NEEDS_COMPILER.keys() - {mutant.function for mutant in every})


def missed(pool: ProcessPoolExecutor, chosen: list[Mutant], marks: str) -> set[str]:
    """The mutants that no test with some marks catches."""
    verdicts = {
        str(m): pool.submit(judge.verdict, m.file, m.function, m.source(), marks) for m in chosen
    }
    return {text for text, verdict in verdicts.items() if not verdict.result()}


def main() -> int:
    """Judge the mutants that the command line names; 1 if the result is not as expected."""
    parser = argparse.ArgumentParser("python -m tools.mutation", description=__doc__)
    parser.add_argument("files", nargs="*", metavar="FILE", help="below src/tribo; default: all")
    parser.add_argument("--all", action="store_true", help="all mutants, not a sample")
    parser.add_argument("-j", type=int, default=1, help="processes (default: 1)")
    given = parser.parse_args()
    wrong = [f"the tables name no mutant or function: {text}" for text in stale()]
    marks = "" if given.all else "not thorough"
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(given.j, mp_context=context, initializer=judge.uncompiled) as pool:
        if given.all:
            wrong += pool.submit(judge.failing_costs).result()
        for file in given.files or files():
            known = {str(m) for m in candidates(file)} & EQUIVALENT.keys() if given.all else set()
            chosen = candidates(file) if given.all else sampled(file)
            left = missed(pool, chosen, marks)
            print(f"{file}: {len(chosen)} mutants, {len(left - known)} missed", flush=True)
            wrong += [f"missed: {text}" for text in sorted(left - known)]
            wrong += [f"caught, but in a table: {text}" for text in sorted(known - left)]
    print(*wrong, sep="\n", end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
