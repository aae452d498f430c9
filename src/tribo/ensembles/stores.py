"""Where the members of an ensemble go while they are computed."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, Protocol

from tribo.ensembles.kept_values import Kept, KeptValues, Tally, kept_dataset
from tribo.ensembles.members import Members
from tribo.kernels.status import Status
from tribo.model.identity import Identity
from tribo.prepared import Simulation

if TYPE_CHECKING:
    import xarray

# Attributes of a data set.
Attributes = dict[str, str | float]


@dataclass(frozen=True)
class About:
    """What is known of an ensemble before its members are run.

    Attributes
    ----------
    simulation : Simulation
        Of its scene.
    kept : Kept
        What is kept of each member.
    count : int
        Of members.
    attributes : dict
        Of the data set.
    """

    simulation: Simulation
    kept: Kept
    count: int
    attributes: Attributes

    @property
    def common_level(self) -> float:
        """The level of most members; NaN where each has its own settings."""
        return float(self.attributes.get("level", "nan"))

    def attributes_at_end(self, tally: Tally, interrupted: bool, seconds: float) -> Attributes:
        """All attributes, once the runs have ended."""
        status = Status.INTERRUPTED if interrupted else Status.COMPLETED
        return {
            **self.attributes,
            "status": str(status),
            "members": json.dumps(tally.status),
            "notes": json.dumps(tally.notes),
            "seconds": seconds,
        }


class Target(NamedTuple):
    """The files of an ensemble that is written.

    Attributes
    ----------
    path : Path
        The file once it is complete.
    part : Path
        The file until then.
    identity : dict
        What tells the ensemble from others.
    """

    path: Path
    part: Path
    identity: Identity


class Store(Protocol):
    """Takes members in the order of their numbers.

    Attributes
    ----------
    done : int
        Members that it has, from 0 on.
    """

    done: int

    def add(self, members: Members, found: KeptValues) -> None:
        """Take in the next members."""

    def dataset(self, interrupted: bool, seconds: float) -> xarray.Dataset:
        """The data set of all members so far.  Raises KeyboardInterrupt if there are none."""


class InMemory:
    """A store in memory; see :class:`Store`."""

    def __init__(self, about: About) -> None:
        self._about = about
        self._parts: list[tuple[Members, KeptValues]] = []
        self.done = 0

    def add(self, members: Members, found: KeptValues) -> None:
        """Take in the next members."""
        self._parts.append((members, found))
        self.done += members.numbers.size

    def dataset(self, interrupted: bool, seconds: float) -> xarray.Dataset:
        """The data set of all members so far.  Raises KeyboardInterrupt if there are none."""
        if not self._parts:
            raise KeyboardInterrupt
        about, tally = self._about, Tally()
        members = Members.joined([members for members, _ in self._parts])
        found = KeptValues.joined([found for _, found in self._parts])
        tally.add(found.status, found.level, found.error, about.common_level)
        attributes = about.attributes_at_end(tally, interrupted, seconds)
        return kept_dataset(about.kept, about.simulation, members, found, attributes)
