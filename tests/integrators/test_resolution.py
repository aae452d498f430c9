"""Steps of splitting methods against the pendulums and springs of a scene."""

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
from tribo.accuracy.choose_method import choose
from tribo.compiler.lanes import LANES
from tribo.compiler.lanes_memory import with_spare_lanes
from tribo.integrators.methods import METHODS
from tribo.integrators.rotations import changes, set_rotations
from tribo.integrators.step_control import LARGEST, all_finite
from tribo.kernels.samples import STORED
from tribo.layout.layout import lay_out
from tribo.ledger.ledger import assemble
from tribo.ledger.samples import Samples
from tribo.loops.resolution import longest_step, pendulum_frequency, spring_frequency
from tribo.results.notes import run_notes

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


def layout(temperature=0.0, end=10.0, **settings):
    """A row of three on a reservoir."""
    reservoir = Langevin(0.5, temperature)
    row = Surface("row", shape=(3, 1), spacing=(1.0, 0.0), langevin=reservoir, **settings)
    return lay_out(Scene([row], Coulomb(0.1), end, output=Output(samples=2)))


def test_a_stiff_pendulum_is_noted_and_then_refused():
    """A note from 0.5 rad on says by how much statics are off; no step rotates it by 2 rad."""
    stiff = layout(asperite=Asperite(kappa=KAPPA))
    verlet = METHODS["verlet"]
    frequency = pendulum_frequency(stiff)
    assert run_notes(stiff, verlet, 0.45 / frequency) == ()
    assert run_notes(stiff, METHODS["midpoint"], 1.5 / frequency) == ()
    (note,) = run_notes(stiff, verlet, 1.5 / frequency)
    assert "by 0.81 of the right angle" in note
    assert choose(stiff, None, "verlet", 1.99 / frequency).step == 1.99 / frequency
    with pytest.raises(InputError, match=r"^step: must be at most 0.0327 for verlet, got 0.04: "):
        choose(stiff, None, "verlet", 0.04)


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
    assert x == pytest.approx(angle, rel=1e-12)
    assert rate == pytest.approx(-0.5 * h * push, rel=1e-12)


def test_kicks_of_a_composition_are_longer_or_shorter_than_its_step():
    """The longest kick of kahan-li-6 is 0.80 of its step."""
    row = Surface("row", asperite=Asperite(kappa=KAPPA))
    stiff = lay_out(Scene([row], Coulomb(0.1), 10.0, output=Output(samples=2)))
    with pytest.raises(InputError, match=r"must be at most 0\.0409 for kahan-li-6"):
        choose(stiff, None, "kahan-li-6", 0.05)


@pytest.mark.parametrize(
    "settings",
    [{"springs": Springs(1e4), "drive": Free()}, {"drive": Pulled(stiffness=1e4, speed=0.1)}],
)
def test_stiff_springs(settings):
    """Steps that would be unstable are refused; with noise, the automatic step is short enough."""
    for temperature in (0.0, 0.1):
        with pytest.raises(InputError, match=r"^step: .* the stiffest spring"):
            choose(layout(temperature, **settings), None, "verlet", 0.1)
    stiff = layout(0.1, **settings)
    step = choose(stiff, None, None, None).step
    assert step == pytest.approx(longest_step(stiff, 0.1 / spring_frequency(stiff)))
    assert spring_frequency(stiff) >= np.sqrt(1e4 / stiff.asperites.mass[0])


def test_steep_corrugation():
    """With noise, the automatic step resolves a rigid tip, which has no frequency of its own."""
    tip = Surface("tip", asperite=Asperite(kappa=np.inf), langevin=Langevin(1.0, 0.1))
    field = Field(Corrugation(20.0, 0.01), on=["tip"])
    layout = lay_out(Scene([tip], [], 10.0, fields=[field]))
    frequency = 2.0 * np.pi / 0.01 * np.sqrt(20.0 / 3.0)
    step = choose(layout, None, None, None).step
    assert step == pytest.approx(longest_step(layout, 0.1 / frequency))


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
    assert choose(layout(0.1, **settings), None, None, None).step < 3e-3
    soft = choose(layout(0.1, drive=Custom(force=Trap(0.1, 0.0))), None, None, None)
    assert soft.step == choose(layout(0.1), None, None, None).step


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
    flat = layout()
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
