"""Methods of the user's own, from their coefficients: explicit Runge-Kutta, and compositions.

The coefficients of a Runge-Kutta method are checked against the conditions of order, tree by tree:
E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, II.2.
"""

import hashlib
import re
from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np

from tribo.integrators.coefficient_files import stages
from tribo.integrators.methods import COMPOSITION, FIRST_LEVELS, METHODS, Method
from tribo.integrators.runge_kutta import RungeKutta
from tribo.integrators.splitting import composed
from tribo.validation import InputError, is_list, must_be, vector

# The highest order whose conditions are checked: 486 trees.
HIGHEST_ORDER = 9
# Largest residual of a condition, for coefficients with twelve digits.
RESIDUAL = 1e-11

# A tree with a root, as the tuple of its branches.
Tree = tuple[Any, ...]


def add_method(
    name: str,
    order: int,
    *,
    a: Sequence[Sequence[float]] | None = None,
    b: Sequence[float] | None = None,
    embedded: Sequence[float] | None = None,
    weights: Sequence[float] | None = None,
    use: str = "one of the user's own",
    source: str = "the user",
) -> None:
    """Add a method of one's own, which ``method=name`` then names in this process.

    Either an explicit Runge-Kutta method, from its tableau `a` and `b`, or a composition of
    leapfrog steps, from their `weights`.

    Parameters
    ----------
    name : str
        Lower-case letters, digits and hyphens.
    order : int
        The order of convergence.
    a : sequence of rows, optional
        Row i has the weights of the stages before stage i, so that the first row is empty.  The
        nodes are the sums of the rows.
    b : (stages,) array, optional
        The weights of the step.
    embedded : (stages,) array, optional
        The weights of a second formula of lower order, which estimates the error of a step; with
        them steps are adaptive, else equal.
    weights : (n,) array, optional
        The lengths of the leapfrog steps, in units of the step: a palindrome whose sum is 1.
    use, source : str
        What it is good for, and where it was published.

    Raises
    ------
    InputError
        If the name is that of another method, the coefficients cannot be used, or they are not of
        this order.  The order of a composition beyond the sums of powers is not checked.
    """
    if not isinstance(name, str) or not re.fullmatch("[a-z0-9-]+", name):
        raise must_be("name", "lower-case letters, digits and hyphens", name)
    texts: dict[str, Any] = {"use": use, "source": source, "own": True}
    if weights is not None:
        if a is not None or b is not None or embedded is not None:
            raise InputError("weights", "cannot go with a tableau; give one or the other")
        method = Method(name, order, _composition(weights, order), **texts, **COMPOSITION)
    elif a is None or b is None:
        raise InputError("a" if a is None else "b", "is missing; give a and b, or weights")
    else:
        tableau = _tableau(a, b, embedded, order)
        adaptive = embedded is not None
        texts |= {"adaptive": adaptive, "smoothness": 0 if adaptive else min(order - 1, 2)}
        if not adaptive:
            texts["first_level"] = FIRST_LEVELS[order > 2]
        method = Method(name, order, tableau, **texts)
    known = METHODS.get(name)
    if known is not None and digest(known) != digest(method):
        raise InputError("name", f'is that of another method, "{name}"; give another one')
    METHODS[name] = method


def digest(method: Method) -> str:
    """The hash of the order and the coefficients of a method."""
    content = hashlib.sha256(repr(method.order).encode())
    for each in method.coefficients:
        content.update(np.asarray(np.nan if each is None else each, float).tobytes())
    return content.hexdigest()[:16]


def coefficients_of(name: str) -> dict[str, object]:
    """The digest of a method that a user added, by which runs differ; nothing of others."""
    method = METHODS.get(name)
    return {} if method is None or not method.own else {"coefficients": digest(method)}


def _composition(weights: Sequence[float], order: int) -> Any:
    """The steps of a palindrome of weights, if it can have the order.  Raises InputError."""
    values = vector("weights", weights)
    if values.size % 2 == 0 or np.max(np.abs(values - values[::-1])) > RESIDUAL:
        raise must_be("weights", "a palindrome of an odd number of steps", values.tolist())
    if order < 2 or order % 2:
        raise must_be("order", "even, as that of every palindrome", order)
    for power in range(1, order, 2):  # necessary conditions
        wanted = 1.0 if power == 1 else 0.0
        found = float(np.sum(values**power))
        if abs(found - wanted) > RESIDUAL:
            what = "sum" if power == 1 else f"sum of powers of {power}"
            wish = f"with a {what} of {wanted:g} for order {order}"
            raise InputError("weights", f"must be numbers {wish}, got {found:.3g}")
    return composed(*values[: (values.size + 1) // 2].tolist())


def _tableau(a: Any, b: Any, embedded: Any, order: int) -> RungeKutta:
    """The tableau with the stated order, and what tells its errors.  Raises InputError."""
    weights = vector("b", b)
    if not is_list(a) or len(a) != weights.size:
        raise must_be("a", f"a list of {weights.size} rows, one a stage", a)
    rows = [vector(f"a[{i}]", row).tolist() if len(row) else [] for i, row in enumerate(a)]
    for i, row in enumerate(rows):
        if any(row[i:]):
            raise must_be(f"a[{i}]", f"{i} weights, of the stages before it", row)
    matrix = stages(*(row[:i] for i, row in enumerate(rows)))
    found = _order_of(matrix, weights)
    if order != found:
        raise must_be("order", f"{found}, that of these coefficients", order)
    tableau = RungeKutta(matrix, weights, matrix.sum(axis=1))
    if embedded is None:
        return tableau
    other = vector("embedded", embedded, size=weights.size)
    lower = _order_of(matrix, other)
    if not 0 < lower < found:
        raise must_be("embedded", f"of an order below {found}, not of order {lower}", embedded)
    return tableau._replace(e5=weights - other, e3=np.zeros(weights.size), order=lower + 1.0)


def _order_of(a: np.ndarray, b: np.ndarray) -> int:
    """The order up to which all conditions hold; 0 if the weights are not consistent."""
    for order in range(1, HIGHEST_ORDER + 1):
        for tree in trees(order):
            at_stages, density, _ = _values(tree, a)
            if abs(float(b @ at_stages) - 1.0 / density) > RESIDUAL:
                return order - 1
    return HIGHEST_ORDER


def _values(tree: Tree, a: np.ndarray) -> tuple[np.ndarray, float, int]:
    """What the stages make of a tree, the density of the tree, and its number of nodes."""
    at_stages = np.ones(len(a))
    density = 1.0
    nodes = 1
    for branch in tree:
        own, of_branch, count = _values(branch, a)
        at_stages = at_stages * (a @ own)
        density *= of_branch
        nodes += count
    return at_stages, density * nodes, nodes


@cache
def trees(nodes: int) -> tuple[Tree, ...]:
    """The trees with so many nodes."""
    return tuple(_forests(nodes - 1, nodes - 1, 0))


def _forests(nodes: int, largest: int, first: int) -> list[Tree]:
    """Several trees with so many nodes in all, the largest first: from the `first` of that size."""
    if nodes == 0:
        return [()]
    found: list[Tree] = []
    for size in range(min(largest, nodes), 0, -1):
        begin = first if size == largest else 0
        for place, tree in enumerate(trees(size)[begin:], begin):
            found += [(tree, *rest) for rest in _forests(nodes - size, size, place)]
    return found
