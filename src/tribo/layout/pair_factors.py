"""Factors from the record of the pair's loop to the layout of a scene."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass

import numpy as np

from tribo.layout.layout import Layout
from tribo.pair.loop import ENERGY
from tribo.pair.step_rows import (
    J_Y,
    Q1,
    Q2,
    T1,
    T2,
    V1,
    V2,
    X1,
    X2,
    Y1,
    Y2,
    J,
    K,
    S,
)

# Columns behind the record's accounts, in place of the contact energy: see `_arcs`.
ARC1, ARC2 = ENERGY, ENERGY + 1

FIRST_ACCOUNT = J + 1


@dataclass(frozen=True, eq=False)
class Factors:
    """The factors from a row of the loop's record, with its arcs, to the scene's layout.

    Attributes
    ----------
    state : ndarray, (2 coordinates, columns)
        Those of y.
    accounts : ndarray, (accounts, columns)
        Those of s.
    linear : dict
        Those of linear functions of s by their keys, (columns, ...); without the arcs where these
        have no part.
    driven : Layout or None
        The scene's layout, if its bars are driven: the reactions on them are not linear.
    """

    state: np.ndarray
    accounts: np.ndarray
    linear: dict[Hashable, np.ndarray]
    driven: Layout | None


def factors_of(
    layout: Layout, asperites: np.ndarray, mobility: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The factors of coordinates and of accounts, (..., 2 coordinates or accounts, columns).

    `asperites` and `mobility` are (..., 2), with the slots of the layout.  For the meaning of the
    accounts see :mod:`tribo.kernels.powers`.
    """
    n, shape = layout.coordinates, asperites.shape[:-1]
    to_state = np.zeros((*shape, 2 * n, ENERGY + 2))
    to_accounts = np.zeros((*shape, layout.accounts, ENERGY + 2))
    columns = ((Q1, V1, X1, Y1, T1, ARC1), (Q2, V2, X2, Y2, T2, ARC2))
    for i, (slots, sign) in enumerate(zip(layout.asperites, (1.0, -1.0), strict=True)):
        q, v, about_x, about_y, twist, arc = columns[i]
        a, slide = asperites[..., i], mobility[..., i]
        to_state[..., i, q] = to_state[..., n + i, v] = 1.0
        first = FIRST_ACCOUNT
        contact = slots.acc_contact
        to_accounts[..., contact, J] = to_accounts[..., contact + 1, first + J_Y] = sign
        to_accounts[..., contact + 2, first + about_x] = sign * a["facing"]
        to_accounts[..., contact + 3, first + about_y] = sign * a["facing"]
        if slots.dof_x >= 0:
            to_state[..., slots.dof_x, K] = to_state[..., n + slots.dof_x, J] = slide
            block = layout.surfaces[i].acc_block
            for slot in (slots.acc_slide, block):
                to_accounts[..., slot, first + S] = sign * slide
        if slots.acc_ends >= 0:
            end = a["kappa"] / a["bar_length"]
            to_accounts[..., slots.acc_ends, arc] = -a["l2"] * a["facing"] * end
            to_accounts[..., slots.acc_ends + 1, arc] = a["l2"] * a["facing"] * end
            to_accounts[..., slots.acc_ends + 3, first + twist] = end
            to_accounts[..., slots.acc_ends + 4, arc] = a["pivot"] * a["facing"] * end
    return to_state, to_accounts
