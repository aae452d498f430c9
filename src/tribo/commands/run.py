"""The command `tribo run`: a scene file is simulated, and the run of a file repeated."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from tribo.commands.scene_options import (
    add_figure,
    add_files,
    add_json,
    add_numerics,
    add_scene,
    add_set,
    check_figure,
    check_files,
    load_with_values,
    numerics_of,
    parsed,
    with_samples,
)
from tribo.interrupts import COMPLETED, STOPPED, also_in_part
from tribo.validation import InputError, integer

if TYPE_CHECKING:
    from tribo.result import Result

# Options that change a scene or its numerics, which a repeated run takes from its file.
CHANGES = ("set", "accuracy", "method", "step", "allow_unresolved", "samples")


def add_run(run: argparse.ArgumentParser) -> None:
    """Add the arguments of `tribo run`."""
    add_scene(run, "SCENE.toml|FILE.nc")
    out = (
        "write all time series as NetCDF; until the run is complete, FILE.part contains its samples"
    )
    add_files(run, out, "print the result if FILE is complete")
    add_json(run, "only the end state")
    add_numerics(run)
    run.add_argument("--samples", metavar="N", help="number of evenly spaced times to record")
    run.add_argument(
        "--threads",
        metavar="N",
        help="threads that share each step of a large surface; the results do not depend on it "
        "(default: TRIBO_THREADS, or the number of cores)",
    )
    add_set(run)
    add_figure(run, "write a figure of the works on the first surface")
    run.set_defaults(command=_run)


def _run(options: argparse.Namespace) -> int:
    check_files(options)
    check_figure(options.figure)
    if options.scene.suffix == ".nc":
        result, same = _repeated(options)
    else:
        result, same = _simulated(options), True
    if options.figure is not None:
        _draw(result, options.figure)
    print(result.to_json() if options.json else result)
    return COMPLETED if result.status == "completed" and same else STOPPED


def _simulated(options: argparse.Namespace) -> Result:
    """The result of a scene file."""
    from tribo.simulation import simulate

    threads, settings = _threads(options), numerics_of(options)
    scene = with_samples(load_with_values(options), options.samples)
    files = {"out": options.out, "resume": options.resume}
    return also_in_part(simulate, scene, **settings, **files, threads=threads)


def _threads(options: argparse.Namespace) -> int | None:
    """The number of threads, if it is given.  Raises InputError."""
    if options.threads is None:
        return None
    return integer("--threads", parsed(options.threads), 1)


def _repeated(options: argparse.Namespace) -> tuple[Result, bool]:
    """The result of the run in a file, and whether it has the bits of the file."""
    from tribo.commands.repeat import differences, repeat, sentence
    from tribo.result import load_result

    for name in CHANGES:
        if getattr(options, name):
            option = f"--{name.replace('_', '-')}"
            raise InputError(option, "cannot go with the file of a run; give a scene file")
    before = load_result(options.scene)
    result = also_in_part(
        repeat,
        before,
        not options.no_plugins,
        out=options.out,
        resume=options.resume,
        threads=_threads(options),
    )
    found = differences(before, result)
    print(f"{options.scene}: {sentence(before, result, found)}", file=sys.stderr)
    return result, not found


def _draw(result: Result, path: Path) -> None:
    """Draw the works on the first surface, or the swings where works are not kept."""
    from tribo.plotting.style import save

    has_works = "W" in result.ledger.blocks[result.scene.surfaces[0].name]
    save(result.plot.work() if has_works else result.plot.angles(), path)
