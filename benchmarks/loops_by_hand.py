"""Time loops written by hand, each for one kind of scene.

Velocity Verlet with exact torsion springs over structures of arrays, whose sizes are known only at
run time.  Five accounts for each asperite: the impulse of f1 along x and y, the works of f1_x and
f1_y about the centre of mass, and the impulse of the force on the end of the bar; more where
centres of mass slide.  The loops check no encounters and record no samples.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

# No more fast mathematics than contraction to fused multiply-add; sums are in any order only where
# `summed` says so.
loop = njit(error_model="numpy", fastmath={"contract"}, nogil=True)
part = njit(error_model="numpy", fastmath={"contract"}, forceinline=True, _nrt=False)
summed = njit(error_model="numpy", fastmath={"contract", "reassoc"}, forceinline=True, _nrt=False)

ROUNDING = 1.5 * 2.0**52  # adding and subtracting it rounds to an integer
QUARTER_TURN = (1.57079632673412561417e00, 6.07710050630396597660e-11, 2.02226624879595063154e-21)


@part
def sine_cosine(x):
    """Sine and cosine, without branches: fdlibm's polynomials of K. C. Ng."""
    quarters = (x * 0.6366197723675814 + ROUNDING) - ROUNDING
    r = (x - quarters * QUARTER_TURN[0]) - quarters * QUARTER_TURN[1] - quarters * QUARTER_TURN[2]
    z = r * r
    sin = 1.58969099521155010221e-10 * z - 2.50507602534068634195e-08
    sin = sin * z + 2.75573137070700676789e-06
    sin = sin * z - 1.98412698298579493134e-04
    sin = sin * z + 8.33333333332248946124e-03
    sin = sin * z - 1.66666666666666324348e-01
    sin = r + r * z * sin
    cos = 2.08757232129817482790e-09 - 1.13596475577881948265e-11 * z
    cos = cos * z - 2.75573143513906633035e-07
    cos = cos * z + 2.48015872894767294178e-05
    cos = cos * z - 1.38888888888741095749e-03
    cos = cos * z + 4.16666666666666019037e-02
    cos = (1.0 - 0.5 * z) + z * z * cos
    quadrant = quarters - 4.0 * ((quarters * 0.25 - 0.375 + ROUNDING) - ROUNDING)
    even = abs(abs(quadrant - 2.0) - 1.0)
    one = cos if even < 0.5 else sin
    other = sin if even < 0.5 else cos
    one = one if quadrant < 1.5 else -one
    other = -other if abs(quadrant - 1.5) < 1.0 else other
    return one, other


class Surfaces(NamedTuple):
    """Asperites of both surfaces, those of the upper one first; arrays (n,)."""

    x: np.ndarray  # centres of mass at t = 0
    y: np.ndarray
    z: np.ndarray
    speed: np.ndarray  # along x
    charge: np.ndarray
    arm: np.ndarray  # l1, up or down
    torque: np.ndarray  # (l1 + l2) / inertia, up or down
    bar_arm: np.ndarray  # l2, up or down
    bar_torque: np.ndarray  # l2 / inertia, up or down
    end: np.ndarray  # inertia / bar length
    mass: np.ndarray
    frequency: np.ndarray


class Motion(NamedTuple):
    """State, accounts and scratch; arrays (n,)."""

    q: np.ndarray  # swing
    v: np.ndarray
    impulse_x: np.ndarray  # of f1
    impulse_y: np.ndarray
    work_x: np.ndarray  # of f1_x about the centre of mass, per length of the rod
    work_y: np.ndarray
    impulse_end: np.ndarray  # of f_L along y
    sin: np.ndarray
    cos: np.ndarray
    bob_x: np.ndarray
    bob_y: np.ndarray
    fx: np.ndarray  # f1
    fy: np.ndarray
    versine: np.ndarray  # of the torsion springs' rotation in a step
    sine: np.ndarray


class Bobs(NamedTuple):
    """Bobs of one surface: views of the arrays of both, (n,)."""

    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    charge: np.ndarray
    fx: np.ndarray
    fy: np.ndarray


class Slide(NamedTuple):
    """Centres of mass of the upper surface, accounts and scratch; arrays (upper,)."""

    x: np.ndarray  # displacement
    y: np.ndarray
    vx: np.ndarray
    vy: np.ndarray
    slide_x: np.ndarray  # pseudoworks of f1_x, f1_y and f_L
    slide_y: np.ndarray
    slide_end: np.ndarray
    inner_x: np.ndarray  # impulse of f_int, its work about the centre of mass, its pseudowork
    inner_y: np.ndarray
    inner_work: np.ndarray
    inner_slide: np.ndarray
    impulse_end: np.ndarray  # of f_L along y, a step before
    bar_x: np.ndarray  # displacement of the bar
    bar_y: np.ndarray
    hx: np.ndarray  # f_int
    hy: np.ndarray


class Bonds(NamedTuple):
    """Lattice springs; arrays (bonds,)."""

    one: np.ndarray
    other: np.ndarray
    stiffness: np.ndarray


class Bath(NamedTuple):
    """Oscillators on one bar; arrays (oscillators,)."""

    mass: np.ndarray
    frequency: np.ndarray
    versine: np.ndarray  # of a rotation in a step
    sine: np.ndarray
    x: np.ndarray
    y: np.ndarray
    vx: np.ndarray
    vy: np.ndarray


@part
def rotation(a, m, tau):
    """1 - cos and sin of the torsion springs' rotation in tau."""
    for i in range(m.q.size):
        half = math.sin(0.5 * a.frequency[i] * tau)
        m.versine[i] = 2.0 * half * half
        m.sine[i] = math.sin(a.frequency[i] * tau)


@part
def drift(a, m, t):
    """Rotate the pendulums on their springs, and place the bobs at t."""
    for i in range(m.q.size):
        q = m.q[i]
        v = m.v[i]
        change = -m.versine[i] * v - m.sine[i] * a.frequency[i] * q
        q = q - m.versine[i] * q + m.sine[i] / a.frequency[i] * v
        m.q[i] = q
        m.v[i] = v + change
        m.impulse_end[i] -= a.end[i] * change
        sin, cos = sine_cosine(q)
        m.sin[i] = sin
        m.cos[i] = cos
        m.bob_x[i] = a.x[i] + a.speed[i] * t + a.arm[i] * sin
        m.bob_y[i] = a.y[i] - a.arm[i] * cos
        m.fx[i] = 0.0
        m.fy[i] = 0.0


@summed
def contact(one, other, strength):
    """Coulomb forces between all bobs of the two surfaces."""
    for i in range(one.x.size):
        x = one.x[i]
        y = one.y[i]
        z = one.z[i]
        charge = strength * one.charge[i]
        sum_x = 0.0
        sum_y = 0.0
        for j in range(other.x.size):
            dx = x - other.x[j]
            dy = y - other.y[j]
            dz = z - other.z[j]
            square = dx * dx + dy * dy + dz * dz
            f = charge * other.charge[j] / (square * math.sqrt(square))
            sum_x += f * dx
            sum_y += f * dy
            other.fx[j] -= f * dx
            other.fy[j] -= f * dy
        one.fx[i] = sum_x
        one.fy[i] = sum_y


@part
def kick(a, m, tau):
    """Forced asperites: f2 = -f1."""
    for i in range(m.q.size):
        fx = m.fx[i]
        fy = m.fy[i]
        along_x = fx * m.cos[i]
        along_y = fy * m.sin[i]
        change = tau * a.torque[i] * (along_x + along_y)
        middle = tau * (m.v[i] + 0.5 * change)
        m.v[i] += change
        m.impulse_x[i] += tau * fx
        m.impulse_y[i] += tau * fy
        m.work_x[i] += middle * along_x
        m.work_y[i] += middle * along_y


@loop
def surfaces_by_hand(a, m, one, other, strength, h, steps):
    """Two forced surfaces."""
    rotation(a, m, 0.5 * h)
    drift(a, m, 0.5 * h)
    rotation(a, m, h)
    for k in range(1, steps):
        contact(one, other, strength)
        kick(a, m, h)
        drift(a, m, (k + 0.5) * h)
    contact(one, other, strength)
    kick(a, m, h)
    rotation(a, m, 0.5 * h)
    drift(a, m, steps * h)


@part
def slide_drift(a, m, s, tau):
    """Move the centres of mass of the upper surface for tau; bobs and bars with them."""
    for i in range(s.x.size):
        s.x[i] += tau * s.vx[i]
        s.y[i] += tau * s.vy[i]
        m.bob_x[i] += s.x[i]
        m.bob_y[i] += s.y[i]
        s.bar_x[i] = s.x[i] - a.bar_arm[i] * m.sin[i]
        s.bar_y[i] = s.y[i] - a.bar_arm[i] * (1.0 - m.cos[i])
        s.hx[i] = 0.0
        s.hy[i] = 0.0
        s.slide_end[i] += (m.impulse_end[i] - s.impulse_end[i]) * s.vy[i]
        s.impulse_end[i] = m.impulse_end[i]


@part
def springs(s, bonds):
    """Forces of lattice springs on the bars."""
    for b in range(bonds.one.size):
        i = bonds.one[b]
        j = bonds.other[b]
        x = bonds.stiffness[b] * (s.bar_x[i] - s.bar_x[j])
        y = bonds.stiffness[b] * (s.bar_y[i] - s.bar_y[j])
        s.hx[i] -= x
        s.hy[i] -= y
        s.hx[j] += x
        s.hy[j] += y


@part
def slide_kick(a, m, s, tau):
    """Forced asperites of the upper surface, whose centres of mass yield to f_int."""
    for i in range(s.x.size):
        fx = m.fx[i]
        fy = m.fy[i]
        hx = s.hx[i]
        hy = s.hy[i]
        along_x = fx * m.cos[i]
        along_y = fy * m.sin[i]
        inner = hx * m.cos[i] + hy * m.sin[i]
        change = tau * (a.torque[i] * (along_x + along_y) - a.bar_torque[i] * inner)
        push_x = tau * hx
        push_y = tau * hy
        middle = tau * (m.v[i] + 0.5 * change)
        middle_x = s.vx[i] + 0.5 * push_x / a.mass[i]
        middle_y = s.vy[i] + 0.5 * push_y / a.mass[i]
        m.v[i] += change
        s.vx[i] += push_x / a.mass[i]
        s.vy[i] += push_y / a.mass[i]
        m.impulse_x[i] += tau * fx
        m.impulse_y[i] += tau * fy
        m.work_x[i] += middle * along_x
        m.work_y[i] += middle * along_y
        s.slide_x[i] += tau * fx * middle_x
        s.slide_y[i] += tau * fy * middle_y
        s.inner_x[i] += push_x
        s.inner_y[i] += push_y
        s.inner_work[i] -= middle * a.bar_arm[i] * inner
        s.inner_slide[i] += push_x * middle_x + push_y * middle_y


@loop
def springs_by_hand(a, m, low, low_m, s, bonds, one, other, strength, h, steps):
    """Two forced surfaces with lattice springs on the upper one."""
    rotation(a, m, 0.5 * h)
    drift(a, m, 0.5 * h)
    slide_drift(a, m, s, 0.5 * h)
    rotation(a, m, h)
    for k in range(1, steps + 1):
        contact(one, other, strength)
        springs(s, bonds)
        slide_kick(a, m, s, h)
        kick(low, low_m, h)
        if k < steps:
            drift(a, m, (k + 0.5) * h)
            slide_drift(a, m, s, h)
    rotation(a, m, 0.5 * h)
    drift(a, m, steps * h)
    slide_drift(a, m, s, 0.5 * h)


@part
def bath_rotation(bath, tau):
    """1 - cos and sin of the oscillators' rotation in tau."""
    for n in range(bath.mass.size):
        half = math.sin(0.5 * bath.frequency[n] * tau)
        bath.versine[n] = 2.0 * half * half
        bath.sine[n] = math.sin(bath.frequency[n] * tau)


@summed
def rotate_bath(bath, x, y):
    """Rotate the oscillators about a bar at (x, y); the momentum that they gain."""
    px = 0.0
    py = 0.0
    for n in range(bath.mass.size):
        frequency = bath.frequency[n]
        versine = bath.versine[n]
        sine = bath.sine[n]
        dx = bath.x[n] - x
        dy = bath.y[n] - y
        vx = bath.vx[n]
        vy = bath.vy[n]
        change_x = -versine * vx - sine * frequency * dx
        change_y = -versine * vy - sine * frequency * dy
        bath.x[n] += sine / frequency * vx - versine * dx
        bath.y[n] += sine / frequency * vy - versine * dy
        bath.vx[n] = vx + change_x
        bath.vy[n] = vy + change_y
        px += bath.mass[n] * change_x
        py += bath.mass[n] * change_y
    return px, py


@part
def push_bar(a, m, s, px, py):
    """Give momentum to the bar of asperite 0."""
    along = m.cos[0] * px + m.sin[0] * py
    change = -a.bar_torque[0] * along
    change_x = px / a.mass[0]
    change_y = py / a.mass[0]
    s.inner_x[0] += px
    s.inner_y[0] += py
    s.inner_work[0] -= a.bar_arm[0] * along * (m.v[0] + 0.5 * change)
    s.inner_slide[0] += px * (s.vx[0] + 0.5 * change_x) + py * (s.vy[0] + 0.5 * change_y)
    m.v[0] += change
    s.vx[0] += change_x
    s.vy[0] += change_y


@loop
def bath_by_hand(a, m, low, low_m, s, bath, one, other, strength, h, steps):
    """A forced pair with a bath on the upper bar."""
    rotation(a, m, 0.5 * h)
    drift(a, m, 0.5 * h)
    slide_drift(a, m, s, 0.5 * h)
    rotation(a, m, h)
    bath_rotation(bath, h)
    for k in range(1, steps + 1):
        contact(one, other, strength)
        slide_kick(a, m, s, 0.5 * h)
        kick(low, low_m, 0.5 * h)
        px, py = rotate_bath(bath, s.bar_x[0], s.bar_y[0])
        push_bar(a, m, s, -px, -py)
        slide_kick(a, m, s, 0.5 * h)
        kick(low, low_m, 0.5 * h)
        if k < steps:
            drift(a, m, (k + 0.5) * h)
            slide_drift(a, m, s, h)
    rotation(a, m, 0.5 * h)
    drift(a, m, steps * h)
    slide_drift(a, m, s, 0.5 * h)
