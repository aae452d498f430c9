"""The commands: their options and their help, and what each prints."""

import argparse
import re
import sys
import warnings
from collections.abc import Callable, Iterable
from difflib import get_close_matches
from pathlib import Path
from shlex import quote
from typing import NoReturn

from tribo.commands import scene_options as shared
from tribo.commands.accuracy import run_accuracy
from tribo.commands.atlas import run_atlas
from tribo.commands.fit import add_fit, add_sensitivity
from tribo.commands.live import add_live
from tribo.commands.new import add_new
from tribo.commands.paper import add_paper
from tribo.commands.run import add_run
from tribo.commands.sweep import run_sweep
from tribo.commands.view import add_play, add_view
from tribo.files import checked_target
from tribo.interrupts import COMPLETED, STOPPED
from tribo.validation import InputError, TriboWarning

FIRST_STEPS = """\
first steps:
  tribo new -o scene.toml              a commented scene file
  tribo run scene.toml --out run.nc    its end state, and all series in a file
  tribo view run.nc -o run.html        a page that plays the run
  tribo COMMAND --help                 all options of a command
"""

SHELLS = ("bash", "zsh", "tcsh")
# Adds a command by its name, its purpose, and the function that runs it, if that is given.
Add = Callable[..., argparse.ArgumentParser]


class CommandParser(argparse.ArgumentParser):
    """A parser that names the nearest word where it does not know one."""

    def error(self, message: str) -> NoReturn:
        """Print the usage and the message; exit with status 2."""
        if message.endswith("are required: COMMAND"):
            message += "; start with: tribo new -o scene.toml (tribo --help lists all commands)"
        unknown = re.search(r"invalid choice: '(.*?)' \(choose from (.*)\)", message)
        if unknown is not None:
            word = unknown[1]
            known = re.findall(r"[\w-]+", unknown[2])
            near = get_close_matches(word, known, 1)
            if Path(word).suffix in (".toml", ".nc"):
                message = f"{word} is no command; did you mean: {self.prog} run {word}"
            elif near:
                message += f"; did you mean {near[0]}?"
        super().error(message)


def run_command(arguments: list[str] | None) -> int:
    """Run a command.  Raises InputError, which names the option that has the value."""
    options = _parser().parse_args(_with_formulas(sys.argv[1:] if arguments is None else arguments))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", TriboWarning)  # commands print what it would say
        try:
            return options.command(options)
        except InputError as error:
            raise shared.of_option(error, options) from None


def _with_formulas(arguments: list[str]) -> list[str]:
    """The arguments, where a formula of `tribo check` that begins with a minus is no option.

    A blank before it tells the parser so.
    """
    if arguments[:1] != ["check"]:
        return arguments
    return [f" {each}" if re.match(r"-(?!-|h$)", each) else each for each in arguments]


def _parser() -> argparse.ArgumentParser:
    """The parser of the whole command line; each command adds its options and its function."""
    from tribo import __version__

    parser = CommandParser(
        prog="tribo",
        description="Simulate sliding friction of asperites, with work accounting.",
        epilog=FIRST_STEPS,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"tribo {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    def add(
        name: str, purpose: str, run: Callable[[argparse.Namespace], int] | None = None
    ) -> argparse.ArgumentParser:
        sentence = f"{purpose[0].upper()}{purpose[1:]}."
        command = commands.add_parser(name, help=purpose, description=sentence)
        command.set_defaults(command=run)
        return command

    _add_runs(add)
    _add_others(add)
    completion = add("completion", "print a script that completes commands")
    _add_completion(completion, parser, commands.choices.values())
    return parser


def _add_runs(add: Add) -> None:
    """Add the commands that run scenes and tell what runs take."""
    add_run(add("run", "simulate a scene file, or repeat the run of a file"))

    sweep = add("sweep", "run a scene with every combination of values", run_sweep)
    shared.add_scene(sweep, with_set=False)
    values = "values separated by commas, as 'upper.drive.load=0.1,0.2,0.4'; if repeated, every "
    values += "combination is run"
    sweep.add_argument("--set", action="append", required=True, metavar="KEY=VALUES", help=values)
    members = "number of runs at each point (default: one run of the scene itself)"
    shared.add_many_runs(sweep, members)
    shared.add_output(sweep, figure="draw the first quantity against the first key of --set")

    ensemble = add("ensemble", "run a scene from many starts", _ensemble)
    shared.add_scene(ensemble)
    shared.add_many_runs(ensemble, "number of members; with grids, by default that of their points")
    figure = "draw a histogram of the first name of --keep at the end (default: upper.W)"
    shared.add_output(ensemble, figure=figure)

    add_fit(add("fit", "find parameters of a scene from a measured series"))
    purpose = "say which parameters of a scene matter, by derivatives with their errors"
    add_sensitivity(add("sensitivity", purpose))

    add_paper(add("paper", "compare the paper's cases with its numbers"))

    explain = add("explain", "say what a run will do and cost", _explain)
    shared.add_scene(explain)
    shared.add_output(explain, "the explanation")

    accuracy = add("accuracy", "measure the error of each method against its time", run_accuracy)
    shared.add_scene(accuracy)
    figure = "write a figure of error against time and evaluations"
    shared.add_output(accuracy, "the rows", figure)
    methods = "methods to compare (default: all)"
    accuracy.add_argument("--methods", nargs="+", metavar="NAME", help=methods)
    observables = 'observables whose errors count, as "upper.W" (default: all)'
    accuracy.add_argument("--observables", nargs="+", metavar="NAME", help=observables)
    seconds = "limit of the time of all runs together (default: 30)"
    accuracy.add_argument("--seconds", type=float, default=30.0, help=seconds)


def _add_others(add: Add) -> None:
    """Add the commands for potentials, hard scenes, pages, figures and files."""
    check = add("check", "check a potential and print a report card", _check)
    potential = "name of a built-in potential, file.py:Class, or an expression in r"
    check.add_argument("potential", metavar="POTENTIAL", help=potential)
    parameters = "parameters, and cutoff, at_cutoff and switch_from as in [interaction]"
    check.add_argument("parameters", nargs="*", metavar="NAME=VALUE", help=parameters)
    figure = "write a figure of energy, force, and the error of the force"
    shared.add_output(check, "the report card", figure)

    atlas = add("atlas", "run hard scenes and compare with references", run_atlas)
    scenes = "scenes of the atlas (default: all)"
    atlas.add_argument("names", nargs="*", metavar="NAME", help=scenes)
    shared.add_output(atlas, "the table")

    add_view(add("view", "write a page that plays runs in a browser"))
    add_live(add("live", "write a page that simulates a scene in the browser itself"))
    add_play(add("play", "change values of a scene in a browser and simulate it again"))

    plot = add("plot", "draw the file of a run in one figure", _plot)
    plot.add_argument("file", type=Path, metavar="FILE.nc", help="the file of a run")
    figure = "the figure to write (default: FILE.png)"
    plot.add_argument("-o", "--out", type=Path, metavar="FIGURE", help=figure)

    lammps = add("export-lammps", "write a scene as input files of LAMMPS", _export_lammps)
    shared.add_scene(lammps)
    folder = "the folder to write to"
    lammps.add_argument("-o", "--out", type=Path, required=True, metavar="DIR", help=folder)

    bundle = add("bundle", "pack scenes and results in one archive with checksums", _bundle)
    files = "a scene file, whose plug-ins and data are added, a result, or any other file"
    bundle.add_argument("files", nargs="+", type=Path, metavar="FILE", help=files)
    archive = "the archive to write"
    bundle.add_argument(
        "-o", "--out", type=Path, required=True, metavar="ARCHIVE.zip", help=archive
    )
    add_new(add("new", "print or write a commented scene file to start from"))
    doctor = add("doctor", "print versions, cores, cache and speed", _doctor)
    compiling = "compile all common kinds of scenes now, which takes one to three minutes"
    doctor.add_argument("--compile", action="store_true", help=compiling)


def _add_completion(
    completion: argparse.ArgumentParser,
    parser: argparse.ArgumentParser,
    commands: Iterable[argparse.ArgumentParser],
) -> None:
    """Let a command print the script for a shell, which shtab makes from all other parsers."""

    def print_script(options: argparse.Namespace) -> int:
        """Print the script, in which arguments that are paths complete to names of files."""
        import shtab

        for command in commands:
            for action in command._actions:
                if action.type is Path:  # completes names of files
                    action.complete = shtab.FILE  # type: ignore[attr-defined]
        print(shtab.complete(parser, options.shell))
        return 0

    completion.add_argument("shell", choices=SHELLS, help="the shell that reads the script")
    completion.set_defaults(command=print_script)


def _ensemble(options: argparse.Namespace) -> int:
    from tribo.commands.ensemble import run_ensemble

    return run_ensemble(options)


def _bundle(options: argparse.Namespace) -> int:
    from tribo.commands.bundle import run_bundle

    return run_bundle(options)


def _doctor(options: argparse.Namespace) -> int:
    from tribo.commands.doctor import run_doctor

    return run_doctor(options)


def _explain(options: argparse.Namespace) -> int:
    """Print the explanation of a scene, and the command that simulates it."""
    from tribo.explanation import explain

    explanation = explain(shared.load_with_values(options))
    if options.json:
        print(explanation.to_json())
    else:
        scene = options.scene
        kept = options.scene.with_suffix(".nc")
        print(f"{explanation}\n")
        print(f"Next:  tribo run {quote(str(scene))} --out {quote(str(kept))}   simulates it")
    return COMPLETED


def _plot(options: argparse.Namespace) -> int:
    """`tribo plot`: draw the overview of a result file."""
    from tribo.plotting.style import figure_path, save
    from tribo.result import load_result

    path = figure_path("--out", options.out or options.file.with_suffix(".png"))
    checked_target("--out", path)
    result = load_result(options.file)
    shared.draw_to(path, lambda target: print(save(result.plot.overview(), target)), "--out")
    return COMPLETED


def _export_lammps(options: argparse.Namespace) -> int:
    from tribo.export.lammps import to_lammps

    files = to_lammps(shared.load_with_values(options), options.out)
    print(files.data, files.forces, files.run, sep="\n")
    for text in files.omitted:
        print(f"omitted: {text}")
    return COMPLETED


def _check(options: argparse.Namespace) -> int:
    """Print the report card of a potential with parameters; the status tells if it passed."""
    from tribo.potentials.tables import from_table
    from tribo.report_card import check

    shared.check_figure(options.figure)
    pairs = shared.by_key("parameter", options.parameters).items()
    named = {"potential": options.potential.strip()}
    table = named | {name: shared.parsed(value) for name, value in pairs}
    report = check(from_table(table, Path.cwd()))
    print(report.to_json() if options.json else report)
    shared.draw_to(options.figure, report.save_figure)
    return COMPLETED if report.passed else STOPPED
