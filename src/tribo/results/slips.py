"""The slips of a surface that a stage pulls: when its springs suddenly relax."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from tribo.results.averages import CONFIDENCE, SampleMean, sample_mean
from tribo.results.run_result import RunResult, begin_of
from tribo.results.stage import (
    Leg,
    legs_of,
    places_of_bars,
    pull_of,
    stiffness_of,
    table_of,
    turning_points,
)
from tribo.validation import POSITIVE, InputError, integer, number, one_of

if TYPE_CHECKING:
    import xarray

# Part of the range of the force by which it falls in a slip, at least.
LEAST = 0.25
# Samples in the fall of a slip, below which its forces depend on the samples.
RESOLVED = 3.0
# Columns of the table: unit and meaning.
COLUMNS = {
    "time": ("time", "time at which the force begins to fall"),
    "duration": ("time", "time until it grows again"),
    "size": ("length", "displacement of the bars in that time, in the direction of the stage"),
    "force_before": ("force", "force of the springs before the slip, along x"),
    "force_after": ("force", "the same when it grows again"),
    "drop": ("force", "fall of the force in the direction of the stage"),
    "energy": ("energy", "energy that the springs lose"),
}


class Slips(NamedTuple):
    """The slips of a surface.

    Attributes
    ----------
    table : xarray.Dataset
        ``time``, ``duration``, ``size``, ``force_before``, ``force_after``, ``drop`` and
        ``energy`` (slip,).
    least : float
        The smallest fall of the force that counts as a slip [force].
    note : str
        What to know of them; else empty.
    """

    table: xarray.Dataset
    least: float
    note: str = ""

    def mean(self, name: str) -> SampleMean:
        """The mean of a column with the half-width of its 95 % interval, as of independent slips.

        Raises InputError for another name.
        """
        return sample_mean(self.table[one_of("name", name, COLUMNS)].values)

    def distribution(self, name: str, bins: int = 10) -> xarray.Dataset:
        """The distribution of a column.

        Parameters
        ----------
        name : str
            A column of the table.
        bins : int
            Number of bins of equal width, from the smallest to the largest value.

        Returns
        -------
        xarray.Dataset
            ``share`` (bin,) of the slips in a bin, with ``share_low`` and ``share_high`` of its
            95 % interval by C. J. Clopper and E. S. Pearson, Biometrika 26 (1934) 404, as of
            independent slips; and the edges ``low`` and ``high`` (bin,) of the bins.
        """
        import xarray
        from scipy.special import betaincinv

        integer("bins", bins, 1, 100_000)
        values = self.table[one_of("name", name, COLUMNS)].values
        unit, _ = COLUMNS[name]
        counts, edges = np.histogram(values, bins)
        total = counts.sum()
        tail = 0.5 * (1.0 - CONFIDENCE)
        with np.errstate(invalid="ignore"):
            low = np.where(counts > 0, betaincinv(counts, total - counts + 1, tail), 0.0)
            high = np.where(counts < total, betaincinv(counts + 1, total - counts, 1.0 - tail), 1.0)
        share = {"units": "1", "long_name": f"share of slips by {name}"}
        variables = {
            "share": ("bin", counts / total, share),
            "share_low": ("bin", low, share),
            "share_high": ("bin", high, share),
        }
        edge = {"units": unit}
        places = {"low": ("bin", edges[:-1], edge), "high": ("bin", edges[1:], edge)}
        return xarray.Dataset(variables, places)


def slips(
    result: RunResult,
    surface: str,
    least: float | None = None,
    after: float | None = None,
    asperite: int | None = None,
) -> Slips:
    """The slips of a surface that springs to a stage pull along x.

    A slip is a fall of the springs' force by `least` or more, in the direction in which the stage
    moves, in which the bars get farther than ever before in that direction; oscillations
    after a slip are none.  The forces before and after are the largest and the smallest of a fall.

    Parameters
    ----------
    surface : str
        Name of the surface.  As for :func:`loop`, undamped springs need no further series, except
        for an `asperite`.
    least : float, optional
        The smallest fall that counts [force]; by default a quarter of the range of the force.
    after : float, optional
        When the first slip may begin; by default the scene's ``output.run_in`` [time].
    asperite : int, optional
        Number of the asperite whose own slips are found.  Without it the force is the sum over the
        asperites, whose slips may overlap.

    Returns
    -------
    Slips
        A table of all slips, with means and distributions.

    Raises
    ------
    InputError
        If there is no such surface, `after` is no time of the run before its end, no springs pull
        the surface, forces or places were not recorded, or it does not slip.
    """
    begin = begin_of(result, after)
    pulled = _pulled(result, surface, asperite)
    force = pulled.force
    first = int(np.searchsorted(result.t, begin))
    spread = float(np.ptp(force[first:])) if force[first:].size else 0.0
    if not np.isfinite(spread):
        raise InputError("surface", f'must have finite forces; those of "{surface}" are not')
    least = LEAST * spread if least is None else number("least", least, POSITIVE, "force")
    rows = []
    if least > 0.0:
        for leg in legs_of(pulled.position, begin, result.t):
            rows += _slips_of_leg(result.t, pulled, leg, least)
    if not rows:
        raise InputError(
            "surface",
            f'must slip: after t = {begin:g} the force of the springs of "{surface}" never falls '
            f"by {least:.3g} while its bars get ahead",
        )
    table = table_of(COLUMNS, "slip", rows).assign_attrs(surface=surface)
    return Slips(table, least, _note(result, table, least))


class _Pulled(NamedTuple):
    """The springs of a surface, or of one asperite, at the samples (times,)."""

    position: np.ndarray  # of the stage
    force: np.ndarray  # along x
    places: np.ndarray  # of the bars along x
    energy: np.ndarray


def _pulled(result: RunResult, surface: str, asperite: int | None) -> _Pulled:
    """The springs whose slips are found.  Raises InputError."""
    part = result.scene.surfaces[result.scene.index_of(surface)]
    stage = part.drive.stage
    if stage is None or not 0.0 < stiffness_of(part) < np.inf:
        raise InputError(
            "surface", f'must be one that springs to a stage pull; "{surface}" has {part.drive}'
        )
    pull = pull_of(result, surface)
    series = result[surface]
    if asperite is not None:
        integer("asperite", asperite, 0, part.count - 1)
        if part.drive.block:
            raise InputError("asperite", "cannot be given: one spring pulls the whole block")
        if "f2_x" not in series:
            raise InputError("output.series", 'does not contain "forces", which an asperite needs')
        force = series["f2_x"][:, asperite]
        energy = 0.5 * force**2 / stage.stiffness
        return _Pulled(pull.position, force, places_of_bars(result, surface)[:, asperite], energy)
    if "e_pull" not in series:
        raise InputError("output.keep", f'leaves out "{surface}.e_pull", the energy of the springs')
    places = places_of_bars(result, surface).mean(axis=1)
    return _Pulled(pull.position, pull.force, places, np.asarray(series["e_pull"]))


def _slips_of_leg(t: np.ndarray, pulled: _Pulled, leg: Leg, least: float) -> list[list[float]]:
    """The slips in a leg of the stage: rows of the table."""
    force = pulled.force
    energy = pulled.energy
    chosen = slice(leg.first, leg.last + 1)
    along_force = leg.along * force[chosen]
    along = leg.along * pulled.places[chosen]
    farthest = np.maximum.accumulate(along)
    turns = turning_points(along_force, least)
    rows = []
    for a, b in pairwise(turns):
        drop = along_force[a] - along_force[b]
        if drop < least or along[b] <= farthest[a]:
            continue
        i = leg.first + int(a)
        j = leg.first + int(b)
        size = along[b] - along[a]
        rows.append([t[i], t[j] - t[i], size, force[i], force[j], drop, energy[i] - energy[j]])
    return rows


def _note(result: RunResult, table: xarray.Dataset, least: float) -> str:
    """What makes the table depend on the samples or on the smallest fall."""
    notes = []
    spacing = float(np.median(np.diff(result.t)))
    if float(np.median(table["duration"])) < RESOLVED * spacing:
        notes.append(
            "most falls take less than three samples, so that forces before and after depend on "
            "these; record more"
        )
    close = int(np.count_nonzero(table["drop"] < 1.5 * least))
    if close > 0.1 * table.sizes["slip"]:
        notes.append(
            f"{close} of {table.sizes['slip']} falls are close to the smallest that counts, "
            f"{least:.3g}: their number depends on it"
        )
    return "; ".join(notes)
