"""The guard of runs with equal steps: energy that no work accounts for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tribo.kernels.samples import BATH, SPRINGS, TORSIONAL, WITHIN
from tribo.kernels.status import Status
from tribo.run.integrate import Integration
from tribo.run.layout import Layout
from tribo.run.ledger import assemble_totals
from tribo.run.motion import internal_energy, motions

# Energy that appears, in units of that at the start, from which a run counts as lost: a step that
# is too long for a spring multiplies it by 1e3 in tens of steps, an inaccurate one does not.
RUNAWAY = 1e3


def up_to_runaway(layout: Layout, run: Integration) -> Integration:
    """The run, or its part up to the first sample at which its energy has run away.

    That is where the change of the total energy differs from the applied work by more than RUNAWAY
    times the energy at the start, more than any energy of contact and more than any applied work.
    """
    samples = run.samples
    with np.errstate(over="ignore", invalid="ignore"):  # an energy may exceed all numbers
        system = assemble_totals(layout, samples).system
        excess = np.abs(system["total_energy_change"] - system["applied_work"])
        known = np.maximum(np.abs(samples.contact), np.abs(system["applied_work"]))
        most = np.maximum(RUNAWAY * _energy_at_start(layout, run), np.maximum.accumulate(known))
        lost = np.flatnonzero(excess > most)
    if lost.size == 0:
        return run
    kept = samples.at(samples.t[: lost[0] + 1])
    return replace(run, recorded=lambda: kept, status=Status.ENERGY_RUNAWAY)


def _energy_at_start(layout: Layout, run: Integration) -> float:
    """Energy at the first sample, of motion relative to the surfaces' mean velocity."""
    first = run.samples.first()
    mean = np.mean([surface.velocity for surface in layout.scene.surfaces], axis=0)
    stores = first.stored[0][:, [SPRINGS, BATH, TORSIONAL, WITHIN]]
    energy = float(np.sum(np.abs(stores)) + abs(first.contact[0]) + abs(first.field[0]))
    for index in range(len(layout.scene.surfaces)):
        for batch, m in motions(layout, first, index):
            vx, vy = batch.velocity - mean
            speed = np.hypot(m.vx + vx, m.vy + vy)
            internal = internal_energy(batch.asperites, m.omega, m.nu, m.swing - m.phi)
            energy += float(np.sum(0.5 * batch.asperites.mass * speed**2 + internal))
    return energy
