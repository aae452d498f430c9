"""The part of a layout by which a ledger reads the raw samples of runs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from tribo.layout.member_numbers import MemberNumbers
from tribo.layout.span import Asperites, Span, span_of, spans_of


@dataclass(frozen=True, eq=False)
class LedgerView:
    """Where samples have coordinates and accounts, and with which masses and velocities.

    Members that differ in numbers have a row of these for each time and member, as the samples.
    """

    asperites: Any  # recarray of ASPERITE, with the slots of samples
    surfaces: Any  # recarray of SURFACE, the same
    lanes: Any  # recarray of ASPERITE: lanes with the sums of accounts, or None
    velocities: np.ndarray  # (surfaces, 2) at the start, in the laboratory
    parts: dict[str, slice]  # surface -> slice of its asperites
    core: int  # number of the asperites' coordinates, before those of baths
    columns: np.ndarray  # (n,) column of each asperite in tables of the kernels
    origin: np.ndarray  # (2,) the point that positions are relative to, in the laboratory
    fields: tuple[int, ...]  # slots of the works of moving fields
    numbers: MemberNumbers | None = None
    times: int = 1  # of each member

    def with_numbers(self, numbers: MemberNumbers, times: int) -> LedgerView:
        """The view of members with numbers of their own, at so many times."""
        return replace(self, numbers=numbers, times=times)

    def of_members(self, selected: np.ndarray) -> LedgerView:
        """That of some of the members."""
        if self.numbers is None:
            return self
        return replace(self, numbers=self.numbers.of_members(selected))

    @cached_property
    def together(self) -> Span:
        """The asperites of all surfaces."""
        mine = self.asperites.surface
        one = span_of(self.asperites, self.surfaces, self.velocities[mine])
        if self.numbers is None:
            return one
        own = {
            name: self._rows(self.numbers.asperites[name])
            for name, each in vars(one.asperites).items()
            if each.dtype.kind == "f"
        }
        velocity = np.moveaxis(self._rows(self.numbers.velocity[:, mine]), 2, 0)
        return replace(one, asperites=Asperites(**vars(one.asperites) | own), velocity=velocity)

    @cached_property
    def spans(self) -> tuple[tuple[Span, ...], ...]:
        """The asperites of each surface."""
        return tuple(spans_of(self.together, part) for part in self.parts.values())

    @cached_property
    def accounted(self) -> Span:
        """Those that have the accounts: all asperites, or lanes that stand for their sums."""
        if self.lanes is None:
            return self.together
        return span_of(self.lanes, self.surfaces, self.velocities[self.lanes.surface])

    @cached_property
    def accounted_parts(self) -> tuple[slice, ...]:
        """The place of each surface in `accounted`."""
        counts = self.surfaces.account_stride
        stops = np.cumsum(counts)
        return tuple(map(slice, (stops - counts).tolist(), stops.tolist()))

    @cached_property
    def accounted_spans(self) -> tuple[tuple[Span, ...], ...]:
        """Those of each surface that have the accounts."""
        if self.lanes is None:
            return self.spans
        return tuple(spans_of(self.accounted, part) for part in self.accounted_parts)

    def velocity_of(self, index: int) -> tuple[float | np.ndarray, ...]:
        """The initial velocity of a surface, in the laboratory: x and y."""
        if self.numbers is None:
            return tuple(self.velocities[index].tolist())
        return tuple(self._rows(self.numbers.velocity[:, index]).T)

    def mass_of(self, index: int) -> float | np.ndarray:
        """The mass of a surface and its bath."""
        record = self.surfaces[index]
        if self.numbers is None:
            return float(record.total_mass)
        own = self.numbers.asperites["mass"][:, list(self.parts.values())[index]].sum(axis=1)
        return self._rows(own + (record.total_mass - record.mass))

    def _rows(self, each: np.ndarray) -> np.ndarray:
        """A row for each time and member, from one for each member."""
        return np.tile(each, (self.times, *np.ones(each.ndim - 1, int)))
