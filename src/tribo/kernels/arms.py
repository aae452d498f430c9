"""Bars of a rigid body that turns about z by an angle chi, the tilt: r2_i = R + e_i.

The arms e_i are those of the start, from R, the mean of the bars' places, turned by chi.  The
coordinates x and y of such a body are those of R, and phi of each bar is chi, see
`kernels.tilting_block`.
"""

from tribo.compiler.jit import inlined
from tribo.compiler.lanes_functions import sine_cosine_versine
from tribo.kernels.packs import set_vectors, vectors


@inlined
def turned_arms(model, i, tilt):
    """The arms of a pack of bars, and the displacements of the bars by the tilt."""
    sin, _, versine = sine_cosine_versine(tilt)
    arm_x, arm_y = vectors(model.arms, i)
    x = -versine * arm_x - sin * arm_y
    y = sin * arm_x - versine * arm_y
    return (arm_x + x, arm_y + y), (x, y)


@inlined
def with_turned_arms(model, s, i, tilt, x, y):
    """Places of a pack with the displacements by the tilt, if there is one; notes the arms."""
    if s.tilting > 0:
        arms, moved = turned_arms(model, i, tilt)
        set_vectors(model.turned, i, *arms)
        x = x + moved[0]
        y = y + moved[1]
    return x, y


@inlined
def with_tilting(model, s, i, nu, vx, vy):
    """Velocities of a pack with those of the bars about R, if these tilt; bobs in place."""
    if s.tilting > 0:
        x, y = vectors(model.turned, i)
        vx = vx - nu * y
        vy = vy + nu * x
    return vx, vy


@inlined
def accelerations_of_bars(model, s, i):
    """r2'' = R'' + alpha z x e - nu^2 e of a pack, the motion of the whole in place."""
    x, y = vectors(model.turned, i)
    inward = s.rate * s.rate
    return s.ax - s.alpha * y - inward * x, s.ay + s.alpha * x - inward * y
