"""The words of the command `tribo ensemble`: what is varied and how, and a summary of members."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from tribo.ensembles.members import Distribution, Source
from tribo.ensembles.sampling import Sampler, dimensions, grid
from tribo.kernels.status import Status
from tribo.model.scene import Scene
from tribo.validation import InputError, inside, must_be

if TYPE_CHECKING:
    import xarray

# The form of an argument of --vary.
VARIED = re.compile(r"\s*(?P<key>[^=\s]+)\s*=\s*(?P<name>\w+)\((?P<numbers>[^()]*)\)\s*")

# The same in words.
FORM = (
    "KEY=normal(MEAN,DEVIATION), KEY=uniform(LOW,HIGH) or KEY=grid(FIRST,LAST,POINTS), with "
    "DEVIATION > 0, LOW < HIGH and POINTS >= 1"
)


def _normal(mean: float, deviation: float) -> Distribution:
    from scipy import stats

    _check(deviation > 0.0)
    return stats.norm(mean, deviation)


def _uniform(low: float, high: float) -> Distribution:
    from scipy import stats

    _check(low < high)
    return stats.uniform(low, high - low)


def _grid(first: float, last: float, points: float) -> np.ndarray:
    _check(points >= 1 and points == int(points))
    return np.linspace(first, last, int(points))


def _check(right: bool) -> None:
    if not right:
        raise ValueError


# What can be given for a key, by name.
SOURCES: dict[str, Callable[..., Distribution | np.ndarray]] = {
    "normal": _normal,
    "uniform": _uniform,
    "grid": _grid,
}


def varied(texts: Sequence[str]) -> dict[str, Source]:
    """Keys and their distributions, from texts as "upper.theta=normal(0,0.1)", or points of a grid.

    Raises InputError.
    """
    sources = dict(map(_varied, texts))
    axes = {key: source for key, source in sources.items() if isinstance(source, np.ndarray)}
    if axes and len(axes) < len(sources):
        raise InputError("--vary", "cannot mix grid(...) with distributions")
    return dict(grid(axes)) if axes else dict(sources)


def _varied(text: str) -> tuple[str, Distribution | np.ndarray]:
    found = VARIED.fullmatch(text)
    try:
        assert found is not None
        source = SOURCES[found["name"]](*map(float, found["numbers"].split(",")))
    except (AssertionError, ValueError, KeyError, TypeError):
        raise must_be("--vary", FORM, text) from None
    return found["key"], source


def sampler_named(name: str, scene: Scene, vary: Mapping[str, Source], seed: int) -> Sampler:
    """A sampler of scipy.stats.qmc by the name that the command line has for it.

    Raises InputError if there is nothing to draw.
    """
    from scipy.stats import qmc

    with inside("--vary"):
        numbers = sum(dimensions(scene, vary).values())
    if numbers == 0:
        raise InputError("--sampler", "needs distributions in --vary, as normal(0,0.1)")
    kinds: dict[str, Callable[..., Sampler]] = {
        "sobol": qmc.Sobol,
        "latin-hypercube": qmc.LatinHypercube,
    }
    return kinds[name](numbers, rng=np.random.default_rng(seed))


def summary(data: xarray.Dataset) -> str:
    """What a command prints: the members by status, and means at the end."""
    attributes = data.attrs
    if "keep" not in attributes:
        return _summary_of_means(data)
    members = json.loads(attributes["members"])
    lines = [f"{attributes['status']}: {sum(members.values())} of {attributes['n']} members"]
    lines += [f"{count} {status}" for status, count in members.items()]
    if attributes["status"] != Status.INTERRUPTED:  # to read all members takes long
        lines.append(f"{'quantity':<28} {'mean':>13} {'deviation':>13}")
        for name in json.loads(attributes["keep"]):
            mean, deviation = _moments(data, name)
            lines.append(f"{name:<28} {mean:>13.6g} {deviation:>13.6g}")
    lines += [f"note: {note}" for note in json.loads(attributes["notes"])]
    lines.append(f"{attributes['seconds']:.2f} s by {attributes['method']}")
    return "\n".join(lines)


def _moments(data: xarray.Dataset, name: str) -> tuple[float, float]:
    """Mean and standard deviation of a quantity at the end, over members and asperites."""
    end = {"time": -1} if "time" in data.dims else {}
    if "covariance" in data:
        means, variances = (data[f"{name}_{of}"].isel(end) for of in ("mean", "variance"))
        return float(means.mean()), float(np.sqrt(variances.mean() + means.var()))
    values = data[name if name in data.data_vars else f"{name}_end"].isel(end).values
    return float(np.nanmean(values)), float(np.nanstd(values))


def _summary_of_means(data: xarray.Dataset) -> str:
    """The means at the end, with the half-widths of their 95 % intervals."""
    lines = [f"{data.sizes['member']} members", f"{'quantity':<28} {'mean':>13} {'half-width':>13}"]
    for name in map(str, data.data_vars):
        if name.endswith("_half_width") and f"{(of := name[:-11])}_mean" in data:
            mean, half_width = (float(data[f"{of}_{what}"][-1]) for what in ("mean", "half_width"))
            lines.append(f"{of:<28} {mean:>13.6g} {half_width:>13.2g}")
    lines.append(f"{data.attrs['seconds']:.2f} s by {data.attrs['method']}")
    return "\n".join(lines)
