"""Any ASE calculator as the contact between surfaces, live: each bob an atom.

The calculator is asked for all bobs, and for each surface's bobs alone; the difference is the
contact between the surfaces, many-body terms included.  It runs at its own cost, at every
evaluation of the forces.

Units are ASE's: lengths in Angstrom, energies in eV, masses in atomic mass units; then times are
in Angstrom sqrt(amu / eV), which is ASE's own unit of time, 10.18 fs.

A. H. Larsen et al., J. Phys.: Condens. Matter 29 (2017) 273002.
"""

from __future__ import annotations

import ctypes
import importlib
import math
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from tribo.validation import NOT_NEGATIVE, POSITIVE, InputError, known_keys, number, short_repr


@dataclass(frozen=True, eq=False)
class Live:
    """An ASE calculator as the contact between surfaces; the bobs' species are its elements.

    `length` is that over which its force changes, by which no step jumps an encounter; 0 takes
    the scale of the distance itself.  From `reach` on there is no force: a periodic scene needs
    one of at most half the box.
    """

    calculator: Any  # an ase.calculators.calculator.Calculator
    length: float = 0.0  # [Angstrom]
    reach: float = math.inf  # [Angstrom]
    arguments: dict[str, Any] = field(default_factory=dict)  # that the calculator was made with

    def __post_init__(self) -> None:
        if not callable(getattr(self.calculator, "get_potential_energy", None)):
            raise InputError(
                "calculator", f"must be one of ASE's, got {short_repr(self.calculator)}"
            )
        object.__setattr__(self, "length", number("length", self.length, NOT_NEGATIVE))
        if self.reach != math.inf:
            object.__setattr__(self, "reach", number("reach", self.reach, POSITIVE))

    def range(self) -> float:
        """Distance from which there is no force."""
        return self.reach

    def smoothness(self) -> float:
        """How many derivatives are continuous: what is not known is taken to be smooth."""
        return math.inf


class ZeroForce(NamedTuple):
    """No force: lets time loops watch the encounters of bobs whose force comes from outside."""

    length: float  # [length]
    reach: float  # [length]

    def energy(self, r):
        """Nothing."""
        return 0.0 * r

    def force(self, r):
        """Nothing."""
        return 0.0 * r

    def feature(self):
        """As the calculator's; without a length, the force changes on the scale of r itself."""
        return self.length, self.reach if self.length > 0.0 else 0.0

    def range(self):
        """As the calculator's."""
        return self.reach


def live(calculator: Any, length: float = 0.0, reach: float = math.inf, **arguments: Any) -> Live:
    """A calculator, or the ``module:Class`` of one and the arguments to make it with."""
    instance = made(calculator, arguments)
    if not isinstance(calculator, str):
        arguments = dict(getattr(calculator, "parameters", {}))
    return Live(instance, length, reach, arguments)


def made(calculator: Any, arguments: dict[str, Any]) -> Any:
    """A calculator as it is, or that of a class named by its module, with its arguments."""
    if not isinstance(calculator, str):
        if not callable(getattr(calculator, "get_potential_energy", None)):
            raise InputError("calculator", f"must be one of ASE's, got {short_repr(calculator)}")
        if arguments:
            name = next(iter(arguments))
            raise InputError(name, "cannot go with a calculator that is made already")
        return calculator
    name = calculator
    if ":" not in name:
        raise InputError(
            "calculator",
            f'must be "module:Class", as "ase.calculators.emt:EMT", got {short_repr(name)}',
        )
    module, _, cls = name.partition(":")
    try:
        return getattr(importlib.import_module(module), cls)(**arguments)
    except Exception as error:
        raise InputError(
            "calculator", f"{name} cannot be made ({type(error).__name__}: {error})"
        ) from None


def from_table(table: dict[str, Any]) -> Live:
    """The calculator that a table of a scene file describes."""
    table = known_keys(table, ["calculator", "arguments", "length", "reach"], ["calculator"])
    name, arguments = table.pop("calculator"), table.pop("arguments", {})
    if not isinstance(name, str):
        raise InputError("calculator", f'must be "module:Class", got {short_repr(name)}')
    if not isinstance(arguments, dict):
        raise InputError("arguments", f"must be a table, got {short_repr(arguments)}")
    return live(name, **table, **arguments)


def as_table(value: Live) -> dict[str, Any]:
    """What `from_table` reads."""
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
    """The names of species, which must be those of chemical elements."""
    from ase.data import atomic_numbers

    for name in names:
        if atomic_numbers.get(name, 0) == 0:
            raise InputError(
                "potential",
                f'needs the bobs\' species to be elements, as "Cu", got {short_repr(name)}',
            )
    return names


class Call:
    """What compiled code calls: the calculator on given bobs, all less each surface alone."""

    def __init__(
        self,
        calculator: Any,
        symbols: list[str],
        z: np.ndarray,
        counts: list[int],
        period: tuple[float, float],
    ) -> None:
        """`symbols` and `z` are the bobs', surface after surface; period 0 is none."""
        from ase import Atoms

        self.place = np.zeros((z.size, 2))
        self.force = np.zeros((z.size, 2))
        self.energy = np.zeros(1)
        self.error: Exception | None = None
        self.interrupted = False
        self._z = z
        cell = [period[0], 0.0, period[1]]
        whole = Atoms(symbols, np.zeros((z.size, 3)), cell=cell, pbc=[side > 0.0 for side in cell])
        stops = np.cumsum(counts).tolist()
        self._parts = [slice(n - count, n) for n, count in zip(stops, counts, strict=True)]
        self._calculator = calculator
        self._atoms = [whole, *(whole[part] for part in self._parts)]
        self._known = np.full_like(self.place, np.nan)
        self._function = ctypes.CFUNCTYPE(None)(self._called)
        self.address = ctypes.cast(self._function, ctypes.c_void_p).value or 0

    def _called(self) -> None:
        """Fill in force and energy; what goes wrong is kept, since nothing can be raised here."""
        if np.array_equal(self._known, self.place):
            return
        try:
            try:
                self._compute()
            except KeyboardInterrupt:  # the state of the run must stay whole
                self.interrupted = True
                self._compute()
        except Exception as error:
            self.error = error
            self.force[:] = np.nan
            self.energy[:] = np.nan
            return
        self._known[:] = self.place

    def _compute(self) -> None:
        positions = np.column_stack([self.place, self._z])
        self.energy[:] = 0.0
        self.force[:] = 0.0
        everyone = slice(0, self._z.size)
        for atoms, part in zip(self._atoms, [everyone, *self._parts], strict=True):
            sign = 1.0 if atoms is self._atoms[0] else -1.0
            atoms.positions = positions[part]
            self.energy[0] += sign * self._calculator.get_potential_energy(atoms)
            self.force[part] += sign * self._calculator.get_forces(atoms)[:, :2]
