"""The scales that accuracies are relative to, and the local tolerances made from them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tribo.integrators.step_control import Tolerance
from tribo.run.layout import Layout
from tribo.run.ledger import Ledger
from tribo.run.quantities import ASPERITE_QUANTITIES, OPTIONAL_QUANTITIES, QUANTITIES
from tribo.run.samples import Samples

EPSILON = float(np.finfo(float).eps)
KINDS = {name: quantity.kind for name, quantity in QUANTITIES.items()}
FLOOR = 2e-15  # no tolerance asks for less, relative to its scale


@dataclass(frozen=True)
class Scales:
    """One scale a kind of quantity: what an accuracy is relative to."""

    rate: float  # the largest |omega| or |nu|
    length: float  # the largest rod
    velocity: float  # the largest bob speed seen from the surfaces' mean initial velocity
    energy: float  # the largest work, pseudowork, delta_e_int or delta_k_trans
    angle: float = 1.0

    def of(self, kind: str) -> float:
        """The scale of one kind of quantity."""
        return float(getattr(self, kind))


def reported_scales(layout: Layout, books: Ledger) -> Scales:
    """The scales by which a run is judged, over all asperites and samples, in the laboratory."""

    def top(*names: str) -> float:
        return max(largest(series) for name in names for series in books.series(name))

    asperite = ASPERITE_QUANTITIES | OPTIONAL_QUANTITIES
    works = [name for name in asperite if KINDS[name] == "energy" and books.series(name)]
    return Scales(
        rate=top("omega", "nu"),
        length=_longest_rod(layout),
        velocity=_fastest_bob(layout, books),
        energy=top(*works),
    )


def _longest_rod(layout: Layout) -> float:
    a = layout.model.asperites
    return float(np.max(a.l1 + a.l2))


def _fastest_bob(layout: Layout, books: Ledger) -> float:
    mean = np.mean([surface.velocity for surface in layout.scene.surfaces], axis=0)
    fastest = 0.0
    for name, table in books.surfaces.items():
        a = layout.model.asperites[layout.parts[name]]
        swing = np.where(a.facing > 0.0, table["theta"], table["theta"] - np.pi)
        along = a.l1 * a.facing * table["omega"]
        vx = (table["vx_cm"] - mean[0]) + along * np.cos(swing)
        vy = (table["vy_cm"] - mean[1]) + along * np.sin(swing)
        fastest = max(fastest, float(np.max(np.hypot(vx, vy))))
    return fastest


@dataclass(frozen=True)
class InnerScales:
    """Scales that every inertial frame agrees on, from which the tolerances are made."""

    velocity: float
    energy: float
    impulse: float
    rate: float  # the largest |omega|
    swing: float  # the largest |theta - rest - phi|


def first_guess(layout: Layout) -> InnerScales:
    """Scales for a first, coarse run: those of the scene as it starts."""
    a = layout.model.asperites
    mean = np.mean(layout.velocity - layout.velocity[0], axis=0)
    relative = layout.velocity - layout.velocity[0] - mean
    frequency = np.sqrt(a.kappa / a.inertia)
    omega = np.max(np.abs(layout.start[layout.coordinates :][: a.size]))
    velocity = float(np.max(np.hypot(relative[:, 0], relative[:, 1])) + np.max(a.l1) * omega)
    velocity = velocity or float(np.max(frequency * a.l1)) or 1.0
    rate = float(max(omega, np.max(frequency), velocity / np.max(a.l1)))
    energy = float(np.max(a.mass)) * velocity**2
    return InnerScales(velocity, energy, energy / velocity, rate, 1.0)


def inner_scales(layout: Layout, samples: Samples) -> InnerScales:
    """The scales that a run turned out to have; those that stayed zero are taken from the start."""
    guess = first_guess(layout)
    a = layout.model.asperites
    swing = samples.y[:, : a.size]
    omega = samples.y[:, layout.core : layout.core + a.size]
    weights = _account_weights(layout)
    top = np.max(np.abs(samples.s), axis=0, initial=0.0)
    internal = 0.5 * (a.inertia * omega**2 + a.kappa * swing**2)
    return InnerScales(
        velocity=guess.velocity,
        energy=max(float(np.max(top * weights)), largest(internal - internal[0])) or guess.energy,
        impulse=float(np.max(top[weights == 0.0])) or guess.impulse,
        rate=largest(omega) or guess.rate,
        swing=largest(swing) or guess.swing,
    )


def largest(values: np.ndarray) -> float:
    return float(np.max(np.abs(values), initial=0.0))


def _account_weights(layout: Layout) -> np.ndarray:
    """What an account is multiplied by to become a work; 0 for impulses, which are none."""
    weights = np.ones(layout.accounts)
    a = layout.model.asperites
    length = a.l1 + a.l2
    impulses = {
        "acc_contact": (0, 1),
        "acc_drive": (0, 1),
        "acc_ends": (2, 3),
        "acc_user_ends": (2, 3, 4, 5),
        "acc_internal": (0, 1),
        "acc_field": (0, 1),
        "acc_thermal": (0, 1),
    }
    arms = {"acc_contact": (2, 3), "acc_drive": (2,)}  # integrals that lack the length of the arm
    for name, offsets in impulses.items():
        present = a[name] >= 0
        for k in offsets:
            weights[a[name][present] + k] = 0.0
        for k in arms.get(name, ()):
            weights[a[name][present] + k] = length[present]
    return weights


def tolerances(layout: Layout, scales: InnerScales, level: float, near: float) -> Tolerance:
    """Local tolerances in each component that serve an accuracy of about `level`.

    Every coordinate is held to its own scale and to what its error does to the energies, so that
    a weakly coupled scene, whose works are tiny, is still followed to the digits they need.
    `near` is how far of the way to the next encounter a step may go.
    """
    level = max(level, FLOOR)
    a = layout.model.asperites
    energy = level * scales.energy
    speed = level * scales.velocity
    q = np.full(layout.coordinates, level * _longest_rod(layout))
    v = np.full(layout.coordinates, speed)
    swing = slice(0, a.size)
    q[swing] = np.minimum(level, energy / _positive(a.kappa * scales.swing))
    v[swing] = np.minimum(level * scales.rate, energy / _positive(a.inertia * scales.rate))
    turning = a.dof_phi >= 0
    q[a.dof_phi[turning]] = q[swing][turning]
    v[a.dof_phi[turning]] = np.minimum(level * scales.rate, energy / (a.i2[turning] * scales.rate))
    for slots in (a.dof_x, a.dof_y):
        live = slots >= 0
        v[slots[live]] = np.minimum(speed, energy / (a.mass[live] * scales.velocity))
    weights = _account_weights(layout)
    impulse = level * min(scales.impulse, scales.energy / scales.velocity)
    s = np.where(weights > 0.0, energy / np.where(weights > 0.0, weights, 1.0), impulse)
    return Tolerance(np.concatenate([q, v]), s, level, near)


def _positive(values: np.ndarray) -> np.ndarray:
    return np.maximum(values, np.finfo(float).tiny)


def first_step(layout: Layout) -> float:
    """A step to begin with: short against every pendulum's period and the run."""
    a = layout.model.asperites
    fastest = float(np.max(np.sqrt(a.kappa * np.maximum(1.0 / a.inertia, 1.0 / a.i2))))
    for oscillators in (layout.model.bath, layout.model.torsional):
        if oscillators is not None:
            fastest = max(fastest, float(np.max(oscillators.frequency)))
    return min(0.05 / fastest if fastest > 0.0 else np.inf, 1e-3 * layout.scene.duration)


def unit_step(layout: Layout) -> float:
    """The time of a radian of the fastest pendulum: the unit of equal steps."""
    a = layout.model.asperites
    inverse = 1.0 / a.inertia + np.where(a.dof_phi >= 0, 1.0 / a.i2, 0.0)
    fastest = float(np.max(np.sqrt(a.kappa * inverse)))
    return min(1.0 / fastest if fastest > 0.0 else np.inf, 0.01 * layout.scene.duration)


def kind_of(name: str) -> str:
    """The kind of a quantity, "w1" or "upper.w1"."""
    return KINDS[name.rpartition(".")[2]]
