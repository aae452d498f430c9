"""Change the physics and the integrators, and say which changes no check catches.

    python -m tools.mutation                    # a sample, in a minute or two
    python -m tools.mutation --all [FILE ...]   # every mutant of these files, or of all: hours
    python -m tools.mutation --check slid       # the checks with this word, without a mutant

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

PATTERNS = (
    *("integrators/*.py", "pair/forces.py", "pair/loop.py", "pair/step.py", "pair/step_sums.py"),
    *(f"kernels/{name}.py" for name in ("accounts", "baths", "blocks", "cells", "contact")),
    *(f"kernels/{name}.py" for name in ("encounters", "equations_of_motion", "fields")),
    *(f"kernels/{name}.py" for name in ("kinematics", "langevin", "levers", "neighbours")),
    *(f"kernels/{name}.py" for name in ("powers", "samples", "speeds", "springs", "user_forces")),
    "model/fields.py",
    *(f"layout/{name}.py" for name in ("contacts", "layout", "scene_records", "span", "start")),
    *("layout/tables.py", "ledger/accounts.py", "ledger/ledger.py", "ledger/motion.py"),
    "ledger/totals.py",
)
# Coefficients have tests of their own.  The files of `lanes` are not here, since they need the
# compiler; tests/ensembles/test_lanes.py compares them with single runs.
WITHOUT = ("__init__", "tableaux")
# Part of all mutants that the sample has; it depends on the text of the changes alone.
SAMPLE = 0.003


def files() -> list[str]:
    """The files that are changed, below the package."""
    found = [path for pattern in PATTERNS for path in sorted(SOURCE.glob(pattern))]
    return [p.relative_to(SOURCE).as_posix() for p in found if not p.stem.endswith(WITHOUT)]


def candidates(file: str) -> list[Mutant]:
    """The mutants of a file that can be run uncompiled."""
    return [mutant for mutant in mutants(file) if mutant.function not in NEEDS_COMPILER]


def sampled(file: str, part: float) -> list[Mutant]:
    """A part of them, without equivalents, which cost all checks."""
    return [m for m in candidates(file) if m.draw <= part and str(m) not in EQUIVALENT]


def stale() -> Iterator[str]:
    """Entries of the tables that a change of the source has left behind."""
    every = [mutant for file in files() for mutant in mutants(file)]
    yield from sorted(set(EQUIVALENT) - {str(mutant) for mutant in every})
    yield from sorted(NEEDS_COMPILER.keys() - {mutant.function for mutant in every})


def missed(pool: ProcessPoolExecutor, chosen: list[Mutant], without: frozenset[str]) -> set[str]:
    """The mutants that no check catches, of all checks but some."""
    verdicts = {
        str(m): pool.submit(judge.verdict, m.file, m.function, m.source(), without) for m in chosen
    }
    return {text for text, verdict in verdicts.items() if not verdict.result()}


def check(word: str) -> int:
    """Run the checks whose names contain a word on the sources as they are; 1 if one complains."""
    judge.uncompiled()
    chosen = {name: each for name, each in judge.CHECKS.items() if word in name}
    said = {name: each() for name, each in chosen.items()}
    for name, problem in said.items():
        print(f"{name}: {problem or 'passes'}")
    if not chosen:
        print(f'no check has "{word}" in its name; there are:', *judge.CHECKS, sep="\n    ")
    return 1 if any(said.values()) or not chosen else 0


def main() -> int:
    """Judge the mutants that the command line names; 1 if the result is not as expected."""
    parser = argparse.ArgumentParser("python -m tools.mutation", description=__doc__)
    parser.add_argument("files", nargs="*", metavar="FILE", help="below src/tribo; default: all")
    parser.add_argument("--all", action="store_true", help="all mutants, not a sample")
    parser.add_argument("--sample", type=float, default=SAMPLE, help=f"default: {SAMPLE}")
    parser.add_argument("--check", metavar="WORD", help="run the checks whose names contain it")
    parser.add_argument("-j", type=int, default=1, help="processes (default: 1)")
    given = parser.parse_args()
    if given.check:
        return check(given.check)
    wrong = [f"the tables name no mutant or function: {text}" for text in stale()]
    # More than the usual sample needs all checks.
    few = not given.all and given.sample <= SAMPLE
    without = frozenset(judge.LONG if few else ())
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(given.j, mp_context=context, initializer=judge.uncompiled) as pool:
        if given.all:
            wrong += pool.submit(judge.complaints).result()
        for file in given.files or files():
            known = {str(m) for m in candidates(file)} & EQUIVALENT.keys() if given.all else set()
            chosen = candidates(file) if given.all else sampled(file, given.sample)
            left = missed(pool, chosen, without)
            print(f"{file}: {len(chosen)} mutants, {len(left - known)} missed", flush=True)
            wrong += [f"missed: {text}" for text in sorted(left - known)]
            wrong += [f"caught, but in a table: {text}" for text in sorted(known - left)]
    print(*wrong, sep="\n", end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
