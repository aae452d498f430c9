"""The ledger of a run, or its end, as a table of pandas."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tribo.results.run_result import RunResult

if TYPE_CHECKING:
    import pandas


def ledger_table(result: RunResult) -> pandas.DataFrame:
    """All series; see :meth:`tribo.Result.to_pandas`."""
    import pandas

    columns: dict[tuple[str, int | str, str], np.ndarray] = {}
    for name, table in result.ledger.surfaces.items():
        for quantity, values in table.items():
            if len(values) == len(result.t):  # else only the first and the last sample are kept
                columns |= {(name, k, quantity): values[:, k] for k in range(values.shape[1])}
    for name, table in result.ledger.blocks.items():
        columns |= {(name, "all", quantity): values for quantity, values in table.items()}
    columns |= {("system", "all", quantity): values for quantity, values in result.system.items()}
    names = ["surface", "asperite", "quantity"]
    frame = pandas.DataFrame(columns, index=pandas.Index(result.t, name="t"))
    frame.columns = pandas.MultiIndex.from_tuples(list(columns), names=names)
    return frame


def end_table(result: RunResult) -> pandas.DataFrame:
    """The end state: a row for each asperite, a column for each of its quantities."""
    import pandas

    ends = result.ledger.at_end().surfaces
    frames = {
        name: pandas.DataFrame({key: values[-1] for key, values in table.items()})
        for name, table in ends.items()
    }
    return pandas.concat(frames, names=["surface", "asperite"])
