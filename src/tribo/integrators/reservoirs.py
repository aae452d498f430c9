"""Langevin reservoirs of splitting methods: friction and noise on bars and swings.

In every step, what friction and noise do to a degree of freedom is the exact solution under the
force that is constant over the step, torsion included; see :func:`damped_motion`.  The drifts
before and after the kick are those without friction, so the displacement of the step needs a jump;
see `jumps`.  Momentum then balances with the displacement d of the bar relative to the reservoir,

    m (v' - v) = F tau - gamma d + noise of variance 2 gamma T tau,

and the sum over steps makes the drift F / gamma and the diffusion T / gamma, for any gamma tau / m.
The reasons for this scheme are in docs/developers/methods.md.
"""

from typing import Any, NamedTuple

from tribo.compiler.generators import generator_at
from tribo.compiler.jit import apart, inlined
from tribo.compiler.lanes import LANES, broadcast, lane, where_less
from tribo.compiler.lanes_functions import sine_cosine
from tribo.compiler.lanes_memory import pack, set_pack
from tribo.integrators.bar_pushes import push_bars
from tribo.integrators.jumps import reservoirs_of, set_jump
from tribo.integrators.two_reservoirs import damped_arc
from tribo.kernels import records as rows
from tribo.kernels.accounts import add_total, add_works
from tribo.kernels.equations_of_motion import bar_angles, velocities_of_bars
from tribo.kernels.langevin import damped_motion, damping_of, normals
from tribo.kernels.packs import (
    absent,
    constant,
    coordinates,
    halves,
    own_number,
    set_coordinates,
    vectors,
)
from tribo.kernels.powers import momentum
from tribo.kernels.schedule import scheduled


@inlined
def torsion_factor(model, s, i, tau):
    """How much of the rates of a pack of swings torsion springs take in a step, per twist.

    They act in the drifts.  A kick in which the forces balance them must change nothing, so this is
    the change of rate by two halves of a rotation that meet at the present angle: the torque times
    tan(w tau / 2) / (w tau / 2).
    """
    angle = 0.5 * tau * constant(model, rows.FREQUENCY, s, i)
    angle = where_less(angle, 1.0, angle, 1.0)  # longer steps resolve no swing
    sin, cos = sine_cosine(angle)
    ratio = where_less(0.0, angle, sin / (angle * cos), 1.0)
    stiffness = constant(model, rows.KAPPA, s, i)
    return tau * ratio * stiffness * constant(model, rows.INVERSE_INERTIA, s, i)


@inlined
def torsion_gains(model, s, i, t, factor, q):
    """What torsion springs add to the rates of a pack of swings in a step."""
    if s.fixed > 0:
        return broadcast(0.0)
    twist = pack(q, i) - bar_angles(model, s, i, t, q)
    return 0.0 - factor * twist


@inlined
def temperature_of(model, schedule, row, number, i, t):
    """The temperature of a reservoir on a pack: a number, or what its schedule has at a time."""
    if schedule == 0:
        return own_number(model.own, row, number, i)
    temperature = scheduled(model.schedules, schedule, t)
    return where_less(temperature, 0.0, 0.0, temperature)  # what rounding made negative


class Arcs(NamedTuple):
    """The motion of a pack of bars along the arcs of their swings, and what damps it."""

    slip: Any  # velocity relative to the reservoir's, and what the whole kick adds to it
    gain: Any
    omega: Any  # of the swings, and what the torsion springs add to it
    turn_gain: Any
    across: Any  # inverse mass
    inverse_inertia: Any
    lever: Any
    gamma: Any
    temperature: Any


class Factors(NamedTuple):
    """What a pack's friction and noise depend on beside its motion."""

    along: Any  # Damping of the motion along the arcs, where the swings have no reservoir
    across: Any  # and of that across them
    torsion: Any  # see `torsion_factor`
    gamma: Any
    temperature: Any


@inlined
def factors_of(model, s, i, t, tau):
    """Those of a pack of bars with a reservoir."""
    gamma = own_number(model.own, rows.OWN_GAMMA, s.gamma, i)
    temperature = temperature_of(model, s.heat_schedule, rows.OWN_TEMPERATURE, s.temperature, i, t)
    mobility = constant(model, rows.INVERSE_MASS, s, i)
    across = damping_of(gamma, temperature, mobility, tau)
    along = across
    if s.swing_gamma == 0.0:
        lever = constant(model, rows.L2, s, i)
        arc = mobility + lever * lever * constant(model, rows.INVERSE_INERTIA, s, i)
        along = damping_of(gamma, temperature, arc, tau)
    return Factors(along, across, torsion_factor(model, s, i, tau), gamma, temperature)


@inlined
def are_alike(model, s):
    """Whether all packs of a surface have the same constants, and so the same factors."""
    return s.constants_mask == 0 and absent(model.own)


@inlined
def damp_arcs(arcs, damping, tau, deviates):
    """Friction and noise on bars along their arcs.

    Returns changes of the momentum along the arcs and of that about them, how far bars and swings
    jump, and what the swings' reservoir is given.
    """
    lever = arcs.lever
    arc = arcs.across + lever * lever * arcs.inverse_inertia
    gain = arcs.gain - lever * arcs.turn_gain
    first, second = deviates
    along, far = damped_motion(damping, arc, arcs.slip, gain, tau, first, second)
    # A jump has the directions of the momentum that would cause it.
    turn = 0.0 - lever * (far / arc) * arcs.inverse_inertia
    return along, broadcast(0.0), arcs.across * (far / arc), turn, broadcast(0.0)


@inlined
def damp_arcs_and_swings(model, s, i, t, reservoirs, arcs, deviates):
    """The same with a reservoir on the swings: of the centres of mass, and of the swings."""
    omega = arcs.omega
    lever = arcs.lever
    turned = omega - pack(reservoirs.before, i)
    swing_gamma = own_number(model.own, rows.OWN_SWING_GAMMA, s.swing_gamma, i)
    number = rows.OWN_SWING_TEMPERATURE, s.swing_temperature
    swing_temperature = temperature_of(model, s.swing_heat_schedule, *number, i, t)
    return damped_arc(
        (arcs.gamma * arcs.across, swing_gamma * arcs.inverse_inertia),
        (arcs.temperature, swing_temperature),
        (constant(model, rows.MASS, s, i), constant(model, rows.INERTIA, s, i)),
        lever,
        (arcs.slip + lever * omega, omega),
        (arcs.gain + 2.0 * lever * turned, arcs.turn_gain + 2.0 * turned),
        reservoirs.tau,
        deviates,
    )


@inlined
def damp_pack(model, s, i, factors, reservoirs, motion, accounts, noise):
    """Friction and noise on a pack of bars, along their arcs and across; on their swings too.

    `motion` is the time, and the coordinates and velocities then.
    """
    t, q, v = motion
    tau = reservoirs.tau
    tx, ty = vectors(model.directions, i)
    vx, vy = velocities_of_bars(model, s, i, v)
    old_x, old_y = velocities_of_bars(model, s, i, reservoirs.before)
    # What the whole kick adds: half of it is still to come.
    gain_x = 2.0 * (vx - old_x)
    gain_y = 2.0 * (vy - old_y)
    x = vx - s.reservoir_x
    y = vy - s.reservoir_y
    count = min(LANES, s.end - i)
    warmest = max(s.temperature, s.swing_temperature)
    deviates = 6 if s.swing_gamma > 0.0 else 4  # of each asperite
    first, second, third, fourth, fifth, sixth = normals(noise, warmest, count, deviates)
    arcs = Arcs(
        slip=tx * x + ty * y,
        gain=tx * gain_x + ty * gain_y,
        omega=pack(v, i),
        turn_gain=torsion_gains(model, s, i, t, factors.torsion, q),
        across=constant(model, rows.INVERSE_MASS, s, i),
        inverse_inertia=constant(model, rows.INVERSE_INERTIA, s, i),
        lever=constant(model, rows.L2, s, i),
        gamma=factors.gamma,
        temperature=factors.temperature,
    )
    if s.swing_gamma > 0.0:
        of_arc = first, second, fifth, sixth
        found = damp_arcs_and_swings(model, s, i, t, reservoirs, arcs, of_arc)
    else:
        found = damp_arcs(arcs, factors.along, tau, (first, second))
    along, turning, far, turn, given = found
    slip = tx * y - ty * x
    curved = tau * arcs.lever * arcs.omega * arcs.omega
    gain = tx * gain_y - ty * gain_x - curved
    side, aside = damped_motion(factors.across, arcs.across, slip, gain, tau, third, fourth)
    present = pack(model.each[rows.PRESENT], i)
    px = present * (along * tx - side * ty)
    py = present * (along * ty + side * tx)
    push_bars(model, s, i, px, py, v, accounts, s.acc_thermal)
    if s.swing_gamma > 0.0:
        turn_swings(model, s, i, present * turning, present * given, v, accounts)
    turn = present * turn
    far = present * far
    aside = present * aside
    jump_x = far * tx - aside * ty
    jump_y = far * ty + aside * tx
    set_jump(model, s, i, t, q, (turn, jump_x, jump_y), reservoirs.jumps, accounts)


@apart
def damp_rigid_body(model, s, reservoirs, motion, accounts, noise):
    """Friction and noise on a rigid body of rigid asperites: those of all its bars together.

    Each asperite takes up the part of the momentum that belongs to its mass.
    """
    t, q, v = motion
    tau = reservoirs.tau
    first = s.start
    vx = broadcast(lane(coordinates(s.dof_x, s, first, v), 0))
    vy = broadcast(lane(coordinates(s.dof_y, s, first, v), 0))
    gain_x = 2.0 * (vx - broadcast(lane(coordinates(s.dof_x, s, first, reservoirs.before), 0)))
    gain_y = 2.0 * (vy - broadcast(lane(coordinates(s.dof_y, s, first, reservoirs.before), 0)))
    one, other, third, fourth, _, _ = normals(noise, s.temperature, 1, 4)
    gamma = broadcast(s.gamma * (s.end - s.start))
    number = rows.OWN_TEMPERATURE, s.temperature
    temperature = temperature_of(model, s.heat_schedule, *number, first, t)
    mobility = broadcast(1.0 / s.mass)
    x = vx - s.reservoir_x
    y = vy - s.reservoir_y
    one = broadcast(lane(one, 0))
    other = broadcast(lane(other, 0))
    third = broadcast(lane(third, 0))
    fourth = broadcast(lane(fourth, 0))
    damping = damping_of(gamma, temperature, mobility, tau)
    px, far_x = damped_motion(damping, mobility, x, gain_x, tau, one, other)
    py, far_y = damped_motion(damping, mobility, y, gain_y, tau, third, fourth)
    zero = broadcast(0.0)
    for i in range(s.start, s.stop, LANES):
        present = pack(model.each[rows.PRESENT], i)
        share = present * constant(model, rows.MASS, s, i) * mobility
        push_bars(model, s, i, share * px, share * py, v, accounts, s.acc_thermal)
        # The same velocity for all, to the last bit.
        set_coordinates(s.dof_x, s, i, v, present * (vx + px * mobility))
        set_coordinates(s.dof_y, s, i, v, present * (vy + py * mobility))
        jump = zero, present * far_x, present * far_y
        set_jump(model, s, i, t, q, jump, reservoirs.jumps, accounts)


@inlined
def turn_swings(model, s, i, turning, given, v, accounts):
    """Give angular momenta to a pack of swings, bars at rest, and `given` heat to the reservoir.

    What the angular momenta do in addition to this heat is the bars' reservoir's.
    """
    omega = pack(v, i)
    now = omega + turning * constant(model, rows.INVERSE_INERTIA, s, i)
    set_pack(v, i, now)
    if s.acc_swing >= 0:
        add_works(accounts, s, s.acc_swing, i, 0.0 - given)
        rest = turning * (0.5 * (omega + now)) + given
        add_works(accounts, s, s.acc_thermal + 2 * s.account_stride, i, rest)


@apart
def damp_bars(model, reservoirs, t, q, v, accounts, noise):
    """Friction and noise on the bars of all surfaces that have a reservoir there."""
    if not absent(model.friction):
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            if s.gamma == 0.0:
                continue
            before_x, before_y = momentum(model, s, v)
            if s.block == rows.RIGID_ASPERITES:
                damp_rigid_body(model, s, reservoirs, (t, q, v), accounts, noise)
            else:
                alike = are_alike(model, s)
                for i in range(s.start, s.stop, LANES):
                    if i == s.start or not alike:
                        factors = factors_of(model, s, i, t, reservoirs.tau)
                    damp_pack(model, s, i, factors, reservoirs, (t, q, v), accounts, noise)
            after_x, after_y = momentum(model, s, v)
            px = after_x - before_x
            py = after_y - before_y
            if s.acc_block >= 0:
                work = 0.5 * (px * (before_x + after_x) + py * (before_y + after_y))
                add_total(model.members, accounts, s.acc_block, work * s.inverse_total_mass)


@inlined
def factors_of_swings(model, s, i, t, tau):
    """The damping of a pack of swings with a reservoir, and the factor of their torsion."""
    gamma = own_number(model.own, rows.OWN_SWING_GAMMA, s.swing_gamma, i)
    number = rows.OWN_SWING_TEMPERATURE, s.swing_temperature
    temperature = temperature_of(model, s.swing_heat_schedule, *number, i, t)
    mobility = constant(model, rows.INVERSE_INERTIA, s, i)
    return damping_of(gamma, temperature, mobility, tau), torsion_factor(model, s, i, tau)


@apart
def damp_swings(model, reservoirs, t, q, v, accounts, noise):
    """Friction and noise on the swings of all surfaces that have no other reservoir."""
    if not absent(model.swing_friction):
        tau = reservoirs.tau
        zero = broadcast(0.0)
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            if s.swing_gamma > 0.0 and s.gamma == 0.0:
                alike = are_alike(model, s)
                for i in range(s.start, s.stop, LANES):
                    if i == s.start or not alike:
                        factors = factors_of_swings(model, s, i, t, tau)
                    damping, torsion = factors
                    mobility = constant(model, rows.INVERSE_INERTIA, s, i)
                    count = min(LANES, s.end - i)
                    one, other, _, _, _, _ = normals(noise, s.swing_temperature, count, 2)
                    omega = pack(v, i)
                    gain = 2.0 * (omega - pack(reservoirs.before, i))
                    gain = gain + torsion_gains(model, s, i, t, torsion, q)
                    gained, turn = damped_motion(damping, mobility, omega, gain, tau, one, other)
                    now = omega + gained * mobility
                    set_pack(v, i, now)
                    if s.acc_swing >= 0:
                        add_works(accounts, s, s.acc_swing, i, gained * (0.5 * (omega + now)))
                    jump = turn, zero, zero
                    set_jump(model, s, i, t, q, jump, reservoirs.jumps, accounts)


def damp(model, t, tau, state, work, noise):
    """Friction and noise on bars and swings for a step of length `tau`, all else frozen."""
    noise = generator_at(noise)
    q, v = halves(state.y)
    reservoirs = reservoirs_of(work.before, state, tau)
    damp_bars(model, reservoirs, t, q, v, state.s, noise)
    damp_swings(model, reservoirs, t, q, v, state.s, noise)
    return 0.0
