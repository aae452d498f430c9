"""Seconds that the first run of a kind of scene compiles, in both ways of using numba.

Every kind runs in a process of its own with an empty cache, and then in another one that finds its
machine code there.  The difference of their times is printed, in seconds of the processor: what
both have to do, such as importing libraries, is not compiled.

    python benchmarks/compiling.py [--json] [--after [--markdown] | --waiting]

--after takes more kinds, in the native way alone, one after another with one cache: what each of
them compiles beyond those before it.  --markdown prints that as in docs/measured/compiling.md.
All these are measured in one process.  --waiting measures the seconds that pass until the first
result, on an empty cache, with one process that compiles and with as many as cores.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

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


def simulated(scene: tribo.Scene, **settings: object) -> Callable[[], object]:
    return partial(tribo.simulate, scene, **settings)


def kinds_one_after_another() -> dict[str, Callable[[], object]]:
    """Runs of scenes, each with something that those before it do not have."""
    verlet = {"method": "verlet", "step": 0.05}
    cut_off = tribo.LennardJones(0.1, 1.0).with_cutoff(2.5)
    field = tribo.Field(tribo.Corrugation(0.1, 1.0), ["upper"])
    pair = replace(paper.scene("A"), duration=1.0)
    scenes = {
        "the first scene, by verlet": rows(3),
        "springs": rows(3, springs=tribo.Springs(1.0)),
        "pulled": rows(3, drive=tribo.Pulled(stiffness=1.0, speed=0.5)),
        "driven bars": rows(3, drive="bars"),
        "no ledger": replace(rows(3), output=tribo.Output(samples=3, ledger="none")),
        "another potential": replace(rows(3), interactions=cut_off),
        "a periodic box": replace(rows(3), interactions=cut_off, periodic=tribo.Periodic(x=9.0)),
        "a field": replace(rows(3), fields=[field]),
        "a reservoir": rows(3, langevin=tribo.Langevin(1.0, 0.1)),
        "a bath": rows(3, bath=tribo.Bath(masses=[1.0], frequencies=[1.0])),
        "lists of neighbours": replace(rows(80), interactions=cut_off),
    }
    runs = {name: simulated(scene, **verlet) for name, scene in scenes.items()}
    swings = {"upper.swing": np.linspace(0.0, 0.1, 64)}
    return runs | {
        "members, by verlet": partial(tribo.ensemble, rows(3), 64, vary=swings, **verlet),
        "the first scene for an accuracy": simulated(rows(3), accuracy=1e-6),
        "members, for an accuracy": partial(
            tribo.ensemble, rows(3), 64, vary=swings, accuracy=1e-6
        ),
        "one asperite on one": simulated(pair, accuracy=1e-8),
        "one on one, another potential": simulated(
            replace(pair, interactions=tribo.Morse(0.1, 1.0, 1.5)), accuracy=1e-8
        ),
    }


def spent(kind: str) -> float:
    """Seconds of the processor that the first run of this process takes."""
    alone = {name: simulated(scene, **settings) for name, (scene, settings) in scenes().items()}
    run = (alone | kinds_one_after_another())[kind]
    began = time.process_time()
    run()
    return time.process_time() - began


def waited(kind: str, processes: str) -> float:
    """Seconds until the first run of a process has ended, with an empty cache."""
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "NUMBA_CACHE_DIR": cache, "TRIBO_THREADS": processes}
        began = time.perf_counter()
        subprocess.run(
            [sys.executable, __file__, "--kind", kind],
            env=environment,
            check=True,
            stdout=subprocess.DEVNULL,
        )
        return time.perf_counter() - began


def measured(kind: str, way: str, cache: str) -> float:
    """By how much that is more where a cache in this folder lacks the kind than where it has it."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": cache, "TRIBO_THREADS": "1"}
    environment.pop("TRIBO_NUMBA", None)
    if way == "plain":
        environment["TRIBO_NUMBA"] = way
    command = [sys.executable, __file__, "--kind", kind]
    compiled, loaded = (
        float(subprocess.check_output(command, env=environment, text=True)) for _ in range(2)
    )
    return compiled - loaded


def alone(kind: str, way: str) -> float:
    """The same with an empty cache."""
    with tempfile.TemporaryDirectory() as cache:
        return measured(kind, way, cache)


def one_after_another() -> dict[str, float]:
    """Seconds of each of the later scenes, which share a cache."""
    with tempfile.TemporaryDirectory() as cache:
        return {kind: measured(kind, "native", cache) for kind in kinds_one_after_another()}


def main() -> None:
    """Measure every kind in both ways."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--kind", help="measure this kind in this process")
    parser.add_argument("--after", action="store_true")
    parser.add_argument("--markdown", action="store_true")
    parser.add_argument("--waiting", action="store_true")
    options = parser.parse_args()
    if options.kind:
        print(spent(options.kind))
        return
    if options.after:
        later = one_after_another()
        if options.json:
            print(json.dumps(later, indent=1))
        elif options.markdown:
            print("| scene | seconds |\n| --- | --- |")
            print("\n".join(f"| {kind} | {max(taken, 0.0):.1f} |" for kind, taken in later.items()))
        else:
            print("\n".join(f"{kind:34} {taken:5.1f} s" for kind, taken in later.items()))
        return
    if options.waiting:
        for kind in scenes():
            one, all_cores = waited(kind, "1"), waited(kind, "")
            print(
                f"{kind:52} one process {one:5.1f} s, as many as cores {all_cores:5.1f} s "
                f"({all_cores / one:.2f})",
                flush=True,
            )
        return
    table: dict[str, dict[str, float]] = {}
    for kind in scenes():
        table[kind] = {way: alone(kind, way) for way in WAYS}
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
