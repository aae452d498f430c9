"""Coefficients of Runge-Kutta-Nystrom methods, and the velocities at their stages.

Sources.  RKN8(6)9FM and RKN12(10)17M: J. R. Dormand, M. E. A. El-Mikkawy, P. J. Prince, High-order
embedded Runge-Kutta-Nystrom formulae, IMA J. Numer. Anal. 7 (1987) 423; their rational numbers,
rounded.  Both have b_i = v_i (1 - c_i), for the weights of the embedded formulae too.
"""

import numpy as np

from tribo.integrators.nystrom import Nystrom
from tribo.integrators.tableaux import read


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
