"""What holds or moves a surface: the force f2 on every bar, given the contact force f1.

Each drive is a class of a few numbers, which declares what the rest of the package has to know
about its force.  Its `law` names the formula, one of those in
:func:`tribo.kernels.equations_of_motion.drive_of_block`, or its `plugin` has the formula.
"""

from __future__ import annotations

import difflib
import functools
import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np

from tribo import validation as check
from tribo.kernels import records
from tribo.model.schedule import Number, Schedule, as_schedule, at_time, number_or_schedule
from tribo.model.tables import field_names, table_of
from tribo.plugins import classes as plugins
from tribo.validation import InputError

# Signatures of the methods that plug-ins need, as messages quote them.
FORCE_ON_BAR = "force_on_bar(self, t, x, y, vx, vy, fx, fy)"
END_FORCES = "end_forces(self, t, phi, nu, twist)"
# What a warning, and a note on a scene file, say of `rigid`.
RIGID_IS_OLD = (
    "joins asperites along x alone and will be removed in 0.5; block = True makes the bars one "
    "rigid body along x and y, under one load"
)


class Stage(NamedTuple):
    """A stage that moves along x, and the springs from it to every bar."""

    stiffness: float  # [force / length]
    speed: Number  # in the laboratory [length / time]
    position: Schedule | None = None  # instead of the speed: displacement from rest [length]

    @property
    def follows_schedule(self) -> bool:
        """Whether its motion is not uniform."""
        return self.position is not None or isinstance(self.speed, Schedule)

    def moves_as(self, other: Stage) -> bool:
        """Whether another stage moves alike."""
        return self.speed == other.speed and self.position == other.position

    def displacement(self, t: Any) -> Any:
        """How far it has moved at times t since t = 0, or from its rest, in the laboratory."""
        if self.position is not None:
            return self.position.at(t)
        return self.speed.integral(t) if isinstance(self.speed, Schedule) else self.speed * t


class Ramp(NamedTuple):
    """A force on every bar that grows at a constant rate, or follows a schedule, x and y."""

    force: tuple[Number, Number]  # when the drive begins [force]
    rate: tuple[float, float]  # [force / time]


@dataclass(frozen=True, kw_only=True)
class Drive:
    """A drive, and the load N that may go with it, which presses every bar to the other surface.

    f2_y is then -N on a surface that faces down and +N on one that faces up, in place of -f1_y.
    Where bars form a `block`, one rigid body, its numbers are those of the whole body, and each bar
    has an equal part.
    """

    load: Number | None = None
    block: bool = False

    # The drive's name in scene files, and the keys that its table there must have.
    kind: ClassVar[str] = ""
    required: ClassVar[tuple[str, ...]] = ()
    # The keys that are numbers of a block alone.
    of_block: ClassVar[tuple[str, ...]] = ()
    # The formula of the force in compiled code, see `kernels.records`.
    law: ClassVar[int] = records.CUSTOM
    # Whether f2_x = -f1_x, so that the centre of mass keeps its velocity along x; and whether
    # f2_y = -f1_y where there is no load.
    cancels_x: ClassVar[bool] = False
    cancels_y: ClassVar[bool] = True
    # Whether a constraint moves the centres of the bars uniformly.
    holds_bars: ClassVar[bool] = False
    # Whether asperites follow a given motion along x and y.
    gives_motion: ClassVar[bool] = False
    # Whether the ledger counts its work; that of f2 = -f1 and f2_x = 0 follows from other works.
    has_account: ClassVar[bool] = True
    # Whether the force depends on the bar's velocity.
    depends_on_velocity: ClassVar[bool] = False
    # Whether it has a force along x of its own, which can start a slide.
    drives_along_x: ClassVar[bool] = False
    # Whether LAMMPS has fixes for it: the force is what it cancels or shares, its stage's, its
    # ramp's and its load's, and no other.
    has_fixes: ClassVar[bool] = False
    # The effect that it calls for beside a load, if any: a value of `model.effects.Effect`.
    effect: ClassVar[str] = ""
    # The fields that may differ between members of an ensemble that run side by side.
    own_numbers: ClassVar[tuple[str, ...]] = ("load",)

    @property
    def cause(self) -> str:
        """Its end of the key and value that call for its effect, as `.stiffness = 2.0`."""
        return f' = "{self.kind}"'

    @property
    def plugin(self) -> Any:
        """The NamedTuple whose `force_on_bar` computes the force; None of a law of the kernels."""
        return None

    @property
    def stage(self) -> Stage | None:
        """The moving stage that pulls the bars, if there is one."""
        return None

    @property
    def ramp(self) -> Ramp | None:
        """The force that is constant or grows at a rate, if it has one."""
        return None

    @property
    def along_axes(self) -> tuple[Number | None, Number | None]:
        """Its own force, or the velocity that it gives, along x and y; None without either."""
        return None, None

    @property
    def moves_as_one(self) -> bool:
        """Whether all asperites accelerate alike along x."""
        return False

    @property
    def damps(self) -> float:
        """The largest damping coefficient between a block and its stage; 0 without dampers."""
        return 0.0

    @property
    def cancels_contact(self) -> bool:
        """Whether f2 = -f1."""
        return self.cancels_x and self.cancels_y and self.load is None

    @property
    def presses(self) -> bool:
        """Whether the surface carries a load: a force along y other than from its surroundings."""
        return self.load is not None and self.load != 0.0

    def numbers(self, velocity: float) -> dict[str, float]:
        """Its numbers in the record of a surface that begins with this velocity along x.

        The names are those of `kernels.records.SURFACE`; the load is filled in for all drives.
        """
        return {}

    def force_along_x(
        self, x: np.ndarray, begun: np.ndarray, stage: np.ndarray
    ) -> np.ndarray | None:
        """f2_x on bars at `x`, (times, asperites), where it follows from these numbers; else None.

        `begun` are the times since the drive began, (times, 1), and `stage` where the ends of the
        springs at its stage are, (times, asperites).
        """
        return None

    def __new__(cls, *values: Any, **settings: Any) -> Self:
        """Refuse values without keywords, of which the first would be the load."""
        if values:
            names = ", ".join(f"{name}=..." for name in field_names(cls))
            raise TypeError(f"{cls.__name__} takes keywords only: {cls.__name__}({names})")
        return super().__new__(cls)

    def __post_init__(self) -> None:
        check.fields(self, load=number_or_schedule(unit="force"))
        check.boolean("block", self.block)


@dataclass(frozen=True, kw_only=True)
class Forced(Drive):
    """f2 = -f1: the centre of mass keeps its velocity.  Takes keywords only.

    Attributes
    ----------
    load : float, optional
        Force N on each asperite towards the other surface [force], in place of f2_y = -f1_y.
    block : bool
        Whether the bars are one rigid body; the load is then that on the whole body.
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
    """Rigid asperites follow a given motion along x and y, whatever forces act on them.

    f2 = M a - (all other forces), with a the acceleration of the motion.  Its work is that of the
    agent that moves the surface: of indentation and retraction, for example.  The motion begins
    with the surface's velocity.  Takes keywords only.

    Attributes
    ----------
    load : None
        Must be None: the motion is given along y too.
    block : bool
        Must be False: all bars move alike.
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


@dataclass(frozen=True, kw_only=True)
class Custom(Drive):
    """A user-defined drive: ``force_on_bar(self, t, x, y, vx, vy, fx, fy) -> (gx, gy)``.

    x, y, vx, vy are the bar's position and velocity in the laboratory, fx, fy the contact force on
    the bob.  The class of the plug-in may declare cancels_x (gx = -fx), cancels_y (gy = -fy),
    depends_on_velocity and drives_along_x (gx can start a slide).  Takes keywords only.

    Attributes
    ----------
    load : float, optional
        Force N on each asperite towards the other surface [force], in place of gy.
    block : bool
        Whether the bars are one rigid body: the plug-in is then called once for all of them, with
        the mean of their places and the sum of the contact forces, and its force and the load are
        those on the whole body.
    force : NamedTuple
        The plug-in: its fields are numbers.
    """

    force: Any

    cancels_y = False
    depends_on_velocity = True
    effect = "own drive"
    own_numbers = ()

    @property
    def cause(self) -> str:
        return f" = {type(self.force).__name__}"

    @property
    def plugin(self) -> Any:
        return self.force

    @property
    def presses(self) -> bool:
        """Whether the surface may carry a load: its own gy, or a load other than zero."""
        return self.load != 0.0 and not (self.load is None and self.cancels_y)

    def __post_init__(self) -> None:
        """Check the force, and take over the flags that its class declares."""
        super().__post_init__()
        plugins.check_class(type(self.force), "force", FORCE_ON_BAR)
        object.__setattr__(self, "force", plugins.with_numbers(self.force))
        with check.inside("force"):
            kind: Any = type(self.force)
            flags = _declared_flags(kind)
            for given in TRIALS if flags else ():
                _check_flags(self.force, flags, given)
        for name, value in flags.items():
            object.__setattr__(self, name, value)


@dataclass(frozen=True)
class Ends:
    """Bars with user-defined forces on their ends.

    ``end_forces(self, t, phi, nu, twist) -> (fL_x, fL_y, fR_x, fR_y)``, where twist is
    theta - phi - rest.

    Attributes
    ----------
    force : NamedTuple
        The plug-in: its fields are numbers.
    """

    force: Any

    def __post_init__(self) -> None:
        plugins.check_class(type(self.force), "force", END_FORCES)
        object.__setattr__(self, "force", plugins.with_numbers(self.force))


# What the class of a user's drive may declare of its force, and what that means.
FLAGS = {
    "cancels_x": "gx = -fx: the drive holds the centres of mass along x",
    "cancels_y": "gy = -fy: the drive holds the centres of mass along y, but for a load",
    "depends_on_velocity": "whether the force depends on vx and vy; True unless it is declared",
    "drives_along_x": "whether gx can start a slide, as that of a stage",
}
# Likeness from which a name is taken for that of a flag, written wrongly; see `difflib`.
ALIKE = 0.8
# Relative difference of two forces that differ by round-off alone.
ROUNDING = 1e-12
# Time, place, velocity and contact force of a bar at which declared flags are tried.
TRIALS = ((0.0, 0.3, -0.7, 0.6, -0.2, 0.9, 0.4), (1.3, -2.1, 0.8, -0.5, 1.1, -0.6, 1.7))


@functools.cache
def _declared_flags(kind: Any) -> dict[str, bool]:
    """The flags that the class of a user's drive declares.

    Raises InputError for names like those of flags, and other values than true and false.
    """
    flags: dict[str, bool] = {}
    for name in dir(kind):
        near = difflib.get_close_matches(name, FLAGS, n=1, cutoff=ALIKE)
        if near == [name]:
            flags[name] = check.boolean(name, getattr(kind, name))
        elif near and isinstance(getattr(kind, name), bool):
            raise InputError(name, f'is not a known flag; did you mean "{near[0]}"?')
    return flags


def _check_flags(plugin: Any, flags: dict[str, bool], given: tuple[float, ...]) -> None:
    """Raise InputError where a user's drive contradicts what its class declares."""
    found = plugins.returned_numbers(plugin, "", "force_on_bar", *given)
    for axis, name in enumerate(("cancels_x", "cancels_y")):
        force = given[5 + axis]
        if flags.get(name) and not math.isclose(found[axis], -force, rel_tol=ROUNDING):
            component = "xy"[axis]
            contrary = f"g{component} = {found[axis]:g} where f{component} = {force:g}"
            raise InputError(name, f"is declared, but force_on_bar gives {contrary}")
    if flags.get("depends_on_velocity", True):
        return
    still = plugins.returned_numbers(plugin, "", "force_on_bar", *given[:3], 0.0, 0.0, *given[5:])
    if tuple(still) != tuple(found):
        problem = "must be True: force_on_bar gives another force at another velocity"
        raise InputError("depends_on_velocity", problem)


KINDS: dict[str, type[Drive]] = {
    each.kind: each for each in (Forced, Free, Pulled, Pushed, DrivenBars, Moved)
}


def as_drive(value: Any, folder: Path = Path()) -> Drive:
    """A drive of a class that runs know, from its name, its table in a scene file, or a drive.

    Raises InputError for a class of one's own that is not the same as its parent.
    """
    if isinstance(value, Drive):
        if hasattr(value, "force_on_bar"):
            name = type(value).__name__
            problem = f"{name}.force_on_bar is not called; give Custom(force=...) a NamedTuple"
            raise InputError("", f"{problem} with {FORCE_ON_BAR}")
        return check.as_parent(value, [*KINDS.values(), Custom])  # type: ignore[no-any-return]
    if isinstance(value, str):
        value = {"kind": check.choice("", value, KINDS)}
    if isinstance(value, dict) and plugins.is_named(value.get("kind")):
        parameters = dict(value)
        name = parameters.pop("kind")
        load = parameters.pop("load", None)
        block = parameters.pop("block", False)
        force = plugins.from_file("kind", name, parameters, folder, FORCE_ON_BAR)
        return Custom(load=load, block=block, force=force)
    table = check.known_keys(value, value, ["kind"])
    kind = KINDS[check.choice("kind", table.pop("kind"), KINDS)]
    if kind.holds_bars and "rigid" in table:
        raise InputError("rigid", 'cannot go with kind = "bars": driven bars move as one anyway')
    replaced = ("speed",) if "position" in table else ()
    required = [name for name in kind.required if name not in replaced]
    own = check.known_keys(table, field_names(kind), required)
    if not own.get("rigid"):
        return kind(**own)
    check.boolean("rigid", own.pop("rigid"))
    drive = kind(**own)
    if drive.block:
        raise InputError("rigid", "cannot go with block = true, which joins bars along x too")
    object.__setattr__(drive, "rigid", True)  # a run has a note in place of Python's warning
    return drive


def as_table(drive: Drive) -> dict[str, Any]:
    if isinstance(drive, Custom):
        table = {"kind": plugins.name_of(drive.force, {})} | drive.force._asdict()
        table |= {"block": True} if drive.block else {}
        return table if drive.load is None else table | {"load": drive.load}
    absent = () if drive.block else drive.of_block
    own = {k: v for k, v in table_of(drive).items() if v is not False and k not in absent}
    return {"kind": drive.kind} | own


def as_bars(value: object, folder: Path = Path()) -> str | Ends:
    """What holds the bars: "clamped", "free", or a user's forces on their ends."""
    if isinstance(value, Ends):
        return check.as_parent(value, [Ends])  # type: ignore[no-any-return]
    if isinstance(value, dict):
        parameters = dict(value)
        if not isinstance(parameters.get("ends"), str):
            raise InputError("ends", 'is missing; give "yourfile.py:YourClass"')
        name = parameters.pop("ends")
        return Ends(plugins.from_file("ends", name, parameters, folder, END_FORCES))
    return check.choice("", value, ["clamped", "free"])


def bars_as_table(bars: str | Ends) -> str | dict[str, Any]:
    """The value that `as_bars` reads."""
    if isinstance(bars, str):
        return bars
    return {"ends": plugins.name_of(bars.force, {})} | bars.force._asdict()
