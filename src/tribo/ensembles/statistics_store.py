"""A store that accumulates statistics of members, and keeps none of them."""

from __future__ import annotations

import copy
import io
import json
import time
from dataclasses import asdict
from typing import TYPE_CHECKING
from zipfile import BadZipFile

import numpy as np

from tribo.ensembles.kept_values import Kept, KeptValues, Tally, times_of
from tribo.ensembles.members import Members
from tribo.ensembles.statistics import COARSE, PROBABILITIES, Moments, Statistics
from tribo.ensembles.stores import About, Target
from tribo.files import replace_file
from tribo.kernels.status import Status
from tribo.loops.journal import INTERVAL, RELATIVE_INTERVAL
from tribo.model.identity import refuse_other
from tribo.results.dataset import Variable
from tribo.results.intervals import student
from tribo.validation import InputError

if TYPE_CHECKING:
    import xarray

# Bytes of all covariances, above which statistics are refused: their sums and those of a block are
# in memory together.
MOST_BYTES = 2**29


class StatisticsStore:
    """A store of statistics; see :class:`tribo.ensembles.stores.Store`.

    Parameters
    ----------
    about : About
        What is known of the ensemble.
    target : Target, optional
        Files, of which one keeps the sums once a second, or less often where that takes long.
    resume : bool
        Whether to continue from the sums in that file, if there is one.

    Raises
    ------
    InputError
        The file is of another ensemble or cannot be read; or covariances are too many.
    """

    def __init__(self, about: About, target: Target | None, resume: bool) -> None:
        self._about = about
        self._target = target
        self._statistics = Statistics(about.kept)
        self._written = time.perf_counter()
        self._took = 0.0  # to write all sums, which may be hundreds of megabytes
        self.done = 0
        columns = sum(map(about.kept.columns, about.kept.names))
        if 8 * about.kept.times * columns**2 > MOST_BYTES:
            raise InputError(
                "statistics",
                f"would keep covariances of {columns} values at {about.kept.times} times, more "
                "than memory holds; keep fewer quantities or times",
            )
        if target is not None and resume and target.part.exists():
            self._restore(target)

    def add(self, members: Members, found: KeptValues) -> None:
        """Take in the next members."""
        self._statistics.add(found.values, found.status == Status.COMPLETED)
        level = self._about.common_level
        self._statistics.tally.add(found.status, found.level, found.error, level)
        self.done += members.numbers.size
        waited = time.perf_counter() - self._written
        if waited > max(INTERVAL, RELATIVE_INTERVAL * self._took):
            self._save()

    def dataset(self, interrupted: bool, seconds: float) -> xarray.Dataset:
        """The statistics of all members so far.

        Raises KeyboardInterrupt or InputError if no member is complete.
        """
        import xarray

        self._save()
        whole = copy.copy(self._statistics)
        whole.waiting = list(whole.waiting)
        whole.merge()
        about, moments = self._about, whole.moments
        if moments is None:
            if interrupted:
                raise KeyboardInterrupt
            raise InputError("scene", "is completed by no member")
        variables = _variables(about.kept, moments)
        coordinates = times_of(about.kept, about.simulation) | {
            "probability": (("probability",), PROBABILITIES, {"long_name": "probability"}),
            "value": (("value",), np.array(_labels(about.kept)), {"long_name": "kept value"}),
        }
        attributes = about.attributes_at_end(whole.tally, interrupted, seconds)
        data = xarray.Dataset(variables, coordinates, attributes)
        if self._target is not None and not interrupted:
            data.attrs["identity"] = json.dumps(self._target.identity)
            replace_file(self._target.path, bytes(data.to_netcdf(engine="h5netcdf")))
            self._target.part.unlink(missing_ok=True)
        return data

    def _save(self) -> None:
        """Write all sums, if there is a file."""
        if self._target is None:
            return
        began = time.perf_counter()
        known = {
            "identity": self._target.identity,
            "done": self.done,
            "tally": asdict(self._statistics.tally),
        }
        content = io.BytesIO()
        arrays = {"known": np.array(json.dumps(known)), **self._statistics.arrays()}
        np.savez(content, **arrays)  # type: ignore[arg-type]
        replace_file(self._target.part, content.getvalue())
        self._written = time.perf_counter()
        self._took = self._written - began

    def _restore(self, target: Target) -> None:
        """Continue from the sums in the file.  Raises InputError."""
        try:
            with np.load(target.part, allow_pickle=False) as file:
                arrays = dict(file)
            known = json.loads(str(arrays.pop("known")))
        except (OSError, ValueError, KeyError, BadZipFile):
            raise InputError(
                str(target.part), "is not the file of statistics; start again without resume"
            ) from None
        refuse_other(target.part, known["identity"], json.loads(json.dumps(target.identity)))
        self.done = known["done"]
        self._statistics.tally = Tally(**known["tally"])
        self._statistics.restore(arrays)


def _labels(kept: Kept) -> list[str]:
    """The name of each column, "upper.w1[0]" for one asperite."""
    labels = []
    for name in kept.names:
        one_each = f"{name.rpartition('.')[0]}_asperite" in kept.dimensions(name)
        labels += [f"{name}[{k}]" if one_each else name for k in range(kept.columns(name))]
    return labels


def _variables(kept: Kept, moments: Moments) -> dict[str, Variable]:
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
