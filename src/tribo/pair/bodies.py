"""The numbers of the pair's loop from those of two asperites; each formula is written once.

These are plain functions of numbers or arrays: runs from Python call them with arrays, the module
of a live page is compiled from them.
"""

from typing import Any, NamedTuple

from tribo.kernels.kinematics import equation
from tribo.pair.forces import PairScene


class Body(NamedTuple):
    """One asperite of a pair; each a number, or an array of those of many members."""

    mass: Any
    inertia: Any  # about the centre of mass
    kappa: Any
    l1: Any
    l2: Any
    pivot: Any  # l2 on driven bars, else 0
    facing: Any
    x: Any  # of the resting centre of mass, relative to the first surface's bob
    y: Any
    vx: Any  # of its surface, relative to the first one
    vy: Any
    depth: Any
    charge: Any
    free: Any  # 1 where its centre of mass slides along x, else 0


@equation
def inertia_about_bar(body: Body) -> Any:
    """The moment of inertia about the point that is held: the centre of mass, or a driven bar."""
    return body.inertia + body.mass * (body.pivot * body.pivot)


@equation
def slide_of(body: Body, sign: Any) -> Any:
    """Displacement of the centre of mass for k = 1; the sign is 1 for the first, -1 else."""
    return sign * body.free / body.mass


@equation
def levers(body: Body, sign: Any) -> Any:
    """lever_x and lever_y of :class:`tribo.pair.forces.PairScene`."""
    lever = sign * body.facing / inertia_about_bar(body)
    across = lever * (body.l1 + body.l2)
    return lever * (body.l1 + (1.0 - body.free) * body.l2), across


@equation
def pair_of(one: Body, other: Body) -> PairScene:
    """Two asperites as the loop reads them; driven bars take the place of centres of mass."""
    raised = one.facing * one.pivot - other.facing * other.pivot
    lever_x1, lever_y1 = levers(one, 1.0)
    lever_x2, lever_y2 = levers(other, -1.0)
    depth = one.depth - other.depth
    return PairScene(
        one.x - other.x,
        (one.y - other.y) + raised,
        depth * depth,
        one.vx - other.vx,
        one.vy - other.vy,
        slide_of(one, 1.0) - slide_of(other, -1.0),
        one.charge,
        other.charge,
        one.facing * (one.l1 + one.pivot),
        other.facing * (other.l1 + other.pivot),
        lever_x1,
        lever_y1,
        one.kappa / inertia_about_bar(one),
        lever_x2,
        lever_y2,
        other.kappa / inertia_about_bar(other),
    )
