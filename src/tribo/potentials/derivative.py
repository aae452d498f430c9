"""Symbolic derivatives of expressions, and of energies whose class defines no force.

An energy is differentiated from its source if that is a formula: assignments to names and a
return, with arithmetic and functions of numpy or math.  Other energies are differentiated by a
complex step, which costs several times as much.
"""

from __future__ import annotations

import ast
import linecache
import math
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


class NoFormulaError(Exception):
    """Source that has no symbolic derivative here."""


class Rules:
    """The rules of differentiation by a variable, and the names that depend on it."""

    def __init__(self, variable: str) -> None:
        self.variable = variable
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
                return multiply(_of_function(function, u), self.derivative(u))
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

    def _of_power(self, u: ast.expr, v: ast.expr) -> ast.expr:
        less: ast.expr = substitute("v - 1", v=v)
        if isinstance(v, ast.Constant) and isinstance(v.value, (int, float)):
            less = ast.Constant(v.value - 1)
        base = multiply(substitute("v*u**w", u=u, v=v, w=less), self.derivative(u))
        return add(base, multiply(substitute("u**v*log(u)", u=u, v=v), self.derivative(v)))


def _of_function(function: ast.Name | ast.Attribute, u: ast.expr) -> ast.expr:
    """The derivative of a function at u, with functions of the same library."""
    name = function.id if isinstance(function, ast.Name) else function.attr
    if name not in FUNCTIONS:
        raise NoFormulaError
    rule = ast.parse(FUNCTIONS[name], mode="eval").body
    if isinstance(function, ast.Attribute):
        for node in ast.walk(rule):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                node.func = ast.Attribute(function.value, node.func.id, ast.Load())
    return substitute(rule, u=u)


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
    rules = Rules(arguments[1])
    body: list[ast.stmt] = []
    for statement in definition.body:
        match statement:
            case ast.Expr(ast.Constant(str())):
                pass
            case ast.Assign([ast.Name(name)], value) if name not in arguments:
                _check(value, rules, energy.__globals__)
                slope = rules.derivative(value)
                varies = rules.varies(value)
                rules.derivatives.pop(name, None)
                if varies:
                    rules.derivatives[name] = f"derivative_of_{name}"
                    body.append(_assigned(rules.derivatives[name], slope))
                body.append(_assigned(name, value))
            case ast.Return(ast.expr() as value) if statement is definition.body[-1]:
                _check(value, rules, energy.__globals__)
                slope = rules.derivative(value)
                body.append(ast.Return(ast.UnaryOp(ast.USub(), slope)))
            case _:
                raise NoFormulaError
    head = ", ".join(arguments)
    text = f"def force({head}):\n" + "".join(f"    {ast.unparse(line)}\n" for line in body)
    (code,) = _codes(compile(text, "<force>", "exec"))
    force = FunctionType(code, energy.__globals__, "force")
    force.__module__ = __name__
    return force


def _assigned(name: str, value: ast.expr) -> ast.Assign:
    return ast.fix_missing_locations(ast.Assign([ast.Name(name, ast.Store())], value))


def _check(node: ast.AST, rules: Rules, names: dict[str, object]) -> None:
    """Raise NoFormulaError unless every function of the variable is one of numpy or math."""
    for part in ast.walk(node):
        if isinstance(part, ast.Call) and rules.varies(part):
            match part.func:
                case ast.Attribute(ast.Name(library)) if names.get(library) in (np, math):
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
