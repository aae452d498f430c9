"""The reaction of the constraint on driven bars: what their motion leaves over of other forces."""

from __future__ import annotations

import numpy as np

from tribo.kernels.records import BARS
from tribo.layout.layout import Layout
from tribo.layout.span import Span
from tribo.ledger.accounts import FORCES, Accounts
from tribo.ledger.motion import about_pivots


def add_reactions(layout: Layout, y: np.ndarray, s: np.ndarray, start: np.ndarray) -> None:
    """Set the accounts of f2 on driven bars in `s`, whose rows are of the coordinates in `y`.

    The impulse is M (v_cm - v_cm(0)) less all other impulses, the pseudowork the change of kinetic
    energy less all other pseudoworks.  In the frame of the bars f2 does no work.  `start` is y at
    the start of the run, (1, 2 coordinates), or a row for each sample.
    """
    for index in range(len(layout.parts)):
        if layout.surfaces[index].drive == BARS and layout.surfaces[index].acc_drive >= 0:
            changes = [_changes(layout, span, y, start) for span in layout.spans[index]]
            if layout.model.sums is not None:
                changes = [_in_first_lane(changes, layout.surfaces[index].account_stride)]
            for span, change in zip(layout.accounted_spans[index], changes, strict=True):
                _add(Accounts(span, s), s, change)


def _changes(layout: Layout, span: Span, y: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Changes of momentum along x and y and of kinetic energy, (3, times, asperites)."""
    a = span.asperites
    (vx0, vy0), (vx, vy) = (
        about_pivots(a, each[:, span.place], each[:, layout.core :][:, span.place])[2:]
        for each in (start, y)
    )
    kinetic = 0.5 * a.mass * (vx**2 + vy**2 - vx0**2 - vy0**2)
    return np.stack([a.mass * (vx - vx0), a.mass * (vy - vy0), kinetic])


def _in_first_lane(changes: list[np.ndarray], lanes: int) -> np.ndarray:
    """The sums over asperites as those of the first of some lanes, (3, times, lanes)."""
    found = np.zeros((*changes[0].shape[:2], lanes))
    found[:, :, 0] = sum(np.sum(change, axis=2) for change in changes)
    return found


def _add(forces: Accounts, s: np.ndarray, change: np.ndarray) -> None:
    """Set the accounts of one span, from the changes of its momenta and kinetic energy."""
    a = forces.span.asperites
    others = [forces[name] for name in FORCES if name != "w2"]
    px, py, kinetic = change
    pseudo = kinetic - sum(f.pseudo for f in others)
    s[:, a.acc_drive] = px - sum(f.jx for f in others)
    s[:, a.acc_drive + a.stride] = py - sum(f.jy for f in others)
    s[:, a.acc_drive + 2 * a.stride] = pseudo  # minus the work about the centre of mass
    s[:, a.acc_drive + 3 * a.stride] = pseudo
