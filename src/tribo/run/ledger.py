"""The ledger: every reported quantity, from the raw samples of a run.

The identities that must hold, and by which the accounts are audited:

    asperite   w - w_ps = delta_e_int,  w_ps = delta_k_trans
    surface    W_ps = delta_K,  W - W_ps = delta_E_int
    system     total_energy_change = applied_work
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from tribo.kernels.kinematics import bar_position, bob_position
from tribo.run.accounts import Account, accounts
from tribo.run.layout import Layout
from tribo.run.motion import Batch, Motion, internal_energy, motions, swing_direction
from tribo.run.quantities import Table
from tribo.run.samples import Samples
from tribo.run.totals import Sums, batch_sums, block_table, system_table


@dataclass(frozen=True, eq=False)
class Ledger:
    """All quantities that a run reports, in the laboratory.

    Attributes
    ----------
    t : ndarray, (times,)
        The recorded times.
    surfaces : dict
        Surface -> quantity -> (times, asperites).
    blocks : dict
        Surface -> quantity of the surface as a whole -> (times,).
    system : dict
        Quantity of the system -> (times,).
    """

    t: np.ndarray  # (times,)
    surfaces: dict[str, Table]  # surface -> quantity -> (times, asperites)
    blocks: dict[str, Table]  # surface -> quantity -> (times,)
    system: Table  # quantity -> (times,)

    def series(self, name: str) -> list[np.ndarray]:
        """All series of a quantity, "w1", or that of one surface, "upper.w1"."""
        surface, _, name = name.rpartition(".")
        tables = [self.system, *self.surfaces.values(), *self.blocks.values()]
        if surface:
            tables = [self.surfaces.get(surface, {}), self.blocks.get(surface, {})]
        return [table[name] for table in tables if name in table]

    def rows(self, selected: slice | np.ndarray) -> Ledger:
        """The ledger at some of its times: a slice, indices or a mask."""
        return Ledger(
            self.t[selected],
            {name: _rows(table, selected) for name, table in self.surfaces.items()},
            {name: _rows(table, selected) for name, table in self.blocks.items()},
            _rows(self.system, selected),
        )


def _rows(table: Table, selected: slice | np.ndarray) -> Table:
    return {name: values[selected] for name, values in table.items()}


# In a run that stopped because values were not finite, the last are infinite or NaN here too.
_with_infinities = np.errstate(over="ignore", invalid="ignore")


@_with_infinities
def assemble(layout: Layout, samples: Samples) -> Ledger:
    """The ledger of raw samples, the first of which is the start of the run."""
    surfaces: dict[str, Table] = {}
    sums = []
    for k, surface in enumerate(layout.scene.surfaces):
        tables, terms = [], []
        for batch, motion, forces, energies in entries(layout, samples, k):
            terms.append(batch_sums(batch, motion, forces, energies))
            works = _works(batch, forces) | _optional(layout, batch, forces)
            tables.append(_positions(layout, batch, motion) | works | energies)
        surfaces[surface.name] = _side_by_side(tables)
        sums.append(sum(terms[1:], start=terms[0]))
    return _with_totals(layout, samples, surfaces, sums)


@_with_infinities
def assemble_totals(layout: Layout, samples: Samples) -> Ledger:
    """The ledger of surfaces as wholes and of the system, without the series of asperites."""
    sums = []
    for k in range(len(layout.scene.surfaces)):
        terms = [batch_sums(*entry) for entry in entries(layout, samples, k)]
        sums.append(sum(terms[1:], start=terms[0]))
    return _with_totals(layout, samples, {}, sums)


def entries(
    layout: Layout, samples: Samples, index: int
) -> Iterator[tuple[Batch, Motion, dict[str, Account], Table]]:
    """Motion, accounts and changes of energy of each batch of surface `index`."""
    for batch, motion in motions(layout, samples, index):
        yield batch, motion, accounts(batch, motion, samples.s), _energies(batch, motion)


def _with_totals(
    layout: Layout, samples: Samples, surfaces: dict[str, Table], sums: list[Sums]
) -> Ledger:
    """The ledger of the asperites' series, completed by the sums over each surface."""
    blocks = {
        surface.name: block_table(layout, k, sums[k], samples)
        for k, surface in enumerate(layout.scene.surfaces)
    }
    return Ledger(samples.t, surfaces, blocks, system_table(layout, sums, blocks, samples))


def _side_by_side(tables: list[Table]) -> Table:
    """One table from those of the batches, whose arrays are released one by one."""
    if len(tables) == 1:
        return tables[0]
    return {
        name: np.concatenate([table.pop(name) for table in tables], axis=1)
        for name in list(tables[0])
    }


def _positions(layout: Layout, batch: Batch, m: Motion) -> Table:
    """Angles, angular rates, positions and velocities."""
    a = batch.asperites
    rest = np.where(a.facing > 0.0, 0.0, np.pi)
    x = layout.origin[0] + (a.x + batch.velocity[0] * m.t + m.x)
    y = layout.origin[1] + (a.y + batch.velocity[1] * m.t + m.y)
    tx, ty = swing_direction(a.facing, m.swing)
    x_bob, y_bob = bob_position(x, y, a.l1, tx, ty)
    x_bar, y_bar = bar_position(x, y, a.l2, tx, ty)
    return {
        "theta": m.swing + rest,
        "phi": m.phi,
        "omega": m.omega,
        "nu": m.nu,
        "x_cm": x,
        "y_cm": y,
        "vx_cm": batch.velocity[0] + m.vx,
        "vy_cm": batch.velocity[1] + m.vy,
        "x_bob": x_bob,
        "y_bob": y_bob,
        "x_bar": x_bar,
        "y_bar": y_bar,
    }


def _works(batch: Batch, forces: dict[str, Account]) -> Table:
    """Works and pseudoworks of each asperite, in the laboratory."""
    works = {name: account.work(batch.velocity) for name, account in forces.items()}
    pseudo = {f"{name}_ps": account.pseudowork(batch.velocity) for name, account in forces.items()}
    return (
        {name: works[name] for name in ("w1", "w2", "wL", "wR", "w_int")}
        | {"w": np.sum(list(works.values()), axis=0)}
        | {name: pseudo[name] for name in ("w1_ps", "w2_ps", "w_int_ps")}
        | {"w_ps": np.sum(list(pseudo.values()), axis=0)}
    )


def _optional(layout: Layout, batch: Batch, forces: dict[str, Account]) -> Table:
    """Works and heat that only surfaces with a field or a reservoir report."""
    surface = layout.scene.surfaces[batch.index]
    table = {}
    if any(surface.name in item.on for item in layout.scene.fields):
        table["w_field"] = forces["w_field"].work(batch.velocity)
        table["w_field_ps"] = forces["w_field"].pseudowork(batch.velocity)
    if surface.langevin:
        account, record = forces["w_T"], batch.surface
        table["w_T"] = account.work(batch.velocity)
        table["w_T_ps"] = account.pseudowork(batch.velocity)
        reservoir = record.reservoir_x * account.jx + record.reservoir_y * account.jy
        table["heat"] = reservoir - account.about - account.pseudo
    return table


def _energies(batch: Batch, m: Motion) -> Table:
    """Changes of the translational kinetic and of the internal energy of each asperite."""
    internal = internal_energy(batch.asperites, m.omega, m.nu, m.swing - m.phi)
    lag = batch.velocity[0] * m.vx + batch.velocity[1] * m.vy + 0.5 * (m.vx**2 + m.vy**2)
    return {
        "delta_k_trans": batch.asperites.mass * (lag - lag[0]),
        "delta_e_int": internal - internal[0],
    }
