"""Interactions between the bobs of surfaces, and the periods of a scene."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tribo import validation as check
from tribo.potentials import tables
from tribo.potentials.from_ase import Live
from tribo.potentials.potential import as_potential
from tribo.validation import InputError, is_list, known_keys, must_be


@dataclass(frozen=True)
class Periodic:
    """The periods of a scene; None along a direction in which it is not periodic.

    Attributes
    ----------
    x, z : float, optional
        Period along x and along z [length].  A cutoff must be at most half a period.
    """

    x: float | None = None
    z: float | None = None

    def __post_init__(self) -> None:
        check.fields(self, **dict.fromkeys("xz", check.one(check.POSITIVE, "length")))

    def __bool__(self) -> bool:
        return self.x is not None or self.z is not None


@dataclass(frozen=True)
class Interaction:
    """A potential between the bobs of two surfaces.

    Attributes
    ----------
    potential : Potential or NamedTuple
        A potential of :mod:`tribo.potentials`, or a user's own.
    between : (str, str), optional
        Names of the two surfaces; None for all pairs. The same name twice means contact among the
        bobs of one surface, which is internal to it.
    species : (str, str), optional
        The two species of bobs between which the potential acts; None for all.

    Raises
    ------
    InputError
        If the potential cannot be used, or a name is missing.
    """

    potential: Any
    between: tuple[str, str] | None = None
    species: tuple[str, str] | None = None

    @property
    def calculator(self) -> Live | None:
        """The ASE calculator that takes the place of a potential, if one does."""
        return self.potential if isinstance(self.potential, Live) else None

    def __post_init__(self) -> None:
        """Check the potential, and that surfaces and species are two names each."""
        put = object.__setattr__
        if not isinstance(self.potential, Live):
            put(self, "potential", as_potential(self.potential))
        elif self.species is not None:
            raise InputError(
                "species", "cannot go with a calculator, which takes the elements of the bobs"
            )
        elif self.between is not None and self.between[0] == self.between[1]:
            raise must_be("between", "two different surfaces for a calculator", self.between)
        for key, kind in (("between", "surfaces"), ("species", "species")):
            names = getattr(self, key)
            if names is None:
                continue
            if not is_list(names) or len(names) != 2 or not all(isinstance(n, str) for n in names):
                raise must_be(key, f"the names of two {kind}", names)
            put(self, key, tuple(names))


def as_interaction(value: object) -> Interaction:
    """An interaction from its table in a scene file or from a potential, or the interaction."""
    if isinstance(value, Mapping):
        return from_table(value, Path())
    return value if isinstance(value, Interaction) else Interaction(value)


def from_table(table: Any, folder: Path) -> Interaction:
    """The interaction that a table of a scene file describes."""
    parameters = known_keys(table, table)
    between = parameters.pop("between", None)
    species = parameters.pop("species", None)
    return Interaction(tables.from_table(parameters, folder), between, species)
