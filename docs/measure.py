"""The measured tables of the pages: true errors and their estimates, hard scenes, a first program.

    python docs/measure.py [TABLE ...]

What accuracy costs is measured by measure_accuracy.py.
Each function measures one table and its name is that of the file in docs/measured.  Errors are
the largest over all reported quantities and recorded times, relative to the scale of their kind.
Where the documents say "independent", the other solution is that of tests/support/reference.py: the
equations written a second time in C, in long double or quadruple precision.
"""

import os
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

import tribo
from tribo import paper
from tribo.accuracy import scales as accuracy
from tribo.accuracy.comparison import distance

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "tests"))
sys.dont_write_bytecode = True

from support import reference  # noqa: E402

FEW = tribo.Output(samples=9)  # so that steps are not cut short by samples


def error(result: tribo.Result, truth: tribo.Result) -> float:
    """The largest difference of two results, each in units of its kind's scale."""
    layout = tribo.prepare(truth.scene, method="verlet", step=1.0).layout
    scales = accuracy.reported_scales(layout, truth.ledger)
    return distance(result.ledger, truth.ledger, scales)


def case(letter: str) -> tribo.Scene:
    """A case of the paper, recorded at a few times."""
    return replace(paper.scene(letter), output=FEW)


def hard_scenes() -> dict[str, tribo.Scene]:
    """Scenes that are rougher than the paper's."""
    soft = tribo.Asperite(kappa=0.5)
    row = {"shape": (5, 1), "spacing": (1.1, 0.0)}
    upper = tribo.Surface("upper", bob=(-6.0, 0.9), velocity=(0.8, 0.0), asperite=soft, **row)
    lower = tribo.Surface("lower", facing="up", asperite=soft, **row)
    jones = tribo.LennardJones(0.3, 1.0).with_cutoff(2.5)
    one = {"asperite": tribo.Asperite(charge=1.0)}
    left = tribo.Surface("upper", bob=(-4.0, 0.6), velocity=(0.6, 0.0), bars="free", **one)
    right = tribo.Surface("lower", facing="up", **one)
    rows = (
        replace(upper, drive=tribo.Free(rigid=True)),
        replace(lower, springs=tribo.Springs(4.0)),
    )
    return {
        "two rows of five, Lennard-Jones with a switch, soft": tribo.Scene(
            (upper, lower), jones, 12.0, output=FEW
        ),
        "the same, one a free block, one with springs": tribo.Scene(rows, jones, 12.0, output=FEW),
        "a short Morse bond, bars that rotate freely": tribo.Scene(
            (left, right), tribo.Morse(0.5, 5.0, 0.5), 16.0, output=FEW
        ),
    }


def estimates() -> Iterator[list[str]]:
    """Error estimates beside true errors, by the independent solution."""
    yield ["scene", "requested accuracy", "met", "estimates that hold", "largest error / estimate"]
    groups = {"the paper's five cases": [paper.scene(c) for c in "ABCDE"]}
    groups |= {name: [scene] for name, scene in hard_scenes().items()}
    for name, scenes in groups.items():
        truths = [reference.solve(tomllib.loads(scene.to_toml())) for scene in scenes]
        for wanted in (1e-4, 1e-7, 1e-10):
            runs = [tribo.simulate(scene, accuracy=wanted) for scene in scenes]
            ratios = [r for pair in zip(runs, truths, strict=True) for r in judged(*pair)]
            met = "yes" if all(run.met for run in runs) else "no"
            holding = f"{sum(r <= 1.0 for r in ratios)} of {len(ratios)}"
            yield [name, f"{wanted:.0e}", met, holding, f"{max(ratios):.2g}"]


def judged(result: tribo.Result, truth: reference.Solution) -> Iterator[float]:
    """Error at the end over its estimate, quantity by quantity of every surface.

    The error of the other solution and round-off are subtracted from the error: where one value is
    exactly zero and the other is not, no estimate could hold.
    """
    for part in ("surfaces", "blocks"):
        for name, table in truth.end[part].items():
            for key, values in table.items():
                scale = truth.scales[accuracy.kind_of(key)]
                doubt = 4.0 * accuracy.EPSILON * max(scale, np.max(np.abs(values)))
                off = np.max(np.abs(np.subtract(result.end[part][name][key], values)))
                bound = result.error_estimate[key] or 0.0
                beyond = max(0.0, float(off - doubt - truth.error[key]))
                yield beyond / (bound + np.finfo(float).tiny)


def closure() -> Iterator[list[str]]:
    """The residuals of the ledger beside its true errors."""
    yield ["case", "method", "step", "w - w_ps - delta_e_int", "w_ps - delta_k_trans", "true error"]
    for letter in "AC":
        truth = tribo.simulate(case(letter), accuracy=1e-12)
        for method, step in (
            ("midpoint", 0.05),
            ("verlet", 0.1),
            ("verlet", 0.01),
            ("kahan-li-6", 0.1),
        ):
            run = tribo.simulate(case(letter), method=method, step=step)
            upper = run["upper"]
            first = np.max(np.abs(upper.w - upper.w_ps - upper.delta_e_int))
            second = np.max(np.abs(upper.w_ps - upper.delta_k_trans))
            wrong = max(
                float(np.max(np.abs(upper[name] - truth["upper"][name])))
                for name in ("w1", "w2", "w", "w_ps", "delta_e_int")
            )
            numbers = (f"{x:.0e}" for x in (first, second, wrong))
            yield [letter, f"`{method}`", str(step), *numbers]


def frames() -> Iterator[list[str]]:
    """The same physics far away and in a fast frame."""
    yield [
        "case C",
        "delta_e_int",
        "change at any time",
        "w1_ps",
        "deviation from the boost's formula",
    ]
    still = tribo.simulate(case("C"), accuracy=1e-10)
    for name, place, speed in (
        ("as in the paper", 0.0, 0.0),
        ("shifted by 1e6", 1e6, 0.0),
        ("shifted by 1e12", 1e12, 0.0),
        ("boosted by 1e6", 0.0, 1e6),
    ):
        surfaces = tuple(
            replace(
                s,
                bob=(s.bob[0] + place, s.bob[1]),
                velocity=(s.velocity[0] + speed, s.velocity[1]),
            )
            for s in case("C").surfaces
        )
        run = tribo.simulate(replace(case("C"), surfaces=surfaces), accuracy=1e-10)
        old, new = still["upper"], run["upper"]
        change = np.max(np.abs(new.delta_e_int - old.delta_e_int))
        impulse = 12.0 * (old.vx_cm - old.vx_cm[0])
        boosted = old.w1_ps + speed * impulse
        off = np.max(np.abs(new.w1_ps - boosted)) / np.max(np.abs(boosted))
        energy = f"{new.delta_e_int[-1, 0]:.12f}"
        yield [name, energy, f"{change:.0e}", f"{new.w1_ps[-1, 0]:.7g}", f"{off:.0e}"]


def cutoffs() -> Iterator[list[str]]:
    """Errors of a method of order 6 with each kind of cutoff, for several steps."""
    steps = (0.04, 0.02, 0.01, 0.005)
    yield ["at_cutoff", *(f"step {h:g}" for h in steps)]
    surfaces = tuple(
        replace(surface, asperite=tribo.Asperite(kappa=20.0))
        for surface in hard_scenes()["a short Morse bond, bars that rotate freely"].surfaces
    )
    for kind in ("truncate", "shift", "force-shift", "switch"):
        options = {"switch_from": 0.9} if kind == "switch" else {}
        potential = tribo.LennardJones(0.05, 1.0).with_cutoff(1.6, kind, **options)
        scene = tribo.Scene(surfaces, potential, 12.0, output=tribo.Output(samples=2))
        truth = tribo.simulate(scene, accuracy=1e-11)
        runs = (tribo.simulate(scene, method="kahan-li-6", step=h) for h in steps)
        yield [f'`"{kind}"`', *(f"{error(run, truth):.0e}" for run in runs)]


def outcomes() -> Iterator[list[str]]:
    """Hard scenes, and how their runs end."""
    yield ["scene", "settings", "status", "accuracy met", "largest error estimate / scale"]
    b = paper.scene("B")
    upper, lower = b.surfaces
    fast = replace(upper, bob=(-3.0, 0.0), velocity=(10.0, 0.0))
    beside = (fast, replace(lower, bob=(0.0, -0.1)))
    short = replace(b, surfaces=beside, interactions=tribo.Morse(0.5, 40.0, 0.05), duration=1.0)
    rows = replace(next(iter(hard_scenes().values())), duration=30.0)
    for name, scene, how in (
        ("case B, where the bobs' lines are 0.3 apart", b, {"accuracy": 1e-8}),
        ("the same with lines 0.0 apart", _apart(b, 0.0), {"accuracy": 1e-8}),
        ("the same with lines that overlap by 0.0096", _apart(b, -0.0096), {"accuracy": 1e-8}),
        ("the same", _apart(b, -0.0096), {"accuracy": 1e-6}),
        ("both bobs at one place", _together(b), {"accuracy": 1e-8}),
        ("a Morse bond of width 1/40 passed at speed 10", short, {"accuracy": 1e-8}),
        ("the same", short, {"method": "midpoint", "step": 0.05}),
        ("two rows of five, Lennard-Jones with a switch", rows, {"accuracy": 1e-8}),
        ("the same", rows, {"accuracy": 1e-11}),
    ):
        result = tribo.simulate(scene, **how)
        met = {True: "yes", False: "no", None: ""}[result.met]
        if result.status == "BobsCoincide":
            met, worst = "", ""
        else:
            worst = _worst(result)
        yield [name, _said(how), f"`{result.status}`", met, worst]


def _apart(scene: tribo.Scene, gap: float) -> tribo.Scene:
    """The scene with another distance between the lines of the resting bobs."""
    upper, lower = scene.surfaces
    return replace(scene, surfaces=(upper, replace(lower, bob=(lower.bob[0], -gap))))


def _together(scene: tribo.Scene) -> tribo.Scene:
    upper, lower = scene.surfaces
    return replace(scene, surfaces=(upper, replace(lower, bob=upper.bob)))


def _said(how: dict) -> str:
    return ", ".join(f"{key} {value}" for key, value in how.items())


def _worst(result: tribo.Result) -> str:
    """The largest error estimate in units of its scale."""
    layout = tribo.prepare(result.scene, method="verlet", step=1.0).layout
    scales = accuracy.reported_scales(layout, result.ledger)
    worst = [
        bar / scales.of(name)
        for name, bar in result.error_estimate.items()
        if bar is not None and scales.of(name) > 0.0
    ]
    return f"{max(worst):.0e}" if worst else ""


def _fresh_process(program: str, cache: str) -> float:
    """The seconds that a program prints last."""
    place = os.environ | {"NUMBA_CACHE_DIR": cache}
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=cache,
        env=place,
        capture_output=True,
        text=True,
        check=True,
    )
    return float(done.stdout.split()[-1])


CARD = """
import {how}, sys, time
sys.path.insert(0, "{folder}")
began = time.perf_counter()
{start}
print(time.perf_counter() - began)
"""
STARTS = {
    "in the program that is run": ("runpy", 'runpy.run_path("{path}", run_name="__main__")'),
    "in a module of its own": ("importlib", 'importlib.import_module("postcard").main()'),
}


def postcard() -> Iterator[list[str]]:
    """Seconds from the start of examples/postcard.py to its answer and its report card."""
    path = HERE.parent / "examples" / "postcard.py"
    yield ["the class is", "first process", "later processes"]
    for what, (how, start) in STARTS.items():
        program = CARD.format(how=how, folder=path.parent, start=start.format(path=path))
        with tempfile.TemporaryDirectory() as cache:
            cells = [f"{_fresh_process(program, cache):.2g} s" for _ in range(2)]
        yield [what, *cells]


TABLES: tuple[Callable[[], Iterator[list[str]]], ...] = (
    estimates,
    closure,
    frames,
    cutoffs,
    outcomes,
    postcard,
)


def write(table: Callable[[], Iterator[list[str]]]) -> None:
    """Measure a table, and write it in one piece."""
    head, *rows = table()
    lines = [head, ["---"] * len(head), *rows]
    text = "".join("| " + " | ".join(cells) + " |\n" for cells in lines)
    folder = HERE / "measured"
    folder.mkdir(exist_ok=True)
    with tempfile.NamedTemporaryFile("w", dir=folder, delete=False) as file:
        file.write(text)
    Path(file.name).chmod(0o644)
    Path(file.name).replace(folder / f"{table.__name__}.md")
    print(f"{table.__name__}\n{text}", flush=True)


if __name__ == "__main__":
    wanted = sys.argv[1:] or [table.__name__ for table in TABLES]
    for table in TABLES:
        if table.__name__ in wanted:
            write(table)
