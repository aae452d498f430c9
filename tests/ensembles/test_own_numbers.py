"""Members that differ in velocities and numbers are the runs of their own scenes."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

import tribo
from support.crossed import Push
from tribo.ensembles.batches import SingleRuns
from tribo.ensembles.kept_values import Kept
from tribo.ensembles.members import Variation, values_at_start
from tribo.ensembles.runner import policy_of
from tribo.integrators.methods import METHODS
from tribo.integrators.step_control import Tolerance
from tribo.layout.initial_state import InitialState
from tribo.layout.layout import lay_out
from tribo.layout.own_numbers import can_differ, member_numbers
from tribo.loops.batch import MemberStarts
from tribo.loops.select import Integrator
from tribo.loops.setting import Setting
from tribo.model.parameters import with_values

SPEEDS = {"upper.velocity": stats.uniform(0.4, 0.2)}
STRENGTHS = {"interaction.strength": stats.uniform(0.1, 0.2)}
ASPERITES = {
    "upper.asperite.kappa": stats.uniform(0.8, 0.4),
    "upper.asperite.length": stats.uniform(1.9, 0.2),
    "lower.asperite.m1": stats.uniform(0.8, 0.4),
    "lower.asperite.charge": stats.uniform(0.5, 1.0),
}
ALONG_BOTH = {"upper.velocity": np.array([[0.5, 0.02], [0.4, -0.01], [0.6, 0.0]] * 3)}
KEEP = ["upper.w1", "upper.w2", "lower.delta_e_int", "upper.W", "upper.W_ps", "upper.delta_K"]
KEEP += ["contact_energy", "total_energy_change"]
ROW = {"shape": (3, 1), "spacing": (1.5, 0.0)}
CUT = tribo.Coulomb(0.2).with_cutoff(1.9)
CORRUGATION = tribo.Field(tribo.Corrugation(0.02, 1.1), on=["upper"])


def scene_of(potential=None, upper=None, lower=None, **settings):
    """Three asperites on three, with settings of each surface."""
    above = {"bob": (-1.0, 0.5), "velocity": (0.5, 0.0), **ROW, **(upper or {})}
    below = {"facing": "up", **ROW, **(lower or {})}
    surfaces = [tribo.Surface("upper", **above), tribo.Surface("lower", **below)]
    settings = {"numerics": tribo.Numerics(accuracy=1e-6), **settings}
    settings["output"] = tribo.Output(samples=2)
    return tribo.Scene(surfaces, potential or tribo.Coulomb(0.2), 3.0, **settings)


def check(scene, vary, members, within, **how):
    """Some members of an ensemble against the runs of their scenes; returns the data set."""
    ensemble_settings = {"step": how["step"]} if "step" in how else {}
    data = tribo.ensemble(scene, members, vary, keep=KEEP, threads=2, **ensemble_settings)
    assert set(data["status"].values) == {"completed"}
    variation = Variation(scene, vary, 0)
    for m in (0, members // 2, members - 1):
        run = tribo.simulate(variation.members(np.array([m])).scene(0, scene, True), **how)
        series = {}
        for name in KEEP:
            surface, _, quantity = name.rpartition(".")
            series[name] = np.asarray(run[surface][quantity] if surface else run.system[quantity])
        scale = max(np.max(np.abs(each)) for each in series.values())
        for name in KEEP:
            found = data[name][m].values
            assert np.max(np.abs(found - series[name][-1])) <= within * scale, name
    return data


KINDS = {
    "speeds": (scene_of(), SPEEDS),
    "both": (scene_of(), ALONG_BOTH),
    "strengths": (scene_of(), STRENGTHS | {"upper.omega": stats.norm(0.0, 0.1)}),
    "asperites": (scene_of(upper={"asperite": tribo.Asperite(m2=[1.0, 2.0, 3.0])}), ASPERITES),
    "sliding": (scene_of(upper={"drive": "free"}), SPEEDS | STRENGTHS),
    "turning": (scene_of(upper={"bars": "free"}), SPEEDS | ASPERITES),
    "loaded": (scene_of(lower={"drive": tribo.Free(load=0.01)}), SPEEDS),
    "body": (scene_of(upper={"drive": tribo.Free(rigid=True)}), SPEEDS),
    "sprung": (scene_of(upper={"drive": "free", "springs": tribo.Springs(1.0)}), SPEEDS),
    "morse": (
        scene_of(tribo.Morse(0.05, 2.0, 0.6)),
        {"interaction.alpha": stats.uniform(1.5, 1.0)},
    ),
    "yukawa": (
        scene_of(tribo.Yukawa(0.2, 1.0)),
        {"interaction.screening": stats.uniform(0.8, 0.4)},
    ),
    "driven": (scene_of(upper={"drive": "bars"}), SPEEDS | STRENGTHS),
    "pulled": (
        scene_of(upper={"drive": tribo.Pulled(stiffness=1.0, speed=0.4)}),
        SPEEDS
        | {f"upper.drive.{name}": stats.uniform(0.3, 0.4) for name in ("stiffness", "speed")},
    ),
    "loads": (
        scene_of(upper={"drive": tribo.Free(load=0.01)}, lower={"drive": tribo.Free(load=0.01)}),
        {f"{name}.drive.load": stats.uniform(0.0, 0.02) for name in ("upper", "lower")},
    ),
    "periodic": (scene_of(CUT, periodic=tribo.Periodic(z=4.0)), SPEEDS | ASPERITES),
}


@pytest.mark.parametrize("kind", KINDS)
def test_members_are_runs_of_their_scenes(kind):
    """In lanes, with an accuracy."""
    scene, vary = KINDS[kind]
    data = check(scene, vary, 9, 1e-6, accuracy=1e-9)
    assert data.attrs["method"] == "rkn8" and "notes" in data.attrs
    assert float(data["error"].max()) <= 1e-6
    assert np.ptp(data["upper.w1"].values) > 1e-4


NOISY = {"drive": "free", "langevin": tribo.Langevin(0.3, 1e-3)}
SWINGING = {"langevin": tribo.Langevin(0.3, 1e-3, on="swing")}
RESERVOIRS = {
    "upper.langevin.temperature": stats.uniform(0.0, 1e-2),
    "lower.langevin.gamma": stats.uniform(0.1, 0.3),
}
STEPPED = {
    "reservoirs": (scene_of(upper=NOISY, lower=SWINGING), RESERVOIRS | SPEEDS),
    "swapped": (
        scene_of(upper=SWINGING, lower=NOISY | {"langevin": tribo.Langevin(0.2, 1e-3)}),
        RESERVOIRS,
    ),
    "noise": (scene_of(upper=NOISY), SPEEDS | STRENGTHS),
    "asperites": (scene_of(upper={"bars": "free"}), SPEEDS | ASPERITES),
    "bath": (
        scene_of(upper={"drive": "free", "bath": tribo.Bath([0.1], [1.0], temperature=1e-3)}),
        SPEEDS,
    ),
    "driven": (scene_of(upper={"drive": "bars"}), {"upper.omega": stats.norm(0.0, 0.1)} | SPEEDS),
    "warm": (scene_of(lower={"initial": tribo.Initial(temperature=1e-2)}), SPEEDS),
}


@pytest.mark.parametrize("kind", STEPPED)
def test_members_with_a_given_step(kind):
    """To round-off, with the noise and the start of each member."""
    scene, vary = STEPPED[kind]
    scene = replace(scene, numerics=tribo.Numerics(method="verlet", step=0.02))
    check(scene, vary, 11, 1e-11, step=0.02)


@pytest.mark.parametrize("key", ["asperite.m1", "theta", "velocity"])
def test_keys_of_all_surfaces(key):
    """Those of every surface: alike in arrays, and drawn by each surface for itself."""
    scene, names = scene_of(), ("upper", "lower")
    source = stats.uniform(0.9, 0.2)
    data = tribo.ensemble(scene, 3, {f"*.{key}": source}, keep=["upper.w1"])
    own = tribo.ensemble(scene, 3, {f"{n}.{key}": source for n in names}, keep=["upper.w1"])
    np.testing.assert_array_equal(data["upper.w1"], own["upper.w1"])
    upper, lower = (data[f"{n}.{key}"].values.reshape(3, -1)[:, 0] for n in names)
    assert not np.any(upper == lower)
    data = tribo.ensemble(scene, 2, {f"*.{key}": [0.9, 1.1]}, keep=["upper.w1"])
    for name in names:
        given = data[f"{name}.{key}"].values.reshape(2, -1)[:, 0]
        np.testing.assert_array_equal(given, [0.9, 1.1])


def test_members_do_not_depend_on_their_company():
    """The same bits in any lane, and alone again from the data set."""
    scene = scene_of()
    layout, method = lay_out(scene), METHODS["rkn8"]
    loop = Integrator(layout, method).batch(own_numbers=True)
    values = Variation(scene, SPEEDS | STRENGTHS | ASPERITES, 0).members(np.arange(40)).values
    numbers = member_numbers(layout, 40, values)
    starts = MemberStarts(np.tile(layout.start, (40, 1)), np.zeros(40, int), numbers)
    y, s = np.full(layout.start.size, 1e-8), np.full(layout.accounts, 1e-8)
    setting = Setting(tolerance=Tolerance(y, s, 1e-8))
    whole = loop.run(setting, starts)
    chosen = np.array([18, 3, 11, 4, 39, 7, 9, 2, 16, 1])
    some = loop.run(setting, starts.of_members(chosen))
    same = whole.of_members(chosen)
    assert np.array_equal(some.counts, same.counts)
    assert np.array_equal(some.samples.y, same.samples.y)
    assert np.array_equal(some.samples.s, same.samples.s)
    data = tribo.ensemble(scene, 20, SPEEDS | ASPERITES, keep=KEEP)
    alone = tribo.ensemble_member(data, 11)
    for name in KEEP:
        assert np.array_equal(alone[name][0], data[name][11])


def test_one_member_alone_on_driven_bars():
    """A batch of one member gives the bits of that member among others."""
    scene = scene_of(upper={"drive": "bars"}, lower={"drive": "bars"})
    vary = {"*.swing_state": tribo.Canonical(0.1)}
    layout, values = lay_out(scene), Variation(scene, vary, 0).members(np.arange(3)).values
    y = InitialState(layout).of_members(values_at_start(values), np.zeros(3, int))
    loop = Integrator(layout, METHODS["rkn8"]).batch()
    scales = np.full(layout.start.size, 1e-8), np.full(layout.accounts, 1e-8)
    setting = Setting(tolerance=Tolerance(*scales, 1e-8))
    starts = MemberStarts(y, np.zeros(3, int))
    whole, one = loop.run(setting, starts), loop.run(setting, starts.of_members([1]))
    same = whole.of_members(np.array([1]))
    assert np.array_equal(one.samples.s, same.samples.s)
    assert np.any(same.samples.s != 0.0)


def test_members_that_need_a_run_of_their_own():
    """A member that swings far faster than the others takes more steps than the loop allows."""
    vary = {"upper.velocity": [0.4, 0.5, 0.3, 0.6, 0.5], "upper.omega": [0.0, 0.1, 3e3, 0.2, 0.0]}
    data = check(scene_of(), vary, 5, 1e-5, accuracy=1e-7)
    assert int(data["steps"][2]) > 2048


def runs_of(scene, keys):
    """The kind of runs of members that differ in some numbers."""
    simulation = tribo.prepare(scene)
    simulation.compute_first()
    return policy_of(simulation, Kept.at_end(simulation.scene, ["upper.w1"]), keys)


@pytest.mark.parametrize(
    ("scene", "key"),
    [
        (scene_of(fields=[CORRUGATION]), "upper.velocity"),
        (scene_of(upper={"langevin": tribo.Langevin(0.3)}), "upper.langevin.gamma"),
        (scene_of(upper={"langevin": tribo.Langevin(0.3, velocity=(0.1, 0.0))}), "upper.velocity"),
        (scene_of(upper={"drive": "free"}), "upper.asperite.m1"),
        (scene_of(upper={"drive": "free", "bath": tribo.Bath([0.1], [1.0])}), "upper.asperite.m2"),
        (scene_of(upper={"initial": tribo.Initial(temperature=0.1)}), "upper.asperite.kappa"),
        (scene_of(CUT), "interaction.strength"),
        (scene_of(upper={"drive": tribo.Pushed(force=(0.1, 0.0))}), "upper.drive.load_rate"),
    ],
)
def test_other_numbers_are_run_one_by_one(scene, key):
    """What refers to a velocity, or follows from the numbers of asperites, is laid out for each."""
    assert not can_differ(lay_out(scene), [key], False)
    assert isinstance(runs_of(scene, [key]), SingleRuns)


WIDTHS = stats.uniform(0.1, 0.2)


@pytest.mark.parametrize(
    ("upper", "key"),
    [
        ({"drive": "free"}, "upper.x"),
        ({"drive": "free"}, "upper.vx"),
        ({"drive": tribo.Free(load=0.1)}, "upper.vy"),
        ({"drive": "free"}, "upper.temperature"),
        ({"langevin": tribo.Langevin(0.3)}, "upper.langevin.temperature"),
        ({"drive": "free", "bath": tribo.Bath([0.1], [1.0])}, "upper.bath.temperature"),
        ({"drive": "free", "springs": tribo.Springs(1.0)}, "upper.springs.stiffness"),
        ({"drive": tribo.Custom(force=Push(0.1))}, "upper.drive.strength"),
    ],
)
def test_every_other_number_differs(upper, key):
    """Members have it, each in a scene of its own."""
    scene = scene_of(upper=upper, numerics=tribo.Numerics(method="verlet", step=0.05))
    data = check(scene, {key: WIDTHS}, 3, 1e-13, step=0.05)
    assert len(np.unique(data["upper.w1"].values)) == 9


def test_one_number_in_place_of_one_for_each_asperite():
    """As in sweeps: all asperites of a member have its number."""
    upper = {"asperite": tribo.Asperite(m2=[1.0, 2.0, 3.0], kappa=[1.0, 2.0, 1.5])}
    vary = {"upper.asperite.m2": [1.5, 2.5], "upper.asperite.kappa": [1.2, 0.9]}
    members = tribo.ensemble(scene_of(upper=upper), vary=vary, keep=["upper.w1"])
    points = tribo.sweep(
        scene_of(upper=upper),
        {tuple(vary): list(zip(*vary.values(), strict=True))},
        keep=["upper.w1"],
        progress=False,
    )
    np.testing.assert_allclose(members["upper.w1"], points["upper.w1"], atol=1e-6)
    assert len(np.unique(members["upper.w1"])) == 6


def test_masses_of_a_sliding_pair():
    """The loop of a pair has them; with a given step each member has a scene of its own."""
    scene = scene_of(upper={"drive": "free", "shape": (1, 1)}, lower={"shape": (1, 1)})
    vary = {"upper.asperite.m1": WIDTHS, "upper.asperite.m2": WIDTHS}
    check(scene, vary, 9, 1e-6, accuracy=1e-9)
    stepped = replace(scene, numerics=tribo.Numerics(method="verlet", step=0.02))
    check(stepped, vary, 9, 1e-12, step=0.02)


@pytest.mark.parametrize("key", ["upper.x", "upper.vx", "upper.temperature"])
def test_starts_of_pairs_differ(key):
    """The loop of a pair does not take them."""
    upper = {"drive": "free", "shape": (1, 1)}
    scene = scene_of(upper=upper, lower={"shape": (1, 1)})
    check(scene, {key: WIDTHS}, 3, 1e-6, accuracy=1e-9)


def test_held_asperites_are_not_displaced():
    """One sentence, by the name of the key."""
    with pytest.raises(tribo.InputError, match="x: cannot be given, as the drive holds"):
        tribo.ensemble(scene_of(), 3, {"upper.x": WIDTHS}, keep=KEEP)


def test_speed_in_a_field():
    """Members that are run one by one have their velocity too."""
    check(scene_of(fields=[CORRUGATION]), SPEEDS, 3, 1e-6, accuracy=1e-9)


@pytest.mark.parametrize(
    ("vary", "what"),
    [
        ({"upper.springs.stiffness": np.array([1.0, 2.0, 900.0])}, "the stiffest spring"),
        ({"upper.drive.stiffness": np.array([1.0, 2.0, 900.0])}, "the stiffest spring"),
        ({"upper.asperite.kappa": np.array([1.0, 2.0, 4000.0])}, "the fastest pendulum"),
        ({"lower.asperite.kappa": np.array([1.0, 2.0, 4000.0])}, "the fastest pendulum"),
    ],
)
def test_a_step_that_one_member_does_not_resolve(vary, what):
    """The scene of all resolves its springs; the stiffest member counts, as in a run of its own."""
    scene = scene_of(
        upper={"drive": tribo.Pulled(stiffness=1.0, speed=0.5), "springs": tribo.Springs(1.0)}
    )
    scene = replace(scene, numerics=tribo.Numerics())
    how = {"method": "verlet", "step": 0.1}
    with pytest.raises(tribo.InputError, match=f"does not resolve {what}"):
        tribo.ensemble(scene, 3, vary, keep=["upper.w1"], **how)
    key = next(iter(vary))
    with pytest.raises(tribo.InputError, match=f"does not resolve {what}"):
        tribo.simulate(with_values(scene, {key: vary[key][2]}), **how)
    allowed = tribo.ensemble(scene, 2, {key: vary[key][:2]}, keep=["upper.w1"], **how)
    assert set(allowed["status"].values) == {"completed"}


def test_a_parameter_may_have_the_name_of_a_start():
    """As of a potential, or of a field, of the user's own."""
    values = {key: np.zeros((2, 1)) for key in ("upper.nu", "interaction.nu", "field.phi")}
    assert list(values_at_start(values)) == ["upper.nu"]
