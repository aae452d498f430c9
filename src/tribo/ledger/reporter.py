"""Ledgers of the runs of one layout, with what is the same for all of them found once."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from tribo.layout.layout import Layout
from tribo.ledger.ledger import Ledger, SampledLedger, contents
from tribo.ledger.samples import Samples, are_among


class Reporter:
    """Makes the ledgers of a layout's runs, most of which stop at the layout's times or `planned`.

    A result keeps it instead of its simulation, which holds the samples of a search.
    """

    def __init__(self, layout: Layout, planned: np.ndarray) -> None:
        self._layout = layout
        self._planned = planned
        self._contents = contents(layout)

    def with_noisy_step(self, step: float) -> Reporter:
        """The same for runs with noise and a step, on which their forces depend."""
        return Reporter(replace(self._layout, noisy_step=step), self._planned)

    def ledger(self, samples: Samples) -> Ledger:
        """The ledger of a run at the scene's times and at its end, without its other stops."""
        layout = self._layout
        t = samples.t
        if t is not layout.times:
            known = t is self._planned
            recorded = self._recorded_of_planned if known else _recorded(layout, t)
            if recorded is not None:
                samples = samples.rows(recorded)
        ledger = SampledLedger(layout, samples, self._contents)
        if samples.t[0] == layout.beginning:
            return ledger
        return ledger.rows(slice(samples.index_from(layout.beginning), None))

    @cached_property
    def _recorded_of_planned(self) -> np.ndarray | None:
        return _recorded(self._layout, self._planned)


def _recorded(layout: Layout, t: np.ndarray) -> np.ndarray | None:
    """Which of the times of a run are to record, with its ends, (times,); None if all are."""
    recorded = are_among(t, layout.times)
    recorded[[0, -1]] = True
    return None if recorded.all() else recorded
