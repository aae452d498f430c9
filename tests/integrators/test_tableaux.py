"""Coefficients against the equations that define them: all conditions of order, tree by tree.

A tree stands for an elementary differential.  What a method makes of it is, stage by stage, a
product of sums over its branches; what is exact is the same product of integrals, a monomial
in time.  E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, II.2 and
II.14.
"""

from functools import cache
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest

from tribo.integrators import derivation, tableaux
from tribo.integrators.coefficient_files import read
from tribo.integrators.collocation import predict
from tribo.integrators.methods import METHODS

ROUND_OFF = 2e-14

EXPLICIT = {"midpoint": tableaux.MIDPOINT, "rk4": tableaux.CLASSICAL, "dop853": tableaux.DOP853}
NYSTROM = {"rkn8": tableaux.RKN8, "rkn12": tableaux.RKN12}
EMBEDDED = {"rkn8": 6, "rkn12": 10}  # orders of the formulae that errors are estimated with
COLLOCATION = {
    "gauss-8": tableaux.GAUSS_8,
    "gauss-radau-15": tableaux.RADAU_15,
}


@cache
def trees(degree, lift):
    """Trees whose exact value grows as t^degree; a branch adds `lift` to its own degree.

    For second-order equations leaves of degree 1, where a velocity enters, stand for themselves.
    """
    branches = [(d + lift, tree) for d in range(degree - lift + 1) for tree in trees(d, lift)]
    if lift == 2:
        branches.append((1, None))

    def fill(left, first):
        if left == 0:
            yield ()
        for k in range(first, len(branches)):
            weight, branch = branches[k]
            if weight <= left:
                yield from ((branch, *rest) for rest in fill(left - weight, k))

    return list(fill(degree, 0))


def values(tree, a, c, lift):
    """What the stages make of a tree, and its exact value: (stages,), factor, degree."""
    at_stages = np.ones(c.size)
    factor = 1.0
    degree = 0
    for branch in tree:
        if branch is None:
            at_stages = at_stages * c
            degree += 1
            continue
        inner, inner_factor, d = values(branch, a, c, lift)
        at_stages = at_stages * (a @ inner)
        factor *= inner_factor / ((d + 1) * (d + 2) if lift == 2 else d + 1)
        degree += d + lift
    return at_stages, factor, degree


def defects(weights, a, c, degree, lift):
    """How far the weights are from integrating every tree of that degree, over (0, 1)."""
    for tree in trees(degree, lift):
        at_stages, factor, d = values(tree, a, c, lift)
        assert d == degree
        yield weights @ at_stages - factor / (degree + 1)


def ledger_defects(tableau, degree):
    """The same for powers: trees with one more branch, a velocity at the stages."""
    a = tableau.a
    c = tableau.c
    r = tableau.r
    v = tableau.v
    for force in range(degree):
        for one in trees(force, 2):
            inner, inner_factor, _ = values(one, a, c, 2)
            for other in trees(degree - force - 1, 2):
                outer, factor, _ = values(other, a, c, 2)
                exact = factor * inner_factor / ((force + 1) * (degree + 1))
                yield v @ (outer * (r @ inner)) - exact


def worst(defects):
    """The largest."""
    return max(abs(defect) for defect in defects)


def test_numbers_of_trees():
    """As many as there are in the literature."""
    assert [len(trees(d, 1)) for d in range(8)] == [1, 1, 2, 4, 9, 20, 48, 115]
    assert [len(trees(d, 2)) for d in range(8)] == [1, 1, 2, 3, 6, 10, 20, 36]


@pytest.mark.parametrize("name", EXPLICIT)
def test_explicit_runge_kutta(name):
    """All conditions up to the order that is declared, and not all of the next."""
    t = EXPLICIT[name]
    order = METHODS[name].order
    assert np.array_equal(t.a, np.tril(t.a, -1))
    assert np.allclose(np.sum(t.a, axis=1), t.c, rtol=0.0, atol=ROUND_OFF)
    for degree in range(order):
        assert worst(defects(t.b, t.a, t.c, degree, 1)) < ROUND_OFF
    assert worst(defects(t.b, t.a, t.c, order, 1)) > 1e-8


def test_error_estimates_of_dop853():
    """Weights of the difference to a formula of lower order: what that gets right cancels."""
    t = tableaux.DOP853
    for weights, order in ((t.e5, 5), (t.e3, 3)):
        for degree in range(order + 1):
            found = max(abs(weights @ values(tree, t.a, t.c, 1)[0]) for tree in trees(degree, 1))
            assert found < ROUND_OFF if degree < order else found > 1e-5


@pytest.mark.parametrize("name", NYSTROM)
def test_nystrom(name):
    """All conditions of places and velocities up to the order, and not all of the next."""
    t = NYSTROM[name]
    order = METHODS[name].order
    assert np.array_equal(t.a, np.tril(t.a, -1))
    assert np.allclose(np.sum(t.a, axis=1), 0.5 * t.c**2, rtol=0.0, atol=ROUND_OFF)
    for degree in range(order):
        assert worst(defects(t.v, t.a, t.c, degree, 2)) < ROUND_OFF
    assert worst(defects(t.v, t.a, t.c, order, 2)) > 1e-9
    for degree in range(order - 1):
        for tree in trees(degree, 2):
            at_stages, factor, _ = values(tree, t.a, t.c, 2)
            assert abs(t.b @ at_stages - factor / ((degree + 1) * (degree + 2))) < ROUND_OFF


@pytest.mark.parametrize("name", NYSTROM)
def test_ledger_of_nystrom(name):
    """All conditions of an integral of force times velocity up to the order."""
    t = NYSTROM[name]
    order = METHODS[name].order
    for degree in range(1, order):
        assert worst(ledger_defects(t, degree)) < ROUND_OFF
    assert worst(ledger_defects(t, order)) > 1e-9
    assert np.max(np.abs(t.r[0])) < 1e-15


@pytest.mark.parametrize("name", NYSTROM)
def test_error_estimates_of_nystrom(name):
    """The end of the step is a stage: its forces come after a last row of weights."""
    t = NYSTROM[name]
    order = EMBEDDED[name]
    a = np.zeros((t.c.size + 1, t.c.size + 1))
    a[:-1, :-1] = t.a
    a[-1, :-1] = t.b
    c = np.append(t.c, 1.0)
    assert t.order == order + 1
    for degree in range(order + 1):
        found = max(abs(t.ev @ values(tree, a, c, 2)[0]) for tree in trees(degree, 2))
        assert found < ROUND_OFF if degree < order else found > 1e-8
    assert np.array_equal(t.eb, t.ev[:-1] * (1.0 - t.c))
    live = np.flatnonzero((t.v != 0.0) | (t.ev[:-1] != 0.0))
    assert np.array_equal(live, [0, *t.with_power])


@pytest.mark.parametrize("name", COLLOCATION)
def test_collocation(name):
    """Polynomials through the nodes are integrated, and at the end those of twice the degree."""
    t = COLLOCATION[name]
    order = METHODS[name].order
    nodes = t.c.size
    for k in range(nodes):
        power = t.c**k
        assert np.allclose(t.r @ power, t.c ** (k + 1) / (k + 1), rtol=0.0, atol=ROUND_OFF)
        twice = t.c ** (k + 2) / ((k + 1) * (k + 2))
        assert np.allclose(t.a @ power, twice, rtol=0.0, atol=ROUND_OFF)
        highest = 1.0 / nodes if k == nodes - 1 else 0.0
        assert t.last @ power == pytest.approx(highest, abs=1e-11)
    for k in range(order):
        assert t.v @ t.c**k == pytest.approx(1.0 / (k + 1), abs=1e-15)
    assert abs(t.v @ t.c**order - 1.0 / (order + 1)) > 1e-10
    assert np.allclose(t.b, t.v * (1.0 - t.c), rtol=0.0, atol=1e-15)


@pytest.mark.parametrize("name", COLLOCATION)
def test_nodes(name):
    """Zeros of shifted Legendre polynomials P_n, or of P_(n - 1) + P_n, to 33 digits."""
    nodes = derivation.NODES[name]
    with mpmath.workdps(50):
        for node in nodes:
            x = 2 * mpmath.mpf(node) - 1
            low, high = (mpmath.legendre(n, x) for n in (len(nodes) - 1, len(nodes)))
            assert abs(high if name == "gauss-8" else low + high) < 1e-31, node


def test_files_of_derived_coefficients():
    """They are what they were derived as; a solution by least squares has other last bits."""
    for name, table in derivation.derived().items():
        stored = read(name)
        assert stored.keys() == table.keys()
        tolerance = 1e-12 if name in ("rkn8-velocities", "rkn12-velocities") else 0.0
        for key, values in table.items():
            assert np.allclose(stored[key], values, rtol=0.0, atol=tolerance), (name, key)


@pytest.mark.parametrize("name", COLLOCATION)
@pytest.mark.parametrize("ratio", [0.3, 1.0, 2.5])
def test_polynomial_is_continued(name, ratio):
    """Into the next step, of another length, from its values at the nodes of the last."""
    t = COLLOCATION[name]
    power = t.c.size - 1
    memory = t.c[:, None] ** power * np.array([1.0, -2.0])
    values_at_nodes = np.ones_like(memory)  # the first, where it is at the start, is known
    predict.py_func(t, SimpleNamespace(last_step=0.5), ratio * 0.5, memory, values_at_nodes)
    expected = (1.0 + ratio * t.c[:, None]) ** power * np.array([1.0, -2.0])
    known = t.c == 0.0
    assert np.allclose(values_at_nodes[~known], expected[~known], rtol=1e-9)
    assert np.all(values_at_nodes[known] == 1.0)


@pytest.mark.parametrize("name", [m.name for m in METHODS.values() if m.splits])
def test_splittings(name):
    """Palindromes of drifts and kicks, which both make up a whole step."""
    drifts, kicks = METHODS[name].coefficients
    assert drifts.size == kicks.size + 1
    for parts in (drifts, kicks):
        assert np.allclose(parts, parts[::-1], rtol=0.0, atol=1e-16)
        assert np.sum(parts) == pytest.approx(1.0, abs=1e-15)
