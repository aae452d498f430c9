"""A short run: two asperites pass, and the energy error decreases at the order of the method.

The error of the energy balance has the order of the method only if the force is the slope of the
energy, and smooth enough along the path: without jumps for order two, smooth throughout for order
six.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from tribo.integrators.methods import METHODS
from tribo.kernels.status import Status
from tribo.model.asperite import Asperite
from tribo.model.initial import Initial
from tribo.model.interaction import Interaction
from tribo.model.scene import Scene
from tribo.model.settings import Output
from tribo.model.surface import Surface
from tribo.report_card.card import Check
from tribo.report_card.scan import PotentialScan
from tribo.report_card.smoothness import smooth_stretch
from tribo.simulation import prepare

# Longest rod [length over which the force changes].
LONGEST_ROD = 6.0

# Distance that is left for the pendulums to swing in [rod length].
SPACE = 0.15

# Distance by which the bobs approach, and part again [rod length].
PASSAGE = 2.0

# Stiffness of the torsion springs [largest torque on the path / rad].
STIFFNESS = 20.0

# Swing at the start [rad].
KICK = 0.1

# Speed of the upper surface [rod length / time], where a radian of the pendulums takes one unit of
# time.
SPEED = 0.5

# Largest distance of the bobs [cutoff], so that they stay within it.
CLEAR = 0.95

# Samples of a run.
SAMPLES = 17

# Longest step [time], as for SPEED, and [time in which a bob crosses a feature], for order two.
FIRST_STEP = 0.2
STEP_OF_FEATURE = 0.25

# Number of runs, each with half the step of the one before.
RUNS = 7

# Energy error that is round-off, relative to the energies of the run.
FLOOR = 1e-12

# Amount by which the order may be missed over two halvings.
SLACK = 0.3


def check_motion(scan: PotentialScan) -> list[Check]:
    """Check the order of each method for which the potential is smooth enough."""
    promised = float(scan.potential.smoothness_within())
    low, high = smooth_stretch(scan)
    room = SPACE * _rod(scan)
    smooth = low <= scan.length - room and scan.length + 2.0 * room <= high
    scene = passage(scan, high if smooth else scan.high)
    suitable = {"verlet": True, "kahan-li-6": smooth}
    return [
        _order(scan, scene, name)
        for name, wanted in suitable.items()
        if wanted and promised >= METHODS[name].smoothness
    ]


def passage(scan: PotentialScan, end: float) -> Scene:
    """A scene in which a bob passes another at the typical distance.

    Parameters
    ----------
    scan : PotentialScan
    end : float
        Largest distance between the bobs [length].

    Returns
    -------
    Scene
        Stiff pendulums keep the bobs near straight paths.  Rods are as long as the typical
        distance, or shorter if the force changes over a short length; a radian of the pendulums
        takes one unit of time.
    """
    closest, rod = scan.length, _rod(scan)
    end = min(CLEAR * scan.cutoff, end) - SPACE * rod
    farthest = max(min(closest + PASSAGE * rod, end), closest + SPACE * rod)
    start = math.sqrt(farthest**2 - closest**2)
    distances = np.linspace(max(closest - SPACE * rod, scan.low), farthest, 64)
    force = np.abs(scan.compiled(distances)[1])
    largest = float(np.max(force, initial=0.0, where=np.isfinite(force))) or 1.0
    kappa = STIFFNESS * rod * largest
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
    interactions = (Interaction(scan.potential),)
    return Scene((upper, lower), interactions, duration, output=Output(samples=SAMPLES))


def _feature(scan: PotentialScan) -> float:
    """The length over which the force changes."""
    return float(scan.potential.feature()[0]) or scan.length / LONGEST_ROD


def _rod(scan: PotentialScan) -> float:
    return min(scan.length, LONGEST_ROD * _feature(scan))


def _order(scan: PotentialScan, scene: Scene, method: str) -> Check:
    """Check that the energy error decreases at the order of the method, down to round-off."""
    order = METHODS[method].order
    between = scene.duration / (SAMPLES - 1)
    crossing = _feature(scan) / (SPEED * _rod(scan))
    parts = math.ceil(between / (0.5 * order * min(FIRST_STEP, STEP_OF_FEATURE * crossing)))
    errors: list[float] = []
    for k in range(RUNS):
        error, status = _energy_error(scene, method, between / (parts * 2**k))
        if status != "completed":
            return Check(method, f"order {order}", math.nan, FLOOR, note=status, failed=True)
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
        note=f"orders as the step is halved: {', '.join(orders)}" if orders else "",
    )


def _energy_error(scene: Scene, method: str, step: float) -> tuple[float, str]:
    """Largest |energy gained - work applied| of a run relative to its energies, and the status."""
    result = prepare(scene, method=method, step=step).compute()
    if result.status == Status.INTERRUPTED:
        raise KeyboardInterrupt
    system = result.system
    swing = 0.5 * float(scene.surfaces[0].asperite.kappa) * KICK**2
    gap = system["total_energy_change"] - system["applied_work"]
    unit = swing + float(np.max(np.abs(system["contact_energy"])))
    return float(np.max(np.abs(gap))) / unit, result.status
