"""Descriptions that docstrings share, repeated where a page shows them.

A docstring says "As for :func:`prepare`." of the arguments that two functions share, so that the
text stands in the sources once.  The build puts that text in the place of the pointer.
"""

import inspect
import re
import sys
from typing import NamedTuple

import function_examples

import tribo
from tribo.model import rows, spectrum

POINTER = re.compile(r"As for :(?:func|meth):`~?([\w.]+)`[.,;]?\s*(.*)", re.DOTALL)


class Entry(NamedTuple):
    """An entry of a section: its names, its type, and its lines."""

    names: tuple[str, ...]
    kind: str
    text: list[str]


def sections(lines: list[str]) -> list[tuple[str, list[str]]]:
    """The title and the lines of each section of a numpydoc text; the first has no title."""
    found: list[tuple[str, list[str]]] = [("", [])]
    for number, line in enumerate(lines):
        after = lines[number + 1] if number + 1 < len(lines) else ""
        if line.strip() and re.fullmatch(r"-{3,}", after.strip()):
            found.append((line.strip(), []))
        else:
            found[-1][1].append(line)
    return [found[0], *((title, body[1:]) for title, body in found[1:])]


def entries(body: list[str]) -> list[Entry]:
    """The entries of a section: lines without an indent, each with the indented lines below it."""
    found: list[Entry] = []
    for line in body:
        if line.strip() and not line.startswith(" "):
            names, _, kind = line.partition(" : ")
            found.append(Entry(tuple(name.strip() for name in names.split(",")), kind, []))
        elif found:
            found[-1].text.append(line)
    return found


def repeated(lines: list[str], owner: object = None) -> list[str]:
    """The lines of a docstring with the text of others in the place of pointers to them.

    `owner` is the class of a method, in which other methods are looked up.
    """
    result: list[str] = []
    for title, body in sections(lines):
        if not title:
            result += body
            continue
        result += [title, "-" * len(title)]
        if not any("As for :" in line for line in body):
            result += body
            continue
        for entry in entries(body):
            result += _whole(entry, title, owner)
        result.append("")
    return result


def _whole(entry: Entry, section: str, owner: object) -> list[str]:
    """The lines of an entry; one entry for each name where its text stands elsewhere."""
    pointer = POINTER.match(" ".join(line.strip() for line in entry.text).strip())
    head = ", ".join(entry.names) + (f" : {entry.kind}" if entry.kind else "")
    if pointer is None:
        return [head, *entry.text]
    source = _target(pointer[1], owner)
    bodies = dict(sections((inspect.getdoc(source) or "").splitlines()))
    known = {name: e for e in entries(bodies.get(section, [])) for name in e.names}
    result: list[str] = []
    for name in entry.names:
        if name not in known:  # the other function has no text on it
            return [head, *entry.text]
        other = known[name]
        further = pointer[2] if name == entry.names[-1] else ""
        text = [line for line in other.text if line.strip()]
        if further:
            text.append(f"    {further[0].upper()}{further[1:]}")
        result += _whole(Entry((name,), entry.kind or other.kind, text), section, owner)
    return result


def _target(name: str, owner: object) -> object:
    """The function or method of a pointer."""
    last = name.rpartition(".")[2]
    for place in (owner, tribo, tribo.potentials, rows, spectrum):
        if hasattr(place, last):
            return getattr(place, last)
    raise LookupError(f"{name} is not known")


def public_name(function: object) -> str:
    """The name by which users call a function: of the highest module that offers it."""
    parts = function.__module__.split(".")
    places = [".".join(parts[:count]) for count in range(1, len(parts) + 1)]
    for place in places:
        if getattr(sys.modules[place], function.__name__, None) is function:
            return f"{place}.{function.__name__}"
    raise LookupError(f"{function.__name__} is not in {parts}")


def process(app, what, name, obj, options, lines):
    """Repeat shared text in a docstring that autodoc shows."""
    owner = None
    if what == "method":
        owner = getattr(tribo, name.split(".")[-2], None)
    lines[:] = repeated(lines, owner)
    if what == "function":
        lines += function_examples.lines(public_name(obj))


def setup(app):
    """Work before napoleon, which turns sections into fields."""
    app.setup_extension("sphinx.ext.autodoc")
    app.connect("autodoc-process-docstring", process, priority=100)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
