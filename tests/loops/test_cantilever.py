"""One cantilever on many commensurate tips: closed forms of Prandtl and Tomlinson, N times over.

N rigid tips of a block stand at equal phases of a corrugation -A cos(q x), which acts on the block
as -N A cos(q x): its largest force is N A q, and its largest curvature N A q^2.
"""

import math

import numpy as np
import pytest
from scipy.integrate import dblquad
from scipy.optimize import brentq

import tribo
from tribo import (
    Asperite,
    Corrugation,
    Field,
    Langevin,
    Output,
    Pulled,
    Pushed,
    Scene,
    Surface,
)

COUNT = 12
AMPLITUDE = 0.05
WAVELENGTH = 1.3
Q = 2.0 * math.pi / WAVELENGTH
DEPTH = COUNT * AMPLITUDE
LARGEST = DEPTH * Q
CRITICAL = DEPTH * Q**2
TIP = Asperite(m1=0.5, m2=0.7, kappa=math.inf)
MASS = COUNT * 1.2


def block(drive, duration, samples=201, x=0.0, speed=0.0, **settings):
    """A block on a corrugation, at x and with a speed."""
    surface = Surface(
        "block",
        bob=(x, 1.0),
        velocity=(speed, 0.0),
        shape=(4, 3),
        spacing=(WAVELENGTH, 1.0),
        asperite=TIP,
        drive=drive,
        **settings,
    )
    field = Field(Corrugation(AMPLITUDE, WAVELENGTH), on=("block",))
    output = Output(samples=samples, ledger="surfaces", series=("forces",))
    return Scene((surface,), (), duration, fields=(field,), output=output)


def pulled(stiffness, periods, speed):
    """Pulled so slowly, and damped so strongly, that it follows its equilibrium."""
    damping = 2.0 * math.sqrt(MASS * (stiffness + CRITICAL))
    drive = Pulled(stiffness=stiffness, speed=speed, damping=damping, load=0.0, block=True)
    samples = 200 * periods + 1
    given = block(drive, periods * WAVELENGTH / speed, samples)
    return tribo.simulate(given, method="dop853", accuracy=1e-5)


def energy_of_a_slip(stiffness):
    """What the potential energy falls by where a minimum ends, and at what force it ends."""

    def energy(x, stage):
        return -DEPTH * math.cos(Q * x) + 0.5 * stiffness * (stage - x) ** 2

    before = math.acos(-stiffness / CRITICAL) / Q
    stage = before + LARGEST * math.sin(Q * before) / stiffness
    force = lambda x: LARGEST * math.sin(Q * x) - stiffness * (stage - x)  # noqa: E731
    after = brentq(force, before + 0.05 * WAVELENGTH, WAVELENGTH)
    return energy(before, stage) - energy(after, stage)


def test_static_friction_is_that_of_all_tips():
    """The largest force of a soft cantilever, whatever its speed."""
    for speed in (1e-3, 2e-4):
        force = pulled(0.3 * CRITICAL, 2, speed)["block"]["pull_force"]
        assert np.max(force) == pytest.approx(LARGEST, rel=1e-4)


def test_a_soft_cantilever_loses_the_energy_of_its_slips():
    """Mean friction times the wavelength is the energy by which each slip lowers the potential.

    A finite speed delays slips, by v^(2/3); two speeds give the limit.
    """
    stiffness = 0.3 * CRITICAL
    means = []
    for speed in (8e-4, 1e-4):
        result = pulled(stiffness, 2, speed)
        whole = result.t >= result.t[-1] * (0.5 - 1e-9)
        force = np.ravel(result["block"]["pull_force"])[whole]
        means.append(np.trapezoid(force, result.t[whole]) / np.ptp(result.t[whole]))
    limit = means[1] + (means[1] - means[0]) / 3.0
    assert means[0] > means[1]
    assert limit * WAVELENGTH == pytest.approx(energy_of_a_slip(stiffness), rel=0.01)


def test_a_stiff_cantilever_slides_without_slips():
    """At the stiffness N A q^2 stick-slip ends: the bars move smoothly, and friction is viscous."""
    largest = {}
    for ratio in (0.8, 1.25):
        result = pulled(ratio * CRITICAL, 2, 2e-4)
        speed = result["block"]["vx_cm"][:, 0] / 2e-4
        force = np.ravel(result["block"]["pull_force"])
        whole = result.t >= 0.5 * result.t[-1]
        largest[ratio] = np.max(speed)
        if ratio > 1.0:
            # k x' / (k + N A q^2 cos q x) of the stage's speed.
            assert np.max(speed) == pytest.approx(ratio / (ratio - 1.0), rel=0.03)
            assert abs(np.mean(force[whole][:-1])) <= 2e-3 * LARGEST
    assert largest[0.8] > 3.0 * largest[1.25]


@pytest.mark.parametrize("ratio", [0.4, 1.0, 1.7])
def test_damping_of_a_cantilever_in_contact_is_critical_where_both_springs_say(ratio):
    """M x'' = -(k + N A q^2) x - c x' about a minimum; a slow start stays harmonic."""
    stiffness = 0.3 * CRITICAL
    w = math.sqrt((stiffness + CRITICAL) / MASS)
    damping = ratio * 2.0 * MASS * w
    drive = Pulled(stiffness=stiffness, speed=0.0, damping=damping, load=0.0, block=True)
    speed = 1e-4
    given = block(drive, 10.0 / w, speed=speed)
    result = tribo.simulate(given, method="dop853", accuracy=1e-6)
    moved = result["block"]["x_bar"][:, 0] - result["block"]["x_bar"][0, 0]
    t = result.t
    root = np.emath.sqrt(ratio**2 - 1.0)
    if ratio == 1.0:
        expected = speed * t * np.exp(-w * t)
    else:
        expected = np.real(speed * np.exp(-ratio * w * t) * np.sinh(w * root * t) / (w * root))
    assert np.max(np.abs(moved - expected)) <= 1e-5 * np.max(np.abs(expected))


@pytest.mark.parametrize(("ratio", "slides"), [(1.06, True), (0.94, False)])
def test_a_damped_slide_is_trapped_below_the_retrapping_force(ratio, slides):
    """F = (4 / pi) G sqrt(N A / M), with G the friction of the whole block, where G is small.

    The slide that passes the maxima with no speed loses 8 G sqrt(N A / M) / q on its way from one
    to the next.
    """
    friction = math.sqrt(MASS * CRITICAL) / 40.0
    force = ratio * 4.0 / math.pi * friction * math.sqrt(DEPTH / MASS)
    fastest = 2.0 * math.sqrt(DEPTH / MASS)
    drive = Pushed(force=(force, 0.0), load=0.0, block=True)
    given = block(
        drive,
        40.0 * WAVELENGTH / fastest,
        speed=1.01 * fastest,
        langevin=Langevin(friction / COUNT, velocity=(0.0, 0.0)),
    )
    result = tribo.simulate(given, method="dop853", accuracy=1e-8)
    speed = result["block"]["vx_cm"][:, 0]
    assert np.all(speed > 0.0) == slides


def creep_speed(force, temperature, friction):
    """Mean speed of an overdamped body on a tilted cosine, by Stratonovich's formula."""

    def energy(x):
        return -DEPTH * math.cos(Q * x) - force * x

    def weight(y, x):
        return math.exp((energy(x) - energy(x - y)) / temperature)

    both = dblquad(weight, 0.0, WAVELENGTH, 0.0, WAVELENGTH)[0]
    pushed = 1.0 - math.exp(-force * WAVELENGTH / temperature)
    return temperature / friction * WAVELENGTH * pushed / both


@pytest.mark.parametrize(("share", "duration", "within"), [(0.5, 1.5e4, 0.15), (0.3, 4e5, 0.06)])
def test_a_pushed_block_creeps_as_stratonovich_says(share, duration, within):
    """At a temperature of a quarter of N A, and with a friction that damps within a step."""
    temperature = 0.25 * DEPTH
    friction = 6.0 * math.sqrt(MASS * CRITICAL)
    force = share * LARGEST
    drive = Pushed(force=(force, 0.0), load=0.0, block=True)
    reservoir = Langevin(friction / COUNT, temperature)
    given = block(drive, duration, 2, langevin=reservoir)
    result = tribo.simulate(given, method="verlet", step=0.15 / math.sqrt(CRITICAL / MASS))
    speed = np.ptp(result["block"]["x_bar"][:, 0]) / duration
    assert abs(speed / creep_speed(force, temperature, friction) - 1.0) <= within
