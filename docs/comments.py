"""Fields of dataclasses and NamedTuples, documented by the comments beside them."""

import inspect
import io
import re
import tokenize


def add_fields(app, what, name, item, options, lines):
    """Append ``:param field: its comment`` to a docstring without a section of attributes."""
    if what != "class" or re.search(r"^Attributes\n-+$", inspect.getdoc(item) or "", re.MULTILINE):
        return
    for field, comment in field_comments(item).items():
        lines += [] if any(lines[-1:]) and lines[-1].startswith(":param") else [""]
        lines.append(f":param {field}: {comment}")


def field_comments(cls) -> dict[str, str]:
    """The comment at the end of each field's lines, for the class and its base classes."""
    found: dict[str, str] = {}
    for base in reversed(cls.__mro__):
        if "__annotations__" in vars(base) and base.__module__.startswith("tribo"):
            found |= _own_comments(base)
    return found


def _own_comments(cls) -> dict[str, str]:
    found, depth, field = {}, 0, ""
    reader = io.StringIO(inspect.getsource(cls)).readline
    fresh = True  # whether a statement begins here
    for token in tokenize.generate_tokens(reader):
        if token.type in (tokenize.INDENT, tokenize.DEDENT):
            depth += 1 if token.type == tokenize.INDENT else -1
        elif token.type == tokenize.NEWLINE:
            fresh = True
        elif token.type == tokenize.COMMENT and field in cls.__annotations__:
            found.setdefault(field, token.string.lstrip("# "))
            field = ""
        elif token.type not in (tokenize.NL, tokenize.COMMENT):
            if fresh:
                field = token.string if depth == 1 else ""
            fresh = False
    return found
