"""Runs of a scene with other values, point by point of a grid, as one labelled data set."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tribo.accuracy.comparison import Accuracy
from tribo.ensembles import ensemble
from tribo.ensembles.dataset import in_file, saved
from tribo.ensembles.engines import Engine
from tribo.ensembles.kept_values import NOT_RUN, REFUSED, total_names
from tribo.ensembles.members import Source, Variation, of_surfaces
from tribo.ensembles.request import END, Request, checked_names, checked_scene, checked_time
from tribo.ensembles.runner import Execution, collect, execution
from tribo.ensembles.sampling import Sampler, sampled
from tribo.ensembles.stores import MemberStore, Target
from tribo.interrupts import answer
from tribo.kernels.status import Status
from tribo.layout.layout import lay_out
from tribo.loops.frames import as_bytes
from tribo.model.parameters import of_each_surface, with_values
from tribo.model.scene import Scene
from tribo.progress import Shown
from tribo.sweeps.dataset import Table, attributes_of, coordinates_of, key_coordinates, side_by_side
from tribo.sweeps.grid import Grid, Keys
from tribo.sweeps.point_sets import PointMembers, point_sets, runs_of
from tribo.validation import InputError, boolean, inside, integer

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
        As for :func:`ensemble`, at each point.  The points are then run one after another.
    progress : callable or bool, optional
        As for :func:`ensemble`, with the number of finished points.
    vary, at, sampler, engine, out, resume, accuracy, method, step, threads, allow_unresolved, seed
        As for :func:`ensemble`.

    Returns
    -------
    xarray.Dataset
        A data set as for an ensemble, with a dimension for each key; the dimension of several keys
        is named by these, with commas.  ``status``, ``steps``, ``force_evaluations``, ``level`` and
        ``error`` are those of each run.  Values of runs that did not complete are NaN.

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
    began = time.perf_counter()
    grid = Grid(checked_scene(scene), values)
    each = _members(grid, members, of_surfaces(scene, vary), seed, sampler, half_width)
    keep = scene.output.keep if keep is None else keep
    names = tuple(total_names(scene)) if keep is None else checked_names(keep)
    alone = each.number is None
    request = Request(names, checked_time(at), alone, accuracy, method, step, allow_unresolved)
    request.check()
    if request.at != END and "duration" in grid.keys:
        raise InputError("at", 'must be "end", as "duration" is swept and times differ')
    how = execution(engine, threads)
    per_point = boolean("statistics", statistics) or half_width is not None
    ensemble_at = partial(
        ensemble,
        members=each.number,
        vary=each.vary,
        keep=None if half_width is not None else names,
        at=at,
        statistics=statistics,
        half_width=half_width,
        engine=engine,
        accuracy=accuracy,
        method=method,
        step=step,
        threads=how.threads,
        progress=False,
        allow_unresolved=allow_unresolved,
        seed=each.seed,
    )

    def compute(target: Target, progress: Callable[[float], None] | None) -> xarray.Dataset:
        if per_point:
            data = _point_by_point(grid, ensemble_at, target, progress, began)
        else:
            data = _together(grid, request, each, target, how._replace(progress=progress), began)
        return saved(data, target)

    others: dict[str, object] = {"values": grid.identity(), "members": each.number}
    others |= {"statistics": statistics, "half_width": half_width}
    identity = request.identity(scene, Variation(scene, each.vary, each.seed), others)
    return in_file(out, resume, identity, progress, grid.size, "points", compute).load()


def _members(
    grid: Grid,
    members: int | None,
    vary: Mapping[str, Source],
    seed: int,
    sampler: Sampler | None,
    half_width: Mapping[str, float] | None,
) -> PointMembers:
    """The members of each point.  Raises InputError."""
    if members is None and (vary or sampler is not None) and half_width is None:
        raise InputError("members", "is missing; vary is what differs between members")
    number = None if members is None else integer("members", members, 2)
    if sampler is not None:
        vary = sampled(sampler, members, grid.scene, vary)
    for key, length in Variation(grid.scene, vary, integer("seed", seed, 0)).lengths.items():
        if number is not None and length != number:
            raise InputError(f"vary.{key}", f"must have values for {number} members, got {length}")
    for key in of_each_surface(grid.scene, dict.fromkeys(grid.keys)):
        if key in vary:
            raise InputError(f"vary.{key}", "is swept too; give it once")
    return PointMembers(number, vary, seed)


def _together(
    grid: Grid, request: Request, each: PointMembers, target: Target, how: Execution, began: float
) -> xarray.Dataset:
    """All points by one engine, those that one plan serves side by side.

    Raises KeyboardInterrupt if no run is complete.
    """
    import xarray

    kept = request.kept(lay_out(request.recorded(grid.scene.with_heights())))
    sets, order, simulation = point_sets(grid, request, each)
    store, report = MemberStore(target.frames), how.progress

    def finished(done: int) -> None:
        if report is not None:
            report(done // each.each)

    chunks = runs_of(sets, store.done, how, simulation)
    interrupted = collect(chunks, store, finished)
    table = Table(grid, order, kept, store.values(), each)
    table.check_any_ran()
    status = str(Status.INTERRUPTED if interrupted else Status.COMPLETED)
    seconds = time.perf_counter() - began
    return xarray.Dataset(
        table.variables(),
        coordinates_of(grid, kept, grid.scene, None if each.number is None else sets[0]),
        attributes_of(grid.scene, kept.names, status, table.notes(), seconds),
    )


def _point_by_point(
    grid: Grid,
    ensemble_at: Callable[[Scene], xarray.Dataset],
    target: Target,
    report: Callable[[int], None] | None,
    began: float,
) -> xarray.Dataset:
    """An ensemble at each point, side by side.  Raises KeyboardInterrupt if none is complete."""
    import xarray

    found: dict[int, xarray.Dataset] = {}
    notes: dict[int, str] = {}
    for arrays in () if target.frames is None else target.frames.read():
        assert target.frames is not None
        index = int(arrays["point"])
        target.frames.name_last(index)
        if "note" in arrays:
            notes[index] = arrays["note"].tobytes().decode()
        else:
            content = arrays["data"].tobytes()
            found[index] = xarray.load_dataset(content, engine="h5netcdf")
    interrupted = False
    try:
        for index in range(len(found) + len(notes), grid.size):
            scene = with_values(grid.scene, grid.point(index))
            arrays = {"point": np.array(index)}
            try:
                found[index] = ensemble_at(scene)
                content = bytes(found[index].to_netcdf(engine="h5netcdf"))
                arrays["data"] = as_bytes(content)
            except InputError as error:
                notes[index] = str(error)
                arrays["note"] = as_bytes(str(error))
            if target.frames is not None:
                target.frames.append(index, arrays)
            if report is not None:
                report(len(found) + len(notes))
    except KeyboardInterrupt:
        answer()
        interrupted = True
        if not found:
            raise
    if not found:
        with inside(grid.label(0)):
            raise InputError("", notes[0])
    variables, coordinates = side_by_side(grid, found)
    first = found[min(found)]
    points = [
        REFUSED if k in notes else found[k].attrs["status"] if k in found else NOT_RUN
        for k in range(grid.size)
    ]
    about = {"long_name": "end of the ensemble"}
    variables["point_status"] = tuple(grid.names), np.array(points).reshape(grid.shape), about
    keys = key_coordinates(grid)
    lines = [f"{grid.label(k)}: {note}" for k, note in sorted(notes.items())]
    return xarray.Dataset(
        variables,
        coordinates | keys,
        attributes_of(
            grid.scene,
            [str(name) for name in first.data_vars],
            str(Status.INTERRUPTED if interrupted else Status.COMPLETED),
            lines,
            time.perf_counter() - began,
        ),
    )
