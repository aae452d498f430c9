"""Run random scenes whose features are crossed, and judge each by something independent.

    python benchmarks/crossed_scenes.py --seeds 0:2000 --json crossed.jsonl
    python benchmarks/crossed_scenes.py --seeds 0:200 --kinds box,tips --checks state,depinning
    python benchmarks/crossed_scenes.py --show 17

Each seed is a scene of one of seventeen kinds (their time loops are compiled once; numbers, drives
and starts are random) that goes through a few of these checks:

- state: runs in two pieces, with another drive, ramp, stage, load, field or order of surfaces, from
  pickled, copied and loaded states, against a solution from what the first run recorded;
- sweep, ensemble, starts, settings: every point and member against a scene that is built for it
  alone, and one of them against the second solution; drawn starts by their mean energies;
- potentials: sums, scaled copies, cutoffs, tables, expressions, users' classes and charges against
  formulae in numpy;
- averages, depinning, files, copies, subclass: against the recorded series, bit for bit where
  nothing may change;
- noise: kinetic and configurational temperatures, momentum balance, and half the step, in runs,
  ensembles and sweeps of the temperature, for the step that tribo chooses; what is off by more than
  1 % and its interval is run again for longer.

The second solution (tests/support/mixed/solver.py) shares no code with the package: equations and
potentials are written out again in numpy and integrated by scipy.

Verdicts: right; noted (wrong, and a note of the run says that numbers may be off); refused (a
sentence); stopped (a named status); slow (the second solution gives up); silent (wrong without a
word); crash (any other exception).  It prints every silent one and every crash, and the totals; the
exit status is 1 if there are any.  `--json` writes a line for each seed and continues a file.
"""

import argparse
import json
import sys
import time
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

# Verdicts that must not occur.
FAILURES = ("silent", "crash")


def main() -> int:
    """Judge the seeds that the file lacks, and print what failed and the totals."""
    from support.mixed.comparison import VERDICTS
    from support.mixed.judge import CHECKS, KINDS, judged

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", default="0:2000", help="first:last, the last excluded")
    parser.add_argument("--kinds", default=",".join(KINDS), help="kinds of scenes, with commas")
    parser.add_argument("--checks", default=",".join(CHECKS), help="checks, with commas")
    parser.add_argument("--json", type=Path, help="a file that gets a line for each seed")
    parser.add_argument("--show", type=int, help="print the scene of a seed and what it shows")
    options = parser.parse_args()
    kinds, checks = options.kinds.split(","), options.checks.split(",")
    if options.show is not None:
        show(options.show, kinds, checks)
        return 0
    first, last = map(int, options.seeds.split(":"))
    rows = rows_of(options.json)
    known = {row["seed"] for row in rows}
    for seed in (seed for seed in range(first, last) if seed not in known):
        began = time.perf_counter()
        row = judged(seed, kinds, checks).as_table() | {"seconds": time.perf_counter() - began}
        rows.append(row)
        if options.json:
            with options.json.open("a", encoding="utf-8") as file:
                file.write(json.dumps(row) + "\n")
        for verdict, check, text in row["found"]:
            if verdict in FAILURES:
                print(f"{verdict} {seed} ({row['kind']}) {check}: {text}", flush=True)
    rows = [row for row in rows if first <= row["seed"] < last]
    counts = Counter(row["verdict"] for row in rows)
    print(f"{len(rows)} scenes, {sum(len(row['checks']) for row in rows)} comparisons")
    for verdict in VERDICTS:
        print(f"{counts[verdict]:6} {verdict}")
    return int(any(counts[verdict] for verdict in FAILURES))


def rows_of(path: Path | None) -> list[dict]:
    """The lines of a file of verdicts."""
    if path is None or not path.exists():
        return []
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def show(seed: int, kinds: list[str], checks: list[str]) -> None:
    """Print the scene of a seed as a file, and what its checks found."""
    from support.mixed.draw import STRUCTURES, drawn
    from support.mixed.judge import judged, kind_of
    from tribo.model.scene_file import scene_from

    kind = kind_of(seed, kinds)
    if kind in STRUCTURES:
        scene = drawn(seed, kind)
        print(f"# {kind}, method {scene.structure.method}")
        print(scene_from(scene.copy()).to_toml())
    findings = judged(seed, kinds, checks)
    print(f"{findings.verdict}; checks: {'; '.join(findings.checks)}")
    for verdict, check, text in findings.found:
        print(f"{verdict} {check}: {text}")


if __name__ == "__main__":
    sys.exit(main())
