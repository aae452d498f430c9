"""Momenta that baths and reservoirs give to bars, frozen in place, and the works that they do."""

from tribo.compiler.jit import inlined
from tribo.compiler.lanes_memory import add_block, block, set_block
from tribo.kernels.blocks import (
    column_of_constants,
    coordinates,
    directions,
    is_fixed,
    keeps_velocity,
)
from tribo.kernels.kinematics import end_force
from tribo.kernels.levers import pivot_lengths
from tribo.kernels.powers import place_of
from tribo.kernels.records import (
    COS_PHI,
    INVERSE_BAR_LENGTH,
    INVERSE_INERTIA,
    INVERSE_MASS,
    L2,
    SIN_PHI,
)


@inlined
def push_bars(model, s, i, px, py, v, accounts, slot):
    """Give momenta (px, py) to a block of bars, frozen in place.

    The works are added to the accounts from `slot` on.
    """
    a = model.constants
    c = column_of_constants(s, i)
    tx, ty = directions(model, i)
    along = tx * px + ty * py
    omega = block(v, i)
    change = 0.0 - block(a[L2], c) * along * block(a[INVERSE_INERTIA], c)
    change_x = px * block(a[INVERSE_MASS], c)
    change_y = py * block(a[INVERSE_MASS], c)
    vx = coordinates(s.dof_x, s, i, v) + 0.5 * change_x
    vy = coordinates(s.dof_y, s, i, v) + 0.5 * change_y
    set_block(v, i, omega + change)
    if not keeps_velocity(s):
        add_block(v, s.dof_x + i - s.start, change_x)
        add_block(v, s.dof_y + i - s.start, change_y)
    if slot < 0:
        return
    stride = s.account_stride
    k = place_of(s, slot, i)
    swept = along * (omega + 0.5 * change)
    pivot = pivot_lengths(model.pivots, s, i)
    add_block(accounts, k, px)
    add_block(accounts, k + stride, py)
    add_block(accounts, k + 2 * stride, 0.0 - (block(a[L2], c) + pivot) * swept)
    add_block(accounts, k + 3 * stride, px * vx + py * vy + pivot * swept)
    if is_fixed(model.fixed, s):
        torque = 0.0 - block(a[L2], c) * along
        x, y = end_force(
            torque, block(a[INVERSE_BAR_LENGTH], c), block(a[SIN_PHI], c), block(a[COS_PHI], c)
        )
        k = place_of(s, s.acc_ends + 2 * stride, i)
        add_block(accounts, k, x)
        add_block(accounts, k + stride, y)
        add_block(accounts, k + 2 * stride, x * vx + y * vy)
