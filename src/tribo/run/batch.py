"""The asperites of each surface as a ledger reads them, batch by batch."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

from tribo.kernels.records import FORCED, Model

# Asperites of a batch: more of them would make the temporary arrays of a ledger large.
BATCH_SIZE = 50_000

Asperites = SimpleNamespace  # the fields of kernels.records.ASPERITE, each an array (asperites,)


@dataclass(frozen=True, eq=False)
class Batch:
    """Some consecutive asperites.

    Attributes
    ----------
    place : slice
        Of the asperites among all.
    asperites : Asperites
        Their parameters and slots.
    velocity : ndarray, (2, asperites)
        Initial velocity of their surface, in the laboratory.
    held : ndarray, (asperites,)
        1 if the drive opposes all of f1_x, 0 if it leaves the surface free to slide.
    reservoir : ndarray, (2, asperites)
        Velocity of the reservoir in the surface's first frame.
    present : frozenset of str
        Groups of accounts that any of the asperites has.
    """

    place: slice
    asperites: Asperites
    velocity: np.ndarray
    held: np.ndarray
    reservoir: np.ndarray
    present: frozenset[str]


def batches_of(model: Model, velocity: np.ndarray, whole: slice) -> tuple[Batch, ...]:
    """Consecutive asperites, at most BATCH_SIZE at a time; `velocity` is that of all (n, 2)."""
    starts = range(whole.start, whole.stop, BATCH_SIZE)
    return tuple(
        batch_of(model, velocity, slice(start, min(start + BATCH_SIZE, whole.stop)))
        for start in starts
    )


def batch_of(model: Model, velocity: np.ndarray, place: slice) -> Batch:
    """The asperites at one place."""
    records = model.asperites
    names = records.dtype.names
    surfaces = model.surfaces[records["surface"][place]]
    return Batch(
        place=place,
        # Attributes of records take microseconds.
        asperites=Asperites(**{name: records[name][place] for name in names}),
        velocity=velocity[place].T.copy(),
        held=(surfaces["drive"] == FORCED).astype(float),
        reservoir=np.array([surfaces["reservoir_x"], surfaces["reservoir_y"]]),
        present=frozenset(
            name for name in names if name.startswith("acc_") and (records[name][place] >= 0).any()
        ),
    )
