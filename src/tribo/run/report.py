"""Results for readers: a table in a notebook, and a CSV file."""

from __future__ import annotations

import csv
import html as markup
import io
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tribo.files import replace_file

if TYPE_CHECKING:
    from tribo.run.result import Result

# Quantities of surfaces in the table, where they are kept, and what stands above them.
SHOWN = {
    "W": "work",
    "W_ps": "pseudowork",
    "delta_K": "bulk kinetic energy",
    "delta_E_int": "internal energy",
}


def html(result: Result) -> str:
    """The summary of a result as HTML: what ran, the surfaces at the end, and notes."""
    first, *_ = str(result).splitlines()
    blocks = result.ledger.at_end().blocks
    names = [name for name in SHOWN if all(name in block for block in blocks.values())]
    rows = [_row(["surface", *(SHOWN[name] for name in names)], "th")]
    for surface, block in blocks.items():
        rows.append(_row([surface, *(f"{block[name][-1]:.6g}" for name in names)]))
    bounds = [result.error_estimate.get(name) for name in names]
    if any(bound is not None for bound in bounds):
        rows.append(_row(["error below", *("" if b is None else f"{b:.1e}" for b in bounds)]))
    notes = "".join(f"<li>{markup.escape(note)}</li>" for note in result.notes)
    after = f"<ul>{notes}</ul>" if notes else ""
    return f"<p>{markup.escape(first)}</p><table>{''.join(rows)}</table>{after}"


def _row(cells: list[str], tag: str = "td") -> str:
    return f"<tr>{''.join(f'<{tag}>{markup.escape(cell)}</{tag}>' for cell in cells)}</tr>"


def save_csv(result: Result, path: Path) -> None:
    """Write all series as a table with a row for each time.  Raises InputError."""
    columns = dict(_columns(result))
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*(column.tolist() for column in columns.values()), strict=True))
    replace_file(path, text.getvalue().encode())


def _columns(result: Result) -> Iterator[tuple[str, np.ndarray]]:
    """The columns of the table; series of which only both ends are kept are left out."""
    yield "time", result.t
    for surface in result.ledger.surfaces:
        for name, values in result[surface].items():
            if len(values) != result.t.size:
                continue
            if values.ndim == 1 or values.shape[1] == 1:
                yield f"{surface}.{name}", values.reshape(-1)
                continue
            for index, column in enumerate(values.T):
                yield f"{surface}.{name}[{index}]", column
    yield from result.system.items()
