"""The rounding of forces that are differences, and of the motion that it makes.

The stretch of a spring is a difference of displacements, and a twist one of angles.  Where the
terms are far larger, their rounding is a force, which may have the same bits in all runs that are
compared, and hides what is smaller.  The bar is an oscillator on its springs: the force acts in one
direction for at most the inverse of its frequency.
"""

from typing import NamedTuple

import numpy as np

from tribo.accuracy.scales import EPSILON, largest
from tribo.kernels.kinematics import versine
from tribo.kernels.records import OSCILLATOR_FREQUENCY, OSCILLATOR_MASS
from tribo.kernels.samples import BATH, SPRINGS
from tribo.layout.layout import Layout, once_per_layout
from tribo.layout.scene_records import stiffness_at_bars
from tribo.ledger.accounts import FORCES, Accounts
from tribo.ledger.motion import Motion

# Roundings of a difference: those of a displacement, of sine and cosine in it, and of the product.
ROUNDINGS = 4.0
# Changes in a step by fewer roundings are no random walk: half a rounding is lost in every step.
FEW_ROUNDINGS = 16.0


class Lost(NamedTuple):
    """What a run loses where its steps change a value by less than the rounding of it."""

    duration: float  # [time]
    steps: int

    def of(self, values: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """A bound for values and their rates of change, (times, asperites) each: (asperites,)."""
        change = self.duration * np.maximum.reduce(np.abs(rates), axis=0)
        roundings = self.steps * EPSILON * np.maximum.reduce(np.abs(values), axis=0)
        slow = change < FEW_ROUNDINGS * roundings
        return np.where(slow, np.minimum(change, roundings), 0.0)


class Errors(NamedTuple):
    """Bounds on what the rounding of forces does to each asperite, (asperites,) each."""

    stretch: np.ndarray  # of springs [length]
    speed: np.ndarray  # of centres of mass [length / time]
    swing: np.ndarray  # of pendulums [rad]
    omega: np.ndarray  # and their rates [rad / time]
    phi: np.ndarray  # of bars that turn [rad]
    nu: np.ndarray  # and their rates [rad / time]


def rounding_of_forces(layout: Layout, motion: Motion, steps: int = 1) -> dict[str, float]:
    """The effect of the rounding of springs, baths and twists, by quantity, in its own unit."""
    last = float(np.maximum.reduce(motion.t, axis=None))
    stiffness = _stiffness(layout)
    lost = Lost(last - layout.beginning, steps)
    if not (stiffness.any() or motion.phi.any() or lost.of(motion.swing, motion.omega).any()):
        return {}
    e = _errors(layout, motion, stiffness, lost)
    a = motion.span.asperites
    place = e.stretch + a.l2 * e.swing
    internal = _of_square(a.inertia, motion.omega, e.omega) + _of_square(a.i2, motion.nu, e.nu)
    internal += _of_square(a.kappa, motion.swing - motion.phi, e.swing + e.phi)
    speed = np.hypot(*motion.velocity)
    kinetic = _of_square(a.mass, speed, e.speed)
    whole = 0.0
    bulk = 0.0
    for index, part in enumerate(layout.parts.values()):
        stored = motion.samples.stored[:, index, [SPRINGS, BATH]].sum(axis=1)
        pull = np.sqrt(2.0 * stiffness[part] * largest(stored))
        springs = e.stretch[part] * (pull + stiffness[part] * e.stretch[part])
        whole += float(np.sum(internal[part] + kinetic[part] + springs))
        bulk = max(bulk, float(np.sum(kinetic[part])))
    work = largest(internal + kinetic)
    found = dict.fromkeys(("w_int", "w_int_ps", "w", "w_ps"), work)
    found |= dict.fromkeys(("delta_e_int", "swing_energy"), largest(internal))
    found |= {"delta_k_trans": largest(kinetic), "theta": largest(e.swing), "phi": largest(e.phi)}
    found |= {"omega": largest(e.omega), "nu": largest(e.nu), "delta_K": bulk}
    found |= dict.fromkeys(("delta_E_int", "total_energy_change"), whole)
    found |= dict.fromkeys(("vx_cm", "vy_cm"), largest(e.speed))
    for name, error in _of_powers(layout, motion, e).items():
        found[name] = found.get(name, 0.0) + error
    for end, arm in (("cm", 0.0), ("bob", a.l1), ("bar", a.l2)):
        found |= dict.fromkeys((f"x_{end}", f"y_{end}"), largest(place + arm * e.swing))
    return found


def _errors(layout: Layout, motion: Motion, stiffness: np.ndarray, lost: Lost) -> Errors:
    """Bounds on the errors of the motion; `stiffness` is that of all springs on each bar."""
    a = motion.span.asperites
    duration = lost.duration
    moves = a.pivot == 0.0  # driven bars are held where they are
    away = np.hypot(
        np.abs(motion.x) + a.l2 * np.abs(np.sin(motion.swing)),
        np.abs(motion.y) + a.l2 * versine(motion.swing),
    )
    # The other ends of springs are bars of the same surface, or oscillators on the bar.
    farthest = np.zeros(stiffness.size)
    for part in layout.parts.values():
        farthest[part] = largest(away[:, part])
    fastest = np.hypot(motion.vx, motion.vy) + a.l2 * np.abs(motion.omega)
    stretch = ROUNDINGS * EPSILON * farthest + lost.of(farthest[None], fastest)
    stretch *= moves & (stiffness > 0.0)
    pendulum = np.where(layout.surfaces.fixed[a.surface], 0.0, 1.0 / a.inertia)
    impulse = stretch * _impulse(stiffness, 1.0 / a.mass + a.l2**2 * pendulum, duration)
    turned = np.abs(motion.swing).max(axis=0) + np.abs(motion.phi).max(axis=0)
    twist = ROUNDINGS * EPSILON * turned * np.any(motion.phi != 0.0, axis=0)
    turns = a.dof_phi >= 0
    bar = np.where(turns, 1.0 / a.i2, 0.0)
    torsional = _of_oscillators(layout, layout.model.torsional, "first_torsional", "torsionals")
    angular = twist * _impulse(a.kappa + torsional[a.surface], pendulum + bar, duration)
    omega = (a.l2 * impulse + angular) * pendulum
    nu = angular * bar
    torsion = np.where(turns & np.isfinite(a.kappa), a.kappa * bar, 0.0)
    nu = nu + lost.of(motion.nu, torsion * (motion.swing - motion.phi))
    period = _inverse_frequency(a.kappa * pendulum, duration)
    return Errors(
        stretch=stretch,
        speed=impulse / a.mass,
        swing=omega * period + lost.of(motion.swing, motion.omega),
        omega=omega,
        phi=nu * duration + lost.of(motion.phi, motion.nu),
        nu=nu,
    )


def _of_powers(layout: Layout, motion: Motion, e: Errors) -> dict[str, float]:
    """The error of works, by name, from that of the velocities that forces are multiplied by."""
    a = motion.span.asperites
    forces = Accounts(layout.accounted, motion.samples.s)
    speed = largest(e.speed)
    rod = largest(e.speed + (a.l1 + a.l2) * e.omega)
    found: dict[str, float] = {}
    for name in FORCES:
        impulse = largest(np.hypot(forces[name].jx, forces[name].jy))
        found |= {name: impulse * rod, f"{name}_ps": impulse * speed}
    each = sum(found.values())
    pseudo = sum(found[f"{name}_ps"] for name in FORCES)
    whole = layout.scene.count * each
    found |= dict.fromkeys(("W", "W_ps", "applied_work", "friction_work"), whole)
    return found | {"w": each, "w_ps": pseudo, "heat": each}


def _impulse(stiffness: np.ndarray, mobility: np.ndarray, duration: float) -> np.ndarray:
    """The impulse of springs for a unit of stretch that lasts."""
    return stiffness * _inverse_frequency(stiffness * mobility, duration)


def _inverse_frequency(square: np.ndarray, duration: float) -> np.ndarray:
    """The inverse of frequencies with these squares, at most the duration [time]."""
    with np.errstate(divide="ignore"):
        return np.minimum(1.0 / np.sqrt(square), duration)


def _of_square(factor: np.ndarray, values: np.ndarray, error: np.ndarray) -> np.ndarray:
    """The error of factor values^2 / 2 from that of the values, (asperites,)."""
    return np.asarray(factor * error * (np.abs(values).max(axis=0) + error))


@once_per_layout
def _stiffness(layout: Layout) -> np.ndarray:
    """The stiffness of all springs on each bar, to other bars and to oscillators, (asperites,)."""
    model = layout.model
    surface = layout.asperites.surface
    found = np.zeros(surface.size)
    if model.springs is not None:
        columns = layout.places.columns
        found += stiffness_at_bars(model.springs, model.each.shape[1])[columns]
    return found + _of_oscillators(layout, model.bath, "first_oscillator", "oscillators")[surface]


def _of_oscillators(layout: Layout, table: np.ndarray | None, first: str, count: str) -> np.ndarray:
    """The stiffness of all oscillators of a kind on one bar, (surfaces,)."""
    found = np.zeros(len(layout.surfaces))
    if table is not None:
        each = table[OSCILLATOR_MASS] * table[OSCILLATOR_FREQUENCY] ** 2
        for k, record in enumerate(layout.model.surfaces):  # those of the samples have no gaps
            found[k] = each[record[first] : record[first] + record[count]].sum()
    return found
