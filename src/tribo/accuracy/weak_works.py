"""Works that are smaller than the rounding of the energies that they change."""

from __future__ import annotations

import numpy as np

from tribo.accuracy.comparison import Accuracy, observables
from tribo.accuracy.scales import Values, are_lost, kind_of

# What each note on such works contains.
LOST = "below the rounding of the energies"


def weak_notes(work: Values, energy: Values, accuracy: Accuracy) -> list[str]:
    """A note for each run whose errors of works are relative to energies of the motion; else "".

    Parameters
    ----------
    work, energy
        the largest work of an asperite, and the scale of energies, of one run or of several
    accuracy
        of the runs; there are no notes where it is for other quantities alone
    """
    work, energy = np.atleast_1d(work), np.atleast_1d(energy)
    asked = [kind_of(name) for name in observables(accuracy)]
    if asked and not {"energy", "total"} & set(asked):
        return [""] * work.size
    lost = (work > 0.0) & are_lost(work, energy)
    return [
        f"no work exceeds {w:.1e}, {LOST} of {e:.1e} that it changes: errors are relative to "
        "these, and works and changes of energies have no digit that is known"
        if weak
        else ""
        for w, e, weak in zip(work, energy, lost, strict=True)
    ]
