"""Measure the cost of user-defined potentials against the built-in Lennard-Jones.

The versions are a copy of the built-in in a user's file; the copy without its force, which is then
derived from the source of the energy; the copy with a loop in its energy, which is differentiated
by a complex step; and an expression.  Two rows of 64 bobs slide over one another without a cutoff,
so that nearly all of the time is that of 4096 pairs.

Runs are interleaved, and the shortest run of each version counts.  The first loop of a process is
several per cent faster than the same loop later, so a version that is not counted comes first.  A
second copy of the plug-in shows the error of the ratios.  It prints nanoseconds per pair and step,
and their ratio to the built-in's.

    python benchmarks/plugins.py [--json] [--rounds 20]
"""

import argparse
import inspect
import json
import tempfile
from pathlib import Path

import tribo
from tribo.potentials import LennardJones, expression, named

# Bobs of each row.
BOBS = 64

# Step of Verlet [time], and number of steps.
STEP = 0.01
STEPS = 500

# Body of an energy with a loop.
COMPLEX_STEP = """
        s6 = 1.0
        for _ in range(6):
            s6 = s6 * (self.sigma / r)
        return 4.0 * self.epsilon * s6 * (s6 - 1.0)
"""
PARAMETERS = {"epsilon": 0.05, "sigma": 1.0}


def scene(potential: object) -> tribo.Scene:
    """Two rows that slide over one another."""
    row = {"shape": (BOBS, 1), "spacing": (1.5, 0.0), "asperite": tribo.Asperite(kappa=20.0)}
    upper = tribo.Surface("upper", bob=(0.3, 1.2), velocity=(0.5, 0.0), **row)
    lower = tribo.Surface("lower", facing="up", **row)
    output = tribo.Output(samples=2)
    return tribo.Scene((upper, lower), potential, STEPS * STEP, output=output)


def versions(folder: Path) -> dict[str, object]:
    """The same potential in every version, by name."""
    source = f"from tribo import Potential\n\n\n{inspect.getsource(LennardJones)}"
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
    """Measure the time of every version, and the difference of its end from the built-in's."""
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
