"""The command line: ``tribo run``, ``tribo paper``, ``tribo check``."""

from __future__ import annotations

import argparse
import json
import os
import sys
import tomllib
import warnings
from pathlib import Path
from typing import Any

from tribo.validation import InputError, TriboWarning

COMPLETED, STOPPED, WRONG_INPUT = 0, 1, 2  # exit statuses
FAILED = 1  # of a check


def main(arguments: list[str] | None = None) -> int:
    """Run the command line; returns the exit status."""
    options = _parser().parse_args(arguments)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", TriboWarning)  # commands print what it would say
            status: int = options.command(options)
    except InputError as error:
        print(f"tribo: {error}", file=sys.stderr)
        return WRONG_INPUT
    except MemoryError as error:
        print(f"tribo: not enough memory for this scene ({error})", file=sys.stderr)
        return WRONG_INPUT
    except BrokenPipeError:
        sys.stderr.close()
        return STOPPED
    return status


def _parser() -> argparse.ArgumentParser:
    from tribo import __version__

    parser = argparse.ArgumentParser(
        prog="tribo", description="Sliding friction from the asperite up."
    )
    parser.add_argument("--version", action="version", version=f"tribo {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    run = commands.add_parser("run", help="run a scene file")
    run.add_argument("scene", type=Path, metavar="SCENE.toml")
    run.add_argument("--out", type=Path, metavar="FILE", help="write all series as NetCDF")
    run.add_argument("--json", action="store_true", help="print the end state alone, as JSON")
    run.set_defaults(command=_run)

    paper = commands.add_parser("paper", help="the paper's cases, its numbers beside ours")
    paper.add_argument("case", nargs="?", choices=list("ABCDE"), help="one case; all without")
    paper.add_argument("--json", action="store_true", help="one object a printed number")
    paper.add_argument("--figures", type=Path, metavar="DIR", help="draw the paper's figures")
    paper.set_defaults(command=_paper)

    accuracy = commands.add_parser("accuracy", help="error against time, for every method")
    accuracy.add_argument("scene", type=Path, metavar="SCENE.toml")
    accuracy.add_argument("--json", action="store_true", help="print rows as JSON")
    accuracy.add_argument("--figure", type=Path, metavar="FILE", help="draw both diagrams")
    accuracy.add_argument("--methods", nargs="+", metavar="NAME", help="these alone")
    accuracy.add_argument(
        "--observables", nargs="+", metavar="NAME", help='errors of these alone, as "upper.W"'
    )
    accuracy.add_argument("--seconds", type=float, default=30.0, help="for all runs together")
    accuracy.set_defaults(command=_accuracy)

    check = commands.add_parser("check", help="a report card for a potential")
    check.add_argument("potential", metavar="POTENTIAL", help="its name, or file.py:Class")
    check.add_argument(
        "parameters",
        nargs="*",
        metavar="NAME=VALUE",
        help="parameters, and cutoff, at_cutoff, switch_from, as in [interaction]",
    )
    check.add_argument("--json", action="store_true", help="print the card as JSON")
    check.add_argument(
        "--figure", type=Path, metavar="FILE", help="draw energy, force and their disagreement"
    )
    check.set_defaults(command=_check)
    return parser


def _run(options: argparse.Namespace) -> int:
    from tribo.model.scene_file import load_scene
    from tribo.simulation import simulate

    scene = load_scene(options.scene)
    if options.out is not None:
        _check_place("--out", options.out.absolute())
    with _Bar(scene.duration) as bar:
        result = simulate(scene, progress=bar)
    if options.out is not None:
        result.save(options.out)
    print(result.to_json() if options.json else result)
    return COMPLETED if result.status == "completed" else STOPPED


def _check_place(option: str, path: Path) -> None:
    """Complain before the run, not after it, about a file that could not be written."""
    if not path.parent.is_dir():
        raise InputError(option, f"there is no folder {path.parent}")
    if path.is_dir():
        raise InputError(option, f"is a folder, {path}; give the name of a file")
    if not os.access(path.parent, os.W_OK):
        raise InputError(option, f"nothing can be written in {path.parent}")


def _paper(options: argparse.Namespace) -> int:
    from tribo import paper

    cases = [options.case] if options.case else list(paper.CASES)
    tables = paper.compare(cases)
    if options.figures is not None:
        from tribo.paper import figures as paper_figures

        for path in paper_figures.draw(options.figures, cases):
            print(path, file=sys.stderr)
    if options.json:
        print(
            json.dumps(
                {case: [row.as_json() for row in rows] for case, rows in tables.items()}, indent=1
            )
        )
    else:
        print(paper.report(tables))
    return COMPLETED


def _accuracy(options: argparse.Namespace) -> int:
    from tribo.model.scene_file import load_scene
    from tribo.work_precision import work_precision

    scene = load_scene(options.scene)
    _check_figure(options.figure)
    told = (lambda name: print(name, file=sys.stderr)) if sys.stderr.isatty() else None
    found = work_precision(
        scene, options.methods, options.observables or (), options.seconds, progress=told
    )
    if options.figure is not None:
        found.save_figure(options.figure)
    print(found.to_json() if options.json else found)
    return COMPLETED


def _check(options: argparse.Namespace) -> int:
    from tribo.potentials.tables import from_table
    from tribo.report_card import check

    _check_figure(options.figure)
    table = {"potential": options.potential} | dict(map(_parameter, options.parameters))
    report = check(from_table(table, Path.cwd()))
    if options.figure is not None:
        report.save_figure(options.figure)
    print(report.to_json() if options.json else report)
    return COMPLETED if report.passed else FAILED


def _check_figure(path: Path | None) -> None:
    """Complain about where a figure is to go, before the work for it is done."""
    if path is not None:
        from tribo.plotting.style import figure_path

        _check_place("--figure", figure_path("--figure", path).absolute())


def _parameter(text: str) -> tuple[str, Any]:
    """A name and its value: a number, else what a scene file would take it for, else a word."""
    name, sign, value = text.partition("=")
    if not sign:
        raise InputError(text, "must be name=value")
    try:
        return name, float(value)
    except ValueError:
        pass
    try:
        return name, tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        return name, value


class _Bar:
    """A progress bar on a terminal; nothing anywhere else."""

    def __init__(self, duration: float) -> None:
        self.duration = duration
        self._bar: Any = None

    def __enter__(self) -> _Bar:
        return self

    def __call__(self, t: float) -> None:
        if self._bar is None:
            from tqdm import tqdm

            self._bar = tqdm(total=self.duration, disable=None, leave=False, unit="t")
        self._bar.n = t
        self._bar.refresh()

    def __exit__(self, *error: object) -> None:
        if self._bar is not None:
            self._bar.close()
