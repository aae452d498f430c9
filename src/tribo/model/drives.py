"""What holds or moves a surface: the force f2 on every bar, given the contact force f1.

Each drive is a class of a few numbers; the force itself is written once, in
:func:`tribo.kernels.equations_of_motion.drive_forces`.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tribo.plugins import classes as plugins
from tribo.validation import NOT_NEGATIVE, InputError, choice, flag, known_keys, number


@dataclass(frozen=True)
class Drive:
    """A drive, and the load that may go with it.

    A load N presses every bar against the other surface: f2_y is -N on a surface that faces
    down and +N on one that faces up, in place of -f1_y.
    """

    load: float | None = None  # [force per asperite]; None: f2_y = -f1_y

    def __post_init__(self) -> None:
        if self.load is not None:
            object.__setattr__(self, "load", number("load", self.load))


@dataclass(frozen=True)
class Forced(Drive):
    """f2 = -f1: the centre of mass keeps its velocity."""


@dataclass(frozen=True)
class Free(Drive):
    """f2_x = 0: each asperite slides on its own, or all of them as one rigid body."""

    rigid: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        flag("rigid", self.rigid)


@dataclass(frozen=True)
class Pulled(Drive):
    """f2_x = k (x_rest(0) + v t - x_bar): a spring from every bar to a stage that moves at v."""

    stiffness: float = 1.0  # k [force / length]
    speed: float = 0.0  # v, in the laboratory

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "stiffness", number("stiffness", self.stiffness, NOT_NEGATIVE))
        object.__setattr__(self, "speed", number("speed", self.speed))


@dataclass(frozen=True)
class Custom(Drive):
    """f2 by a plug-in: ``force_on_bar(self, t, x, y, vx, vy, fx, fy) -> (gx, gy)``.

    x, y, vx, vy are the bar's place and velocity in the laboratory, fx, fy the contact force on
    the bob.
    """

    force: Any = None

    def __post_init__(self) -> None:
        super().__post_init__()
        method = "force_on_bar(self, t, x, y, vx, vy, fx, fy)"
        plugins.check_class(type(self.force), "force", method)
        object.__setattr__(self, "force", plugins.with_numbers(self.force))


@dataclass(frozen=True)
class Ends:
    """Bars with forces of the user's own on their ends, by a plug-in.

    ``end_forces(self, t, phi, nu, twist) -> (fL_x, fL_y, fR_x, fR_y)``, twist being
    theta - phi - rest.
    """

    force: Any

    def __post_init__(self) -> None:
        plugins.check_class(type(self.force), "force", "end_forces(self, t, phi, nu, twist)")
        object.__setattr__(self, "force", plugins.with_numbers(self.force))


KINDS: dict[str, type[Drive]] = {"forced": Forced, "free": Free, "pulled": Pulled}


def as_drive(value: Any, folder: Path = Path()) -> Drive:
    """A drive from its name, its table in a scene file, or itself."""
    if isinstance(value, Drive) and type(value) is not Drive:
        return value
    if isinstance(value, str):
        return KINDS[choice("", value, KINDS)]()
    wanted = value.get("kind") if isinstance(value, dict) else None
    if plugins.is_named(wanted):
        parameters = dict(value)
        name, load = parameters.pop("kind"), parameters.pop("load", None)
        cls = plugins.class_named("kind", name, folder)
        plugins.check_class(cls, "kind", "force_on_bar(self, t, x, y, vx, vy, fx, fy)")
        return Custom(load, plugins.instance(cls, parameters))
    table = known_keys(value, ["kind", "load", "rigid", "stiffness", "speed"], ["kind"])
    kind = KINDS[choice("kind", table.pop("kind"), KINDS)]
    required = ["stiffness", "speed"] if kind is Pulled else []
    return kind(**known_keys(table, kind.__dataclass_fields__, required))


def as_table(drive: Drive) -> dict[str, Any]:
    """The drive's table in a scene file."""
    if isinstance(drive, Custom):
        table = {"kind": plugins.name_of(drive.force, {})} | drive.force._asdict()
        return table if drive.load is None else table | {"load": drive.load}
    kind = next(name for name, cls in KINDS.items() if cls is type(drive))
    settings = {name: getattr(drive, name) for name in drive.__dataclass_fields__}
    return {"kind": kind} | {k: v for k, v in settings.items() if v is not None and v is not False}


def as_bars(value: Any, folder: Path = Path()) -> str | Ends:
    """What holds the bars: "clamped", "free", or forces of the user's own on their ends."""
    if isinstance(value, Ends):
        return value
    if isinstance(value, dict):
        parameters = dict(value)
        if not isinstance(parameters.get("ends"), str):
            raise InputError("ends", 'is missing; give "yourfile.py:YourClass"')
        cls = plugins.class_named("ends", parameters.pop("ends"), folder)
        plugins.check_class(cls, "ends", "end_forces(self, t, phi, nu, twist)")
        return Ends(plugins.instance(cls, parameters))
    return choice("", value, ["clamped", "free"])


def bars_as_table(bars: str | Ends) -> str | dict[str, Any]:
    """What `as_bars` reads again."""
    if isinstance(bars, str):
        return bars
    return {"ends": plugins.name_of(bars.force, {})} | bars.force._asdict()
