"""What holds or moves a surface: the force f2 on every bar, given the contact force f1.

Each drive is a class of a few numbers.  :func:`tribo.kernels.equations_of_motion.drive_forces`
computes the force.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from tribo import validation as check
from tribo.model.tables import table_of
from tribo.plugins import classes as plugins
from tribo.validation import InputError

# Signatures of the methods that plug-ins need, as messages quote them.
FORCE_ON_BAR = "force_on_bar(self, t, x, y, vx, vy, fx, fy)"
END_FORCES = "end_forces(self, t, phi, nu, twist)"


@dataclass(frozen=True, kw_only=True)
class Drive:
    """A drive, and the load N that may go with it, which presses every bar to the other surface.

    f2_y is then -N on a surface that faces down and +N on one that faces up, in place of -f1_y.
    """

    load: float | None = None

    @property
    def presses(self) -> bool:
        """Whether the surface carries a load: a force along y other than from its surroundings."""
        return self.load is not None and self.load != 0.0

    def __new__(cls, *values: Any, **settings: Any) -> Self:
        """Refuse values without keywords, of which the first would be the load."""
        if values:
            names = ", ".join(f"{name}=..." for name in cls.__dataclass_fields__)
            raise TypeError(f"{cls.__name__} takes keywords only: {cls.__name__}({names})")
        return super().__new__(cls)

    def __post_init__(self) -> None:
        check.fields(self, load=check.one(unit="force"))


@dataclass(frozen=True, kw_only=True)
class Forced(Drive):
    """f2 = -f1: the centre of mass keeps its velocity.  Takes keywords only.

    Attributes
    ----------
    load : float, optional
        Force N on each asperite towards the other surface [force], in place of f2_y = -f1_y.
    """


@dataclass(frozen=True, kw_only=True)
class Free(Drive):
    """f2_x = 0: each asperite slides on its own, or all of them together as one block.

    As one block, f2_x = -f1_x + (M_i / M_surface) sum_j f1_x,j.  Takes keywords only.

    Attributes
    ----------
    load : float, optional
        Force N on each asperite towards the other surface [force], in place of f2_y = -f1_y.
    rigid : bool
        Whether all asperites form one block, and share the acceleration of the surface along x.
    """

    rigid: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        check.boolean("rigid", self.rigid)


@dataclass(frozen=True, kw_only=True)
class Pulled(Drive):
    """f2_x = k (x_rest(0) + v t - x_bar): a spring from every bar to a stage that moves at v.

    This is the Prandtl-Tomlinson arrangement; with lattice springs, that of Frenkel, Kontorova and
    Tomlinson.  Takes keywords only.

    Attributes
    ----------
    load : float, optional
        Force N on each asperite towards the other surface [force], in place of f2_y = -f1_y.
    stiffness : float
        Stiffness k of each spring [force / length].
    speed : float
        Velocity v of the stage along x in the laboratory [length / time].
    """

    stiffness: float = 1.0
    speed: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        stiffness = check.one(check.NOT_NEGATIVE, "force / length")
        check.fields(self, stiffness=stiffness, speed=check.one(unit="length / time"))


@dataclass(frozen=True, kw_only=True)
class Pushed(Drive):
    """f2 = force + rate t: a force on each bar that is constant, or grows at a rate.

    It finds the force at which a surface starts to slide.  Takes keywords only.

    Attributes
    ----------
    load : float, optional
        Force N on each asperite towards the other surface [force], in place of f2_y.
    force : (float, float)
        Force on each bar at t = 0, x and y [force].
    rate : (float, float)
        Growth of that force, x and y [force / time].
    """

    force: tuple[float, float] = (0.0, 0.0)
    rate: tuple[float, float] = (0.0, 0.0)

    @property
    def presses(self) -> bool:
        """Whether the load, or the force along y, is not zero at all times."""
        return super().presses or self.force[1] != 0.0 or self.rate[1] != 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        check.fields(self, force=check.pair(unit="force"), rate=check.pair(unit="force / time"))
        for name, (_, along_y) in (("force", self.force), ("rate", self.rate)):
            if self.load is not None and along_y != 0.0:
                raise InputError(name, f"must be zero along y beside a load, got {along_y:g}")


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
    """

    def __post_init__(self) -> None:
        if self.load is not None:
            raise InputError("load", "cannot go with driven bars, which are held along y too")


@dataclass(frozen=True, kw_only=True)
class Custom(Drive):
    """A user-defined drive: ``force_on_bar(self, t, x, y, vx, vy, fx, fy) -> (gx, gy)``.

    x, y, vx, vy are the bar's position and velocity in the laboratory, fx, fy the contact force on
    the bob.  Takes keywords only.

    Attributes
    ----------
    load : float, optional
        Force N on each asperite towards the other surface [force], in place of gy.
    force : NamedTuple
        The plug-in: its fields are numbers.
    """

    force: Any

    @property
    def presses(self) -> bool:
        """Whether the surface may carry a load: unless one of zero stands for the user's gy."""
        return self.load != 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        plugins.check_class(type(self.force), "force", FORCE_ON_BAR)
        object.__setattr__(self, "force", plugins.with_numbers(self.force))


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


KINDS: dict[str, type[Drive]] = {
    "forced": Forced,
    "free": Free,
    "pulled": Pulled,
    "push": Pushed,
    "bars": DrivenBars,
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
        force = plugins.from_file("kind", name, parameters, folder, FORCE_ON_BAR)
        return Custom(load=load, force=force)
    table = check.known_keys(value, value, ["kind"])
    kind = KINDS[check.choice("kind", table.pop("kind"), KINDS)]
    if kind is DrivenBars and "rigid" in table:
        raise InputError("rigid", 'cannot go with kind = "bars": driven bars move as one anyway')
    required = {Pulled: ["stiffness", "speed"], Pushed: ["force"]}.get(kind, [])
    return kind(**check.known_keys(table, kind.__dataclass_fields__, required))


def as_table(drive: Drive) -> dict[str, Any]:
    if isinstance(drive, Custom):
        table = {"kind": plugins.name_of(drive.force, {})} | drive.force._asdict()
        return table if drive.load is None else table | {"load": drive.load}
    (kind,) = (name for name, cls in KINDS.items() if cls is type(drive))
    return {"kind": kind} | {k: v for k, v in table_of(drive).items() if v is not False}


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
