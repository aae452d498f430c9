"""The asperites of each surface as a ledger reads them, batch by batch."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

from tribo.kernels.records import FORCED, Model
from tribo.model.surface import Surface

# Asperites of a batch: more of them would make the temporary arrays of a ledger large.
BATCH_SIZE = 50_000

Asperites = SimpleNamespace  # the fields of kernels.records.ASPERITE, each an array (asperites,)


@dataclass(frozen=True, eq=False)
class Batch:
    """Some consecutive asperites of one surface.

    Attributes
    ----------
    index : int
        Of the surface.
    place : slice
        Of the asperites among all.
    asperites : Asperites
        Their parameters and slots.
    velocity : ndarray, (2,)
        Initial velocity of the surface, in the laboratory.
    held : float
        1 if the drive opposes all of f1_x, 0 if it leaves the surface free to slide.
    reservoir : tuple of float
        Velocity of the reservoir in the surface's first frame.
    total_mass : float
        Of the surface and its bath.
    block : int
        Slot of the pseudowork of the surface as a whole; -1 if it is absent.
    """

    index: int
    place: slice
    asperites: Asperites
    velocity: np.ndarray
    held: float
    reservoir: tuple[float, float]
    total_mass: float
    block: int


def batches_of(model: Model, index: int, surface: Surface) -> tuple[Batch, ...]:
    """The asperites of a surface, at most BATCH_SIZE at a time."""
    record, fields = model.surfaces[index], model.asperites.dtype.names
    places = range(int(record.start), int(record.stop), BATCH_SIZE)
    return tuple(
        Batch(
            index=index,
            place=(place := slice(start, min(start + BATCH_SIZE, int(record.stop)))),
            # Attributes of records take microseconds.
            asperites=Asperites(**{name: model.asperites[name][place] for name in fields}),
            velocity=np.array(surface.velocity),
            held=1.0 if record.drive == FORCED else 0.0,
            reservoir=(float(record.reservoir_x), float(record.reservoir_y)),
            total_mass=float(record.total_mass),
            block=int(record.acc_block),
        )
        for start in places
    )
