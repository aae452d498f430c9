"""What a drive is: the force f2 on every bar of a surface, given the contact force f1.

A drive is a class of a few numbers, which declares what the rest of the package has to know about
its force.  Its `law` names the formula, or its `plugin` has it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np

from tribo import validation as check
from tribo.kernels import records
from tribo.model.number import Number, number_or_schedule
from tribo.model.schedule import Schedule
from tribo.model.tables import field_names
from tribo.validation import InputError


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
    has an equal part.  With `tilt` = "free" the body turns about z as well.
    """

    load: Number | None = None
    block: bool = False
    tilt: str = "fixed"

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
    def tilts(self) -> bool:
        """Whether the bars turn about z together."""
        return self.tilt == "free"

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

        `begun` are the times since a push began, (times, 1), and `stage` where the ends of the
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
        """Refuse a load that is no number, and a tilt without the force that a tilting body needs.

        A class of drives extends this for its own fields.
        """
        check.fields(self, load=number_or_schedule(unit="force"))
        check.boolean("block", self.block)
        check.choice("tilt", self.tilt, ["fixed", "free"])
        if not self.tilts:
            return
        if not self.block:
            raise InputError("tilt", "needs block = true: it turns the block")
        if self.cancels_x:
            problem = f'must be "fixed" with kind = "{self.kind}", which opposes contact bar by bar'
            raise InputError("tilt", problem)
        if self.cancels_y and self.load is None:
            problem = "needs a load, of 0 or more: without one f2_y = -f1_y on each bar"
            raise InputError("tilt", problem)
