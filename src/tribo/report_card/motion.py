"""A short run: two asperites pass, and the energy error falls at the order of the method.

Only if the force is the slope of the energy, smooth along the way, does the energy that the system
gains come as near to the work applied as the method's order says.  Order two needs a force without
jumps, order six one that is smooth all the way.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from tribo.integrators.methods import METHODS
from tribo.model.asperite import Asperite
from tribo.model.interaction import Interaction
from tribo.model.scene import Scene
from tribo.model.settings import Output
from tribo.model.surface import Initial, Surface
from tribo.report_card.card import Check
from tribo.report_card.smoothness import smooth_stretch
from tribo.report_card.specimen import Specimen
from tribo.simulation import prepare

RODS_OF_FEATURE = 6.0  # a rod is at most so many of the lengths on which the force changes
SPACE = 0.15  # of a rod, for the pendulums to swing in
PASSAGE = 2.0  # rods by which the bobs come nearer, and part again
STIFFNESS = 20.0  # of the torsion springs, in units of the largest torque on the way
KICK = 0.1  # swing at the start [rad]
SPEED = 0.5  # rods in the time of a pendulum's radian
CLEAR = 0.95  # of the range: the bobs stay within that
SAMPLES = 17
FIRST_STEP = 0.2  # of a pendulum's radian
OF_FEATURE = 0.25  # and of the time in which a bob crosses a feature
HALVINGS = 7
FLOOR = 1e-12  # relative energy errors below that are round-off
SLACK = 0.3  # by which the order may be missed, over two halvings


def check_motion(specimen: Specimen) -> list[Check]:
    """A line for each method that the potential is smooth enough for."""
    promised = float(specimen.potential.smoothness_within())
    low, high = smooth_stretch(specimen)
    room = SPACE * _rod(specimen)
    smooth = low <= specimen.length - room and specimen.length + 2.0 * room <= high
    scene = passage(specimen, high if smooth else specimen.high)
    fit = {"verlet": True, "kahan-li-6": smooth}
    return [
        _line(specimen, scene, name)
        for name, wanted in fit.items()
        if wanted and promised >= METHODS[name].smoothness
    ]


def passage(specimen: Specimen, end: float) -> Scene:
    """A bob passes another at the typical distance; stiff pendulums keep it near its path.

    They stay within `end` of one another.  Rods are as long as the distance, or short if the force
    changes on a short length; a radian of the pendulums takes one unit of time.
    """
    closest, rod = specimen.length, _rod(specimen)
    end = min(CLEAR * specimen.cutoff, end) - SPACE * rod
    farthest = max(min(closest + PASSAGE * rod, end), closest + SPACE * rod)
    start = math.sqrt(farthest**2 - closest**2)
    on_the_way = np.linspace(max(closest - SPACE * rod, specimen.low), farthest, 64)
    force = np.abs(specimen.compiled(on_the_way)[1])
    pull = float(np.max(force, initial=0.0, where=np.isfinite(force))) or 1.0
    kappa = STIFFNESS * rod * pull
    mass = 2.0 * kappa / rod**2
    asperite = Asperite(m1=mass, m2=mass, kappa=kappa, length=rod, bar_length=rod)
    upper = Surface(
        "upper",
        bob=(-start, closest),
        velocity=(SPEED * rod, 0.0),
        asperite=asperite,
        initial=Initial(theta=KICK),
    )
    lower = Surface("lower", facing="up", asperite=asperite)
    duration = 2.0 * start / (SPEED * rod)
    interactions = (Interaction(specimen.potential),)
    return Scene((upper, lower), interactions, duration, output=Output(samples=SAMPLES))


def _feature(specimen: Specimen) -> float:
    """The length on which the force changes."""
    return float(specimen.potential.feature()[0]) or specimen.length / RODS_OF_FEATURE


def _rod(specimen: Specimen) -> float:
    return min(specimen.length, RODS_OF_FEATURE * _feature(specimen))


def _line(specimen: Specimen, scene: Scene, method: str) -> Check:
    """Energy errors at one halving of the step after another, down to round-off."""
    order = METHODS[method].order
    between = scene.duration / (SAMPLES - 1)
    crossing = _feature(specimen) / (SPEED * _rod(specimen))
    parts = math.ceil(between / (0.5 * order * min(FIRST_STEP, OF_FEATURE * crossing)))
    errors: list[float] = []
    for k in range(HALVINGS):
        error, status = _energy_error(scene, method, between / (parts * 2**k))
        if status != "completed":
            return Check(method, f"order {order}", math.nan, FLOOR, says=status, failed=True)
        errors.append(error)
        if error < FLOOR:
            break
    bound = FLOOR
    if len(errors) > 2:
        bound = max(FLOOR, errors[-3] * 4.0 ** (SLACK - order))
    orders = [f"{math.log2(a / b):.1f}" for a, b in itertools.pairwise(errors) if a > b > 0.0]
    return Check(
        method,
        f"energy error of a run, at order {order}",
        errors[-1],
        bound,
        says=f"orders seen as the step is halved: {', '.join(orders)}" if orders else "",
    )


def _energy_error(scene: Scene, method: str, step: float) -> tuple[float, str]:
    """Largest |energy gained - work applied| of a run, relative to what energies there are."""
    result = prepare(scene, method=method, step=step).run()
    system = result.system
    swing = 0.5 * float(scene.surfaces[0].asperite.kappa) * KICK**2
    gap = system["total_energy_change"] - system["applied_work"]
    unit = swing + float(np.max(np.abs(system["contact_energy"])))
    return float(np.max(np.abs(gap))) / unit, result.status
