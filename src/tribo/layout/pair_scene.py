"""One asperite on one: a scene as the loop of a pair reads it, and back to the scene's layout.

The samples of the loop have few columns.  Every coordinate and every account of the layout is a
multiple of one of them; two matrices hold the factors.
"""

from __future__ import annotations

import numpy as np

from tribo.kernels.records import FREE
from tribo.layout.layout import Layout
from tribo.pair.forces import PAIR
from tribo.pair.loop import ENERGY
from tribo.pair.step_rows import J_Y, Q1, Q2, T1, T2, V1, V2, X1, X2, Y1, Y2, J, K, S

# Columns behind the record's accounts, in place of the contact energy: see `_arcs`.
ARC1, ARC2 = ENERGY, ENERGY + 1

FIRST_ACCOUNT = J + 1


def factors_of(layout: Layout, asperites: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The factors of coordinates and of accounts, (..., 2 coordinates or accounts, columns).

    `asperites` are (..., 2), with the slots of the layout.  For the meaning of the accounts see
    :mod:`tribo.kernels.powers`.
    """
    n, shape, mobility = layout.coordinates, asperites.shape[:-1], _mobility_of(layout, asperites)
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


def _mobility_of(layout: Layout, asperites: np.ndarray) -> np.ndarray:
    """(..., 2) displacement of each centre of mass for k = 1."""
    free = layout.surfaces.drive == FREE
    return np.asarray(np.array([1.0, -1.0]) * free / asperites["mass"])


def record_of(layout: Layout, asperites: np.ndarray, charges: np.ndarray) -> np.ndarray:
    """Scenes as the loop reads them, (...) of PAIR; driven bars take the place of centres of mass.

    Asperites and charges are (..., 2).
    """
    a, depths, mobility = asperites, layout.depths, _mobility_of(layout, asperites)
    record = np.zeros(a.shape[:-1], PAIR)
    for name, of in (("gap_x", "x"), ("gap_y", "y"), ("velocity_x", "vx"), ("velocity_y", "vy")):
        record[name] = a[of][..., 0] - a[of][..., 1]
    raised = a["facing"] * a["pivot"]
    record["gap_y"] += raised[..., 0] - raised[..., 1]
    record["z_squared"] = (depths[0] - depths[1]) ** 2
    record["mobility"] = mobility[..., 0] - mobility[..., 1]
    for i, sign in enumerate((1.0, -1.0)):
        one, free = a[..., i], mobility[..., i] != 0.0
        inertia = one["inertia"] + one["mass"] * one["pivot"] ** 2
        lever = sign * one["facing"] / inertia
        across = one["l1"] + one["l2"]
        record[f"charge{i + 1}"] = charges[..., i]
        record[f"arm{i + 1}"] = one["facing"] * (one["l1"] + one["pivot"])
        record[f"lever_x{i + 1}"] = lever * np.where(free, one["l1"], across)
        record[f"lever_y{i + 1}"] = lever * across
        record[f"omega_squared{i + 1}"] = one["kappa"] / inertia
    return record
