"""The reaction of the constraint on driven bars: what their motion leaves over of other forces."""

from __future__ import annotations

import numpy as np

from tribo.kernels.records import BARS
from tribo.run.accounts import FORCES, Accounts
from tribo.run.batch import batches_of
from tribo.run.layout import Layout
from tribo.run.motion import about_pivots
from tribo.run.samples import Samples


def add_reactions(layout: Layout, samples: Samples, run: Samples) -> None:
    """Set the accounts of f2 on driven bars in `samples` of a run that begins with that of `run`.

    The impulse is M (v_cm - v_cm(0)) less all other impulses, the pseudowork the change of kinetic
    energy less all other pseudoworks.  In the frame of the bars f2 does no work.
    """
    for k, part in enumerate(layout.parts.values()):
        if layout.surfaces[k].drive == BARS:
            for batch in batches_of(layout.together, part):
                first, later = (
                    (each.y[:, batch.place], each.y[:, layout.core :][:, batch.place])
                    for each in (run.first(), samples)
                )
                _add(Accounts(batch, samples.s), samples.s, first, later)


def _add(
    forces: Accounts,
    s: np.ndarray,
    first: tuple[np.ndarray, np.ndarray],
    later: tuple[np.ndarray, np.ndarray],
) -> None:
    """The same of one batch, from its swings and their rates at the start and at samples."""
    a = forces.batch.asperites
    others = [forces[name] for name in FORCES if name != "w2"]
    _, _, vx, vy = about_pivots(a, *later)
    _, _, vx0, vy0 = about_pivots(a, *first)
    pseudo = 0.5 * a.mass * (vx**2 + vy**2 - vx0**2 - vy0**2) - sum(f.pseudo for f in others)
    s[:, a.acc_drive] = a.mass * (vx - vx0) - sum(f.jx for f in others)
    s[:, a.acc_drive + a.stride] = a.mass * (vy - vy0) - sum(f.jy for f in others)
    s[:, a.acc_drive + 3 * a.stride] = pseudo
