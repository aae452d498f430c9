"""Measured series that a scene is fitted to: arrays, labelled arrays, and CSV files."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tribo.validation import InputError, as_path, short_repr, vector

# Names of columns and dimensions that are times.
TIMES = ("t", "time")


class Trace(NamedTuple):
    """A measured series."""

    t: np.ndarray  # (times,) [time]
    values: np.ndarray  # (times,)


def trace_of(data: Any, quantity: str) -> Trace:
    """The series in (t, values), a DataArray with a dimension of times, or a CSV file.

    Raises InputError if there is none, or its times do not increase.
    """
    if isinstance(data, (str, Path)):
        t, values = _from_csv(as_path(data), quantity)
    elif hasattr(data, "dims") and hasattr(data, "coords"):
        t, values = _from_labels(data)
    elif isinstance(data, (tuple, list)) and len(data) == 2:
        t, values = data
    else:
        wanted = "(t, values), a DataArray over time, or the name of a CSV file"
        raise InputError("data", f"must be {wanted}, got {short_repr(data)}")
    t = vector("data.t", t, unit="time")
    values = vector("data.values", values, size=t.size)
    if t.size < 2 or np.any(np.diff(t) <= 0.0) or t[0] < 0.0:
        raise InputError("data.t", "must be two times or more that increase, from 0 or later")
    return Trace(t, values)


def _from_labels(data: Any) -> tuple[np.ndarray, np.ndarray]:
    array = data.squeeze()
    if len(array.dims) != 1:
        raise InputError("data", f"must have one dimension, of times, got {tuple(data.dims)}")
    (dimension,) = array.dims
    if dimension not in array.coords:
        raise InputError("data", f'must have times as the coordinate of "{dimension}"')
    return array[dimension].values, array.values


def _from_csv(path: Path, quantity: str) -> tuple[np.ndarray, np.ndarray]:
    """Columns of times and of the quantity by their names, or the first two without names."""
    try:
        text = path.read_text(encoding="utf-8-sig")  # Excel begins with a mark
    except OSError as error:
        raise InputError("data", f"{path} cannot be read ({error.strerror or error})") from None
    except UnicodeDecodeError:
        raise InputError("data", f"{path} is not a text file in UTF-8") from None
    numbered = [
        (number, line)
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip() and line.lstrip()[0] != "#"
    ]
    lines = [line for _, line in numbered]
    if not lines:
        raise InputError("data", f"{path} has no rows")
    delimiter = next((mark for mark in ",;\t" if mark in lines[0]), None)
    if delimiter is None:
        rows = [line.split() for line in lines]
    else:
        rows = list(csv.reader(lines, delimiter=delimiter))
    columns = (0, 1)
    if not _is_number(rows[0][0]):
        names = [word.strip() for word in rows.pop(0)]
        columns = _columns_of(names, quantity, path)
        if delimiter and rows and len(_without_end(rows[0])) > len(names):
            raise InputError(
                "data",
                f"{path} must have a name for each column, got {len(names)} names and "
                f"{len(rows[0])} columns in the first row; decimals need points",
            )
    table = []
    for (number, line), row in zip(numbered[-len(rows) :], rows, strict=False):
        try:
            table.append([float(row[k]) for k in columns])
            known = bool(np.isfinite(table[-1]).all())
        except (ValueError, IndexError):
            known = False
        if not known:
            problem = f"{path} must have finite numbers in two columns, time and value, with points"
            quoted = short_repr(line.strip())
            raise InputError(
                "data", f"{problem} before decimals; line {number} is {quoted}; leave out others"
            )
    if not table:
        raise InputError("data", f"{path} has no rows")
    t, values = np.array(table).T
    return t, values


def _without_end(row: list[str]) -> list[str]:
    """A row without the empty cells at its end."""
    filled = [k for k, word in enumerate(row, start=1) if word.strip()]
    return row[: filled[-1] if filled else 0]


def _columns_of(names: list[str], quantity: str, path: Path) -> tuple[int, int]:
    """Which columns are times and values.  Raises InputError if names leave it open."""
    times = [k for k, name in enumerate(names) if name.lower() in TIMES]
    values = [k for k, name in enumerate(names) if name in (quantity, f"{quantity}[0]")]
    if len(times) == 1 and len(values) == 1:
        return times[0], values[0]
    if len(names) == 2:
        return (times[0], 1 - times[0]) if len(times) == 1 else (0, 1)
    raise InputError(
        "data",
        f'{path} must have the columns "time" and "{quantity}", or two columns alone; it has '
        f"{', '.join(names)}",
    )


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
