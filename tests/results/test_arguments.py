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


FROM_A_TIME = {
    "time_without_contact": lambda result, after: result.time_without_contact("upper", after),
    "loop": lambda result, after: result.loop("upper", after),
    "slips": lambda result, after: result.slips("upper", after=after),
    "force_distance": lambda result, after: result.force_distance("upper", after),
}
FROM_A_TIME_OR_AUTO = {
    "friction_force": lambda result, after: result.friction_force("upper", after),
    "friction_coefficient": lambda result, after: result.friction_coefficient("upper", after),
    "pull_force": lambda result, after: result.pull_force("upper", after),
    "friction_map": lambda result, after: result.friction_map("upper", after),
    "velocity_profile": lambda result, after: result.velocity_profile(after),
    "plot.friction_force": lambda result, after: result.plot.friction_force("upper", after),
}
WRONG_TIMES = {
    5.0: "must be before the end of the run, t = 5, got 5",
    7.0: "must be before the end of the run, t = 5, got 7",
    float("nan"): "must be a finite number",
    float("inf"): "must be a finite number",
    True: "must be a number",
    (1.0, 2.0): "must be a number",
    "late": "must be a",
}


@pytest.mark.parametrize("evaluation", [*FROM_A_TIME, *FROM_A_TIME_OR_AUTO])
@pytest.mark.parametrize("after", WRONG_TIMES, ids=repr)
def test_a_wrong_beginning_of_an_average(result, evaluation, after):
    """The message names `after`, and not a consequence of it."""
    evaluate = (FROM_A_TIME | FROM_A_TIME_OR_AUTO)[evaluation]
    with pytest.raises(tribo.InputError, match=f"^after: {WRONG_TIMES[after]}"):
        evaluate(result, after)


@pytest.mark.parametrize("evaluation", FROM_A_TIME)
def test_no_automatic_run_in_of_what_is_no_average(result, evaluation):
    """Loops, slips, curves and shares of time begin at a time that is given."""
    with pytest.raises(tribo.InputError, match=r"^after: must be a number \[time\], got 'auto'"):
        FROM_A_TIME[evaluation](result, "auto")


@pytest.mark.parametrize("evaluation", ["friction_force", "pull_force", "velocity_profile"])
def test_averages_begin_at_the_end_of_the_run_in(result, evaluation):
    """ "auto" and every time before the end are valid."""
    for after in (None, "auto", 0, 0.0, 4.5):
        FROM_A_TIME_OR_AUTO[evaluation](result, after)
