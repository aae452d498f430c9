"""Runs that end at an earlier sample than their last: energy ran away, or surfaces passed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tribo.kernels.status import Status
from tribo.layout.layout import Layout
from tribo.ledger.passing import passed_through
from tribo.ledger.runaway import lost_sample
from tribo.loops.integrate import Integration


def up_to_runaway(layout: Layout, run: Integration) -> Integration:
    """The run, or its part up to the first sample at which its energy has run away."""
    lost = lost_sample(layout, run.samples)
    return run if lost is None else _cut(run, lost, Status.ENERGY_RUNAWAY)


def up_to_passing(layout: Layout, run: Integration) -> Integration:
    """The run, or its part up to the first sample at which surfaces have passed."""
    if run.status != Status.COMPLETED:
        return run
    passed = np.flatnonzero(passed_through(layout, run.samples))
    return _cut(run, int(passed[0]), Status.PASSED_THROUGH) if passed.size else run


def _cut(run: Integration, last: int, status: Status) -> Integration:
    """The part of a run up to a sample."""
    kept = run.samples.at(run.samples.t[: last + 1])
    return replace(run, recorded=lambda: kept, _samples=kept, status=status, cut=True)
