"""Derivatives by parameters, against closed forms."""

import json

import numpy as np
import pytest
from scipy import stats

import tribo
from tribo import Asperite, Free, InputError, Scene, SoftSphere, Surface
from tribo.derivatives.differences import Differences, best_of_ladder
from tribo.derivatives.figure import tornado

UPPER, LOWER, SPEED = 1.5, 3.0, 0.5


def collision():
    """Two rigid asperites that meet head-on and share their momentum, elastically."""
    rigid = {"kappa": np.inf, "m1": 1.0}
    upper = Surface(
        "upper",
        bob=(-2.0, 0.0),
        velocity=(SPEED, 0.0),
        drive=Free(),
        asperite=Asperite(**rigid, m2=UPPER - 1.0),
    )
    lower = Surface("lower", drive=Free(), asperite=Asperite(**rigid, m2=LOWER - 1.0))
    repulsion = SoftSphere(0.5, 0.6, 12.0).with_cutoff(1.5, "switch")
    return Scene((upper, lower), repulsion, 8.0)


KEYS = ["upper.velocity", "upper.asperite.m1", "lower.asperite.m2", "interaction.epsilon"]


@pytest.fixture(scope="module")
def found():
    return tribo.sensitivity(collision(), ["lower.w1", "upper.w1"], KEYS, accuracy=1e-9)


def test_work_of_a_head_on_collision(found):
    """The work on the lower one is 1/2 M V^2 with V = 2 m v / (m + M); errors are within bounds."""
    work = 0.5 * LOWER * (2.0 * UPPER * SPEED / (UPPER + LOWER)) ** 2
    expected = {
        "upper.velocity": 2.0 * work / SPEED,
        "upper.asperite.m1": 2.0 * work * (1.0 / UPPER - 1.0 / (UPPER + LOWER)),
        "lower.asperite.m2": work / LOWER - 2.0 * work / (UPPER + LOWER),
        "interaction.epsilon": 0.0,
    }
    for name, sign in (("lower.w1", 1.0), ("upper.w1", -1.0)):
        for key, exact in expected.items():
            one = found.sel(quantity=name, key=key)
            error = abs(float(one["derivative"]) - sign * exact)
            assert error <= float(one["half_width"]) < 1e-6, (name, key)
    assert found["quantity_value"].values == pytest.approx([work, -work])
    assert float(found["relative"].sel(quantity="lower.w1", key="upper.velocity")) == pytest.approx(
        2
    )
    assert json.loads(found.attrs["notes"]) == []


def test_a_tornado(found):
    """The largest relative derivative is on top."""
    axes = tornado(found, "upper.w1")
    labels = [label.get_text() for label in axes.get_yticklabels()]
    assert labels[-1] == "upper.velocity" and labels[0] == "interaction.epsilon"
    with pytest.raises(InputError, match="quantity"):
        tornado(found, "upper.w2")


def test_extrapolation_takes_the_best_step():
    """Of exp at 0 with errors of 1e-9, and of a jump, which has no derivative."""
    steps = 0.04 * 0.5 ** np.arange(6)
    rng = np.random.default_rng(0)
    noise = rng.uniform(-1e-9, 1e-9, (2, 6, 1))
    smooth = Differences(
        steps, np.exp(steps)[:, None] + noise[0], np.exp(-steps)[:, None] + noise[1]
    )
    best = best_of_ladder(smooth, np.full(6, 2e-9))
    assert abs(best.value - 1.0) <= best.half_width < 1e-6
    jump = Differences(steps, np.ones((6, 1)), np.zeros((6, 1)))
    worst = best_of_ladder(jump, np.full(6, 2e-9))
    assert worst.half_width > 0.5 * abs(worst.value)
    assert best_of_ladder(smooth, np.full(6, np.inf)) is None


def straight_line(errors):
    """The best derivative of 3 x at 0 by four steps, with these errors of runs, and the steps."""
    steps = 0.1 * 0.5 ** np.arange(4)
    up, down = (3.0 * sign * steps[:, None] for sign in (1.0, -1.0))
    return best_of_ladder(Differences(steps, up, down), np.array(errors)), steps


def test_the_interval_of_an_extrapolated_derivative():
    """(4 D(h/2) - D(h)) / 3, whose errors add up: each is that of runs over 2 h."""
    best, steps = straight_line([1e-3] * 4)
    own = 1e-3 / (2.0 * steps)
    assert best.value == pytest.approx(3.0)
    assert best.step == steps[1]
    assert best.half_width == pytest.approx((4.0 * own[2] + own[1]) / 3.0, rel=1e-9)


def test_a_step_that_is_lost_in_errors_of_runs_spoils_no_other():
    """The shortest step has errors of one; the longer ones keep intervals of their own."""
    best, _ = straight_line([1e-6, 1e-6, 1e-6, 1.0])
    assert best.value == pytest.approx(3.0)
    assert best.half_width < 1e-3


def test_members_differ_in_pairs():
    """The mean over starts: the derivative of each member is known, and so is the interval."""
    spread = {"upper.omega": stats.norm(0.0, 0.3)}
    upper = Surface("upper", asperite=Asperite(kappa=2.0))
    scene = Scene((upper,), (), 2.0)
    found = tribo.sensitivity(
        scene,
        ["upper.swing_energy"],
        ["upper.asperite.m1"],
        members=16,
        vary=spread,
        accuracy=1e-9,
    )
    # 1/2 mu length^2 omega^2 with the reduced mass mu, which stays: the pendulum conserves it.
    own = tribo.ensemble(scene, 16, spread, keep=["upper.swing_energy"], accuracy=1e-9)
    asperite = upper.asperite
    one, other = float(asperite.m1), float(asperite.m2)
    slope = other / (one * (one + other))
    expected = slope * float(own["upper.swing_energy"].mean())
    one = found.isel(quantity=0, key=0)
    assert float(one["derivative"]) == pytest.approx(expected, rel=1e-5)
    width = stats.t.ppf(0.975, 15) * slope * float(own["upper.swing_energy"].std(ddof=1)) / 4.0
    assert float(one["half_width"]) == pytest.approx(width, rel=1e-2)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((["upper.w1"], []), "keys: must be a list of keys"),
        ((["upper.w1"], ["lower.velocity"]), r"scales.lower\.velocity: is missing"),
        ((["upper.w1"], ["upper.drive"]), r"keys.upper\.drive: must be a number"),
        ((["upper.w1"], ["upper.asperite.kappa"]), "must be finite"),
        ((["upper.w9"], ["upper.velocity"]), "w9"),
        ((["upper.w1"], ["uper.theta"]), r'uper\.theta: is not a known key; did you mean "upper'),
        ((["upper.w1"], ["third.theta"]), r"third\.theta: is not a known key; the surfaces are"),
        ((["upper.w1"], ["*.theta"]), "must be a number of the scene"),
        ((["upper.w1"], ["upper.langevin.bar.gamma"]), "is not a known key"),
        ((["upper.w1"], ["upper.asperite.kappa.1"]), "is not a known key"),
        ((["upper.w1"], ["upper.heights.rms"]), "is not a known key"),
    ],
)
def test_refusals(arguments, message):
    with pytest.raises(InputError, match=message):
        tribo.sensitivity(collision(), *arguments)


def test_long_steps_that_agree_by_chance():
    """A derivative that shorter steps contradict is no derivative."""
    steps = 0.04 * 0.5 ** np.arange(6)
    # Of which the extrapolations of the first steps agree, at 1, and those of the last ones at 2.
    slopes = np.array([1.0, 1.0, 1.0, 2.0, 2.01, 2.012])
    up = (slopes * steps)[:, None]
    found = best_of_ladder(Differences(steps, up, -up), np.full(6, 1e-9))
    assert abs(found.value - 2.0) < found.half_width + 0.02 and found.half_width < 0.1


def test_quantities_without_error_estimates_are_named():
    tip = tribo.Surface("tip", drive=tribo.Pulled(stiffness=0.5, speed=0.2))
    scene = tribo.Scene((tip,), (), 2.0, output=tribo.Output(samples=3))
    names = ["tip.W", "tip.stage_work"]
    data = tribo.sensitivity(scene, names, ["tip.drive.speed"], accuracy=1e-6)
    assert "tip.stage_work have no error estimates" in data.attrs["notes"]


def test_averages_without_an_interval_have_no_derivative():
    """Which is said, and what would do: the runs end as they should."""
    tip = Surface(
        "tip",
        asperite=Asperite(kappa=np.inf),
        drive=tribo.Pulled(stiffness=0.5, speed=0.1),
        langevin=tribo.Langevin(0.5),
    )
    field = tribo.Field(tribo.Corrugation(0.1, 1.0), on=["tip"])
    output = tribo.Output(samples=5, series=("forces",))
    scene = Scene([tip], [], 4.0, fields=[field], output=output)
    with pytest.raises(InputError, match=r'error of "tip\.pull_force" is not known; .* longer run'):
        tribo.sensitivity(scene, ["tip.pull_force"], ["field.amplitude"], accuracy=1e-6)
