"""Symbolic derivatives of expressions, and of energies whose class defines no force.

An energy is differentiated from its source if that is a formula: assignments to names, ``if`` and
return, with arithmetic, functions of numpy or math, and a choice between two values by
``np.where``, ``min``, ``max`` or a conditional expression.  Other energies are differentiated by a
complex step, which costs several times as much and allows no comparison of r.
"""

import ast
import linecache
import math
from collections.abc import Callable
from types import CodeType, FunctionType

import numpy as np

OPERATORS = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.Pow)
# The functions that can be differentiated, and their derivatives at the argument u.
FUNCTIONS = {
    "exp": "exp(u)",
    "log": "1/u",
    "sqrt": "0.5/sqrt(u)",
    "sin": "cos(u)",
    "cos": "-sin(u)",
    "tan": "1/cos(u)**2",
    "sinh": "cosh(u)",
    "cosh": "sinh(u)",
    "tanh": "1/cosh(u)**2",
}
# Functions that choose between two values, and the comparison by which they take the first one.
CHOICES: dict[str, type[ast.cmpop]] = {
    "max": ast.Gt,
    "maximum": ast.Gt,
    "min": ast.Lt,
    "minimum": ast.Lt,
}
# Functions whose derivative is infinite at zero, where a choice of zero may put their argument.
SINGULAR = ("log", "sqrt")
# The name of np.where in the force that is made from an energy.
WHERE = "_where_of_numpy"


class NoFormulaError(Exception):
    """Source that has no symbolic derivative here."""


class Rules:
    """The rules of differentiation by a variable; `where` is numpy's in derivatives."""

    def __init__(self, variable: str, where: str = "where") -> None:
        self.variable = variable
        self.where = where
        # The derivatives, by name, that are zero for one choice between two values.
        self.chosen: set[str] = set()
        # The name of the derivative of each name that depends on the variable.
        self.derivatives: dict[str, str] = {}

    def varies(self, node: ast.expr) -> bool:
        """Whether an expression depends on the variable, other than by a jump (a comparison)."""
        if isinstance(node, ast.Compare):
            return False
        if isinstance(node, ast.Name):
            return node.id == self.variable or node.id in self.derivatives
        return any(self.varies(part) for part in ast.iter_child_nodes(node))  # type: ignore[arg-type]

    def derivative(self, node: ast.expr) -> ast.expr:
        """The derivative of an expression, as an expression."""
        if not self.varies(node):
            return ast.Constant(0)
        match node:
            case ast.Name(name):
                return (
                    ast.Constant(1) if name == self.variable else ast.Name(self.derivatives[name])
                )
            case ast.UnaryOp(ast.USub() | ast.UAdd() as op, operand):
                return ast.UnaryOp(op, self.derivative(operand))
            case ast.Call(ast.Name() | ast.Attribute() as function, [u], []):
                argument = self._inside(u) if _name(function) in SINGULAR else u
                return multiply(_of_function(function, argument), self.derivative(u))
            case ast.Call(ast.Name() | ast.Attribute() as function, [u, v], []):
                if _name(function) not in CHOICES:
                    raise NoFormulaError
                test = ast.Compare(u, [CHOICES[_name(function)]()], [v])
                return self._choice(test, self.derivative(u), self.derivative(v))
            case ast.Call(ast.Name() | ast.Attribute() as function, [test, u, v], []):
                if _name(function) != "where":
                    raise NoFormulaError
                return self._choice(test, self.derivative(u), self.derivative(v))
            case ast.IfExp(test, u, v):
                return ast.IfExp(test, self.derivative(u), self.derivative(v))
            case ast.BinOp(u, ast.Pow(), v):
                return self._of_power(u, v)
            case ast.BinOp(u, ast.Mult(), v):
                return add(multiply(self.derivative(u), v), multiply(u, self.derivative(v)))
            case ast.BinOp(u, ast.Div(), v):
                first: ast.expr = ast.Constant(0)
                if self.varies(u):
                    first = substitute("u/v", u=self.derivative(u), v=v)
                second = multiply(substitute("-(u/v)/v", u=u, v=v), self.derivative(v))
                return add(first, second)
            case ast.BinOp(u, ast.Add() | ast.Sub() as op, v):
                return add(self.derivative(u), self.derivative(v), op)
        raise NoFormulaError

    def _choice(self, test: ast.expr, u: ast.expr, v: ast.expr) -> ast.expr:
        """One of two values, both of them floats."""
        parts = [
            ast.Constant(float(x.value))
            if isinstance(x, ast.Constant) and isinstance(x.value, (int, float))
            else x
            for x in (u, v)
        ]
        return ast.Call(ast.Name(self.where), [test, *parts], [])

    def _inside(self, u: ast.expr) -> ast.expr:
        """The argument u of an infinite slope, or 1 where the derivative of u is zero.

        The square root of max(1 - r, 0) has an infinite slope beyond r = 1, to be multiplied by 0.
        """
        inner = self.derivative(u)
        if not _names(inner) & {self.where, *self.chosen}:
            return u
        test = ast.Compare(inner, [ast.Eq()], [ast.Constant(0.0)])
        return self._choice(test, ast.Constant(1.0), u)

    def _of_power(self, u: ast.expr, v: ast.expr) -> ast.expr:
        less: ast.expr = substitute("v - 1", v=v)
        base = self._inside(u)
        if isinstance(v, ast.Constant) and isinstance(v.value, (int, float)):
            less = ast.Constant(v.value - 1)
            base = u if v.value >= 1 else base
        slope = substitute("v*u**w", u=base, v=v, w=less)
        first = multiply(slope, self.derivative(u))
        return add(first, multiply(substitute("u**v*log(u)", u=u, v=v), self.derivative(v)))


def _of_function(function: ast.Name | ast.Attribute, u: ast.expr) -> ast.expr:
    """The derivative of a function at u, with functions of the same library."""
    name = _name(function)
    if name not in FUNCTIONS:
        raise NoFormulaError
    rule = ast.parse(FUNCTIONS[name], mode="eval").body
    if isinstance(function, ast.Attribute):
        for node in ast.walk(rule):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                node.func = ast.Attribute(function.value, node.func.id, ast.Load())
    return substitute(rule, u=u)


def _name(function: ast.Name | ast.Attribute) -> str:
    return function.id if isinstance(function, ast.Name) else function.attr


def multiply(u: ast.expr, v: ast.expr) -> ast.expr:
    """u v, without factors of one and terms of zero."""
    for one, other in ((u, v), (v, u)):
        if isinstance(one, ast.Constant) and one.value in (0, 1):
            return other if one.value == 1 else one
    return ast.BinOp(u, ast.Mult(), v)


def add(u: ast.expr, v: ast.expr, op: ast.operator | None = None) -> ast.expr:
    """u + v, or u - v, without terms of zero."""
    op = op or ast.Add()
    if isinstance(v, ast.Constant) and v.value == 0:
        return u
    if isinstance(u, ast.Constant) and u.value == 0:
        return v if isinstance(op, ast.Add) else ast.UnaryOp(ast.USub(), v)
    return ast.BinOp(u, op, v)


def substitute(pattern: str | ast.expr, **parts: ast.expr) -> ast.expr:
    """The expression of a pattern, its names replaced by other expressions."""

    class Fill(ast.NodeTransformer):
        def visit_Name(self, node: ast.Name) -> ast.expr:
            return parts.get(node.id, node)

    tree = ast.parse(pattern, mode="eval").body if isinstance(pattern, str) else pattern
    result: ast.expr = Fill().visit(tree)
    return result


def force_from(energy: FunctionType) -> FunctionType | None:
    """force(self, r) = -dU/dr from the source of energy(self, r); None if that is no formula."""
    try:
        tree = _source(energy)
        return _force(tree, energy)
    except (NoFormulaError, OSError, TypeError, SyntaxError, ValueError):
        return None


def _source(function: FunctionType) -> ast.FunctionDef:
    """The definition of a function, if its file still holds the source of its code."""
    code = function.__code__
    text = "".join(linecache.getlines(code.co_filename))
    if code not in _codes(compile(text, code.co_filename, "exec", dont_inherit=True)):
        raise NoFormulaError
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef) and node.lineno == code.co_firstlineno:
            return node
    raise NoFormulaError


def _codes(code: CodeType) -> list[CodeType]:
    """All code objects inside a code object."""
    inner = [item for item in code.co_consts if isinstance(item, CodeType)]
    return inner + [item for part in inner for item in _codes(part)]


def _force(definition: ast.FunctionDef, energy: FunctionType) -> FunctionType:
    """The force, compiled from the derivative of the definition of the energy."""
    arguments = [argument.arg for argument in definition.args.args]
    if len(arguments) != 2 or len(definition.args.args) != energy.__code__.co_argcount:
        raise NoFormulaError
    rules = Rules(arguments[1], WHERE)
    body = _slopes(definition.body, rules, arguments, energy.__globals__)
    head = ", ".join(arguments)
    tree = ast.parse(f"def make({WHERE}):\n    def force({head}): pass\n    return force")
    tree.body[0].body[0].body = body  # type: ignore[attr-defined]
    made: dict[str, Callable[..., FunctionType]] = {}
    code = compile(ast.unparse(ast.fix_missing_locations(tree)), "<force>", "exec")
    exec(code, energy.__globals__, made)  # names that follow the class are found when it runs
    force = made["make"](np.where)
    force.__module__, force.__qualname__ = __name__, "force"
    return force


def _slopes(
    statements: list[ast.stmt], rules: Rules, arguments: list[str], names: dict[str, object]
) -> list[ast.stmt]:
    """The statements, each with the derivative of the name that it assigns, or of its result."""
    body: list[ast.stmt] = []
    for statement in statements:
        match statement:
            case ast.Expr(ast.Constant(str())) | ast.Pass():
                pass
            case ast.Assign([ast.Name(name)], value) if name not in arguments:
                _check(value, rules, names)
                slope = rules.derivative(value)
                varies = rules.varies(value)
                rules.derivatives.pop(name, None)
                if varies:
                    rules.derivatives[name] = f"derivative_of_{name}"
                    if not rules.chosen.isdisjoint(_names(slope)) or rules.where in _names(slope):
                        rules.chosen.add(rules.derivatives[name])
                    body.append(_assigned(rules.derivatives[name], slope))
                body.append(_assigned(name, value))
            case ast.Return(ast.expr() as value):
                _check(value, rules, names)
                slope = rules.derivative(value)
                body.append(ast.Return(ast.UnaryOp(ast.USub(), slope)))
            case ast.If(test, then, otherwise):
                body.append(_branches(test, (then, otherwise), rules, arguments, names))
            case _:
                raise NoFormulaError
    return body


def _branches(
    test: ast.expr,
    branches: tuple[list[ast.stmt], list[ast.stmt]],
    rules: Rules,
    arguments: list[str],
    names: dict[str, object],
) -> ast.If:
    """An ``if`` whose branches end with the derivatives of the same names."""
    before = dict(rules.derivatives)
    bodies, after = [], []
    for branch in branches:
        rules.derivatives = dict(before)
        bodies.append(_slopes(branch, rules, arguments, names))
        after.append(rules.derivatives)
    rules.derivatives = after[0] | after[1]
    rules.chosen |= set(rules.derivatives.values()) - set(before.values())
    for body, own in zip(bodies, after, strict=True):
        zero = ast.Constant(0.0)
        missing = rules.derivatives.keys() - own.keys()
        body += [_assigned(rules.derivatives[name], zero) for name in sorted(missing)]
        body.append(ast.Pass())
    return ast.If(test, *bodies)


def _names(node: ast.AST) -> set[str]:
    """Every name in an expression."""
    return {part.id for part in ast.walk(node) if isinstance(part, ast.Name)}


def _assigned(name: str, value: ast.expr) -> ast.Assign:
    return ast.fix_missing_locations(ast.Assign([ast.Name(name, ast.Store())], value))


def _check(node: ast.AST, rules: Rules, names: dict[str, object]) -> None:
    """Raise NoFormulaError unless every function of the variable is one of numpy or math."""
    for part in ast.walk(node):
        if isinstance(part, ast.Call) and rules.varies(part):
            match part.func:
                case ast.Attribute(ast.Name(library)) if names.get(library) in (np, math):
                    pass
                case ast.Name("min" | "max" as name) if name not in names:
                    pass
                case _:
                    raise NoFormulaError
        if (
            isinstance(part, ast.BinOp)
            and isinstance(part.op, ast.Pow)
            and rules.varies(part.right)
        ):
            raise NoFormulaError  # its derivative needs a logarithm, of an unknown library
        if isinstance(part, (ast.NamedExpr, ast.Lambda, ast.Await, ast.Yield, ast.YieldFrom)):
            raise NoFormulaError
