"""Derivatives of formulae, term by term: of expressions, and of energies that come without a force.

An energy of one's own is differentiated from its source if that is a formula: assignments to names
and a return, with arithmetic and functions of numpy or math.  Any other is left to the complex
step, which costs several times as much.
"""

from __future__ import annotations

import ast
import linecache
import math
from collections.abc import Callable
from types import CodeType, FunctionType
from typing import Any

import numpy as np

OPERATORS = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.Pow)
FUNCTIONS = {  # and what each is differentiated to; u stands for its argument
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
    """Something that the rules here do not cover."""


class Rules:
    """The rules, for a variable and for the names that depend on it."""

    def __init__(self, variable: str) -> None:
        self.variable = variable
        self.rates: dict[str, str] = {}  # of each name that depends on it, the name of its rate

    def moves(self, node: ast.expr) -> bool:
        """Whether an expression depends on the variable; comparisons do so only by jumps."""
        if isinstance(node, ast.Compare):
            return False
        if isinstance(node, ast.Name):
            return node.id == self.variable or node.id in self.rates
        return any(self.moves(part) for part in ast.iter_child_nodes(node))  # type: ignore[arg-type]

    def derivative(self, node: ast.expr) -> ast.expr:
        """The derivative of an expression, as another."""
        if not self.moves(node):
            return ast.Constant(0)
        match node:
            case ast.Name(name):
                return ast.Constant(1) if name == self.variable else ast.Name(self.rates[name])
            case ast.UnaryOp(ast.USub() | ast.UAdd() as op, operand):
                return ast.UnaryOp(op, self.derivative(operand))
            case ast.Call(ast.Name() | ast.Attribute() as function, [u], []):
                return product(_of_function(function, u), self.derivative(u))
            case ast.BinOp(u, ast.Pow(), v):
                return self._of_power(u, v)
            case ast.BinOp(u, ast.Mult(), v):
                return total(product(self.derivative(u), v), product(u, self.derivative(v)))
            case ast.BinOp(u, ast.Div(), v):
                first: ast.expr = ast.Constant(0)
                if self.moves(u):
                    first = filled("u/v", u=self.derivative(u), v=v)
                second = product(filled("-(u/v)/v", u=u, v=v), self.derivative(v))
                return total(first, second)
            case ast.BinOp(u, ast.Add() | ast.Sub() as op, v):
                return total(self.derivative(u), self.derivative(v), op)
        raise NoFormulaError

    def _of_power(self, u: ast.expr, v: ast.expr) -> ast.expr:
        less: ast.expr = filled("v - 1", v=v)
        if isinstance(v, ast.Constant) and isinstance(v.value, (int, float)):
            less = ast.Constant(v.value - 1)
        base = product(filled("v*u**w", u=u, v=v, w=less), self.derivative(u))
        return total(base, product(filled("u**v*log(u)", u=u, v=v), self.derivative(v)))


def _of_function(function: ast.Name | ast.Attribute, u: ast.expr) -> ast.expr:
    """The derivative of a function at u, by functions from where it is from."""
    name = function.id if isinstance(function, ast.Name) else function.attr
    if name not in FUNCTIONS:
        raise NoFormulaError
    rule = ast.parse(FUNCTIONS[name], mode="eval").body
    if isinstance(function, ast.Attribute):
        for node in ast.walk(rule):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                node.func = ast.Attribute(function.value, node.func.id, ast.Load())
    return filled(rule, u=u)


def product(u: ast.expr, v: ast.expr) -> ast.expr:
    """u v, without factors of one and terms of zero."""
    for one, other in ((u, v), (v, u)):
        if isinstance(one, ast.Constant) and one.value in (0, 1):
            return other if one.value == 1 else one
    return ast.BinOp(u, ast.Mult(), v)


def total(u: ast.expr, v: ast.expr, op: ast.operator | None = None) -> ast.expr:
    """u + v, or u - v, without terms of zero."""
    op = op or ast.Add()
    if isinstance(v, ast.Constant) and v.value == 0:
        return u
    if isinstance(u, ast.Constant) and u.value == 0:
        return v if isinstance(op, ast.Add) else ast.UnaryOp(ast.USub(), v)
    return ast.BinOp(u, op, v)


def filled(pattern: str | ast.expr, **parts: ast.expr) -> ast.expr:
    """The expression of a pattern, with others in the places of its names."""

    class Fill(ast.NodeTransformer):
        def visit_Name(self, node: ast.Name) -> ast.expr:
            return parts.get(node.id, node)

    tree = ast.parse(pattern, mode="eval").body if isinstance(pattern, str) else pattern
    result: ast.expr = Fill().visit(tree)
    return result


def force_from(energy: Callable[..., Any]) -> Callable[..., Any] | None:
    """force(self, r) = -dU/dr from the source of energy(self, r), or None if that is no formula."""
    try:
        tree = _source(energy)
        return _force(tree, energy)
    except (NoFormulaError, OSError, TypeError, SyntaxError, ValueError):
        return None


def _source(function: Any) -> ast.FunctionDef:
    """The definition of a function, if its file still has what the function was made from."""
    code = function.__code__
    text = "".join(linecache.getlines(code.co_filename))
    if code not in _codes(compile(text, code.co_filename, "exec", dont_inherit=True)):
        raise NoFormulaError
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef) and node.lineno == code.co_firstlineno:
            return node
    raise NoFormulaError


def _codes(code: CodeType) -> list[CodeType]:
    """All code within some."""
    inner = [item for item in code.co_consts if isinstance(item, CodeType)]
    return inner + [item for part in inner for item in _codes(part)]


def _force(definition: ast.FunctionDef, energy: Any) -> Callable[..., Any]:
    """The function that the derivative of a definition is compiled to."""
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
                moves = rules.moves(value)
                rules.rates.pop(name, None)
                if moves:
                    rules.rates[name] = f"rate_of_{name}"
                    body.append(_assigned(rules.rates[name], slope))
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


def _check(node: ast.AST, rules: Rules, names: dict[str, Any]) -> None:
    """That every function of the variable in an expression is one of numpy or math."""
    for part in ast.walk(node):
        if isinstance(part, ast.Call) and rules.moves(part):
            match part.func:
                case ast.Attribute(ast.Name(library)) if names.get(library) in (np, math):
                    pass
                case _:
                    raise NoFormulaError
        if isinstance(part, ast.BinOp) and isinstance(part.op, ast.Pow) and rules.moves(part.right):
            raise NoFormulaError  # whose derivative has a logarithm, from a library unknown
        if isinstance(part, (ast.NamedExpr, ast.Lambda, ast.Await, ast.Yield, ast.YieldFrom)):
            raise NoFormulaError
