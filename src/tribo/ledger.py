"""The ledger: every reported quantity, from the raw state and accounts of a run.

The identities that must hold, and by which the accounts are audited:

    asperite   w - w_ps = delta_e_int,  w_ps = delta_k_trans
    surface    W_ps = delta_K,  W - W_ps = delta_E_int
    system     total_energy_change = applied_work

Kernels keep their books in the frame of each surface's initial velocity V; here
work = (about the centre of mass) + V . J + (pseudowork in that frame).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tribo.kernels.records import FORCED
from tribo.layout import Layout

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
BLOCK_KINDS = {"W": "energy", "W_ps": "energy", "delta_K": "energy", "delta_E_int": "energy"}
SYSTEM_KINDS = {
    "contact_energy": "energy",
    "total_energy_change": "energy",
    "applied_work": "energy",
}

Table = dict[str, np.ndarray]


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
        """In the laboratory, where the surface's first velocity is `velocity` (asperites, 2)."""
        return self.pseudo + velocity[:, 0] * self.jx + velocity[:, 1] * self.jy

    def work(self, velocity: np.ndarray) -> np.ndarray:
        """In the laboratory."""
        return self.about + self.pseudowork(velocity)


@dataclass(frozen=True, eq=False)
class Ledger:
    """All that a run reports, in the laboratory."""

    surfaces: dict[str, Table]  # surface -> quantity -> (times, asperites)
    blocks: dict[str, Table]  # surface -> quantity -> (times,)
    system: Table  # quantity -> (times,)


def ledger(layout: Layout, t: np.ndarray, y: np.ndarray, s: np.ndarray, u: np.ndarray) -> Ledger:
    """Put together the ledger from samples of the state y, the accounts s and the contact energy u.

    The arrays have one row a sample; t is (times,), u is (times,).
    """
    motion = _motion(layout, t, y)
    accounts = _accounts(layout, motion, s)
    energies = _energies(layout, motion)
    whole = _places(layout, motion) | _works(layout, accounts) | energies
    surfaces = {
        name: {quantity: values[:, part] for quantity, values in whole.items()}
        for name, part in layout.parts.items()
    }
    blocks = {
        surface.name: _block(layout, k, motion, accounts, energies["delta_e_int"], s)
        for k, surface in enumerate(layout.scene.surfaces)
    }
    stored = sum(block["delta_K"] + block["delta_E_int"] for block in blocks.values())
    applied = whole["w2"] + whole["wL"] + whole["wR"]
    system = {
        "contact_energy": u,
        "total_energy_change": stored + (u - u[0]),
        "applied_work": np.sum(applied, axis=1),
    }
    return Ledger(surfaces, blocks, system)


def _columns(slots: np.ndarray, table: np.ndarray, absent: np.ndarray | float = 0.0) -> np.ndarray:
    """Columns of a table by slot; `absent` where the slot is -1."""
    values = np.empty((table.shape[0], slots.size))
    values[:] = absent
    values[:, slots >= 0] = table[:, slots[slots >= 0]]
    return values


def _motion(layout: Layout, t: np.ndarray, y: np.ndarray) -> Motion:
    a = layout.model.asperites
    q, v = y[:, : layout.coordinates], y[:, layout.coordinates :]
    time = t[:, None]
    return Motion(
        t=time,
        swing=q[:, : a.size],
        phi=_columns(a.dof_phi, q, a.phi + a.nu * time),
        omega=v[:, : a.size],
        nu=_columns(a.dof_phi, v, a.nu),
        x=_columns(a.dof_x, q),
        y=_columns(a.dof_y, q),
        vx=_columns(a.dof_x, v),
        vy=_columns(a.dof_y, v),
    )


def _places(layout: Layout, m: Motion) -> Table:
    """Angles, rates, places and velocities; r1 = r_cm + l1 (sin theta, -cos theta)."""
    a = layout.model.asperites
    rest = np.where(a.facing > 0.0, 0.0, np.pi)
    velocity = layout.velocity
    x = layout.origin[0] + (a.x + velocity[:, 0] * m.t + m.x)
    y = layout.origin[1] + (a.y + velocity[:, 1] * m.t + m.y)
    sin, cos = a.facing * np.sin(m.swing), a.facing * np.cos(m.swing)
    return {
        "theta": m.swing + rest,
        "phi": m.phi,
        "omega": m.omega,
        "nu": m.nu,
        "x_cm": x,
        "y_cm": y,
        "vx_cm": velocity[:, 0] + m.vx,
        "vy_cm": velocity[:, 1] + m.vy,
        "x_bob": x + a.l1 * sin,
        "y_bob": y - a.l1 * cos,
        "x_bar": x - a.l2 * sin,
        "y_bar": y + a.l2 * cos,
    }


def _accounts(layout: Layout, m: Motion, s: np.ndarray) -> dict[str, Account]:
    """Every force's account, by the name of its work."""
    a = layout.model.asperites
    surface = layout.model.surfaces[a.surface]
    none = np.zeros_like(m.swing)

    def column(slots: np.ndarray, k: int) -> np.ndarray:
        return _columns(np.where(slots >= 0, slots + k, -1), s)

    jx, jy, about_x, about_y = (column(a.acc_contact, k) for k in range(4))
    slide_x, slide_y = (column(a.acc_slide, k) for k in range(2))
    contact = Account(a.l1 * (about_x + about_y), jx, jy, slide_x + slide_y)

    # f2 = -(held f1_x, f1_y), with held = 1 for a forced drive and 0 for a free one, unless the
    # drive has an account of its own.
    held = np.where(surface.drive == FORCED, 1.0, 0.0)
    own = a.acc_drive >= 0
    drive = Account(
        np.where(own, -a.l2 * column(a.acc_drive, 2), a.l2 * (held * about_x + about_y)),
        np.where(own, column(a.acc_drive, 0), -held * jx),
        np.where(own, column(a.acc_drive, 1), -jy),
        np.where(own, column(a.acc_drive, 3), -(held * slide_x + slide_y)),
    )

    left, right, end_x, end_y, end_pseudo = (column(a.acc_ends, k) for k in range(5))
    return {
        "w1": contact,
        "w2": drive,
        "wL": Account(left, end_x, end_y, end_pseudo),
        "wR": Account(right, -end_x, -end_y, -end_pseudo),
        "w_int": Account(none, none, none, none),
    }


def _works(layout: Layout, accounts: dict[str, Account]) -> Table:
    velocity = layout.velocity
    works = {name: account.work(velocity) for name, account in accounts.items()}
    pseudoworks = {f"{name}_ps": account.pseudowork(velocity) for name, account in accounts.items()}
    reported = ("w1_ps", "w2_ps", "w_int_ps")
    return (
        works
        | {"w": sum(works.values())}
        | {name: pseudoworks[name] for name in reported}
        | {"w_ps": sum(pseudoworks.values())}
    )


def _energies(layout: Layout, m: Motion) -> Table:
    a = layout.model.asperites
    velocity = layout.velocity
    internal = 0.5 * (a.inertia * m.omega**2 + a.i2 * m.nu**2 + a.kappa * (m.swing - m.phi) ** 2)
    lag = velocity[:, 0] * m.vx + velocity[:, 1] * m.vy + 0.5 * (m.vx**2 + m.vy**2)
    return {
        "delta_k_trans": a.mass * lag,
        "delta_e_int": internal - internal[0],
    }


def _block(
    layout: Layout,
    k: int,
    m: Motion,
    accounts: dict[str, Account],
    internal: np.ndarray,
    s: np.ndarray,
) -> Table:
    """The ledger of surface k as a whole; V is the velocity of the centre of all its masses."""
    surface = layout.scene.surfaces[k]
    part = layout.parts[surface.name]
    mass = layout.model.asperites.mass[part]
    velocity = layout.velocity[part]
    vx, vy = m.vx[:, part], m.vy[:, part]
    total = np.sum(mass)
    lag_x, lag_y = vx @ mass / total, vy @ mass / total
    external = [account for name, account in accounts.items() if name != "w_int"]
    impulse_x = sum(np.sum(account.jx[:, part], axis=1) for account in external)
    impulse_y = sum(np.sum(account.jy[:, part], axis=1) for account in external)
    boost = surface.velocity[0] * impulse_x + surface.velocity[1] * impulse_y
    slot = layout.model.surfaces[k].acc_block
    apart = 0.5 * ((vx**2 + vy**2) @ mass - total * (lag_x**2 + lag_y**2))
    return {
        "W": sum(np.sum(a.about[:, part] + a.pseudo[:, part], axis=1) for a in external) + boost,
        "W_ps": (s[:, slot] if slot >= 0 else 0.0) + boost,
        "delta_K": total
        * (velocity[0, 0] * lag_x + velocity[0, 1] * lag_y + 0.5 * (lag_x**2 + lag_y**2)),
        "delta_E_int": np.sum(internal[:, part], axis=1) + apart,
    }
