"""The scales that errors are relative to."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from tribo.kernels.kinematics import rod_velocity
from tribo.layout.layout import Layout, once_per_layout
from tribo.ledger import quantities
from tribo.ledger.ledger import Ledger
from tribo.ledger.motion import internal_energies, mean_velocity, swing_direction
from tribo.ledger.quantity import OWN

# The distance from 1 to the next double.
EPSILON = float(np.finfo(float).eps)
# The role of every quantity that has an accuracy, which declares its scale.
ROLES = {name: quantity.role for name, quantity in quantities.QUANTITIES.items()}
# Those whose errors are relative to a common scale.  Others change no bound but their own.
COMMON = tuple(name for name, role in ROLES.items() if role.scale != OWN)


def measures_of(scale: str) -> tuple[str, ...]:
    """The quantities of which a scale is at least the largest value."""
    return tuple(name for name, role in ROLES.items() if scale in role.measures)


RATES, ENERGIES, WORKS, TOTALS, POTENTIALS = map(
    measures_of, ("rate", "energy", "work", "total", "potential")
)
# All quantities from which scales are found.
MEASURES = frozenset(name for name, role in ROLES.items() if role.measures)
# Motion with less than this part of the energy of contacts and fields is round-off.  Two rows of
# five in an equilibrium have works of 1e-15 of that energy, and a total of 1e-14.
UNRESOLVED = 256.0 * EPSILON


# A value of one run, or those of several members (members,).
Values = float | np.ndarray


@dataclass(frozen=True)
class Scales:
    """The scales that errors are relative to, as quantities declare; arrays of members.

    Rates, velocities and energies below UNRESOLVED of what the energy of contacts and fields by
    asperite could give are round-off; this is then the scale.
    """

    rate: float  # the largest |omega| or |nu| [1 / time]
    # The largest displacement of a bob relative to the mean of the surfaces' initial velocities, at
    # most the longest rod; this where nothing moves.
    length: float
    velocity: float  # the largest of a bob relative to the mean of the surfaces' initial velocities
    # The largest work, pseudowork, delta_e_int or delta_k_trans; where works are below the rounding
    # of the largest internal energy, that energy.
    energy: float
    # The largest work, pseudowork or change of energy of a surface or system; at least `energy`.
    total: float
    work: float = 0.0  # the largest work or pseudowork of an asperite; no errors are relative to it
    angle: float = 1.0  # radian
    # The largest values of quantities that have scales of their own, by name.
    own: Mapping[str, Values] = field(default_factory=dict)

    def of(self, name: str) -> Any:
        """The scale of a quantity, "w1" or "upper.w1"."""
        quantity = name.rpartition(".")[2]
        scale = scale_of(quantity)
        return self.own[quantity] if scale == OWN else getattr(self, scale)

    def each(self, names: tuple[str, ...]) -> np.ndarray:
        """The scales of several quantities of one run, (names,)."""
        shared = vars(self)
        own = self.own
        return np.array([shared[scale] if scale else own[name] for name, scale in _units(names)])

    def relative(self, name: str, difference: float) -> float:
        """A difference of a quantity in units of its scale; 0 stays 0 where that is 0."""
        scale = self.of(name)
        if difference == 0.0:
            return 0.0
        return difference / scale if scale > 0.0 else np.inf


def reported_scales(layout: Layout, ledger: Ledger) -> Scales:
    """The scales of a run's errors: maxima over asperites and samples, in the laboratory."""
    tops = {
        name: max(map(largest, ledger.series(name)))
        for name, role in ROLES.items()
        if (role.measures or role.scale == OWN) and ledger.series(name)
    }
    mean = mean_velocity(layout)
    speed = 0.0
    internal = 0.0
    path = 0.0
    later = ledger.t[:, None] - ledger.t[0]
    for surface in layout.scene.surfaces:
        table = ledger.surfaces[surface.name]
        a = layout.asperites[layout.parts[surface.name]]
        swing = table["theta"] - surface.rest
        turning, bar, spring = internal_energies(
            a, table["omega"], table["nu"], swing - table["phi"]
        )
        internal = max(internal, largest(turning + bar + spring))
        vx, vy = table["vx_cm"] - mean[0], table["vy_cm"] - mean[1]
        direction = swing_direction(a.facing, swing)
        bob = rod_velocity(vx, vy, table["omega"], a.l1, *direction)
        speed = max(speed, float(np.max(np.hypot(*bob))))
        x, y = (table[name] - table[name][0] for name in ("x_bob", "y_bob"))
        path = max(path, largest(np.hypot(x - mean[0] * later, y - mean[1] * later)))
    return scales_of(layout, tuple(tops), np.array([*tops.values()]), speed, internal, path)


def scales_of(
    layout: Layout,
    names: tuple[str, ...],
    tops: np.ndarray,
    speed: Values,
    internal: Values,
    path: Values,
) -> Scales:
    """The scales of a run, or of members (members,), from largest magnitudes: see Extremes.

    `tops` are those of quantities with some names, (names,) or (names, members).
    """
    body = _largest_body(layout)
    single = tops.ndim == 1
    runs = 1 if single else tops.shape[1]
    inertia = body.inertia[:runs]
    mass = body.mass[:runs]
    length = body.rod[:runs]
    soft = body.soft
    highest = _highest(names, tops, ENERGIES)
    works = _places(names, WORKS).size > 0
    work = _highest(names, tops, WORKS) if works else highest
    potential = _highest(names, tops, POTENTIALS) / body.number
    energy = resolved(np.where(are_lost(work, internal), internal, highest), potential)
    # Where nothing happens, what the motion or a pendulum that turns by 1 rad could exchange.
    for possible in (0.5 * mass * np.asarray(speed) ** 2, 0.5 * soft):
        energy = np.where(energy > 0.0, energy, possible)
    rate = resolved(_highest(names, tops, RATES), np.sqrt(potential / inertia))
    velocity = resolved(speed, np.sqrt(potential / mass))
    if not single or rate == 0.0 or velocity == 0.0:
        # Where nothing moves but all of the scene, whose velocities are known to their rounding.
        resting = np.maximum(np.sqrt(energy / mass), largest(layout.velocities))
        velocity = np.where(velocity > 0.0, velocity, resting)
        rate = np.where(rate > 0.0, rate, np.sqrt(energy / inertia))
    scales: dict[str, Any] = {
        "rate": rate,
        "length": length_scale(path, length),
        "velocity": velocity,
        "energy": energy,
        "total": np.maximum(energy, _highest(names, tops, TOTALS)),
        "work": work if works else np.zeros_like(work),
    }
    own = {names[place]: tops[place] for place in _with_own_scale(names)}
    if single:
        scales = {scale: each.item() for scale, each in scales.items()}
        own = {name: each.item() for name, each in own.items()}
    return Scales(**scales, own=own)


class _LargestBody(NamedTuple):
    """The largest constants of any asperite; arrays are (1,), or of all samples of members."""

    inertia: np.ndarray
    mass: np.ndarray
    rod: np.ndarray  # l1 + l2
    soft: float  # the smallest stiffness of a pendulum that is not rigid; 0 if any is
    number: int  # of asperites


@once_per_layout
def _largest_body(layout: Layout) -> _LargestBody:
    a = layout.together.asperites
    inertia, mass, rod = (
        np.atleast_2d(each).max(axis=1) for each in (a.inertia, a.mass, a.l1 + a.l2)
    )
    soft = float(np.where(np.isfinite(a.kappa), a.kappa, 0.0).min())
    return _LargestBody(inertia, mass, rod, soft, layout.scene.count)


def length_scale(path: Values, rod: Values) -> np.ndarray:
    """The scale of lengths: how far bobs move, at most the longest rod; this where they do not."""
    moves = path > UNRESOLVED * rod
    return np.where(moves, np.minimum(path, rod), rod)


def are_lost(work: Values, energy: Values) -> np.ndarray:
    """Whether works lie below the rounding of an energy that they change."""
    return np.logical_not(work > EPSILON * energy)


@lru_cache
def _places(names: tuple[str, ...], chosen: tuple[str, ...]) -> np.ndarray:
    """The places of the chosen quantities, of those that there are, among some names."""
    return np.array([names.index(name) for name in chosen if name in names], int)


@lru_cache
def _with_own_scale(names: tuple[str, ...]) -> tuple[int, ...]:
    """The places of quantities, without those of single surfaces, that have scales of their own."""
    return tuple(k for k, name in enumerate(names) if name in ROLES and name not in COMMON)


def _highest(names: tuple[str, ...], tops: np.ndarray, chosen: tuple[str, ...]) -> Any:
    """The largest of the chosen quantities, of those that there are; 0 without any."""
    places = _places(names, chosen)
    return np.maximum.reduce(tops[places]) if places.size > 0 else np.zeros(tops.shape[1:])


def resolved(measured: Values, possible: Values) -> np.ndarray:
    """What was measured, or what is possible where only round-off was."""
    possible = np.where(np.isfinite(possible), possible, 0.0)
    return np.where(measured > UNRESOLVED * possible, measured, possible)


def scale_of(name: str) -> str:
    """The scale that a quantity, "w1" or "upper.w1", declares: a field of Scales, or its own."""
    return ROLES[name.rpartition(".")[2]].scale


@lru_cache
def without_surfaces(names: tuple[str, ...]) -> tuple[str, ...]:
    """The names of quantities without those of surfaces: "w1" of "upper.w1"."""
    return tuple(name.rpartition(".")[2] for name in names)


@lru_cache
def are_common(names: tuple[str, ...]) -> np.ndarray:
    """Whether the errors of quantities are relative to a common scale, (names,)."""
    return np.array([name in COMMON for name in without_surfaces(names)])


@lru_cache
def _units(names: tuple[str, ...]) -> tuple[tuple[str, str], ...]:
    """Of each quantity its name without a surface, and its scale; "" if that is its own."""
    each = without_surfaces(names)
    scales = [scale_of(name) for name in each]
    own = [scale == OWN for scale in scales]
    return tuple((n, "" if o else s) for n, s, o in zip(each, scales, own, strict=True))


def largest_of_runs(series: np.ndarray, runs: int) -> np.ndarray:
    """The largest magnitude of a series in each of some runs, over times and asperites."""
    each = np.abs(series).reshape(-1, runs, series.shape[1])
    highest: np.ndarray = np.maximum.reduce(each, axis=(0, 2))
    return highest


def largest(values: np.ndarray) -> float:
    """The largest magnitude; 0 of an empty array."""
    return float(np.maximum.reduce(np.abs(values), axis=None, initial=0.0))
