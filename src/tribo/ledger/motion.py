"""The motion of asperites and their energies, from raw samples.

Also the reaction of the constraint on driven bars: what their motion leaves over of other forces.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from tribo.kernels.kinematics import rod_position, rod_velocity, versine
from tribo.kernels.records import BARS, MOVED
from tribo.layout.layout import Layout, once_per_layout
from tribo.layout.span import Asperites, Span, columns
from tribo.ledger.accounts import FORCES, Accounts
from tribo.ledger.lazy import lazy_property
from tribo.ledger.samples import Samples

Position = tuple[np.ndarray, np.ndarray]  # x and y, or a velocity


def _of_centre(group: str, table: str, place: int) -> lazy_property[np.ndarray]:
    """A coordinate of the centres of mass, or its rate: a group of slots, and about these."""
    return lazy_property(
        lambda motion: motion._column(group, getattr(motion, table)) + motion._about_pivots[place]
    )


class Motion:
    """The motion of a span, and its energies.

    Every array is (times, asperites), and computed when it is first needed.  The displacements x
    and y and the velocities vx and vy are relative to the uniform motion with the initial velocity
    of the surface; positions and velocities are in the laboratory.  The first of the raw samples is
    the start of the run.
    """

    def __init__(self, layout: Layout, span: Span, samples: Samples) -> None:
        self.span = span
        self.samples = samples
        self._layout = layout
        self._q = samples.y[:, : layout.core]
        self._v = samples.y[:, layout.core :]

    @lazy_property
    def t(self) -> np.ndarray:
        """The times, (times, 1)."""
        return self.samples.t[:, None]

    @lazy_property
    def swing(self) -> np.ndarray:
        """Angle theta from rest."""
        return self._q[:, self.span.place]

    @lazy_property
    def phi(self) -> np.ndarray:
        """Angle of the bar."""
        a = self.span.asperites
        return self._column("dof_phi", self._q, lambda: a.phi + a.nu * self.t)

    @lazy_property
    def omega(self) -> np.ndarray:
        """Rate of theta."""
        return self._v[:, self.span.place]

    @lazy_property
    def nu(self) -> np.ndarray:
        """Rate of phi."""
        return self._column("dof_phi", self._v, lambda: self.span.asperites.nu)

    # Displacements of the centre of mass from its uniform motion, and their rates.
    x = _of_centre("dof_x", "_q", 0)
    y = _of_centre("dof_y", "_q", 1)
    vx = _of_centre("dof_x", "_v", 2)
    vy = _of_centre("dof_y", "_v", 3)

    @property
    def x_of_block(self) -> np.ndarray:
        """Displacement along x of the bars of a block, or of their mean where it tilts."""
        return self._column("dof_x", self._q)

    @property
    def y_of_block(self) -> np.ndarray:
        """The same along y."""
        return self._column("dof_y", self._q)

    @lazy_property
    def theta(self) -> np.ndarray:
        """The angle of the pendulum."""
        return self.swing + np.where(self.span.asperites.facing > 0.0, 0.0, np.pi)

    @lazy_property
    def centre(self) -> Position:
        """The centre of mass."""
        a = self.span.asperites
        velocity = self.span.velocity
        x = self._layout.origin[0] + (a.x + velocity[0] * self.t + self.x)
        y = self._layout.origin[1] + (a.y + velocity[1] * self.t + self.y)
        return x, y

    @lazy_property
    def velocity(self) -> Position:
        """The velocity of the centre of mass."""
        return self.span.velocity[0] + self.vx, self.span.velocity[1] + self.vy

    @lazy_property
    def bob(self) -> Position:
        return rod_position(*self.centre, self.span.asperites.l1, *self.direction)

    @lazy_property
    def bar(self) -> Position:
        """The centre of the bar."""
        return rod_position(*self.centre, -self.span.asperites.l2, *self.direction)

    @lazy_property
    def direction(self) -> Position:
        """The unit vector along which a growing theta moves the bob."""
        return swing_direction(self.span.asperites.facing, self.swing)

    @lazy_property
    def moving(self) -> np.ndarray:
        """Kinetic energy of the centre of mass, relative to its uniform motion."""
        moving: np.ndarray = 0.5 * (self.vx**2 + self.vy**2) * self.span.asperites.mass
        return moving

    @lazy_property
    def momentum(self) -> Position:
        """Momentum along x and y, relative to the uniform motion."""
        mass = self.span.asperites.mass
        return self.vx * mass, self.vy * mass

    @lazy_property
    def within(self) -> np.ndarray:
        """All energy relative to the uniform motion, less the internal energy at the start."""
        return self.moving + self.internal

    @lazy_property
    def kinetic(self) -> np.ndarray:
        """Change of the translational kinetic energy."""
        velocity = self.span.velocity
        mass = self.span.asperites.mass
        kinetic = mass * (velocity[0] * self.vx + velocity[1] * self.vy) + self.moving
        return self.samples.change(kinetic)

    @property
    def translation(self) -> np.ndarray:
        """The translational kinetic energy."""
        vx, vy = self.velocity
        return np.asarray(0.5 * self.span.asperites.mass * (vx**2 + vy**2))

    @property
    def energies(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The kinetic energies of pendulum and bar about their centres, and that of the torsion."""
        return internal_energies(self.span.asperites, self.omega, self.nu, self.swing - self.phi)

    @lazy_property
    def energy(self) -> np.ndarray:
        """The internal energy."""
        swing, bar, spring = self.energies
        return swing + bar + spring

    @lazy_property
    def swinging(self) -> np.ndarray:
        """The energy that belongs to the drive: the internal one, on driven bars about the bar."""
        a = self.span.asperites
        held = a.dof_x < 0  # on a block, centres of mass have slots
        held = held | (np.asarray(self._layout.surfaces)["drive"][a.surface] == MOVED)
        driven = np.where(held, a.pivot, 0.0)
        swinging: np.ndarray = self.energy + 0.5 * a.mass * (driven * self.omega) ** 2
        return swinging

    @lazy_property
    def internal(self) -> np.ndarray:
        """Change of the internal energy."""
        return self.samples.change(self.energy)

    def bob_path(self, mean: np.ndarray) -> np.ndarray:
        """How far the bobs are from their start, in a frame of a velocity (2,), or (2, times)."""
        a = self.span.asperites
        tx, ty = self.direction
        samples = self.samples
        later = samples.change(self.t)
        own_x, own_y = self.span.velocity - mean[..., None]
        x = samples.change(self.x + a.l1 * ty) + own_x * later
        y = samples.change(self.y - a.l1 * tx) + own_y * later
        path: np.ndarray = np.hypot(x, y)
        return path

    def bob_speed(self, frame: np.ndarray) -> np.ndarray:
        """The speed of the bob in a frame that moves with a velocity (2,), or (2, times)."""
        vx, vy = self.velocity
        frame_x, frame_y = frame[..., None]
        moving = vx - frame_x, vy - frame_y, self.omega, self.span.asperites.l1
        speed: np.ndarray = np.hypot(*rod_velocity(*moving, *self.direction))
        return speed

    @lazy_property
    def _about_pivots(self) -> tuple[np.ndarray | float, ...]:
        """Displacements and velocities of centres of mass about what x and y are those of."""
        a = self.span.asperites
        if not a.pivot.any():
            return 0.0, 0.0, 0.0, 0.0
        about = about_pivots(a, self.swing, self.omega)
        if not (a.arm_x.any() or a.arm_y.any()):
            return about
        tilted = about_mean(a, self.phi, self.nu)
        return tuple(one + other for one, other in zip(about, tilted, strict=True))

    def _column(
        self, group: str, table: np.ndarray, absent: Callable[[], np.ndarray | float] = float
    ) -> np.ndarray:
        """The columns of a group of slots; the value of `absent` where there is none."""
        if group in self.span.present:
            return columns(getattr(self.span.asperites, group), table, absent())
        values = np.empty((len(table), self.span.asperites.stride.size))
        values[:] = absent()
        return values


def motions(layout: Layout, samples: Samples, index: int) -> Iterator[Motion]:
    """The motion of surface `index`, span by span."""
    return (Motion(layout, span, samples) for span in layout.spans[index])


@once_per_layout
def mean_velocity(layout: Layout) -> np.ndarray:
    """The mean of the surfaces' initial velocities, (2,); of members (2, times)."""
    velocities = [np.asarray(layout.velocity_of(index)) for index in range(len(layout.parts))]
    return np.asarray(np.mean(velocities, axis=0))


def about_pivots(
    asperites: Asperites, swing: np.ndarray, omega: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Displacements x, y and velocities of centres of mass about the centres of driven bars."""
    pivot = asperites.pivot
    facing = asperites.facing
    tx, ty = swing_direction(facing, swing)
    lift = facing * versine(swing)  # facing - tx
    return pivot * ty, pivot * lift, pivot * omega * tx, pivot * omega * ty


def about_mean(
    asperites: Asperites, phi: np.ndarray, nu: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Displacements x, y and velocities of the bars of a block that tilts about their mean.

    They are 0 for all other bars, whose arms are.
    """
    a = asperites
    sin = np.sin(phi)
    less = versine(phi)  # 1 - cos phi
    x = -less * a.arm_x - sin * a.arm_y
    y = sin * a.arm_x - less * a.arm_y
    return x, y, -nu * (a.arm_y + y), nu * (a.arm_x + x)


def swing_direction(facing: np.ndarray, swing: np.ndarray) -> Position:
    """The unit vector (t_x, t_y) along which a growing theta moves the bob; see `kinematics`."""
    return facing * np.cos(swing), facing * np.sin(swing)


def internal_energies(
    asperites: Asperites, omega: np.ndarray, nu: np.ndarray, torsion: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """1/2 I omega^2, 1/2 i2 nu^2 and 1/2 kappa (theta - rest - phi)^2, each (times, asperites)."""
    a = asperites
    return 0.5 * a.inertia * omega**2, 0.5 * a.i2 * nu**2, 0.5 * a.kappa * torsion**2


def add_reactions(layout: Layout, y: np.ndarray, s: np.ndarray, start: np.ndarray) -> None:
    """Set the accounts of f2 on driven bars in `s`, whose rows are of the coordinates in `y`.

    The impulse is M (v_cm - v_cm(0)) less all other impulses, the pseudowork the change of kinetic
    energy less all other pseudoworks.  In the frame of the bars f2 does no work.  `start` is y at
    the start of the run, (1, 2 coordinates), or a row for each sample.
    """
    for index in range(len(layout.parts)):
        if layout.surfaces[index].drive == BARS and layout.surfaces[index].acc_drive >= 0:
            changes = [_changes(layout, span, y, start) for span in layout.spans[index]]
            if layout.model.sums is not None:  # over asperites, in the first lane
                lanes = np.zeros((3, len(y), layout.surfaces[index].account_stride))
                lanes[:, :, 0] = sum(np.sum(change, axis=2) for change in changes)
                changes = [lanes]
            for span, change in zip(layout.accounted_spans[index], changes, strict=True):
                _add(Accounts(span, s), s, change)


def _changes(layout: Layout, span: Span, y: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Changes of momentum along x and y and of kinetic energy, (3, times, asperites)."""
    a = span.asperites
    (vx0, vy0), (vx, vy) = (
        about_pivots(a, each[:, span.place], each[:, layout.core :][:, span.place])[2:]
        for each in (start, y)
    )
    kinetic = 0.5 * a.mass * (vx**2 + vy**2 - vx0**2 - vy0**2)
    return np.stack([a.mass * (vx - vx0), a.mass * (vy - vy0), kinetic])


def _add(forces: Accounts, s: np.ndarray, change: np.ndarray) -> None:
    """Set the accounts of one span, from the changes of its momenta and kinetic energy."""
    a = forces.span.asperites
    others = [forces[name] for name in FORCES if name != "w2"]
    px, py, kinetic = change
    pseudo = kinetic - sum(f.pseudo for f in others)
    s[:, a.acc_drive] = px - sum(f.jx for f in others)
    s[:, a.acc_drive + a.stride] = py - sum(f.jy for f in others)
    s[:, a.acc_drive + 2 * a.stride] = pseudo  # minus the work about the centre of mass
    s[:, a.acc_drive + 3 * a.stride] = pseudo
