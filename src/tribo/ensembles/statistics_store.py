"""A store that accumulates statistics of members, and keeps none of them."""

from __future__ import annotations

import json
import time
from dataclasses import asdict, fields

import numpy as np

from tribo.ensembles.kept_values import Kept, KeptValues, Tally
from tribo.ensembles.statistics import COARSE, PROBABILITIES, Moments
from tribo.kernels.status import Status
from tribo.loops.frames import INTERVAL, RELATIVE_INTERVAL, Frames, as_bytes
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


class StatisticsStore:
    """Accumulates statistics of members, which arrive in order; `done` is their number.

    `common_level` is the level of most members; NaN where each has its own settings.  Frames take
    the sums once a second, or less often where that takes long, and have those of an earlier call.
    Raises InputError if covariances are too many.
    """

    def __init__(self, kept: Kept, common_level: float, frames: Frames | None) -> None:
        self._kept, self._level, self._frames = kept, common_level, frames
        self._merged: Moments | None = None
        self._waiting: list[np.ndarray] = []  # (members, times, columns), for the next block
        self._written = time.perf_counter()
        self._took = 0.0  # to write all sums, which may be hundreds of megabytes
        self.tally = Tally()
        self.done = 0
        columns = sum(map(kept.columns, kept.names))
        if 8 * kept.times * columns**2 > MOST_BYTES:
            raise InputError(
                "statistics",
                f"would keep covariances of {columns} values at {kept.times} times, more "
                "than memory holds; keep fewer quantities or times",
            )
        for arrays in () if frames is None else frames.read():
            assert frames is not None
            frames.name_last(SUMS)
            known = json.loads(arrays.pop("known").tobytes())
            self.done, self.tally = known["done"], Tally(**known["tally"])
            self._waiting = [arrays["waiting"]] if "waiting" in arrays else []
            if "mean" in arrays:
                self._merged = Moments(*(arrays[each.name] for each in fields(Moments)))

    def add(self, found: KeptValues) -> None:
        """Take in the next members."""
        complete = found.status == Status.COMPLETED
        shape = (np.count_nonzero(complete), self._kept.times, -1)
        parts = [found.values[name][complete].reshape(shape) for name in self._kept.names]
        self._waiting.append(np.concatenate(parts, axis=2))
        if sum(map(len, self._waiting)) >= BLOCK:
            self._merged, self._waiting = self.moments(), []
        self.tally.add(found, self._level)
        self.done += found.status.size
        waited = time.perf_counter() - self._written
        if waited > max(INTERVAL, RELATIVE_INTERVAL * self._took):
            self.flush()

    def flush(self) -> None:
        """Write all sums, if there is a file."""
        if self._frames is None:
            return
        began = time.perf_counter()
        known = {"done": self.done, "tally": asdict(self.tally)}
        arrays = {"known": as_bytes(json.dumps(known))}
        if self._waiting:
            arrays["waiting"] = np.concatenate(self._waiting)
        if self._merged is not None:
            arrays |= {each.name: getattr(self._merged, each.name) for each in fields(Moments)}
        self._frames.append(SUMS, arrays)
        self._written = time.perf_counter()
        self._took = self._written - began

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
    for name in kept.names:
        columns = slice(first, first + kept.columns(name))
        first = columns.stop
        dimensions, shape = kept.dimensions(name), kept.shapes[kept.names.index(name)]
        for kind, (values, meaning) in of_columns.items():
            about = {**kept.about(name), "long_name": meaning + kept.about(name)["long_name"]}
            if kind == "variance":
                about["units"] = f"({about['units']})^2"
            variables[f"{name}_{kind}"] = dimensions, values[:, columns].reshape(shape), about
        about = {**kept.about(name), "long_name": "quantile of: " + kept.about(name)["long_name"]}
        found = quantiles[:, :, columns].reshape(-1, *shape)
        variables[f"{name}_quantile"] = ("probability", *dimensions), found, about
        variables |= _histogram(kept, name, moments, columns)
    return variables


def _histogram(kept: Kept, name: str, moments: Moments, columns: slice) -> dict[str, Variable]:
    """Counts and edges of a quantity's bins, which are the same multiples of each column's unit."""
    places = np.arange(moments.mean.size).reshape(moments.mean.shape)[:, columns].ravel()
    found = [moments.bins_of(int(place)) for place in places]
    first = min(int(bins[0]) for bins, _ in found) // COARSE
    last = max(int(bins[-1]) for bins, _ in found) // COARSE
    counts = np.zeros((places.size, last - first + 1), np.int64)
    for row, (bins, each) in zip(counts, found, strict=True):
        np.add.at(row, bins // COARSE - first, each)
    bounds = COARSE * np.arange(first, last + 2)
    edges = np.array([moments.edges(bounds, int(place)) for place in places])
    dimensions, shape = kept.dimensions(name), kept.shapes[kept.names.index(name)]
    meaning = kept.about(name)
    return {
        f"{name}_count": (
            (*dimensions, f"{name}_bin"),
            counts.reshape(*shape, -1),
            {"long_name": f"members in each bin of: {meaning['long_name']}"},
        ),
        f"{name}_edge": (
            (*dimensions, f"{name}_bin_edge"),
            edges.reshape(*shape, -1),
            {**meaning, "long_name": f"edges of the bins of: {meaning['long_name']}"},
        ),
    }
