"""The model of what each method costs on a scene.

    seconds = evaluations x (seconds of an evaluation)
    evaluations = evaluations(1e-6) (accuracy / 1e-6)^(-1/slope), for each radian of the pendulums,
                  but at least those of a step for each sample, and of those towards encounters
    seconds of an evaluation = (for each run) + (for each asperite) + (for each bath oscillator)

The numbers were measured by benchmarks/calibrate.py and are part of the source: no clock decides
which method is chosen.  Only their ratios enter, which differ little between machines.  Methods
that integrate bath oscillators numerically are stable only if steps are short against the fastest
of them.  Methods that advance oscillators exactly are stable, but their errors fall more slowly
until steps are that short.  A step goes at most a fraction of the way to the nearest bob: those
towards encounters are about the integral of speed / clearance over time.
"""

from dataclasses import dataclass

import numpy as np

from tribo.accuracy.levels import NEAR
from tribo.accuracy.scales import largest
from tribo.integrators.methods import METHODS, Cost, Method, refusal
from tribo.integrators.step_control import count_of_steps
from tribo.kernels.kinematics import rod_position
from tribo.layout.layout import Layout
from tribo.ledger.motion import swing_direction
from tribo.ledger.nearest import nearest
from tribo.ledger.separation import in_box
from tribo.loops.pair_records import has_pair_loop
from tribo.loops.resolution import bath_frequency, unit_step
from tribo.potentials.potential import Potential, acting_charges

# Of gauss-radau-15 in the loop for pairs.
PAIR = Cost(5.13, 21.4, 12.0, 0.0, 0.0, 18)
# Evaluations per radian of a bath's fastest oscillator that methods need for stability.
FAST = 1.6
# The steepest slope where some derivative of a potential jumps.
ROUGH_SLOPE = 12.0
# Time of a pair of bobs, and of a call of an ASE calculator [ns]: of 512 bobs on 512 with AVX-512
# Coulomb takes 0.8 and Morse 2.9; EMT takes a million.
PAIR_OF_BOBS = 2.0
CALCULATOR_CALL = 1e6
# Neighbours of a bob in a list, as in benchmarks/scale.py: each is in reach of about a dozen.
LISTED = 16.0
# Times at which clearances are computed.
TIMES = 129
# Bobs of the first of two surfaces whose clearances are computed.
FOLLOWED = 8


@dataclass(frozen=True)
class Estimate:
    """What one method should cost on one scene."""

    method: Method
    evaluations: float
    seconds: float


def estimates(layout: Layout, accuracy: float) -> list[Estimate]:
    """Methods for the scene, the cheapest first.

    Equal steps cannot shorten at an encounter: methods with these are considered only where a fast
    bath would make even the best of the others take short steps throughout.
    """
    scene = layout.scene
    steps = max(steps_towards(layout), float(scene.times.size))
    fast = FAST * layout.run_time * bath_frequency(layout)
    radians = layout.run_time / unit_step(layout)
    steepest = ROUGH_SLOPE if np.isfinite(scene.smoothness) else np.inf

    def at_accuracy(each: float, slope: float) -> float:
        """Evaluations with so many for each radian at 1e-6."""
        return radians * each * (accuracy / 1e-6) ** (-1.0 / min(slope, steepest))

    found = []
    for method in METHODS.values():
        if method.cost is None or refusal(method, scene) is not None:
            continue
        if method.smoothness > scene.smoothness and method.adaptive:
            continue
        rate = rate_of(layout, method)
        count = max(at_accuracy(rate.evaluations, rate.slope), rate.step * steps)
        if count < fast and method.splits:
            count = max(count, at_accuracy(*method.cost.fast_bath))
        elif not method.splits:
            count = max(count, fast)
        found.append(Estimate(method, count, 1e-9 * count * _each(layout, rate)))
    found.sort(key=lambda item: item.seconds)
    adaptive = [item for item in found if item.method.adaptive]
    return adaptive if adaptive and adaptive[0].evaluations > fast else found


def rate_of(layout: Layout, method: Method) -> Cost:
    """The costs of a method, also where they were not measured."""
    if has_pair_loop(layout, method):
        return PAIR
    return method.cost or _assumed(method)


def _assumed(method: Method) -> Cost:
    """Those of the method of the same family with the nearest order, per evaluation."""
    family = [m for m in METHODS.values() if type(m.coefficients) is type(method.coefficients)]
    known = [(abs(m.order - method.order), m.cost) for m in family if m.cost is not None]
    _, cost = min(known)
    return cost._replace(slope=float(method.order), step=method.stages)


def _each(layout: Layout, rate: Cost) -> float:
    """Nanoseconds of one evaluation, without those of pairs of bobs."""
    oscillators = layout.coordinates - layout.core
    return rate.run + layout.scene.count * rate.asperite + oscillators * rate.oscillator


def evaluation_time(layout: Layout, method: Method) -> float:
    """Nanoseconds of one evaluation by the model of costs, which knows no effect apart."""
    pairs, _ = pairs_of_bobs(layout)
    calls = len(layout.calculator_calls) * CALCULATOR_CALL
    return _each(layout, rate_of(layout, method)) + pairs * PAIR_OF_BOBS + calls


def pairs_of_bobs(layout: Layout) -> tuple[int, bool]:
    """The pairs of bobs that one evaluation visits, and whether some bobs are in lists."""
    counts = [surface.count for surface in layout.scene.surfaces]
    visited = 0.0
    listed = False
    for contact in layout.model.contacts:
        for (one, other), row in zip(contact.pairs.tolist(), contact.rows.tolist(), strict=True):
            among = counts[one] * (counts[one] - 1) // 2
            every = among if one == other else counts[one] * counts[other]
            visited += every if row < 0 else LISTED * counts[one]
            listed = listed or row >= 0
    return round(visited), listed


def counted(layout: Layout, method: Method, step: float, times: np.ndarray) -> float:
    """The evaluations of one run through `times` with a given step."""
    each = (method.cost or _assumed(method)).step
    intervals = np.diff(times)
    steps = np.sum(count_of_steps(intervals, step))
    return float(steps * each + (not method.splits))


def steps_towards(layout: Layout) -> float:
    """The fewest steps that jump no encounter, if bobs keep their first velocity and swing."""
    a = layout.together.asperites
    count = layout.scene.count
    tx, ty = swing_direction(a.facing, layout.start[:count])
    places = np.column_stack([*rod_position(a.x, a.y, a.l1, tx, ty), layout.depths])
    in_place, box = in_box(layout, places)
    swinging = largest(a.l1 * layout.start[layout.coordinates :][:count])
    parts = list(layout.parts.values())
    times = np.linspace(layout.beginning, layout.scene.duration, TIMES)
    rates = [0.0]
    for contact in (each for each in layout.model.contacts if each.within is None):
        for one, other in contact.pairs:
            mine = parts[one]
            theirs = parts[other]
            first = np.arange(mine.start, mine.stop)
            if first.size > FOLLOWED:
                first = np.linspace(mine.start, mine.stop - 1, FOLLOWED)
            drift = layout.velocities[one] - layout.velocities[other]
            moved = places[first.astype(int)] + np.outer(times, [*drift, 0.0])[:, None]
            candidates = in_place[theirs]
            near = nearest(in_box(layout, moved)[0], candidates, box)[0].min(axis=1)
            try:
                clear = _clearances(contact.potential, near)
            except Exception:  # of the user's code, whose line the compiler names
                continue
            widest = clear.max()
            if widest > 0.0:  # bobs that stay at one place have no run
                speed = float(np.hypot(*drift)) + 2.0 * swinging
                rates.append(float(np.mean(speed / np.maximum(clear, 1e-3 * widest))))
    return max(rates) * layout.run_time / NEAR


def _clearances(potential: Potential, r: np.ndarray) -> np.ndarray:
    """The clearances of bobs at distances r (n,): together if the class has no rule of its own."""
    kind = type(potential)
    of_both = kind.clearance_between is Potential.clearance_between
    if not of_both or kind.clearance is not Potential.clearance:
        charges = acting_charges(potential)
        return np.array([potential.clearance_between(each, *charges) for each in r.tolist()])
    if not potential.acts_at_all():
        return np.full(r.size, np.inf)
    length, reach = potential.feature()
    return np.maximum(length, r - min(reach, potential.range()))
