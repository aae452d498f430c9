"""Many runs of a scene, which differ in their starts, their numbers, or their noise.

Means serve chaotic motion and thermal noise, where single trajectories are not reproducible.  Kept
quantities of each member, or their statistics, serve maps and distributions.
"""

from __future__ import annotations

import os
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from tribo.ensembles.engines import Engine, check_engine
from tribo.ensembles.kept_ensemble import Wanted, kept_ensemble
from tribo.ensembles.means import checked_half_width, means
from tribo.ensembles.members import Source, Variation
from tribo.ensembles.runner import Runner
from tribo.ensembles.sampling import Sampler, sampled
from tribo.ensembles.single_runs import planned
from tribo.interrupts import Interrupted
from tribo.kernels.status import Status
from tribo.model.scene import Scene
from tribo.progress import Reported, Shown
from tribo.validation import InputError, integer, short_repr

if TYPE_CHECKING:
    import xarray

# Most members that a half-width may take where `n` is not given.
MOST_MEMBERS = 10_000


def ensemble(
    scene: Scene,
    n: int | None = None,
    vary: Mapping[str, Source] | None = None,
    seed: int = 0,
    engine: Engine | None = None,
    half_width: Mapping[str, float] | None = None,
    method: str | None = None,
    step: float | None = None,
    progress: Shown = None,
    keep: Sequence[str] | None = None,
    threads: int | None = None,
    at: str = "end",
    statistics: bool = False,
    out: str | Path | None = None,
    resume: bool = False,
    sampler: Sampler | None = None,
) -> xarray.Dataset:
    """Run a scene from many starts; keep quantities of each member, their statistics, or means.

    Parameters
    ----------
    scene : Scene
        The scene.  All members share its heights; each has a seed of its own for noise and thermal
        starts.
    n : int, optional
        Number of members, at least 2.  With `half_width`, the largest number.  By default that of
        the arrays in `vary`.
    vary : mapping, optional
        Quantities that differ between members: "surface.theta" (or another initial value),
        "surface.velocity", or a number of the scene as "surface.asperite.kappa",
        "surface.langevin.temperature" (or of its drive or bath) or "interaction.strength" -> an
        array of shape (n,), (n, asperites) or, for velocities, (n, 2); or a distribution with
        ``rvs(size=, random_state=)``, as those of scipy.stats, from which each asperite of each
        member draws.  :func:`tribo.grid` makes the arrays of a grid.
    seed : int
        The seed of the ensemble.  A member depends on it and on the member's number.
    engine : executor, optional
        Runs the members in other processes: it has ``submit`` or ``map`` as concurrent.futures
        defines them, or is a client of dask.distributed.
    half_width : mapping, optional
        Quantity of a surface as a whole or of the system, as "upper.W" -> the largest half-width
        of the 95 % interval of its mean, at any recorded time, in units of the largest work or
        change of energy of a surface or of the system.  It determines the number of members.
    method, step
        As for :func:`prepare`.  Required where no accuracy of single runs can be kept.
    progress : callable or bool, optional
        Called with the number of members that have been run; or whether a bar is shown: by default
        on a terminal and in a notebook, after a second.
    keep : sequence of str, optional
        Quantities of each member that are kept, and nothing else: "upper.w1" or "contact_energy".
        It makes the members of a scene of one asperite on one run thousands of times faster.
        Forces and energies as series need no ``output.series`` here.  At the end,
        "upper.friction_force" is the average over time of each member, and
        ``upper.friction_force_time_half_width`` that of its 95 % interval, as of
        :meth:`tribo.Result.friction_force`.  By default the scene's ``output.keep``; without that,
        means of all sums.
    threads : int, optional
        Threads that run such members; by default one for each core.  Values do not depend on it.
    at : {"end", "samples"}
        Whether quantities are kept at the end of each run or at all times of the scene's output.
    statistics : bool
        Return statistics of the kept quantities in place of the members, for more members than
        memory holds.
    out : str or Path, optional
        A NetCDF file for the data set, with `keep`.  Until it is complete, ``out`` with ``.part``
        behind its name has the members so far, or with `statistics` their sums, also if the
        ensemble is interrupted.  Values of the data set are then read from the file when used.
    resume : bool
        Continue ``out.part``, to the bits of an ensemble without a pause; begin if there is no such
        file, and only read ``out`` if that is complete.
    sampler : scipy.stats.qmc.QMCEngine, optional
        Its points take the place of random numbers in all distributions of `vary`, which need
        ``ppf``; one dimension for each number that a member draws.

    Returns
    -------
    xarray.Dataset
        With `keep`, each quantity under its name (member, [time,] [asperite]), and for each
        member its ``status``, ``steps``, ``level`` of the tolerances, and ``error`` where it was
        measured.  Values of members that did not complete are NaN.  A quantity whose start is
        varied is ``upper.theta_end``.

        With `statistics`, for each quantity ``upper.w1_mean`` ([time,] [asperite]),
        ``upper.w1_half_width`` of the 95 % interval of the mean, ``upper.w1_variance``,
        ``upper.w1_quantile`` (probability, ...), and a histogram: ``upper.w1_count`` (..., bin)
        between the values in ``upper.w1_edge``; and the ``covariance`` of all values.

        Without `keep`, for each quantity, as ``upper.W`` (member, time): ``upper.W_mean`` and
        ``upper.W_half_width`` (time,).  The effect of the step or of the tolerances on the mean is
        ``upper.W_bias`` and ``upper.W_bias_half_width`` (time,), or ``upper.W_error``.  Works that
        are reported of asperites, as ``upper.w2``, are summed over their surface; series of
        surfaces that ``output.series`` asks for, as ``upper.friction_force``, have no error.

    Raises
    ------
    InputError
        An argument cannot be used, the half-width takes too many members, fewer than two members
        reach the end, or the file is of another ensemble.
    KeyboardInterrupt
        The ensemble was interrupted, as by Ctrl-C.  If enough members were complete, the attribute
        ``result`` of the exception has their data set, whose attribute ``status`` is "Interrupted".
    """
    began = time.perf_counter()
    if not isinstance(scene, Scene):
        raise InputError("scene", f"must be a tribo.Scene, got {short_repr(scene)}")
    scene = scene.with_heights()
    if keep is None and half_width is None:
        keep = scene.output.keep
    if scene.output.keep is not None:
        scene = replace(scene, output=replace(scene.output, keep=None))
    wanted = None if half_width is None else checked_half_width(scene, half_width)
    source = {} if vary is None else vary
    if sampler is not None:
        _check_alone("half_width", half_width, "sampler")
        source = sampled(sampler, n, scene, source)
    variation = Variation(scene, source, integer("seed", seed, 0))
    most = _most_members(n, wanted, variation)
    check_engine(engine)
    threads = os.cpu_count() or 1 if threads is None else integer("threads", threads, 1)
    if keep is not None:
        _check_alone("half_width", half_width, "keep")
        what = Wanted(keep, at, statistics, out, resume)
        simulation = planned(what.scene(scene), method, what.step(scene, method, step))
        with Reported(progress, most, "members") as report:
            data = kept_ensemble(simulation, variation, most, what, engine, threads, report)
    else:
        Wanted.check_absent(at, statistics, out, resume)
        simulation = planned(scene, method, step)
        with Reported(progress, most, "members") as report:
            data = means(Runner(simulation, variation, engine, report), wanted, most, began)
    if data.attrs["status"] == Status.INTERRUPTED:
        raise Interrupted(data)
    return data


def _check_alone(field: str, value: object, other: str) -> None:
    if value is not None:
        raise InputError(field, f"cannot go with {other}; give one or the other")


def _most_members(
    n: int | None, half_width: Mapping[str, float] | None, variation: Variation
) -> int:
    """The largest number of members, for which arrays have values.  Raises InputError."""
    lengths = variation.lengths
    if n is None and half_width is None and not lengths:
        raise InputError("n", 'is missing; give it, or half_width={"surface.W": 1e-2}')
    largest = [] if half_width is None else [MOST_MEMBERS]
    most = min([*largest, *lengths.values()]) if n is None else integer("n", n, 2)
    for key, length in lengths.items():
        if length != most:
            raise InputError(f"vary.{key}", f"must have values for {most} members, got {length}")
    return integer("n", most, 2)
