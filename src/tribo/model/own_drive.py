"""Drives of the user's own, and the flags that the classes of their forces may declare."""

import difflib
import functools
import math
from dataclasses import dataclass
from typing import Any

from tribo import validation as check
from tribo.model.drive import Drive
from tribo.plugins import classes as plugins
from tribo.validation import InputError

# Signature of the method that a plug-in needs, as messages quote it.
FORCE_ON_BAR = "force_on_bar(self, t, x, y, vx, vy, fx, fy)"
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
    tilt : str
        Of a block: "fixed", or "free" to turn about z around the mean of the bars' places.
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
