"""The command `tribo run`: a scene file is simulated, and the run of a file repeated."""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from functools import partial
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Any

from tribo.commands import scene_options as shared
from tribo.interrupts import COMPLETED, STOPPED, also_in_part
from tribo.validation import LARGEST_COUNT, InputError, integer

if TYPE_CHECKING:
    from tribo.result import Result

# Options that change a scene or its numerics, which a repeated run takes from its file.
CHANGES = ("set", "accuracy", "method", "step", "allow_unresolved", "samples")


def add_run(run: argparse.ArgumentParser) -> None:
    """Add the arguments and options of `tribo run`."""
    shared.add_scene(run, "SCENE.toml|FILE.nc")
    out = "write all time series as NetCDF; until the run is complete, FILE.part contains its "
    out += "samples; or as a table, if FILE ends on .csv"
    shared.add_files(run, out, "print the result if FILE is complete")
    shared.add_numerics(run)
    run.add_argument("--samples", metavar="N", help="number of evenly spaced times to record")
    threads = "threads that share each step of a large surface; the results do not depend on it "
    threads += "(default: TRIBO_THREADS, or the number of cores)"
    run.add_argument("--threads", metavar="N", help=threads)
    shared.add_output(run, "only the end state", "write a figure of the works on the first surface")
    run.set_defaults(command=_run)


def _run(options: argparse.Namespace) -> int:
    """Run a scene, or repeat the run of a result file; print the end and draw the works."""
    shared.check_files(options, " or .csv")
    shared.check_figure(options.figure)
    if options.scene.suffix == ".nc":
        result, same = _repeated(options)
    else:
        result = _simulated(options)
        same = True
    if shared.is_table(options.out) and result.status == "Interrupted":
        print(f"tribo: {options.out} is not written, as the run was interrupted", file=sys.stderr)
    elif shared.is_table(options.out):
        result.save(options.out)
    print(result.to_json() if options.json else f"{result}\n\n{_next(options, result)}")
    shared.draw_to(options.figure, partial(_draw, result))
    return COMPLETED if result.status == "completed" and same else STOPPED


def _next(options: argparse.Namespace, result: Result) -> str:
    """What one may do after the run, as a line."""
    given = options.scene
    scene = quote(str(given))
    kept = quote(str(options.out or given.with_suffix(".nc")))
    if shared.is_table(options.out):
        return f"Next:  tribo view {scene}   writes a page that plays the run"
    if options.out is not None and result.status == "Interrupted":
        return f"Next:  the same command with --resume   goes on from {kept}.part"
    if options.out is not None or given.suffix == ".nc":
        return f"Next:  tribo view {kept}   writes a page that plays the run"
    if result.status != "completed":
        return f"Next:  tribo explain {scene}   says what the run would take"
    return f"Next:  tribo run {scene} --out {kept}   keeps all series; tribo view {kept} plays them"


def _draw(result: Result, path: Path) -> None:
    """Draw the works on the first surface, or the swings where works are not kept."""
    from tribo.plotting.style import save

    has_works = "W" in result.ledger.blocks[result.scene.surfaces[0].name]
    save(result.plot.work() if has_works else result.plot.angles(), path)


def _simulated(options: argparse.Namespace) -> Result:
    """The result of the scene with the values and settings of the command line."""
    from tribo.simulation import simulate

    settings: dict[str, Any] = shared.numerics_of(options) | _of_run(options)
    scene = shared.load_with_values(options)
    if options.samples is not None:
        count = integer("--samples", shared.parsed(options.samples), 2, LARGEST_COUNT)
        scene = replace(scene, output=replace(scene.output, samples=count, times=None))
    return also_in_part(simulate, scene, **settings)


def _of_run(options: argparse.Namespace) -> dict[str, Any]:
    """The NetCDF file, and the number of threads if it is given.  Raises InputError."""
    given = options.threads
    threads = None if given is None else integer("--threads", shared.parsed(given), 1)
    out = None if shared.is_table(options.out) else options.out
    return {"out": out, "resume": options.resume, "threads": threads}


def _repeated(options: argparse.Namespace) -> tuple[Result, bool]:
    """The result of the run in a file, and whether it has the bits of the file."""
    from tribo.commands.repeat import differences, repeat, sentence
    from tribo.result import load_result

    for name in CHANGES:
        if getattr(options, name):
            option = f"--{name.replace('_', '-')}"
            raise InputError(option, "cannot go with the file of a run; give a scene file")
    before = load_result(options.scene)
    result = also_in_part(repeat, before, not options.no_plugins, **_of_run(options))
    found = differences(before, result)
    print(f"{options.scene}: {sentence(before, result, found)}", file=sys.stderr)
    return result, not found
