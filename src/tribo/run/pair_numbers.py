"""Scenes of two asperites that differ in velocities and in numbers of asperites and potential."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from tribo.kernels.potential_numbers import has_plain_numbers, numbers_of
from tribo.kernels.records import ASPERITE
from tribo.model.asperite import Asperite
from tribo.model.parameters import INTERACTION, with_values
from tribo.model.surface import Surface
from tribo.run.batch import Asperites, Batch, batch_of
from tribo.run.layout import Layout
from tribo.run.pair_adapter import mobility_of, record_of
from tribo.run.pair_factors import factors_of
from tribo.run.scene_records import fill_parameters, resting_bobs
from tribo.validation import inside

VELOCITY, ASPERITE_PART = "velocity", "asperite"


class PairNumbers(NamedTuple):
    """The numbers of some members, where they differ from the scene of all.

    Attributes
    ----------
    asperites : ndarray, (members, 2), of ASPERITE
        With the slots of the scene's layout.
    charges : ndarray, (members, 2)
        Of the bobs.
    velocity : ndarray, (members, 2, 2)
        Of each surface in the laboratory, x and y.
    potential : ndarray, (members, fields)
        The numbers of the potential.
    """

    asperites: np.ndarray
    charges: np.ndarray
    velocity: np.ndarray
    potential: np.ndarray

    def of_members(self, selected: np.ndarray | slice) -> PairNumbers:
        """Those of some members."""
        return PairNumbers(*(each[selected] for each in self))

    def records(self, layout: Layout) -> np.ndarray:
        """The scene of each member as the pair's loop reads it, (members,)."""
        mobility = mobility_of(layout, self.asperites)
        return record_of(self.asperites, layout.depths, self.charges, mobility)

    def factors(self, layout: Layout) -> tuple[np.ndarray, np.ndarray]:
        """Those of :func:`tribo.run.pair_factors.factors_of`, for each member."""
        return factors_of(layout, self.asperites, mobility_of(layout, self.asperites))


def are_pair_numbers(layout: Layout, keys: Iterable[str]) -> bool:
    """Whether members of a pair may differ in these numbers, by their dotted keys."""
    potential = layout.model.contacts[0].potential
    known = {f"{name}.{VELOCITY}" for name in layout.parts}
    if has_plain_numbers(potential):
        known |= {f"{INTERACTION}.{name}" for name in potential._fields}
    parts = tuple(f"{name}.{ASPERITE_PART}." for name in layout.parts)
    return all(key in known or key.startswith(parts) for key in keys)


def pair_numbers(layout: Layout, members: int, values: Mapping[str, np.ndarray]) -> PairNumbers:
    """The numbers of members.

    Parameters
    ----------
    layout : Layout
        Of the scene of all.
    members : int
        How many there are.
    values : mapping
        Key -> (members, 1), of a velocity (members, 2).

    Raises
    ------
    InputError
        A number cannot be used.
    """
    asperites = np.tile(np.asarray(layout.asperites).view(ASPERITE), (members, 1))
    charges, velocity = np.empty((members, 2)), np.empty((members, 2, 2))
    for i, surface in enumerate(layout.scene.surfaces):
        each = _parameters(surface, members, values)
        bobs = np.broadcast_to(resting_bobs(layout.scene, i), (members, 3))
        fill_parameters(asperites[:, i], surface, each, bobs)
        charges[:, i] = each["charge"]
        velocity[:, i] = values.get(f"{surface.name}.{VELOCITY}", surface.velocity)
    asperites["vx"] = velocity[..., 0] - velocity[:, :1, 0]
    asperites["vy"] = velocity[..., 1] - velocity[:, :1, 1]
    return PairNumbers(asperites, charges, velocity, _potentials(layout, members, values))


def _parameters(
    surface: Surface, members: int, values: Mapping[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """Every parameter of the asperite of a surface, (members,)."""
    before = f"{surface.name}.{ASPERITE_PART}."
    own = {key.removeprefix(before): v[:, 0] for key, v in values.items() if key.startswith(before)}
    one = surface.asperite.for_each(1)
    common = Asperite(*(float(one[each.name][0]) for each in fields(Asperite)))
    with inside(before[:-1]):
        return replace(common, **own).for_each(members)


def _potentials(layout: Layout, members: int, values: Mapping[str, np.ndarray]) -> np.ndarray:
    """The numbers of the potential, (members, fields)."""
    potential = layout.model.contacts[0].potential
    table = np.tile(np.array(numbers_of(potential), float), (members, 1))
    for key, rows in values.items():
        part, _, name = key.rpartition(".")
        if part == INTERACTION:
            for extreme in (rows.min(), rows.max()):  # a value that cannot be used is refused
                with_values(layout.scene, {key: float(extreme)})
            table[:, potential._fields.index(name)] = rows[:, 0]
    return table


@dataclass(frozen=True, eq=False)
class LayoutOfMembers(Layout):
    """The layout of members that differ in numbers, as the ledger reads it.

    Parameters of asperites have a row for each time and member, as the samples have.

    Attributes
    ----------
    numbers : PairNumbers
        Of the members.
    """

    numbers: PairNumbers = field(kw_only=True)

    @classmethod
    def of(cls, layout: Layout, numbers: PairNumbers) -> LayoutOfMembers:
        """The layout of members of a scene."""
        known = {each.name: getattr(layout, each.name) for each in fields(Layout)}
        return cls(**known, numbers=numbers)

    def of_members(self, selected: np.ndarray) -> LayoutOfMembers:
        """That of some of the members."""
        return LayoutOfMembers.of(self, self.numbers.of_members(selected))

    @cached_property
    def together(self) -> Batch:
        """The asperites of all surfaces."""
        one = batch_of(self.asperites, self.surfaces, self.velocity)
        own = {
            name: self._rows(self.numbers.asperites[name])
            for name, each in vars(one.asperites).items()
            if each.dtype.kind == "f"
        }
        velocity = np.moveaxis(self._rows(self.numbers.velocity), 2, 0)
        return replace(one, asperites=Asperites(**vars(one.asperites) | own), velocity=velocity)

    def velocity_of(self, index: int) -> tuple[float | np.ndarray, ...]:
        """The initial velocity of a surface in each row of samples: x and y."""
        return tuple(self._rows(self.numbers.velocity[:, index]).T)

    def mass_of(self, index: int) -> float | np.ndarray:
        """The mass of a surface in each row of samples."""
        return self._rows(self.numbers.asperites["mass"][:, index])

    def _rows(self, each: np.ndarray) -> np.ndarray:
        """A row for each time and member, from one for each member."""
        return np.tile(each, (self.times.size, *np.ones(each.ndim - 1, int)))
