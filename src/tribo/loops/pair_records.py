"""One asperite on one as its own loop reads it: which scenes it serves, and their numbers.

The samples of the loop have few columns.  Every coordinate and every account of the layout is a
multiple of one of them; two matrices hold the factors.
"""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numba import config

from tribo.integrators.collocation import Collocation
from tribo.integrators.methods import Method
from tribo.kernels.records import ASPERITE, BARS, CHARGE, FORCED, FREE
from tribo.layout.layout import Layout, once_per_layout
from tribo.layout.scene_records import MemberNumbers
from tribo.model.effects import Effect
from tribo.pair import step_rows
from tribo.pair.bodies import Body, pair_of
from tribo.pair.forces import PAIR
from tribo.pair.loop import ENERGY

# Columns behind the record's accounts, in place of the contact energy: see `_arcs`.
ARC1 = ENERGY
ARC2 = ENERGY + 1

FIRST_ACCOUNT = step_rows.J + 1
# Names of what records of asperites contain.
OF_ASPERITE = frozenset(ASPERITE.names or ())
# Effects of scenes that the loop of a pair knows.
KNOWN = {
    *(Effect.CONTACT, Effect.SWING, Effect.SLIDING),
    *(Effect.CLAMPED_ENDS, Effect.CUTOFF, Effect.DRIVEN_BARS),
}


class Slots(NamedTuple):
    """The slots of one asperite of a pair: its coordinate along x, and its accounts."""

    dof_x: int
    acc_contact: int
    acc_ends: int
    acc_slide: int
    acc_block: int  # of its surface


@once_per_layout
def _slots_of(layout: Layout) -> tuple[Slots, ...]:
    asperites = np.asarray(layout.asperites)
    surfaces = np.asarray(layout.surfaces)
    names = Slots._fields[:-1]
    blocks = surfaces["acc_block"].tolist()
    each = zip(*(asperites[name].tolist() for name in names), blocks, strict=True)
    return tuple(itertools.starmap(Slots, each))


def factors_of(layout: Layout, asperites: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The factors of coordinates and of accounts, (..., 2 coordinates or accounts, columns).

    Asperites (..., 2) have the slots of the layout.  Accounts: see :mod:`tribo.kernels.powers`.
    """
    n = layout.coordinates
    shape = asperites.shape[:-1]
    mobility = _mobility_of(layout, asperites)
    to_state = np.zeros((*shape, 2 * n, ENERGY + 2))
    to_accounts = np.zeros((*shape, layout.accounts, ENERGY + 2))
    columns = (
        (step_rows.Q1, step_rows.V1, step_rows.X1, step_rows.Y1, step_rows.T1, ARC1),
        (step_rows.Q2, step_rows.V2, step_rows.X2, step_rows.Y2, step_rows.T2, ARC2),
    )
    for i, (slots, sign) in enumerate(zip(_slots_of(layout), (1.0, -1.0), strict=True)):
        q, v, about_x, about_y, twist, arc = columns[i]
        a = asperites[..., i]
        slide = mobility[..., i]
        to_state[..., i, q] = 1.0
        to_state[..., n + i, v] = 1.0
        first = FIRST_ACCOUNT
        contact = slots.acc_contact
        to_accounts[..., contact, step_rows.J] = sign
        to_accounts[..., contact + 1, first + step_rows.J_Y] = sign
        to_accounts[..., contact + 2, first + about_x] = sign * a["facing"]
        to_accounts[..., contact + 3, first + about_y] = sign * a["facing"]
        if slots.dof_x >= 0:
            to_state[..., slots.dof_x, step_rows.K] = slide
            to_state[..., n + slots.dof_x, step_rows.J] = slide
            for slot in (slots.acc_slide, slots.acc_block):
                to_accounts[..., slot, first + step_rows.S] = sign * slide
        if slots.acc_ends >= 0:
            end = a["kappa"] / a["bar_length"]
            to_accounts[..., slots.acc_ends, arc] = -a["l2"] * a["facing"] * end
            to_accounts[..., slots.acc_ends + 1, arc] = a["l2"] * a["facing"] * end
            to_accounts[..., slots.acc_ends + 3, first + twist] = end
            to_accounts[..., slots.acc_ends + 4, arc] = a["pivot"] * a["facing"] * end
    return to_state, to_accounts


def _mobility_of(layout: Layout, asperites: np.ndarray) -> np.ndarray:
    """(..., 2) displacement of each centre of mass for k = 1."""
    free = np.asarray(layout.surfaces)["drive"] == FREE
    return np.asarray(np.array([1.0, -1.0]) * free / asperites["mass"])


def record_of(layout: Layout, asperites: np.ndarray, charges: np.ndarray) -> np.ndarray:
    """Scenes as the loop reads them, (...) of PAIR; driven bars take the place of centres of mass.

    Asperites and charges are (..., 2).
    """
    free = layout.surfaces.drive == FREE
    bodies = []
    for i in range(2):
        own = {name: asperites[name][..., i] for name in Body._fields if name in OF_ASPERITE}
        bodies.append(
            Body(**own, depth=layout.depths[i], charge=charges[..., i], free=float(free[i]))
        )
    record = np.zeros(asperites.shape[:-1], PAIR)
    for name, values in pair_of(*bodies)._asdict().items():
        record[name] = values
    return record


def record_of_scene(layout: Layout) -> np.ndarray:
    """The record of a scene without members, (1,) of PAIR."""
    charges = layout.model.each[CHARGE, layout.places.columns]
    return record_of(layout, np.asarray(layout.asperites)[None], charges)


def has_pair_loop(layout: Layout, method: Method) -> bool:
    """Whether the pair's loop serves a scene and a method; it exists in compiled form only."""
    compiled = not config.DISABLE_JIT  # type: ignore[attr-defined]
    adaptive = method.adaptive and isinstance(method.coefficients, Collocation)
    return compiled and adaptive and is_pair(layout)


@once_per_layout
def is_pair(layout: Layout) -> bool:
    """Whether a scene is one asperite on one, with bars clamped at rest, forced, free or driven.

    Centres of mass start where they rest, with their surface's velocity: the loop has one number
    for the impulse of the contact and for their rates.
    """
    model = layout.model
    a = layout.together.asperites
    surfaces = np.asarray(layout.surfaces)
    along_x = a.dof_x[a.dof_x >= 0]
    return (
        layout.scene.count == surfaces.size == 2
        and not np.any(layout.start.reshape(2, -1)[:, along_x])
        and layout.scene.output.ledger == "asperites"
        and layout.scene.effects <= KNOWN
        and model.species is None
        and layout.rows == 0
        and len(model.contacts[0].pairs) == 1
        and set(surfaces["drive"].tolist()) <= {FORCED, FREE, BARS}
        and not surfaces["loaded"].any()
        and bool(np.all((a.dof_phi < 0) & (a.phi == 0.0) & (a.nu == 0.0) & (a.dof_y < 0)))
    )


class MembersOfPair:
    """What all runs of some members share that have numbers of their own."""

    def __init__(self, layout: Layout, numbers: MemberNumbers) -> None:
        self.numbers = numbers
        self.record = record_of(layout, numbers.asperites, numbers.charges)
        self.factors = factors_of(layout, numbers.asperites)
        self._layout = layout
        self._layouts: dict[int, Layout] = {}

    def layout(self, times: int) -> Layout:
        """The layout of samples at so many times."""
        if times not in self._layouts:
            own = replace(self._layout, numbers=self.numbers, member_times=times)
            self._layouts[times] = own
        return self._layouts[times]
