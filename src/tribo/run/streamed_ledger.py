"""The ledger of a run whose samples are too many to hold: assembled portion by portion."""

from __future__ import annotations

import math

import numpy as np

from tribo.kernels.force_probe import ROWS
from tribo.run.layout import Layout
from tribo.run.ledger import Ledger, assemble
from tribo.run.quantities import ASPERITE_QUANTITIES, OPTIONAL_QUANTITIES, Table
from tribo.run.samples import Samples

# Bytes of all samples of a run. Above it, only the first and the last sample of each asperite are
# kept: a gigabyte fits into the memory of any computer of today.
SERIES_BYTES = 2**30
# Bytes of the samples of one portion: 1/8 of the above, so that a portion needs little memory
# beside the state of the run.
PORTION_BYTES = 2**27


class StreamedLedger:
    """The ledger of a run whose samples arrive in portions.

    The series of the surfaces as wholes and of the system are complete; those of the asperites
    are left out.
    """

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self._portions: list[Ledger] = []

    def add(self, samples: Samples) -> None:
        """Take in a portion, whose first sample is the first of the run."""
        new = slice(1 if self._portions else 0, None)
        ledger = assemble(self._layout, samples).rows(new)
        blocks = {name: dict(table) for name, table in ledger.blocks.items()}
        self._portions.append(Ledger(ledger.t, {}, blocks, dict(ledger.system)))

    def with_ends(self, samples: Samples) -> Ledger:
        """All series, and those of the asperites at `samples`, the first and the last."""
        portions = self._portions
        ends = assemble(self._layout, samples)
        return Ledger(
            np.concatenate([portion.t for portion in portions]),
            ends.surfaces,
            {
                name: _joined([portion.blocks[name] for portion in portions])
                for name in portions[0].blocks
            },
            _joined([portion.system for portion in portions]),
            ends.oscillators,
        )


def exceeds_memory(layout: Layout, times: int) -> bool:
    """Whether so many samples of all asperites are too many to hold."""
    return times * _sample_bytes(layout) > SERIES_BYTES


def portion_size(layout: Layout) -> int:
    """Samples of one portion."""
    return max(1, PORTION_BYTES // _sample_bytes(layout))


def _joined(tables: list[Table]) -> Table:
    return {name: np.concatenate([table[name] for table in tables]) for name in tables[0]}


def _sample_bytes(layout: Layout) -> int:
    """Bytes of one sample, raw and as the ledger."""
    reported = len(ASPERITE_QUANTITIES) + len(OPTIONAL_QUANTITIES)
    raw = 2 * layout.core + layout.accounts + math.prod(layout.sampled_baths)
    if "forces" in layout.scene.output.series:
        raw += ROWS * layout.model.asperites.shape[1]
    return 8 * (raw + 2 * reported * layout.scene.count)
