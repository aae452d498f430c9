"""Runs of a scene with other values, point by point of a grid, as one labelled data set."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from tribo import interrupts
from tribo.ensembles.engines import Engine, check_engine
from tribo.ensembles.members import Source
from tribo.files import netcdf_target, replace_file
from tribo.kernels.status import Status
from tribo.model.scene import Scene
from tribo.model.settings import Numerics
from tribo.progress import Reported, Shown
from tribo.sweeps.dataset import dataset, opened
from tribo.sweeps.grid import Grid
from tribo.sweeps.points import Found, Members, found_at, kept_names
from tribo.sweeps.record import Record, identity_of
from tribo.validation import InputError, as_path, inside, integer, short_repr

if TYPE_CHECKING:
    import xarray


def sweep(
    scene: Scene,
    values: Mapping[str, Sequence[object]],
    members: int | None = None,
    keep: Sequence[str] | None = None,
    vary: Mapping[str, Source] | None = None,
    seed: int = 0,
    accuracy: float | None = None,
    method: str | None = None,
    step: float | None = None,
    engine: Engine | None = None,
    out: str | Path | None = None,
    resume: bool = False,
    progress: Shown = None,
) -> xarray.Dataset:
    """Run a scene with every combination of some values.

    Parameters
    ----------
    scene : Scene
        The scene.
    values : mapping
        Key -> values, as ``{"upper.drive.load": [0.1, 0.2], "upper.velocity": [0.5]}``: numbers or
        words.  The keys are those of :func:`ensemble`, and "duration" and "seed".  A number for a
        velocity is its x component.
    members : int, optional
        Number of runs at each point, at least 2, with starts that differ by `vary` and thermal
        noise; by default one run.
    keep : sequence of str, optional
        Quantities whose values at the end are kept, as "upper.w1" or "contact_energy"; by default
        the scene's ``output.keep``, or else those of surfaces as wholes and of the system.
        "upper.friction_force" is its average over time, with the half-width of the 95 % interval
        as ``upper.friction_force_time_half_width``.
    vary : mapping, optional
        Quantities that differ between the members of a point, as for :func:`ensemble`.
    seed : int
        The seed of the members, the same at each point.
    accuracy, method, step
        As for :func:`simulate`.
    engine : executor, optional
        Runs the points in parallel, as for :func:`ensemble`; without it they are run in this
        process, one by one.
    out : str or Path, optional
        A NetCDF file for the data set.  During the sweep, ``out`` with ``.part`` appended to its
        name has the finished points.
    resume : bool
        Take the finished points from ``out.part``; read ``out`` if that is complete.
    progress : callable or bool, optional
        A function that is called with the number of finished points.  By default a bar appears on
        a terminal or in a notebook after a second; True shows it elsewhere too, False never.

    Returns
    -------
    xarray.Dataset
        A dimension for each key.  Each quantity is at the end of the run, with its units, and its
        error estimate as ``upper.W_error``; ``status``, ``steps``, ``force_evaluations`` and
        ``seconds`` are those of each point.  Values of points that did not complete are NaN; a
        point that missed its accuracy has its values and the status "AccuracyMissed".

        With members, each quantity has the dimension ``member`` too, and its mean and the
        half-width of the 95 % interval of that are ``upper.W_mean`` and ``upper.W_half_width``.

    Raises
    ------
    InputError
        An argument cannot be used, no point can be run, or another sweep writes ``out.part``.
    KeyboardInterrupt
        The sweep was interrupted, as by Ctrl-C.  If any point was finished, the attribute
        ``result`` of the exception has the data set, in which the others are "not run".
    """
    began = time.perf_counter()
    if not isinstance(scene, Scene):
        raise InputError("scene", f"must be a tribo.Scene, got {short_repr(scene)}")
    if accuracy is not None or method is not None or step is not None:
        scene = replace(scene, numerics=_numerics(scene.numerics, accuracy, method, step))
    grid = Grid(scene, values)
    group = None
    if members is not None:
        group = Members(integer("members", members, 2), dict(vary or {}), integer("seed", seed, 0))
    elif vary:
        raise InputError("members", "is missing; vary is what differs between members")
    names = kept_names(scene, keep)
    check_engine(engine)
    identity = identity_of(grid, names, group)
    path = None if out is None else netcdf_target("out", as_path(out))
    if resume and path is None:
        raise InputError("resume", "needs out, the file of the sweep")
    if path is not None and resume and path.exists():
        return opened(path, identity)
    with Record(path, identity, resume) as record:
        with Reported(progress, grid.size, "points") as report:
            _run_points(grid, names, group, engine, record, report)
        data = dataset(grid, record.found, group is not None, identity, time.perf_counter() - began)
        if path is not None and len(record.found) == grid.size:
            replace_file(path, bytes(data.to_netcdf(engine="h5netcdf")))
            record.remove()
    if data.attrs["status"] == Status.INTERRUPTED:
        raise interrupts.Interrupted(data)
    return data


def _numerics(
    given: Numerics, accuracy: float | None, method: str | None, step: float | None
) -> Numerics:
    """The numerics of all points; an accuracy and a step replace each other."""
    if accuracy is None and step is None:
        return replace(given, method=method)
    return replace(given, accuracy=accuracy, step=step, method=method or given.method)


def _run_points(
    grid: Grid,
    names: Sequence[str],
    group: Members | None,
    engine: Engine | None,
    record: Record,
    report: Callable[[float], None] | None,
) -> None:
    """Run the points that are not finished.  An interrupt leaves those that are.

    Raises InputError if no point can be run, and KeyboardInterrupt if none is finished.
    """
    left = [index for index in range(grid.size) if index not in record.found]
    runs = found_at([grid.scene(index) for index in left], names, group, engine)
    try:
        for index, found in zip(left, runs, strict=True):
            if found.status == Found.INTERRUPTED:
                raise KeyboardInterrupt
            record.add(index, found)
            if report is not None:
                report(len(record.found))
    except KeyboardInterrupt:
        interrupts.answer()
        if not record.found:
            raise
    if all(found.status == Found.REFUSED for found in record.found.values()):
        with inside(grid.label(min(record.found))):
            raise InputError("", next(iter(record.found.values())).note)
