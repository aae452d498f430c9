"""The drives of scene files, each a class.

A class has a few numbers, and declares what the rest of the package has to know about its force;
see :class:`tribo.model.drive.Drive`.  Its `law` names the formula, one of those in
:func:`tribo.kernels.equations_of_motion.drive_of_pack`.
"""

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from tribo import validation as check
from tribo.kernels import records
from tribo.model.drive import Drive, Ramp, Stage
from tribo.model.number import Number, at_time, number_or_schedule
from tribo.model.schedule import Schedule, as_schedule
from tribo.validation import InputError

# What a warning, and a note on a scene file, say of `rigid`.
RIGID_IS_OLD = (
    "joins asperites along x alone and will be removed in 0.5; block = True makes the bars one "
    "rigid body along x and y, under one load"
)


@dataclass(frozen=True, kw_only=True)
class Forced(Drive):
    """f2 = -f1: the centre of mass keeps its velocity.  Takes keywords only.

    Attributes
    ----------
    load : float, optional
        Force N on each asperite towards the other surface [force], in place of f2_y = -f1_y.
    block : bool
        Whether the bars are one rigid body; the load is then that on the whole body.
    tilt : str
        Must be "fixed".
    """

    kind = "forced"
    law = records.FORCED
    has_fixes = True
    cancels_x = True
    has_account = False


@dataclass(frozen=True, kw_only=True)
class Free(Drive):
    """f2_x = 0: each asperite slides on its own, or all of them together as one block.

    With `rigid`, f2_x = -f1_x + (M_i / M_surface) sum_j f1_x,j.  Takes keywords only.

    Attributes
    ----------
    load : float, optional
        Force N on each asperite towards the other surface [force], in place of f2_y = -f1_y.
    block : bool
        Whether the bars are one rigid body, which moves along x and y; the load is then that on it.
    tilt : str
        Of a block with a load: "fixed", or "free" to turn about z.
    rigid : bool
        Whether all asperites share the acceleration of the surface along x alone: each has its own
        motion along y.  Deprecated; `block` joins bars along x and y.
    """

    rigid: bool = False

    kind = "free"
    law = records.FREE
    has_fixes = True
    has_account = False

    @property
    def moves_as_one(self) -> bool:
        return self.rigid

    def __post_init__(self) -> None:
        super().__post_init__()
        check.boolean("rigid", self.rigid)
        if self.rigid and self.block:
            raise InputError("rigid", "cannot go with block = true, which joins bars along x too")
        if self.rigid:
            warnings.warn(f"rigid = True {RIGID_IS_OLD}", DeprecationWarning, stacklevel=3)


# Numbers of a pulled block beside stiffness and speed.
OF_BLOCK = ("stiffness_y", "damping", "damping_y")


@dataclass(frozen=True, kw_only=True)
class Pulled(Drive):
    """f2_x = k (x_rest(0) + v t - x_bar): a spring from every bar to a stage that moves at v.

    This is the Prandtl-Tomlinson arrangement; with lattice springs, that of Frenkel, Kontorova and
    Tomlinson.  Takes keywords only.

    Attributes
    ----------
    load : float or Schedule, optional
        Force N on each asperite towards the other surface [force], in place of f2_y = -f1_y.
    block : bool
        Whether the bars are one rigid body, pulled by one spring of stiffness k, as by the
        cantilever of a microscope; the load is then that on the whole body.
    tilt : str
        Of a block with a load: "fixed", or "free" to turn about z.  The spring then acts at the
        mean of the bars' places.
    stiffness : float
        Stiffness k of each spring, or of that of the block [force / length].
    speed : float or Schedule
        Velocity v of the stage along x in the laboratory [length / time].
    position : Schedule, optional
        Displacement of the stage along x from where the springs are relaxed, in the laboratory,
        instead of the speed [length]; without steps.
    stiffness_y : float
        Of a block with a load: stiffness of its spring along y, about its height at the start
        [force / length].
    damping : float
        Of a block: damping coefficient along x, of its velocity relative to the stage
        [force time / length].
    damping_y : float
        Of a block with a load: damping coefficient along y [force time / length].
    """

    stiffness: float = 1.0
    speed: Number = 0.0
    position: Schedule | None = None
    stiffness_y: float = 0.0
    damping: float = 0.0
    damping_y: float = 0.0

    kind = "pulled"
    required = ("stiffness", "speed")
    of_block = OF_BLOCK
    law = records.PULLED
    has_fixes = True
    drives_along_x = True
    effect = "pull"
    own_numbers = ("load", "stiffness", "speed")

    @property
    def cause(self) -> str:
        return f".stiffness = {self.stiffness}"

    @property
    def stage(self) -> Stage:
        return Stage(self.stiffness, self.speed, self.position)

    def numbers(self, velocity: float) -> dict[str, float]:
        uniform = not self.stage.follows_schedule
        speed = self.speed - velocity if uniform else 0.0  # type: ignore[operator]
        own = {name: getattr(self, name) for name in ("stiffness", *OF_BLOCK)}
        return {"speed": speed, **own}

    @property
    def damps(self) -> float:
        return max(self.damping, self.damping_y)

    def force_along_x(self, x: np.ndarray, begun: np.ndarray, stage: np.ndarray) -> np.ndarray:
        return np.asarray(self.stiffness * (stage - x))

    def __post_init__(self) -> None:
        """Check the numbers, of which some need a block or a load, and the stage's schedule."""
        super().__post_init__()
        stiffness = check.one(check.NOT_NEGATIVE, "force / length")
        damping = check.one(check.NOT_NEGATIVE, "force time / length")
        check.fields(self, stiffness=stiffness, speed=number_or_schedule(unit="length / time"))
        check.fields(self, stiffness_y=stiffness, damping=damping, damping_y=damping)
        for name in OF_BLOCK:
            if getattr(self, name) != 0.0 and not self.block:
                raise InputError(name, "needs block = true, of which it is a number")
            if name.endswith("_y") and getattr(self, name) != 0.0 and self.load is None:
                raise InputError(name, "needs a load, of 0 or more: without one f2_y = -f1_y")
        if self.position is None:
            return
        if self.speed != 0.0:
            raise InputError("position", "cannot go with a speed; give one or the other")
        with check.inside("position"):
            position = as_schedule(self.position)
            if position.jumps:
                raise InputError("", "must have no steps; a stage that jumps has no power")
        object.__setattr__(self, "position", position)


@dataclass(frozen=True, kw_only=True)
class Pushed(Drive):
    """f2 = force + rate t: a force on each bar that is constant, or grows at a rate.

    It finds the force at which a surface starts to slide.  Takes keywords only.

    Attributes
    ----------
    load : float, optional
        Force N on each asperite towards the other surface [force], in place of f2_y.
    block : bool
        Whether the bars are one rigid body; load, force and rate are then those on the whole body.
    tilt : str
        Of a block: "fixed", or "free" to turn about z.
    force : (float, float)
        Force on each bar at t = 0, x and y [force]; either may be a Schedule.
    rate : (float, float)
        Growth of that force, x and y [force / time]; zero beside a schedule.
    """

    force: tuple[Number, Number] = (0.0, 0.0)
    rate: tuple[float, float] = (0.0, 0.0)

    kind = "push"
    required = ("force",)
    law = records.PUSHED
    has_fixes = True
    cancels_y = False
    drives_along_x = True
    effect = "push"

    @property
    def cause(self) -> str:
        return f".force = {list(self.force)}"

    @property
    def ramp(self) -> Ramp:
        return Ramp(self.force, self.rate)

    @property
    def along_axes(self) -> tuple[Number, Number]:
        return self.force

    def numbers(self, velocity: float) -> dict[str, float]:
        push, load = (0.0 if isinstance(each, Schedule) else each for each in self.force)
        push_rate, load_rate = self.rate
        own = {"push": push, "push_rate": push_rate, "load": load, "load_rate": load_rate}
        return {"loaded": 1.0, **own}

    def force_along_x(self, x: np.ndarray, begun: np.ndarray, stage: np.ndarray) -> np.ndarray:
        return np.broadcast_to(at_time(self.force[0], begun) + self.rate[0] * begun, x.shape)

    @property
    def presses(self) -> bool:
        """Whether the load, or the force along y, is not zero at all times."""
        return super().presses or self.force[1] != 0.0 or self.rate[1] != 0.0

    def __post_init__(self) -> None:
        """Check the force and its rate, of which a load or a schedule takes the place."""
        super().__post_init__()
        check.fields(
            self,
            force=_pair_of_numbers("force", "[[[0, 0], [10, 1]], 0]"),
            rate=check.pair(unit="force / time"),
        )
        for k, (force, rate) in enumerate(zip(self.force, self.rate, strict=True)):
            if isinstance(force, Schedule) and rate != 0.0:
                raise InputError(f"rate[{k}]", f"must be zero beside a schedule, got {rate:g}")
        for name, (_, along_y) in (("force", self.force), ("rate", self.rate)):
            if self.load is not None and along_y != 0.0:
                raise InputError(name, f"must be zero along y beside a load, got {along_y:g}")


def _pair_of_numbers(unit: str, example: str) -> Callable[[str, Any], tuple[Number, Number]]:
    """The check of an x and a y, of which each is a number or a schedule."""

    def checked(field: str, value: Any) -> tuple[Number, Number]:
        """The x and the y of a list of two; a list of points alone is refused."""
        points = check.is_list(value) and len(value) > 0 and check.is_list(value[0])
        numbers = points and len(value[0]) > 0 and not check.is_list(value[0][0])
        if not check.is_list(value) or len(value) != 2 or numbers:
            wanted = f"2 numbers [{unit}], each of which may be a schedule, as {example}"
            raise check.must_be(field, wanted, value)
        one = number_or_schedule(unit=unit)
        x, y = (one(f"{field}[{k}]", each) for k, each in enumerate(value))
        return x, y

    return checked


@dataclass(frozen=True, kw_only=True)
class DrivenBars(Drive):
    """The centres of the bars move uniformly with the surface's initial velocity, or stand.

    f2 is the reaction of the constraint.  Its work is the integral of f2 . V, with V that velocity:
    zero on a surface that stands.  Each asperite is a pendulum about its bar's centre.  A bar
    begins a rod's length from the surface's `bob`, for any initial angle of its pendulum, so that
    m2 does not influence the motion.

    Attributes
    ----------
    load : None
        Must be None: a constraint holds the bars along y too.
    block : bool
        Must be False: driven bars move as one anyway.
    tilt : str
        Must be "fixed".
    """

    kind = "bars"
    law = records.BARS
    has_fixes = True
    holds_bars = True
    effect = "driven bars"

    def __post_init__(self) -> None:
        if self.load is not None:
            raise InputError("load", "cannot go with driven bars, which are held along y too")
        if self.block:
            raise InputError(
                "block", 'cannot go with kind = "bars": driven bars move as one anyway'
            )


@dataclass(frozen=True, kw_only=True)
class Moved(Drive):
    """Bars follow a given motion along x and y, whatever forces act on them.

    f2 = M a_cm - (all other forces), with a_cm the acceleration of the centre of mass: that of the
    motion, a, and of the swing about the bar.  Its work is that of the agent that moves the
    surface: of indentation and retraction, for example.  Pendulums feel -m1 a at their bobs, as
    Kapitza's.  The motion begins with the surface's velocity.  Takes keywords only.

    Attributes
    ----------
    load : None
        Must be None: the motion is given along y too.
    block : bool
        Must be False: all bars move alike.
    tilt : str
        Must be "fixed".
    speed : (float or Schedule, float or Schedule)
        Velocity along x and y in the laboratory, without steps [length / time].
    """

    speed: tuple[Number, Number] = (0.0, 0.0)

    kind = "moved"
    required = ("speed",)
    law = records.MOVED
    cancels_y = False
    gives_motion = True
    own_numbers = ()

    def __post_init__(self) -> None:
        """Check the velocities; a load, a block and steps cannot go with a given motion."""
        if self.load is not None:
            raise InputError("load", "cannot go with a given motion, which is along y too")
        if self.block:
            raise InputError("block", "cannot go with a given motion, which moves bars as one")
        check.fields(self, speed=_pair_of_numbers("length / time", "[[[0, 0], [10, 1]], 0]"))
        for k, speed in enumerate(self.speed):
            if isinstance(speed, Schedule) and speed.jumps:
                problem = "must have no steps, at which the force is infinite; give a short ramp"
                raise InputError(f"speed[{k}]", problem)

    @property
    def along_axes(self) -> tuple[Number, Number]:
        return self.speed

    @property
    def first_velocity(self) -> tuple[float, float]:
        """The velocity at t = 0."""
        x, y = (float(at_time(each, 0.0)) for each in self.speed)
        return x, y


KINDS: dict[str, type[Drive]] = {
    each.kind: each for each in (Forced, Free, Pulled, Pushed, DrivenBars, Moved)
}
