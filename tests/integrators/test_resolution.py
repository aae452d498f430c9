"""Steps of splitting methods against the pendulums and springs of a scene."""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

import tribo
from support.kernels import shared_kernel
from tribo import (
    Asperite,
    Corrugation,
    Coulomb,
    Custom,
    Ends,
    Field,
    Free,
    InputError,
    Langevin,
    Output,
    Pulled,
    Scene,
    Springs,
    Surface,
    paper,
)
from tribo.accuracy.choose_method import check_damped_step
from tribo.compiler.lanes import LANES
from tribo.compiler.lanes_memory import with_spare_lanes
from tribo.integrators.rotations import changes, set_rotations
from tribo.integrators.step_control import LARGEST, all_finite
from tribo.kernels.samples import STORED
from tribo.layout.layout import lay_out
from tribo.ledger.ledger import assemble
from tribo.ledger.samples import Samples
from tribo.loops.resolution import (
    MOST_DAMPED_PHASE,
    corrugation_frequency,
    longest_damped_step,
    spring_frequency,
)

KAPPA = 1e4


class Trap(NamedTuple):
    """A stiff trap with friction."""

    stiffness: float
    drag: float

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        """f2."""
        return -self.stiffness * x - self.drag * vx, -fy


class Clamp(NamedTuple):
    """Ends that hold the angle of a bar."""

    stiffness: float

    def end_forces(self, t, phi, nu, twist):
        """Opposed forces."""
        return 0.0, self.stiffness * phi, 0.0, -self.stiffness * phi


def on_reservoir(temperature=0.0, **settings):
    """A row of three on a reservoir."""
    reservoir = Langevin(0.5, temperature)
    row = Surface("row", shape=(3, 1), spacing=(1.0, 0.0), langevin=reservoir, **settings)
    return Scene([row], Coulomb(0.1), 10.0, output=Output(samples=2))


def frequency_of(scene):
    """Of the first pendulum on its spring [rad / time]."""
    each = scene.surfaces[0].each
    return math.sqrt(each["kappa"][0] / each["inertia"][0])


def test_a_stiff_pendulum_is_noted_and_then_refused():
    """A note from 0.5 rad on says by how much statics are off; no step rotates it by 2 rad."""
    stiff = on_reservoir(asperite=Asperite(kappa=KAPPA))
    frequency = frequency_of(stiff)

    def notes(method, turn):
        """Those on pendulums that turn by an angle in a step, of a run of a few steps."""
        step = turn / frequency
        found = tribo.simulate(replace(stiff, duration=4.0 * step), method=method, step=step).notes
        return [note for note in found if "right angle" in note]

    assert notes("verlet", 0.45) == notes("midpoint", 1.5) == []
    (note,) = notes("verlet", 1.5)
    assert "by 0.81 of the right angle" in note
    assert len(notes("verlet", 1.99)) == 1
    with pytest.raises(InputError, match=r"^step: must be at most 0.0327 for verlet, got 0.04: "):
        tribo.simulate(stiff, method="verlet", step=0.04)


# Kernels that kernels alone can call.
@shared_kernel
def rotate(x, rate, frequencies, tau, rotations):
    """The first of the oscillators after tau."""
    set_rotations(frequencies, tau, rotations)
    dx, change = changes(x, rate, (rotations[0, 0], rotations[1, 0], rotations[2, 0]))
    return x + dx, rate + change


@shared_kernel
def is_finite(x):
    """Whether all components are."""
    return all_finite(x)


def test_the_noted_deflection_is_that_of_the_method():
    """Kicks of a constant force keep a pendulum at the angle of the note."""
    frequency = 61.0
    push = 3.0
    turn = 1.5
    h = turn / frequency
    angle = 0.75 / np.tan(0.75) * push / frequency**2  # 0.805 of the right one
    frequencies = with_spare_lanes(np.full(LANES, frequency))
    rotations = with_spare_lanes(np.full((3, 2 * LANES), np.nan))
    x, rate = rotate(angle, 0.5 * h * push, frequencies, h, rotations)
    assert x == pytest.approx(angle, rel=1e-12, abs=0.0)
    assert rate == pytest.approx(-0.5 * h * push, rel=1e-12, abs=0.0)


def test_kicks_of_a_composition_are_longer_or_shorter_than_its_step():
    """The longest kick of kahan-li-6 is 0.80 of its step."""
    row = Surface("row", asperite=Asperite(kappa=KAPPA))
    stiff = Scene([row], Coulomb(0.1), 10.0, output=Output(samples=2))
    with pytest.raises(InputError, match=r"must be at most 0\.0409 for kahan-li-6"):
        tribo.simulate(stiff, method="kahan-li-6", step=0.05)


@pytest.mark.parametrize(
    "settings",
    [{"springs": Springs(1e4), "drive": Free()}, {"drive": Pulled(stiffness=1e4, speed=0.1)}],
)
def test_stiff_springs(settings):
    """Steps that would be unstable are refused; with noise, the automatic step is short enough."""
    for temperature in (0.0, 0.1):
        with pytest.raises(InputError, match=r"^step: .* the stiffest spring"):
            tribo.simulate(on_reservoir(temperature, **settings), method="verlet", step=0.1)
    stiff = on_reservoir(0.1, **settings)
    turn = tribo.explain(stiff).step * math.sqrt(1e4 / stiff.surfaces[0].each["mass"][0])
    # Of one asperite on one spring; a row has modes of up to twice its frequency.
    assert 0.04 < turn <= 0.1


def test_steep_corrugation():
    """With noise, the automatic step resolves a rigid tip, which has no frequency of its own."""
    tip = Surface("tip", asperite=Asperite(kappa=np.inf), langevin=Langevin(1.0, 0.1))
    field = Field(Corrugation(20.0, 0.01), on=["tip"])
    scene = Scene([tip], [], 10.0, fields=[field], output=Output(samples=2))
    frequency = 2.0 * np.pi / 0.01 * np.sqrt(20.0 / 3.0)
    # The longest step that divides the interval of samples, and turns by 0.1 rad at most.
    assert tribo.explain(scene).step == pytest.approx(10.0 / math.ceil(10.0 * frequency / 0.1))


def test_the_frequency_of_two_bars_on_a_spring():
    """sqrt(2 k / M), with which they swing against each other, is no more than the bound."""
    row = {"shape": (2, 1), "spacing": (1.0, 0.0), "drive": "free"}
    half = Asperite(kappa=np.inf, m1=0.5, m2=0.5)
    scene = Scene([Surface("s", asperite=half, springs=Springs(3.0), **row)], [], 1.0)
    exact = np.sqrt(2.0 * 3.0 / 1.0)
    assert spring_frequency(lay_out(scene)) >= exact * (1.0 - 1e-12)


def test_the_longest_step_of_a_damped_pendulum():
    """Where gamma h / M times the fourth power of half the turn, w h / 2, reaches its bound."""
    gamma = 0.5
    surface = Surface("s", asperite=Asperite(kappa=KAPPA), drive="free", langevin=Langevin(gamma))
    scene = Scene([surface], [], 1.0)
    h = longest_damped_step(lay_out(scene))
    phase = gamma / surface.each["mass"][0] * h * (0.5 * frequency_of(scene) * h) ** 4
    assert phase == pytest.approx(MOST_DAMPED_PHASE, rel=1e-6)


def test_the_frequency_of_a_pendulum_in_a_corrugation():
    """The curvature A q^2 acts on the bob, which a push moves with 1 / M + l1^2 / I."""
    surface = Surface("s", asperite=Asperite(kappa=1.0), drive="free")
    field = Field(Corrugation(0.3, 1.0), on=["s"])
    each = surface.each
    mobility = 1.0 / each["mass"][0] + each["l1"][0] ** 2 / each["inertia"][0]
    exact = np.sqrt(0.3 * (2.0 * np.pi) ** 2 * mobility)
    layout = lay_out(Scene([surface], [], 1.0, fields=[field]))
    assert corrugation_frequency(layout) == pytest.approx(exact)


def test_steps_that_would_heat_are_refused():
    """A step of one and a half times the longest one of damped pendulums."""
    with pytest.raises(InputError, match="would heat them"):
        check_damped_step(1.0, 1.5)


@pytest.mark.parametrize(
    "settings",
    [
        {"drive": Custom(force=Trap(1e4, 0.0))},
        {"drive": Custom(force=Trap(0.0, 1e3))},
        {"bars": Ends(Clamp(1e4))},
    ],
)
def test_stiff_forces_of_a_user(settings):
    """The automatic step with noise is short against the rates of a user's forces."""
    assert tribo.explain(on_reservoir(0.1, **settings)).step < 3e-3


def test_a_soft_force_of_a_user_allows_the_usual_step():
    soft = on_reservoir(0.1, drive=Custom(force=Trap(0.1, 0.0)))
    assert tribo.explain(soft).step == tribo.explain(on_reservoir(0.1)).step


def test_a_search_begins_with_long_steps():
    """Stiff pendulums that are rotated exactly; from steps of 0.005 rad on it took 541,065."""
    asperite = Asperite(kappa=1e3)
    scene = paper.scene("A")
    surfaces = tuple(replace(surface, asperite=asperite) for surface in scene.surfaces)
    scene = replace(scene, surfaces=surfaces, output=Output(samples=9))
    result = tribo.simulate(scene, accuracy=1e-3, method="verlet")
    assert result.met
    assert result.cost.force_evaluations < 200_000


@pytest.mark.filterwarnings("error")
def test_numbers_that_overflow_stop_a_run_without_warnings():
    """A state whose squares overflow counts as not finite; its ledger has infinities."""
    flat = lay_out(on_reservoir())
    assert is_finite(with_spare_lanes(np.array([LARGEST, -1.0] * LANES)))
    assert not is_finite(with_spare_lanes(np.array([1.0, -10.0 * LARGEST] * LANES)))
    assert not is_finite(with_spare_lanes(np.array([1.0, np.nan] * LANES)))
    y = np.outer([1.0, 1e200], np.ones(2 * flat.core))
    s = np.ones((2, flat.accounts))
    stored = np.zeros((2, 1, STORED))
    baths = np.zeros((2, *flat.sampled_baths))
    samples = Samples(np.array([0.0, 1.0]), y, s, np.zeros(2), np.zeros(2), stored, baths)
    table = assemble(flat, samples).surfaces["row"]
    assert np.all(np.isfinite(table["theta"]))
    assert np.all(np.isinf(table["delta_e_int"][-1]))
