"""Coefficients of all methods but splittings, and how the tables of long ones are read.

Sources.  midpoint: C. Runge, Math. Ann. 46 (1895) 167.  classical: W. Kutta, Z. Math. Phys. 46
(1901) 435.  DOP853, eighth order with embedded fifth and third: E. Hairer, S. P. Norsett,
G. Wanner, Solving Ordinary Differential Equations I, 2nd ed., Springer 1993, section II.10, with
the digits of their program.

RKN8(6)9FM and RKN12(10)17M: J. R. Dormand, M. E. A. El-Mikkawy, P. J. Prince, High-order embedded
Runge-Kutta-Nystrom formulae, IMA J. Numer. Anal. 7 (1987) 423; their rational numbers, rounded.
Both have b_i = v_i (1 - c_i), for the weights of the embedded formulae too.

Coefficients of collocation methods follow from the nodes by exact arithmetic.  Gauss nodes: J. C.
Butcher, Math. Comput. 18 (1964) 50.  Radau nodes that begin with 0: E. Everhart, in Dynamics of
Comets, eds. Carusi and Valsecchi, Reidel 1985, p. 185.
"""

import json
import math
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.polynomial.polynomial import polyint, polyval

from tribo.integrators.collocation import Collocation
from tribo.integrators.nystrom import Nystrom
from tribo.integrators.runge_kutta import RungeKutta


def stages(*rows: list[float]) -> np.ndarray:
    """The strictly lower triangular matrix of weights (stages, stages), from its rows."""
    a = np.zeros((len(rows), len(rows)))
    for i, row in enumerate(rows):
        a[i, : len(row)] = row
    return a


def read(name: str) -> dict[str, np.ndarray]:
    """The coefficients of a method from its file, by name; "a" is (stages, stages)."""
    path = Path(__file__).parent / "coefficients" / f"{name}.json"
    table = json.loads(path.read_text(encoding="utf-8"))
    return {key: stages(*each) if key == "a" else np.array(each) for key, each in table.items()}


MIDPOINT = RungeKutta(stages([], [0.5]), np.array([0.0, 1.0]), np.array([0.0, 0.5]))

CLASSICAL = RungeKutta(
    stages([], [0.5], [0.0, 0.5], [0.0, 0.0, 1.0]),
    np.array([1 / 6, 1 / 3, 1 / 3, 1 / 6]),
    np.array([0.0, 0.5, 0.5, 1.0]),
)

_TABLE = read("dop853")
DOP853 = RungeKutta(_TABLE["a"], _TABLE["b"], _TABLE["c"], _TABLE["e5"], _TABLE["e3"])


def stage_velocities(v: np.ndarray, c: np.ndarray, matched: int, weighed: int) -> np.ndarray:
    """The matrix r (stages, stages) with which the ledger has the order p of the method.

    It is the smallest one on the stages whose weight v_i is not zero that satisfies

        sum_j r_ij P(c_j)      = int_0^c_i P        for polynomials P of degrees < `matched`,
        sum_i v_i P(c_i) r_ij  = v_j int_c_j^1 P    for polynomials P of degrees < `weighed`.

    A power is linear in the velocity.  Let coordinates at those stages, and so the forces there,
    have errors of O(h^m).  With the first set, velocities have errors of O(h^(matched + 1)) and,
    from the forces, of O(h^(m + 1)).  With the second set, both enter the ledger as errors of
    forces enter the end of the step, where the method's own order conditions cancel them.  The sets
    are compatible if `matched` + `weighed` is at most p.  They suffice if that is at least p - 1
    and `weighed` is at least p - 1 - m.  (They are J. C. Butcher's C and D, Math. Comput. 18 (1964)
    50.)
    """
    live = np.flatnonzero(v)
    n = live.size
    weights, nodes = v[live], c[live]
    upper, whole = _integrals(nodes, max(matched, weighed))
    values = np.polynomial.legendre.legvander(2.0 * nodes - 1.0, max(matched, weighed))
    one = np.eye(n)
    rows = [np.kron(one, values[:, k]) for k in range(matched)]
    right = [upper[:, k] for k in range(matched)]
    rows += [np.kron(weights * values[:, k], one) for k in range(weighed)]
    right += [weights * (whole[k] - upper[:, k]) for k in range(weighed)]
    rows.append(np.kron(one[:1], one))  # velocities at the start are known
    right.append(np.zeros(n))
    found, *_ = np.linalg.lstsq(np.concatenate(rows), np.concatenate(right), rcond=1e-10)
    r = np.zeros((c.size, c.size))
    r[np.ix_(live, live)] = found.reshape(n, n)
    return r


def _integrals(x: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Integrals from 0 to x, and to 1, of the first Legendre polynomials on (0, 1)."""
    p = np.polynomial.legendre.legvander(2.0 * x - 1.0, count + 1)
    upper = np.empty((x.size, count))
    upper[:, 0] = x
    for k in range(1, count):
        upper[:, k] = (p[:, k + 1] - p[:, k - 1]) / (2 * (2 * k + 1))
    return upper, np.eye(count)[0]


def _nystrom(name: str, order: float, velocities: tuple[int, int]) -> Nystrom:
    """A method from the file of its coefficients."""
    table = read(name)
    a, v, c, error = table["a"], table["v"], table["c"], table["error"]
    stages = c.size
    counts = (v != 0.0) | (error[:stages] != 0.0)
    return Nystrom(
        a=a,
        b=v * (1.0 - c),
        v=v,
        c=c,
        r=stage_velocities(v, c, *velocities),
        with_power=np.flatnonzero(counts)[1:],
        eb=error[:stages] * (1.0 - c),
        ev=error,
        order=order,
    )


RKN8 = _nystrom("rkn8", 7.0, (5, 3))
RKN12 = _nystrom("rkn12", 11.0, (7, 5))

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
    others = [c[:j] + c[j + 1 :] for j in range(len(c))]
    poles = [1 / Fraction(math.prod(x - y for y in r)) for x, r in zip(c, others, strict=True)]
    # Coefficients of Lagrange's polynomials, from the constant on.
    products: list[Any] = [np.poly(np.array(rest, object))[::-1] for rest in others]
    basis = [product * pole for product, pole in zip(products, poles, strict=True)]
    one = Fraction(1)

    def integrals(ends: list[Fraction], times: int) -> np.ndarray:
        """Integrals of the polynomials from 0 to each end, taken once or twice."""
        sums = [polyint(each, times) for each in basis]
        return np.array([[float(polyval(x, each)) for each in sums] for x in ends])

    return Collocation(
        c=np.array([float(x) for x in c]),
        r=integrals(c, 1),
        a=integrals(c, 2),
        v=integrals([one], 1)[0],
        b=integrals([one], 2)[0],
        pole=np.array([float(pole) for pole in poles]),
        last=np.array([float(pole / len(c)) for pole in poles]),
        order=float(len(c)),
    )


GAUSS_8 = collocation(GAUSS)
RADAU_15 = collocation(RADAU)
