"""The account of every force, from the integrals that the kernels record.

Kernels integrate in the frame of each surface's initial velocity V; in the laboratory
work = (about the centre of mass) + V . J + (pseudowork in that frame).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tribo.run.batch import Batch
from tribo.run.motion import columns


@dataclass(frozen=True, eq=False)
class Account:
    """One force's entries; arrays (times, asperites)."""

    about: np.ndarray  # work about the centre of mass: the same in every frame
    jx: np.ndarray  # impulse
    jy: np.ndarray
    pseudo: np.ndarray  # pseudowork in the surface's first frame

    def pseudowork(self, velocity: np.ndarray) -> np.ndarray:
        """In the laboratory, where the surface's first velocity is `velocity` (2,)."""
        return self.pseudo + self.boost(velocity)

    def boost(self, velocity: np.ndarray) -> np.ndarray:
        """The work of the impulse at a velocity (2,)."""
        return np.asarray(velocity[0] * self.jx + velocity[1] * self.jy)

    def work(self, velocity: np.ndarray) -> np.ndarray:
        """In the laboratory."""
        return self.about + self.pseudowork(velocity)


class Accounts(dict[str, Account]):
    """The accounts of the forces on a batch, by the names of their works, each made when needed.

    Parameters
    ----------
    batch : Batch
        Some asperites of one surface.
    s : ndarray, (times, accounts)
        The integrals that the kernels record.
    """

    def __init__(self, batch: Batch, s: np.ndarray) -> None:
        super().__init__()
        self.batch = batch
        self._s = s

    def __missing__(self, name: str) -> Account:
        account = self[name] = FORCES[name](self.batch, self._s)
        return account


class Integrals:
    """The integrals that the kernels record, by batch and force.

    Parameters
    ----------
    s : ndarray, (times, accounts)
        The integrals.
    """

    def __init__(self, s: np.ndarray) -> None:
        self.s = s
        self._known: dict[Batch, Accounts] = {}

    def of(self, batch: Batch) -> Accounts:
        """The accounts of a batch."""
        if batch not in self._known:
            self._known[batch] = Accounts(batch, self.s)
        return self._known[batch]


def _column(slots: np.ndarray, k: int, s: np.ndarray) -> np.ndarray:
    """Column `k` of a group of accounts; zeros where the group is absent."""
    return columns(np.where(slots >= 0, slots + k, -1), s)


def _contact(batch: Batch, s: np.ndarray) -> Account:
    """The contact with bobs of other surfaces."""
    a = batch.asperites
    jx, jy, about_x, about_y = (_column(a.acc_contact, k, s) for k in range(4))
    slide_x, slide_y = (_column(a.acc_slide, k, s) for k in range(2))
    return Account(a.l1 * (about_x + about_y), jx, jy, slide_x + slide_y)


def _drive(batch: Batch, s: np.ndarray) -> Account:
    """The drive: f2 = -(held f1_x, f1_y), unless it has an account of its own."""
    a = batch.asperites
    held = batch.held
    jx, jy, about_x, about_y = (_column(a.acc_contact, k, s) for k in range(4))
    slide_x, slide_y = (_column(a.acc_slide, k, s) for k in range(2))
    own_jx, own_jy, own_about, own_pseudo = (_column(a.acc_drive, k, s) for k in range(4))
    own = a.acc_drive >= 0
    return Account(
        np.where(own, -a.l2 * own_about, a.l2 * (held * about_x + about_y)),
        np.where(own, own_jx, -held * jx),
        np.where(own, own_jy, -jy),
        np.where(own, own_pseudo, -(held * slide_x + slide_y)),
    )


def _left_end(batch: Batch, s: np.ndarray) -> Account:
    """The left end of the bar."""
    a = batch.asperites
    about, jx, jy, pseudo = (_column(a.acc_ends, k, s) for k in (0, 2, 3, 4))
    user = [_column(a.acc_user_ends, k, s) for k in (0, 2, 3, 6)]
    return Account(about + user[0], jx + user[1], jy + user[2], pseudo + user[3])


def _right_end(batch: Batch, s: np.ndarray) -> Account:
    """The right end of the bar, on which a clamp exerts the opposite of its force on the left."""
    a = batch.asperites
    about, jx, jy, pseudo = (_column(a.acc_ends, k, s) for k in range(1, 5))
    user = [_column(a.acc_user_ends, k, s) for k in (1, 4, 5, 7)]
    return Account(about + user[0], user[1] - jx, user[2] - jy, user[3] - pseudo)


def _point(group: str) -> Callable[[Batch, np.ndarray], Account]:
    """A force with accounts of its own."""

    def account(batch: Batch, s: np.ndarray) -> Account:
        slots = getattr(batch.asperites, group)
        jx, jy, about, pseudo = (_column(slots, k, s) for k in range(4))
        return Account(about, jx, jy, pseudo)

    return account


# The account of every force on an asperite, by the name of its work.
FORCES: dict[str, Callable[[Batch, np.ndarray], Account]] = {
    "w1": _contact,
    "w2": _drive,
    "wL": _left_end,
    "wR": _right_end,
    "w_int": _point("acc_internal"),
    "w_field": _point("acc_field"),
    "w_T": _point("acc_thermal"),
}
# The names of the external ones, and of those by which outside agents do work on a surface.
EXTERNAL = tuple(name for name in FORCES if name != "w_int")
APPLIED = ("w2", "wL", "wR", "w_T")


def accounted(forces: Accounts, name: str) -> np.ndarray:
    """What is linear in the accounts: "w1", "w1_ps", ..., "w", "w_ps" of all forces, or "heat"."""
    batch = forces.batch
    if name == "heat":
        (vx, vy), thermal = batch.reservoir, forces["w_T"]
        reservoir = vx * thermal.jx + vy * thermal.jy
        return np.asarray(reservoir - thermal.about - thermal.pseudo)
    force = name.removesuffix("_ps")
    kind = Account.pseudowork if name.endswith("_ps") else Account.work
    names = FORCES if force == "w" else [force]
    return np.asarray(sum(kind(forces[name], batch.velocity) for name in names))
