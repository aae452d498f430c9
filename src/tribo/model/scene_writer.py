"""Parts of scenes as nested tables of TOML: the inverse of :mod:`tribo.model.scene_file`."""

import re
from typing import Any

from tribo.model import bars, bath, drive_tables
from tribo.model.settings import Numerics, Output
from tribo.model.surface import Surface
from tribo.model.tables import table_of
from tribo.model.topography import Topography

# A list of at most four numbers, as tomli-w writes it: one a line.  A string contains no new line.
SHORT_LIST = re.compile(r"\[\n((?: +[-+.\w]+,\n){1,4}) *\]")


def toml(table: dict[str, Any]) -> bytes:
    """The text of a table, with positions and velocities in a line each."""
    import tomli_w

    def in_a_line(found: re.Match[str]) -> str:
        return f"[{' '.join(found[1].split()).removesuffix(',')}]"

    return SHORT_LIST.sub(in_a_line, tomli_w.dumps(table)).encode("utf-8")


def output_table(output: Output) -> dict[str, Any]:
    """The table of a scene's output, without what is not given."""
    table = table_of(output)
    if output.times is not None:
        del table["samples"]
    return {key: value for key, value in table.items() if value or key not in ("series", "run_in")}


def surface_table(surface: Surface) -> dict[str, Any]:
    """The table of a surface, with the heights of topographies as numbers."""
    table = table_of(surface)
    table["drive"] = drive_tables.as_table(surface.drive)
    table["bars"] = bars.bars_as_table(surface.bars)
    table["bath"] = bath.as_table(surface.bath)
    if isinstance(surface.heights, Topography):
        table["heights"] = surface.heights.heights.tolist()
    if surface.positions is not None:
        for key in ("bob", "shape", "spacing", "depth"):
            del table[key]
    return table


def without_defaults(table: dict[str, Any]) -> dict[str, Any]:
    """The table of a scene without the values that a file need not give."""
    usual = {"seed": 0, "output": output_table(Output()), "numerics": table_of(Numerics())}
    short = _others(table, usual | {"periodic": {}, "field": []})
    short["surface"] = [
        {"name": each["name"]} | _others(each, surface_table(Surface(each["name"])))
        for each in table["surface"]
    ]
    if len(table["interaction"]) == 1:
        short["interaction"] = table["interaction"][0]
    return short


def _others(table: dict[str, Any], usual: dict[str, Any]) -> dict[str, Any]:
    """The entries that differ; of a table with a kind, all of them."""
    found: dict[str, Any] = {}
    for key, value in table.items():
        default = usual.get(key)
        if key in usual and value == default:
            continue
        is_part = isinstance(value, dict) and isinstance(default, dict) and "kind" not in value
        found[key] = _others(value, default) if is_part and default else value
    return found
