"""Members that are run side by side in lanes agree with those that are run one by one."""

import itertools

import numpy as np
import pytest

import tribo
from support.crossed import Push, Turn
from support.kinds import surfaces_of
from tribo.compiler.lanes import LANES
from tribo.ensembles.batches import StepRuns
from tribo.ensembles.kept_values import Kept
from tribo.integrators.methods import METHODS
from tribo.integrators.step_control import Tolerance
from tribo.kernels.status import (
    BOBS_COINCIDE,
    CODE,
    COMPLETED,
    ENCOUNTER_JUMPED,
    EVALUATIONS,
    STEPS,
)
from tribo.lanes.steps import MOST_TRIALS
from tribo.layout.layout import lay_out
from tribo.loops.batch import Batch, GeneralMembers, MemberStarts
from tribo.loops.lane_loop import fit_lanes
from tribo.loops.select import Integrator
from tribo.loops.setting import Setting

FIELDS = ("y", "s", "contact", "field", "stored")
STEP, FIRST_STEP = 0.02, 0.2
BATH = {"masses": (0.1, 0.2), "frequencies": (0.8, 1.1)}
TORSIONAL = {"inertias": (0.1,), "torsional_frequencies": (0.9,)}
HEAT = tribo.Langevin(0.3, 1e-3)
SWING_HEAT = tribo.Langevin(0.3, 1e-3, on="swing")
UNLIKE = tribo.Asperite(m1=np.linspace(0.5, 1.0, 6))
RIGID = tribo.Asperite(kappa=np.inf)
KINDS = {
    "drives": {
        "forced": {},
        "loaded": {"drive": tribo.Forced(load=0.1)},
        "rigid": {"drive": tribo.Free(rigid=True)},
        "pulled": {"drive": tribo.Pulled(stiffness=1.0, speed=0.4)},
        "pushed": {"drive": tribo.Pushed(force=(0.05, 0.1)), "asperite": UNLIKE},
        "free": {"drive": "free", "bars": "free"},
        "custom": {"drive": tribo.Custom(force=Push(0.1))},
    },
    "bars": {
        "bars": {"drive": "bars"},
        "fixed": {"drive": "free", "asperite": RIGID},
        "turning": {"initial": tribo.Initial(swing=0.1, nu=0.1)},
        "tilted": {"initial": tribo.Initial(swing=0.1, phi=0.1)},
        "ends": {"bars": tribo.Ends(force=Turn(0.1))},
    },
    "stores": {
        "sprung": {"drive": "free", "springs": tribo.Springs(1.0)},
        "bathed": {"drive": "free", "bath": tribo.Bath(**BATH)},
        "turned": {"drive": "free", "bars": "free", "bath": tribo.Bath(**BATH, **TORSIONAL)},
        "unlike": {"drive": "free", "asperite": UNLIKE, "springs": tribo.Springs(1.0)},
    },
    "noise": {
        "heated": {"drive": "free", "langevin": HEAT, "bath": tribo.Bath(**BATH)},
        "damped": {"langevin": SWING_HEAT},
        "cold": {"drive": "free", "langevin": tribo.Langevin(0.3)},
        "stiff": {"drive": "free", "asperite": RIGID, "langevin": HEAT},
        "driven": {"drive": "bars", "langevin": SWING_HEAT},
    },
}
# Adaptive members have no noise, no baths and no forces that depend on velocities.
POSITIONS_ONLY = ("drives", "bars", "stores")
REFUSED = ("custom", "ends", "bathed", "turned")
POTENTIALS = {
    "coulomb": tribo.Coulomb(0.05),
    "morse": tribo.Morse(0.05, 2.0, 0.6),
    "lennard-jones": tribo.LennardJones(0.02, 0.4).with_cutoff(1.0),
}


def scene_of(kinds, potential, **settings):
    """Surfaces of six asperites, with some settings each, and contact within the first."""
    surfaces, pairs = surfaces_of(kinds, (3, 2))
    names = list(kinds)
    interactions = [tribo.Interaction(potential, pair) for pair in (*pairs, (names[0], names[0]))]
    fields = [
        tribo.Field(tribo.Corrugation(0.02, 1.1), on=names[:2]),
        tribo.Field(tribo.Corrugation(0.01, 0.7), on=names[1:], velocity=(0.2, 0.0)),
    ]
    return tribo.Scene(
        surfaces, interactions, 1.0, fields=fields, output=tribo.Output(samples=3), **settings
    )


def two_rows(bob=(-1.0, 0.5), **settings):
    """Three asperites on three, with settings of both surfaces."""
    both = {"shape": (3, 1), "spacing": (1.5, 0.0)} | settings
    upper = tribo.Surface("upper", bob=bob, velocity=(0.5, 0.0), **both)
    surfaces = [upper, tribo.Surface("lower", facing="up", **both)]
    return tribo.Scene(surfaces, tribo.Coulomb(0.2), 4.0, output=tribo.Output(samples=3))


def starts_of(layout, members):
    """Starts that differ, from a fixed seed."""
    rng = np.random.default_rng(3)
    y = layout.start + 0.02 * rng.standard_normal((members, layout.start.size))
    return MemberStarts(y, np.arange(members) + 5)


def loops_of(layout, method):
    """Loops that run members in lanes, and one by one."""
    assert fit_lanes(layout, method)
    alone = Batch(lambda: GeneralMembers(layout, method, FIRST_STEP))
    integrator = Integrator(layout, method)
    integrator.first_step = FIRST_STEP
    return [integrator.batch(), alone]


def setting_of(layout, method):
    """A step, or tolerances that differ from one coordinate to another."""
    if not method.adaptive:
        return Setting(step=STEP)
    y, s = (1e-8 + 1e-9 * np.arange(n) / n for n in (layout.start.size, layout.accounts))
    return Setting(tolerance=Tolerance(y, s, 1e-8))


def runs_of(loop, layout, members, chosen=slice(None), method=METHODS["verlet"]):
    """The runs of some of these members."""
    starts = starts_of(layout, members).of_members(chosen)
    return loop.run(setting_of(layout, method), starts)


def check_agreement(one, other, within):
    """The same counts, and all samples within some part of their sizes."""
    assert np.array_equal(one.counts, other.counts) and np.all(one.counts[:, CODE] == COMPLETED)
    for name in FIELDS:
        mine, theirs = getattr(one.samples, name), getattr(other.samples, name)
        if theirs.size:
            scale = np.max(np.abs(theirs), axis=0) + 1e-3 * np.max(np.abs(theirs)) + 1e-300
            assert np.max(np.abs(mine - theirs) / scale) < within, name


# In the default set each kind and each potential; the slow set has the other combinations.
PAIRED = {
    ("drives", "coulomb"),
    ("bars", "morse"),
    ("stores", "lennard-jones"),
    ("noise", "morse"),
}
COMBINATIONS = [
    pytest.param(*each, marks=() if each in PAIRED else pytest.mark.slow)
    for each in itertools.product(KINDS, POTENTIALS)
]


@pytest.mark.parametrize(("kinds", "potential"), COMBINATIONS)
def test_lanes_agree_with_single_runs(kinds, potential):
    """Every drive, bar, store and reservoir, with moving fields and contact within a surface."""
    layout, method = lay_out(scene_of(KINDS[kinds], POTENTIALS[potential])), METHODS["verlet"]
    one, other = (runs_of(loop, layout, 11) for loop in loops_of(layout, method))
    check_agreement(one, other, 1e-12)


@pytest.mark.parametrize("name", ["rkn8", "rkn12"])
@pytest.mark.parametrize("kinds", POSITIONS_ONLY)
def test_adaptive_lanes_agree_with_single_runs(kinds, name):
    """Each member takes its own steps."""
    kinds = {kind: settings for kind, settings in KINDS[kinds].items() if kind not in REFUSED}
    layout, method = lay_out(scene_of(kinds, POTENTIALS["morse"])), METHODS[name]
    one, other = (runs_of(loop, layout, 21, method=method) for loop in loops_of(layout, method))
    check_agreement(one, other, 1e-11)


def test_steps_that_pass_an_encounter():
    """Where tolerances allow longer steps, lanes reject those that go too far as single runs do."""
    layout, method = lay_out(two_rows((-1.0, 0.05))), METHODS["rkn8"]
    starts = starts_of(layout, 20)
    limits = np.full(layout.start.size, 0.1), np.full(layout.accounts, 0.1)
    setting = Setting(tolerance=Tolerance(*limits, 0.1, 0.9))
    one, other = (loop.run(setting, starts) for loop in loops_of(layout, method))
    check_agreement(one, other, 1e-11)
    tried = (one.counts[:, EVALUATIONS] - 1) // method.coefficients.c.size
    assert np.all(tried > one.counts[:, STEPS])


@pytest.mark.parametrize("name", ["rkn8", "rkn12"])
def test_adaptive_members_do_not_depend_on_their_company(name):
    """The same bits in any lane, beside any others, and after any others."""
    layout, method = lay_out(two_rows()), METHODS[name]
    loop, _ = loops_of(layout, method)
    whole = runs_of(loop, layout, 40, method=method)
    assert np.ptp(whole.counts[:, STEPS]) > 0
    for chosen in (np.array([18, 3, 11, 4, 0, 7, 39, 2, 16, 1]), np.array([5])):
        some, same = runs_of(loop, layout, 40, chosen, method), whole.of_members(chosen)
        assert np.array_equal(some.counts, same.counts)
        for field in FIELDS:
            mine = getattr(some.samples, field)
            assert np.array_equal(mine, getattr(same.samples, field)), field


def test_adaptive_members_that_need_care_are_run_alone():
    """Bobs in one place, motion that is not finite, and too many trials; the others are as ever."""
    layout, method = lay_out(two_rows((-1.0, 0.0), drive="free")), METHODS["rkn8"]
    loop, single = loops_of(layout, method)
    usual = runs_of(loop, layout, 20, method=method)
    starts, setting = starts_of(layout, 20), setting_of(layout, method)
    upper, n = layout.surfaces[0], layout.coordinates
    touching, lost, fast = special = [3, 8, 12]
    starts.y[touching] = layout.start
    starts.y[touching, upper.dof_x] = 1.0
    starts.y[lost, n] = np.nan
    starts.y[fast, n] = 3e4
    found = loop.run(setting, starts)
    assert found.counts[touching, CODE] == BOBS_COINCIDE
    assert found.counts[fast, STEPS] > MOST_TRIALS
    assert np.array_equal(
        found.counts[special], single.run(setting, starts.of_members(special)).counts
    )
    others = np.setdiff1d(np.arange(20), special)
    for field in FIELDS:
        mine = getattr(found.of_members(others).samples, field)
        assert np.array_equal(mine, getattr(usual.of_members(others).samples, field)), field


def test_species_and_periodic_boxes():
    """Lanes have the same species, and the same nearest images."""
    row = {"shape": (3, 1), "spacing": (1.0, 0.0)}
    upper = tribo.Surface(
        "upper", bob=(0.2, 0.7), velocity=(0.4, 0.0), species=["a", "b", "a"], **row
    )
    lower = tribo.Surface("lower", facing="up", species=["b", "b", "a"], **row)
    names = ("upper", "lower")
    interactions = [
        tribo.Interaction(tribo.Coulomb(0.1).with_cutoff(1.2), names, ("a", "b")),
        tribo.Interaction(tribo.Morse(0.05, 2.0, 0.6).with_cutoff(1.4), names, ("a", "a")),
    ]
    scene = tribo.Scene([upper, lower], interactions, 2.0, periodic=tribo.Periodic(x=3.0))
    layout, method = lay_out(scene), METHODS["verlet"]
    one, other = (runs_of(loop, layout, 9) for loop in loops_of(layout, method))
    assert np.allclose(one.samples.y, other.samples.y, rtol=0.0, atol=1e-13)
    assert np.ptp(one.samples.contact) > 1e-3


def test_members_do_not_depend_on_their_company():
    """The same bits in any lane, beside any others, and after any others."""
    scene = scene_of(KINDS["noise"], POTENTIALS["coulomb"])
    layout, method = lay_out(scene), METHODS["verlet"]
    loop, _ = loops_of(layout, method)
    whole = runs_of(loop, layout, 19)
    chosen = np.array([18, 3, 11, 4, 0, 7, 9, 2, 16, 1])
    some = runs_of(loop, layout, 19, chosen)
    for name in FIELDS:
        mine = getattr(some.samples, name)
        assert np.array_equal(mine, getattr(whole.of_members(chosen).samples, name)), name


def test_member_that_jumps_an_encounter_is_run_alone():
    """It has the status of a run of its own, and changes no bit of the others."""
    upper = tribo.Surface("upper", bob=(-1.0, 0.5), velocity=(0.5, 0.0))
    scene = tribo.Scene([upper, tribo.Surface("lower", facing="up")], tribo.Coulomb(0.2), 2.0)
    layout, method = lay_out(scene), METHODS["verlet"]
    starts = MemberStarts(np.tile(layout.start, (9, 1)), np.zeros(9, int))
    starts.y[:, 0] = np.linspace(-0.1, 0.1, 9)
    loop, single = loops_of(layout, method)
    usual = loop.run(Setting(step=0.05), starts)
    assert np.all(usual.counts[:, CODE] == COMPLETED)
    starts.y[4, layout.coordinates] = 400.0
    found = loop.run(Setting(step=0.05), starts)
    assert found.counts[4, CODE] == ENCOUNTER_JUMPED
    others = np.arange(9) != 4
    for name in FIELDS:
        mine = getattr(found.of_members(others).samples, name)
        assert np.array_equal(mine, getattr(usual.of_members(others).samples, name)), name
    alone = single.run(Setting(step=0.05), starts.of_members(slice(4, 5)))
    assert np.array_equal(found.counts[4], alone.counts[0])


def test_calls_fill_registers():
    """Members that take long are run by eights too."""
    upper = tribo.Surface("upper", bob=(-1.0, 0.5), velocity=(0.5, 0.0), langevin=HEAT)
    surfaces = [upper, tribo.Surface("lower", facing="up")]
    scene = tribo.Scene(surfaces, tribo.Coulomb(0.2), 1e5, numerics=tribo.Numerics(step=0.01))
    simulation = tribo.prepare(scene)
    kept = Kept.at_end(simulation.scene, ["upper.w1"])
    assert StepRuns(simulation, kept, ()).chunk == LANES
