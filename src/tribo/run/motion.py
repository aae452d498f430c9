"""The motion of a surface's asperites, from raw samples."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from tribo.kernels.records import BARS
from tribo.run.force_records import Records
from tribo.run.layout import Layout
from tribo.run.samples import Samples

# Asperites of a batch: more of them would make the temporary arrays of a ledger large.
BATCH_SIZE = 50_000


@dataclass(frozen=True, eq=False)
class Batch:
    """Some consecutive asperites of one surface."""

    index: int  # of the surface
    place: slice  # of the asperites among all
    surface: np.record  # of kernels.records.SURFACE
    asperites: Records  # of kernels.records.ASPERITE
    velocity: np.ndarray  # (2,) initial velocity of the surface, in the laboratory


@dataclass(frozen=True, eq=False)
class Motion:
    """The motion of a batch relative to its surface's initial velocity.

    Every array is (times, asperites).
    """

    t: np.ndarray  # (times, 1)
    swing: np.ndarray  # theta - rest
    phi: np.ndarray
    omega: np.ndarray
    nu: np.ndarray
    x: np.ndarray  # displacement of the centre of mass from its uniform motion
    y: np.ndarray
    vx: np.ndarray
    vy: np.ndarray


def motions(layout: Layout, samples: Samples, index: int) -> Iterator[tuple[Batch, Motion]]:
    """The motion of surface `index`, batch by batch."""
    for batch in _batches(layout, index):
        yield batch, _motion(layout, batch, samples)


def _batches(layout: Layout, index: int) -> Iterator[Batch]:
    """The asperites of a surface, at most BATCH_SIZE at a time."""
    whole = layout.parts[layout.scene.surfaces[index].name]
    for start in range(whole.start, whole.stop, BATCH_SIZE):
        place = slice(start, min(start + BATCH_SIZE, whole.stop))
        yield Batch(
            index,
            place,
            layout.surfaces[index],
            layout.asperites[place],
            np.array(layout.scene.surfaces[index].velocity),
        )


def _motion(layout: Layout, batch: Batch, samples: Samples) -> Motion:
    a = batch.asperites
    q, v = samples.y[:, : layout.core], samples.y[:, layout.core :]
    time = samples.t[:, None]
    motion = Motion(
        t=time,
        swing=q[:, batch.place],
        phi=columns(a.dof_phi, q, a.phi + a.nu * time),
        omega=v[:, batch.place],
        nu=columns(a.dof_phi, v, a.nu),
        x=columns(a.dof_x, q),
        y=columns(a.dof_y, q),
        vx=columns(a.dof_x, v),
        vy=columns(a.dof_y, v),
    )
    if batch.surface.drive != BARS:
        return motion
    x, y, vx, vy = about_pivots(a, motion.swing, motion.omega)
    return replace(motion, x=motion.x + x, y=motion.y + y, vx=motion.vx + vx, vy=motion.vy + vy)


def about_pivots(
    asperites: Records, swing: np.ndarray, omega: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Displacements x, y and velocities of the centres of mass about the centres of driven bars.

    The coordinates x and y of such asperites are those of the bars.
    """
    pivot, facing = asperites.pivot, asperites.facing
    tx, ty = swing_direction(facing, swing)
    lift = facing * 2.0 * np.sin(0.5 * swing) ** 2  # facing - tx
    return pivot * ty, pivot * lift, pivot * omega * tx, pivot * omega * ty


def columns(slots: np.ndarray, table: np.ndarray, absent: np.ndarray | float = 0.0) -> np.ndarray:
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


def swing_direction(facing: np.ndarray, swing: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The unit vector (t_x, t_y) along which a growing theta moves the bob; see `kinematics`."""
    return facing * np.cos(swing), facing * np.sin(swing)


def internal_energy(
    asperites: Records, omega: np.ndarray, nu: np.ndarray, torsion: np.ndarray
) -> np.ndarray:
    """1/2 I omega^2 + 1/2 i2 nu^2 + 1/2 kappa (theta - rest - phi)^2, (times, asperites)."""
    a = asperites
    return np.asarray(0.5 * (a.inertia * omega**2 + a.i2 * nu**2 + a.kappa * torsion**2))
