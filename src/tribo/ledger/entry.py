"""The motion of asperites in the laboratory and their energies, from raw samples."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from tribo.kernels.kinematics import bar_position, bob_position, bob_velocity
from tribo.layout.batch import Batch
from tribo.layout.layout import Layout
from tribo.ledger.motion import Motion, internal_energies, swing_direction
from tribo.ledger.samples import Samples

Position = tuple[np.ndarray, np.ndarray]  # x and y


class Entry(Motion):
    """The motion of a batch in the laboratory, and its energies.

    Every array is (times, asperites), and computed when it is first needed.

    Parameters
    ----------
    layout : Layout
        The scene.
    batch : Batch
        Some asperites of one surface.
    samples : Samples
        The raw samples of a run, the first of which is the start of the run.
    """

    def __init__(self, layout: Layout, batch: Batch, samples: Samples) -> None:
        super().__init__(layout, batch, samples)
        self.batch = batch
        self.samples = samples
        self._layout = layout

    def part(self, batch: Batch) -> Entry:
        """The same of some of the asperites, with the arrays from which totals are summed."""
        part = Entry(self._layout, batch, self.samples)
        for name in ("vx", "vy", "moving", "internal"):
            part.__dict__[name] = getattr(self, name)[:, batch.place]
        return part

    @cached_property
    def theta(self) -> np.ndarray:
        """The angle of the pendulum."""
        return self.swing + np.where(self.batch.asperites.facing > 0.0, 0.0, np.pi)

    @cached_property
    def centre(self) -> Position:
        """The centre of mass."""
        a, velocity = self.batch.asperites, self.batch.velocity
        x = self._layout.origin[0] + (a.x + velocity[0] * self.t + self.x)
        y = self._layout.origin[1] + (a.y + velocity[1] * self.t + self.y)
        return x, y

    @cached_property
    def velocity(self) -> Position:
        """The velocity of the centre of mass."""
        return self.batch.velocity[0] + self.vx, self.batch.velocity[1] + self.vy

    @cached_property
    def bob(self) -> Position:
        """The bob."""
        return bob_position(*self.centre, self.batch.asperites.l1, *self.direction)

    @cached_property
    def bar(self) -> Position:
        """The centre of the bar."""
        return bar_position(*self.centre, self.batch.asperites.l2, *self.direction)

    @cached_property
    def direction(self) -> Position:
        """The unit vector along which a growing theta moves the bob."""
        return swing_direction(self.batch.asperites.facing, self.swing)

    @cached_property
    def moving(self) -> np.ndarray:
        """Kinetic energy of the centre of mass, relative to its uniform motion."""
        return np.asarray(0.5 * (self.vx**2 + self.vy**2) * self.batch.asperites.mass)

    @cached_property
    def kinetic(self) -> np.ndarray:
        """Change of the translational kinetic energy."""
        velocity, mass = self.batch.velocity, self.batch.asperites.mass
        kinetic = mass * (velocity[0] * self.vx + velocity[1] * self.vy) + self.moving
        return self.samples.change(kinetic)

    @property
    def translation(self) -> np.ndarray:
        """The translational kinetic energy."""
        vx, vy = self.velocity
        return np.asarray(0.5 * self.batch.asperites.mass * (vx**2 + vy**2))

    @property
    def energies(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The kinetic energies of pendulum and bar about their centres, and that of the torsion."""
        a = self.batch.asperites
        return internal_energies(a, self.omega, self.nu, self.swing - self.phi)

    @cached_property
    def energy(self) -> np.ndarray:
        """The internal energy."""
        swing, bar, spring = self.energies
        return swing + bar + spring

    @property
    def swinging(self) -> np.ndarray:
        """The energy that belongs to the drive: the internal one, on driven bars about the bar."""
        a = self.batch.asperites
        return np.asarray(self.energy + 0.5 * a.mass * (a.pivot * self.omega) ** 2)

    @cached_property
    def internal(self) -> np.ndarray:
        """Change of the internal energy."""
        return self.samples.change(self.energy)

    def bob_speed(self, frame: np.ndarray) -> np.ndarray:
        """The speed of the bob in a frame that moves with a velocity (2,), or (2, times)."""
        (vx, vy), (frame_x, frame_y) = self.velocity, frame[..., None]
        moving = vx - frame_x, vy - frame_y, self.omega, self.batch.asperites.l1
        return np.asarray(np.hypot(*bob_velocity(*moving, *self.direction)))
