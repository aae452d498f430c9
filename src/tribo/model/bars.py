"""What holds the bars of a surface: clamps, nothing, or forces of the user's own on their ends."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tribo import validation as check
from tribo.plugins import classes as plugins
from tribo.validation import InputError

# Signature of the method that a plug-in needs, as messages quote it.
END_FORCES = "end_forces(self, t, phi, nu, twist)"


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
