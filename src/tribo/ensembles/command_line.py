"""The words of the command `tribo ensemble`: distributions, and a summary of the members."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.validation import must_be

if TYPE_CHECKING:
    import xarray

# The form of an argument of --vary.
VARIED = re.compile(r"\s*(?P<key>[^=\s]+)\s*=\s*(?P<name>\w+)\((?P<numbers>[^()]*)\)\s*")

# The same in words.
FORM = "KEY=normal(MEAN,DEVIATION) or KEY=uniform(LOW,HIGH), with DEVIATION > 0 and LOW < HIGH"


def _normal(mean: float, deviation: float) -> Any:
    from scipy import stats

    return stats.norm(mean, deviation)


def _uniform(low: float, high: float) -> Any:
    from scipy import stats

    return stats.uniform(low, high - low)


# The distributions by name: normal(mean, standard deviation) and uniform(low, high).
DISTRIBUTIONS: dict[str, Callable[[float, float], Any]] = {"normal": _normal, "uniform": _uniform}


def varied(text: str) -> tuple[str, Any]:
    """A key and its distribution, from "upper.theta=normal(0,0.1)".  Raises InputError."""
    found = VARIED.fullmatch(text)
    try:
        assert found is not None
        first, second = map(float, found["numbers"].split(","))
        distribution = DISTRIBUTIONS[found["name"]]
    except (AssertionError, ValueError, KeyError):
        raise must_be("--vary", FORM, text) from None
    if not second > (first if found["name"] == "uniform" else 0.0):
        raise must_be("--vary", FORM, text)
    return found["key"], distribution(first, second)


def summary_of_means(data: xarray.Dataset) -> str:
    """The means at the end, with the half-widths of their 95 % intervals."""
    lines = [f"{data.sizes['member']} members", f"{'quantity':<28} {'mean':>13} {'half-width':>13}"]
    for name in map(str, data.data_vars):
        if name.endswith("_half_width") and f"{(of := name[:-11])}_mean" in data:
            mean, half_width = (float(data[f"{of}_{what}"][-1]) for what in ("mean", "half_width"))
            lines.append(f"{of:<28} {mean:>13.6g} {half_width:>13.2g}")
    lines.append(f"{data.attrs['seconds']:.2f} s by {data.attrs['method']}")
    return "\n".join(lines)


def summary(data: xarray.Dataset, names: list[str]) -> str:
    """The numbers of members by status, and mean and standard deviation of each quantity."""
    statuses, counts = np.unique(data["status"].values, return_counts=True)
    lines = [f"{count} {status}" for status, count in zip(statuses, counts, strict=True)]
    lines.append(f"{'quantity':<28} {'mean':>13} {'deviation':>13}")
    for name in names:
        values = data[name if name in data.data_vars else f"{name}_end"].values
        lines.append(f"{name:<28} {np.nanmean(values):>13.6g} {np.nanstd(values):>13.6g}")
    lines.append(f"{data.attrs['seconds']:.2f} s by {data.attrs['method']}")
    return "\n".join(lines)
