"""The asperites of each surface as a ledger reads them, span by span."""

from dataclasses import dataclass
from functools import cached_property
from types import SimpleNamespace

import numpy as np

from tribo.kernels.records import FORCED

# Asperites of a span: more of them would make the temporary arrays of a ledger large.
SPAN_SIZE = 50_000

Asperites = SimpleNamespace  # the fields of kernels.records.ASPERITE, each an array (asperites,)


@dataclass(frozen=True, eq=False)
class Span:
    """Some consecutive asperites."""

    place: slice  # of the asperites among all
    asperites: Asperites  # their parameters and slots
    velocity: np.ndarray  # (2, asperites) initial velocity of their surface, in the laboratory
    # (asperites,) 1 if the drive opposes all of f1_x, 0 if it leaves the surface free to slide.
    held: np.ndarray
    reservoir: np.ndarray  # (2, asperites) velocity of the reservoir in the surface's first frame

    @cached_property
    def present(self) -> frozenset[str]:
        """Groups of slots, as "dof_x" and "acc_slide", that any of the asperites has."""
        found = []
        for name, slots in vars(self.asperites).items():
            if name[:4] in ("acc_", "dof_") and np.maximum.reduce(slots) >= 0:
                found.append(name)
        return frozenset(found)

    @cached_property
    def consecutive(self) -> frozenset[str]:
        """Groups whose slots follow one another, with one stride for all of them."""
        strides = self.asperites.stride
        if (strides != strides[0]).any():
            return frozenset()
        place = np.arange(strides.size)
        each = vars(self.asperites)
        found = []
        for name in self.present:
            slots = each[name]
            if slots[0] >= 0 and (slots - slots[0] == place).all():
                found.append(name)
        return frozenset(found)


def spans_of(whole: Span, part: slice) -> tuple[Span, ...]:
    """Consecutive asperites among all, at most SPAN_SIZE at a time."""
    spans = []
    for start in range(part.start, part.stop, SPAN_SIZE):
        place = slice(start, min(start + SPAN_SIZE, part.stop))
        own = Asperites(**{name: each[..., place] for name, each in vars(whole.asperites).items()})
        others = whole.velocity[..., place], whole.held[place], whole.reservoir[:, place]
        spans.append(Span(place, own, *others))
    return tuple(spans)


def span_of(records: np.ndarray, surfaces: np.ndarray, velocity: np.ndarray) -> Span:
    """All asperites, whose initial velocities are `velocity` (asperites, 2)."""
    # Attributes of record arrays, and fields of these, take microseconds.
    records = np.asarray(records)
    surfaces = np.asarray(surfaces)
    mine = records["surface"]
    asperites = Asperites(**{name: records[name] for name in records.dtype.names or ()})
    return Span(
        place=slice(0, records.size),
        asperites=asperites,
        velocity=velocity.T.copy(),
        held=(surfaces["drive"] == FORCED).astype(float)[mine],
        reservoir=np.array([surfaces["reservoir_x"], surfaces["reservoir_y"]])[:, mine],
    )


def columns(slots: np.ndarray, table: np.ndarray, absent: np.ndarray | float = 0.0) -> np.ndarray:
    """Columns of a table by slot; `absent` where the slot is -1."""
    present = slots >= 0
    if present.all():
        return table[:, slots]
    values = np.array(np.broadcast_to(absent, (table.shape[0], slots.size)), float)
    values[:, present] = table[:, slots[present]]
    return values
