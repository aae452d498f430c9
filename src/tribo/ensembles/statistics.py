"""Statistics of more members than memory holds: moments, quantiles and histograms.

Means and covariances are merged block by block.  With n_a, mean_a and sum of products S_a of one
block, and d = mean_b - mean_a,

    mean = mean_a + d n_b / n ,   S = S_a + S_b + d d^T n_a n_b / n ,   n = n_a + n_b .

T. F. Chan, G. H. Golub, R. J. LeVeque, The American Statistician 37 (1983) 242.

Quantiles and histograms come from counts in bins of equal width in asinh((x - centre) / unit),
where centre and unit are mean and standard deviation of the first block.  So the bins are as wide
as a fraction of the standard deviation near the centre, and as a fraction of the distance from it
far away, and cover all numbers.  This is the idea of DDSketch (C. Masson, J. E. Rim, H. K. Lee,
Proc. VLDB Endow. 12 (2019) 2195), whose bins are relative to zero.  Counts are integers, so their
sums do not depend on any order.

A value that some member lacks, as a force with white noise at t = 0, has no mean, covariance or
quantile; bins count the members that have it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tribo.ensembles.kept_values import Kept
from tribo.results.averages import student
from tribo.results.result_file import Variable

# Bins for a unit of asinh: a bin near the centre is 1/256 of a standard deviation wide.
FINE = 256
# Fine bins in one of a histogram: 1/16 of a standard deviation.
COARSE = 16
# Numbers of a column's bins in the keys of all columns: asinh of the largest double is 710.
BINS = 2**20
# Probabilities of the quantiles that are reported; 0 and 1 are the smallest and largest value.
PROBABILITIES = np.array([0.0, 1e-3, 0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 0.999, 1.0])


@dataclass(eq=False)
class Moments:
    """Sums over the complete members, of columns at each time: of a quantity, or of one asperite's.

    Arrays are (times, columns), `products` of deviations (times, columns, columns).  `keys` and
    `counts` are the occupied bins, ascending, and their members: a key is the index of the time and
    column times `BINS`, plus that of the bin, which begins at -BINS / 2.
    """

    count: np.ndarray
    mean: np.ndarray
    lowest: np.ndarray
    highest: np.ndarray
    products: np.ndarray
    centre: np.ndarray
    unit: np.ndarray
    keys: np.ndarray
    counts: np.ndarray

    @classmethod
    def of(cls, values: np.ndarray, like: Moments | None = None) -> Moments:
        """Those of values (members, times, columns), with the bins of `like`."""
        mean = values.mean(axis=0)
        off = values - mean
        products = np.matmul(np.moveaxis(off, 0, 2), np.moveaxis(off, 0, 1))
        if like is None:
            spread = np.std(values, axis=0)
            centre = np.where(np.isfinite(mean), mean, 0.0)
            unit = np.where(spread > 0.0, spread, np.where(centre, np.abs(centre), 1.0))
        else:
            centre = like.centre
            unit = like.unit
        known = np.isfinite(values)
        places = FINE * np.arcsinh(np.where(known, values - centre, 0.0) / unit)
        bins = np.floor(places).astype(np.int64) + BINS // 2
        columns = BINS * np.arange(mean.size).reshape(mean.shape)
        keys, counts = np.unique((bins + columns)[known], return_counts=True)
        lowest = values.min(axis=0)
        highest = values.max(axis=0)
        count = np.array(len(values))
        return cls(count, mean, lowest, highest, products, centre, unit, keys, counts)

    def merged(self, other: Moments) -> Moments:
        """Those of both; `other` has the same bins."""
        count = self.count + other.count
        off = other.mean - self.mean
        share = other.count / count
        between = off[:, :, None] * off[:, None, :] * (self.count * share)
        keys, places = np.unique(np.append(self.keys, other.keys), return_inverse=True)
        counts = np.zeros(keys.size, np.int64)
        np.add.at(counts, places, np.append(self.counts, other.counts))
        return Moments(
            count,
            self.mean + off * share,
            np.minimum(self.lowest, other.lowest),
            np.maximum(self.highest, other.highest),
            self.products + other.products + between,
            self.centre,
            self.unit,
            keys,
            counts,
        )

    @property
    def covariance(self) -> np.ndarray:
        """Between columns, (times, columns, columns); NaN of fewer than two members."""
        if self.count < 2:
            return np.full_like(self.products, np.nan)
        return self.products / (self.count - 1)

    def edges(self, bins: np.ndarray, column: int) -> np.ndarray:
        """Lower edges of bins of one time and column, from its index among all."""
        centre = self.centre.flat[column]
        unit = self.unit.flat[column]
        return centre + unit * np.sinh((bins - BINS // 2) / FINE)

    def bins_of(self, column: int) -> tuple[np.ndarray, np.ndarray]:
        """The occupied bins of one time and column, and their counts."""
        first, last = np.searchsorted(self.keys, [BINS * column, BINS * (column + 1)])
        return self.keys[first:last] - BINS * column, self.counts[first:last]

    def quantiles(self) -> np.ndarray:
        """Values at the PROBABILITIES, (probabilities, times, columns), in the exact ones' bins."""
        found = np.empty((PROBABILITIES.size, self.mean.size))
        ranks = PROBABILITIES * (self.count - 1)
        for column in range(self.mean.size):
            bins, counts = self.bins_of(column)
            if not bins.size:
                found[:, column] = np.nan
                continue
            until = np.cumsum(counts)
            place = np.minimum(np.searchsorted(until, ranks, "right"), bins.size - 1)
            inside = (ranks - (until - counts)[place] + 0.5) / counts[place]
            low, high = (self.edges(bins[place] + k, column) for k in (0, 1))
            found[:, column] = low + np.clip(inside, 0.0, 1.0) * (high - low)
        shape = (PROBABILITIES.size, *self.mean.shape)
        found = np.clip(found.reshape(shape), self.lowest, self.highest)
        found[0] = self.lowest
        found[-1] = self.highest
        return found


def coordinates_of(kept: Kept) -> dict[str, Variable]:
    """The probabilities of quantiles, and the names of values in covariances."""
    labels = []
    for name in kept.names:  # "upper.w1[0]" for one asperite
        one_each = f"{name.rpartition('.')[0]}_asperite" in kept.dimensions(name)
        labels += [f"{name}[{k}]" if one_each else name for k in range(kept.columns(name))]
    return {
        "probability": (("probability",), PROBABILITIES, {"long_name": "probability"}),
        "value": (("value",), np.array(labels), {"long_name": "kept value"}),
    }


def variables_of(kept: Kept, moments: Moments) -> dict[str, Variable]:
    """The statistics of every quantity."""
    times = ("time",) if kept.at_samples else ()
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
    quantiles = moments.quantiles()
    first = 0
    for name, shape in kept.shapes.items():
        columns = slice(first, first + kept.columns(name))
        first = columns.stop
        dimensions = kept.dimensions(name)
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
    """Counts and edges of some columns' bins, which are the same multiples of each one's unit.

    Edges are NaN where no member has a value.
    """
    places = np.arange(moments.mean.size).reshape(moments.mean.shape)[:, columns].ravel().tolist()
    found = [moments.bins_of(place) for place in places]
    ends = [(int(bins[0]), int(bins[-1])) for bins, _ in found if bins.size] or [
        (BINS // 2, BINS // 2)
    ]
    first = min(low for low, _ in ends) // COARSE
    last = max(high for _, high in ends) // COARSE
    counts = np.zeros((len(places), last - first + 1), np.int64)
    for row, (bins, each) in zip(counts, found, strict=True):
        np.add.at(row, bins // COARSE - first, each)
    bounds = COARSE * np.arange(first, last + 2)
    edges = np.array([moments.edges(bounds, place) for place in places])
    edges[[not bins.size for bins, _ in found]] = np.nan
    return counts, edges
