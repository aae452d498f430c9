"""The account of every force, from the integrals that the kernels record.

`kernels/powers.py` computes the powers of forces and drives, and `kernels/accounts.py` adds them
up; `FORCES` has for each work a function that reads its account.

Kernels integrate in the frame of each surface's initial velocity V; in the laboratory
work = (about the centre of mass) + V . J + (pseudowork in that frame).
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import NamedTuple

import numpy as np

from tribo.layout.span import Span, columns

Part = np.ndarray | float  # of an account


@dataclass(frozen=True, eq=False)
class Account:
    """One force's entries; arrays (times, asperites), or 0.0 where no asperite has the force."""

    about: Part  # work about the centre of mass: the same in every frame
    jx: Part  # impulse
    jy: Part
    pseudo: Part  # pseudowork in the surface's first frame

    def pseudowork(self, velocity: np.ndarray) -> Part:
        """In the laboratory, where the surface's first velocity is `velocity` (2, asperites)."""
        return self.pseudo + self.boost(velocity)

    def boost(self, velocity: np.ndarray) -> Part:
        """The work of the impulse at the velocities of the asperites (2, asperites)."""
        return velocity[0] * self.jx + velocity[1] * self.jy

    def work(self, velocity: np.ndarray) -> Part:
        """In the laboratory."""
        return self.about + self.pseudowork(velocity)


class Accounts(dict[str, Account]):
    """The accounts of the forces on a span of one surface by their works, made when needed."""

    def __init__(self, span: Span, s: np.ndarray) -> None:
        super().__init__()
        self.span = span
        self.shape = len(s), span.held.size  # (times, asperites)
        self._s = s

    def __missing__(self, name: str) -> Account:
        account = self[name] = FORCES[name](self.span, self._s)
        return account

    def total(
        self, names: Iterable[str], part: Callable[[Account, np.ndarray], Part]
    ) -> np.ndarray:
        """The sum of a part of the accounts of some forces, (times, asperites)."""
        total: Part = 0.0
        acting = forces_with_accounts(self.span.present)
        for name in names:
            if name in acting:
                total = total + part(self[name], self.span.velocity)
        return self.whole(total)

    @property
    def swing_work(self) -> Part:
        """The work of the reservoir on the swing, a part of that of both."""
        return account_columns(self.span, "acc_swing", (0,), self._s)[0]

    def whole(self, part: Part) -> np.ndarray:
        """A part, or a sum of parts, of all asperites, (times, asperites)."""
        if isinstance(part, np.ndarray) and part.shape == self.shape:
            return part if part.base is None else part.copy()  # users may change it
        return np.full(self.shape, part)


class Integrals(dict[Span, Accounts]):
    """The integrals `s` that the kernels record, (times, accounts), by span and force."""

    def __init__(self, s: np.ndarray) -> None:
        super().__init__()
        self.s = s

    def __missing__(self, span: Span) -> Accounts:
        accounts = self[span] = Accounts(span, self.s)
        return accounts


@lru_cache
def forces_with_accounts(present: frozenset[str]) -> frozenset[str]:
    """The forces that have any of the groups of accounts, by the names of their works."""
    return frozenset([name for name, groups in GROUPS.items() if present.intersection(groups)])


def account_columns(span: Span, group: str, places: Iterable[int], s: np.ndarray) -> list[Part]:
    """Columns of a group of accounts; zeros where the group is absent."""
    if group not in span.present:
        return [0.0 for _ in places]
    slots = getattr(span.asperites, group)
    stride = span.asperites.stride
    if group in span.consecutive:  # a part of the table, ten times faster than its columns
        firsts = [int(slots[0] + k * stride[0]) for k in places]
        return [s[:, first : first + slots.size] for first in firsts]
    present = slots >= 0
    if present.all():
        return [s[:, slots + k * stride] for k in places]
    return [columns(np.where(present, slots + k * stride, -1), s) for k in places]


def _contact(span: Span, s: np.ndarray) -> Account:
    jx, jy, about_x, about_y = account_columns(span, "acc_contact", range(4), s)
    slide_x, slide_y = account_columns(span, "acc_slide", range(2), s)
    a = span.asperites
    swept = about_x + about_y
    # On driven bars the centre of mass has no velocity but that about the bar.
    about_bar = np.where(a.acc_slide < 0, a.pivot, 0.0)
    return Account(a.l1 * swept, jx, jy, slide_x + slide_y + about_bar * swept)


def _drive(span: Span, s: np.ndarray) -> Account:
    """The drive: f2 = -(held f1_x, f1_y), unless it has an account of its own."""
    a = span.asperites
    held = span.held
    jx, jy, about_x, about_y = account_columns(span, "acc_contact", range(4), s)
    slide_x, slide_y = account_columns(span, "acc_slide", range(2), s)
    own_jx, own_jy, own_about, own_pseudo = account_columns(span, "acc_drive", range(4), s)
    own = a.acc_drive >= 0
    # On driven bars the reaction does no work in the frame of the surface.
    driven = (a.pivot > 0.0) & (a.acc_slide < 0)
    own_about = np.where(driven, -own_pseudo, -a.l2 * own_about)
    return Account(
        np.where(own, own_about, a.l2 * (held * about_x + about_y)),
        np.where(own, own_jx, -held * jx),
        np.where(own, own_jy, -jy),
        np.where(own, own_pseudo, -(held * slide_x + slide_y)),
    )


def _end(about: int, user: tuple[int, ...], side: float, span: Span, s: np.ndarray) -> Account:
    """An end of the bar; a clamp exerts the opposite of its force on the left one on the right."""
    own, jx, jy, pseudo = account_columns(span, "acc_ends", (about, 2, 3, 4), s)
    theirs = account_columns(span, "acc_user_ends", user, s)
    return Account(
        own + theirs[0], theirs[1] + side * jx, theirs[2] + side * jy, theirs[3] + side * pseudo
    )


def _thermal(span: Span, s: np.ndarray) -> Account:
    """Langevin reservoirs: at the bar, and on the swing, whose torque has no pseudowork."""
    bars = _point("acc_thermal", span, s)
    swing = Accounts(span, s).swing_work
    return replace(bars, about=bars.about + swing)


def _point(group: str, span: Span, s: np.ndarray) -> Account:
    """A force with accounts of its own."""
    jx, jy, about, pseudo = account_columns(span, group, range(4), s)
    return Account(about, jx, jy, pseudo)


# The account of every force on an asperite, by the name of its work.
FORCES: dict[str, Callable[[Span, np.ndarray], Account]] = {
    "w1": _contact,
    "w2": _drive,
    "wL": partial(_end, 0, (0, 2, 3, 6), 1.0),
    "wR": partial(_end, 1, (1, 4, 5, 7), -1.0),
    "w_int": partial(_point, "acc_internal"),
    "w_field": partial(_point, "acc_field"),
    "w_T": _thermal,
}
# The groups of accounts of these forces.
GROUPS = {
    "w1": ("acc_contact", "acc_slide"),
    "w2": ("acc_contact", "acc_slide", "acc_drive"),
    "wL": ("acc_ends", "acc_user_ends"),
    "wR": ("acc_ends", "acc_user_ends"),
    "w_int": ("acc_internal",),
    "w_field": ("acc_field",),
    "w_T": ("acc_thermal", "acc_swing"),
}
# The names of the external ones, and of those by which outside agents do work on a surface.
EXTERNAL = tuple(name for name in FORCES if name != "w_int")
APPLIED = ("w2", "wL", "wR", "w_T")

# The terms of an account: the work about the centre of mass, the pseudowork, the impulse along x
# and y at the velocity of the surface, and, of a reservoir's force, at that of the reservoir.
ABOUT, PSEUDO, BOOST_X, BOOST_Y, RESERVOIR_X, RESERVOIR_Y = range(6)


class Kind(NamedTuple):
    """What is taken of accounts."""

    series: Callable[[Accounts, Iterable[str]], np.ndarray]  # from those of some forces
    terms: tuple[int, ...]  # which terms it sums: their rounding is that of the sum


def _heat(accounts: Accounts, forces: Iterable[str]) -> np.ndarray:
    """Minus the work of reservoirs in the frame in which they rest."""
    vx, vy = accounts.span.reservoir
    (name,) = forces
    thermal = accounts[name]
    return accounts.whole(vx * thermal.jx + vy * thermal.jy - thermal.about - thermal.pseudo)


def _heat_of_swing(accounts: Accounts, forces: Iterable[str]) -> np.ndarray:
    return accounts.whole(-accounts.swing_work)


WORK = Kind(partial(Accounts.total, part=Account.work), (ABOUT, PSEUDO, BOOST_X, BOOST_Y))
PSEUDOWORK = Kind(partial(Accounts.total, part=Account.pseudowork), (PSEUDO, BOOST_X, BOOST_Y))
BOOST = Kind(partial(Accounts.total, part=Account.boost), (BOOST_X, BOOST_Y))
HEAT = Kind(_heat, (ABOUT, PSEUDO, RESERVOIR_X, RESERVOIR_Y))
HEAT_OF_SWING = Kind(_heat_of_swing, (ABOUT,))


class OfAccounts(NamedTuple):
    """A quantity that is linear in the accounts of some forces."""

    forces: tuple[str, ...]
    kind: Kind

    def series(self, accounts: Accounts) -> np.ndarray:
        """Of each asperite of a span, (times, asperites)."""
        return self.kind.series(accounts, self.forces)
