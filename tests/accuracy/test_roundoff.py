"""The rounding of differences of large terms is part of every bar."""

import itertools
import json
from dataclasses import replace

import mpmath
import numpy as np
import pytest

import tribo
from support.reference import compiler, solve
from support.scene_tables import scene_from
from support.verdicts import compared
from support.wide_scenes import wide_scene
from tribo import Asperite, Coulomb, Initial, Output, Scene, Surface
from tribo.accuracy import roundoff
from tribo.layout.layout import lay_out
from tribo.ledger.motion import Motion
from tribo.ledger.samples import Samples

# What a note says of works without a digit that is known.
LOST = "below the rounding of the energies"
EPSILON = np.finfo(float).eps


def works_of_ends(kappa, swing, times):
    """wL of a pendulum that nothing disturbs, to 40 digits.

    The force on the left end is kappa q / bar_length along y; the end moves at -l2 sin(q) dq/dt.
    """
    with mpmath.workdps(40):
        rate = mpmath.sqrt(mpmath.mpf(kappa) / (mpmath.mpf(2) / 3 * 4))
        angles = [mpmath.mpf(swing) * mpmath.cos(rate * t) for t in map(mpmath.mpf, times)]
        arcs = [mpmath.sin(q) - q * mpmath.cos(q) for q in angles]
        return [-mpmath.mpf(kappa) / 3 * mpmath.mpf(2) / 3 * (arc - arcs[0]) for arc in arcs]


@pytest.mark.filterwarnings("ignore::tribo.TriboWarning")  # the smallest changes have few digits
@pytest.mark.parametrize("method", [None, "dop853"])
@pytest.mark.parametrize("kappa", [1e-4, 1e-8, 1e-12])
def test_works_of_ends_that_hardly_turn(method, kappa):
    """The twist is far larger than its change, and so are the terms of a work than the work."""
    asperite, start = Asperite(kappa=kappa), Initial(swing=1.0)
    upper = Surface("upper", bob=(-3.0, 0.5), velocity=(0.5, 0.0), asperite=asperite, initial=start)
    lower = Surface("lower", facing="up", asperite=asperite)
    scene = Scene((upper, lower), Coulomb(1e-40), 12.0, output=Output(samples=9))
    result = tribo.simulate(scene, accuracy=1e-8, method=method)
    for name, sign in (("wL", 1), ("wR", -1)):
        exact = works_of_ends(kappa, 1.0, result.t)
        found = result["upper"][name][:, 0]
        error = max(abs(mpmath.mpf(float(x)) - sign * e) for x, e in zip(found, exact, strict=True))
        bar = result.error_estimate[name]
        assert error <= bar
        assert bar <= 1e-7 * np.max(np.abs(found)) + 1e-14 * kappa


def test_works_of_a_clamp_that_has_turned_often():
    """sin x - x cos x of a twist of 30 rad: a rounding of x changes it by 30 sin 30 roundings.

    The twist itself has 30 roundings.
    """
    layout = lay_out(Scene([Surface("s", initial=Initial(theta=30.0))], [], 1.0))
    samples = Samples.at_zero(layout)
    samples.y[0, 0] = 30.0
    count = 1e-10
    found = roundoff._of_ends(layout, Motion(layout, layout.together, samples), count)["wL"]
    a = layout.together.asperites
    lever = (a.kappa / a.bar_length * a.l2)[0]
    assert found == pytest.approx(lever * count * 30.0**2 * abs(np.sin(30.0)), rel=1e-3)


@pytest.mark.filterwarnings("ignore::tribo.TriboWarning")
def test_places_of_ends_of_arms_that_have_turned_often():
    """An angle of many turns has few digits behind the point, and so have sine and cosine."""
    turns, rate, times = 6164.054919666023, 0.7, np.linspace(0.0, 3.0, 7)
    upper = Surface("upper", asperite=Asperite(kappa=0.0), initial=Initial(swing=turns, omega=rate))
    scene = Scene([upper], [], 3.0, output=Output(samples=7))
    result = tribo.simulate(scene, method="gauss-radau-15", accuracy=1e-8)
    with mpmath.workdps(40):
        swings = [mpmath.mpf(turns) + mpmath.mpf(rate) * mpmath.mpf(t) for t in times]
        for arm, name in ((4 / mpmath.mpf(3), "bob"), (-2 / mpmath.mpf(3), "bar")):
            found = result["upper"][f"x_{name}"][:, 0]
            errors = [abs(x - arm * mpmath.sin(q)) for x, q in zip(found, swings, strict=True)]
            assert 1e-14 < max(errors) <= result.error_estimate[f"x_{name}"] < 1e-10


@pytest.mark.filterwarnings("ignore::tribo.TriboWarning")
def test_oscillators_that_start_a_rounding_from_their_bars():
    """All rests, but for contact of 1e-40 and the rounding of places, the same in all runs."""
    result = tribo.simulate(scene_from(wide_scene(1000779)))
    assert result.status == "completed"
    moved = np.max(np.abs(result["upper"].omega))
    assert 1e-35 < moved <= result.error_estimate["omega"] < 1e-15


def equal_pendulums():
    """Two on a spring that swing alike, but for a contact that is weaker than their rounding."""
    lower = {"name": "lower", "facing": "up", "shape": [2, 1], "drive": {"kind": "forced"}}
    lower |= {"spacing": [1.1, 0.0]}
    lower |= {"initial": {"swing": 0.3, "omega": 0.2}, "springs": {"stiffness": 0.7}}
    upper = {"name": "upper", "facing": "down", "bob": [-1.5, 0.5], "drive": {"kind": "forced"}}
    return {
        "surface": [upper, lower],
        "interaction": [{"potential": "coulomb", "strength": 1e-25}],
        "output": {"samples": 5},
        "numerics": {"accuracy": 1e-3, "method": "rk4"},
        "duration": 4.0,
    }


@pytest.mark.filterwarnings("ignore::tribo.TriboWarning")
@pytest.mark.skipif(compiler() is None, reason="there is no C compiler")
def test_stretches_below_the_rounding_of_equal_motions():
    """They are lost in all runs, whose works of springs are exactly zero."""
    table = equal_pendulums()
    truth, result = solve(table, "quad"), tribo.simulate(scene_from(table))
    assert result.status == "completed" and not result["lower"].w_int.any()
    assert np.max(np.abs(truth.series("w_int")[-1])) > 0.0
    found = compared(result, truth)
    assert found["outcome"] == "right", found
    assert 0.0 < result.error_estimate["w_int"] < 1e-13


@pytest.mark.filterwarnings("ignore::tribo.TriboWarning")
def test_steps_do_not_resolve_the_rounding_of_springs():
    """Tolerances that are relative to a tiny contact are no smaller than what springs round off.

    Adaptive steps took four times the evaluations, since the stretches of equal motions are
    rounding.
    """
    table = equal_pendulums()
    table["surface"][1]["asperite"] = {"kappa": 0.0}
    table["numerics"] = {"accuracy": 1e-10, "method": "rkn8"}
    result = tribo.simulate(scene_from(table))
    assert result.status == "completed"
    assert result.cost.force_evaluations < 2e3
    assert EPSILON < result.error_estimate["omega"] < 1e-12


@pytest.mark.filterwarnings("ignore::tribo.TriboWarning")
def test_steps_of_a_row_on_springs_with_a_bath_do_not_underflow():
    """A contact of 1e-40 is all that acts; rounding of the stretches is 1e24 times as much."""
    scene = scene_from(wide_scene(1000779))
    result = tribo.simulate(replace(scene, numerics=tribo.Numerics(1e-10, "rkn8")))
    assert result.status == "completed" and not result.met
    assert result.cost.force_evaluations < 1e4


def test_rigid_rows_on_springs_meet_an_accuracy():
    """The rounding of springs turns no asperite where none can turn, and no rate has a scale."""
    field = tribo.Field(tribo.Corrugation(0.3, 1.0), on=("upper",))
    row = {"shape": (5, 1), "spacing": (1.1, 0.0), "springs": tribo.Springs(3.0)}
    upper = Surface("upper", drive=tribo.Free(), asperite=Asperite(kappa=np.inf), **row)
    result = tribo.simulate(Scene([upper], [], 8.0, fields=(field,), output=Output(samples=9)))
    assert result.met and result.error_estimate["omega"] == 0.0


@pytest.mark.parametrize("ending", ["shift", "force-shift"])
def test_energies_that_cutoffs_subtract(ending):
    """They are far larger than what is left of them, and the same bits in all runs.

    Rigid asperites pass at a distance of sqrt(t^2 + 1) without a change of their velocities.
    """
    width, end, times = 1000.0, 4.0, (0.0, 1.3, 2.7, 3.1)
    contact = tribo.Gaussian(1.0, width).with_cutoff(end, at_cutoff=ending)
    rigid = Asperite(kappa=np.inf)
    upper = Surface("upper", bob=(0.0, 1.0), velocity=(1.0, 0.0), asperite=rigid)
    lower = Surface("lower", facing="up", asperite=rigid)
    result = tribo.simulate(Scene((upper, lower), contact, 3.1, output=Output(times=times)))
    with mpmath.workdps(40):
        last = mpmath.exp(-((end / mpmath.mpf(width)) ** 2) / 2)
        for k, t in enumerate(times):
            r = mpmath.sqrt(mpmath.mpf(t) ** 2 + 1)
            exact = mpmath.exp(-((r / width) ** 2) / 2) - last
            if ending == "force-shift":
                exact += (r - end) * end / mpmath.mpf(width) ** 2 * last
            found = mpmath.mpf(float(result.system["contact_energy"][k]))
            assert abs(found - exact) <= result.error_estimate["contact_energy"] < 1e-14


@pytest.mark.parametrize("strength", [1e-20, 1e-40])
def test_works_below_the_rounding_of_energies(strength):
    """Their errors are relative to the energies, which a note says; bars are no smaller."""
    upper = Surface("upper", bob=(-3.0, 0.5), velocity=(0.5, 0.0), initial=Initial(omega=0.3))
    lower = Surface("lower", facing="up", bars="free")
    scene = Scene((replace(upper, bars="free"), lower), Coulomb(strength), 12.0)
    result = tribo.simulate(scene, accuracy=1e-6)
    assert result.status == "completed" and result.met
    assert any(f"{LOST} of 1.2e-01" in note for note in result.notes)
    for name in ("w1", "w", "w1_ps"):
        assert EPSILON * 0.12 < result.error_estimate[name] < 1e-6 * 0.12
    others = ({"upper.x_bob": 1e-6}, scene), (1e-6, replace(scene, interactions=()))
    for accuracy, other in others:
        result = tribo.simulate(other, accuracy=accuracy)
        assert result.met and not any(LOST in note for note in result.notes)


def test_works_of_members_below_the_rounding_of_energies():
    """Members in lanes have the note of a single run."""
    members = 64
    upper = Surface("upper", bob=(-3.0, 0.5), velocity=(0.5, 0.0), initial=Initial(omega=0.3))
    lower = Surface("lower", facing="up", bars="free")
    scene = Scene((replace(upper, bars="free"), lower), Coulomb(1e-20), 12.0)
    vary = {"upper.theta": np.linspace(-0.1, 0.1, members)}
    data = tribo.ensemble(scene, vary=vary, keep=["upper.w1"], accuracy=1e-6)
    assert set(data["status"].values) == {"completed"}
    said = f"works of {members} members that were compared lie {LOST}"
    assert any(said in note for note in json.loads(data.attrs["notes"]))
    strong = replace(scene, interactions=Coulomb(1e-3))
    data = tribo.ensemble(strong, vary=vary, keep=["upper.w1"], accuracy=1e-6)
    assert LOST not in data.attrs["notes"]


@pytest.mark.filterwarnings("ignore::tribo.TriboWarning")  # the request is out of reach
@pytest.mark.parametrize(
    ("accuracy", "method"),
    [
        *itertools.product([1e-6, 1e-8, 1e-10], [None, "dop853"]),
        (1e-6, "verlet"),
        (1e-8, "verlet"),
        pytest.param(1e-10, "verlet", marks=pytest.mark.thorough),  # 25 s
    ],
)
def test_a_bar_on_the_maximum_of_a_field(method, accuracy):
    """Nothing but the rounding of its place moves it, in all runs alike."""
    simulation = tribo.prepare(on_a_maximum(4.0), accuracy=accuracy, method=method)
    for result in (simulation.first_result(), simulation.run()):
        for name in ("x_cm", "vx_cm", "w_field"):
            assert np.max(np.abs(result["lower"][name])) <= result.error_estimate[name], name


def test_members_on_the_maximum_of_a_field():
    """They are compared with runs from other roundings, as single runs are."""
    vary = {"upper.theta": np.linspace(0.01, 0.1, 8)}
    keep = ["lower.x_cm"]
    data = tribo.ensemble(on_a_maximum(3.5), vary=vary, keep=keep, accuracy=1e-5)
    off = np.abs(data["lower.x_cm"].values).ravel()
    assert np.all(off > 1e-9) and np.all(off <= data["error"].values)


def on_a_maximum(duration):
    """A free bar on the maximum of a field, at a distance that has no exact number of periods."""
    own = Asperite(m1=0.7, m2=1.3, kappa=100.0, length=1.0)
    upper = Surface("upper", bob=(-7.3, 5.0), velocity=(1.0, 0.0), bars="free", asperite=own)
    lower = Surface("lower", facing="up", bob=(0.0, 0.0), bars="free", asperite=own)
    hill = tribo.Field(tribo.Corrugation(-1.0, 1.0), on=["upper", "lower"])
    return Scene((upper, lower), (), duration, fields=hill, output=Output(samples=9))
