"""Potentials written out a second time: energies in numpy, forces by a complex step.

energy = energy_of(table)       # a table as in a scene file
energy(r, q)                    # distances, products of the charges
force(energy, r, q)             # -dU/dr to round-off, without a formula of its own
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

Energy = Callable[[np.ndarray, np.ndarray], np.ndarray]

# A step along the imaginary axis, whose square vanishes in double precision [length].
STEP = 1e-30
PLUGINS = "support.mixed.plugins:"


def _mie(p: dict, r: np.ndarray) -> np.ndarray:
    n = p["n"]
    m = p["m"]
    scale = n / (n - m) * (n / m) ** (m / (n - m)) * p["epsilon"]
    return scale * ((p["sigma"] / r) ** n - (p["sigma"] / r) ** m)


def _jones(p: dict, r: np.ndarray) -> np.ndarray:
    six = (p["sigma"] / r) ** 6
    return 4.0 * p["epsilon"] * (six * six - six)


def _inside(r: np.ndarray, reach: float, energy: np.ndarray) -> np.ndarray:
    """An energy that ends at a distance."""
    return np.where(np.real(r) < reach, energy, 0.0)


def _morse(p: dict, r: np.ndarray) -> np.ndarray:
    x = np.exp(-p["alpha"] * (r - p["r0"]))
    return p["D"] * (x * x - 2.0 * x)


def _hertz(p: dict, r: np.ndarray) -> np.ndarray:
    depth = np.where(np.real(r) < p["d"], 1.0 - r / p["d"], 0.0)
    return p["A"] * depth**2 * np.sqrt(depth)


# The energy of each potential without charges, or between charges of 1.
FORMULAE: dict[str, Callable[[dict, np.ndarray], np.ndarray]] = {
    "coulomb": lambda p, r: p["strength"] / r,
    "yukawa": lambda p, r: p["strength"] * np.exp(-p["screening"] * r) / r,
    "plummer": lambda p, r: p["strength"] / np.sqrt(r * r + p["softening"] ** 2),
    "morse": _morse,
    "lennard-jones": _jones,
    "weeks-chandler-andersen": lambda p, r: _inside(
        r, 2.0 ** (1.0 / 6.0) * p["sigma"], _jones(p, r) + p["epsilon"]
    ),
    "mie": _mie,
    "born-mayer": lambda p, r: p["A"] * np.exp(-r / p["rho"]),
    "buckingham": lambda p, r: p["A"] * np.exp(-r / p["rho"]) - p["C"] / r**6,
    "hertz": _hertz,
    "soft-sphere": lambda p, r: p["epsilon"] * (p["sigma"] / r) ** p["n"],
    "gaussian": lambda p, r: p["height"] * np.exp(-r * r / (2.0 * p["width"] ** 2)),
    f"{PLUGINS}Cap": lambda p, r: _inside(r, p["d"], p["A"] * (1.0 - r / p["d"]) ** 3),
    f"{PLUGINS}Dimple": lambda p, r: -p["depth"] / (1.0 + (r / p["width"]) ** 2) ** 2,
}
CHARGED = ("coulomb", "yukawa", "plummer")
# Distances at which potentials end by themselves.
REACHES: dict[str, Callable[[dict], float]] = {
    "weeks-chandler-andersen": lambda p: 2.0 ** (1.0 / 6.0) * p["sigma"],
    "hertz": lambda p: p["d"],
    f"{PLUGINS}Cap": lambda p: p["d"],
    "table": lambda p: p["r"][-1],
}
EXPRESSION = {name: getattr(np, name) for name in ("exp", "log", "sqrt", "sin", "cos", "tanh")}


def energy_of(table: dict[str, Any]) -> Energy:
    """The energy of a potential with its cutoff."""
    whole = _without_cutoff(table)
    cutoff = table.get("cutoff")
    how = table.get("at_cutoff", "switch")
    if cutoff is None:
        return whole
    start = table.get("switch_from", 0.9 * cutoff)

    def cut(r: np.ndarray, q: np.ndarray) -> np.ndarray:
        """The energy of a pair with the cutoff in the given way."""
        value = whole(r, q)
        if how == "switch":
            u = np.where(np.real(r) > start, (r - start) / (cutoff - start), 0.0)
            value = value * (1.0 - 10.0 * u**3 + 15.0 * u**4 - 6.0 * u**5)
        elif how in ("shift", "force-shift"):
            at = np.full(np.shape(q), cutoff)
            value = value - whole(at, q)
            if how == "force-shift":
                value = value + (r - cutoff) * force(whole, at, q)
        return _inside(r, cutoff, value)

    return cut


def _without_cutoff(table: dict[str, Any]) -> Energy:
    """The energy of a table's potential, which also takes complex distances."""
    kind = table["potential"]
    if kind == "sum":
        parts = [energy_of(part) for part in table["of"]]
        return lambda r, q: sum(part(r, q) for part in parts)
    if kind == "scaled":
        part = energy_of(table["of"])
        factor = table["factor"]
        return lambda r, q: factor * part(r, q)
    if kind == "table":
        spline = CubicSpline(table["r"], table["energy"])
        return lambda r, q: _inside(r, table["r"][-1], _analytic(spline, r))
    if kind in CHARGED:
        return lambda r, q: q * FORMULAE[kind](table, r)
    if kind in FORMULAE:
        return lambda r, q: FORMULAE[kind](table, r)
    code = compile(kind, "expression", "eval")
    return lambda r, q: eval(code, {"__builtins__": {}}, EXPRESSION | table | {"r": r})


def _analytic(spline: CubicSpline, r: np.ndarray) -> np.ndarray:
    """A spline at a complex distance near the real axis, to first order."""
    return spline(np.real(r)) + 1j * np.imag(r) * spline(np.real(r), 1) + 0.0 * r


def force(energy: Energy, r: np.ndarray, q: np.ndarray) -> np.ndarray:
    """-dU/dr at real distances."""
    return -np.imag(energy(r + 1j * STEP, q)) / STEP
