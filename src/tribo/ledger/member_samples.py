"""The samples of many runs of one scene: a row for each time and member."""

from __future__ import annotations

from dataclasses import fields
from typing import NamedTuple

import numpy as np

from tribo.layout.layout import Layout
from tribo.layout.member_numbers import LayoutOfMembers
from tribo.ledger.reactions import add_reactions
from tribo.ledger.samples import Samples


class MemberSamples(Samples):
    """The raw samples of several runs, all members of a time together.

    Parameters
    ----------
    members : int
        How many runs there are.
    *columns : ndarray, (times x members, ...)
        As the fields of `Samples`; those of the first time are the starts of the runs.

    Attributes
    ----------
    members : int
        As given.
    """

    def __init__(self, members: int, *columns: np.ndarray) -> None:
        super().__init__(*columns)
        self.members = members

    def at_start(self, series: np.ndarray) -> np.ndarray:
        """The value of a series of these samples at the start of each member's run."""
        times = self.t.size // self.members
        return np.tile(series[: self.members], (times, *np.ones(series.ndim - 1, int)))

    def of_members(self, selected: np.ndarray) -> MemberSamples:
        """The samples of some members, by their indices or a mask."""
        rows = np.arange(self.t.size).reshape(-1, self.members)[:, selected]
        columns = (getattr(self, each.name)[rows.ravel()] for each in fields(Samples))
        return MemberSamples(rows.shape[1], *columns)


class MemberRuns(NamedTuple):
    """The runs of some members.

    Attributes
    ----------
    layout : Layout
        Of the members, by which their samples are read.
    samples : MemberSamples
        At all times.
    counts : ndarray, (members, 3)
        Columns of :mod:`tribo.pair.members`.
    """

    layout: Layout
    samples: MemberSamples
    counts: np.ndarray

    @classmethod
    def of(cls, layout: Layout, samples: MemberSamples, counts: np.ndarray) -> MemberRuns:
        """The runs with these raw samples, to which the reactions on driven bars are added."""
        if layout.model.pivots is not None:
            add_reactions(layout, samples.y, samples.s, samples.at_start(samples.y))
        return cls(layout, samples, counts)

    def of_members(self, selected: np.ndarray) -> MemberRuns:
        """The runs of some members, by their indices or a mask."""
        layout = self.layout
        if isinstance(layout, LayoutOfMembers):
            layout = layout.of_members(selected)
        return MemberRuns(layout, self.samples.of_members(selected), self.counts[selected])
