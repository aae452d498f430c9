"""The drive that a value of a scene means, and its table in a scene file."""

from pathlib import Path
from typing import Any

from tribo import validation as check
from tribo.model.drive import Drive
from tribo.model.drives import KINDS
from tribo.model.own_drive import FORCE_ON_BAR, Custom
from tribo.model.tables import field_names, table_of
from tribo.plugins import classes as plugins
from tribo.validation import InputError


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
        tilt = parameters.pop("tilt", "fixed")
        force = plugins.from_file("kind", name, parameters, folder, FORCE_ON_BAR)
        return Custom(load=load, block=block, tilt=tilt, force=force)
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
    """The keys of a drive in a scene file, without those that have no effect."""
    if isinstance(drive, Custom):
        table = {"kind": plugins.name_of(drive.force, {})} | drive.force._asdict()
        table |= {"block": True} if drive.block else {}
        table |= {"tilt": drive.tilt} if drive.tilts else {}
        return table if drive.load is None else table | {"load": table_of(drive)["load"]}
    absent = () if drive.block else drive.of_block
    absent = absent if drive.tilts else (*absent, "tilt")
    own = {k: v for k, v in table_of(drive).items() if v is not False and k not in absent}
    return {"kind": drive.kind} | own
