"""Potentials from an expression in r, as "D*(exp(-2*a*(r - r0)) - 2*exp(-a*(r - r0)))".

The expression is parsed and never evaluated as text: only arithmetic, numbers, names and the
functions below are allowed.  It is differentiated term by term.  Energy and force are written into
the source of a class as a user would write it, so it is compiled and cached like a user's class.
"""

import ast
import math
from functools import cache

from tribo.plugins import classes as plugins
from tribo.plugins import sources
from tribo.potentials.derivative import CHOICES, FUNCTIONS, OPERATORS, Rules, factors_in, substitute
from tribo.potentials.potential import Potential, as_potential
from tribo.validation import InputError, short_repr

# The functions that an expression may have, and their names in numpy.
IN_NUMPY = {name: name for name in (*FUNCTIONS, *CHOICES, "where")} | {
    "min": "minimum",
    "max": "maximum",
}
# Comparisons in the first argument of where, and in "... if ... else ...".
COMPARISONS = (ast.Lt, ast.LtE, ast.Gt, ast.GtE)
# Names that a parameter cannot have: those of a potential's methods and of a scene file's keys.
RESERVED = (
    *dir(Potential),
    *("energy", "force", "energy_between", "force_between", "minimum", "self", "np"),
    *("potential", "between", "cutoff", "at_cutoff", "switch_from", "expression_text"),
)
HEAD = '''"""A potential that was given as an expression."""
import numpy as np
from tribo import Potential
class Expression(Potential):
    """{text}"""
'''
BODY = """
    def energy(self, r):
        return {energy}
    def force(self, r):
        return -({slope})
    def acts_at_all(self):
        return {acts}
Expression.expression_text = {text!r}
"""


def expression(text: str, /, **parameters: float) -> Potential:
    """A potential U(r) from an expression.

    Parameters
    ----------
    text : str
        An expression of ``+ - * / **``, brackets, numbers, ``r``, ``pi``, parameters, and the
        functions exp, log, sqrt, sin, cos, tan, sinh, cosh and tanh.  It may choose between two
        values: ``min(a, b)``, ``max(a, b)``, ``where(r < d, a, b)`` or ``a if r < d else b``.
    **parameters : float
        A number for each parameter.

    Returns
    -------
    Potential
        Its force is minus the derivative of the expression.

    Raises
    ------
    InputError
        If the expression has other parts, or a parameter is missing.
    """
    return as_potential(plugins.instance(class_of(text), parameters))  # type: ignore[no-any-return]


def is_expression(text: str) -> bool:
    """Whether a text is an expression rather than the name of a potential."""
    if any(sign in text for sign in "()*+/"):
        return True
    try:
        return not text.isidentifier() and "r" in _names(ast.parse(text, mode="eval"))
    except (SyntaxError, ValueError):
        return False


@cache
def class_of(text: str) -> type:
    """The class whose energy is the expression and whose fields are its parameters."""
    tree = _parsed(text)
    fields = [name for name in _names(tree) if name not in ("r", "pi", *IN_NUMPY)]
    for name in fields:
        if name in RESERVED or name.startswith("_"):
            raise _refusal(text, f'another name for the parameter "{name}"')
    if "r" not in _names(tree):
        raise _refusal(text, "the distance r")
    if not fields:
        raise _refusal(text, "a name for one of its numbers, as k/r with k = 0.2")
    source = HEAD.format(text=text.replace("\\", "").replace('"', ""))
    source += "".join(f"    {name}: float\n" for name in fields)
    energy = _compiled(tree)
    factors = factors_in(ast.parse(energy, mode="eval").body, "self")
    acts = " and ".join(f"self.{name} != 0.0" for name in factors) or "True"
    source += BODY.format(
        energy=energy, acts=acts, slope=_compiled(Rules("r").derivative(tree)), text=text
    )
    return sources.load(source.encode(), f"<{text}>").Expression


def _parsed(text: str) -> ast.expr:
    """The tree of an expression.  Raises InputError for parts that are not allowed."""
    try:
        tree = ast.parse(text.strip(), mode="eval").body
    except SyntaxError as error:
        problem = f"valid syntax ({error.msg}, at its character {error.offset})"
        raise _refusal(text, problem) from None
    except (ValueError, RecursionError, MemoryError):
        raise _refusal(text, "valid syntax") from None
    _check(tree, text)
    return _without_if(tree)


def _without_if(tree: ast.expr) -> ast.expr:
    """The tree with where(test, a, b) for every "a if test else b"."""

    class Replace(ast.NodeTransformer):
        def visit_IfExp(self, node: ast.IfExp) -> ast.expr:
            parts = [self.visit(part) for part in (node.test, node.body, node.orelse)]
            return ast.copy_location(ast.Call(ast.Name("where"), parts, []), node)

    result: ast.expr = ast.parse(ast.unparse(Replace().visit(tree)), mode="eval").body
    return result


def _check(node: ast.expr, text: str) -> None:
    """Raise InputError for the first part of a tree that is not allowed."""
    parts: list[ast.expr] = []
    match node:
        case ast.BinOp(left, op, right) if isinstance(op, OPERATORS):
            parts = [left, right]
        case ast.BinOp(op=ast.BitXor()):
            raise _refusal(text, "** for powers instead of ^")
        case ast.UnaryOp(ast.USub() | ast.UAdd(), operand):
            parts = [operand]
        case ast.Call(ast.Name(name), [_], []) if name in FUNCTIONS:
            parts = node.args
        case ast.Call(ast.Name(name), [_, _], []) if name in CHOICES:
            parts = node.args
        case ast.Call(
            ast.Name("where"), [ast.Compare(left, [op], [right]), one, other], []
        ) | ast.IfExp(ast.Compare(left, [op], [right]), one, other) if isinstance(op, COMPARISONS):
            parts = [left, right, one, other]
        case ast.Name(name) if name not in IN_NUMPY:
            pass
        case ast.Constant(float() | int() as value) if not isinstance(value, bool):
            if not math.isfinite(value):
                raise _refusal(text, "finite numbers")
        case _:
            found = short_repr(ast.get_source_segment(text.strip(), node) or "an unknown part")
            raise _refusal(
                text,
                f"arithmetic, r, pi, parameters, {', '.join(FUNCTIONS)}, min(a, b), max(a, b) and "
                f"where(r < d, a, b) only, not {found} at its character {node.col_offset + 1}",
            )
    for part in parts:
        _check(part, text)


def _refusal(text: str, wanted: str) -> InputError:
    return InputError("potential", f'must be an expression with {wanted}, got "{text}"')


def _names(tree: ast.AST) -> list[str]:
    """Every name in a tree, once, in order of appearance."""
    nodes = [node for node in ast.walk(tree) if isinstance(node, ast.Name)]
    nodes.sort(key=lambda node: (node.lineno, node.col_offset))
    return list(dict.fromkeys(node.id for node in nodes))


def _compiled(tree: ast.expr) -> str:
    """The source of an expression in a method: parameters of self, functions of numpy."""
    text = ast.unparse(tree)
    parts = {}
    for name in _names(ast.parse(text)):
        if name == "pi" or name in IN_NUMPY:
            parts[name] = ast.Attribute(ast.Name("np"), IN_NUMPY.get(name, name))
        elif name != "r":
            parts[name] = ast.Attribute(ast.Name("self"), name)
    return ast.unparse(substitute(text, **parts))
