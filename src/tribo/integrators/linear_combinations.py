"""Linear combinations of derivatives, of which the steps of most methods consist.

Sizes of all arrays are whole packs of lanes.
"""

from tribo.compiler.jit import inlined, kernel
from tribo.compiler.lanes import LANES, absolute, broadcast, where_less
from tribo.compiler.lanes_memory import pack, set_pack
from tribo.compiler.numbers_in_lanes import largest_of_runs, sum_of_runs
from tribo.integrators.step_control import EPSILON


@inlined
def weighted_sum(weights, derivatives, m):
    """sum_j weights_j rates_j of a pack."""
    total = weights[0] * pack(derivatives[0], m)
    for j in range(1, weights.size):
        total = total + weights[j] * pack(derivatives[j], m)
    return total


@inlined
def increase(x, low, m, step):
    """Add to a pack of x, with the rounding error kept in `low`."""
    before = pack(x, m)
    whole = step + pack(low, m)
    new = before + whole
    set_pack(low, m, whole - (new - before))
    set_pack(x, m, new)


@kernel
def combine(y, h, row, derivatives, out):
    """out = y + h sum_j row_j rates_j."""
    for m in range(0, y.size, LANES):
        set_pack(out, m, pack(y, m) + h * weighted_sum(row, derivatives, m))


@kernel
def combine_twice(q, h, c, v, row, derivatives, out):
    """out = q + c h v + h^2 sum_j row_j rates_j."""
    for m in range(0, q.size, LANES):
        change = c * pack(v, m) + h * weighted_sum(row, derivatives, m)
        set_pack(out, m, pack(q, m) + h * change)


@kernel
def add(x, low, h, weights, derivatives):
    """x += h sum_j weights_j rates_j, with the rounding error kept in `low`."""
    for m in range(0, x.size, LANES):
        increase(x, low, m, h * weighted_sum(weights, derivatives, m))


@kernel
def add_twice(q, low, h, v, v_low, weights, derivatives):
    """q += h (v + v_low) + h^2 sum_j weights_j rates_j, with the rounding error kept in `low`."""
    for m in range(0, q.size, LANES):
        change = pack(v_low, m) + h * weighted_sum(weights, derivatives, m)
        increase(q, low, m, h * (pack(v, m) + change))


@kernel
def largest(h, weights, derivatives, scale_of, tolerance):
    """Largest |h sum_j weights_j rates_j| in units of the tolerance (never below round-off).

    That of all lanes, or of each where h is that of each; nan where a rate is not finite.
    """
    worst = broadcast(0.0)
    not_finite = broadcast(0.0)
    for m in range(0, scale_of.size, LANES):
        unit = pack(tolerance, m) + 2.0 * EPSILON * absolute(pack(scale_of, m))
        error = absolute(h * weighted_sum(weights, derivatives, m)) / unit
        worst = where_less(worst, error, error, worst)
        not_finite = not_finite + (error - error)  # nan for inf and nan
    return largest_of_runs(h, worst) + sum_of_runs(h, not_finite)
