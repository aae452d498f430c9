"""Mutants of the package: its functions with one small change each, found in the syntax tree."""

import ast
import hashlib
import re
from collections import Counter
from collections.abc import Iterator
from copy import deepcopy
from functools import cache
from typing import NamedTuple

from support.package import SOURCE

OPERATORS = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult}
COMPARISONS = {
    ast.Lt: ast.GtE,
    ast.GtE: ast.Lt,
    ast.Gt: ast.LtE,
    ast.LtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
}
NAMES = {"sin": "cos", "cos": "sin", "min": "max", "max": "min"}
AXIS = re.compile(r"(?:(?<=_)|(?<=^)|(?<=^[a-z]))[xy](?=\d?$)")  # of x, fx, gap_x, turn_x1
WORD = re.compile(r"[A-Za-z_]\w*")
NOT_CODE = (ast.Assert, ast.Raise, ast.JoinedStr, ast.arguments)


class Mutant(NamedTuple):
    """One change of one function."""

    file: str  # below the package
    function: str  # qualified name
    old: str
    new: str
    nth: int  # among the changes of this function that read the same
    draw: float  # in [0, 1): which mutants a sample takes

    def __str__(self) -> str:
        again = f" ({self.nth + 1})" if self.nth else ""
        return f"{self.file}: {self.function}: {self.old} -> {self.new}{again}"

    def source(self) -> str:
        """The file's source with this change."""
        tree = parsed(self.file)
        for mutant, change in changes(self.file, tree):
            if mutant == self:
                change()
                return ast.unparse(tree)
        raise LookupError(f"no such mutant: {self}")


def parsed(file: str) -> ast.Module:
    """The syntax tree of a file of the package."""
    return ast.parse((SOURCE / file).read_text(encoding="utf-8"))


@cache
def mutants(file: str) -> list[Mutant]:
    """All mutants of a file's functions."""
    return [mutant for mutant, _ in changes(file, parsed(file))]


def changes(file: str, tree: ast.Module):
    """Every mutant and a function that makes the change in the tree."""
    words = {n.id for n in ast.walk(tree) if isinstance(n, ast.Name)}
    words |= {n.attr for n in ast.walk(tree) if isinstance(n, ast.Attribute)}
    alike: Counter[str] = Counter()  # changes that differ in names alone, so that a rename
    for name, function in functions(tree):  # of a variable changes no draw
        seen: Counter[tuple[str, str]] = Counter()
        for node, parent, field, index in sites(function):
            for new in replacements(node, parent, words):
                old, text = texts(node, parent, field, index, new)
                nth = seen[old, text]
                seen[old, text] += 1
                form = WORD.sub("_", f"{old} -> {text}")
                draw = number(f"{file} {form} {alike[form]}")
                alike[form] += 1

                def change(parent=parent, field=field, index=index, new=new):
                    replace(parent, field, index, new)

                yield Mutant(file, name, old, text, nth, draw), change


def number(text: str) -> float:
    """A number in [0, 1) that depends on a text alone."""
    return int.from_bytes(hashlib.blake2b(text.encode(), digest_size=4).digest(), "big") / 2**32


def functions(tree: ast.AST, prefix: str = "") -> Iterator[tuple[str, ast.FunctionDef]]:
    """Functions and methods with their qualified names; inner functions belong to the outer."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.FunctionDef):
            yield prefix + node.name, node
        elif isinstance(node, ast.ClassDef):
            yield from functions(node, f"{prefix}{node.name}.")


def sites(parent: ast.AST):
    """Every node below, with its parent, the parent's field, and the place in a list."""
    for field, value in ast.iter_fields(parent):
        if field in ("decorator_list", "returns", "annotation"):
            continue
        children = value if isinstance(value, list) else [value]
        for index, node in enumerate(children):
            if isinstance(node, ast.AST) and not isinstance(node, NOT_CODE):
                yield node, parent, field, index if isinstance(value, list) else None
                yield from sites(node)


def replace(parent: ast.AST, field: str, index: int | None, new: ast.AST) -> ast.AST:
    """Put a node in place of another; returns the other."""
    if index is None:
        old = getattr(parent, field)
        setattr(parent, field, new)
    else:
        old = getattr(parent, field)[index]
        getattr(parent, field)[index] = new
    return old


def texts(node, parent, field, index, new) -> tuple[str, str]:
    """The code before and after a change: as much of it as shows what it means."""
    if isinstance(node, ast.stmt) or not isinstance(parent, ast.expr):
        if isinstance(parent, (ast.AugAssign, ast.Assign, ast.Return)):
            shown = parent
        else:
            return ast.unparse(node), ast.unparse(new)
    else:
        shown = parent
    before = ast.unparse(shown)
    old = replace(parent, field, index, new)
    after = ast.unparse(shown)
    replace(parent, field, index, old)
    return before, after


def with_changes(node: ast.AST, **fields) -> ast.AST:
    """A copy of a node with other fields."""
    new = deepcopy(node)
    for name, value in fields.items():
        setattr(new, name, value)
    return new


def replacements(node: ast.AST, parent: ast.AST, words: set[str]) -> list[ast.AST]:
    """What a node can be replaced by."""
    found: list[ast.AST] = []
    if isinstance(node, ast.stmt):
        return of_statement(node)
    if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
        found.append(with_changes(node, op=OPERATORS[type(node.op)]()))
        if isinstance(node.op, (ast.Add, ast.Sub)):
            found.append(node.left)
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.Not)):
        found.append(node.operand)
    elif isinstance(node, ast.Compare) and type(node.ops[0]) in COMPARISONS:
        found.append(with_changes(node, ops=[COMPARISONS[type(node.ops[0])](), *node.ops[1:]]))
    elif isinstance(node, ast.BoolOp):
        other = ast.Or() if isinstance(node.op, ast.And) else ast.And()
        found.append(with_changes(node, op=other))
    elif isinstance(node, ast.IfExp):
        found.append(with_changes(node, body=node.orelse, orelse=node.body))
    elif isinstance(node, ast.Constant):
        found += of_constant(node, parent)
    elif isinstance(node, ast.Call) and len(node.args) > 1 and not is_symmetric(node):
        *first, one, other = node.args
        if ast.dump(one) != ast.dump(other) and not isinstance(other, ast.Starred):
            found.append(with_changes(node, args=[*first, other, one]))
    found += of_name(node, words)
    return found


def is_symmetric(call: ast.Call) -> bool:
    """Whether a call means the same with its arguments in another order, but for nan."""
    return isinstance(call.func, ast.Name) and call.func.id in ("min", "max")


def of_statement(node: ast.stmt) -> list[ast.AST]:
    """Without the statement, and with the sign or the condition turned round."""
    found: list[ast.AST] = []
    assigned = isinstance(node, ast.Assign) and not isinstance(
        node.targets[0], (ast.Name, ast.Tuple)
    )
    called = isinstance(node, ast.Expr) and isinstance(node.value, ast.Call)
    if assigned or called or isinstance(node, (ast.AugAssign, ast.Continue)):
        found.append(ast.Pass())
    if isinstance(node, ast.AugAssign) and type(node.op) in OPERATORS:
        found.append(with_changes(node, op=OPERATORS[type(node.op)]()))
    if isinstance(node, ast.If) and isinstance(node.test, (ast.Name, ast.Attribute, ast.Call)):
        found.append(with_changes(node, test=ast.UnaryOp(ast.Not(), node.test)))
    return found


def of_constant(node: ast.Constant, parent: ast.AST) -> list[ast.AST]:
    """Twice the number, the next number, or the other axis."""
    value = node.value
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return []
    if isinstance(value, float):
        return [ast.Constant(2.0 * value if value else 1.0)]
    if isinstance(parent, ast.Subscript) and value in (0, 1):
        return [ast.Constant(1 - value)]
    return [ast.Constant(value + 1)]


def of_name(node: ast.AST, words: set[str]) -> list[ast.AST]:
    """Sine for cosine, x for y."""
    field = {ast.Name: "id", ast.Attribute: "attr"}.get(type(node))
    if field is None or not isinstance(node.ctx, ast.Load):
        return []
    name = getattr(node, field)
    other = AXIS.sub(lambda axis: "y" if axis[0] == "x" else "x", name)
    found = [NAMES[name]] if name in NAMES else []
    found += [other] if other != name and other in words else []
    return [with_changes(node, **{field: new}) for new in found]
