"""Surfaces that pass through each other, part for good or never meet, and the time of contact."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

import tribo
from tribo import Asperite, Free, Output, Scene, Surface
from tribo.layout.layout import lay_out
from tribo.ledger.nearest import nearest
from tribo.ledger.separation import (
    _any_within,
    _by_trees,
    _part,
    contact_distance_of,
    nearest_images,
)

HEIGHT, LOAD, WIDTH = 0.6, 0.1, 0.2
CUTOFF, DURATION = 0.8, 20.0
RIGID = Asperite(kappa=np.inf)
SOFT = tribo.Gaussian(0.02, WIDTH).with_cutoff(CUTOFF)


class Killed(BaseException):
    """The process ends here."""


def fall(place=-5.0, load=LOAD, output=None, potential=SOFT):
    """A bar that its load presses down beside or onto a held one."""
    upper = Surface("upper", bob=(place, HEIGHT), drive=Free(load=load))
    lower = Surface("lower", facing="up", drive="bars")
    return Scene((upper, lower), potential, DURATION, output=output or Output(samples=401))


def passing_time(load=LOAD):
    """When a bar that falls freely is as low as the resting bob of the other."""
    each = Asperite()
    return np.sqrt(2.0 * (each.m1 + each.m2) * (HEIGHT + each.length) / load)


@pytest.mark.parametrize("numerics", [{"method": "verlet", "step": 0.01}, {"accuracy": 1e-6}])
def test_a_bar_that_falls_past_the_other_surface_ends_the_result(numerics):
    """At the first recorded time after that of free fall, with a given step and an accuracy."""
    with pytest.warns(tribo.TriboWarning, match="passed through each other"):
        result = tribo.simulate(fall(), **numerics)
    assert result.status == "PassedThrough"
    assert result.t[-2] < passing_time() <= result.t[-1]
    notes = " ".join(result.notes)
    assert '1 of 1 bars of "upper" passed through "lower"' in notes
    assert "1 of them are off its ends, at x = " in notes and 'a longer "lower"' in notes


def test_bars_that_fall_between_bobs_need_other_help():
    """A bar that falls into a gap of the other row is not off its ends."""
    row = {"shape": (2, 1), "spacing": (20.0, 0.0)}
    lower = Surface("lower", bob=(-10.0, 0.0), facing="up", drive="bars", **row)
    scene = fall(place=0.0)
    scene = replace(scene, surfaces=(scene.surfaces[0], lower))
    with pytest.warns(tribo.TriboWarning, match="passed through each other"):
        result = tribo.simulate(scene, method="verlet", step=0.01)
    notes = " ".join(result.notes)
    assert "stronger contact hold them" in notes and "off its ends" not in notes


def test_bobs_that_change_their_order_alone_have_not_passed():
    """A run that ends while the bar is above the bobs; and forced bars that start beyond them."""
    ends = fall(output=Output(samples=11))
    ends = tribo.Scene(ends.surfaces, SOFT, 0.95 * passing_time(), output=Output(samples=11))
    result = tribo.simulate(ends, method="verlet", step=0.01)
    assert result["upper"].y_bob[-1, 0] < -0.7  # below the other bob, at y = 0
    assert result.status == "completed"
    upper = Surface("upper", bob=(-1.0, -3.0), velocity=(0.5, 0.0))
    scene = Scene((upper, Surface("lower", facing="up")), SOFT, 4.0)
    assert tribo.simulate(scene, accuracy=1e-6).status == "completed"


def test_bodies_without_a_load_may_pass():
    """Two free bodies that attract each other orbit, and the energy budget closes."""
    rigid = tribo.Asperite(kappa=np.inf)
    free = {"asperite": rigid, "drive": Free(load=0.0)}
    upper = Surface("upper", bob=(0.0, 3.0), velocity=(0.298, 0.0), **free)
    scene = Scene((upper, Surface("lower", facing="up", **free)), tribo.Coulomb(-0.4), 64.0)
    result = tribo.simulate(scene, accuracy=1e-7)
    assert result.status == "completed"
    assert not any("passed through" in note for note in result.notes)
    below = result["upper"].y_bar[:, 0] < result["lower"].y_bob[:, 0]
    assert np.any(below) and not np.all(below)


def row_of_two(spring):
    """A bar over the other surface, which its contact holds, and one that falls beside it."""
    row = {"shape": (2, 1), "spacing": (5.0, 0.0), "springs": {"stiffness": spring}}
    upper = Surface("upper", bob=(0.0, HEIGHT), drive=Free(load=LOAD), asperite=RIGID, **row)
    lower = Surface("lower", facing="up", drive="bars", asperite=RIGID)
    core = tribo.WeeksChandlerAndersen(1.0, 0.5)
    return tribo.simulate(Scene((upper, lower), core, DURATION), method="verlet", step=0.01)


def test_half_of_the_bars_are_noted():
    """One of two passes, and the run is complete; stiff springs hold it."""
    result = row_of_two(0.0)
    assert result.status == "completed"
    assert result.notes[0].startswith('1 of 2 bars of "upper" passed through "lower" by t = 20')
    assert "passed" not in " ".join(row_of_two(100.0).notes)


def test_means_leave_out_members_and_points_that_pass():
    """Of members in lanes and of sweeps; the status is that of each."""
    scene, run = fall(output=Output(samples=41)), {"method": "verlet", "step": 0.02}
    loads = np.array([0.001, LOAD, 0.002, 2.0 * LOAD])
    passes = [passing_time(load) < DURATION for load in loads]
    wanted = np.where(passes, "PassedThrough", "completed")
    data = tribo.ensemble(scene, 4, {"upper.drive.load": loads}, keep=["upper.W"], **run)
    assert data.status.values.tolist() == wanted.tolist()
    assert np.isnan(data["upper.W"].values).tolist() == passes
    assert "2 of 4 members have no values (PassedThrough)" in data.attrs["notes"]
    swept = tribo.sweep(scene, {"upper.drive.load": loads}, keep=["upper.W"], **run)
    assert swept.status.values.tolist() == wanted.tolist()
    assert np.isnan(swept["upper.W"].values).tolist() == passes


def pass_over(gap, potential=SOFT, duration=DURATION, **settings):
    """Rigid bobs, of which one moves past the other at a distance."""
    upper = Surface("upper", bob=(-2.0, gap), velocity=(0.5, 0.0), asperite=RIGID)
    lower = Surface("lower", facing="up", asperite=RIGID)
    output = Output(samples=4001, series=["forces"], **settings)
    scene = Scene((upper, lower), potential, duration, output=output)
    return tribo.simulate(scene, method="verlet", step=duration / 4000)


def test_time_without_contact_of_a_pass():
    """The chord of the range over the speed; and that to which the energy has the stated size."""
    gap, speed = 0.5, 0.5
    chord = 2.0 * np.sqrt(CUTOFF**2 - gap**2) / speed
    result = pass_over(gap)
    for name in ("upper", "lower"):
        share = result.time_without_contact(name)
        assert share == pytest.approx(1.0 - chord / DURATION, abs=2.0 / 4000)
        assert result.end["time_without_contact"][name] == share
    assert "time without contact: upper 87.5 %" in str(result)
    assert result.time_without_contact("upper", after=10.0) == 1.0
    assert pass_over(CUTOFF + 0.01).time_without_contact("upper") == 1.0


@pytest.mark.parametrize("inner", [tribo.WeeksChandlerAndersen(0.1, 1.0), tribo.Coulomb(1e-6)])
def test_bobs_of_one_surface_that_act_on_one_another_are_no_contact(inner):
    """Each bob was in contact with itself, and an endless force within hid all contacts."""
    row = {"shape": (2, 1), "spacing": (6.0, 0.0)}
    upper = tribo.Surface("upper", bob=(0.0, 1.0), velocity=(1.0, 0.0), drive="bars", **row)
    lower = tribo.Surface("lower", facing="up", drive="bars")
    between = tribo.Interaction(tribo.WeeksChandlerAndersen(0.1, 1.0), between=("upper", "lower"))
    within = tribo.Interaction(inner, between=("upper", "upper"))
    output = tribo.Output(samples=10, series=("forces", "contacts"))

    def share(*interactions):
        scene = tribo.Scene([upper, lower], interactions, 9.0, output=output)
        result = tribo.simulate(scene, method="verlet", step=0.05)
        assert [*result["upper"].contact_number] == [1.0, *[0.0] * 9]
        assert not any('"upper" and "upper"' in note for note in result.notes)
        return [result.time_without_contact(name) for name in ("upper", "lower")]

    assert share(between, within) == share(between) == [pytest.approx(17 / 18)] * 2


def test_time_without_contact_of_an_endless_potential():
    """Contact is where the energy is 1 % of torsion by 1 rad; distances are 2 % apart."""
    gap, height, speed = 0.4, 0.01, 0.5
    soft = Asperite(kappa=0.05)
    upper = Surface("upper", bob=(-2.0, gap), velocity=(speed, 0.0), asperite=soft)
    lower = Surface("lower", facing="up", asperite=soft)
    output = Output(samples=4001, series=["forces"])
    scene = Scene((upper, lower), tribo.Gaussian(height, WIDTH), DURATION, output=output)
    radius = WIDTH * np.sqrt(2.0 * np.log(height / (0.01 * 0.5 * 0.05)))
    share = tribo.simulate(scene, method="verlet", step=0.05).time_without_contact("upper")
    chord = 2.0 * np.sqrt(radius**2 - gap**2) / speed
    # Less than half of the time: the bobs move little until they meet.
    assert 1.0 - share == pytest.approx(chord / DURATION, rel=0.06)


def test_contact_is_where_the_energy_exceeds_torsion_and_temperature():
    """A distance r at which A exp(-r / rho) = (kappa / 2 + T) / 100; distances are 2 % apart."""
    soft = Asperite(kappa=2.0)
    warm = tribo.Langevin(gamma=1.0, temperature=3.0)
    surface = Surface("a", asperite=soft, langevin=warm)
    other = Surface("b", facing="up", asperite=soft)
    scene = Scene([surface, other], tribo.BornMayer(5.0, 0.5), 1.0)
    expected = 0.5 * np.log(5.0 / (0.01 * (0.5 * 2.0 + 3.0)))
    assert contact_distance_of(scene, scene.surfaces[0]) == pytest.approx(expected, rel=0.021)


def test_contact_is_repulsion():
    """An attractive tail is no contact; a weak part of a sum leaves it to the other; by charges."""
    upper = Surface("upper", bob=(-12.0, 0.9), velocity=(1.0, 0.0), asperite=RIGID)
    lower = Surface("lower", facing="up", asperite=RIGID)
    output = Output(samples=2401, series=["forces"])
    how = {"method": "verlet", "step": 0.01}
    lennard_jones = tribo.LennardJones(0.3, 1.0)
    chord = 2.0 * np.sqrt(2.0 ** (1.0 / 3.0) - 0.9**2)
    for potential in (lennard_jones, lennard_jones.with_cutoff(2.5, "shift")):
        result = tribo.simulate(Scene((upper, lower), potential, 24.0, output=output), **how)
        share = result.time_without_contact("upper")
        assert share == pytest.approx(1.0 - chord / 24.0, abs=1e-3)
        assert result.end["contact_distance"]["upper"] == pytest.approx(2.0 ** (1.0 / 6.0))
        assert "in contact are bobs that repel each other, here closer than 1.122" in str(result)
    both = tribo.Coulomb(0.2) + tribo.LennardJones(1e-9, 0.5)
    soft = Asperite(kappa=2.0)
    for charge, share in ((1.0, 0.0), (-1.0, 1.0)):
        one = Surface("upper", bob=(-12.0, 2.0), velocity=(1.0, 0.0), asperite=soft)
        other = Surface("lower", facing="up", asperite=Asperite(kappa=2.0, charge=charge))
        scene = Scene((one, other), both, 24.0, output=output)
        assert tribo.simulate(scene, **how).time_without_contact("upper") == share


class Ended(tribo.Potential):
    """A repulsion whose formula has no real value beyond its range."""

    stiffness: float

    def energy(self, r):
        return self.stiffness * (1.2 - r) ** 1.5

    def range(self):
        return 1.2


@pytest.mark.thorough
@pytest.mark.filterwarnings("error")
def test_contact_within_a_range_of_ones_own():
    """Beyond its range a formula may give a complex number in Python: no contact, no warning."""
    upper = Surface("upper", bob=(-2.0, 0.9), velocity=(1.0, 0.0), asperite=RIGID)
    lower = Surface("lower", facing="up", asperite=RIGID)
    tail = tribo.LennardJones(1e-9, 1.0).with_cutoff(2.5)
    output = Output(samples=3, series=["forces"])
    for potential in (Ended(2.0), Ended(2.0) + tail):
        result = tribo.simulate(Scene((upper, lower), potential, 4.0, output=output), step=0.01)
        assert result.end["contact_distance"]["upper"] == pytest.approx(1.2)


def test_parting_and_not_meeting_are_noted():
    """Where a friction force is asked for; a slide over a periodic row is not parting."""
    (note,) = pass_over(0.5).notes
    assert note.startswith('"upper" and "lower" part for good: none of their bobs was in contact')
    last = float(note.partition("t = ")[2].partition(";")[0])
    leaves = (2.0 + np.sqrt(CUTOFF**2 - 0.25)) / 0.5
    assert last == pytest.approx(leaves, abs=DURATION / 255)
    (note,) = pass_over(CUTOFF + 0.01).notes
    assert note.startswith('at no recorded time was a bob of "upper" within the range of contact')
    upper = Surface("upper", bob=(-2.0, 0.5), velocity=(0.5, 0.0), asperite=RIGID)
    lower = Surface("lower", facing="up", asperite=RIGID)
    output = Output(samples=401, series=["forces"])
    again = Scene((upper, lower), SOFT, 100.0, periodic={"x": 8.0}, output=output)
    result = tribo.simulate(again, method="verlet", step=0.05)
    assert result.notes == ()
    chord = 2.0 * np.sqrt(CUTOFF**2 - 0.25)
    assert result.time_without_contact("upper") == pytest.approx(1.0 - chord / 8.0, abs=0.02)


@pytest.mark.parametrize("gap", [0.5, CUTOFF + 0.01])
def test_streamed_runs_are_noted_alike(gap, monkeypatch, tmp_path):
    """From portions of a few samples, also where a run that was stopped goes on."""
    monkeypatch.setattr("tribo.ledger.sinks.PORTION_BYTES", 20_000)
    held, streamed = pass_over(gap), pass_over(gap, keep=["upper.W", "upper.friction_force"])
    assert len(held.notes) == 1 and streamed.notes == held.notes
    monkeypatch.setattr("tribo.loops.frames.INTERVAL", -1.0)
    monkeypatch.setattr("tribo.loops.frames.RELATIVE_INTERVAL", 0.0)
    calls = []

    def stop(*arguments):
        calls.append(arguments)
        if len(calls) > 12:
            raise Killed

    how = {"method": "verlet", "step": DURATION / 4000, "out": tmp_path / "a.nc"}
    with pytest.raises(Killed):
        tribo.simulate(streamed.scene, **how, progress=stop)
    told = []
    resumed = tribo.simulate(streamed.scene, **how, resume=True, progress=lambda *a: told.append(a))
    assert told and resumed.notes == held.notes


def test_potentials_without_a_range_have_no_time_of_contact():
    """The paper's, whose surfaces pass and part without a note."""
    result = pass_over(0.5, tribo.Coulomb(0.2))
    assert result.notes == ()
    assert "time_without_contact" not in result["upper"]
    assert "time_without_contact" not in result.end
    with pytest.raises(tribo.InputError, match="has no range"):
        result.time_without_contact("upper")


def test_species_that_do_not_interact_are_not_in_contact():
    """The chord counts for bobs of two species of which the potential speaks, in any order."""
    surfaces = (
        Surface("upper", bob=(-2.0, 0.5), velocity=(0.5, 0.0), asperite=RIGID, species="A"),
        Surface(
            "lower",
            facing="up",
            shape=(2, 1),
            spacing=(3.0, 0.0),
            asperite=RIGID,
            species=("B", "C"),
        ),
    )
    output = Output(samples=2001, series=["forces"])
    shares = {}
    for species in (("A", "B"), ("C", "A")):
        contact = tribo.Interaction(SOFT, species=species)
        scene = Scene(surfaces, contact, DURATION, output=output)
        result = tribo.simulate(scene, method="verlet", step=0.05)
        without = result["upper"].time_without_contact
        shares[species] = float(result.t[np.argmin(without)])
    chord = np.sqrt(CUTOFF**2 - 0.25)
    assert shares["A", "B"] == pytest.approx((2.0 - chord) / 0.5, abs=0.02)
    assert shares["C", "A"] == pytest.approx((5.0 - chord) / 0.5, abs=0.02)


def test_ensembles_and_sweeps_show_the_time_without_contact():
    """Beside the average of the friction force, and surfaces that part in the notes."""
    scene = pass_over(0.5).scene
    heights = {"upper.velocity": stats.uniform(0.4, 0.1)}
    run = {"method": "verlet", "step": 0.05}
    data = tribo.ensemble(scene, 3, heights, keep=["upper.friction_force"], **run)
    chord = 2.0 * np.sqrt(CUTOFF**2 - 0.25) / data["upper.velocity"].values[:, 0]
    shares = data["upper.time_without_contact"].values
    assert shares == pytest.approx(1.0 - chord / DURATION, abs=1e-3)
    swept = tribo.sweep(scene, {"upper.velocity": [0.5]}, keep=["upper.friction_force"], **run)
    assert swept["upper.time_without_contact"].values == pytest.approx(0.875, abs=1e-3)
    assert "part for good" in swept.attrs["notes"]
    means = tribo.ensemble(scene, 3, heights, **run)
    assert any("in 3 of 3 members surfaces part" in n for n in json.loads(means.attrs["notes"]))


@pytest.mark.parametrize("period", [None, 12.0])
@pytest.mark.parametrize("speed", [0.002, 0.05, 2.0])
def test_contact_by_trees_is_that_of_all_pairs(period, speed):
    """Of bobs that move little, by their distance, or far between two times."""
    rng = np.random.default_rng(5)
    count, times = 40, 200
    path = np.cumsum(speed * rng.standard_normal((times, 1, 3)), axis=0)
    mine = path + 0.3 * speed * rng.standard_normal((times, count, 3))
    mine = mine + rng.uniform(0.0, 10.0, (count, 3)) * [1.0, 0.0, 0.0] + [0.0, 1.0, 0.0]
    theirs = np.broadcast_to(rng.uniform(0.0, 10.0, (count, 3)) * [1.0, 0.0, 0.0], mine.shape)
    row = tribo.Surface("row", shape=(count, 1), spacing=(0.1, 0.0))
    box = {} if period is None else {"x": period}
    contact = tribo.Coulomb(0.1).with_cutoff(1.0)
    layout = lay_out(tribo.Scene([row, replace(row, name="other")], contact, 1.0, periodic=box))
    between = nearest_images(layout, mine[:, :, None] - theirs[:, None])
    closest = np.linalg.norm(between, axis=-1).min(axis=(1, 2))
    some = 0
    for distance in np.quantile(closest, [0.1, 0.5, 0.9]):
        found = _any_within(layout, mine, theirs, distance)
        np.testing.assert_array_equal(found, closest < distance)
        some += found.sum()
    assert 0 < some < 3 * times


def test_surfaces_that_met_regularly_have_not_parted():
    """A time since the last contact that is as long as those between contacts is no parting."""
    assert not _part(np.linspace(0.0, 100.0, 101), np.arange(0.0, 85.0, 12.0))


def test_contact_of_surfaces_that_approach_is_found_by_trees():
    """Of bobs in space, from far apart to among one another, as by all pairs."""
    scene = Scene([Surface("a"), Surface("b", facing="up")], tribo.Hertz(1.0, 1.0), 1.0)
    rng = np.random.default_rng(0)
    mine = np.repeat(rng.uniform(0.0, 9.0, (1, 25, 3)), 40, axis=0)
    approach = np.linspace(30.0, 0.0, 40)[:, None, None] * [1.0, 0.0, 0.0]
    theirs = rng.uniform(0.0, 9.0, (1, 25, 3)) + approach
    closest = np.linalg.norm(mine[:, :, None] - theirs[:, None], axis=-1).min(axis=(1, 2))
    found = _by_trees(lay_out(scene), mine, theirs, 1.5)
    np.testing.assert_array_equal(found, closest < 1.5)
    assert found.any() and not found.all()


@pytest.mark.parametrize("period", [1.0, 0.0])
def test_the_nearest_bob_may_be_an_image(period):
    """Bobs at 0.9 and 0.1 of a period are 0.2 apart; without a period they are 0.8 apart."""
    box = np.array([period, 0.0, 0.0])
    (distance,), _ = nearest(np.array([[0.9, 0.0, 0.0]]), np.array([[0.1, 0.0, 0.0]]), box)
    assert distance == pytest.approx(0.2 if period else 0.8)
