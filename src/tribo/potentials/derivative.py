"""Symbolic derivatives of expressions, and of energies whose class defines no force.

An energy is differentiated from its source if that is a formula: assignments to names, ``if`` and
return, with arithmetic, functions of numpy or math, ``abs``, and a choice between two values by
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
# Functions that take a number without its sign.
MAGNITUDES = ("abs", "absolute", "fabs")
# Functions whose derivative is infinite at zero, where a choice of zero may put their argument.
SINGULAR = ("log", "sqrt")


class NoFormulaError(Exception):
    """Source that has no symbolic derivative here, or an energy that is no formula."""


class Rules:
    """The rules of differentiation of expressions by a variable."""

    where = "where"  # the name of np.where in derivatives

    def __init__(self, variable: str) -> None:
        self.variable = variable
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
                own = name == self.variable
                return ast.Constant(1) if own else ast.Name(self.derivatives[name])
            case ast.UnaryOp(ast.USub() | ast.UAdd() as op, operand):
                return ast.UnaryOp(op, self.derivative(operand))
            case ast.Call(function, [u], []) if _name(function) in FUNCTIONS:
                argument = self._inside(u) if _name(function) in SINGULAR else u
                return multiply(_of_function(function, argument), self.derivative(u))
            case ast.Call(function, [u, v], []) if _name(function) in CHOICES:
                test = ast.Compare(u, [CHOICES[_name(function)]()], [v])
                return self._choice(test, self.derivative(u), self.derivative(v))
            case ast.Call(function, [u], []) if _name(function) in MAGNITUDES:
                test = ast.Compare(u, [ast.Gt()], [ast.Constant(0.0)])
                slope = self.derivative(u)
                return self._choice(test, slope, ast.UnaryOp(ast.USub(), slope))
            case ast.Call(function, [test, u, v], []) if _name(function) == "where":
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
                return add(first, self._of_inverse(u, v))
            case ast.BinOp(u, ast.Add() | ast.Sub() as op, v):
                return add(self.derivative(u), self.derivative(v), op)
        raise NoFormulaError

    def _of_inverse(self, u: ast.expr, v: ast.expr) -> ast.expr:
        """What the change of v adds to the derivative of u / v.

        That of a power of w is n (u / w ** n) / w.  No square of v occurs, which would overflow
        or underflow where u / v does not.
        """
        match v:
            case ast.BinOp(w, ast.Pow(), n) if not self.varies(n):
                return multiply(substitute("-(n*(u/v))/w", n=n, u=u, v=v, w=w), self.derivative(w))
        slope = self.derivative(v)
        if isinstance(slope, ast.Constant):
            return multiply(substitute("-(u/v)/v", u=u, v=v), slope)
        return substitute("-(u/v)*(slope/v)", u=u, v=v, slope=slope)

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
        """The derivative of u ** v; an exponent that is a number is lowered by one here."""
        less: ast.expr = substitute("v - 1", v=v)
        base = self._inside(u)
        if isinstance(v, ast.Constant) and isinstance(v.value, (int, float)):
            less = ast.Constant(v.value - 1)
            base = u if v.value >= 1 else base
        slope = substitute("v*u**w", u=base, v=v, w=less)
        first = multiply(slope, self.derivative(u))
        return add(first, multiply(substitute("u**v*log(u)", u=u, v=v), self.derivative(v)))


def _of_function(function: ast.expr, u: ast.expr) -> ast.expr:
    """The derivative of a function at u, with functions of the same library."""
    rule = ast.parse(FUNCTIONS[_name(function)], mode="eval").body
    if isinstance(function, ast.Attribute):
        for node in ast.walk(rule):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                node.func = ast.Attribute(function.value, node.func.id, ast.Load())
    return substitute(rule, u=u)


def _name(function: ast.expr) -> str:
    """The name of a function, without that of its library; empty if it has none."""
    return getattr(function, "id", getattr(function, "attr", ""))


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


def substitute(pattern: str | ast.expr, /, **parts: ast.expr) -> ast.expr:
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


def factors_of(energy: FunctionType) -> tuple[str, ...]:
    """The fields of which energy(self, r) is a multiple, by its source; none if that is unknown."""
    try:
        definition = _source(energy)
    except (NoFormulaError, OSError, TypeError, SyntaxError, ValueError, AttributeError):
        return ()
    returned = [node for node in ast.walk(definition) if isinstance(node, ast.Return)]
    if len(returned) != 1 or returned[0] is not definition.body[-1] or not definition.args.args:
        return ()
    return tuple(dict.fromkeys(factors_in(returned[0].value, definition.args.args[0].arg)))


def factors_in(node: ast.expr | None, owner: str) -> list[str]:
    """The attributes of a name that multiply an expression."""
    match node:
        case ast.Attribute(ast.Name(name), attribute) if name == owner:
            return [attribute]
        case ast.UnaryOp(ast.USub() | ast.UAdd(), operand):
            return factors_in(operand, owner)
        case ast.BinOp(u, ast.Mult(), v):
            return factors_in(u, owner) + factors_in(v, owner)
        case ast.BinOp(u, ast.Div(), _):
            return factors_in(u, owner)
    return []


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
    """The code of all functions within some code, at any depth."""
    inner = [item for item in code.co_consts if isinstance(item, CodeType)]
    found = list(inner)
    for part in inner:
        found += _codes(part)
    return found


def _force(definition: ast.FunctionDef, energy: FunctionType) -> FunctionType:
    """The force, compiled from the derivative of the definition of the energy."""
    arguments = [argument.arg for argument in definition.args.args]
    if len(arguments) != 2 or len(arguments) != energy.__code__.co_argcount:
        raise NoFormulaError
    body = Statements(arguments, energy.__globals__).slopes(definition.body)
    head = ", ".join(arguments)
    where = Statements.where
    tree = ast.parse(f"def make({where}):\n    def force({head}): pass\n    return force")
    tree.body[0].body[0].body = body  # type: ignore[attr-defined]
    made: dict[str, Callable[..., FunctionType]] = {}
    code = compile(ast.unparse(ast.fix_missing_locations(tree)), "<force>", "exec")
    exec(code, energy.__globals__, made)  # names that follow the class are found when it runs
    force = made["make"](np.where)
    force.__module__ = __name__
    force.__qualname__ = "force"
    return force


class Statements(Rules):
    """The rules for statements of a method of `arguments`; `names` are the globals that it sees."""

    where = "_where_of_numpy"

    def __init__(self, arguments: list[str], names: dict[str, object]) -> None:
        super().__init__(arguments[1])
        self._arguments = arguments
        self._names = names

    def slopes(self, statements: list[ast.stmt]) -> list[ast.stmt]:
        """The statements, with the derivatives of the names that they assign, or of the result."""
        body: list[ast.stmt] = []
        for statement in statements:
            match statement:
                case ast.Expr(ast.Constant(str())) | ast.Pass():
                    pass
                case ast.Assign([ast.Name(name)], value) if name not in self._arguments:
                    self._check(value)
                    slope = self.derivative(value)
                    varies = self.varies(value)
                    self.derivatives.pop(name, None)
                    if varies:
                        self.derivatives[name] = f"derivative_of_{name}"
                        if _names(slope) & {self.where, *self.chosen}:
                            self.chosen.add(self.derivatives[name])
                        body.append(_assigned(self.derivatives[name], slope))
                    body.append(_assigned(name, value))
                case ast.Return(ast.expr() as value):
                    self._check(value)
                    body.append(ast.Return(ast.UnaryOp(ast.USub(), self.derivative(value))))
                case ast.If(test, then, otherwise):
                    body.append(ast.If(test, *self._branches(then, otherwise)))
                case _:
                    raise NoFormulaError
        return body

    def _branches(self, *branches: list[ast.stmt]) -> list[list[ast.stmt]]:
        """The branches of an ``if``, which end with the derivatives of the same names."""
        before = dict(self.derivatives)
        bodies = []
        after = []
        for branch in branches:
            self.derivatives = dict(before)
            bodies.append(self.slopes(branch))
            after.append(self.derivatives)
        self.derivatives = after[0] | after[1]
        self.chosen |= set(self.derivatives.values()) - set(before.values())
        for body, own in zip(bodies, after, strict=True):
            missing = sorted(self.derivatives.keys() - own.keys())
            body += [_assigned(self.derivatives[name], ast.Constant(0.0)) for name in missing]
            body.append(ast.Pass())
        return bodies

    def _check(self, node: ast.AST) -> None:
        """Raise NoFormulaError unless every function of the variable is one of numpy or math."""
        for part in ast.walk(node):
            match part:
                case ast.Call() if not self.varies(part):
                    pass
                case ast.Call(ast.Attribute(ast.Name(name))) if self._names.get(name) in (np, math):
                    pass
                case ast.Call(ast.Name("min" | "max" | "abs" as name)) if name not in self._names:
                    pass
                case ast.BinOp(_, ast.Pow(), power) if self.varies(power):
                    raise NoFormulaError  # its derivative needs a logarithm, of an unknown library
                case ast.Call() | ast.NamedExpr() | ast.Lambda() | ast.Await():
                    raise NoFormulaError
                case ast.Yield() | ast.YieldFrom():
                    raise NoFormulaError


def _names(node: ast.AST) -> set[str]:
    return {part.id for part in ast.walk(node) if isinstance(part, ast.Name)}


def _assigned(name: str, value: ast.expr) -> ast.Assign:
    return ast.fix_missing_locations(ast.Assign([ast.Name(name, ast.Store())], value))
