"""Two atoms of an ASE calculator as a potential: its dimer curve, and a table of it.

    U(r) = E(two atoms at r) - E(one alone) - E(the other alone)

Units are ASE's: eV and Angstrom.  A table of the curve is the calculator itself only where that
sums over pairs; how far from it three atoms are is measured before it is believed.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from tribo.potentials.from_ase import made
from tribo.potentials.spline import Table, tabulated
from tribo.validation import InputError, is_list, number, short_repr

SIDES = ((1.0, 1.0), (1.0, 1.4), (1.3, 1.3))  # of the triangles looked at, in the closest distance


def curve(calculator: Any, symbols: Any, r: Any) -> np.ndarray:
    """Energy [eV] of two atoms at each distance `r` [Angstrom] less that of each alone."""
    first, second = symbols
    alone = _energy(calculator, [first], [[0.0, 0.0, 0.0]])
    alone += _energy(calculator, [second], [[0.0, 0.0, 0.0]])
    pairs = [[[0.0, 0.0, 0.0], [x, 0.0, 0.0]] for x in np.ravel(r).tolist()]
    energies = [_energy(calculator, [first, second], pair) - alone for pair in pairs]
    return np.reshape(energies, np.shape(r))


def from_dimer(
    calculator: Any,
    symbols: Any,
    low: float,
    high: float,
    accuracy: float,
    many_body: bool = False,
    arguments: dict[str, Any] | None = None,
) -> Table:
    """A compiled table of a calculator's dimer curve from `low` to `high`, to `accuracy` [eV].

    `calculator` is one of ASE's, or the ``module:Class`` of one with its `arguments`; `symbols`
    two elements.  The curve is shifted to end at zero.  A calculator whose energy of three atoms
    is not the sum over its pairs is refused, unless `many_body` says that the table may stand for
    it all the same; what three atoms are off by is then part of the table's stated error.
    Raises InputError.
    """
    calculator = made(calculator, arguments or {})
    if not is_list(symbols) or len(symbols) != 2 or not all(isinstance(s, str) for s in symbols):
        raise InputError("symbols", f"must be two elements, got {short_repr(symbols)}")
    end = curve(calculator, symbols, number("high", high))
    table = tabulated(lambda r: curve(calculator, symbols, r) - end, low, high, accuracy)
    off = _three_body(calculator, symbols, table)
    if off <= accuracy:
        return table
    if not many_body:
        raise InputError(
            "calculator",
            f"{type(calculator).__name__} does not sum over pairs: three atoms of {symbols[0]} and "
            f"{symbols[1]} are off by {off:.1e} eV; run it live, or accept that with many_body",
        )
    return table._replace(error=table.error + off)


def _three_body(calculator: Any, symbols: Any, table: Table) -> float:
    """By how much the energies of triangles differ from the sums over their sides [eV]."""
    unit = _closest(table)
    off = 0.0
    for one, other in SIDES:
        places = np.array([[0.0, 0.0], [one, 0.0], [0.0, other]]) * unit
        for trio in ([symbols[0], *symbols], [*symbols, symbols[1]]):
            whole = _energy(calculator, trio, np.column_stack([places, np.zeros(3)]).tolist())
            parts = sum(_energy(calculator, [name], [[0.0, 0.0, 0.0]]) for name in trio)
            for i, j in ((0, 1), (0, 2), (1, 2)):
                r = float(np.hypot(*(places[i] - places[j])))
                parts += float(curve(calculator, (trio[i], trio[j]), r))
            off = max(off, abs(whole - parts))
    return off


def _closest(table: Table) -> float:
    """A distance at which bobs meet: where the energy is least, or else half way in."""
    lowest = int(np.argmin(table.values))
    if 0 < lowest < table.r.size - 1:
        return float(table.r[lowest])
    return 0.5 * float(table.r[0] + table.r[-1])


def _energy(calculator: Any, symbols: list[str], places: Any) -> float:
    """Potential energy of some atoms [eV]."""
    from ase import Atoms

    return float(calculator.get_potential_energy(Atoms(symbols, positions=places)))
