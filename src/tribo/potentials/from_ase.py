"""Any ASE calculator as the contact between surfaces: each bob is an atom.

The calculator computes the energy of all bobs, and of each surface's bobs alone.  The difference
is the contact between the surfaces, many-body terms included.  It is called at every evaluation of
the forces.

Units are ASE's: lengths in Angstrom, energies in eV, masses in atomic mass units.  Times are then
in Angstrom sqrt(amu / eV), which is ASE's unit of time, 10.18 fs.

A. H. Larsen et al., J. Phys.: Condens. Matter 29 (2017) 273002.
"""

from __future__ import annotations

import ctypes
import importlib
import math
import threading
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any
from weakref import WeakValueDictionary

import numpy as np

from tribo import validation as check
from tribo.plugins.unloaded import refuse_code
from tribo.potentials.potential import Potential
from tribo.validation import InputError, must_be

if TYPE_CHECKING:
    from ase.calculators.calculator import Calculator


@dataclass(frozen=True, eq=False)
class Live:
    """An ASE calculator as the contact between surfaces; the bobs' species are its elements.

    Attributes
    ----------
    calculator : ase.calculators.calculator.Calculator
        The calculator.
    length : float
        Length over which its force changes [Angstrom], from which steps are limited so that none
        jumps over an encounter; 0 for the distance itself.
    reach : float
        Distance from which the force is zero [Angstrom]; in a periodic scene at most half a
        period.
    arguments : dict
        The arguments with which the calculator was made, for scene files.
    """

    calculator: Calculator
    length: float = 0.0
    reach: float = math.inf
    arguments: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        _check_calculator(self.calculator)
        check.fields(self, length=check.one(check.NOT_NEGATIVE, "Angstrom"))
        if self.reach != math.inf:
            check.fields(self, reach=check.one(check.POSITIVE, "Angstrom"))

    def range(self) -> float:
        """Distance from which the force is zero."""
        return self.reach

    def range_between(self, one: float, other: float) -> float:
        """The same between two charges, of which a calculator knows nothing."""
        return self.reach

    def smoothness(self) -> float:
        """Number of continuous derivatives: unknown, and assumed infinite."""
        return math.inf


class ZeroForce(Potential):
    """No force: time loops detect by it encounters of bobs whose force a calculator computes."""

    length: float  # over which the calculator's force changes [length]; 0 for the distance itself
    reach: float  # distance from which its force is zero [length]

    def energy(self, r):
        return 0.0 * r

    def force(self, r):
        return 0.0 * r

    def feature(self):
        """The calculator's length and reach; without a length, the length is r itself."""
        return self.length, self.reach if self.length > 0.0 else 0.0

    def range(self):
        return self.reach


def from_calculator(
    calculator: Calculator | str, length: float = 0.0, reach: float = math.inf, **arguments: Any
) -> Live:
    """An ASE calculator as the contact between surfaces.

    Parameters
    ----------
    calculator : ase.calculators.calculator.Calculator or str
        A calculator, or ``module:Class`` of one, as "ase.calculators.emt:EMT".
    length : float
        Length over which its force changes [Angstrom]; 0 for the distance itself.
    reach : float
        Distance from which its force is zero [Angstrom].
    **arguments
        Arguments of the class, if `calculator` names one.

    Returns
    -------
    Live
        A potential of a scene whose bobs have elements as their species.

    Raises
    ------
    InputError
        If there is no such calculator, or a value is out of range.
    """
    instance = make_calculator(calculator, arguments)
    if not isinstance(calculator, str):
        arguments = dict(getattr(calculator, "parameters", {}))
    return Live(instance, length, reach, arguments)


def _check_calculator(value: object) -> None:
    if not callable(getattr(value, "get_potential_energy", None)):
        raise must_be("calculator", "a calculator of ASE", value)


def make_calculator(calculator: Calculator | str, arguments: dict[str, Any]) -> Calculator:
    """A calculator unchanged, or an instance of the class ``module:Class`` with its arguments."""
    if not isinstance(calculator, str):
        _check_calculator(calculator)
        if arguments:
            name = next(iter(arguments))
            raise InputError(name, 'needs a calculator given as "module:Class"')
        return calculator
    name = calculator
    if ":" not in name:
        raise must_be("calculator", '"module:Class", as "ase.calculators.emt:EMT"', name)
    refuse_code("calculator", name)
    module, _, cls = name.partition(":")
    try:
        return getattr(importlib.import_module(module), cls)(**arguments)
    except Exception as error:
        raise InputError(
            "calculator", f"{name} cannot be made ({type(error).__name__}: {error})"
        ) from None


def from_table(table: dict[str, Any]) -> Live:
    """The calculator that a table of a scene file describes."""
    table = check.known_keys(table, ["calculator", "arguments", "length", "reach"], ["calculator"])
    name = table.pop("calculator")
    arguments = table.pop("arguments", {})
    if not isinstance(arguments, dict):
        raise must_be("arguments", "a table", arguments)
    return from_calculator(name, **table, **arguments)


def as_table(value: Live) -> dict[str, Any]:
    """The table of a scene file that `from_table` reads."""
    cls = type(value.calculator)
    table: dict[str, Any] = {"calculator": f"{cls.__module__}:{cls.__qualname__}"}
    arguments = {name: item for name, item in value.arguments.items() if item is not None}
    if arguments:
        table["arguments"] = arguments
    if value.length > 0.0:
        table["length"] = value.length
    if math.isfinite(value.reach):
        table["reach"] = value.reach
    return table


def elements(names: list[str]) -> list[str]:
    """The names of species unchanged.  Raises InputError unless they are chemical elements."""
    from ase.data import atomic_numbers

    for name in names:
        if atomic_numbers.get(name, 0) == 0:
            raise InputError(
                "potential",
                f'needs elements as the species of bobs, as "Cu", got {check.short_repr(name)}',
            )
    return names


# Locks of calculators in use, by their identity.  A calculator keeps the atoms and the results of
# its last call, and cannot be copied where it holds a process or a file, so threads that run scenes
# with the same one call it in turn.
_locks: WeakValueDictionary[int, threading.Lock] = WeakValueDictionary()


class Call:
    """The calculator as compiled code calls it: all bobs minus each surface's bobs alone."""

    def __init__(
        self,
        calculator: Calculator,
        symbols: list[str],
        z: np.ndarray,
        counts: list[int],
        period: tuple[float, float],
    ) -> None:
        """Elements and z of the bobs, surface after surface; a period of 0 stands for none."""
        from ase import Atoms

        self.place = np.zeros((z.size, 2))
        self.force = np.zeros((z.size, 2))
        self.energy = np.zeros(1)
        self.error: Exception | None = None
        self.interrupted = False
        self._z = z
        cell = [period[0], 0.0, period[1]]
        atoms = Atoms(symbols, np.zeros((z.size, 3)), cell=cell, pbc=[side > 0.0 for side in cell])
        stops = np.cumsum(counts).tolist()
        parts = [slice(n - count, n) for n, count in zip(stops, counts, strict=True)]
        self._calculator = calculator
        self._lock = _locks.setdefault(id(calculator), threading.Lock())
        # All bobs, from which each surface's alone are subtracted.
        self._terms = [(1.0, slice(None), atoms), *((-1.0, part, atoms[part]) for part in parts)]
        self._known = np.full_like(self.place, np.nan)
        self._function = ctypes.CFUNCTYPE(None)(self._called)
        self.address = ctypes.cast(self._function, ctypes.c_void_p).value or 0

    @property
    def failure(self) -> str:
        """The error that the calculator raised, in words."""
        return f"{type(self.error).__name__}: {self.error}"

    def _called(self) -> None:
        """Compute force and energy; an exception is kept, since compiled code cannot raise it."""
        if np.array_equal(self._known, self.place):
            return
        try:
            try:
                self._compute()
            except KeyboardInterrupt:  # finish the step, so that the run's state stays consistent
                self.interrupted = True
                self._compute()
        except Exception as error:
            self.error = error
            self.force[:] = np.nan
            self.energy[:] = np.nan
            return
        self._known[:] = self.place

    def _compute(self) -> None:
        """Ask the calculator for the energy and the forces, term by term."""
        positions = np.column_stack([self.place, self._z])
        self.energy[:] = 0.0
        self.force[:] = 0.0
        with self._lock:
            for sign, part, atoms in self._terms:
                atoms.positions = positions[part]
                self.energy[0] += sign * self._calculator.get_potential_energy(atoms)
                self.force[part] += sign * self._calculator.get_forces(atoms)[:, :2]
