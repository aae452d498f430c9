"""Notes of a result on what its drives did."""

import pytest

import tribo
from tribo import Asperite, Coulomb, Forced, Free, Scene, Surface


def notes(lower_drive, velocity=(0.0, 0.0), **numerics):
    """The notes on a pass over a surface with a drive."""
    upper = Surface("upper", bob=(-3.0, 0.0), velocity=(0.5, 0.0))
    lower = Surface("lower", facing="up", drive=lower_drive, velocity=velocity)
    scene = Scene((upper, lower), Coulomb(0.2), 12.0)
    return tribo.simulate(scene, **numerics).notes


@pytest.mark.parametrize("numerics", [{"accuracy": 1e-6}, {"method": "rk4", "step": 0.05}])
def test_a_forced_surface_at_rest_that_receives_work_is_noted(numerics):
    """With an estimate of errors and with a given step."""
    (note,) = notes(Forced(), **numerics)
    assert note.startswith('"lower" is forced and at rest, but its bars swing')
    assert note.endswith('drive = "bars" holds bars without work')


@pytest.mark.parametrize(
    ("drive", "velocity"), [(Free(), (0.0, 0.0)), (Forced(), (-0.125, 0.0)), (Forced(), (0.0, 0.1))]
)
def test_other_surfaces_are_not_noted(drive, velocity):
    """A free one, and one that moves."""
    assert notes(drive, velocity, accuracy=1e-6) == ()


def test_little_work_is_not_noted():
    """A stiff pendulum at rest hardly swings."""
    upper = Surface("upper", bob=(-3.0, 0.0), velocity=(0.5, 0.0))
    lower = Surface("lower", facing="up", asperite=Asperite(kappa=100.0))
    assert tribo.simulate(Scene((upper, lower), Coulomb(0.2), 12.0)).notes == ()
