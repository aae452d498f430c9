"""The times at which something happens in a run: when the energy of contact changes."""

from __future__ import annotations

import numpy as np

from tribo.results.run_result import RunResult

# Of all changes of the contact energy, the parts before the first and after the last time that is
# chosen: most of an encounter lies between these times, and the asperites are near each other.
BEFORE = 0.15


def encounter_times(result: RunResult, number: int) -> list[float]:
    """Times of samples between which the contact energy changes by equal amounts.

    A single encounter is thus shown on its way in, at its closest, and on its way out.

    They are fewer than `number` where samples are few, and evenly spaced from start to end where no
    contact energy is recorded, or it does not change.
    """
    parts = np.linspace(BEFORE, 1.0 - BEFORE, number)
    energy = np.asarray(result.system.get("contact_energy", 0))
    changes = np.abs(np.diff(energy)) if energy.size == result.t.size else np.zeros(1)
    total = np.nansum(changes)
    if not (np.isfinite(total) and total > 0.0):
        return np.linspace(result.t[0], result.t[-1], number).tolist()
    reached = np.concatenate([[0.0], np.cumsum(np.nan_to_num(changes))]) / total
    samples = np.unique(np.searchsorted(reached, parts))
    return [float(result.t[k]) for k in samples]
