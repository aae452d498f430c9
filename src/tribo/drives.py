"""What holds or moves a surface: the force f2 on every bar, given the contact force f1.

Each drive is a class of a few numbers; the force itself is written once, in
:func:`tribo.kernels.motion.drive_forces`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from tribo.checks import NOT_NEGATIVE, choice, flag, known_keys, number


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


KINDS: dict[str, type[Drive]] = {"forced": Forced, "free": Free, "pulled": Pulled}


def as_drive(value: Any) -> Drive:
    """A drive from its name, its table in a scene file, or itself."""
    if isinstance(value, Drive):
        return value
    if isinstance(value, str):
        return KINDS[choice("", value, KINDS)]()
    table = known_keys(value, ["kind", "load", "rigid", "stiffness", "speed"], ["kind"])
    kind = KINDS[choice("kind", table.pop("kind"), KINDS)]
    required = ["stiffness", "speed"] if kind is Pulled else []
    return kind(**known_keys(table, kind.__dataclass_fields__, required))


def as_table(drive: Drive) -> dict[str, Any]:
    """The drive's table in a scene file."""
    kind = next(name for name, cls in KINDS.items() if cls is type(drive))
    settings = {name: getattr(drive, name) for name in drive.__dataclass_fields__}
    return {"kind": kind} | {k: v for k, v in settings.items() if v is not None and v is not False}
