"""What a potential of one's own costs: the same Lennard-Jones in five ways, against the built-in.

A copy of the built-in in a user's file, the same without its force (which is then taken from the
energy's source), the same with an energy that is no formula (for the complex step), and an
expression.  Two rows of 64 bobs slide over one another without a cutoff, so
that nearly all of the time goes into 4096 pairs.  Runs are interleaved, and the shortest of each
counts.  The loop that a process has first is several per cent faster than the same when it comes
later, so that place goes to one that is not counted; a second copy of the plug-in shows what a
ratio is good for.  Prints nanoseconds per pair and step, and their ratio.

    python benchmarks/plugins.py [--json] [--rounds 20]
"""

import argparse
import inspect
import json
import tempfile
from pathlib import Path

import tribo
from tribo.potentials import expression, lennard_jones, named

BOBS = 64
STEP = 0.01
STEPS = 500
COMPLEX_STEP = """
        s6 = 1.0
        for _ in range(6):
            s6 = s6 * (self.sigma / r)
        return 4.0 * self.epsilon * s6 * (s6 - 1.0)
"""
PARAMETERS = {"epsilon": 0.05, "sigma": 1.0}


def scene(potential: object) -> tribo.Scene:
    """Two rows that pass over one another."""
    row = {"shape": (BOBS, 1), "spacing": (1.5, 0.0), "asperite": tribo.Asperite(kappa=20.0)}
    upper = tribo.Surface("upper", bob=(0.3, 1.2), velocity=(0.5, 0.0), **row)
    lower = tribo.Surface("lower", facing="up", **row)
    output = tribo.Output(samples=2)
    return tribo.Scene((upper, lower), potential, STEPS * STEP, output=output)


def versions(folder: Path) -> dict[str, object]:
    """The potential in each of the ways that it can be had."""
    source = inspect.getsource(lennard_jones)
    for name in ("first", "copied", "again"):
        (folder / f"{name}.py").write_text(source)
    (folder / "energy_alone.py").write_text(source.partition("    def force")[0])
    looped = source.partition("        s6 =")[0] + COMPLEX_STEP
    (folder / "looped.py").write_text(looped)
    return {
        "first": named(f"{folder}/first.py:LennardJones", **PARAMETERS),
        "built-in": tribo.LennardJones(**PARAMETERS),
        "plug-in": named(f"{folder}/copied.py:LennardJones", **PARAMETERS),
        "plug-in again": named(f"{folder}/again.py:LennardJones", **PARAMETERS),
        "energy alone": named(f"{folder}/energy_alone.py:LennardJones", **PARAMETERS),
        "complex step": named(f"{folder}/looped.py:LennardJones", **PARAMETERS),
        "expression": expression("4*epsilon*((sigma/r)**12 - (sigma/r)**6)", **PARAMETERS),
    }


def measure(rounds: int) -> list[dict[str, object]]:
    """Every version's time, and that it ends where the built-in does."""
    with tempfile.TemporaryDirectory() as folder:
        prepared = {
            name: tribo.prepare(scene(potential), method="verlet", step=STEP)
            for name, potential in versions(Path(folder)).items()
        }
        seconds = dict.fromkeys(prepared, float("inf"))
        ends = {}
        for _ in range(rounds):
            for name, simulation in prepared.items():
                result = simulation.run()
                seconds[name] = min(seconds[name], result.cost.wall_seconds)
                ends[name] = float(result["upper"].theta[-1, 0])
    return [
        {
            "version": name,
            "nanoseconds": 1e9 * taken / STEPS / BOBS**2,
            "ratio": taken / seconds["built-in"],
            "difference": abs(ends[name] - ends["built-in"]),
        }
        for name, taken in seconds.items()
        if name != "first"
    ]


def main() -> None:
    """Measure all versions in one process."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--rounds", type=int, default=20)
    options = parser.parse_args()
    rows = measure(options.rounds)
    if options.json:
        print(json.dumps(rows, indent=1))
        return
    for row in rows:
        print(
            f"{row['version']:>14} {row['nanoseconds']:7.2f} ns a pair and step "
            f"({row['ratio']:.3f} of the built-in), ends within {row['difference']:.0e}"
        )


if __name__ == "__main__":
    main()
