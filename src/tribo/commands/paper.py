"""The command `tribo paper`: the paper's numbers beside the computed ones, and a picture."""

import argparse
import sys
from functools import partial
from pathlib import Path

from tribo.commands import scene_options as shared
from tribo.files import checked_target, strict_json
from tribo.interrupts import COMPLETED
from tribo.validation import InputError

# The picture that the command writes unless --figure names another.
PICTURE = Path("paper.png")
NEXT = """\
Next:  tribo paper --all       all printed numbers, each with the computed one and its error
       tribo new A -o a.toml   the paper's case A as a scene file; likewise B to E
       tribo run a.toml        simulates it
       tribo live a.toml       writes a page in which you change its values and see what follows"""


def add_paper(paper: argparse.ArgumentParser) -> None:
    """Add the arguments of `tribo paper`."""
    cases = "case of the paper, whose numbers are all printed (default: the ends of all cases)"
    paper.add_argument("case", nargs="?", choices=list("ABCDE"), help=cases)
    numbers = "print all numbers beside the computed ones, with errors and explanations"
    paper.add_argument("--all", action="store_true", help=numbers)
    figure = f"write the picture of the works (default: {PICTURE}, unless that exists)"
    shared.add_output(paper, "the comparison", figure)
    figures = "write the paper's figures to this folder"
    paper.add_argument("--figures", type=Path, metavar="DIR", help=figures)
    paper.set_defaults(command=_paper)


def _paper(options: argparse.Namespace) -> int:
    """Print the comparison with the paper, and draw what is asked for."""
    from tribo import paper

    shared.check_figure(options.figure)
    cases = [options.case] if options.case else list(paper.CASES)
    tables = paper.compare(cases)
    if options.json:
        rows = {case: [row.as_json() for row in table] for case, table in tables.items()}
        print(strict_json(rows))
    else:
        whole = options.all or options.case
        print(paper.report(tables) if whole else paper.short_report(tables))

    path, line = _picture(options)
    shared.draw_to(path, partial(paper.draw_overview, tables))

    def draw(folder: Path) -> None:
        from tribo.paper import figures

        for file in figures.draw(folder, cases):
            print(file, file=sys.stderr)

    shared.draw_to(options.figures, draw, "--figures")
    if not options.json:
        print(f"\n{line}\n\n{NEXT}")
    return COMPLETED


def _picture(options: argparse.Namespace) -> tuple[Path | None, str]:
    """The file of the picture, if one is to be written, and a line about it.

    A file that the user has not named is never replaced.
    """
    shows = "the works in each case, with a circle at each number printed for its end"
    if options.figure is not None:
        return options.figure, f"{options.figure} shows {shows}."
    if options.json:
        return None, ""
    if PICTURE.exists():
        return None, f"{PICTURE} exists and is kept; --figure FILE draws {shows}."
    try:
        checked_target("--figure", PICTURE)
    except InputError as error:
        return None, f"{PICTURE} was not written: it {error.problem}."
    return PICTURE, f"{PICTURE} shows {shows}."
