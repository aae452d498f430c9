"""The options that commands share: a scene file, and values that replace those of the file."""

from __future__ import annotations

import argparse
import math
import os
import sys
import tomllib
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tribo.files import PART, checked_target, netcdf_target, read_file
from tribo.interrupts import part_is_kept_in
from tribo.validation import InputError, must_be

if TYPE_CHECKING:
    from tribo.model.scene import Scene


# Characters of an error of matplotlib that a message quotes: LaTeX's have hundreds of lines.
MOST_OF_ERROR = 200
# Of the parsed command line, what is given without the name of an option.
ARGUMENTS = {
    *("command", "scene", "trace", "case", "potential", "parameters"),
    *("names", "beside", "file", "files", "kind", "shell"),
}
# What the pages of each command contain, and others do not.
PAGES = {"live": '<main id="live">', "view": '<main id="player">'}
# The ending of names of tables as text.
CSV = ".csv"
# How problems of an argument begin that is not given.
MISSING = ("is missing", "is empty")
# Of an option that may be given several times.
REPEATED: dict[str, Any] = {"action": "append", "default": []}


def add_output(
    command: argparse.ArgumentParser, json: str | None = None, figure: str | None = None
) -> None:
    """Add the output as JSON, of what `json` names, and the file of a figure."""
    if json is not None:
        command.add_argument("--json", action="store_true", help=f"print {json} as JSON")
    if figure is not None:
        command.add_argument("--figure", type=Path, metavar="FILE", help=figure)


def add_files(command: argparse.ArgumentParser, out: str, otherwise: str) -> None:
    """Add the file that a computation writes, and whether it continues."""
    resume = f"continue from FILE.part, with the same bits as without a stop; {otherwise}"
    command.add_argument("--out", type=Path, metavar="FILE", help=out)
    command.add_argument("--resume", action="store_true", help=resume)


def check_files(options: argparse.Namespace, others: str = "") -> None:
    """Raise InputError where --out cannot be written, or --resume has nothing to continue.

    `others` names the other endings of files that the command writes, as " or .csv".
    """
    if options.resume and options.out is None:
        raise InputError("--resume", "needs --out FILE")
    if others and is_table(options.out):
        checked_target("--out", options.out)
        if options.resume:
            raise InputError("--resume", f"needs a file that ends on .nc, got {options.out}")
    elif options.out is not None:
        netcdf_target("--out", options.out, others)
        part_is_kept_in(f"{options.out}{PART}")


def is_table(out: Path | None) -> bool:
    """Whether a file to write is a table as text, which contains nothing before the end."""
    return out is not None and out.suffix.lower() == CSV


def add_scene(
    command: argparse.ArgumentParser, files: str = "SCENE.toml", with_set: bool = True
) -> None:
    """Add the scene file, the refusal of code that it names, and values that replace its own."""
    meaning = "the file; code of a plug-in that it names is executed"
    command.add_argument("scene", type=Path, metavar=files, help=meaning)
    meaning = "refuse a scene file that names code"
    command.add_argument("--no-plugins", action="store_true", help=meaning)
    if with_set:
        meaning = (
            "replaces a value of the file, as 'upper.drive.load=0.4', 'upper.theta=0.1', "
            "'interaction.strength=0.3' or 'duration=20'; may be repeated"
        )
        command.add_argument("--set", metavar="KEY=VALUE", help=meaning, **REPEATED)


def add_numerics(command: argparse.ArgumentParser) -> None:
    """Add the accuracy, the method and the step of runs."""
    accuracy = "largest relative error, as 1e-6 (default: the file's)"
    command.add_argument("--accuracy", metavar="A", help=accuracy)
    method = "integration method (default: the file's, or the fastest)"
    command.add_argument("--method", metavar="M", help=method)
    command.add_argument("--step", metavar="H", help="time step, instead of an accuracy")
    unresolved = "let the step of a splitting method be too long to resolve the fastest oscillation"
    command.add_argument("--allow-unresolved", action="store_true", help=unresolved)


def numerics_of(options: argparse.Namespace) -> dict[str, Any]:
    """The arguments of runs that :func:`add_numerics` lets a user give.  Raises InputError."""
    return {
        "accuracy": as_number("--accuracy", options.accuracy),
        "step": as_number("--step", options.step),
        "method": options.method,
        "allow_unresolved": options.allow_unresolved,
    }


def add_many_runs(command: argparse.ArgumentParser, members: str) -> None:
    """Add the options of ensembles and sweeps; `members` says what their number is."""
    command.add_argument("--members", type=int, metavar="N", help=members)
    vary = (
        "draw a value for each member, as 'upper.theta=normal(0,0.1)', "
        "'interaction.strength=uniform(0.1,0.2)' or 'upper.theta=grid(-1,1,1000)'; may be repeated"
    )
    command.add_argument("--vary", metavar="KEY=DISTRIBUTION", help=vary, **REPEATED)
    keep = (
        "quantities to keep, separated by commas, as upper.w1,contact_energy (default: the "
        "file's, or those of whole surfaces and of the system)"
    )
    command.add_argument("--keep", metavar="NAMES", help=keep)
    at = "keep them at the end, or at all times of the scene's output (default: end)"
    command.add_argument("--at", choices=["end", "samples"], default="end", help=at)
    returned = (
        "return means, covariances, quantiles and histograms of the kept quantities, not the "
        "members"
    )
    command.add_argument("--statistics", action="store_true", help=returned)
    width = (
        "run as many members as make the half-width of the 95 %% interval of a mean, as "
        "upper.W, at most SIZE, in units of the largest work or change of energy; may be repeated"
    )
    command.add_argument("--half-width", metavar="NAME=SIZE", help=width, **REPEATED)
    sampler = "draw quasi-random instead of random numbers; for sobol, N should be a power of 2"
    command.add_argument("--sampler", choices=["sobol", "latin-hypercube"], help=sampler)
    command.add_argument("--seed", type=int, default=0, help="seed of the members (default: 0)")
    add_numerics(command)
    threads = "runs at the same time in this process (default: TRIBO_THREADS, or all cores)"
    command.add_argument("--threads", type=int, metavar="N", help=threads)
    processes = "processes that run members or points at the same time (default: 1)"
    command.add_argument("--processes", type=int, default=1, metavar="N", help=processes)
    out = "write the data set as NetCDF; during the runs, FILE.part contains the finished ones"
    add_files(command, out, "read FILE if that is complete")
    add_output(command, "a summary")


def load(options: argparse.Namespace) -> Scene:
    """The scene in the file; with --no-plugins its code is refused.  Raises InputError."""
    from tribo.model.scene_file import load_scene
    from tribo.plugins.unloaded import Code, code

    with code(Code.REFUSE if options.no_plugins else Code.LOAD):
        return load_scene(options.scene)


def load_with_values(options: argparse.Namespace) -> Scene:
    """The scene in the file with the values of --set, which no option replaces.

    Raises InputError.
    """
    from tribo.model.binding import check_arguments
    from tribo.model.parameters import with_values

    values = {key: parsed(value) for key, value in by_key("--set", options.set).items()}
    scene = load(options)
    try:
        check_arguments(values, vars(options))
        return with_values(scene, values) if values else scene
    except InputError as error:
        raise InputError(f"--set {error.field}", error.problem) from None


def of_option(error: InputError, options: argparse.Namespace) -> InputError:
    """The same error about the option that gives the argument of a function, if one does.

    Options have the names of arguments, as ``--half-width upper.W`` that of ``half_width.upper.W``.
    """
    name, _, rest = error.field.partition(".")
    value = None if name in ARGUMENTS else vars(options).get(name)
    is_given = not (value is None or value is False or value == [])
    is_missing = name in vars(options) and error.problem.startswith(MISSING)
    if not is_given and not is_missing:
        return error
    return InputError(f"--{name.replace('_', '-')} {rest}".strip(), error.problem)


def page_of(options: argparse.Namespace, command: str, other: str) -> Path:
    """The page that a `command` writes, by default beside the scene.

    A line says so where that replaces a page of the command `other`, whose default it is too.
    """
    if options.out is not None:
        return Path(options.out)
    page: Path = options.scene.with_suffix(".html")
    if page.is_file() and PAGES[other].encode() in read_file(page):
        kept = page.with_stem(f"{page.stem}_{command}")
        line = f"{page} is a page of tribo {other}; this one replaces it; -o {kept} keeps both"
        print(f"tribo: {line}", file=sys.stderr)
    return page


def by_key(option: str, texts: Iterable[str]) -> dict[str, str]:
    """The values of texts as "key=value" by their keys.  Raises InputError about the option."""
    found: dict[str, str] = {}
    for text in texts:
        name, _, value = text.partition("=")
        key = ",".join(map(str.strip, name.split(",")))  # a sweep may join several
        if not key or not value.strip():
            raise must_be(option, "KEY=VALUE", text)
        if key in found:
            raise InputError(f"{option} {key}", "is given twice; give each key once")
        found[key] = value.strip()
    return found


def parsed(text: str) -> object:
    """A value on the command line: a value of TOML, a number, or a word."""
    try:
        return tomllib.loads(f"value = {text}\n")["value"]
    except tomllib.TOMLDecodeError:
        pass
    try:
        return float(text)  # as .5, which TOML does not know
    except ValueError:
        return text


def parsed_list(option: str, text: str) -> list[object]:
    """The values of "0.1,0.2,0.4" or "bar,swing".  Raises InputError about the option."""
    values = parsed(f"[{text}]")
    if isinstance(values, list) and values:
        return values
    words = [word.strip() for word in text.split(",")]
    if not all(words) or text.startswith("["):
        raise must_be(option, "values with commas between them, as 0.1,0.2,0.4", text)
    return [parsed(word) for word in words]


def as_number(option: str, text: str | None) -> float | None:
    """The number of an option, None where it is not given.  Raises InputError about the option."""
    if text is None:
        return None
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise must_be(option, "a number", text)
    return value


def check_figure(path: Path | None) -> None:
    """Raise InputError before the work for a figure that could not be written."""
    if path is not None:
        from tribo.plotting.style import figure_path

        checked_target("--figure", figure_path("--figure", path))


def draw_to(path: Path | None, draw: Callable[[Path], object], option: str = "--figure") -> None:
    """Let a function draw the figure that a command was asked for, after its output.

    Raises InputError if that fails: matplotlib may be set up for another place, as a notebook.
    """
    if path is None:
        return
    sys.stdout.flush()
    os.environ["MPLBACKEND"] = "agg"  # read when matplotlib is imported; files need no window
    try:
        draw(path)
    except InputError:
        raise
    except Exception as error:  # of matplotlib, its backends or LaTeX
        problem = " ".join(str(error).split())[:MOST_OF_ERROR]
        raise InputError(option, f"{path} cannot be drawn ({problem})") from None
