"""The frequencies that steps have to resolve."""

import math
from collections.abc import Callable, Iterator

import numpy as np

from tribo.integrators.methods import Method
from tribo.integrators.splitting import Splitting
from tribo.integrators.step_control import count_of_steps
from tribo.kernels import records as row
from tribo.kernels.records import OF_MEMBERS
from tribo.layout.elastic_body import stiffest
from tribo.layout.layout import Layout, once_per_layout
from tribo.layout.scene_records import MemberNumbers, stiffness_at_bars
from tribo.layout.tables import constants_of
from tribo.model.fields import curvature_of

# Change of a place in units of a rod's length, of an angle in radians, and of a velocity in these
# for each unit of time, by which derivatives of a user's forces are taken.  A smaller one would let
# a jump of a force, as of dry friction at rest, demand steps that are too short to be of use.
DIFFERENCE = 0.01

# Bounds on steps h with reservoirs, where a pendulum of frequency w swings.  The jumps by which
# strong friction undoes the drifts leave an error that heats it.  With z = gamma h / mass:
# <twist^2> of harmonic swings is too large by about 0.12 z (w h / 2)^4, from the covariance of a
# step, and that of wide swings on damped bars by about 0.1 z^2 T / kappa (less for z > 6), but by
# less than 1 % for z < 0.25 at any T; benchmarks/damped_swings.py.  Both stay below 1 %.
MOST_DAMPED_PHASE = 0.08  # of z (w h / 2)^4
MOST_DAMPED_SWING = 0.1  # of z^2 T / kappa
MOST_DAMPING = 0.25  # of z, where T / kappa is large


def pendulum_frequency(layout: Layout, members: MemberNumbers | None = None) -> float:
    """The angular frequency of the fastest pendulum, also of any of the members [rad / time]."""
    return float(np.max(_constants(layout, members)[row.FREQUENCY]))


def spring_frequency(layout: Layout, members: MemberNumbers | None = None) -> float:
    """A bound on the angular frequencies of lattice springs and of pulling springs [rad / time].

    By Gershgorin: the sum of a row of the matrix of stiffnesses, over mass and inertia of its bar;
    the largest of the members, where there are any.
    """
    a = layout.asperites
    surfaces = layout.surfaces
    springs = layout.model.springs
    pulling = surfaces.stiffness if members is None else members.of_surfaces[..., row.OWN_STIFFNESS]
    has_stage = np.array([surface.drive.stage is not None for surface in layout.scene.surfaces])
    stiffness = np.where(has_stage, pulling, 0.0)[..., a.surface]
    if springs is not None:
        columns = layout.places.columns
        stiffness += 2.0 * stiffness_at_bars(springs, layout.model.each.shape[1])[columns]
    for k, of_body in stiffest(layout.scene).items():
        stiffness = stiffness + (a.surface == k) * of_body
    return float(np.sqrt(np.max(stiffness * _mobility(_constants(layout, members), row.L2))))


def bath_frequency(layout: Layout) -> float:
    """The angular frequency of the fastest oscillator of any bath [rad / time]; 0 without one."""
    baths = (layout.model.bath, layout.model.torsional)
    fastest = [float(np.max(bath[row.OSCILLATOR_FREQUENCY])) for bath in baths if bath is not None]
    return max(fastest, default=0.0)


def schedule_frequency(layout: Layout) -> float:
    """The largest angular frequency of a schedule that is a sine [rad / time]; or 0."""
    return max((each.schedule.frequency for each in layout.scheduled), default=0.0)


def corrugation_frequency(layout: Layout) -> float:
    """The largest angular frequency of a bob in a field that states its curvature [rad / time]."""
    mobility = _mobility(layout.constants, row.L1)
    fastest = 0.0
    # The largest factors on fields, by the rows of their schedules.
    numbers = enumerate(layout.scheduled, start=1)
    factors = {row: each.schedule.largest for row, each in numbers}
    for field in layout.model.fields or ():
        curvature = curvature_of(field.potential) * factors.get(field.modulation, 1.0)
        if curvature > 0.0:
            on = np.isin(layout.asperites.surface, field.surfaces)
            fastest = max(fastest, float(np.sqrt(curvature * np.max(mobility[on]))))
    return fastest


def contact_frequency(layout: Layout) -> float:
    """The largest of a bob in the minimum of a potential, without its cutoff, that declares one."""
    mobility = 2.0 * float(np.max(_mobility(layout.constants, row.L1)))
    inner = (getattr(i.potential, "potential", i.potential) for i in layout.scene.interactions)
    curvatures = (float(each.minimum()[2]) for each in inner if hasattr(each, "minimum"))
    return math.sqrt(max(0.0, 0.0, *curvatures) * mobility)


def first_step(layout: Layout, members: MemberNumbers | None = None) -> float:
    """The first step: short against the run and the period of every pendulum and oscillator."""
    own = np.asarray(layout.asperites) if members is None else members.asperites
    a = {name: own[name] for name in ("kappa", "inertia", "i2")}
    mobility = np.maximum(1.0 / a["inertia"], 1.0 / a["i2"])
    pendulum = float(np.sqrt(a["kappa"] * mobility).max())
    fastest = max(pendulum, bath_frequency(layout), schedule_frequency(layout))
    return min(0.05 / fastest if fastest > 0.0 else np.inf, 1e-3 * layout.run_time)


@once_per_layout
def unit_step(layout: Layout) -> float:
    """The unit of equal steps: the time in which the fastest pendulum turns by one radian."""
    fastest = pendulum_frequency(layout)
    return min(1.0 / fastest if fastest > 0.0 else np.inf, 0.01 * layout.run_time)


def longest_damped_step(layout: Layout, members: MemberNumbers | None = None) -> float:
    """The longest step of a splitting method with which reservoirs leave swings their temperature.

    Infinite where no reservoir acts on pendulums that can swing [time].
    """
    a = layout.asperites
    table = layout.constants
    gamma, swing_gamma, temperature, other = (
        layout.surfaces[name] if members is None else members.of_surfaces[..., place]
        for place, name in list(enumerate(OF_MEMBERS))[row.OWN_GAMMA :]
    )
    warmest = np.maximum(temperature, other)[..., a.surface]
    with np.errstate(divide="ignore", invalid="ignore"):
        on_bars = gamma[..., a.surface] / table[row.MASS] * np.isfinite(table[row.INERTIA])
        rates = on_bars + swing_gamma[..., a.surface] / table[row.INERTIA]
        most = (16.0 * MOST_DAMPED_PHASE / (rates * table[row.FREQUENCY] ** 4)) ** 0.2
        torsion = table[row.KAPPA] / warmest
        curved = np.maximum(MOST_DAMPING, np.sqrt(MOST_DAMPED_SWING * torsion)) / on_bars
        curved = np.where(warmest > 0.0, curved, np.inf)
    return float(min(np.nanmin(most, initial=np.inf), np.nanmin(curved, initial=np.inf)))


def user_frequency(layout: Layout) -> float:
    """The largest rate at which a user's forces change motions at the start [rad / time]; or 0."""
    with np.errstate(all="ignore"):
        rates = [rate for rate in _user_rates(layout) if np.isfinite(rate)]
    return max(rates, default=0.0)


def turn_of_step(layout: Layout, method: Method, step: float, frequency: float) -> float:
    """The phase of a frequency in the longest substep that a splitting method takes [rad]."""
    return frequency * longest_step(layout, step) * longest_kick(method)


def longest_step(layout: Layout, step: float) -> float:
    """The longest of equal parts of the times between samples, of at most `step` [time]."""
    intervals = np.diff(layout.stops)
    return float(np.max(intervals / count_of_steps(intervals, step)))


def longest_kick(method: Method) -> float:
    """The longest kick of a splitting method, in units of the step."""
    assert isinstance(method.coefficients, Splitting)
    return float(np.max(np.abs(method.coefficients.kicks)))


def _constants(layout: Layout, members: MemberNumbers | None) -> np.ndarray:
    """The constants of asperites, (rows, asperites), or of those of members, (rows, members, n)."""
    if members is None:
        return layout.constants
    table = constants_of(layout.scene, members.asperites.ravel())
    return table.reshape(len(table), *members.asperites.shape)


def _mobility(table: np.ndarray, length: int) -> np.ndarray:
    """Velocity of each bob (with L1) or bar (with L2) for a unit of momentum, at most."""
    return 1.0 / table[row.MASS] + table[length] ** 2 / table[row.INERTIA]


def _user_rates(layout: Layout) -> Iterator[float]:
    """Rates of change of places, angles and velocities, at one asperite of each surface."""
    a = layout.asperites
    mobility = _mobility(layout.constants, row.L2)
    for drive in layout.model.drives or ():
        i = int(layout.surfaces.start[drive.surface])
        place = np.add(drive.origin, (a.x[i], a.y[i] + a.facing[i] * a.l2[i]))
        velocity = np.add(drive.velocity, (a.vx[i], a.vy[i]))
        state = (0.0, *place, *velocity, 0.0, 0.0)
        size = float(a.l1[i] + a.l2[i])
        force = drive.plugin.force_on_bar
        yield np.sqrt(_slope(force, state, (1, 2), size) * mobility[i])
        yield _slope(force, state, (3, 4), size) * mobility[i]
    for end in layout.model.ends or ():
        i = int(layout.surfaces.start[end.surface])
        angles = (0.0, float(a.phi[i]), float(a.nu[i]), 0.0)
        arm = a.bar_length[i] / a.i2[i]
        force = end.plugin.end_forces
        yield np.sqrt(_slope(force, angles, (1, 3), 1.0) * arm)
        yield _slope(force, angles, (2,), 1.0) * arm


def _slope(
    force: Callable[..., tuple[float, ...]],
    state: tuple[float, ...],
    places: tuple[int, ...],
    size: float,
) -> float:
    """The largest derivative of a force by some of its arguments; nan if it cannot be computed."""
    slopes = [0.0]
    for place in places:
        one = list(state)
        other = list(state)
        one[place] -= DIFFERENCE * size
        other[place] += DIFFERENCE * size
        try:
            change = np.subtract(force(*other), force(*one))
        except (ArithmeticError, ValueError):
            return np.nan
        slopes.append(float(np.max(np.abs(change))) / (2.0 * DIFFERENCE * size))
    return max(slopes)
