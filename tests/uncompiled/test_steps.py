"""Errors and lengths of steps, the rounding of time, and when a loop stops."""

import math
from types import SimpleNamespace
from typing import NamedTuple
from unittest import mock

import numpy as np
import pytest

import tribo
from support.uncompiled.ledger import ALL, scene_of, simulate
from support.uncompiled.pair import registers_as_arrays
from support.uncompiled.start import start_of
from tribo.integrators.linear_combinations import largest
from tribo.integrators.methods import METHODS
from tribo.integrators.step_control import Tolerance
from tribo.kernels.encounters import closing_speed
from tribo.kernels.status import STATUS_OF_CODE
from tribo.layout.layout import lay_out
from tribo.loops.general import GeneralLoop
from tribo.loops.setting import Setting
from tribo.pair import step, step_sums
from tribo.pair import step_rows as rows

EPSILON = np.finfo(float).eps


def test_errors():
    """The error of a step is in units of the tolerance, or of the round-off of large values."""
    rng = np.random.default_rng(1)
    weights = rng.normal(size=4)
    rates = rng.normal(size=(4, 16))
    values = np.zeros(16)
    tolerance = np.full(16, 1e-3)
    values[1:3] = (-1e10, 3e9)
    tolerance[1:3] = 1e-6
    for component in (0, 1, 2, 15):
        only = np.arange(16) == component
        found = largest(0.5, weights, rates * only, values, tolerance)
        unit = tolerance[component] + 2.0 * EPSILON * abs(values[component])
        assert np.isclose(found, 0.5 * abs(weights @ rates[:, component]) / unit, 1e-12)
        infinite = np.where(only, np.inf, rates)
        assert not np.isfinite(largest(0.5, weights, infinite, values, tolerance))


def test_closing_speeds():
    """Two surfaces close in at the diagonal of their velocities, and two swings at most."""
    rng = np.random.default_rng(2)
    surfaces = [
        SimpleNamespace(start=start, end=end, stop=stop)
        for start, end, stop in ((0, 8, 8), (8, 19, 24), (32, 34, 40))
    ]
    model = SimpleNamespace(surfaces=surfaces)
    every = [*range(8, 19), 32, 33]

    def some(active: list[int], first: list[int]) -> SimpleNamespace:
        return SimpleNamespace(packs=np.array(active), first=first)

    none = some([0], [0, 1, 1, 1])
    assert closing_speed(model, none, (1, 2), np.ones((3, 48))) == 0.0
    for sign, active, columns in (
        (1.0, None, every),
        (-1.0, None, every),
        (1.0, some([0, 1, 4], [0, 1, 2, 3]), [*range(8, 16), 32, 33]),
        (-1.0, some([4], [0, 0, 0, 1]), [32, 33]),
    ):
        speeds = np.full((3, 48), 1e3)  # of other surfaces
        own = rng.normal(2.0 * sign, 1.0, (3, len(columns)))
        own[2] = np.abs(own[2])
        speeds[:, columns] = own
        expected = np.hypot(*np.ptp(own[:2], axis=1)) + 2.0 * np.max(own[2])
        assert np.isclose(closing_speed(model, active, (1, 2), speeds), expected, 1e-12)


def test_errors_of_a_pair():
    """The error of a pair's step: the worst rate's, and that of the worst account."""
    rng = np.random.default_rng(4)
    work = rng.uniform(1e-6, 1e-5, (rows.ROWS, 8))
    work[rows.PLACE] = 1e10 * rng.normal(size=8)
    places = (rows.V1, rows.OF_V1), (rows.V2, rows.OF_V2), (rows.J, rows.OF_J)
    units = [
        work[rows.LIMITS, limit] + 2.0 * EPSILON * abs(work[rows.PLACE, rate])
        for rate, limit in places
    ]
    for worst in range(3):
        leading = np.where(np.arange(3) == worst, -1.0, 1e-3)
        gains = rng.normal(size=8)
        sums = SimpleNamespace(leading=leading, leading_gains=gains)
        with registers_as_arrays():
            found = step_sums.error_of(0.5, work, sums)
        accounts = np.max(0.5 * abs(gains) * work[rows.ALLOWED])
        assert np.isclose(found, np.max(0.5 * abs(leading) / units) + accounts, 1e-12)


@pytest.mark.parametrize(("rate", "later"), [(0.2, 0.8), (0.6, 0.8), (0.8, 0.8), (1.2, 0.8)])
def test_steps_of_a_pair_towards_encounters(rate, later):
    """A pair's next step goes 3/4 of the way by the rate that will have grown as much again.

    By the rate at its start it goes the part that the clock allows.
    """
    clock = SimpleNamespace(encounter_fraction=0.5)
    length = 0.5
    rest = SimpleNamespace(square=np.zeros(8))
    nodes = step.Nodes((np.zeros(8),) * 3, np.zeros(8), np.zeros(8), rest)
    others = {
        "solve": lambda *_: (True, nodes),
        "powers": lambda *_: None,
        "end_values": lambda *_: np.zeros(8),
        "sums_of": lambda *_: SimpleNamespace(once=(0.0, 0.0, 0.0)),
        "error_of": lambda *_: 0.0,
        "update_state": lambda *_: None,
        "encounter_rate_of": lambda *_: later,
    }
    with registers_as_arrays(), mock.patch.multiple(step, **others):
        work = np.zeros((rows.ROWS, 8))
        _, growth, _ = step.try_step(None, None, clock, length, rate, 1.0, work)
    longest = clock.encounter_fraction / later
    if later > rate:
        longest = min(longest, 0.75 / (later + (later - rate)))
    assert np.isclose(growth * length, longest, 1e-12)


@pytest.mark.parametrize("scene", ["slid", "pulled", "slid, slowly"])
def test_encounters(scene):
    """A first step is refused if a pair of bobs can cover its distance in it, and no other.

    Bobs that interact by 1 / r change their force over their distance.
    """
    table = ALL[scene]
    start = start_of(table)
    swing = np.hypot(start.omega, start.frequency * start.twist)
    first, second = np.triu_indices(start.omega.size, 1)
    speed = np.hypot(*(start.velocity[:, first] - start.velocity[:, second]))
    speed += (start.arm * swing)[first] + (start.arm * swing)[second]
    places = np.vstack([start.bob, start.depth])
    distance = np.linalg.norm(places[:, first] - places[:, second], axis=0)
    rate = np.max((speed / distance)[touching(table, start, first, second)])
    for part in (0.99, 1.01):
        h = part / rate
        run = tribo.simulate(scene_of(table | {"duration": 4.0 * h}), method="midpoint", step=h)
        assert (run.cost.steps == 0) == (part > 1.0), f"{part} of the longest step"


def touching(table, start, first, second):
    """Which pairs of bobs have a contact, in a scene whose contacts are of all species."""
    contacts = table["interaction"]
    contacts = [contacts] if isinstance(contacts, dict) else contacts
    names = [surface["name"] for surface in table["surface"]]
    of = np.repeat(names, start.counts)
    met = of[first] != of[second]
    for contact in contacts:
        one, other = contact.get("between", names)
        met |= (of[first] == one) & (of[second] == other)
    return met


@pytest.mark.parametrize("method", ["midpoint", "verlet"])
def test_equal_steps(method):
    """Between two samples the steps are equal, and as few as the longest step allows."""
    table = ALL["slid"] | {"duration": 0.7, "output": {"samples": 3}}
    assert simulate(table, method=method, step=0.2).cost.steps == 4


def loop_of(method, setting, first_step=0.0):
    """The time loop of a method, and a function that takes steps and returns its status."""
    layout = lay_out(scene_of(ALL["slid"]))
    steps = Setting(step=setting)
    if METHODS[method].adaptive:
        sizes = layout.start.size, layout.accounts
        tolerance = Tolerance(*(np.full(size, setting) for size in sizes), setting)
        steps = Setting(tolerance=tolerance)
    loop = GeneralLoop(layout, METHODS[method], steps, layout.start, first_step)

    def advance(times, steps):
        return STATUS_OF_CODE.get(loop.advance(np.array(times), loop.room(len(times)), steps))

    return loop, advance


@pytest.mark.parametrize("method", ["midpoint", "verlet"])
def test_time_of_equal_steps(method):
    """After steps of 0.1 from t = 1000, the time and what rounding took from it are exact."""
    loop, advance = loop_of(method, 0.1)
    loop.clocks.t = 1000.0
    advance([1001.0], 5)
    (clock,) = loop.clocks
    assert clock.steps == 5
    assert abs((clock.t - 1000.5) + clock.t_low) <= 1e-16
    assert abs(clock.last_step - 0.1) <= 1e-15


@pytest.mark.parametrize(
    ("times", "status", "steps"), [([1.0], "StepUnderflow", 0), ([1e-17, 1.0], None, 1)]
)
def test_shortest_step(times, status, steps):
    """A step that is lost in the spacing of times stops the run, unless it ends at a sample."""
    loop, advance = loop_of("rkn8", 1e-3, first_step=1e-17)
    assert (advance(times, 1), loop.clocks.steps[0]) == (status, steps)


class NoValue(NamedTuple):
    """No force, but nan below a distance."""

    end: float

    def energy(self, r):
        """U(r)."""
        return 0.0 if r > self.end else math.nan

    def force(self, r):
        """-dU/dr."""
        return self.energy(r)


@pytest.mark.parametrize("end", [0.8, 0.95])
def test_first_value_that_is_not_finite(end):
    """Equal steps end with the first rate that is not finite, though the state still is.

    The middle of the fifth step is outside of the one distance, and within the other.
    """
    upper = tribo.Surface("upper", bob=(-2.0, 0.0), velocity=(1.0, 0.0))
    surfaces = (upper, tribo.Surface("lower", facing="up"))
    scene = tribo.Scene(surfaces, NoValue(end), 4.0, output=tribo.Output(samples=2))
    result = tribo.simulate(scene, method="midpoint", step=0.25)
    assert (result.status, result.cost.steps) == ("NotFinite", 5)
