"""Declared orders, of motion and ledger; and the paper's own scheme, step by step."""

from dataclasses import replace
from unittest import mock

import numpy as np
import pytest

import tribo
from support.everything import everything
from tribo import Output
from tribo.integrators.methods import METHODS
from tribo.integrators.step_control import Tolerance
from tribo.layout.layout import lay_out
from tribo.loops.select import Integrator
from tribo.loops.setting import Setting
from tribo.paper import scene as case

END = 4.0
# In how many equal steps each method goes there, and by how much its slope may fall short.
COUNTS = {
    "midpoint": ((40, 80, 160, 320), 0.1),
    "rk4": ((20, 40, 80, 160), 0.2),
    "dop853": ((20, 28, 40, 56), 0.5),
    "rkn8": ((14, 20, 28, 40), 1.0),
    "rkn12": ((8, 9, 10, 12, 14), 1.5),
    "gauss-radau-15": ((6, 7, 8, 9, 10), 2.5),
    "gauss-8": ((16, 20, 24, 28, 32), 1.0),
    "verlet": ((40, 80, 160, 320), 0.1),
    "kahan-li-6": ((20, 28, 40, 56), 0.3),
    "kahan-li-8": ((14, 16, 20, 24, 28), 1.0),
    "blanes-moan-6": ((20, 28, 40, 56), 0.5),
}
# The level of tolerances at which no error counts that depends on it; 0 has no first step.
NO_LEVEL = 1e-300
ACCOUNTS = ("contact", "slide", "drive", "ends", "internal", "field")


def in_steps(layout, method, count):
    """The state and the accounts after `count` equal steps.

    A method that chooses its steps is given a sample after each, and no reason for more: no
    tolerance, or, where it iterates, one of round-off that no error is compared with.
    """
    times = END / count * np.arange(1, count + 1)
    setting = Setting(step=END / count)
    if method.adaptive:
        iterates = method.remembers > 0
        y, s = (np.full(n, 1e-15 if iterates else np.inf) for n in sizes(layout))
        setting = Setting(tolerance=Tolerance(y, s, NO_LEVEL))
    with mock.patch("tribo.loops.select.first_step", return_value=np.inf):
        integrator = Integrator(layout, method)
    run = integrator(setting, times)
    assert (run.status, run.steps) == ("completed", count)
    return run.samples.y[-1], run.samples.s[-1]


def sizes(layout):
    """Of y and of s."""
    return layout.start.size, layout.accounts


def families(layout):
    """Slots of the accounts of each kind, over all asperites."""
    widths = {"contact": 4, "slide": 2, "drive": 4, "ends": 5, "internal": 4, "field": 4}
    assert widths.keys() == set(ACCOUNTS)
    for name, width in widths.items():
        first = layout.asperites[f"acc_{name}"]
        stride = layout.asperites.stride
        present = first >= 0
        if np.any(present):
            yield name, (first[:, None] + stride[:, None] * np.arange(width))[present].ravel()
    blocks = layout.surfaces.acc_block
    yield "block", blocks[blocks >= 0]
    yield "moving", np.array([field.account for field in layout.model.fields])


# Mass of an oscillator [mass].
HEAVY = 0.2
# One that is too light to act, for methods that refuse a bath.
LIGHT = 1e-30


@pytest.fixture(scope="module")
def exact():
    """The end of `everything` for either mass, as round-off allows."""

    def end(mass):
        return in_steps(lay_out(everything(END, mass=mass)), METHODS["kahan-li-8"], 120)

    return {mass: end(mass) for mass in (HEAVY, LIGHT)}


# Methods whose step another one shares, with other coefficients; the slow set has them.
ALIKE = ("rk4", "rkn12", "kahan-li-8", "blanes-moan-6")
NAMES = [pytest.param(m, marks=[pytest.mark.slow] * (m in ALIKE)) for m in METHODS]


@pytest.mark.parametrize("name", NAMES)
def test_order_of_motion_and_ledger(exact, name):
    """Errors fall as the declared power of the step: of the motion, and of accounts of any kind."""
    method = METHODS[name]
    mass = LIGHT if "bath" in method.refuses else HEAVY
    layout = lay_out(everything(END, mass=mass))
    counts, slack = COUNTS[name]
    y, s = exact[mass]
    ends = [in_steps(layout, method, count) for count in counts]
    errors = {"motion": [np.max(np.abs(one[0] - y)) for one in ends]}
    for family, slots in families(layout):
        errors[family] = [np.max(np.abs(one[1] - s)[slots]) for one in ends]
    assert {"motion", "block", "moving", *ACCOUNTS} <= errors.keys()
    for family, error in errors.items():
        slope = -np.polyfit(np.log(counts), np.log(error), 1)[0]
        assert slope > method.order - slack, family


STEPS = 0.01 / 2.0 ** np.arange(5)
ENDS = {"A": 26.0, "C": 32.0}  # soon after the encounter, when everything is still in motion


def at_end(name, **how):
    """theta and w1 of the upper asperite."""
    scene = replace(case(name), duration=ENDS[name], output=Output(samples=2))
    upper = tribo.simulate(scene, **how)["upper"]
    return np.array([upper.theta[-1, 0], upper.w1[-1, 0]])


@pytest.mark.parametrize("name", ENDS)
def test_midpoint_is_of_second_order(name):
    """Over four halvings of the step the errors fall as its square."""
    exact = at_end(name, accuracy=1e-12)
    errors = [np.abs(at_end(name, method="midpoint", step=h) - exact) for h in STEPS]
    for error in np.transpose(errors):
        slope = np.polyfit(np.log(STEPS), np.log(error), 1)[0]
        assert slope == pytest.approx(2.0, abs=0.05)


def by_hand(scene, steps):
    """The paper's scheme for two asperites, force by force in the laboratory.

    One row an asperite, upper first.  Returns theta, v_cm, and the works and pseudoworks.
    """
    h = scene.duration / steps
    each = [
        s.asperite.for_each(1) | {"rest": s.rest, "sign": s.facing_sign} for s in scene.surfaces
    ]
    p = {key: np.array([float(np.squeeze(e[key])) for e in each]) for key in each[0]}
    forced = np.array([type(s.drive).__name__ == "Forced" for s in scene.surfaces])
    strength = scene.interactions[0].potential.strength
    bobs = np.array([s.bob for s in scene.surfaces])

    def up(angle, length):  # from the bob towards the bar
        return length[:, None] * np.stack([-np.sin(angle), np.cos(angle)], axis=1)

    def turning(rate, arm):  # velocity of the end of an arm
        return rate[:, None] * np.stack([-arm[:, 1], arm[:, 0]], axis=1)

    def look(y):
        """Rates of change of the state, and the powers of f1, f2, fL, fR at v and at v_cm."""
        r = y[:, :2]
        v = y[:, 2:4]
        theta = y[:, 4]
        omega = y[:, 5]
        bob = -up(theta, p["l1"])
        bar = up(theta, p["l2"])
        apart = (r + bob)[0] - (r + bob)[1]
        push = strength * apart / np.hypot(*apart) ** 3
        f1 = np.array([push, -push])
        f2 = -f1 * np.stack([forced, np.ones(2)], axis=1)
        torque = p["kappa"] * (theta - p["rest"])
        left = np.stack([np.zeros(2), torque / p["bar_length"]], axis=1)  # phi = nu = 0
        moment = bob[:, 0] * f1[:, 1] - bob[:, 1] * f1[:, 0] + bar[:, 0] * f2[:, 1]
        moment += -bar[:, 1] * f2[:, 0] - torque
        rates = [
            v,
            (f1 + f2) / p["mass"][:, None],
            omega[:, None],
            (moment / p["inertia"])[:, None],
        ]
        at_bob = v + turning(omega, bob)
        at_bar = v + turning(omega, bar)
        pairs = [(f1, at_bob), (f2, at_bar), (left, at_bar), (-left, at_bar), (f1, v), (f2, v)]
        return np.hstack(rates), np.array([np.sum(f * u, axis=1) for f, u in pairs])

    rest = np.zeros(2) + p["rest"]
    y = np.column_stack(
        [bobs + up(rest, p["l1"]), [s.velocity for s in scene.surfaces], rest, rest]
    )
    y[:, 5] = 0.0
    works = np.zeros((6, 2))
    for _ in range(steps):
        rates, powers = look(y + 0.5 * h * look(y)[0])
        y = y + h * rates
        works = works + h * powers
    return (
        y[:, 4],
        y[:, 2:4],
        dict(zip(["w1", "w2", "wL", "wR", "w1_ps", "w2_ps"], works, strict=True)),
    )


@pytest.mark.parametrize("name", "ABCDE")
def test_midpoint_is_the_scheme_of_the_paper(name):
    """Angles, velocities, and every work are those of the scheme written out, to round-off."""
    steps = 500
    start = {s.name: s for s in case(name).surfaces}
    nearer = replace(start["upper"], bob=(-1.0, 0.0))
    scene = replace(
        case(name),
        surfaces=(nearer, start["lower"]),
        duration=5.0,
        output=Output(samples=2),
    )
    result = tribo.simulate(scene, method="midpoint", step=scene.duration / steps)
    assert result.cost.steps == steps
    theta, velocity, works = by_hand(scene, steps)
    for k, surface in enumerate(("upper", "lower")):
        end = {key: values[-1] for key, values in result[surface].items()}
        assert end["theta"] == pytest.approx(theta[k], abs=1e-12)
        assert end["vx_cm"] == pytest.approx(velocity[k, 0], abs=1e-12)
        assert end["vy_cm"] == pytest.approx(velocity[k, 1], abs=1e-12)
        for key, values in works.items():
            assert end[key] == pytest.approx(values[k], abs=1e-12), key
        assert end["w"] == pytest.approx(sum(works[w][k] for w in ("w1", "w2", "wL", "wR")))
