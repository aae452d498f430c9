"""Seconds that the first run of a kind of scene compiles, in both ways of using numba.

Every kind runs in a process of its own with an empty cache.  The time is that of the first run less
that of a second one, in seconds of the processor.

    python benchmarks/compiling.py [--json]
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import replace

import tribo
from tribo import paper

WAYS = ("native", "plain")


def rows(count: int, **settings: object) -> tribo.Scene:
    """Two rows of so many asperites; the settings are those of the upper one."""
    row = {"shape": (count, 1), "spacing": (1.1, 0.0)}
    upper = tribo.Surface("upper", bob=(0.0, 1.2), velocity=(0.5, 0.0), **row, **settings)
    lower = tribo.Surface("lower", facing="up", **row)
    potential = tribo.Morse(0.1, 3.0, 1.0)
    return tribo.Scene((upper, lower), potential, 0.1, output=tribo.Output(samples=3))


def scenes() -> dict[str, tuple[tribo.Scene, dict]]:
    """A scene of each kind, and the settings of its run."""
    verlet = {"method": "verlet", "step": 0.05}
    noise = {
        "langevin": tribo.Langevin(1.0, 0.1),
        "bath": tribo.Bath(masses=[1.0], frequencies=[1.0]),
        "springs": tribo.Springs(1.0),
    }
    short = replace(paper.scene("A"), duration=1.0)
    return {
        "one asperite on one, for an accuracy": (short, {"accuracy": 1e-8}),
        "three on three, verlet": (rows(3), verlet),
        "three on three, for an accuracy": (rows(3), {"accuracy": 1e-6}),
        "three on three with bath, springs and noise, verlet": (rows(3, **noise), verlet),
    }


def compiling(kind: str) -> float:
    """Seconds of the processor by which the first run of this process exceeds the second."""
    scene, settings = scenes()[kind]
    taken = []
    for _ in range(2):
        began = time.process_time()
        tribo.simulate(scene, **settings)
        taken.append(time.process_time() - began)
    return taken[0] - taken[1]


def measured(kind: str, way: str) -> float:
    """The same in a new process with an empty cache."""
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "NUMBA_CACHE_DIR": cache}
        environment.pop("TRIBO_NUMBA", None)
        if way == "plain":
            environment["TRIBO_NUMBA"] = way
        command = [sys.executable, __file__, "--kind", kind]
        return float(subprocess.check_output(command, env=environment, text=True))


def main() -> None:
    """Measure every kind in both ways."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--kind", help="measure this kind in this process")
    options = parser.parse_args()
    if options.kind:
        print(compiling(options.kind))
        return
    table = {}
    for kind in scenes():
        table[kind] = {way: measured(kind, way) for way in WAYS}
        if not options.json:
            native, plain = table[kind].values()
            ratio = plain / native
            print(
                f"{kind:52} native {native:5.1f} s, plain {plain:5.1f} s ({ratio:.2f})", flush=True
            )
    if options.json:
        print(json.dumps(table, indent=1))


if __name__ == "__main__":
    main()
