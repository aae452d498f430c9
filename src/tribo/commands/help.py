"""Help of the command line: the way to the right command, and completion in a shell."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterable
from difflib import get_close_matches
from pathlib import Path
from typing import NoReturn

# The end of `tribo --help`.
FIRST_STEPS = """\
first steps:
  tribo new -o scene.toml              a commented scene file
  tribo run scene.toml --out run.nc    its end state, and all series in a file
  tribo view run.nc -o run.html        a page that plays the run
  tribo COMMAND --help                 all options of a command
"""

# Shells for which `tribo completion` writes a script.
SHELLS = ("bash", "zsh", "tcsh")


class CommandParser(argparse.ArgumentParser):
    """A parser that names the nearest word where it does not know one."""

    def error(self, message: str) -> NoReturn:
        """Print the usage and the message; exit with status 2."""
        unknown = re.search(r"invalid choice: '(.*?)' \(choose from (.*)\)", message)
        if unknown is not None:
            word, known = unknown[1], re.findall(r"[\w-]+", unknown[2])
            near = get_close_matches(word, known, 1)
            if Path(word).suffix in (".toml", ".nc"):
                message = f"{word} is no command; did you mean: {self.prog} run {word}"
            elif near:
                message += f"; did you mean {near[0]}?"
        super().error(message)


def add_completion(
    completion: argparse.ArgumentParser,
    parser: argparse.ArgumentParser,
    commands: Iterable[argparse.ArgumentParser],
) -> None:
    """Add the arguments of `tribo completion`, for a parser and its commands."""

    def print_script(options: argparse.Namespace) -> int:
        import shtab

        for action in (action for command in commands for action in command._actions):
            if action.type is Path:  # completes names of files
                action.complete = shtab.FILE  # type: ignore[attr-defined]
        print(shtab.complete(parser, options.shell))
        return 0

    completion.add_argument("shell", choices=SHELLS, help="the shell that reads the script")
    completion.set_defaults(command=print_script)
