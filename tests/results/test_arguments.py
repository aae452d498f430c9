"""Names of surfaces and times from which averages begin are checked alike everywhere."""

import pytest

import tribo
from tribo import Gaussian, Output, Scene, Surface


@pytest.fixture(scope="module")
def result():
    """A pulled surface on one at rest; all forces are recorded."""
    drive = tribo.Pulled(stiffness=1.0, speed=0.5)
    surfaces = [
        Surface("upper", bob=(-2.0, 0.3), drive=drive),
        Surface("lower", facing="up"),
    ]
    contact = Gaussian(0.1, 0.5).with_cutoff(1.5)
    output = Output(samples=51, series=("forces",))
    scene = Scene(surfaces, contact, 5.0, output=output)
    return tribo.simulate(scene, method="verlet", step=0.01)


OF_A_SURFACE = {
    "friction_force": lambda result, name: result.friction_force(name),
    "friction_force of a field": lambda result, name: result.friction_force(name, part="field"),
    "friction_coefficient": lambda result, name: result.friction_coefficient(name),
    "pull_force": lambda result, name: result.pull_force(name),
    "time_without_contact": lambda result, name: result.time_without_contact(name),
    "depinning": lambda result, name: result.depinning(name),
    "contacts": lambda result, name: result.contacts(name),
    "friction_map": lambda result, name: result.friction_map(name),
    "loop": lambda result, name: result.loop(name),
    "slips": lambda result, name: result.slips(name),
    "force_distance": lambda result, name: result.force_distance(name),
    "oscillators": lambda result, name: result.oscillators(name),
    "animate": lambda result, name: result.animate("film.gif", frames=2, surface=name),
    "plot.work": lambda result, name: result.plot.work(name),
    "plot.friction_force": lambda result, name: result.plot.friction_force(name),
    "plot.loop": lambda result, name: result.plot.loop(name),
    "plot.friction_map": lambda result, name: result.plot.friction_map(name),
    "plot.contacts": lambda result, name: result.plot.contacts(name),
    "plot.map": lambda result, name: result.plot.map("w1", name),
    "plot.sequence": lambda result, name: result.plot.sequence(surface=name),
    "plot.snapshots": lambda result, name: result.plot.snapshots(forces=(name, 0)),
}


@pytest.mark.parametrize("evaluation", OF_A_SURFACE)
@pytest.mark.parametrize("name", ["nope", ""], ids=repr)
def test_an_unknown_surface(result, evaluation, name, tmp_path, monkeypatch):
    """The message has the names of those that exist; nothing is written."""
    monkeypatch.chdir(tmp_path)
    with pytest.raises(tribo.InputError, match=r"must be one of upper, lower, got '(nope)?'"):
        OF_A_SURFACE[evaluation](result, name)
    assert not list(tmp_path.iterdir())
