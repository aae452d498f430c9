"""The motion of a surface's asperites, from raw samples."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cached_property

import numpy as np

from tribo.layout.batch import Asperites, Batch
from tribo.layout.layout import Layout
from tribo.ledger.samples import Samples


class Motion:
    """The motion of a batch relative to its surface's initial velocity.

    Every array is (times, asperites), and computed when it is first needed.
    """

    def __init__(self, layout: Layout, batch: Batch, samples: Samples) -> None:
        self._core = layout.core
        self._asperites = batch.asperites
        self._present = batch.present
        self._place = batch.place
        self._samples = samples

    @cached_property
    def t(self) -> np.ndarray:
        """The times, (times, 1)."""
        return self._samples.t[:, None]

    @cached_property
    def swing(self) -> np.ndarray:
        """Angle theta from rest."""
        return self._q[:, self._place]

    @cached_property
    def phi(self) -> np.ndarray:
        """Angle of the bar."""
        a = self._asperites
        return self._column("dof_phi", self._q, lambda: a.phi + a.nu * self.t)

    @cached_property
    def omega(self) -> np.ndarray:
        """Rate of theta."""
        return self._v[:, self._place]

    @cached_property
    def nu(self) -> np.ndarray:
        """Rate of phi."""
        return self._column("dof_phi", self._v, lambda: self._asperites.nu)

    @cached_property
    def x(self) -> np.ndarray:
        """Displacement of the centre of mass from its uniform motion."""
        return self._column("dof_x", self._q) + self._about_pivots[0]

    @cached_property
    def y(self) -> np.ndarray:
        """The same along y."""
        return self._column("dof_y", self._q) + self._about_pivots[1]

    @cached_property
    def vx(self) -> np.ndarray:
        """Rate of `x`."""
        return self._column("dof_x", self._v) + self._about_pivots[2]

    @cached_property
    def vy(self) -> np.ndarray:
        """Rate of `y`."""
        return self._column("dof_y", self._v) + self._about_pivots[3]

    @cached_property
    def _about_pivots(self) -> tuple[np.ndarray | float, ...]:
        """Displacements and velocities of centres of mass about driven bars; else zeros."""
        if not self._asperites.pivot.any():
            return 0.0, 0.0, 0.0, 0.0
        return about_pivots(self._asperites, self.swing, self.omega)

    def _column(
        self, group: str, table: np.ndarray, absent: Callable[[], np.ndarray | float] = float
    ) -> np.ndarray:
        """The columns of a group of slots; the value of `absent` where there is none."""
        if group in self._present:
            return columns(getattr(self._asperites, group), table, absent())
        return np.full((len(table), self._asperites.stride.size), absent())

    @property
    def _q(self) -> np.ndarray:
        return self._samples.y[:, : self._core]

    @property
    def _v(self) -> np.ndarray:
        return self._samples.y[:, self._core :]


def motions(layout: Layout, samples: Samples, index: int) -> Iterator[tuple[Batch, Motion]]:
    """The motion of surface `index`, batch by batch."""
    for batch in layout.batches[index]:
        yield batch, Motion(layout, batch, samples)


def about_pivots(
    asperites: Asperites, swing: np.ndarray, omega: np.ndarray
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
    if present.all():
        return table[:, slots]
    if not present.any():
        return np.broadcast_to(np.asarray(absent), shape)
    values = np.empty(shape)
    values[:] = absent
    values[:, present] = table[:, slots[present]]
    return values


def swing_direction(facing: np.ndarray, swing: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The unit vector (t_x, t_y) along which a growing theta moves the bob; see `kinematics`."""
    return facing * np.cos(swing), facing * np.sin(swing)


def internal_energies(
    asperites: Asperites, omega: np.ndarray, nu: np.ndarray, torsion: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """1/2 I omega^2, 1/2 i2 nu^2 and 1/2 kappa (theta - rest - phi)^2, each (times, asperites)."""
    a = asperites
    return 0.5 * a.inertia * omega**2, 0.5 * a.i2 * nu**2, 0.5 * a.kappa * torsion**2


def internal_energy(
    asperites: Asperites, omega: np.ndarray, nu: np.ndarray, torsion: np.ndarray
) -> np.ndarray:
    """Their sum."""
    swing, bar, spring = internal_energies(asperites, omega, nu, torsion)
    return np.asarray(swing + bar + spring)
