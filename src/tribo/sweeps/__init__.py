"""Runs of a scene with other values, point by point of a grid, as one labelled data set."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tribo.accuracy.comparison import Accuracy
from tribo.ensembles import ensemble
from tribo.ensembles.engines import Engine
from tribo.ensembles.kept_values import total_names
from tribo.ensembles.members import Sampler, Source, Variation, sources_of
from tribo.ensembles.request import END, SAMPLES, Request
from tribo.ensembles.runner import Execution
from tribo.ensembles.stores import Target, in_file
from tribo.model.binding import check_apart, check_arguments
from tribo.model.scene import Scene
from tribo.model.settings import names_of_quantities
from tribo.progress import Shown
from tribo.sweeps.effects import check_effects
from tribo.sweeps.grid import POINT, Grid, Keys
from tribo.sweeps.point_by_point import point_by_point
from tribo.sweeps.side_by_side import SideBySide
from tribo.validation import InputError, boolean, choice, inside, instance, integer

if TYPE_CHECKING:
    import xarray


def sweep(
    scene: Scene,
    values: Mapping[Keys, Sequence[object]],
    members: int | None = None,
    vary: Mapping[str, Source] | None = None,
    keep: Sequence[str] | None = None,
    at: str = END,
    statistics: bool = False,
    half_width: Mapping[str, float] | None = None,
    sampler: Sampler | None = None,
    engine: Engine | None = None,
    out: str | Path | None = None,
    resume: bool = False,
    accuracy: Accuracy | None = None,
    method: str | None = None,
    step: float | None = None,
    threads: int | None = None,
    progress: Shown = None,
    allow_unresolved: bool = False,
    seed: int = 0,
    point: str = POINT,
) -> xarray.Dataset:
    """Run a scene with every combination of some values: a grid of ensembles.

    Parameters
    ----------
    scene : Scene
        The scene.
    values : mapping
        Key -> values, as ``{"upper.drive.load": [0.1, 0.2], "upper.velocity": [0.5]}``: numbers or
        words.  The keys are those of :func:`ensemble`, and "duration" and "seed".  A number for a
        velocity is its x component.  A tuple of keys sweeps them together:
        ``{("upper.velocity", "duration"): [(0.5, 40.0), (0.25, 80.0)]}``.
    members : int, optional
        Number of runs at each point, the same at all points; by default one run of the scene.
    keep : sequence of str, optional
        As for :func:`ensemble`; by default the scene's ``output.keep``, or else quantities of
        surfaces as wholes and of the system.
    statistics, half_width
        As for :func:`ensemble`, at each point.  With `half_width`, which takes another number of
        members at each point, the points are run one after another.
    progress : callable or bool, optional
        As for :func:`ensemble`, with the number of finished points.
    point : str
        Name of the dimension of keys that are swept together; of further ones with "_2", "_3".
    vary, at, sampler, engine, out, resume, accuracy, method, step, threads, allow_unresolved, seed
        As for :func:`ensemble`.

    Returns
    -------
    xarray.Dataset
        A data set as for an ensemble, with a dimension for each key, which is a coordinate.  Keys
        that are swept together share the dimension `point`.  ``status``, ``steps``,
        ``force_evaluations``, ``level`` and ``error`` are those of each run.  Values of runs that
        did not complete are NaN.

        Without members, the error of each quantity is ``upper.W_error``, if there is an accuracy;
        a point that missed it has its values and the status "AccuracyMissed".  With members, their
        means and the half-widths of the 95 % intervals are ``upper.W_mean`` and
        ``upper.W_half_width``.

    Raises
    ------
    InputError
        An argument cannot be used, no point can be run, or another sweep writes ``out.part``.
    KeyboardInterrupt
        As for :func:`ensemble`; runs that were not finished are "not run".
    """
    grid = Grid(instance(Scene)("scene", scene), values, point)
    if members is None and (vary or sampler is not None) and half_width is None:
        raise InputError("members", "is missing; vary is what differs between members")
    number = None if members is None else integer("members", members, 2)
    at = choice("at", at, (END, SAMPLES))
    settings: dict[str, Any] = {"at": at, "accuracy": accuracy, "method": method, "step": step}
    settings["allow_unresolved"] = allow_unresolved
    with inside("values"):
        check_arguments(grid.bound, settings)
    sources = sources_of(grid.first, vary, sampler, members)
    with inside("vary"):
        check_apart(scene, sources, grid.bound)
    variation = Variation(grid.first, sources, integer("seed", seed, 0))
    if number is not None:
        variation.check(number)
    if half_width is not None and keep is not None:
        raise InputError("half_width", "cannot go with keep; give one or the other")
    keep = scene.output.keep if keep is None else keep
    names = tuple(total_names(scene)) if keep is None else names_of_quantities("keep", keep)
    request = Request(names, with_errors=number is None, **settings)
    recorded = request.recorded(scene)
    one_run = number is None and half_width is None
    check_effects(grid, names, at != END or half_width is not None, not one_run)
    how = Execution.checked(engine, threads)
    statistics = boolean("statistics", statistics)
    if statistics and number is None and half_width is None:
        raise InputError("statistics", "needs members; give their number")
    wanted: dict[str, Any] = {"statistics": statistics, "half_width": half_width}
    compute: Callable[[Target, Callable[[float], None] | None], xarray.Dataset]
    if half_width is None:
        points = SideBySide(grid, request, recorded, variation, number, how, statistics)
        compute = points.compute
    else:
        own: dict[str, Any] = {"members": number, "vary": sources, "seed": seed}
        own |= {"engine": engine, "threads": threads, "progress": False, **settings, **wanted}
        compute = partial(point_by_point, grid, partial(ensemble, **own))
    others: dict[str, object] = {"values": grid.identity(), "members": number, **wanted}
    others |= {"point": point}
    identify = partial(request.identity, recorded, variation, others)
    return in_file(out, resume, scene, identify, progress, grid.size, "points", compute).load()
