"""A store that accumulates statistics of members, and keeps none of them."""

from __future__ import annotations

import json
from dataclasses import fields

import numpy as np

from tribo.ensembles.kept_values import Kept, KeptValues, Tally, completed
from tribo.ensembles.statistics import COARSE, PROBABILITIES, Moments
from tribo.ensembles.stores import Store
from tribo.loops.frames import Frames, as_bytes
from tribo.results.dataset import Variable
from tribo.results.intervals import student
from tribo.validation import InputError

# Bytes of all covariances, above which statistics are refused: their sums and those of a block are
# in memory together.
MOST_BYTES = 2**29
# Members that are merged at once, at least: the merge of one costs as much as that of some 1000.
BLOCK = 1024
# The frame of all sums.
SUMS = "sums"


class StatisticsStore(Store):
    """Accumulates statistics of members.  Raises InputError if covariances are too many."""

    def __init__(self, kept: Kept, frames: Frames | None, common_level: float = np.nan) -> None:
        self._kept = kept
        self._merged: Moments | None = None
        self._waiting: list[np.ndarray] = []  # (members, times, columns), for the next block
        columns = sum(map(kept.columns, kept.names))
        if 8 * kept.times * columns**2 > MOST_BYTES:
            raise InputError(
                "statistics",
                f"would keep covariances of {columns} values at {kept.times} times, more "
                "than memory holds; keep fewer quantities or times",
            )
        super().__init__(frames, common_level)

    def _take(self, found: KeptValues) -> None:
        complete = completed(found)
        shape = (np.count_nonzero(complete), self._kept.times, -1)
        parts = [found[name][complete].reshape(shape) for name in self._kept.names]
        self._waiting.append(np.concatenate(parts, axis=2))
        if sum(map(len, self._waiting)) >= BLOCK:
            self._merged, self._waiting = self.moments(), []

    def _take_back(self, arrays: KeptValues) -> None:
        known = json.loads(arrays["known"].tobytes())
        self.done, self.tally = known["done"], Tally(known["tally"])
        self._waiting = [arrays["waiting"]] if "waiting" in arrays else []
        if "mean" in arrays:
            self._merged = Moments(*(arrays[each.name] for each in fields(Moments)))

    def flush(self) -> None:
        """Write all sums, if there is a file."""
        if self._frames is None:
            return
        arrays = {"known": as_bytes(json.dumps({"done": self.done, "tally": self.tally}))}
        if self._waiting:
            arrays["waiting"] = np.concatenate(self._waiting)
        if self._merged is not None:
            arrays |= {each.name: getattr(self._merged, each.name) for each in fields(Moments)}
        self._frames.append(SUMS, arrays)

    def moments(self) -> Moments | None:
        """Those of all complete members so far; None without any."""
        values = np.concatenate(self._waiting) if self._waiting else np.empty(0)
        if not len(values):
            return self._merged
        block = Moments.of(values, self._merged)
        return block if self._merged is None else self._merged.merged(block)


def statistics_coordinates(kept: Kept) -> dict[str, Variable]:
    """The probabilities of quantiles, and the names of values in covariances."""
    labels = []
    for name in kept.names:  # "upper.w1[0]" for one asperite
        one_each = f"{name.rpartition('.')[0]}_asperite" in kept.dimensions(name)
        labels += [f"{name}[{k}]" if one_each else name for k in range(kept.columns(name))]
    return {
        "probability": (("probability",), PROBABILITIES, {"long_name": "probability"}),
        "value": (("value",), np.array(labels), {"long_name": "kept value"}),
    }


def statistics_variables(kept: Kept, moments: Moments) -> dict[str, Variable]:
    """The statistics of every quantity."""
    times = ("time",) * kept.at_samples
    covariance = moments.covariance if kept.at_samples else moments.covariance[0]
    about = {"long_name": "covariance of the kept values, over members"}
    variables: dict[str, Variable] = {
        "covariance": ((*times, "value", "other_value"), covariance, about),
        "complete_members": ((), int(moments.count), {"long_name": "members that completed"}),
    }
    variance = np.diagonal(moments.covariance, axis1=1, axis2=2)
    half_width = np.full_like(variance, np.nan)
    if moments.count > 1:
        half_width = student(int(moments.count) - 1) * np.sqrt(variance / moments.count)
    of_columns = {
        "mean": (moments.mean, "mean of: "),
        "half_width": (half_width, "half-width of the 95 % interval of the mean of: "),
        "variance": (variance, "variance of: "),
    }
    quantiles, first = moments.quantiles(), 0
    for name, shape in kept.shapes.items():
        columns = slice(first, first + kept.columns(name))
        first, dimensions = columns.stop, kept.dimensions(name)
        for kind, (values, of) in of_columns.items():
            about = kept.about(name, of)
            if kind == "variance":
                about["units"] = f"({about['units']})^2"
            variables[f"{name}_{kind}"] = dimensions, values[:, columns].reshape(shape), about
        found = quantiles[:, :, columns].reshape(-1, *shape)
        about = kept.about(name, "quantile of: ")
        variables[f"{name}_quantile"] = ("probability", *dimensions), found, about
        counts, edges = _histogram(moments, columns)
        about = {"long_name": kept.about(name, "members in each bin of: ")["long_name"]}
        variables[f"{name}_count"] = (*dimensions, f"{name}_bin"), counts.reshape(*shape, -1), about
        about = kept.about(name, "edges of the bins of: ")
        bounds = (*dimensions, f"{name}_bin_edge")
        variables[f"{name}_edge"] = bounds, edges.reshape(*shape, -1), about
    return variables


def _histogram(moments: Moments, columns: slice) -> tuple[np.ndarray, np.ndarray]:
    """Counts and edges of some columns' bins, which are the same multiples of each one's unit."""
    places = np.arange(moments.mean.size).reshape(moments.mean.shape)[:, columns].ravel().tolist()
    found = [moments.bins_of(place) for place in places]
    first = min(int(bins[0]) for bins, _ in found) // COARSE
    last = max(int(bins[-1]) for bins, _ in found) // COARSE
    counts = np.zeros((len(places), last - first + 1), np.int64)
    for row, (bins, each) in zip(counts, found, strict=True):
        np.add.at(row, bins // COARSE - first, each)
    bounds = COARSE * np.arange(first, last + 2)
    return counts, np.array([moments.edges(bounds, place) for place in places])
