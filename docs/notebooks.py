"""Tutorials as Jupyter notebooks, made from their pages when the documents are built.

Python blocks become cells with the output that the page shows, scene files are written by
``%%writefile``, and ``tribo`` commands run in a shell.  Pictures of the page are left out.
"""

import json
import re
from pathlib import Path
from typing import Any

import page_code

DIRECTIVE = re.compile(r"^```\{.*?^```$\n?", re.MULTILINE | re.DOTALL)
DOWNLOAD = re.compile(r"[^.]*\{download\}`[^`]*`\.")  # the sentence that offers the notebook
TARGET = re.compile(r"\]\((?:\.\./)*[\w/-]+\.md(#[\w-]+)?\)")  # of links to other pages


def notebook(page: Path) -> dict[str, Any]:
    """The notebook of a page, in format 4.5."""
    text = page.read_text(encoding="utf-8")
    fences = [found for found in page_code.FENCE.finditer(text) if not found[1].startswith("{")]
    cells: list[dict[str, Any]] = []
    end = 0
    for found, block in zip(fences, page_code.blocks(page), strict=True):
        _add_prose(cells, text[end : found.start()])
        end = found.end()
        if block.language == "text" and block.follows and cells[-1]["cell_type"] == "code":
            cells[-1]["outputs"] = [{"output_type": "stream", "name": "stdout", "text": block.text}]
        elif block.language in page_code.RUN:
            cells.append(_code(_source(block)))
        else:
            _add_prose(cells, found[0])
    _add_prose(cells, text[end:])
    for number, cell in enumerate(cells):
        cell["id"] = f"cell-{number}"
    return {
        "cells": cells,
        "metadata": {"kernelspec": {"display_name": "Python 3", "name": "python3"}},
        "nbformat": 4,
        "nbformat_minor": 5,
    }


def write(page: Path, folder: Path) -> Path:
    """Write the notebook of a page into a folder."""
    path = folder / f"{page.stem}.ipynb"
    path.write_text(json.dumps(notebook(page), indent=1), encoding="utf-8")
    return path


def _source(block: page_code.Block) -> str:
    """The code of a cell."""
    if block.language == "shell":
        return "".join(f"!{line}\n" for line in block.text.splitlines()).rstrip()
    if block.language == "toml":
        named = page_code.FILE_NAME.match(block.text)
        return f"%%writefile {named[1] if named else 'scene.toml'}\n{block.text}".rstrip()
    return block.text.rstrip()


def _code(source: str) -> dict[str, Any]:
    empty: dict[str, Any] = {"metadata": {}, "outputs": [], "execution_count": None}
    return {"cell_type": "code", "source": source, **empty}


def _add_prose(cells: list[dict[str, Any]], text: str) -> None:
    """Add a cell of text, without directives and without links to pages that are not there."""
    prose = TARGET.sub("]", DOWNLOAD.sub("", DIRECTIVE.sub("", text))).strip()
    prose = re.sub(r"(?<!!)\[([^\]\[]+)\](?!\()", r"\1", prose)
    if prose:
        cells.append({"cell_type": "markdown", "metadata": {}, "source": prose})
