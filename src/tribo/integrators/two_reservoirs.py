"""Reservoirs on a bar and on its swing at once: the exact motion along the arc of the rod.

The velocity of the centre of mass along the arc and the rate of the swing are coupled, since
friction on the bar acts on both.  In the coordinates w = (sqrt(M) v, sqrt(I) omega) the matrix of
friction is symmetric, and each of its two eigenmodes moves as a single damped velocity; see
:func:`damped_motion`.  At one temperature their noises are independent.  At two they are not, as
heat then flows from one reservoir through the pendulum to the other; see :func:`correlated`.
"""

from tribo.compiler.jit import inlined
from tribo.compiler.lanes import sqrt, where_less
from tribo.kernels.langevin import damped_motion, damping_of, decay_means, spread_of_travel

# What no rate of damping is smaller than; lanes without an asperite have none.
TINY = 1e-300
# Damping of a step, below which the overlap of noises is taken there: its error is of this order.
WEAK = 1e-5
# Least share of a deviate of its own, in the deviate that is built from it and two others.
LEAST_SHARE = 1e-8


@inlined
def modes_of_friction(on_bar, on_swing, arm):
    """Eigenmodes of the friction [[a, -a r], [-a r, a r^2 + k]].

    `on_bar` and `on_swing` are a = gamma / M and k = gamma / I of the two reservoirs [1 / time],
    and `arm` is r = l2 sqrt(M / I).  Returns the eigenvalues of the modes (c, -s) and (s, c), c and
    s.
    """
    across = on_bar * arm
    other = across * arm + on_swing
    half = 0.5 * (on_bar - other)
    root = sqrt(half * half + across * across) + TINY
    fast = 0.5 * (on_bar + other) + root
    larger = sqrt(0.5 * (1.0 + where_less(half, 0.0, -half, half) / root))
    smaller = 0.5 * across / (root * larger)
    c = where_less(half, 0.0, smaller, larger)
    s = where_less(half, 0.0, larger, smaller)
    return fast, on_bar * on_swing / fast, c, s


@inlined
def norms(z):
    """Norms of a mode's velocity, and of its travel without the part that goes with the velocity.

    They are functions of the time s that is left when the noise acts, of the step [1]: the velocity
    exp(-z s), the travel (1 - exp(-z s)) / z.  Returns the mean of the velocity, the part of it in
    the travel, and the two norms.
    """
    kept, mean, _ = decay_means(z)
    part = mean / (1.0 + kept)
    rest = spread_of_travel(0.5 * z, 2.0 * part) / (2.0 * z)
    return mean, part, sqrt(0.5 * mean * (1.0 + kept)), sqrt(rest)


@inlined
def correlated(z, other_z, correlation, deviates):
    """Deviates for the velocities and travels of two modes whose noises are correlated.

    The covariances are the overlaps of the functions in :func:`norms`, times `correlation`.
    `deviates` are four independent ones; those of the first mode stay.
    """
    first, second, third, fourth = deviates
    z = where_less(z, WEAK, WEAK, z)
    other_z = where_less(other_z, WEAK, WEAK, other_z)
    mean, part, norm, rest = norms(z)
    other_mean, other_part, other_norm, other_rest = norms(other_z)
    _, velocities, _ = decay_means(z + other_z)
    velocity_travel = (mean - velocities) / other_z
    travel_velocity = (other_mean - velocities) / z
    travels = (1.0 - mean - other_mean + velocities) / (z * other_z)
    travels = travels - part * velocity_travel - other_part * travel_velocity
    travels = travels + part * other_part * velocities
    # Correlations of velocity (v) and travel (t) of the first mode with those of the other.
    vv = correlation * velocities / (norm * other_norm)
    vt = correlation * (velocity_travel - other_part * velocities) / (norm * other_rest)
    tv = correlation * (travel_velocity - part * velocities) / (rest * other_norm)
    tt = correlation * travels / (rest * other_rest)
    own = positive_root(1.0 - vv * vv - tv * tv)
    shared = 0.0 - (vv * vt + tv * tt) / where_less(own, LEAST_SHARE, LEAST_SHARE, own)
    last = positive_root(1.0 - vt * vt - tt * tt - shared * shared)
    velocity = vv * first + tv * second + own * third
    return velocity, vt * first + tt * second + shared * third + last * fourth


@inlined
def positive_root(x):
    """The square root, 0 of what rounding made negative."""
    return sqrt(where_less(x, 0.0, 0.0, x))


@inlined
def damped_arc(rates, temperatures, masses, lever, velocities, gains, tau, deviates):
    """What friction and noise do in a step to a bar and its swing along the arc.

    `rates` are gamma / M and gamma / I [1 / time], `masses` M and I, `lever` l2.
    `velocities` are those of the centre of mass relative to the reservoir, and of the swing, in the
    middle of the kick; `gains` is what all other forces add to them in the step.

    Returns the momentum that the reservoir at the bar gives, the angular momentum that the other
    gives, the displacements of centre of mass and angle that the drifts leave out, and the heat
    given to the reservoir on the swing.
    """
    on_bar, on_swing = rates
    root_mass = sqrt(masses[0])
    root_inertia = sqrt(masses[1])
    temperature, other = temperatures
    arm = lever * root_mass / root_inertia
    fast, slow, c, s = modes_of_friction(on_bar, on_swing, arm)
    # Of the modes: slip of the bar and of the swing, strength of the noise, its correlation.
    bar = c + s * arm
    slow_bar = s - c * arm
    strength = temperature * on_bar * bar * bar + other * on_swing * s * s
    slow_strength = temperature * on_bar * slow_bar * slow_bar + other * on_swing * c * c
    both = (temperature - other) * on_swing * c * s
    correlation = both / (sqrt(strength * slow_strength) + TINY)
    first, second, _, _ = deviates
    third, fourth = correlated(tau * fast, tau * slow, correlation, deviates)
    v = root_mass * velocities[0]
    omega = root_inertia * velocities[1]
    gain = root_mass * gains[0]
    turn = root_inertia * gains[1]
    w = c * v - s * omega
    gained = c * gain - s * turn
    slow_w = s * v + c * omega
    slow_gained = s * gain + c * turn
    damping = damping_of(fast, strength / (fast + TINY), 1.0, tau)
    change, jump = damped_motion(damping, 1.0, w, gained, tau, first, second)
    slow_damping = damping_of(slow, slow_strength / (slow + TINY), 1.0, tau)
    slow_change, slow_jump = damped_motion(
        slow_damping, 1.0, slow_w, slow_gained, tau, third, fourth
    )
    # The integrals of products of w follow from their changes, up to noise without a mean:
    # d(w_a w_b) = (2 D_ab - (g_a + g_b) w_a w_b + F_a w_b + F_b w_a) dt.  Over the step, with
    # F = gained / tau, the integral of w is tau middle + jump, and w changes by gained + change:
    # g int w^2 dt = D tau + F int w dt - (gained + change) middle, which are `squares`.
    rate = 1.0 / tau
    middle = w + 0.5 * change
    slow_middle = slow_w + 0.5 * slow_change
    squares = rate * gained * jump - change * middle + tau * strength
    slow_squares = rate * slow_gained * slow_jump - slow_change * slow_middle + tau * slow_strength
    products = rate * (gained * slow_jump + slow_gained * jump) + 2.0 * tau * both
    products = products - change * slow_middle - slow_change * middle
    heat = s * s * squares / (fast + TINY) + c * c * slow_squares / (slow + TINY)
    heat = on_swing * (heat - 2.0 * c * s * products / (fast + slow + TINY) - tau * other)
    impulse = root_mass * (c * change + s * slow_change)
    turning = root_inertia * (c * slow_change - s * change) + lever * impulse
    along = (c * jump + s * slow_jump) / root_mass
    return impulse, turning, along, (c * slow_jump - s * jump) / root_inertia, heat
