"""The commands, and the functions that run them."""

from __future__ import annotations

import argparse
import json
import sys
import tomllib
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tribo.doctor import add_doctor
from tribo.files import checked_target
from tribo.interrupts import STOPPED, answer, report_by
from tribo.starters.command_line import add_new
from tribo.validation import InputError, TriboWarning, must_be

if TYPE_CHECKING:
    from tribo.atlas import Row
    from tribo.model.scene import Scene

# The exit status of a run that completed, or of a check that passed.
COMPLETED = 0


def run_command(arguments: list[str] | None) -> int:
    """Run the command that the arguments name; return the exit status."""
    options = _parser().parse_args(arguments)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", TriboWarning)  # commands print what it would say
        status: int = options.command(options)
    return status


def _parser() -> argparse.ArgumentParser:
    from tribo import __version__

    parser = argparse.ArgumentParser(
        prog="tribo", description="Simulate sliding friction of asperites, with work accounting."
    )
    parser.add_argument("--version", action="version", version=f"tribo {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    _add_run(commands.add_parser("run", help="simulate a scene file and print its end state"))
    _add_ensemble(commands.add_parser("ensemble", help="run a scene from many starts"))
    _add_paper(commands.add_parser("paper", help="compare the paper's cases with its numbers"))
    _add_explain(commands.add_parser("explain", help="say what a run will do and cost"))
    _add_accuracy(commands.add_parser("accuracy", help="measure error against time per method"))
    _add_check(commands.add_parser("check", help="test a potential and print a report card"))
    _add_atlas(commands.add_parser("atlas", help="run hard scenes and compare with references"))
    _add_view(commands.add_parser("view", help="write a page that plays a run in a browser"))
    _add_plot(commands.add_parser("plot", help="draw the file of a run in one figure"))
    add_new(commands.add_parser("new", help="print or write a commented scene file to start from"))
    add_doctor(commands.add_parser("doctor", help="print versions, cores, cache and speed"))
    return parser


def _add_run(run: argparse.ArgumentParser) -> None:
    _add_scene(run)
    run.add_argument(
        "--out",
        type=Path,
        metavar="FILE",
        help="write all time series as NetCDF; FILE.part keeps what is reached while the run goes "
        "on, and if it is interrupted",
    )
    run.add_argument(
        "--resume",
        action="store_true",
        help="continue FILE.part, to the same bits as without the pause; print the result if FILE "
        "is complete",
    )
    run.add_argument("--json", action="store_true", help="print only the end state, as JSON")
    run.set_defaults(command=_run)


def _add_ensemble(ensemble: argparse.ArgumentParser) -> None:
    _add_scene(ensemble)
    ensemble.add_argument(
        "--vary",
        action="append",
        default=[],
        metavar="KEY=DISTRIBUTION",
        help="what differs between members, as 'upper.theta=normal(0,0.1)' or "
        "'interaction.strength=uniform(0.1,0.2)'; may be repeated",
    )
    ensemble.add_argument("-n", type=int, required=True, help="number of members")
    ensemble.add_argument(
        "--keep",
        metavar="NAMES",
        help="quantities at the end, with commas, as upper.w1,contact_energy (default: means of "
        "all, over time)",
    )
    ensemble.add_argument("--seed", type=int, default=0, help="of the ensemble (default: 0)")
    ensemble.add_argument("--out", type=Path, metavar="FILE", help="write all members as NetCDF")
    ensemble.set_defaults(command=_ensemble)


def _add_scene(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "scene",
        type=Path,
        metavar="SCENE.toml",
        help="the scene file; if it names a plug-in, the code of that runs too",
    )
    command.add_argument(
        "--no-plugins", action="store_true", help="refuse a scene file that names code"
    )


def _add_paper(paper: argparse.ArgumentParser) -> None:
    paper.add_argument("case", nargs="?", choices=list("ABCDE"), help="one case (default: all)")
    paper.add_argument("--json", action="store_true", help="print the comparison as JSON")
    paper.add_argument("--figures", type=Path, metavar="DIR", help="draw the paper's figures")
    paper.set_defaults(command=_paper)


def _add_explain(explain: argparse.ArgumentParser) -> None:
    _add_scene(explain)
    explain.add_argument("--json", action="store_true", help="print the explanation as JSON")
    explain.set_defaults(command=_explain)


def _add_accuracy(accuracy: argparse.ArgumentParser) -> None:
    _add_scene(accuracy)
    accuracy.add_argument("--json", action="store_true", help="print the rows as JSON")
    accuracy.add_argument(
        "--figure", type=Path, metavar="FILE", help="draw error against time and evaluations"
    )
    accuracy.add_argument("--methods", nargs="+", metavar="NAME", help="methods (default: all)")
    accuracy.add_argument(
        "--observables",
        nargs="+",
        metavar="NAME",
        help='observables whose errors count, as "upper.W" (default: all)',
    )
    accuracy.add_argument(
        "--seconds", type=float, default=30.0, help="time for all runs together (default: 30)"
    )
    accuracy.set_defaults(command=_accuracy)


def _add_view(view: argparse.ArgumentParser) -> None:
    view.add_argument(
        "scene",
        type=Path,
        metavar="SCENE.toml|FILE.nc",
        help="a scene file, which is run, or the file of a run",
    )
    view.add_argument(
        "-o", "--out", type=Path, required=True, metavar="PAGE.html", help="the page to write"
    )
    view.add_argument(
        "--no-plugins", action="store_true", help="refuse a scene file that names code"
    )
    view.set_defaults(command=_view)


def _add_plot(plot: argparse.ArgumentParser) -> None:
    plot.add_argument("file", type=Path, metavar="FILE.nc", help="the file of a run")
    plot.add_argument(
        "-o", "--out", type=Path, metavar="FIGURE", help="the figure to write (default: FILE.png)"
    )
    plot.set_defaults(command=_plot)


def _add_check(check: argparse.ArgumentParser) -> None:
    check.add_argument(
        "potential",
        metavar="POTENTIAL",
        help="name of a built-in potential, file.py:Class, or an expression in r",
    )
    check.add_argument(
        "parameters",
        nargs="*",
        metavar="NAME=VALUE",
        help="parameters, and cutoff, at_cutoff and switch_from as in [interaction]",
    )
    check.add_argument("--json", action="store_true", help="print the report card as JSON")
    check.add_argument(
        "--figure",
        type=Path,
        metavar="FILE",
        help="draw energy, force and the difference between force and derivative",
    )
    check.set_defaults(command=_check)


def _add_atlas(atlas: argparse.ArgumentParser) -> None:
    atlas.add_argument("names", nargs="*", metavar="NAME", help="scenes (default: all)")
    atlas.add_argument("--json", action="store_true", help="print the table as JSON")
    atlas.set_defaults(command=_atlas)


def _run(options: argparse.Namespace) -> int:
    from tribo.simulation import simulate

    if options.resume and options.out is None:
        raise InputError("--resume", "needs --out FILE")
    if options.out is not None:
        checked_target("--out", options.out)
    scene = _scene(options)
    with _ProgressBar(scene.duration) as progress:
        result = simulate(scene, progress=progress, out=options.out, resume=options.resume)
    print(result.to_json() if options.json else result)
    return COMPLETED if result.status == "completed" else STOPPED


def _ensemble(options: argparse.Namespace) -> int:
    from tribo.ensembles import ensemble
    from tribo.ensembles.command_line import summary, summary_of_means, varied
    from tribo.files import replace_file

    if options.out is not None:
        checked_target("--out", options.out)
    vary = dict(varied(text) for text in options.vary)
    keep = None if options.keep is None else options.keep.split(",")
    scene = _scene(options)
    with _ProgressBar(options.n, "members") as progress:
        data = ensemble(scene, options.n, vary, options.seed, keep=keep, progress=progress)
    if options.out is not None:
        replace_file(options.out, bytes(data.to_netcdf(engine="h5netcdf")))
    print(summary_of_means(data) if keep is None else summary(data, keep))
    return COMPLETED if data.attrs["status"] == "completed" else STOPPED


def _scene(options: argparse.Namespace) -> Scene:
    """The scene in the file, whose code is refused if that is wanted."""
    from tribo.model.scene_file import load_scene
    from tribo.plugins.unloaded import Code, code

    with code(Code.REFUSE if options.no_plugins else Code.LOAD):
        return load_scene(options.scene)


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


def _explain(options: argparse.Namespace) -> int:
    from tribo.explanation import explain

    explanation = explain(_scene(options))
    print(explanation.to_json() if options.json else explanation)
    return COMPLETED


def _view(options: argparse.Namespace) -> int:
    from tribo.run.result import load_result
    from tribo.simulation import simulate

    checked_target("--out", options.out)
    if options.scene.suffix == ".toml":
        scene = _scene(options)
        with _ProgressBar(scene.duration) as progress:
            result = simulate(scene, progress=progress)
    else:
        result = load_result(options.scene)
    print(result.to_html(options.out))
    return COMPLETED if result.status == "completed" else STOPPED


def _plot(options: argparse.Namespace) -> int:
    from tribo import plotting
    from tribo.run.result import load_result

    path = plotting.figure_path("--out", options.out or options.file.with_suffix(".png"))
    checked_target("--out", path)
    print(plotting.save(plotting.overview(load_result(options.file)), path))
    return COMPLETED


def _accuracy(options: argparse.Namespace) -> int:
    from tribo.work_precision import work_precision

    scene = _scene(options)
    _check_figure(options.figure)
    report = (lambda name: print(name, file=sys.stderr)) if sys.stderr.isatty() else None
    diagram = work_precision(
        scene, options.methods, options.observables or (), options.seconds, progress=report
    )
    if options.figure is not None:
        diagram.save_figure(options.figure)
    print(diagram.to_json() if options.json else diagram)
    if not diagram.rows:
        print("tribo: no run ended in time; give more --seconds", file=sys.stderr)
        return STOPPED
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
    return COMPLETED if report.passed else STOPPED


def _atlas(options: argparse.Namespace) -> int:
    from tribo import atlas

    entries = atlas.chosen(options.names)
    # With --json, the lines show the progress on a terminal.
    lines = sys.stderr if options.json else sys.stdout
    shown = not options.json or lines.isatty()
    rows: list[atlas.Row] = []

    def report() -> None:
        """Print what was reached where an interrupt ends the program."""
        print(f"tribo: interrupted after {len(rows)} of {len(entries)} scenes", file=sys.stderr)
        _print_atlas(options, rows, len(entries))

    report_by(report)
    if shown:
        print(atlas.HEAD, file=lines, flush=True)
    try:
        for row in map(atlas.row, entries):
            rows.append(row)
            if shown:
                print(row, file=lines, flush=True)
    except KeyboardInterrupt:
        answer()
        report()
        return STOPPED
    return _print_atlas(options, rows, len(entries))


def _print_atlas(options: argparse.Namespace, rows: list[Row], count: int) -> int:
    """Print the rows of `count` scenes, or how many ended as declared; the exit status."""
    from tribo import atlas
    from tribo.run.result import without_nan

    declared = sum(row.as_declared for row in rows)
    if options.json:
        print(json.dumps(without_nan(atlas.table(rows)), indent=1, allow_nan=False), flush=True)
    else:
        print(f"{declared} of {count} scenes as declared", flush=True)
    return COMPLETED if declared == count else STOPPED


def _check_figure(path: Path | None) -> None:
    """Raise InputError before the work for a figure that could not be written."""
    if path is not None:
        from tribo.plotting.style import figure_path

        checked_target("--figure", figure_path("--figure", path))


def _parameter(text: str) -> tuple[str, object]:
    """A name and its value: a number, else a value of TOML, else a word."""
    name, sign, value = text.partition("=")
    if not sign:
        raise must_be("parameter", "NAME=VALUE", text)
    try:
        return name, float(value)
    except ValueError:
        pass
    try:
        return name, tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        return name, value


class _ProgressBar:
    """A progress bar on a terminal, and no output elsewhere."""

    def __init__(self, duration: float, unit: str = "t") -> None:
        self.duration = duration
        self._unit = unit
        self._bar: Any = None

    def __enter__(self) -> _ProgressBar:
        return self

    def __call__(self, t: float) -> None:
        if self._bar is None:
            from tqdm import tqdm

            self._bar = tqdm(total=self.duration, disable=None, leave=False, unit=self._unit)
        self._bar.n = t
        self._bar.refresh()

    def __exit__(self, *error: object) -> None:
        if self._bar is not None:
            self._bar.close()
