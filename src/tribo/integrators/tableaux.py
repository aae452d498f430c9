"""Coefficients of explicit Runge-Kutta methods, and how the tables of long ones are read.

Sources.  midpoint: C. Runge, Math. Ann. 46 (1895) 167.  classical: W. Kutta, Z. Math. Phys. 46
(1901) 435.  DOP853, eighth order with embedded fifth and third: E. Hairer, S. P. Norsett,
G. Wanner, Solving Ordinary Differential Equations I, 2nd ed., Springer 1993, section II.10, with
the digits of their program.
"""

import json
from pathlib import Path

import numpy as np

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
