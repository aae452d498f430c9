"""What a reported quantity is: the kind, the scale, the meaning and the formula of its entry."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from tribo.ledger import accounts
from tribo.ledger.accounts import OfAccounts
from tribo.ledger.forces import Has, always
from tribo.ledger.motion import Motion
from tribo.ledger.totals import AsperiteSeries, Linear, Moving

Table = Mapping[str, np.ndarray]  # quantity -> its series

# The scale of a quantity that is its own largest value.
OWN = "own"
# The units of each kind, in the scene's own units of length, time and energy.
UNITS = {
    "angle": "rad",
    "rate": "time^-1",
    "length": "length",
    "velocity": "length time^-1",
    "energy": "energy",
    "power": "energy time^-1",
    "force": "force",
    "share": "1",
    "number": "1",
}


class Role(NamedTuple):
    """What the errors of a quantity are relative to, and which scales are its largest values.

    A quantity of the default role has a scale of its own: it changes no bound of another one.
    """

    scale: str = OWN  # of its errors: a field of `tribo.accuracy.scales.Scales`, or OWN
    measures: tuple[str, ...] = ()  # scales that are at least its largest value


OWN_SCALE = Role()
ANGLE = Role("angle")
RATE = Role("rate", ("rate",))
LENGTH = Role("length")
VELOCITY = Role("velocity")
# A work or pseudowork, and a heat or change of energy, of an asperite.
WORK = Role("energy", ("energy", "work"))
CHANGE = Role("energy", ("energy",))
# An energy by which no others are measured: a swing's is no change.
ENERGY = Role("energy")
# A work, heat or change of energy of a surface or the system.
TOTAL = Role("total", ("total",))
# Work against friction, which is a part of other works.
PART = Role("total")
# The energy of contacts, whose origin is arbitrary.
POTENTIAL = Role("total", ("potential",))


class Summary(NamedTuple):
    """How a quantity stands in the summary of a result."""

    heading: str  # above it in a notebook's table
    form: str = ""  # format of its value in the text; without one the text leaves it out


@dataclass(frozen=True)
class Quantity:
    """An entry of the tables of quantities: what it is, how it is computed, when it is present."""

    kind: str  # a key of `UNITS`
    long_name: str  # its meaning in a few words
    of: Callable[..., np.ndarray]  # its series, from some asperites, a surface or the system
    present: Has = always  # whether it can be asked for
    role: Role = OWN_SCALE
    # The sum of terms of accounts whose rounding it has; None where it is no such sum.
    terms: OfAccounts | None = None
    is_summed: bool = False  # whether ensembles keep its sum over the asperites of a surface
    summary: Summary | None = None  # None: results do not show it in their summary

    @property
    def units(self) -> str:
        """The units of its kind."""
        return UNITS[self.kind]


def moving(
    kind: str, long_name: str, value: Callable[[Motion], np.ndarray], role: Role = OWN_SCALE
) -> Quantity:
    """A quantity of the motion alone, which needs no accounts."""
    return Quantity(kind, long_name, Moving(value), role=role)


def accounted(
    terms: OfAccounts,
    long_name: str,
    present: Has = always,
    role: Role = WORK,
    is_summed: bool = False,
) -> Quantity:
    """An energy of each asperite that is linear in the accounts of forces."""
    of = Linear(partial(AsperiteSeries.accounted, quantity=terms))
    return energy(long_name, of, present, role, terms=terms, is_summed=is_summed)


def works_of(agents: Mapping[str, str], present: Has = always) -> dict[str, Quantity]:
    """The works of agents, and behind them the pseudoworks but those of single ends."""
    works: dict[str, Quantity] = {}
    pseudoworks: dict[str, Quantity] = {}
    for name, agent in agents.items():
        is_total = name not in accounts.FORCES
        forces = tuple(accounts.FORCES) if is_total else (name,)
        work = OfAccounts(forces, accounts.WORK)
        pseudowork = OfAccounts(forces, accounts.PSEUDOWORK)
        works[name] = accounted(work, f"work of {agent}", present, is_summed=not is_total)
        if name not in ("wL", "wR"):
            pseudoworks[f"{name}_ps"] = accounted(pseudowork, f"pseudowork of {agent}", present)
    return works | pseudoworks


def energy(
    long_name: str,
    of: Callable[..., np.ndarray],
    present: Has = always,
    role: Role = OWN_SCALE,
    **others: Any,
) -> Quantity:
    """A quantity with the unit of an energy; `others` are further fields of its entry."""
    return Quantity("energy", long_name, of, present, role, **others)
