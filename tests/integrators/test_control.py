"""Steps and lanes: how many equal steps there are, how a step grows, which member takes a lane."""

import math

import numpy as np
import pytest

from tribo.integrators import step_control as control
from tribo.integrators.methods import METHODS
from tribo.integrators.step_control import MIN_GROWTH, SAFETY, count_of_steps, growth_factor
from tribo.kernels.records import CLOCK
from tribo.lanes.refill import leave_member, next_member, queue_of


@pytest.mark.parametrize("step", [0.1, 0.3, 1.0, 7.0])
def test_as_few_equal_steps_as_the_longest_allows(step):
    """By trial: one fewer would be longer than allowed; round-off adds none."""
    for time in (*np.arange(1.0, 40.0), *(step * np.arange(1, 40))):
        fewest = next(n for n in range(1, 1000) if time / n <= step * (1.0 + 1e-8))
        assert count_of_steps(time, step) == fewest
    assert np.array_equal(count_of_steps(step * np.arange(1.0, 9.0), step), np.arange(1, 9))


@pytest.mark.parametrize("name", [name for name, method in METHODS.items() if method.adaptive])
def test_growth_of_a_step(name, monkeypatch):
    """An error that grows as h^order is SAFETY^order after the next step; bounds hold."""
    monkeypatch.setattr(control, "within_bounds", control.within_bounds.py_func)
    method = METHODS[name].coefficients
    order = method.order
    most = method.most_growth
    growth = growth_factor.py_func
    for error in (0.01, 0.3, 1.0, 3.0):
        factor = growth(error, order, most)
        assert factor == most or error * factor**order == pytest.approx(SAFETY**order)
    assert growth(0.0, order, most) == most == growth(1e-300, order, most)
    assert growth(1e300, order, most) == MIN_GROWTH == growth(math.nan, order, most)
    assert growth(math.inf, order, most) == 0.5


def test_growth_by_roots(monkeypatch):
    """As by powers, where an error grows as a power of h that is one of 2."""
    monkeypatch.setattr(control, "within_bounds", control.within_bounds.py_func)
    for roots in (3, 4):
        for error in (1e-300, 0.01, 0.3, 1.0, 3.0, 1e300, math.nan):
            by_powers = growth_factor.py_func(error, 2**roots, 4.0)
            by_roots = control.growth_by_roots.py_func(error, roots, SAFETY, 4.0)
            assert by_roots == pytest.approx(by_powers, rel=1e-14, abs=0.0)


def test_which_steps_are_taken(monkeypatch):
    """Those of an error of 1 at most, whose end is finite and before the next encounter."""
    monkeypatch.setattr(control, "reject_step", control.reject_step.py_func)
    check_error = control.check_error.py_func
    check_arrival = control.check_arrival.py_func
    for error in (0.0, 1.0, 1.001, math.inf, math.nan):
        clock = np.zeros(1, CLOCK).view(np.recarray)[0]
        assert check_error(clock, 0.5, error, 0.25) is (error <= 1.0)
        assert (clock.h, clock.rejected) == ((0.0, 0) if error <= 1.0 else (0.125, 1))
    for rate, finite in ((0.0, True), (2.0, True), (2.001, True), (math.nan, True), (0.0, False)):
        clock = np.zeros(1, CLOCK).view(np.recarray)[0]
        taken = finite and rate <= 2.0
        assert check_arrival(clock, 0.5, rate, finite) is taken
        assert clock.encounter_rate == (rate if taken else 0.0)
        assert (clock.h, clock.rejected) == ((0.0, 0) if taken else (0.25, 1))


def test_lanes_take_members_in_order():
    """Each member has one lane, for as long as it runs, and none is left."""
    queue = queue_of(20, 3)
    lanes = 3
    rng = np.random.default_rng(1)
    left = rng.integers(1, 9, 20)
    length = left.copy()
    begun = []
    while queue.waiting[0] < 20 or np.any(queue.held >= 0):
        for lane in range(lanes):
            if queue.held[lane] < 0:
                member = next_member.py_func(queue, lane)
                assert member == queue.held[lane] or member == -1
                begun += [int(member)] if member >= 0 else []
        for lane, member in enumerate(queue.held):
            if member >= 0:
                left[member] -= 1
                if left[member] == 0:
                    leave_member.py_func(queue, lane, 1, length[member], 9 * length[member])
    assert begun == list(range(20)) and not left.any()
    assert np.array_equal(queue.counts, np.column_stack([np.ones(20), length, 9 * length]))
