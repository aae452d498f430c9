"""The guard of runs with equal steps: energy that no work accounts for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tribo.kernels.samples import BATH, SPRINGS, TORSIONAL, WITHIN
from tribo.kernels.status import Status
from tribo.run.integrate import Integration
from tribo.run.layout import Layout
from tribo.run.ledger import assemble
from tribo.run.motion import internal_energy, motions
from tribo.run.samples import Samples

# Energy that appears, in units of that at the start, from which a run counts as lost: a step that
# is too long for a spring multiplies it by 1e3 in tens of steps, an inaccurate one does not.
RUNAWAY = 1e3


def up_to_runaway(layout: Layout, run: Integration) -> Integration:
    """The run, or its part up to the first sample at which its energy has run away.

    That is where the energy exceeds RUNAWAY times that at the start, and its change differs from
    the applied work by more than any applied work and any energy of contact or of fields so far.
    Without a ledger it is not known.
    """
    samples = run.samples
    if layout.model.ledger is None:
        return run
    with np.errstate(over="ignore", invalid="ignore"):  # an energy may exceed all numbers
        grown = grows(layout, samples)
        if not np.any(grown):
            return run
        system = assemble(layout, samples).system
        excess = np.abs(system["total_energy_change"] - system["applied_work"])
        known = np.maximum(np.abs(samples.contact), np.abs(samples.field))
        known = np.maximum(known, np.abs(system["applied_work"]))
        lost = np.flatnonzero(grown & (excess > np.maximum.accumulate(known)))
    if lost.size == 0:
        return run
    kept = samples.at(samples.t[: lost[0] + 1])
    return replace(run, recorded=lambda: kept, _samples=kept, status=Status.ENERGY_RUNAWAY)


def grows(layout: Layout, samples: Samples) -> np.ndarray:
    """Whether the energy exceeds RUNAWAY times that at the start, (times,)."""
    with np.errstate(over="ignore", invalid="ignore"):  # an energy may exceed all numbers
        energy = _energy(layout, samples)
        return np.asarray(energy > RUNAWAY * samples.at_start(energy))


def _energy(layout: Layout, samples: Samples) -> np.ndarray:
    """Sum of the magnitudes of all energies, in the frame of the surfaces' mean velocity."""
    mean = np.mean([surface.velocity for surface in layout.scene.surfaces], axis=0)
    stores = samples.stored[:, :, [SPRINGS, BATH, TORSIONAL, WITHIN]]
    energy = np.sum(np.abs(stores), axis=(1, 2)) + np.abs(samples.contact) + np.abs(samples.field)
    for index in range(len(layout.scene.surfaces)):
        for batch, m in motions(layout, samples, index):
            vx, vy = batch.velocity - mean[:, None]
            moving = 0.5 * ((m.vx + vx) ** 2 + (m.vy + vy) ** 2)
            internal = internal_energy(batch.asperites, m.omega, m.nu, m.swing - m.phi)
            energy = energy + moving @ batch.asperites.mass + np.sum(internal, axis=1)
    return np.asarray(energy)
