"""Many runs of a scene, which differ in their starts, their numbers, or their noise.

Means serve chaotic motion and thermal noise, where single trajectories are not reproducible.  Kept
quantities of each member, or their statistics, serve maps and distributions.
"""

from __future__ import annotations

import json
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tribo.accuracy.comparison import Accuracy
from tribo.ensembles.checked_runs import CheckedPlan
from tribo.ensembles.dataset import kept_attributes, members_dataset, times_of
from tribo.ensembles.engines import Engine
from tribo.ensembles.kept_values import Kept, KeptValues, doubtful
from tribo.ensembles.means import check_series, checked_half_width, mean_dataset
from tribo.ensembles.members import Members, Sampler, Source, Variation, is_random, sources_of
from tribo.ensembles.request import END, SAMPLES, Request
from tribo.ensembles.runner import Execution, Runs, planned, policy_of
from tribo.ensembles.statistics import coordinates_of, variables_of
from tribo.ensembles.stores import MemberStore, StatisticsStore, Target, in_file
from tribo.model.scene import Scene
from tribo.model.scene_file import scene_from
from tribo.model.settings import names_of_quantities
from tribo.prepared import Simulation
from tribo.progress import Shown
from tribo.results.notes import scene_notes
from tribo.simulation import prepare
from tribo.validation import InputError, boolean, choice, instance, integer, short_repr

if TYPE_CHECKING:
    import xarray

# Most members that a half-width may take where their number is not given.
MOST_MEMBERS = 10_000


def ensemble(
    scene: Scene,
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
    """Run a scene from many starts; keep quantities of each member, their statistics, or means.

    Parameters
    ----------
    scene : Scene
        The scene.  All members share its heights; each uses a separate seed for noise and thermal
        starts.
    members : int, optional
        Number of members, at least 2. With `half_width`, the largest number. By default the
        length of the arrays in `vary`.
    vary : mapping, optional
        Quantities that differ between members: "surface.theta" (or another initial value),
        "surface.velocity", or a number of the scene as "surface.asperite.kappa" (of all its
        asperites), "surface.langevin.temperature" (or of its drive or bath) or
        "interaction.strength" -> an array of shape (members,), (members, asperites) or, for
        velocities, (members, 2); or a distribution with ``rvs(size=, random_state=)``, as those of
        scipy.stats, from which each asperite of each member draws. ``"*.theta"`` stands for that
        key of every surface without values of its own: arrays give all the same values, and each
        surface draws its own from a distribution.  Keys that exclude each other are refused.
    keep : sequence of str, optional
        The only quantities of each member to keep, as "upper.w1" or "contact_energy".
        Forces and energies as series need no ``output.series`` here.  At the end,
        "upper.friction_force" is the average over time of each member, and
        ``upper.friction_force_time_half_width`` that of its 95 % interval, as of
        :meth:`tribo.Result.friction_force`.  By default the scene's ``output.keep``; without that,
        means of all sums.
    at : {"end", "samples"}
        Whether quantities are kept at the end of each run or at all times of the scene's output.
    statistics : bool
        Return statistics of the kept quantities instead of the members, for more members than fit
        into memory.
    half_width : mapping, optional
        Quantity of a surface as a whole or of the system, as "upper.W" -> the largest half-width
        of the 95 % interval of its mean, at any recorded time, in units of the largest work or
        change of energy of a surface or of the system.  It determines the number of members.
    sampler : scipy.stats.qmc.QMCEngine, optional
        Its points replace random numbers in all distributions of `vary`, which need ``ppf``. It
        needs one dimension for each number that a member draws.
    engine : executor, optional
        Runs the members in other processes: it has ``submit`` or ``map`` as concurrent.futures
        defines them, or is a client of dask.distributed.
    out, resume
        As for :func:`simulate`.  With `keep`, values are read from ``out`` when used.
    accuracy, method, step, allow_unresolved
        As for :func:`prepare`.  A step is required where no accuracy of single runs can be kept.
    threads : int, optional
        Threads that run members in batches; by default TRIBO_THREADS, or one for each core that
        this process may use.  Values do not depend on it.
    progress : callable or bool, optional
        As for :func:`simulate`, with the number of members that have been run.
    seed : int
        The seed of the ensemble.  A member depends on it and on the member's number.

    Returns
    -------
    xarray.Dataset
        With `keep`, each quantity under its name (member, [time,] [asperite]), and for each
        member its ``status``, ``steps``, ``force_evaluations``, ``level`` of the tolerances, and
        ``error`` where it was measured.  Values of members that did not complete are NaN.  A
        quantity whose start is varied is ``upper.theta_end``.

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
        The ensemble was interrupted, as by Ctrl-C.  The attribute ``result`` of the exception has
        the data set of the complete members, if enough were, with the status "Interrupted".
    """
    of_scene = scene_notes(instance(Scene)("scene", scene))
    scene = scene.with_heights()
    if keep is None and half_width is None:
        keep = scene.output.keep
    for name, other in (("sampler", sampler), ("keep", keep)):
        if other is not None and half_width is not None:
            raise InputError("half_width", f"cannot go with {name}; give one or the other")
    at_samples = choice("at", at, (END, SAMPLES)) != END
    statistics = boolean("statistics", statistics)
    for name, given in (("at", at_samples), ("statistics", statistics)):
        if given and keep is None:
            needs = 'needs keep, as keep=["upper.w1"]'
            raise InputError(name, needs if half_width is None else "cannot go with half_width")
    vary = sources_of(scene, vary, sampler, members)
    names = None if keep is None else names_of_quantities("keep", keep)
    request = Request(names, at, False, accuracy, method, step, allow_unresolved)
    wanted = None if half_width is None else checked_half_width(scene, half_width)
    variation = Variation(scene, vary, integer("seed", seed, 0))
    if not (is_random(scene) or vary):
        raise InputError(
            "vary",
            "is empty, and nothing is random, so that all members would be the same; vary a start, "
            "give a reservoir, bath or start a temperature, or sweep the seed of random heights",
        )
    lengths = variation.lengths
    if members is None and wanted is None and not lengths:
        raise InputError("members", "is missing; give a number, or the half-width of a mean")
    if members is None:
        given_lengths = list(lengths.values())
        members = min(given_lengths if wanted is None else [*given_lengths, MOST_MEMBERS])
    most = integer("members", members, 2)
    variation.check(most)
    how = Execution.checked(engine, threads)
    recorded = request.recorded(scene)
    kept = request.kept(recorded)  # before anything is compiled
    check_series(kept, wanted or {})

    def compute(target: Target, progress: Callable[[float], None] | None) -> xarray.Dataset:
        simulation = request.prepare(scene, recorded)
        runs = planned(request, simulation, kept, variation, most, how._replace(progress=progress))
        if names is not None:
            return _collected(runs, statistics, most, target, of_scene)
        return mean_dataset(runs, target, wanted, most, of_scene)

    others = {"members": most, "statistics": statistics, "half_width": wanted}
    identify = partial(request.identity, recorded, variation, others)
    return in_file(out, resume, recorded, identify, progress, most, "members", compute)


def _collected(
    runs: Runs, statistics: bool, count: int, target: Target, of_scene: Sequence[str]
) -> xarray.Dataset:
    """The data set of all members or of their statistics; after an interrupt, of those so far.

    Its notes begin with those `of_scene`.
    """
    import xarray

    kept = runs.policy.kept
    attributes = kept_attributes(runs)
    level = float(attributes.get("level", "nan"))
    store: MemberStore | StatisticsStore = (
        StatisticsStore(kept, target.frames, level)
        if statistics
        else MemberStore(target.frames, level)
    )
    interrupted = runs.fill(store, count)
    attributes |= {"n": count, "members": json.dumps(store.tally.statuses)}
    plan = runs.policy.simulation.plan
    step = None if plan.automatic else plan.setting.step
    attributes |= {"doubtful": doubtful(store.tally.statuses) if step is not None else 0}
    notes = [*of_scene, *store.tally.notes(step)]
    attributes |= target.attributes(interrupted, notes)
    if isinstance(store, StatisticsStore):
        store.flush()
        if (moments := store.moments()) is None:
            if interrupted:
                raise KeyboardInterrupt
            raise InputError("scene", "is completed by no member")
        coordinates = times_of(kept, runs.policy.simulation.scene) | coordinates_of(kept)
        return target.saved(xarray.Dataset(variables_of(kept, moments), coordinates, attributes))

    def datasets(parts: Iterable[KeptValues]) -> Iterator[xarray.Dataset]:
        first = 0
        for found in parts:
            numbers = np.arange(first, first + found["status"].size)
            first += numbers.size
            members = runs.variation.members(numbers)
            yield members_dataset(runs.policy, members, found, attributes)

    if target.path is None or interrupted:
        return next(datasets([store.values()]))
    return target.saved_in_parts(datasets(store.parts()))


def ensemble_member(data: xarray.Dataset, number: int) -> xarray.Dataset:
    """Run one member of an ensemble again, alone.

    Parameters
    ----------
    data : xarray.Dataset
        The data set that :func:`tribo.ensemble` returns with `keep`, or that of its file.
    number : int
        The number of the member, from 0.

    Returns
    -------
    xarray.Dataset
        The quantities of this member, with the bits in `data` if version and machine are the same.

    Raises
    ------
    InputError
        If the data set contains no members with kept quantities, or not that member.
    """
    attributes = dict(data.attrs)
    if "keep" not in attributes or "member" not in data.coords:
        raise InputError("data", "must have members, as tribo.ensemble(..., keep=...) returns them")
    integer("number", number, 0)
    found = np.flatnonzero(data["member"].values == number)
    if found.size != 1:
        raise InputError("number", f"must be that of a member, got {short_repr(number)}")
    keep = json.loads(attributes["keep"])
    plan = CheckedPlan.from_attributes(attributes) if "scales" in attributes else None
    scene = scene_from(tomllib.loads(attributes["scene"]))
    # The method of a pair's lanes takes the place of `method`, which found the scales.
    step = json.loads(attributes["step"])
    simulation = prepare(
        scene, method=attributes["method_alone"], step=step, progress=False, threads=1
    )
    if attributes.get("automatic", False):  # a member may have needed a shorter step
        interval = json.loads(attributes["interval"])
        given = replace(simulation.plan, automatic=True, interval=interval)
        simulation = Simulation(given, simulation.integrator)
    at_samples = "time" in data.dims
    kept = (
        Kept.at_all_times(simulation.layout, keep)
        if at_samples
        else Kept.at_end(simulation.scene, keep)
    )
    one = data.isel(member=found)
    names = [str(name) for name in one.coords if "." in str(name)]
    members = Members(
        one["member"].values,
        one["seed"].values,
        {name: one[name].values.reshape(1, -1) for name in names},
    )
    policy = policy_of(simulation, kept, json.loads(attributes["own_numbers"]), plan)
    return members_dataset(policy, members, policy.complete(members), attributes)
