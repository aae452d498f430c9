"""The commands: their options, and what each prints."""

from __future__ import annotations

import argparse
import sys
import warnings
from pathlib import Path

from tribo.commands.bundle import add_bundle
from tribo.commands.doctor import run_doctor
from tribo.commands.help import FIRST_STEPS, CommandParser, add_completion
from tribo.commands.new import add_new
from tribo.commands.run import add_run
from tribo.commands.scene_options import (
    add_figure,
    add_json,
    add_many_runs,
    add_scene,
    add_set,
    check_figure,
    load_with_values,
    parsed,
    split,
)
from tribo.commands.view import add_play, add_view
from tribo.files import checked_target, strict_json
from tribo.interrupts import COMPLETED, STOPPED
from tribo.validation import TriboWarning


def run_command(arguments: list[str] | None) -> int:
    """Run the command that the arguments name; return the exit status."""
    options = _parser().parse_args(arguments)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", TriboWarning)  # commands print what it would say
        status: int = options.command(options)
    return status


def _parser() -> argparse.ArgumentParser:
    from tribo import __version__

    parser = CommandParser(
        prog="tribo",
        description="Simulate sliding friction of asperites, with work accounting.",
        epilog=FIRST_STEPS,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"tribo {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    def command(name: str, purpose: str) -> argparse.ArgumentParser:
        sentence = f"{purpose[0].upper()}{purpose[1:]}."
        return commands.add_parser(name, help=purpose, description=sentence)

    add_run(command("run", "simulate a scene file, or repeat the run of a file"))
    _add_sweep(command("sweep", "run a scene with every combination of values"))
    _add_ensemble(command("ensemble", "run a scene from many starts"))
    _add_paper(command("paper", "compare the paper's cases with its numbers"))
    _add_explain(command("explain", "say what a run will do and cost"))
    _add_accuracy(command("accuracy", "measure the error of each method against its time"))
    _add_check(command("check", "check a potential and print a report card"))
    _add_atlas(command("atlas", "run hard scenes and compare with references"))
    add_view(command("view", "write a page that plays runs in a browser"))
    add_play(command("play", "change values of a scene in a browser and simulate it again"))
    _add_plot(command("plot", "draw the file of a run in one figure"))
    _add_export_lammps(command("export-lammps", "write a scene as input files of LAMMPS"))
    add_bundle(command("bundle", "pack scenes and results in one archive with checksums"))
    add_new(command("new", "print or write a commented scene file to start from"))
    doctor = command("doctor", "print versions, cores, cache and speed")
    doctor.set_defaults(command=run_doctor)
    completion = command("completion", "print a script that completes commands")
    add_completion(completion, parser, commands.choices.values())
    return parser


def _add_sweep(sweep: argparse.ArgumentParser) -> None:
    add_scene(sweep)
    sweep.add_argument(
        "--set",
        action="append",
        required=True,
        metavar="KEY=VALUES",
        help="values separated by commas, as 'upper.drive.load=0.1,0.2,0.4'; if repeated, every "
        "combination is run",
    )
    add_many_runs(sweep, "number of runs at each point (default: one run of the scene itself)")
    add_figure(sweep, "draw the first quantity against the first key of --set")
    sweep.set_defaults(command=_sweep)


def _add_ensemble(ensemble: argparse.ArgumentParser) -> None:
    add_scene(ensemble)
    add_set(ensemble)
    add_many_runs(ensemble, "number of members; with grids, by default that of their points")
    add_figure(
        ensemble, "draw a histogram of the first name of --keep at the end (default: upper.W)"
    )
    ensemble.set_defaults(command=_ensemble)


def _add_paper(paper: argparse.ArgumentParser) -> None:
    cases = "case of the paper (default: all)"
    paper.add_argument("case", nargs="?", choices=list("ABCDE"), help=cases)
    add_json(paper, "the comparison")
    figures = "write the paper's figures to this folder"
    paper.add_argument("--figures", type=Path, metavar="DIR", help=figures)
    paper.set_defaults(command=_paper)


def _add_explain(explain: argparse.ArgumentParser) -> None:
    add_scene(explain)
    add_set(explain)
    add_json(explain, "the explanation")
    explain.set_defaults(command=_explain)


def _add_accuracy(accuracy: argparse.ArgumentParser) -> None:
    add_scene(accuracy)
    add_set(accuracy)
    add_json(accuracy, "the rows")
    add_figure(accuracy, "write a figure of error against time and evaluations")
    methods = "methods to compare (default: all)"
    accuracy.add_argument("--methods", nargs="+", metavar="NAME", help=methods)
    observables = 'observables whose errors count, as "upper.W" (default: all)'
    accuracy.add_argument("--observables", nargs="+", metavar="NAME", help=observables)
    seconds = "limit of the time of all runs together (default: 30)"
    accuracy.add_argument("--seconds", type=float, default=30.0, help=seconds)
    accuracy.set_defaults(command=_accuracy)


def _add_plot(plot: argparse.ArgumentParser) -> None:
    plot.add_argument("file", type=Path, metavar="FILE.nc", help="the file of a run")
    figure = "the figure to write (default: FILE.png)"
    plot.add_argument("-o", "--out", type=Path, metavar="FIGURE", help=figure)
    plot.set_defaults(command=_plot)


def _add_check(check: argparse.ArgumentParser) -> None:
    potential = "name of a built-in potential, file.py:Class, or an expression in r"
    check.add_argument("potential", metavar="POTENTIAL", help=potential)
    parameters = "parameters, and cutoff, at_cutoff and switch_from as in [interaction]"
    check.add_argument("parameters", nargs="*", metavar="NAME=VALUE", help=parameters)
    add_json(check, "the report card")
    add_figure(check, "write a figure of energy, force, and the error of the force")
    check.set_defaults(command=_check)


def _add_atlas(atlas: argparse.ArgumentParser) -> None:
    scenes = "scenes of the atlas (default: all)"
    atlas.add_argument("names", nargs="*", metavar="NAME", help=scenes)
    add_json(atlas, "the table")
    atlas.set_defaults(command=_atlas)


def _add_export_lammps(export: argparse.ArgumentParser) -> None:
    add_scene(export)
    add_set(export)
    folder = "the folder to write to"
    export.add_argument("-o", "--out", type=Path, required=True, metavar="DIR", help=folder)
    export.set_defaults(command=_export_lammps)


def _sweep(options: argparse.Namespace) -> int:
    from tribo.commands.sweep import run_sweep

    return run_sweep(options)


def _ensemble(options: argparse.Namespace) -> int:
    from tribo.commands.ensemble import run_ensemble

    return run_ensemble(options)


def _paper(options: argparse.Namespace) -> int:
    from tribo import paper

    cases = [options.case] if options.case else list(paper.CASES)
    tables = paper.compare(cases)
    if options.figures is not None:
        from tribo.paper import figures as paper_figures

        for path in paper_figures.draw(options.figures, cases):
            print(path, file=sys.stderr)
    if options.json:
        rows = {case: [row.as_json() for row in table] for case, table in tables.items()}
        print(strict_json(rows))
    else:
        print(paper.report(tables))
    return COMPLETED


def _explain(options: argparse.Namespace) -> int:
    from tribo.explanation import explain

    explanation = explain(load_with_values(options))
    print(explanation.to_json() if options.json else explanation)
    return COMPLETED


def _plot(options: argparse.Namespace) -> int:
    from tribo.plotting.style import figure_path, save
    from tribo.result import load_result

    path = figure_path("--out", options.out or options.file.with_suffix(".png"))
    checked_target("--out", path)
    print(save(load_result(options.file).plot.overview(), path))
    return COMPLETED


def _export_lammps(options: argparse.Namespace) -> int:
    from tribo.export.lammps import to_lammps

    files = to_lammps(load_with_values(options), options.out)
    print(files.data, files.forces, files.run, sep="\n")
    for text in files.omitted:
        print(f"omitted: {text}")
    return COMPLETED


def _accuracy(options: argparse.Namespace) -> int:
    from tribo.commands.accuracy import run_accuracy

    return run_accuracy(options)


def _check(options: argparse.Namespace) -> int:
    from tribo.potentials.tables import from_table
    from tribo.report_card import check

    check_figure(options.figure)
    pairs = (split("parameter", text) for text in options.parameters)
    table = {"potential": options.potential} | {name: parsed(value) for name, value in pairs}
    report = check(from_table(table, Path.cwd()))
    if options.figure is not None:
        report.save_figure(options.figure)
    print(report.to_json() if options.json else report)
    return COMPLETED if report.passed else STOPPED


def _atlas(options: argparse.Namespace) -> int:
    from tribo.commands.atlas import run_atlas

    return run_atlas(options)
