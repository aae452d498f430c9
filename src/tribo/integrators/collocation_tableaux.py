"""Collocation methods: every coefficient follows from the nodes by exact arithmetic.

Sources.  Gauss nodes: J. C. Butcher, Math. Comput. 18 (1964) 50.  Radau nodes that begin with 0: E.
Everhart, in Dynamics of Comets, eds. Carusi and Valsecchi, Reidel 1985, p. 185.
"""

from fractions import Fraction

import numpy as np

from tribo.integrators.collocation import Collocation

# Zeros of the shifted Legendre polynomials P_4 and P_7 + P_8, to 33 digits, so that coefficients
# are rounded only once: scipy.special.roots_jacobi is off by up to 6 units in the last place.
GAUSS = (
    "0.069431844202973712388026755553595247",
    "0.33000947820757186759866712044837766",
    "0.66999052179242813240133287955162234",
    "0.93056815579702628761197324444640475",
)
RADAU = (
    "0",
    "0.056262560536922146465652191032311176",
    "0.18024069173689236498757994280918178",
    "0.3526247171131696373739077701712412",
    "0.54715362633055538300144855765234885",
    "0.73421017721541053152321060830661",
    "0.88532094683909576809035976293248537",
    "0.97752061356128750189117450042915494",
)


def collocation(nodes: tuple[str, ...]) -> Collocation:
    """The method with these nodes, each coefficient rounded once."""
    c = [Fraction(node) for node in nodes]
    poles = [_reciprocal(c, j) for j in range(len(c))]
    basis = [[pole * x for x in _product(c, j)] for j, pole in enumerate(poles)]
    one = Fraction(1)
    return Collocation(
        c=np.array([float(x) for x in c]),
        r=np.array([[float(_integral(p, x)) for p in basis] for x in c]),
        a=np.array([[float(_twice(p, x)) for p in basis] for x in c]),
        v=np.array([float(_integral(p, one)) for p in basis]),
        b=np.array([float(_twice(p, one)) for p in basis]),
        pole=np.array([float(pole) for pole in poles]),
        last=np.array([float(pole / len(c)) for pole in poles]),
        order=float(len(c)),
    )


def _reciprocal(c: list[Fraction], j: int) -> Fraction:
    """1 / product of c_j - c_k over all k but j."""
    product = Fraction(1)
    for k, node in enumerate(c):
        if k != j:
            product *= c[j] - node
    return 1 / product


def _product(c: list[Fraction], j: int) -> list[Fraction]:
    """Coefficients, from the constant on, of the product of x - c_k over all k but j."""
    product = [Fraction(1)]
    for k, node in enumerate(c):
        if k != j:
            higher, lower = [Fraction(0), *product], [*product, Fraction(0)]
            product = [one - node * other for one, other in zip(higher, lower, strict=True)]
    return product


def _integral(p: list[Fraction], x: Fraction) -> Fraction:
    """The integral of a polynomial from 0 to x."""
    return sum((a * x ** (k + 1) / (k + 1) for k, a in enumerate(p)), Fraction(0))


def _twice(p: list[Fraction], x: Fraction) -> Fraction:
    """The integral of its integral."""
    return sum((a * x ** (k + 2) / ((k + 1) * (k + 2)) for k, a in enumerate(p)), Fraction(0))


GAUSS_8 = collocation(GAUSS)
RADAU_15 = collocation(RADAU)
