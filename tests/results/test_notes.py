"""Notes of a result on what its drives did, and on bobs that start in a core."""

import re
import warnings
from types import SimpleNamespace

import numpy as np
import pytest

import tribo
from tribo import Asperite, Coulomb, Forced, Free, Langevin, Output, Scene, Surface
from tribo.analysis import deep_core
from tribo.layout.layout import lay_out
from tribo.model.spectrum import Spectrum, valid_until
from tribo.results import notes as result_notes


def notes(lower_drive, velocity=(0.0, 0.0), count=2, **numerics):
    """The notes on a pass over a surface of one asperite or two, with a drive."""
    upper = Surface("upper", bob=(-3.0, 0.0), velocity=(0.5, 0.0))
    row = {"shape": (count, 1), "spacing": (9.0, 0.0)}  # the second one is out of the way
    lower = Surface("lower", facing="up", drive=lower_drive, velocity=velocity, **row)
    scene = Scene((upper, lower), Coulomb(0.2), 12.0)
    return tribo.simulate(scene, **numerics).notes


@pytest.mark.parametrize("numerics", [{"accuracy": 1e-6}, {"method": "rk4", "step": 0.03}])
def test_a_forced_surface_at_rest_that_receives_work_is_noted(numerics):
    """With an estimate of errors and with a given step."""
    (note,) = notes(Forced(), **numerics)
    assert note.startswith('the force that holds the centre of mass of "lower" also does work, 0.')
    assert note.endswith('because its bars move; with drive = "bars" it does none')


def test_an_interaction_without_a_pair_is_noted():
    """A scene from which a surface was left out."""
    alone = Scene((Surface("upper", velocity=(0.5, 0.0)),), Coulomb(0.2), 1.0)
    noted = tribo.simulate(alone, method="rk4", step=0.1).notes
    assert any('acts on nothing: "upper" is the only surface' in note for note in noted)
    row = Surface("row", shape=(2, 1), spacing=(1.0, 0.0))
    within = tribo.Interaction(Coulomb(0.2), between=("row", "row"))
    noted = tribo.simulate(Scene((row,), within, 1.0), method="rk4", step=0.1).notes
    assert not any("acts on nothing" in note for note in noted)


def test_a_single_encounter_has_no_note():
    """One asperite on one, as in the paper's cases: the works are the result."""
    assert notes(Forced(), count=1, accuracy=1e-6) == ()
    assert tribo.simulate(tribo.paper.scene("A")).notes == ()


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


def test_work_is_compared_with_that_of_other_drives(monkeypatch):
    """A note gives the work of the drive that holds a surface beside that of all other drives."""
    row = {"shape": (2, 1), "spacing": (1.0, 0.0)}
    surfaces = Surface("upper", velocity=(1.0, 0.0), **row), Surface("lower", facing="up", **row)
    works = {"upper": {"w2": np.array([[1.0]])}, "lower": {"w2": np.array([[-0.9]])}}
    ledger = SimpleNamespace(of=works.get)
    monkeypatch.setattr(result_notes, "assemble", lambda layout, samples: ledger)
    layout = lay_out(Scene(surfaces, tribo.Gaussian(0.1, 0.5), 1.0))
    (note,) = result_notes.drive_notes(layout, SimpleNamespace(ends=lambda: None))
    assert "-0.9 (other drives: 1)" in note


def pressed(gap, periodic=None, **settings):
    """Bobs above one another, or nearly so."""
    upper = Surface("upper", bob=(-1e-17, gap), **settings)
    lower = Surface("lower", facing="up", shape=(3, 1), spacing=(-2.0, 0.0), **settings)
    potential = tribo.LennardJones(0.5, 1.0).with_cutoff(2.5)
    return Scene((lower, upper), potential, 1.0, periodic=periodic or {})


def core_notes(scene):
    """What is said of starts in a core before a run."""
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        tribo.prepare(scene, method="rk4", step=1e-6)
    return tuple(str(each.message) for each in found if "core" in str(each.message))


def test_a_start_in_a_core_is_noted():
    """With the pair and its energy; not in front of the core, or with stiff springs."""
    (note,) = core_notes(pressed(0.5))
    assert note == (
        'the bobs of asperite 0 of "lower" and asperite 0 of "upper" start deep in a repulsive '
        "core: 0.5 apart, with an energy of 8.06e+03, 8e+03 times their other energies; start them "
        "farther apart, or from tribo.relax(scene)"
    )
    assert core_notes(pressed(0.5, {"x": 6.0})) == (note,), "a bob is at -1e-17 in a period"
    assert core_notes(pressed(0.8)) == () and core_notes(pressed(1.0)) == ()
    assert core_notes(pressed(0.5, asperite=Asperite(kappa=1e6))) == ()
    (note,) = core_notes(pressed(0.5, asperite=Asperite(kappa=float("inf"))))
    assert note.endswith("times their other energies; start them farther apart")


def test_a_start_in_a_core_is_warned_of():
    """By the call, and in the notes of its result."""
    upper = Surface("upper", bob=(0.0, 0.001))
    scene = Scene((upper, Surface("lower", facing="up", drive=Free())), Coulomb(0.2), 1e-5)
    with pytest.warns(tribo.TriboWarning, match="start deep in a repulsive core: 0.001 apart"):
        notes = tribo.simulate(scene, method="rk4", step=1e-6).notes
    assert "start deep in a repulsive core" in notes[0]


@pytest.mark.parametrize(("speed", "count"), [(0.1, 1), (3.0, 0)])
def test_kinetic_energy_counts_in_front_of_a_core(speed, count):
    """A fast asperite has more energy of its own, beside which that of a weak core is small."""
    soft = {"asperite": Asperite(kappa=0.1)}
    upper = Surface("upper", bob=(0.0, 0.4), velocity=(speed, 0.0), **soft)
    lower = Surface("lower", facing="up", **soft)
    scene = Scene((upper, lower), tribo.LennardJones(1e-3, 1.0), 1.0)
    assert len(deep_core.core_notes(lay_out(scene))) == count


def passing(method, step, times=None, samples=25, **settings):
    """A pass with given samples, by equal steps."""
    upper = Surface("upper", bob=(-3.0, 0.0), velocity=(0.5, 0.0), **settings)
    lower = Surface("lower", facing="up", drive=Free())
    output = Output(samples=samples) if times is None else Output(times=times)
    return tribo.simulate(
        Scene((upper, lower), Coulomb(0.2), 12.0, output=output), method=method, step=step
    )


@pytest.mark.parametrize("method", ["midpoint", "verlet"])
@pytest.mark.parametrize(("step", "taken"), [(5.0, 0.5), (0.6, 0.5), (0.3, 0.25), (0.26, 0.25)])
def test_steps_that_samples_shorten(method, step, taken):
    """A note has the step that is taken where it is more than 5 % shorter than the given one."""
    result = passing(method, step)
    exact = passing(method, taken)
    assert result.cost.steps == round(12.0 / taken)
    assert np.array_equal(result["upper"].w1, exact["upper"].w1)
    assert exact.notes == ()
    if taken > 0.95 * step:
        assert result.notes == ()
        return
    (note,) = result.notes
    rest = "fewer samples allow longer steps" if step > 0.5 else "a step that divides 0.5 is taken"
    assert note.startswith(f"steps are at most {taken:g} long in place of {step:g}: ")
    assert rest in note


def test_steps_between_unequal_samples():
    """The longest step counts: others are shorter where samples are closer together."""
    assert passing("midpoint", 0.25, (0.1, 5.0, 5.01, 12.0)).notes == ()
    times = (0.1, *(0.4 * np.arange(1, 30)))
    (note,) = passing("midpoint", 0.6, times).notes
    assert note.startswith("steps are at most 0.4 long in place of 0.6: ")
    assert passing("midpoint", 0.4, times).notes == ()


def test_automatic_steps_are_as_they_are_taken():
    """With noise and without a given step, no step is shorter than another."""
    reservoir = Langevin(0.1, temperature=0.1)
    assert passing(None, None, samples=1201, langevin=reservoir).notes == ()


def starting(**settings):
    """The notes on a start with settings of the upper surface."""
    upper = Surface("upper", **{"bob": (-3.0, 0.0)} | settings)
    surfaces = upper, Surface("lower", facing="up")
    scene = Scene(surfaces, Coulomb(0.2), 0.1, output=Output(samples=2))
    return tribo.prepare(scene, method="rk4", step=0.05).run().notes


@pytest.mark.parametrize(
    ("settings", "places"),
    [
        ({"shape": (3, 2)}, "6 asperites of .* are on 1 place,"),
        ({"shape": (3, 2), "spacing": (1.0, 0.0)}, "6 asperites of .* are on 3 places,"),
        ({"bob": (0.0, 0.0), "positions": [[-3.0, 0.0, 0.0]] * 2}, "2 asperites of .* on 1 place,"),
    ],
)
def test_asperites_on_one_place_are_noted(settings, places):
    """Without a spacing, or with equal positions."""
    (note,) = starting(**settings)
    assert re.search(places, note)


def test_angles_beyond_a_turn_are_noted():
    """They look like degrees; those of a surface that faces up are counted from pi."""
    (note,) = starting(initial=tribo.Initial(theta=30.0))
    assert "swing from rest of 30 rad" in note and "30 degrees would be 0.5236" in note
    assert starting(initial=tribo.Initial(theta=6.2)) == ()
    assert starting(shape=(3, 1), spacing=(1.0, 0.0)) == ()


def test_steps_along_z_are_noted_at_its_seam():
    """Heights that rise along z fall at the end of its period; along x they repeat."""
    nx, nz = 8, 6
    along_x = 0.1 * np.sin(2.0 * np.pi * np.arange(nx) / nx)
    heights = np.add.outer(np.linspace(0.0, 1.0, nz), along_x).ravel()
    grid = {"shape": (nx, nz), "spacing": (1.0, 3.0), "heights": heights}
    upper = Surface("upper", asperite=Asperite(kappa=np.inf), **grid)
    scene = Scene([upper], [], 1.0, periodic={"x": 8.0, "z": 18.0})
    seams = [note for note in result_notes.scene_notes(scene) if "repeats along" in note]
    assert len(seams) == 1 and "repeats along z" in seams[0]


def test_shorter_steps_that_keep_the_temperature():
    """The excess e falls with the square of the step: e / (1 + e) is to be 1 %, and a bit less."""
    (note,) = result_notes.excess_note(0.5, 0.1)
    expected = 0.9 * 0.1 * np.sqrt(0.01 * 3.0)
    assert f"steps of {expected:.2g} keep" in note


def test_a_bath_of_unequal_masses_lasts_as_with_the_lightest():
    """The lightest asperite of a surface tells how long its bath stands for a continuum."""
    spectrum = Spectrum("drude", 1.0, 2.0, 8)

    def notes_with(m1):
        rigid = Asperite(kappa=np.inf, m1=m1, m2=0.5)
        row = {"shape": (2, 1), "spacing": (1.0, 0.0), "drive": "free"}
        surface = Surface("s", asperite=rigid, bath=tribo.Bath(spectrum=spectrum), **row)
        return [*result_notes._on_baths(Scene([surface], [], 1e4))]

    assert valid_until(spectrum, 0.6, 0.0) != valid_until(spectrum, 9.5, 0.0)
    assert notes_with(np.array([0.1, 9.0])) == notes_with(0.1)
