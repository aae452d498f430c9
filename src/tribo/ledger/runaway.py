"""The guard of runs with equal steps: energy that no work accounts for."""

from __future__ import annotations

import numpy as np

from tribo.kernels.samples import BATH, SPRINGS, TORSIONAL, WITHIN
from tribo.layout.layout import Layout
from tribo.ledger.ledger import assemble
from tribo.ledger.motion import motions
from tribo.ledger.quantities import Table
from tribo.ledger.samples import Samples

# Energy that appears, in units of that at the start, from which a run counts as lost: a step that
# is too long for a spring multiplies it by 1e3 in tens of steps, an inaccurate one does not.
RUNAWAY = 1e3


def lost_sample(layout: Layout, samples: Samples) -> int | None:
    """The index of the first sample at which the energy has run away, if there is one.

    Without a ledger it is not known.
    """
    if layout.model.ledger is None or not np.any(grows(layout, samples)):
        return None
    return first_lost(layout, samples, assemble(layout, samples).system)[0]


def first_lost(
    layout: Layout, samples: Samples, system: Table, known: float = 0.0
) -> tuple[int | None, float]:
    """The index of the first sample at which the energy has run away, if there is one.

    That is where the energy exceeds RUNAWAY times that at the start, and its change differs from
    the applied work by more than any applied work and any energy of contact or of fields so far.
    `system` is the ledger of the system at these samples of a run, the first of which is its start.
    `known` is the largest of those works and energies before; the largest so far is returned too.
    """
    with np.errstate(over="ignore", invalid="ignore"):  # an energy may exceed all numbers
        excess = np.abs(system["total_energy_change"] - system["applied_work"])
        terms = np.abs([samples.contact, samples.field, system["applied_work"]])
        so_far = np.maximum.accumulate(np.maximum(np.max(terms, axis=0), known))
        lost = np.flatnonzero(grows(layout, samples) & (excess > so_far))
    return (int(lost[0]) if lost.size else None), float(so_far[-1])


@np.errstate(over="ignore", invalid="ignore")  # an energy may exceed all numbers
def grows(layout: Layout, samples: Samples) -> np.ndarray:
    """Whether the energy exceeds RUNAWAY times that at the start, (times,).

    It is the sum of the magnitudes of all energies, in the frame of the surfaces' mean velocity.
    """
    surfaces = range(len(layout.scene.surfaces))
    mean = np.mean([np.asarray(layout.view.velocity_of(index)) for index in surfaces], axis=0)
    stores = samples.stored[:, :, [SPRINGS, BATH, TORSIONAL, WITHIN]]
    energy = np.sum(np.abs(stores), axis=(1, 2)) + np.abs(samples.contact) + np.abs(samples.field)
    for index in surfaces:
        for span, m in motions(layout.view, samples, index):
            vx, vy = span.velocity - mean[..., None]
            moving = 0.5 * ((m.vx + vx) ** 2 + (m.vy + vy) ** 2)
            energy = energy + np.sum(moving * span.asperites.mass + m.energy, axis=1)
    return np.asarray(energy > RUNAWAY * samples.at_start(energy))
