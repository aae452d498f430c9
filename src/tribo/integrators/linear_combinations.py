"""Linear combinations of derivatives, of which the steps of most methods consist."""

from tribo.integrators.step_control import EPSILON
from tribo.kernels.compiled import kernel


@kernel
def combine(y, h, row, derivatives, out):
    """out = y + h sum_j row_j rates_j."""
    for m in range(y.size):
        out[m] = y[m]
    for j in range(row.size):
        if row[j] != 0.0:
            weight = h * row[j]
            for m in range(y.size):
                out[m] += weight * derivatives[j, m]


@kernel
def combine_twice(q, h, c, v, row, derivatives, out):
    """out = q + c h v + h^2 sum_j row_j rates_j."""
    for m in range(q.size):
        total = 0.0
        for j in range(row.size):
            total += row[j] * derivatives[j, m]
        out[m] = q[m] + h * (c * v[m] + h * total)


@kernel
def add(x, low, h, weights, derivatives):
    """x += h sum_j weights_j rates_j, with the rounding error kept in `low`."""
    for m in range(x.size):
        total = 0.0
        for j in range(weights.size):
            total += weights[j] * derivatives[j, m]
        step = h * total + low[m]
        new = x[m] + step
        low[m] = step - (new - x[m])
        x[m] = new


@kernel
def add_twice(q, low, h, v, v_low, weights, derivatives):
    """q += h (v + v_low) + h^2 sum_j weights_j rates_j, with the rounding error kept in `low`."""
    for m in range(q.size):
        total = 0.0
        for j in range(weights.size):
            total += weights[j] * derivatives[j, m]
        step = h * (v[m] + (v_low[m] + h * total)) + low[m]
        new = q[m] + step
        low[m] = step - (new - q[m])
        q[m] = new


@kernel
def largest(h, weights, derivatives, scale_of, tolerance):
    """Largest |h sum_j weights_j rates_j| in units of the tolerance (never below round-off)."""
    worst = 0.0
    for m in range(scale_of.size):
        total = 0.0
        for j in range(weights.size):
            total += weights[j] * derivatives[j, m]
        error = abs(h * total) / (tolerance[m] + 2.0 * EPSILON * abs(scale_of[m]))
        if not error <= worst:  # keeps nan
            worst = error
    return worst
