"""Momenta that baths and reservoirs give to bars, frozen in place, and the works that they do."""

from tribo.compiler.jit import inlined
from tribo.compiler.lanes_memory import add_pack, pack, set_pack
from tribo.kernels import records as rows
from tribo.kernels.accounts import add_works
from tribo.kernels.kinematics import end_force
from tribo.kernels.levers import pivot_lengths
from tribo.kernels.packs import constant, coordinates, keeps_velocity, vectors


@inlined
def impulse_on_end(model, s, i, impulse):
    """The impulse on the left ends of clamped bars at rest that an angular impulse makes."""
    inverse_length = constant(model, rows.INVERSE_BAR_LENGTH, s, i)
    sin = constant(model, rows.SIN_PHI, s, i)
    cos = constant(model, rows.COS_PHI, s, i)
    return end_force(impulse, inverse_length, sin, cos)


@inlined
def push_bars(model, s, i, px, py, v, accounts, slot):
    """Give momenta (px, py) to a pack of bars, frozen; works are added from account `slot` on."""
    l2 = constant(model, rows.L2, s, i)
    mobility = constant(model, rows.INVERSE_MASS, s, i)
    tx, ty = vectors(model.directions, i)
    along = tx * px + ty * py
    omega = pack(v, i)
    change = 0.0 - l2 * along * constant(model, rows.INVERSE_INERTIA, s, i)
    change_x, change_y = px * mobility, py * mobility
    vx = coordinates(s.dof_x, s, i, v) + 0.5 * change_x
    vy = coordinates(s.dof_y, s, i, v) + 0.5 * change_y
    set_pack(v, i, omega + change)
    if not keeps_velocity(s):
        add_pack(v, s.dof_x + i - s.start, change_x)
        add_pack(v, s.dof_y + i - s.start, change_y)
    if slot < 0:
        return
    swept = along * (omega + 0.5 * change)
    pivot = pivot_lengths(model.pivots, s, i)
    about = 0.0 - (l2 + pivot) * swept
    pseudowork = px * vx + py * vy + pivot * swept
    add_works(accounts, s, slot, i, px, py, about, pseudowork)
    if s.fixed > 0:
        x, y = impulse_on_end(model, s, i, 0.0 - l2 * along)
        k = s.acc_ends + 2 * s.account_stride
        add_works(accounts, s, k, i, x, y, x * vx + y * vy)
