"""How coefficients that no paper prints follow from the others.

Their files are written by ``python -m tribo.integrators.derivation``: to compute them takes longer
than a first run, and a solution by least squares has other last bits on another machine.

Coefficients of collocation methods follow from the nodes by exact arithmetic.  Gauss nodes: J. C.
Butcher, Math. Comput. 18 (1964) 50.  Radau nodes that begin with 0: E. Everhart, in Dynamics of
Comets, eds. Carusi and Valsecchi, Reidel 1985, p. 185.
"""

import json
import math
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.polynomial.polynomial import polyint, polyval

from tribo.integrators.coefficient_files import path_of, read


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
    weights = v[live]
    nodes = c[live]
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


def collocation(nodes: tuple[str, ...]) -> dict[str, np.ndarray]:
    """The coefficients of the method with these nodes by name, each rounded once."""
    c = [Fraction(node) for node in nodes]
    others = [c[:j] + c[j + 1 :] for j in range(len(c))]
    poles = []
    for x, rest in zip(c, others, strict=True):
        differences = [x - y for y in rest]
        poles.append(1 / Fraction(math.prod(differences)))
    # Coefficients of Lagrange's polynomials, from the constant on.
    products: list[Any] = [np.poly(np.array(rest, object))[::-1] for rest in others]
    basis = [product * pole for product, pole in zip(products, poles, strict=True)]
    one = Fraction(1)

    def integrals(ends: list[Fraction], times: int) -> np.ndarray:
        """Integrals of the polynomials from 0 to each end, taken once or twice."""
        sums = [polyint(each, times) for each in basis]
        found = np.empty((len(ends), len(sums)))
        for i, end in enumerate(ends):
            for j, antiderivative in enumerate(sums):
                found[i, j] = float(polyval(end, antiderivative))
        return found

    return {
        "c": np.array([float(x) for x in c]),
        "r": integrals(c, 1),
        "a": integrals(c, 2),
        "v": integrals([one], 1)[0],
        "b": integrals([one], 2)[0],
        "pole": np.array([float(pole) for pole in poles]),
        "last": np.array([float(pole / len(c)) for pole in poles]),
    }


# Numbers of conditions (matched, weighed) of :func:`stage_velocities`.
CONDITIONS = {"rkn8": (5, 3), "rkn12": (7, 5)}
NODES = {"gauss-8": GAUSS, "gauss-radau-15": RADAU}


def derived() -> dict[str, dict[str, np.ndarray]]:
    """Names of files -> coefficients by name."""
    found = {name: collocation(nodes) for name, nodes in NODES.items()}
    for name, conditions in CONDITIONS.items():
        table = read(name)
        found[f"{name}-velocities"] = {"r": stage_velocities(table["v"], table["c"], *conditions)}
    return found


def main() -> None:
    """Write the files."""
    for name, table in derived().items():
        lists = {key: values.tolist() for key, values in table.items()}
        rows = (f"{json.dumps(key)}: {json.dumps(value)}" for key, value in lists.items())
        path_of(name).write_text("{\n" + ",\n".join(rows) + "\n}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
