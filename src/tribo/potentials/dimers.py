"""The dimer curve of an ASE calculator as a potential.

    U(r) = E(two atoms at r) - E(one alone) - E(the other alone)

Units are ASE's: eV and Angstrom.  A table of the curve replaces the calculator only where its
energy is a sum over pairs, which is tested on triangles of three atoms.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from tribo.potentials.from_ase import make_calculator
from tribo.potentials.spline import Table, tabulated
from tribo.validation import InputError, is_list, must_be, number

if TYPE_CHECKING:
    from ase.calculators.calculator import Calculator

# Legs of the right-angled triangles that are tested [distance of the minimum].
LEGS = ((1.0, 1.0), (1.0, 1.4), (1.3, 1.3))


def curve(calculator: Calculator, symbols: Sequence[str], r: ArrayLike) -> np.ndarray:
    """Energy of two atoms minus that of each alone [eV], at distances `r` [Angstrom]."""
    first, second = symbols
    alone = _energy(calculator, [first]) + _energy(calculator, [second])
    pairs = [[[0.0, 0.0, 0.0], [x, 0.0, 0.0]] for x in np.ravel(r).tolist()]
    energies = [_energy(calculator, [first, second], pair) - alone for pair in pairs]
    return np.reshape(energies, np.shape(r))


def from_dimer(
    calculator: Calculator | str,
    symbols: Sequence[str],
    low: float,
    high: float,
    tolerance: float,
    many_body: bool = False,
    arguments: dict[str, Any] | None = None,
) -> Table:
    """A table of a calculator's dimer curve, shifted to end at zero.

    Parameters
    ----------
    calculator : ase.calculators.calculator.Calculator or str
        A calculator of ASE, or ``module:Class`` of one.
    symbols : (str, str)
        Two elements.
    low, high : float
        Smallest and largest distance of the table [Angstrom].
    tolerance : float
        Largest error of the table [eV].
    many_body : bool
        Whether to accept a calculator whose energy of three atoms is not the sum over pairs; the
        difference is then part of the table's stated error.
    arguments : dict, optional
        Arguments of the class, if `calculator` names one.

    Raises
    ------
    InputError
        If the calculator is not a sum over pairs, or the tolerance is out of reach.
    """
    calculator = make_calculator(calculator, arguments or {})
    if not is_list(symbols) or len(symbols) != 2 or not all(isinstance(s, str) for s in symbols):
        raise must_be("symbols", "two elements", symbols)
    pair = (str(symbols[0]), str(symbols[1]))
    end = curve(calculator, pair, number("high", high, unit="Angstrom"))
    table = tabulated(lambda r: curve(calculator, pair, r) - end, low, high, tolerance)
    difference = _three_body(calculator, pair, table)
    if difference <= tolerance:
        return table
    if not many_body:
        raise InputError(
            "calculator",
            f"{type(calculator).__name__} does not sum over pairs: for three atoms of {symbols[0]} "
            f"and {symbols[1]} the sum is off by {difference:.1e} eV; use from_calculator, or "
            "accept the error with many_body",
        )
    return table._replace(error=table.error + difference)


def _three_body(calculator: Calculator, symbols: Sequence[str], table: Table) -> float:
    """Largest difference between the energy of a triangle and the sum over its sides [eV]."""
    lowest = int(np.argmin(table.values))
    largest = 0.0
    inside = 0 < lowest < table.r.size - 1
    # The distance of the minimum, or the middle of the table if there is none.
    unit = float(table.r[lowest]) if inside else 0.5 * float(table.r[0] + table.r[-1])
    for one, other in LEGS:
        places = np.array([[0.0, 0.0], [one, 0.0], [0.0, other]]) * unit
        for trio in ([symbols[0], *symbols], [*symbols, symbols[1]]):
            energy = _energy(calculator, trio, np.column_stack([places, np.zeros(3)]).tolist())
            pairs = sum(_energy(calculator, [name]) for name in trio)
            for i, j in ((0, 1), (0, 2), (1, 2)):
                r = float(np.hypot(*(places[i] - places[j])))
                pairs += float(curve(calculator, (trio[i], trio[j]), r))
            largest = max(largest, abs(energy - pairs))
    return largest


def _energy(calculator: Calculator, symbols: list[str], positions: Any = None) -> float:
    """Potential energy of some atoms [eV], by default of one at the origin."""
    from ase import Atoms

    return float(calculator.get_potential_energy(Atoms(symbols, positions=positions)))
