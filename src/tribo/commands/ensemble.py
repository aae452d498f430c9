"""The command `tribo ensemble`: what is varied and how, and a summary of members."""

from __future__ import annotations

import argparse
import json
import re
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import AbstractContextManager, nullcontext, suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.commands import scene_options as shared
from tribo.ensembles.engines import Engine
from tribo.ensembles.kept_values import is_averaged
from tribo.ensembles.members import Distribution, Sampler, Source, draws_of
from tribo.ensembles.swing_states import Canonical, EnergyBall, Microcanonical, SwingStates
from tribo.files import strict_json
from tribo.interrupts import COMPLETED, STOPPED, also_in_part
from tribo.kernels.status import Status
from tribo.model.binding import bound, check_apart
from tribo.model.scene import Scene
from tribo.results.averages import interval, student
from tribo.validation import InputError, inside, integer, must_be

if TYPE_CHECKING:
    import xarray

# The form of an argument of --vary.
VARIED = re.compile(r"\s*(?P<key>[^=\s]+)\s*=\s*(?P<name>\w+)\((?P<numbers>[^()]*)\)\s*")
# The same in words.
FORM = (
    "KEY=normal(MEAN,DEVIATION), KEY=uniform(LOW,HIGH) or KEY=grid(FIRST,LAST,POINTS), with "
    "DEVIATION > 0, LOW < HIGH and POINTS >= 1, or SURFACE.swing_state=canonical(TEMPERATURE), "
    "microcanonical(ENERGY) or energy_ball(ENERGY)"
)


def _all_varied(texts: Sequence[str]) -> dict[str, Source]:
    """Sources by key, from texts as "upper.theta=normal(0,0.1)".  Raises InputError."""
    sources: dict[str, Any] = {}
    for key, source in map(_varied, texts):
        if key in sources:
            raise InputError(f"--vary {key}", "is given twice; give each key once")
        sources[key] = source
    axes = {key: source for key, source in sources.items() if isinstance(source, np.ndarray)}
    if axes and len(axes) < len(sources):
        raise InputError("--vary", "cannot mix grid(...) with distributions")
    if not axes:
        return dict(sources)
    tables = np.meshgrid(*axes.values(), indexing="ij")
    return {key: table.ravel() for key, table in zip(axes, tables, strict=True)}


def _varied(text: str) -> tuple[str, Distribution | SwingStates | np.ndarray]:
    found = VARIED.fullmatch(text)
    if found is not None:
        with suppress(ValueError):
            return found["key"], _source(found["name"], *map(float, found["numbers"].split(",")))
    raise must_be("--vary", FORM, text)


def _source(name: str, *numbers: float) -> Distribution | SwingStates | np.ndarray:
    """What a name with numbers stands for.  Raises ValueError."""
    from scipy import stats

    match name, numbers:
        case "normal", (mean, deviation) if deviation > 0.0:
            return stats.norm(mean, deviation)
        case "uniform", (low, high) if low < high:
            return stats.uniform(low, high - low)
        case "grid", (first, last, points) if points >= 1 and points == int(points):
            return np.linspace(first, last, int(points))
        case "canonical", (temperature,):
            return Canonical(temperature)
        case "microcanonical", (energy,):
            return Microcanonical(energy)
        case "energy_ball", (energy,):
            return EnergyBall(energy)
    raise ValueError


def _sampler_named(name: str, scene: Scene, vary: Mapping[str, Source], seed: int) -> Sampler:
    """The sampler of an option.  Raises InputError if there is nothing to draw."""
    from scipy.stats import qmc

    with inside("--vary"):
        numbers = sum(draw.dimensions for draw in draws_of(scene, vary).values())
    if numbers == 0:
        raise InputError("--sampler", "needs distributions in --vary, as normal(0,0.1)")
    kinds = {"sobol": qmc.Sobol, "latin-hypercube": qmc.LatinHypercube}
    return kinds[name](numbers, rng=np.random.default_rng(seed))


def settings_of(options: argparse.Namespace, scene: Scene) -> dict[str, Any]:
    """The arguments of ensembles and sweeps that the options give.  Raises InputError."""
    shared.check_files(options)
    vary = _all_varied(options.vary)
    sampler = None
    if options.sampler is not None:
        sampler = _sampler_named(options.sampler, scene, vary, options.seed)
    names = ("members", "at", "statistics", "out", "resume", "threads", "seed")
    widths = shared.by_key("--half-width", options.half_width).items()
    half_width = {name: shared.as_number(f"--half-width {name}", size) for name, size in widths}
    return {
        **{name: getattr(options, name) for name in names},
        **shared.numerics_of(options),
        "vary": vary,
        "keep": options.keep and [name.strip() for name in options.keep.split(",")],
        "half_width": half_width or None,
        "sampler": sampler,
    }


def workers(options: argparse.Namespace) -> AbstractContextManager[Engine | None]:
    """The processes of an option.  Raises InputError."""
    number = integer("--processes", options.processes, 1)
    return ProcessPoolExecutor(number) if number > 1 else nullcontext()


def run_ensemble(options: argparse.Namespace) -> int:
    """Run an ensemble, print a summary of its members and draw the figure."""
    from tribo.ensembles import ensemble

    shared.check_figure(options.figure)
    if options.figure is not None and options.statistics:
        raise InputError("--figure", "needs the members, which --statistics does not keep")
    scene = shared.load_with_values(options)
    settings = settings_of(options, scene)
    with inside("--vary"):
        given = bound(scene, shared.by_key("--set", options.set))
        check_apart(scene, bound(scene, settings["vary"]), given, "set")
    try:
        with workers(options) as engine:
            data = also_in_part(ensemble, scene, engine=engine, **settings)
    except InputError as error:
        varied = any(error.field.startswith(key) for key in settings["vary"])
        raise InputError(f"--vary {error.field}", error.problem) if varied else error from None
    found = _summary(data, options.out)
    if any(isinstance(source, np.ndarray) for source in settings["vary"].values()):
        found["notes"].append(ON_A_GRID)
    averaged = _averaged(data, found["quantities"])
    print(strict_json(found) if options.json else _in_words(found, averaged))
    shared.draw_to(options.figure, partial(_draw, data, settings["keep"]))
    return COMPLETED if data.attrs["status"] == "completed" else STOPPED


# A note on the half-widths of members that were not drawn.
ON_A_GRID = "members on a grid are no random sample: half-widths are those of as many drawn ones"


def _draw(data: xarray.Dataset, keep: Sequence[str] | None, path: Path) -> None:
    """Draw a histogram of the first quantity that is asked for, at the end."""
    from tribo.plotting import histogram, save

    known = [str(name) for name in data.data_vars if "member" in data[name].dims]
    works = [name for name in known if name.endswith(".W")]
    name = next(iter(keep or works or known))
    values = data[name if name in data else f"{name}_end"]
    values = values.isel(time=-1) if "time" in values.dims else values
    if values.size != data.sizes["member"]:
        raise InputError("--figure", f"needs one value a member, as upper.W; {name} has more")
    if "status" in data:
        values = values[(data["status"] == Status.COMPLETED).values]
    with inside("--figure"):
        when = "averaged over time" if _averaged(data, [name]) else "at the end"
        save(histogram(values.values.ravel(), f"{name} {when}"), path)


def _summary(data: xarray.Dataset, out: Path | None) -> dict[str, Any]:
    """What a command prints: the members by status, and means at the end.

    After an interrupt they are those of the finished members, unless these are in a file.
    """
    attributes = data.attrs
    finished = attributes["status"] != Status.INTERRUPTED
    rest = {"seconds": attributes["seconds"], "method": attributes["method"]}
    notes = json.loads(attributes["notes"]) if "notes" in attributes else []
    if not finished:
        where = "the quantities are those of the finished members"
        if out is not None:
            where = f"the finished members are in {out}.part; --resume goes on"
        notes = [f"the ensemble was interrupted; {where}", *notes]
    if "keep" not in attributes:
        counts = {"completed": data.sizes["member"]}
        table = _means(data)
    else:
        counts = json.loads(attributes["members"])
        # To read all members of an ensemble that was interrupted from a file takes long.
        names = json.loads(attributes["keep"]) if finished or out is None else []
        table = {name: _moments(data, name) for name in names}
    status = attributes["status"]
    wanted = int(attributes.get("n", data.sizes.get("member", 0)))
    head = {"status": status, "n": wanted, "members": counts, "quantities": table}
    return {**head, "notes": notes, **rest}


def _averaged(data: xarray.Dataset, names: Iterable[str]) -> list[str]:
    """The quantities that are averages over time of each member, of those in a summary."""
    has_times = "keep" not in data.attrs or "time" in data.dims
    return [] if has_times else [name for name in names if is_averaged(name)]


def _in_words(found: Mapping[str, Any], averaged: Sequence[str]) -> str:
    """The summary as text: statuses, a line for each quantity, notes and duration.

    Of quantities that are `averaged` over time a line says so.
    """
    members = found["members"]
    table = found["quantities"]
    lines = [f"{found['status']}: {sum(members.values())} of {found['n']} members"]
    lines += [f"{count} {status}" for status, count in members.items()]
    if table:
        columns = list(next(iter(table.values())))
        lines.append(f"{'quantity':<28} " + " ".join(f"{c.replace('_', '-'):>13}" for c in columns))
    for name, numbers in table.items():
        lines.append(f"{name:<28} " + " ".join(f"{x:>13.6g}" for x in numbers.values()))
    if table:
        rest = "others are" if averaged else "values are"
        over_time = f"averages over time: {', '.join(averaged)}; " if averaged else ""
        lines.append(f"{over_time}{rest} those at the end")
    lines += [f"note: {note}" for note in found["notes"]]
    lines.append(f"{found['seconds']:.2f} s by {found['method']}")
    return "\n".join(lines)


def _moments(data: xarray.Dataset, name: str) -> dict[str, float]:
    """Mean and standard deviation of a quantity at the end, over members and asperites.

    Members are a sample, of n with n - 1 degrees of freedom; a surface has no other asperites.
    The half-width is that of the 95 % interval of the mean.
    """
    end = {"time": -1} if "time" in data.dims else {}
    half_width = np.nan
    if "covariance" in data:
        means, variances = (data[f"{name}_{of}"].isel(end) for of in ("mean", "variance"))
        labels = [str(label).partition("[")[0] for label in data["value"].values]
        own = np.flatnonzero([label == name for label in labels])
        covariance = data["covariance"].isel(end).values[np.ix_(own, own)]
        count = int(data["complete_members"])
        if count > 1:
            half_width = student(count - 1) * float(np.sqrt(covariance.mean() / count))
    else:
        values = data[name if name in data.data_vars else f"{name}_end"].isel(end)
        means = values.mean("member")
        variances = values.var("member", ddof=1)
        members = values.values.reshape(values.sizes["member"], -1).mean(axis=1)
        known = members[np.isfinite(members)]
        if known.size > 1:
            half_width = float(interval(known).half_width)
    deviation = np.sqrt(variances.mean() + means.var())
    mean = float(means.mean())
    return {"mean": mean, "deviation": float(deviation), "half_width": half_width}


def _means(data: xarray.Dataset) -> dict[str, dict[str, float]]:
    """The means at the end, with the half-widths of their 95 % intervals."""
    table = {}
    for name in map(str, data.data_vars):
        if name.endswith("_half_width") and f"{(of := name[:-11])}_mean" in data:
            table[of] = {what: float(data[f"{of}_{what}"][-1]) for what in ("mean", "half_width")}
    return table
