"""The ledger of surfaces as wholes and of the system, from sums over asperites."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from tribo.kernels.samples import BATH, MOMENTUM_X, MOMENTUM_Y, SPRINGS, TORSIONAL, WITHIN
from tribo.run.accounts import Account
from tribo.run.layout import Layout
from tribo.run.motion import Batch, Motion
from tribo.run.quantities import Table
from tribo.run.samples import Samples


@dataclass(frozen=True, eq=False)
class Sums:
    """Sums over the asperites of a surface; arrays (times,)."""

    px: np.ndarray  # momentum in the surface's first frame, without its bath's
    py: np.ndarray
    moving: np.ndarray  # kinetic energy of the centres of mass in that frame
    internal: np.ndarray  # change of the asperites' internal energy
    work: np.ndarray  # of the external forces, in the surface's first frame
    jx: np.ndarray  # impulse of the external forces
    jy: np.ndarray
    outside: np.ndarray  # work of f2, f_L, f_R and f_T in the laboratory

    def __add__(self, other: Sums) -> Sums:
        return Sums(*(getattr(self, f.name) + getattr(other, f.name) for f in fields(self)))


def batch_sums(batch: Batch, m: Motion, forces: dict[str, Account], energies: Table) -> Sums:
    """The sums over one batch."""
    mass = batch.asperites.mass

    # Sums, unlike products of matrices, have the same bits for any number of times.
    def total(*values: np.ndarray) -> np.ndarray:
        return np.sum(sum(values), axis=1)

    external = [account for name, account in forces.items() if name != "w_int"]
    outside = [forces[name].work(batch.velocity) for name in ("w2", "wL", "wR", "w_T")]
    return Sums(
        px=total(m.vx * mass),
        py=total(m.vy * mass),
        moving=total(0.5 * (m.vx**2 + m.vy**2) * mass),
        internal=total(energies["delta_e_int"]),
        work=total(*(e.about + e.pseudo for e in external)),
        jx=total(*(e.jx for e in external)),
        jy=total(*(e.jy for e in external)),
        outside=total(*outside),
    )


def block_table(layout: Layout, k: int, sums: Sums, samples: Samples) -> Table:
    """The ledger of surface k as a whole; V is the velocity of the centre of all its masses."""
    record = layout.surfaces[k]
    velocity = layout.scene.surfaces[k].velocity
    stored = samples.stored[:, k]
    lag_x = (sums.px + stored[:, MOMENTUM_X]) / record.total_mass
    lag_y = (sums.py + stored[:, MOMENTUM_Y]) / record.total_mass
    bulk = 0.5 * record.total_mass * (lag_x**2 + lag_y**2)
    moving = record.total_mass * (velocity[0] * lag_x + velocity[1] * lag_y) + bulk
    within = sums.moving + sums.internal - bulk
    for store in (SPRINGS, BATH, TORSIONAL, WITHIN):
        within = within + stored[:, store]
    boost = velocity[0] * sums.jx + velocity[1] * sums.jy
    # Without an account, surfaces keep their momentum, or a constraint provides its change.
    pseudowork = samples.s[:, record.acc_block] if record.acc_block >= 0 else bulk - bulk[0]
    return {
        "W": sums.work + boost,
        "W_ps": pseudowork + boost,
        "delta_K": moving - moving[0],
        "delta_E_int": within - within[0],
    }


def system_table(
    layout: Layout, sums: list[Sums], blocks: dict[str, Table], samples: Samples
) -> Table:
    """The energy of the whole system, and the work done on it from outside."""
    stored = sum(block["delta_K"] + block["delta_E_int"] for block in blocks.values())
    potential = samples.contact + samples.field
    applied = sum((item.outside for item in sums[1:]), start=sums[0].outside)
    for field in layout.model.fields or ():
        if field.account >= 0:
            applied = applied + samples.s[:, field.account]
    with np.errstate(invalid="ignore"):  # the energy of bobs at one place is infinite
        change = potential - potential[0]
    return {
        "contact_energy": samples.contact,
        "total_energy_change": stored + change,
        "applied_work": applied,
    }
