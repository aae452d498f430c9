"""The speeds of bobs, by which encounters are foreseen."""

from tribo.compiler.jit import kernel
from tribo.compiler.lanes import broadcast, sqrt
from tribo.compiler.lanes_memory import pack, set_pack
from tribo.compiler.units import call_unit
from tribo.kernels import records as rows
from tribo.kernels.arms import turned_arms
from tribo.kernels.equations_of_motion import bar_angles
from tribo.kernels.packs import (
    active_of,
    active_range,
    column_of,
    constant,
    coordinates,
    halves,
    own_number,
)


@kernel
def top_speeds(model, neighbours, t, y, speeds):
    """Set the speeds of bobs, see :func:`speeds_unit`."""
    q, v = halves(y)
    call_unit(model.units[rows.SPEEDS], (model, neighbours, broadcast(t), q, v, speeds))


def speeds_unit(model, neighbours, t, q, v, speeds):
    """Set the velocity of each centre of mass, or driven bar, and the bob's largest speed about it.

    The second follows from the energy of the swing, so a pendulum at its turning point counts with
    the speed that it will have at its rest angle.  `speeds` is (3, n); those of inactive packs are
    not set.
    """
    active = active_of(neighbours)
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        for n in range(*active_range(active, s, k)):
            i = column_of(active, n)
            twist = pack(q, i) - bar_angles(model, s, i, t, q)
            omega = pack(v, i)
            stiffness = constant(model, rows.KAPPA, s, i)
            stiffness = stiffness * constant(model, rows.INVERSE_INERTIA, s, i)
            rate = stiffness * twist * twist + omega * omega
            vx = own_number(model.own, rows.OWN_VX, s.vx, i)
            vy = own_number(model.own, rows.OWN_VY, s.vy, i)
            own_x = coordinates(s.dof_x, s, i, v)
            own_y = coordinates(s.dof_y, s, i, v)
            if s.tilting > 0:
                x, y = turned_arms(model, i, coordinates(s.dof_phi, s, i, q))[0]
                nu = coordinates(s.dof_phi, s, i, v)
                own_x = own_x - nu * y
                own_y = own_y + nu * x
            set_pack(speeds[0], i, vx + own_x)
            set_pack(speeds[1], i, vy + own_y)
            set_pack(speeds[2], i, constant(model, rows.L1, s, i) * sqrt(rate))
    return 0.0
