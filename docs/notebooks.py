"""Tutorials as Jupyter notebooks, made from their pages when the documents are built.

Python blocks become cells with the output that the page shows, scene files are written by
``%%writefile``, and ``tribo`` commands run in a shell.  A picture that a cell draws is the output
of this cell, so that a changed cell shows its own; other pictures are part of the text.

    python docs/notebooks.py        writes them beside their pages, where they can be opened
"""

import base64
import json
import re
import tempfile
from pathlib import Path
from typing import Any

import page_code

HERE = Path(__file__).parent
PAGES = [
    HERE / "tutorials" / f"{name}.md"
    for name in ("from_the_paper", "energy_direction", "friction_law", "new_potential", "answers")
]
INCLUDE = re.compile(r"^```\{include\} /(\S+)\n```$", re.MULTILINE)
DIRECTIVE = re.compile(r"^```\{.*?^```$\n?", re.MULTILINE | re.DOTALL)
IMAGE = re.compile(
    r"^```\{image\} \S*?([\w.-]+)\n.*?:alt: ([^\n]*)\n.*?^```$", re.MULTILINE | re.DOTALL
)
UNNAMED = re.compile(r"\[\]\(([\w./-]+\.md)(?:#[\w-]+)?\)")  # shown with the title of its page
DOWNLOAD = re.compile(r"[^.]*\{download\}`[^`]*`\.")  # the sentence that offers the notebook
TARGET = re.compile(r"\]\((?:\.\./)*[\w/-]+\.md(#[\w-]+)?\)")  # of links to other pages


class Notebook:
    """The cells of a notebook, to which text and code are added in order.

    `page` is the page, and `folder` has its pictures.
    """

    def __init__(self, page: Path, folder: Path) -> None:
        self.cells: list[dict[str, Any]] = []
        self._page = page
        self._folder = folder

    def add_code(self, source: str) -> None:
        """Add a cell of code."""
        empty: dict[str, Any] = {"metadata": {}, "outputs": [], "execution_count": None}
        self.cells.append({"cell_type": "code", "source": source, **empty})

    def add_text(self, text: str) -> None:
        """Add a cell without directives and without links to pages that are not there."""
        text = INCLUDE.sub(lambda found: (HERE / found[1]).read_text(encoding="utf-8"), text)
        text = DOWNLOAD.sub("", text)  # before pictures, on whose long lines it takes minutes
        text = DIRECTIVE.sub("", IMAGE.sub(self._picture, text))
        prose = TARGET.sub("]", UNNAMED.sub(self._title, text)).strip()
        prose = re.sub(r"(?<!!)\[([^\]\[]+)\](?!\()", r"\1", prose)
        if prose:
            self.cells.append({"cell_type": "markdown", "metadata": {}, "source": prose})

    def _picture(self, found: re.Match[str]) -> str:
        """A picture as text, or nothing: where it was not drawn, or is the output of a cell."""
        file = self._folder / found[1]
        if not file.exists():
            return ""
        data = base64.b64encode(file.read_bytes()).decode("ascii")
        for cell in self.cells:
            if cell["cell_type"] == "code" and f'"{file.name}"' in cell["source"]:
                shown = {"data": {"image/png": data}, "metadata": {}}
                cell["outputs"].append({"output_type": "display_data", **shown})
                return ""
        return f"![{found[2]}](data:image/png;base64,{data})"

    def _title(self, found: re.Match[str]) -> str:
        """The title of another page, in quotation marks."""
        text = (self._page.parent / found[1]).read_text(encoding="utf-8")
        return f"“{re.search(r'^# (.*)$', text, re.MULTILINE)[1]}”"  # type: ignore[index]


def notebook(page: Path, folder: Path) -> dict[str, Any]:
    """The notebook of a page, in format 4.5, with the pictures that are in a folder."""
    text = page.read_text(encoding="utf-8")
    fences = [found for found in page_code.FENCE.finditer(text) if not found[1].startswith("{")]
    book = Notebook(page, folder)
    end = 0
    for found, block in zip(fences, page_code.blocks(page), strict=True):
        book.add_text(text[end : found.start()])
        end = found.end()
        follows = block.language == "text" and block.follows
        if follows and book.cells[-1]["cell_type"] == "code":
            output = {"output_type": "stream", "name": "stdout", "text": block.text}
            book.cells[-1]["outputs"] = [output]
        elif block.language in page_code.RUN:
            book.add_code(_source(block))
        else:
            book.add_text(found[0])
    book.add_text(text[end:])
    for number, cell in enumerate(book.cells):
        cell["id"] = f"cell-{number}"
    return {
        "cells": book.cells,
        "metadata": {"kernelspec": {"display_name": "Python 3", "name": "python3"}},
        "nbformat": 4,
        "nbformat_minor": 5,
    }


def write(page: Path, folder: Path) -> Path:
    """Write the notebook of a page into a folder that has its pictures."""
    path = folder / f"{page.stem}.ipynb"
    path.write_text(json.dumps(notebook(page, folder), indent=1), encoding="utf-8")
    return path


def _source(block: page_code.Block) -> str:
    """The code of a cell."""
    if block.language == "shell":
        # tribo of the kernel's Python, also where its folder of programs is not on the PATH.
        lines = [
            line.replace("tribo ", '"{sys.executable}" -m tribo ', 1)
            for line in block.text.splitlines()
        ]
        return "import sys\n\n" + "".join(f"!{line}\n" for line in lines).rstrip()
    if block.language == "toml":
        named = page_code.FILE_NAME.match(block.text)
        return f"%%writefile {named[1] if named else 'scene.toml'}\n{block.text}".rstrip()
    return block.text.rstrip()


if __name__ == "__main__":
    for page in PAGES:
        with tempfile.TemporaryDirectory() as folder:
            page_code.run(page, Path(folder))
            written = write(page, Path(folder)).read_bytes()
        page.with_suffix(".ipynb").write_bytes(written)
