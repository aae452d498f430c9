"""Averages of friction and pull: fields and contact, parts, members, files, and what is printed."""

import json
from dataclasses import replace

import numpy as np
import pytest

import tribo
from support.command import main
from support.transformations import boosted
from tribo.ledger.ledger import Ledger, known
from tribo.results import report
from tribo.results.averages import Average, mean_text
from tribo.results.force_averages import _sampling_note

HOW = {"method": "verlet", "step": 0.02}
GAMMA = 1.0
SPEED = 0.05
DURATION = 450.0


def tip(temperature=0.0, gamma=GAMMA, **output):
    """A tip that is pulled over a corrugation, in stick and slip, with a reservoir on its bar."""
    langevin = tribo.Langevin(gamma=gamma, temperature=temperature)
    drive = tribo.Pulled(stiffness=5.0, speed=SPEED)
    surface = tribo.Surface(
        "tip", asperite=tribo.Asperite(kappa=np.inf), drive=drive, langevin=langevin
    )
    field = tribo.Field(tribo.Corrugation(amplitude=0.3, period=1.0), on=["tip"])
    output = tribo.Output(**({"samples": 2001, "series": ("forces",), "run_in": 50.0} | output))
    return tribo.Scene([surface], [], DURATION, fields=[field], output=output, seed=3)


@pytest.fixture(scope="module")
def result():
    """The run at rest of temperature."""
    return tribo.simulate(tip(), **HOW)


def test_a_tip_on_a_corrugation_has_friction(result):
    """Friction, pull and drag balance; their works are friction times distance."""
    friction = result.friction_force("tip")
    pull = result.pull_force("tip")
    drag = -GAMMA * SPEED
    assert -2.0 < friction.mean < -0.5 < 0.0 < friction.half_width < 0.1
    assert 0.0 < pull.half_width < 0.1
    gap = friction.mean + pull.mean + drag
    assert abs(gap) < friction.half_width + pull.half_width
    assert result.friction_force("tip", part="field") == friction
    contact = result.friction_force("tip", part="contact")
    assert contact.mean == contact.spread == contact.half_width == 0.0
    # The stage does the work of the pull at its own speed.
    later = result.t >= 50.0
    spring = SPEED * result.t + result["tip"].x_bar[0, 0] - result["tip"].x_bar[:, 0]
    assert pull.mean == pytest.approx(5.0 * np.mean(spring[later]), rel=0.02)
    with pytest.raises(tribo.InputError, match='must be "contact": no field acts on "upper"'):
        sliding(tribo.Forced()).friction_force("upper", part="field")


@pytest.mark.parametrize("temperature", [0.0, 0.02])
def test_it_is_the_same_in_files_members_and_sweeps(temperature, tmp_path, capsys, monkeypatch):
    """Also in portions, with sums of works alone, and from the command line."""
    scene = tip(temperature)
    result = tribo.simulate(scene, **HOW)
    friction = result.friction_force("tip")
    pull = result.pull_force("tip")
    assert friction.mean < -0.3 and pull.mean > 0.3
    result.save(tmp_path / "tip.nc")
    loaded = tribo.load_result(tmp_path / "tip.nc")
    assert (loaded.friction_force("tip"), loaded.pull_force("tip")) == (friction, pull)
    keep = ["tip.friction_force", "tip.pull_force", "tip.field_force"]
    members = tribo.ensemble(scene, 2, {"tip.vx": np.zeros((2, 1))}, keep=keep, **HOW)
    points = tribo.sweep(scene, {"tip.vx": [0.0]}, keep=keep, **HOW)
    for data in (members, points) if temperature == 0.0 else ():
        for name, average in zip(keep, (friction, pull, friction), strict=True):
            assert data[name].values[0] == average.mean
            assert data[f"{name}_time_half_width"].values[0] == average.half_width
    assert np.all(np.isfinite(members["tip.pull_force_time_half_width"]))
    monkeypatch.setattr("tribo.ledger.sinks.SERIES_BYTES", 10_000)
    monkeypatch.setattr("tribo.ledger.sinks.PORTION_BYTES", 5_000)
    kept = tribo.simulate(tip(temperature, keep=keep), **HOW)
    if temperature == 0.0:
        kept = [kept, tribo.simulate(tip(ledger="surfaces"), **HOW)]
        path = tmp_path / "tip.toml"
        replace(scene, numerics=tribo.Numerics(**HOW)).save(path)
        assert main(["run", str(path), "--json"]) == 0
        end = json.loads(capsys.readouterr().out)
        assert end["friction_force"]["tip"]["mean"] == friction.mean
        assert end["pull_force"]["tip"] == pull._asdict()
    for other in np.atleast_1d(kept):
        assert (other.friction_force("tip"), other.pull_force("tip")) == (friction, pull)


def test_work_of_the_stage_and_energy_of_its_springs(result):
    """The stage's work is the impulse times its speed; it heats, and loads the springs."""
    table = result["tip"]
    t = result.t
    spring = SPEED * t + table.x_bar[0, 0] - table.x_bar[:, 0]
    assert table.e_pull == pytest.approx(0.5 * 5.0 * spring**2, abs=1e-12)
    assert table.pull_force == pytest.approx(5.0 * spring, abs=1e-12)
    pulls = 0.5 * (table.pull_force[1:] + table.pull_force[:-1]) * np.diff(t)
    work = SPEED * np.append(0.0, np.cumsum(pulls))
    assert table.stage_work == pytest.approx(work, abs=2e-3 * work[-1])
    # The springs do the rest of the work on the bars, as on the way of any closed system.
    assert table.stage_work - table.e_pull == pytest.approx(table.w2[:, 0], abs=1e-4 * work[-1])
    energies = result.system["total_energy_change"] + table.heat[:, 0] + table.e_pull
    assert table.stage_work == pytest.approx(energies, abs=1e-3 * work[-1])
    stick = int(np.argmax(table.e_pull))
    assert table.e_pull[stick] > 0.01 * table.stage_work[stick]
    ax = result.plot.energy_budget()
    lines = {line.get_label(): line.get_ydata() for line in ax.get_lines()}
    top = lines["pulling springs"] - lines["heat"]
    assert top == pytest.approx(table.e_pull - table.e_pull[0], abs=1e-12)
    assert lines["work put in"] == pytest.approx(table.stage_work, abs=1e-3 * work[-1])


def held(temperature=0.02):
    """A pendulum on a driven bar over a corrugation; the swing has a reservoir, f2 its noise."""
    langevin = tribo.Langevin(gamma=0.5, temperature=temperature, on="swing")
    surface = tribo.Surface("tip", velocity=(0.2, 0.0), drive="bars", langevin=langevin)
    field = tribo.Field(tribo.Corrugation(amplitude=0.3, period=1.0), on=["tip"])
    output = tribo.Output(samples=301, series=("forces",), run_in=10.0)
    return tribo.Scene([surface], [], 60.0, fields=[field], output=output, seed=3)


def test_friction_and_pull_have_one_window(result):
    """Both means are integrals over the same time, of the samples or of means over intervals."""
    noisy = tribo.simulate(held(), **HOW)
    for each, begin in ((result, 50.0), (noisy, 10.0)):
        friction = each.friction_force("tip")
        pull = each.pull_force("tip")
        t = each.t
        series = each["tip"]
        first = int(np.searchsorted(t, begin))
        assert friction.after == pull.after == t[first]
        length = t[-1] - t[first]
        mean = np.trapezoid(series.friction_force[first:], t[first:]) / length
        assert friction.mean == pytest.approx(mean, rel=1e-11)
        pulls = series.pull_force
        if each is noisy:
            assert np.isnan(pulls[0])
            mean = np.sum((pulls[1:] * np.diff(t))[first:]) / length
            # The impulse of f2 at the velocity of the bars is its work.
            assert 0.2 * length * mean == pytest.approx(series.w2[-1, 0] - series.w2[first, 0])
        else:
            mean = np.trapezoid(pulls[first:], t[first:]) / length
        assert pull.mean == pytest.approx(mean, rel=1e-11)


def test_heat_of_a_reservoir_on_the_swing_alone():
    """It is all heat."""
    table = tribo.simulate(held(), **HOW)["tip"]
    assert np.ptp(table.heat_swing) > 0.0
    assert np.array_equal(table.heat_swing, table.heat)


def test_what_a_scene_does_not_report_is_refused_at_once(monkeypatch):
    """Ensembles and sweeps refuse it before anything is compiled."""

    def compiled(*arguments, **settings):
        raise AssertionError("compiled")

    monkeypatch.setattr("tribo.simulation.Integrator", compiled)
    scene = tip(0.02)
    keep = ["tip.heat_swing"]
    for refused in (
        lambda: tribo.ensemble(scene, 2, keep=keep, **HOW),
        lambda: tribo.sweep(scene, {"tip.vx": [0.0]}, keep=keep, **HOW),
        lambda: tribo.ensemble(scene, 2, half_width={"tip.heat_swing": 1.0}, **HOW),
        lambda: tribo.simulate(replace(scene, output=tribo.Output(keep=keep)), **HOW),
    ):
        with pytest.raises(tribo.InputError, match="heat_swing"):
            refused()


def test_averages_of_a_stopped_run_end_together(result):
    """At the last time at which all forces are finite; too late a beginning names the stop."""
    series = dict(result.ledger.blocks["tip"])
    series["friction_force"] = np.append(series["friction_force"][:-1], np.inf)
    whole = result.ledger
    ledger = Ledger(whole.t, whole.surfaces, {"tip": known(series)}, whole.system)
    stopped = replace(result, status="NotFinite", assemble=lambda: ledger)
    friction = stopped.friction_force("tip")
    pull = stopped.pull_force("tip")
    t = result.t
    pulls = result["tip"].pull_force
    first = int(np.searchsorted(result.t, 50.0))
    mean = np.trapezoid(pulls[first:-1], t[first:-1]) / (t[-2] - t[first])
    assert friction.after == pull.after and pull.mean == pytest.approx(mean, rel=1e-12, abs=0.0)
    for average in (stopped.friction_force, stopped.pull_force):
        with pytest.raises(tribo.InputError, match="the run stopped at t = 450, NotFinite"):
            average("tip", after=460.0)


def sliding(drive, **settings):
    """One asperite over another: the loop for a pair, or the general one."""
    upper = tribo.Surface("upper", bob=(-3.0, 0.0), velocity=(0.5, 0.0), drive=drive)
    lower = tribo.Surface("lower", facing="up", drive=drive)
    output = tribo.Output(samples=301, series=("forces",), **settings)
    return tribo.simulate(
        tribo.Scene([upper, lower], tribo.Gaussian(0.2, 0.5), 12.0, output=output),
        method="gauss-radau-15",
        accuracy=1e-9,
    )


@pytest.mark.parametrize("ledger", ["asperites", "none"])
@pytest.mark.parametrize("drive", [tribo.Forced(), tribo.DrivenBars()])
def test_the_pull_of_forced_surfaces_and_driven_bars(drive, ledger):
    """A forced drive cancels the contact; the reaction of bars is that less the bob's momentum."""
    result = sliding(drive, ledger=ledger)
    upper = result["upper"]
    friction = result.friction_force("upper")
    pull = result.pull_force("upper")
    momentum = np.trapezoid(upper.friction_force + upper.pull_force, result.t)
    change = result.scene.surfaces[0].each["mass"][0] * (upper.vx_cm[-1, 0] - upper.vx_cm[0, 0])
    assert momentum == pytest.approx(change, abs=2e-4)
    assert friction.mean == pytest.approx(result["upper"].f1_x.mean(), rel=0.05)
    if isinstance(drive, tribo.Forced):
        assert pull.mean == pytest.approx(-friction.mean, rel=1e-9)
    # One passage: no mean friction force in the summary.
    assert "friction" not in str(result) and "friction" not in result._repr_html_()


def test_the_summary_prints_friction_heat_and_budget(result):
    """As text and as HTML, with the pull, per asperite and per load where there is one."""
    friction = result.friction_force("tip")
    text = str(result)
    pull = result.pull_force("tip")
    shown = mean_text(friction.mean, friction.half_width)
    assert f"friction force {shown} from t = 50.175 on" in text
    assert f"drive's force {mean_text(pull.mean, pull.half_width)} from" in text
    assert f"heat {result['tip'].heat[-1, 0]:.6g} to the reservoir" in text
    work = result.system["applied_work"][-1]
    drag = np.sum(result["tip"].w_T[-1])
    pulled = np.sum(result["tip"].w2[-1]) + 0.0
    assert f"energy: work applied {work:.6g} ({drag:.6g} by reservoirs, {pulled:.6g} by all" in text
    assert "friction force" in result._repr_html_() and "energy: work" in result._repr_html_()
    drawn = [ax.get_ylabel() for ax in result.plot.overview().axes]
    assert "friction force on tip" in drawn
    plain = tribo.simulate(tip(series=()), **HOW)
    assert 'friction force: not recorded; series = ["forces"] under [output]' in str(plain)


def test_the_summary_divides_by_asperites_and_loads(result):
    """Friction per asperite, and as a part of the load on all of them."""
    drive = tribo.Pulled(load=0.5)
    upper = tribo.Surface("upper", drive=drive, shape=(4, 1), spacing=(1.0, 0.0))
    average = result.friction_force("tip")._replace(mean=-0.8)
    text = report.in_words(average, upper, True)
    assert text.startswith(mean_text(-0.8, average.half_width) + " from") and " +- " in text
    assert text.endswith(", -0.2 per asperite, 0.4 of the load")
    alone = report.in_words(result.pull_force("tip"), result.scene.surfaces[0], False)
    assert "per asperite" not in alone and "load" not in alone


def test_a_large_drag_is_noted():
    """Where the reservoir resists with more than a tenth of the pull."""
    assert "drag" not in tribo.simulate(tip(), **HOW).pull_force("tip").note
    result = tribo.simulate(tip(gamma=8.0), **HOW)
    drag = "the reservoir's drag on the bars, -0.39, is more than a tenth of it"
    assert result.pull_force("tip").note.endswith(drag) and drag in str(result)
    assert drag in json.loads(result.to_json())["pull_force"]["tip"]["note"]


def test_the_drag_is_that_of_any_observer():
    """An observer who moves sees the reservoir move, too, and the same drag on the bars."""
    scene = replace(tip(gamma=8.0, samples=501, run_in=0.0), duration=100.0)
    known, found = (
        tribo.simulate(each, **HOW).pull_force("tip").note
        for each in (scene, boosted(scene, (0.5, 0.0)))
    )
    assert "drag" in known and found == known


def test_the_average_of_a_stopped_run_says_so(result):
    """Its status and its time are in the note."""
    stopped = replace(result)
    stopped.status = "EncounterJumped"
    for average in (stopped.friction_force("tip"), stopped.pull_force("tip")):
        assert average.note.startswith("the run stopped at t = 450, EncounterJumped")
    assert "the run stopped at t = 450, EncounterJumped" in str(stopped)


@pytest.mark.parametrize(("samples", "missed"), [(41, True), (1281, False)])
def test_samples_at_one_phase_are_noted(samples, missed):
    """An asperite meets another one every 3 time units, as often as its force is recorded."""
    row = {"shape": (12, 1), "spacing": (1.5, 0.0)}
    rigid = {"asperite": {"kappa": np.inf}}
    upper = tribo.Surface("upper", bob=(0.3, 0.8), velocity=(0.5, 0.0), **rigid)
    lower = tribo.Surface("lower", facing="up", **row, **rigid)
    output = tribo.Output(samples=samples, series=["forces"])
    contact = tribo.Morse(0.1, 1.0, 0.8).with_cutoff(2.5)
    scene = tribo.Scene((upper, lower), contact, 120.0, periodic={"x": 18.0}, output=output)
    result = tribo.simulate(scene, accuracy=1e-8)
    average = result.friction_force("upper")
    assert (abs(average.mean) > 1e-3) == missed  # of whole periods it is 0
    assert ("samples miss a part of the motion" in average.note) == missed
    assert ("samples miss a part of the motion" in str(result)) == missed
    with_field = replace(scene, fields=(tribo.Field(tribo.Corrugation(0.1, 1.0), on=("upper",)),))
    noted = tribo.simulate(with_field, accuracy=1e-8).friction_force("upper").note
    assert "samples miss" not in noted  # whose impulse the work does not have


def test_surfaces_longer_than_the_period_are_noted():
    """Their asperites stand among images of one another."""
    row = {"shape": (12, 1), "spacing": (1.5, 0.0)}
    surfaces = tribo.Surface("upper", bob=(0.3, 1.2), **row), tribo.Surface("lower", facing="up")
    contact = tribo.Morse(0.1, 1.0, 0.8).with_cutoff(2.5)
    for period, fit in ((18.0, 12), (16.5, 11), (9.0, 6)):
        scene = tribo.Scene(surfaces, contact, 0.1, periodic={"x": period})
        notes = " ".join(tribo.simulate(scene, method="verlet", step=0.05).notes)
        assert (f"{fit} fit in it" in notes) == (fit < 12)


def test_notes_of_a_coefficient_quote_coefficients():
    """Not forces: of incomplete periods, and of samples that see one phase of a motion."""
    rigid = tribo.Asperite(kappa=np.inf)
    pull = tribo.Pulled(stiffness=0.5, speed=0.1, load=2.0)
    langevin = tribo.Langevin(2.0)
    tip = tribo.Surface("tip", drive=pull, langevin=langevin, asperite=rigid)
    bobs = {"shape": (60, 1), "bob": (-1.0, -1.5), "spacing": (0.5, 0.0)}
    wall = tribo.Surface("wall", facing="up", drive="bars", asperite=rigid, **bobs)
    field = tribo.Field(tribo.Corrugation(0.1, 1.0), on=["tip"])
    output = tribo.Output(samples=1151, series=["forces"])
    scene = tribo.Scene(
        [tip, wall], tribo.BornMayer(5.0, 0.3), 115.0, fields=[field], output=output
    )
    result = tribo.simulate(scene, accuracy=1e-6)
    force = result.friction_force("tip", after=13.0)
    found = result.friction_coefficient("tip", after=13.0)
    assert found.mean == pytest.approx(-0.5 * force.mean) and found.mean > 0.0
    assert found.weighted_mean == pytest.approx(-0.5 * force.weighted_mean)
    shown = mean_text(force.weighted_mean, force.weighted_half_width)
    assert f"it is {shown}" in force.note
    shown = mean_text(found.weighted_mean, found.weighted_half_width)
    assert f"it is {shown}" in found.note


class Sliding(dict):
    """What the note on samples uses of a result: times, speeds and works."""

    t = np.linspace(0.0, 10.0, 101)
    scene = tribo.Scene([tribo.Surface("upper", velocity=(0.5, 0.0))], [], 10.0)


def test_samples_of_a_coefficient_are_compared_with_its_work():
    """The work of a friction force of -0.8 agrees with a coefficient of 2 at a load of 0.4."""
    result = Sliding(upper={"friction_work": 0.5 * 0.8 * Sliding.t})
    for mean, noted in ((2.0, False), (1.0, True)):
        found = Average(mean, 0.01, 0.1, 0.1, 50.0, 0.0)
        note = _sampling_note(result, "upper", found, 10.0, -0.4)
        assert ("samples miss a part of the motion" in note) == noted
