"""The ledger of a run, or its end, as a table of pandas or as CSV."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tribo.files import replace_file
from tribo.results.run_result import RunResult

if TYPE_CHECKING:
    import pandas


def ledger_table(result: RunResult) -> pandas.DataFrame:
    """All series; see :meth:`tribo.Result.to_pandas`."""
    import pandas

    columns = {
        (surface or "system", "all" if k is None else k, quantity): values
        for surface, k, quantity, values in _columns(result)
    }
    names = ["surface", "asperite", "quantity"]
    frame = pandas.DataFrame(columns, index=pandas.Index(result.t, name="t"))
    frame.columns = pandas.MultiIndex.from_tuples(list(columns), names=names)
    return frame


def save_csv(result: RunResult, path: Path) -> None:
    """Write all series; see :meth:`tribo.Result.save`.  Raises InputError."""
    import pandas

    several = [surface.name for surface in result.scene.surfaces if surface.count > 1]
    columns = {"time": result.t}
    for surface, k, quantity, values in _columns(result):
        number = "" if k is None or surface not in several else f"[{k}]"
        columns[f"{surface}.{quantity}{number}" if surface else quantity] = values
    text = pandas.DataFrame(columns).to_csv(index=False, na_rep="nan", lineterminator="\n")
    replace_file(path, text.encode())


def end_table(result: RunResult) -> pandas.DataFrame:
    """The end state: a row for each asperite, a column for each of its quantities."""
    import pandas

    frames = {}
    for name, table in result.ledger.at_end().surfaces.items():
        ends = {key: values[-1] for key, values in table.items()}
        frames[name] = pandas.DataFrame(ends)
    return pandas.concat(frames, names=["surface", "asperite"])


def _columns(result: RunResult) -> Iterator[tuple[str, int | None, str, np.ndarray]]:
    """Surface, asperite, quantity and values (times,) of every series that has all times.

    The asperite of a whole surface is None, the surface of the system is empty.
    """
    for surface in result.ledger.surfaces:
        for quantity, values in result[surface].items():
            if values.ndim == 1:
                yield surface, None, quantity, values
            elif len(values) == result.t.size:  # else only the first and the last sample are kept
                yield from ((surface, k, quantity, each) for k, each in enumerate(values.T))
    yield from (("", None, quantity, values) for quantity, values in result.system.items())
