"""The ledger: every reported quantity, from the raw state and accounts of a run.

The identities that must hold, and by which the accounts are audited:

    asperite   w - w_ps = delta_e_int,  w_ps = delta_k_trans
    surface    W_ps = delta_K,  W - W_ps = delta_E_int
    system     total_energy_change = applied_work

Kernels keep their books in the frame of each surface's initial velocity V; here
work = (about the centre of mass) + V . J + (pseudowork in that frame).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from tribo.kernels.records import FORCED
from tribo.kernels.samples import BATH, MOMENTUM_X, MOMENTUM_Y, SPRINGS, TORSIONAL, WITHIN
from tribo.run.layout import Layout

# What each reported quantity is, which fixes the scale that its accuracy is relative to.
ASPERITE_KINDS = {
    "theta": "angle",
    "phi": "angle",
    "omega": "rate",
    "nu": "rate",
    "x_cm": "length",
    "y_cm": "length",
    "vx_cm": "velocity",
    "vy_cm": "velocity",
    "x_bob": "length",
    "y_bob": "length",
    "x_bar": "length",
    "y_bar": "length",
    "w1": "energy",
    "w2": "energy",
    "wL": "energy",
    "wR": "energy",
    "w_int": "energy",
    "w": "energy",
    "w1_ps": "energy",
    "w2_ps": "energy",
    "w_int_ps": "energy",
    "w_ps": "energy",
    "delta_k_trans": "energy",
    "delta_e_int": "energy",
}
# Reported of the surfaces that have them.
OPTIONAL_KINDS = {
    "w_field": "energy",
    "w_field_ps": "energy",
    "w_T": "energy",
    "w_T_ps": "energy",
    "heat": "energy",
}
BLOCK_KINDS = {"W": "energy", "W_ps": "energy", "delta_K": "energy", "delta_E_int": "energy"}
SYSTEM_KINDS = {
    "contact_energy": "energy",
    "total_energy_change": "energy",
    "applied_work": "energy",
}

Table = dict[str, np.ndarray]
MANY = 50_000  # asperites of a surface, above which its ledger is made out in parts


@dataclass(frozen=True, eq=False)
class Samples:
    """The raw samples of a run, one row a time; see tribo.run.layout and kernels.samples."""

    t: np.ndarray  # (times,)
    y: np.ndarray  # (times, 2 core coordinates)
    s: np.ndarray  # (times, accounts)
    contact: np.ndarray  # (times,) energy
    field: np.ndarray  # (times,) energy
    stored: np.ndarray  # (times, surfaces, STORED)

    def at(self, times: np.ndarray) -> Samples:
        """The samples at some of the times."""
        return self._rows(np.isin(self.t, times))

    def first(self) -> Samples:
        """The start alone."""
        return self._rows(np.array([0]))

    def last(self) -> Samples:
        """The end alone."""
        return self._rows(np.array([-1]))

    def ends(self) -> Samples:
        """The start and the end."""
        return self._rows(np.unique([0, self.t.size - 1]))

    def then(self, later: Samples) -> Samples:
        """These samples and later ones."""
        pairs = ((getattr(self, f.name), getattr(later, f.name)) for f in fields(self))
        return Samples(*(np.concatenate(pair) for pair in pairs))

    def _rows(self, k: np.ndarray) -> Samples:
        return Samples(*(getattr(self, f.name)[k] for f in fields(self)))


@dataclass(frozen=True, eq=False)
class Part:
    """Some asperites of one surface: the ledger is made out part by part, to need little room."""

    index: int  # of the surface
    place: slice  # of the asperites among all
    surface: Any  # record of kernels.records.SURFACE
    asperites: Any  # recarray of kernels.records.ASPERITE
    velocity: np.ndarray  # (2,) initial velocity of the surface, in the laboratory


@dataclass(frozen=True, eq=False)
class Motion:
    """The raw motion in each surface's first frame, every array (times, asperites)."""

    t: np.ndarray  # (times, 1)
    swing: np.ndarray  # theta - rest
    phi: np.ndarray
    omega: np.ndarray
    nu: np.ndarray
    x: np.ndarray  # how far the centre of mass has left its uniform motion
    y: np.ndarray
    vx: np.ndarray
    vy: np.ndarray


@dataclass(frozen=True, eq=False)
class Account:
    """One force's entries; arrays (times, asperites)."""

    about: np.ndarray  # work about the centre of mass: the same in every frame
    jx: np.ndarray  # impulse
    jy: np.ndarray
    pseudo: np.ndarray  # pseudowork in the surface's first frame

    def pseudowork(self, velocity: np.ndarray) -> np.ndarray:
        """In the laboratory, where the surface's first velocity is `velocity` (2,)."""
        return self.pseudo + velocity[0] * self.jx + velocity[1] * self.jy

    def work(self, velocity: np.ndarray) -> np.ndarray:
        """In the laboratory."""
        return self.about + self.pseudowork(velocity)


@dataclass(frozen=True, eq=False)
class Sums:
    """What the ledger of a surface as a whole is made of; arrays (times,)."""

    px: np.ndarray  # momentum in the surface's first frame, without its bath's
    py: np.ndarray
    moving: np.ndarray  # kinetic energy of the centres of mass there
    internal: np.ndarray  # change of the asperites' internal energy
    work: np.ndarray  # of the external forces, in the surface's first frame
    jx: np.ndarray  # impulse of the external forces
    jy: np.ndarray
    outside: np.ndarray  # work of f2, f_L, f_R and f_T in the laboratory

    def __add__(self, other: Sums) -> Sums:
        return Sums(*(getattr(self, f.name) + getattr(other, f.name) for f in fields(self)))


@dataclass(frozen=True, eq=False)
class Ledger:
    """All that a run reports, in the laboratory."""

    surfaces: dict[str, Table]  # surface -> quantity -> (times, asperites)
    blocks: dict[str, Table]  # surface -> quantity -> (times,)
    system: Table  # quantity -> (times,)

    def series(self, name: str) -> list[np.ndarray]:
        """Every series of that name: of each surface that has it, or of the system.

        A surface's alone if it is named too, as "upper.w1".
        """
        surface, _, name = name.rpartition(".")
        tables = [self.system, *self.surfaces.values(), *self.blocks.values()]
        if surface:
            tables = [self.surfaces.get(surface, {}), self.blocks.get(surface, {})]
        return [table[name] for table in tables if name in table]

    def rows(self, kept: Any) -> Ledger:
        """The same at some of the times: a slice, indices or a mask."""
        return Ledger(
            {name: _rows(table, kept) for name, table in self.surfaces.items()},
            {name: _rows(table, kept) for name, table in self.blocks.items()},
            _rows(self.system, kept),
        )


def _rows(table: Table, kept: Any) -> Table:
    return {name: values[kept] for name, values in table.items()}


def ledger(layout: Layout, samples: Samples) -> Ledger:
    """Put together the ledger from raw samples, the first of which is the start."""
    return _made_out(layout, samples, series=True)


def bulk_ledger(layout: Layout, samples: Samples) -> Ledger:
    """The ledger without the asperites' series: the surfaces as wholes, and the system."""
    return _made_out(layout, samples, series=False)


def motions(layout: Layout, samples: Samples, index: int) -> Iterator[tuple[Part, Motion]]:
    """The motion of surface `index`, part by part."""
    for part in _parts(layout, index):
        yield part, _motion(layout, part, samples)


def _made_out(layout: Layout, samples: Samples, series: bool) -> Ledger:
    surfaces: dict[str, Table] = {}
    blocks: dict[str, Table] = {}
    outside: Any = 0.0
    for k, surface in enumerate(layout.scene.surfaces):
        tables = []
        sums = []
        for part, motion in motions(layout, samples, k):
            accounts = _accounts(part, samples.s)
            energies = _energies(part, motion)
            sums.append(_sums(part, motion, accounts, energies))
            if series:
                works = _works(part, accounts) | _optional(layout, part, accounts)
                tables.append(_places(layout, part, motion) | works | energies)
        whole = sum(sums[1:], start=sums[0])
        blocks[surface.name] = _block(layout, k, whole, samples)
        outside = outside + whole.outside
        if series:
            surfaces[surface.name] = _side_by_side(tables)
    return Ledger(surfaces, blocks, _system(layout, outside, blocks, samples))


def _parts(layout: Layout, index: int) -> Iterator[Part]:
    """The asperites of a surface, at most MANY at a time."""
    whole = layout.parts[layout.scene.surfaces[index].name]
    for start in range(whole.start, whole.stop, MANY):
        place = slice(start, min(start + MANY, whole.stop))
        yield Part(
            index,
            place,
            layout.model.surfaces[index],
            layout.model.asperites[place],
            np.array(layout.scene.surfaces[index].velocity),
        )


def _side_by_side(tables: list[Table]) -> Table:
    """One table from those of the parts; theirs are given up one by one."""
    if len(tables) == 1:
        return tables[0]
    return {
        name: np.concatenate([table.pop(name) for table in tables], axis=1)
        for name in list(tables[0])
    }


def _columns(slots: np.ndarray, table: np.ndarray, absent: np.ndarray | float = 0.0) -> np.ndarray:
    """Columns of a table by slot; `absent` where the slot is -1."""
    shape = (table.shape[0], slots.size)
    present = slots >= 0
    if not np.any(present):
        return np.broadcast_to(np.asarray(absent), shape)
    if np.all(present):
        return table[:, slots]
    values = np.empty(shape)
    values[:] = absent
    values[:, present] = table[:, slots[present]]
    return values


def _motion(layout: Layout, part: Part, samples: Samples) -> Motion:
    a = part.asperites
    q, v = samples.y[:, : layout.core], samples.y[:, layout.core :]
    time = samples.t[:, None]
    return Motion(
        t=time,
        swing=q[:, part.place],
        phi=_columns(a.dof_phi, q, a.phi + a.nu * time),
        omega=v[:, part.place],
        nu=_columns(a.dof_phi, v, a.nu),
        x=_columns(a.dof_x, q),
        y=_columns(a.dof_y, q),
        vx=_columns(a.dof_x, v),
        vy=_columns(a.dof_y, v),
    )


def rod_direction(facing: np.ndarray, swing: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """sin(theta) and cos(theta): the bob is at r1 = r_cm + l1 (sin theta, -cos theta)."""
    return facing * np.sin(swing), facing * np.cos(swing)


def _places(layout: Layout, part: Part, m: Motion) -> Table:
    """Angles, rates, places and velocities."""
    a = part.asperites
    rest = np.where(a.facing > 0.0, 0.0, np.pi)
    x = layout.origin[0] + (a.x + part.velocity[0] * m.t + m.x)
    y = layout.origin[1] + (a.y + part.velocity[1] * m.t + m.y)
    sin, cos = rod_direction(a.facing, m.swing)
    return {
        "theta": m.swing + rest,
        "phi": m.phi,
        "omega": m.omega,
        "nu": m.nu,
        "x_cm": x,
        "y_cm": y,
        "vx_cm": part.velocity[0] + m.vx,
        "vy_cm": part.velocity[1] + m.vy,
        "x_bob": x + a.l1 * sin,
        "y_bob": y - a.l1 * cos,
        "x_bar": x - a.l2 * sin,
        "y_bar": y + a.l2 * cos,
    }


def _accounts(part: Part, s: np.ndarray) -> dict[str, Account]:
    """Every force's account, by the name of its work."""
    a = part.asperites

    def column(slots: np.ndarray, k: int) -> np.ndarray:
        return _columns(np.where(slots >= 0, slots + k, -1), s)

    def point(slots: np.ndarray) -> Account:
        jx, jy, about, pseudo = (column(slots, k) for k in range(4))
        return Account(about, jx, jy, pseudo)

    jx, jy, about_x, about_y = (column(a.acc_contact, k) for k in range(4))
    slide_x, slide_y = (column(a.acc_slide, k) for k in range(2))
    contact = Account(a.l1 * (about_x + about_y), jx, jy, slide_x + slide_y)

    # f2 = -(held f1_x, f1_y), with held = 1 for a forced drive and 0 for a free one, unless the
    # drive has an account of its own.
    held = 1.0 if part.surface.drive == FORCED else 0.0
    own = a.acc_drive >= 0
    drive = Account(
        np.where(own, -a.l2 * column(a.acc_drive, 2), a.l2 * (held * about_x + about_y)),
        np.where(own, column(a.acc_drive, 0), -held * jx),
        np.where(own, column(a.acc_drive, 1), -jy),
        np.where(own, column(a.acc_drive, 3), -(held * slide_x + slide_y)),
    )

    left, right, end_x, end_y, end_pseudo = (column(a.acc_ends, k) for k in range(5))
    user = [column(a.acc_user_ends, k) for k in range(8)]
    return {
        "w1": contact,
        "w2": drive,
        "wL": Account(left + user[0], end_x + user[2], end_y + user[3], end_pseudo + user[6]),
        "wR": Account(right + user[1], user[4] - end_x, user[5] - end_y, user[7] - end_pseudo),
        "w_int": point(a.acc_internal),
        "w_field": point(a.acc_field),
        "w_T": point(a.acc_thermal),
    }


def _works(part: Part, accounts: dict[str, Account]) -> Table:
    works = {name: account.work(part.velocity) for name, account in accounts.items()}
    pseudo = {f"{name}_ps": account.pseudowork(part.velocity) for name, account in accounts.items()}
    return (
        {name: works[name] for name in ("w1", "w2", "wL", "wR", "w_int")}
        | {"w": np.sum(list(works.values()), axis=0)}
        | {name: pseudo[name] for name in ("w1_ps", "w2_ps", "w_int_ps")}
        | {"w_ps": np.sum(list(pseudo.values()), axis=0)}
    )


def _optional(layout: Layout, part: Part, accounts: dict[str, Account]) -> Table:
    """What is reported of a surface because it has a field or a reservoir."""
    surface = layout.scene.surfaces[part.index]
    table = {}
    if any(surface.name in item.on for item in layout.scene.fields):
        table["w_field"] = accounts["w_field"].work(part.velocity)
        table["w_field_ps"] = accounts["w_field"].pseudowork(part.velocity)
    if surface.langevin:
        account, record = accounts["w_T"], part.surface
        table["w_T"] = account.work(part.velocity)
        table["w_T_ps"] = account.pseudowork(part.velocity)
        reservoir = record.reservoir_x * account.jx + record.reservoir_y * account.jy
        table["heat"] = reservoir - account.about - account.pseudo
    return table


def internal_energy(part: Part, m: Motion) -> np.ndarray:
    """1/2 I omega^2 + 1/2 i2 nu^2 + 1/2 kappa (theta - rest - phi)^2, (times, asperites)."""
    a = part.asperites
    return 0.5 * (a.inertia * m.omega**2 + a.i2 * m.nu**2 + a.kappa * (m.swing - m.phi) ** 2)


def _energies(part: Part, m: Motion) -> Table:
    a = part.asperites
    internal = internal_energy(part, m)
    lag = part.velocity[0] * m.vx + part.velocity[1] * m.vy + 0.5 * (m.vx**2 + m.vy**2)
    return {
        "delta_k_trans": a.mass * lag,
        "delta_e_int": internal - internal[0],
    }


def _sums(part: Part, m: Motion, accounts: dict[str, Account], energies: Table) -> Sums:
    """What the part adds to its surface."""
    mass = part.asperites.mass

    def total(*values: np.ndarray) -> np.ndarray:
        return np.sum(sum(values), axis=1)

    external = [account for name, account in accounts.items() if name != "w_int"]
    outside = [accounts[name].work(part.velocity) for name in ("w2", "wL", "wR", "w_T")]
    return Sums(
        px=m.vx @ mass,
        py=m.vy @ mass,
        moving=0.5 * (m.vx**2 + m.vy**2) @ mass,
        internal=total(energies["delta_e_int"]),
        work=total(*(e.about + e.pseudo for e in external)),
        jx=total(*(e.jx for e in external)),
        jy=total(*(e.jy for e in external)),
        outside=total(*outside),
    )


def _block(layout: Layout, k: int, sums: Sums, samples: Samples) -> Table:
    """The ledger of surface k as a whole; V is the velocity of the centre of all its masses."""
    record = layout.model.surfaces[k]
    velocity = layout.scene.surfaces[k].velocity
    stored = samples.stored[:, k]
    lag_x = (sums.px + stored[:, MOMENTUM_X]) / record.total_mass
    lag_y = (sums.py + stored[:, MOMENTUM_Y]) / record.total_mass
    bulk = 0.5 * record.total_mass * (lag_x**2 + lag_y**2)
    moving = record.total_mass * (velocity[0] * lag_x + velocity[1] * lag_y) + bulk
    within = sums.moving + sums.internal - bulk
    for kept in (SPRINGS, BATH, TORSIONAL, WITHIN):
        within = within + stored[:, kept]
    boost = velocity[0] * sums.jx + velocity[1] * sums.jy
    pseudowork = samples.s[:, record.acc_block] if record.acc_block >= 0 else 0.0
    return {
        "W": sums.work + boost,
        "W_ps": pseudowork + boost,
        "delta_K": moving - moving[0],
        "delta_E_int": within - within[0],
    }


def _system(layout: Layout, outside: Any, blocks: dict[str, Table], samples: Samples) -> Table:
    """Energy of everything, and the work done on it from outside."""
    stored = sum(block["delta_K"] + block["delta_E_int"] for block in blocks.values())
    potential = samples.contact + samples.field
    applied = outside
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
