"""Sums over the nodes of a step: the ends of the motion and of the accounts, and their errors."""

from typing import Any, NamedTuple

from tribo.compiler.jit import inlined
from tribo.compiler.lanes import (
    LANES,
    absolute,
    lane,
    maximum,
    sum_of_lanes,
    sums_of_lanes,
    with_lane,
)
from tribo.compiler.lanes_memory import load, store
from tribo.integrators.step_control import EPSILON
from tribo.pair import step_rows as rows
from tribo.pair.step_rows import V1, V2, J


class Sums(NamedTuple):
    """Integrals over a step of length 1: three numbers each for q1, q2 and k, Lanes of accounts."""

    twice: Any  # q'' integrated twice
    once: Any  # q'' integrated once
    leading: Any  # the highest term of q'', integrated once
    gains: Any  # of the accounts
    leading_gains: Any  # of the highest terms of the powers


@inlined
def weighted_sums(work, first, f):
    """sum_j a_ij f_j in lane i; `first` is the row of a_i0."""
    one = load(work, first) * lane(f, 0) + load(work, first + 4) * lane(f, 4)
    two = load(work, first + 1) * lane(f, 1) + load(work, first + 5) * lane(f, 5)
    three = load(work, first + 2) * lane(f, 2) + load(work, first + 6) * lane(f, 6)
    four = load(work, first + 3) * lane(f, 3) + load(work, first + 7) * lane(f, 7)
    return (one + two) + (three + four)


@inlined
def weighted_sum(weights, work, row):
    """sum_j w_j f_j, with the eight f_j in a row."""
    w0, w1, w2, w3, w4, w5, w6, w7 = weights
    one = w0 * work[row, 0] + w4 * work[row, 4]
    two = w1 * work[row, 1] + w5 * work[row, 5]
    three = w2 * work[row, 2] + w6 * work[row, 6]
    four = w3 * work[row, 3] + w7 * work[row, 7]
    return (one + two) + (three + four)


@inlined
def powers(h, work, nodes):
    """Account by account, at the nodes; those at the end of the step in lane 0."""
    contact = nodes.contact
    omega1 = work[rows.PLACE, V1] + h * weighted_sums(work, rows.R, nodes.f[0])
    omega2 = work[rows.PLACE, V2] + h * weighted_sums(work, rows.R, nodes.f[1])
    j = work[rows.PLACE, J] + h * weighted_sums(work, rows.R, nodes.f[2])
    return (
        contact.fy,
        contact.fx * omega1 * contact.cos1,
        contact.fy * omega1 * contact.sin1,
        contact.fx * omega2 * contact.cos2,
        contact.fy * omega2 * contact.sin2,
        nodes.q1,
        nodes.q2,
        contact.fx * j,
    )


@inlined
def end_values(power):
    """Lane 0 of each account."""
    first = power[0]
    for account in range(1, LANES):
        first = with_lane(first, account, lane(power[account], 0))
    return first


@inlined
def weighted(w, power):
    """The powers of all accounts with weights."""
    p0, p1, p2, p3, p4, p5, p6, p7 = power
    return w * p0, w * p1, w * p2, w * p3, w * p4, w * p5, w * p6, w * p7


@inlined
def sums_of(work, nodes, power):
    """Integrals over a step of the polynomials through the nodes."""
    b = load(work, rows.B)
    v = load(work, rows.V)
    last = load(work, rows.LAST)
    f1, f2, fk = nodes.f
    motion = sums_of_lanes((b * f1, b * f2, b * fk, v * f1, v * f2, v * fk, last * f1, last * f2))
    twice = lane(motion, 0), lane(motion, 1), lane(motion, 2)
    once = lane(motion, 3), lane(motion, 4), lane(motion, 5)
    ends = lane(motion, 6), lane(motion, 7), sum_of_lanes(last * fk)
    at_start = load(work, rows.BEGINNING)
    within = with_lane(v, 0, 0.0)
    rest = with_lane(last, 0, 0.0)
    gains = sums_of_lanes(weighted(within, power)) + lane(v, 0) * at_start
    high = sums_of_lanes(weighted(rest, power)) + lane(last, 0) * at_start
    return Sums(twice, once, ends, gains, high)


@inlined
def tolerance_of(work, m):
    """The tolerance of the rate of q1, q2 or k, which is never below round-off."""
    return work[rows.LIMITS, m] + 2.0 * EPSILON * abs(work[rows.PLACE, V1 + m])


@inlined
def error_of(h, work, sums):
    """The largest integral of a highest term over its tolerance."""
    one = abs(h * sums.leading[0]) / tolerance_of(work, 0)
    two = abs(h * sums.leading[1]) / tolerance_of(work, 1)
    three = abs(h * sums.leading[2]) / tolerance_of(work, 2)
    return max(max(one, two), three) + maximum(
        h * absolute(sums.leading_gains) * load(work, rows.ALLOWED)
    )


@inlined
def compensated_sum(x, low, step):
    """x + low + step, and its rounding error."""
    step = step + low
    new = x + step
    return new, step - (new - x)


@inlined
def update_state(h, work, sums):
    """Advance places, rates and accounts to the end of the step, with their rounding errors."""
    for m in range(3):
        rate = work[rows.PLACE, m + 3] + (work[rows.LOW, m + 3] + h * sums.twice[m])
        new = compensated_sum(work[rows.PLACE, m], work[rows.LOW, m], h * rate)
        work[rows.PLACE, m], work[rows.LOW, m] = new
        new = compensated_sum(work[rows.PLACE, m + 3], work[rows.LOW, m + 3], h * sums.once[m])
        work[rows.PLACE, m + 3], work[rows.LOW, m + 3] = new
    accounts = load(work, rows.ACCOUNTS)
    low = load(work, rows.REMAINDERS)
    accounts, low = compensated_sum(accounts, low, h * sums.gains)
    store(work, rows.ACCOUNTS, accounts)
    store(work, rows.REMAINDERS, low)
