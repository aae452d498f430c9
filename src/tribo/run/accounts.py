"""The account of every force, from the integrals that the kernels record.

Kernels integrate in the frame of each surface's initial velocity V; in the laboratory
work = (about the centre of mass) + V . J + (pseudowork in that frame).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tribo.kernels.records import BARS, FORCED
from tribo.run.motion import Batch, Motion, columns


@dataclass(frozen=True, eq=False)
class Account:
    """One force's entries; arrays (times, asperites)."""

    about: np.ndarray  # work about the centre of mass: the same in every frame
    jx: np.ndarray  # impulse
    jy: np.ndarray
    pseudo: np.ndarray  # pseudowork in the surface's first frame

    def pseudowork(self, velocity: np.ndarray) -> np.ndarray:
        """In the laboratory, where the surface's first velocity is `velocity` (2,)."""
        return self.pseudo + velocity[0] * self.jx + velocity[1] * self.jy

    def work(self, velocity: np.ndarray) -> np.ndarray:
        """In the laboratory."""
        return self.about + self.pseudowork(velocity)


def accounts(batch: Batch, motion: Motion, s: np.ndarray) -> dict[str, Account]:
    """The account of every force, by the name of its work."""
    a = batch.asperites

    def column(slots: np.ndarray, k: int) -> np.ndarray:
        return columns(np.where(slots >= 0, slots + k * a.stride, -1), s)

    def point(slots: np.ndarray) -> Account:
        jx, jy, about, pseudo = (column(slots, k) for k in range(4))
        return Account(about, jx, jy, pseudo)

    jx, jy, about_x, about_y = (column(a.acc_contact, k) for k in range(4))
    slide_x, slide_y = (column(a.acc_slide, k) for k in range(2))
    swept = about_x + about_y
    contact = Account(a.l1 * swept, jx, jy, slide_x + slide_y + a.pivot * swept)

    # f2 = -(held f1_x, f1_y), with held = 1 for a forced drive and 0 for a free one, unless the
    # drive has an account of its own.
    held = 1.0 if batch.surface.drive == FORCED else 0.0
    own = a.acc_drive >= 0
    drive = Account(
        np.where(own, -a.l2 * column(a.acc_drive, 2), a.l2 * (held * about_x + about_y)),
        np.where(own, column(a.acc_drive, 0), -held * jx),
        np.where(own, column(a.acc_drive, 1), -jy),
        np.where(own, column(a.acc_drive, 3), -(held * slide_x + slide_y)),
    )

    left, right, end_x, end_y, end_pseudo = (column(a.acc_ends, k) for k in range(5))
    user = [column(a.acc_user_ends, k) for k in range(8)]
    thermal = point(a.acc_thermal)
    table = {
        "w1": contact,
        "w2": drive,
        "wL": Account(left + user[0], end_x + user[2], end_y + user[3], end_pseudo + user[6]),
        "wR": Account(right + user[1], user[4] - end_x, user[5] - end_y, user[7] - end_pseudo),
        "w_int": point(a.acc_internal),
        "w_field": point(a.acc_field),
        "w_T": replace(thermal, about=thermal.about + column(a.acc_swing, 0)),
    }
    if batch.surface.drive == BARS:
        others = [account for name, account in table.items() if name != "w2"]
        table["w2"] = _reaction(batch, motion, others)
    return table


def _reaction(batch: Batch, m: Motion, others: list[Account]) -> Account:
    """The account of the constraint on driven bars: what the motion leaves over.

    It does no work in the frame of the bars.
    """
    mass = batch.asperites.mass
    energy = 0.5 * mass * (m.vx**2 + m.vy**2)
    pseudo = energy - energy[0] - sum(other.pseudo for other in others)
    return Account(
        about=-pseudo,
        jx=mass * (m.vx - m.vx[0]) - sum(other.jx for other in others),
        jy=mass * (m.vy - m.vy[0]) - sum(other.jy for other in others),
        pseudo=pseudo,
    )
