"""Coefficients of all methods but splittings.

Sources.  midpoint: C. Runge, Math. Ann. 46 (1895) 167.  classical: W. Kutta, Z. Math. Phys. 46
(1901) 435.  DOP853, eighth order with embedded fifth and third: E. Hairer, S. P. Norsett,
G. Wanner, Solving Ordinary Differential Equations I, 2nd ed., Springer 1993, section II.10, with
the digits of their program.

RKN8(6)9FM and RKN12(10)17M: J. R. Dormand, M. E. A. El-Mikkawy, P. J. Prince, High-order embedded
Runge-Kutta-Nystrom formulae, IMA J. Numer. Anal. 7 (1987) 423; their rational numbers, rounded.
Both have b_i = v_i (1 - c_i), for the weights of the embedded formulae too.

`derivation` computes the other coefficients of these, and those of collocation methods.
"""

import numpy as np

from tribo.integrators.coefficient_files import read, stages
from tribo.integrators.collocation import Collocation
from tribo.integrators.nystrom import Nystrom
from tribo.integrators.runge_kutta import RungeKutta

MIDPOINT = RungeKutta(stages([], [0.5]), np.array([0.0, 1.0]), np.array([0.0, 0.5]))

CLASSICAL = RungeKutta(
    stages([], [0.5], [0.0, 0.5], [0.0, 0.0, 1.0]),
    np.array([1 / 6, 1 / 3, 1 / 3, 1 / 6]),
    np.array([0.0, 0.5, 0.5, 1.0]),
)

_TABLE = read("dop853")
DOP853 = RungeKutta(_TABLE["a"], _TABLE["b"], _TABLE["c"], _TABLE["e5"], _TABLE["e3"])


def _nystrom(name: str, order: float) -> Nystrom:
    """A method from the files of its coefficients."""
    table = read(name)
    a = table["a"]
    v = table["v"]
    c = table["c"]
    error = table["error"]
    stages = c.size
    counts = (v != 0.0) | (error[:stages] != 0.0)
    return Nystrom(
        a=a,
        b=v * (1.0 - c),
        v=v,
        c=c,
        r=read(f"{name}-velocities")["r"],
        with_power=np.flatnonzero(counts)[1:],
        eb=error[:stages] * (1.0 - c),
        ev=error,
        order=order,
    )


def _collocation(name: str) -> Collocation:
    """A method from the file of its coefficients."""
    table = read(name)
    return Collocation(
        c=table["c"],
        r=table["r"],
        a=table["a"],
        v=table["v"],
        b=table["b"],
        pole=table["pole"],
        last=table["last"],
        order=float(table["c"].size),
    )


RKN8 = _nystrom("rkn8", 7.0)
RKN12 = _nystrom("rkn12", 11.0)
GAUSS_8 = _collocation("gauss-8")
RADAU_15 = _collocation("gauss-radau-15")
