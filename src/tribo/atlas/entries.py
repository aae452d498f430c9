"""The entries of the atlas: a scene file, a declared outcome and a reference for each."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from tribo.model.scene import Scene
from tribo.model.scene_file import load_scene
from tribo.validation import one_of

FOLDER = Path(__file__).parent
# The key of a reference for the time at which a run stops; other keys are as "upper.theta".
STOP_TIME = "t"


@dataclass(frozen=True)
class HardScene:
    """A hard scene, how its run should end, and what its end should be."""

    name: str  # of the scene file, without its folder and suffix
    declared: str  # "completed", "completed, accuracy not met", or the status that stops the run
    bound: float  # largest error, in scales of the quantities; of a stop's time, in durations
    # "surface.quantity" -> digits at the end for each asperite, or "t" -> of a stop's time
    reference: Mapping[str, tuple[str, ...]]
    source: str  # where the reference comes from
    failure: str  # how a simple integrator fails on the scene

    @property
    def path(self) -> Path:
        """The scene file."""
        return FOLDER / "scenes" / f"{self.name}.toml"

    def scene(self) -> Scene:
        """The scene, with its own accuracy or method."""
        return load_scene(self.path)


@cache
def all_entries() -> dict[str, HardScene]:
    """Every entry by its name, in the order of the file."""
    tables = tomllib.loads((FOLDER / "entries.toml").read_text(encoding="utf-8"))
    return {name: _entry(name, table) for name, table in tables.items()}


def _entry(name: str, table: dict[str, object]) -> HardScene:
    """The scene of a table in the atlas's file.

    Reference values get keys such as "upper.w1"; each is a tuple of one value or of several.
    """
    given = table.pop("reference")
    assert isinstance(given, dict)
    reference = {}
    for key, value in given.items():
        quantities = value if isinstance(value, dict) else {"": value}
        for quantity, digits in quantities.items():
            several = tuple(digits) if isinstance(digits, list) else (digits,)
            reference[f"{key}.{quantity}" if quantity else key] = several
    return HardScene(name=name, reference=reference, **table)  # type: ignore[arg-type]


def chosen(names: Sequence[str] = ()) -> list[HardScene]:
    """Entries by their names; all of them without names. Raises InputError for an unknown name."""
    entries = all_entries()
    return [entries[one_of("name", name, entries)] for name in names or entries]
