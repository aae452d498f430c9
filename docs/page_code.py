"""The code blocks of the pages: found by their language, run in order, compared with their output.

    python    one program a page, run in a folder of its own
    text      right after a python or shell block: the output of that block; elsewhere not run
    shell     ``tribo`` commands, one a line, run in the same folder
    toml      a scene file, which must load; with a first line ``# NAME.toml`` it gets that name
    py        Python that is not run; its names and arguments of tribo must exist
    console   commands that are not run, since they take long or install something

Two outputs are the same if they differ in the last digit of their numbers, or in numbers below
``ROUND_OFF``.
"""

import ast
import contextlib
import inspect
import io
import os
import re
import shlex
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import NamedTuple, TypeGuard

import tribo
from tribo import load_scene
from tribo.commands import cli

RUN = ("python", "shell", "toml")
LANGUAGES = (*RUN, "py", "text", "console")
MADE = (".ipynb", ".py")  # downloads that are made of a page or are programs, not data
ROUND_OFF = 1e-9  # numbers below, in magnitude, may differ from machine to machine
FENCE = re.compile(r"^```(.*)\n((?:.*\n)*?)^```$", re.MULTILINE)
NUMBER = re.compile(r"(-?\d+(?:\.\d+)?(?:e[-+]\d+)?)")
FILE_NAME = re.compile(r"# (\S+\.toml)$", re.MULTILINE)
DOWNLOAD = re.compile(r"\{download\}`[^`<]*<([^`>]+)>`")
INDENTED = re.compile(r"\n\n((?: {4}|\t).*)\n")


class Block(NamedTuple):
    """A fenced block of a page."""

    language: str
    text: str
    line: int  # of the page, where the text begins
    follows: bool  # whether only blank lines part it from the block before


def blocks(page: Path) -> Iterator[Block]:
    """The code blocks of a page; directives as ``{image}`` are left out.

    Raises AssertionError for a block without one of ``LANGUAGES``, and for code without a fence.
    """
    text = page.read_text(encoding="utf-8")
    end = 0
    for found in FENCE.finditer(text):
        between = text[end : found.start()]
        _check_prose(page, between)
        language, end = found[1], found.end()
        if not language.startswith("{"):
            assert language in LANGUAGES, f"{page.name}: a block of {language!r} is not known"
            line = text.count("\n", 0, found.start(2))
            yield Block(language, found[2], line, not between.strip())
    _check_prose(page, text[end:])


def _check_prose(page: Path, text: str) -> None:
    """Complain about code between the fences, whose language is not named."""
    indented = INDENTED.search(text)
    assert not indented, f"{page.name}: fence {indented[1].strip()!r} and name its language"
    assert "```" not in text, f"{page.name}: a block is not closed"


def run(page: Path, folder: Path) -> None:
    """Run the blocks of a page in a folder, which gets the data that the page offers to download.

    Raises what a block raises, and AssertionError where the page shows another output than that of
    the code.
    """
    os.environ.setdefault("MPLBACKEND", "Agg")
    found = list(blocks(page))
    for name in DOWNLOAD.findall(page.read_text(encoding="utf-8")):
        data = page.parent / name
        if data.suffix not in MADE:
            shutil.copy(data, folder)
    with contextlib.chdir(folder), _module(page, found, folder) as module:
        printed = None
        for block in found:
            if block.language == "text" and block.follows and printed is not None:
                assert same(printed, block.text), (
                    f"{page.name} shows\n{block.text}but its code prints\n{printed}"
                )
            with contextlib.redirect_stdout(io.StringIO()) as out:
                _run(block, module)
            printed = out.getvalue() if block.language in ("python", "shell") else None


@contextlib.contextmanager
def _module(page: Path, found: list[Block], folder: Path) -> Iterator[ModuleType]:
    """A module for the page's program, with a source file whose lines are numbered as the page's.

    So potentials in pages have a source, by which compiled loops are kept on disk.
    """
    source = ""
    for block in found:
        if block.language == "python":
            source += "\n" * (block.line - source.count("\n")) + block.text
    module = ModuleType(f"page_{page.stem}")
    module.__file__ = str(folder / f"{module.__name__}.py")
    Path(module.__file__).write_text(source, encoding="utf-8")
    sys.modules[module.__name__] = module
    try:
        yield module
    finally:
        del sys.modules[module.__name__]


def _run(block: Block, module: ModuleType) -> None:
    """Run a block, if its language is one that runs."""
    if block.language == "python":
        code = compile("\n" * block.line + block.text, str(module.__file__), "exec")
        exec(code, vars(module))
    elif block.language == "py":
        _check_calls(ast.parse(block.text))
    elif block.language == "shell":
        for command in block.text.splitlines():
            program, *arguments = shlex.split(command, comments=True)
            assert program == "tribo", f"{command}: only tribo commands run; use console"
            assert cli.main(arguments) == 0, f"{command} fails"
    elif block.language == "toml":
        named = FILE_NAME.match(block.text)
        file = Path(named[1] if named else "scene.toml")
        file.write_text(block.text, encoding="utf-8")
        load_scene(file)


def _check_calls(tree: ast.AST) -> None:
    """Complain about names of tribo, and arguments of its functions, that do not exist."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and _is_of_tribo(node.func):
            given = {keyword.arg: None for keyword in node.keywords}
            inspect.signature(getattr(tribo, node.func.attr)).bind(*node.args, **given)
        elif _is_of_tribo(node):
            getattr(tribo, node.attr)


def _is_of_tribo(node: ast.AST) -> TypeGuard[ast.Attribute]:
    return isinstance(node, ast.Attribute) and ast.unparse(node.value) == "tribo"


def same(one: str, other: str) -> bool:
    """Whether two outputs are the same, but for round-off."""
    first, second = NUMBER.split(one.rstrip()), NUMBER.split(other.rstrip())
    return first[::2] == second[::2] and all(map(_near, first[1::2], second[1::2]))


def _near(one: str, other: str) -> bool:
    a, b = float(one), float(other)
    digits, _, exponent = other.partition("e")
    unit = 10.0 ** (int(exponent or 0) - len(digits.partition(".")[2]))  # of the last digit
    return a == b or ("." in digits and abs(a - b) <= 1.1 * unit) or max(abs(a), abs(b)) < ROUND_OFF
