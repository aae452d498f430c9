"""Averages over time of the forces on a surface: friction, and the force of its drive."""

import numpy as np

from tribo.kernels.status import Status
from tribo.layout.legs import begun_of, scheduled_numbers
from tribo.ledger.ledger import Series
from tribo.ledger.quantities import AVERAGED
from tribo.model.number import changes, largest
from tribo.model.scene import Scene
from tribo.model.surface import Surface
from tribo.results.averages import Average, average_from
from tribo.results.run_result import RunResult, begin_of, begin_or_auto, stop_of
from tribo.validation import InputError, choice

PARTS = ("contact", "field")
# Part of a mean force that its samples may miss without a note.
NOTED_MISS = 0.05
# Part of the pull above which the drag of a reservoir is noted: less leaves its first digit.
NOTED_DRAG = 0.1


def friction_force(
    result: RunResult, surface: str, after: float | str | None = None, part: str | None = None
) -> Average:
    """The time average of the friction force on a surface, with a 95 % interval.

    The friction force is the x component of the force that resists sliding: the sum of all
    contact forces f1 and of all forces of external fields.  It is negative on a surface that
    slides towards positive x.  The scene's output must ask for the series "forces".

    Parameters
    ----------
    surface : str
        Name of the surface.
    after : float or "auto", optional
        When the average begins, as in :func:`tribo.time_average`; by default at the scene's
        ``output.run_in`` [time].
    part : "contact" or "field", optional
        Select one of the two; None for both.

    Returns
    -------
    Average
        As of :func:`tribo.time_average` [force].  Its note says where a run stopped.

    Raises
    ------
    InputError
        If there is no such surface, `after` is neither "auto" nor a time of the run before its end,
        the forces were not recorded, no field acts on the surface, or there are fewer than two
        samples.
    """
    name = "friction_force"
    if part is not None:
        scene = result.scene
        has_field = scene.has_field(scene.surfaces[scene.index_of(surface)])
        if choice("part", part, PARTS) == "field" and not has_field:
            raise InputError("part", f'must be "contact": no field acts on "{surface}"')
        name = f"{part}_force" if has_field else name
    return force_average(result, f"{surface}.{name}", after)


def pull_force(result: RunResult, surface: str, after: float | str | None = None) -> Average:
    """The time average of the drive's force on a surface, with a 95 % interval.

    It is the x component of the sum of f2 over the asperites: of the springs of a pulled
    surface, or of the reaction that holds driven bars.  It is positive on a surface that is
    pulled towards positive x.  The scene's output must ask for the series "forces".

    Parameters
    ----------
    surface, after
        As for :meth:`friction_force`.

    Returns
    -------
    Average
        As of :meth:`friction_force`.
    """
    return force_average(result, f"{surface}.pull_force", after)


def friction_coefficient(
    result: RunResult, surface: str, after: float | str | None = None
) -> Average:
    """The time average of the friction force on a surface, divided by the load on it.

    Parameters
    ----------
    surface, after
        As for :meth:`friction_force`; the surface's drive has a load.

    Returns
    -------
    Average
        As of :meth:`friction_force`, relative to the load and in the direction of the mean, which
        is not negative.
    """
    found = friction_force(result, surface, after)
    part = result.scene.surfaces[result.scene.index_of(surface)]
    if changes(part.drive.load):
        raise InputError(
            f"{surface}.drive.load",
            "changes with time, so that no one load divides the friction force; take "
            "friction_force, and a mean of the load over the same time",
        )
    load = load_of(part)
    if load == 0.0:
        raise InputError(f"{surface}.drive.load", "is missing; name the surface that has the load")
    # The series itself is divided: notes quote its numbers.
    toward = float(np.copysign(load, found.mean))
    return force_average(result, f"{surface}.friction_force", after, per=toward)


def force_average(
    result: RunResult, full: str, after: float | str | None = None, per: float = 1.0
) -> Average:
    """The average of "upper.pull_force", by default from ``output.run_in`` on; it notes a stop.

    It is `per` another force, as a load.
    """
    surface, _, name = full.rpartition(".")
    result.scene.index_of(surface)
    begin = begin_or_auto(result, after)
    series = result[surface]
    if name not in series and not result.ledger.kept:
        if "forces" in result.scene.output.series:
            ledger = result.scene.output.ledger
            raise InputError("output.ledger", f'must be "asperites", got "{ledger}": f2 has noise')
        raise InputError("output.series", 'does not contain "forces"; add it, and run again')
    stop = stop_of(result)
    t, values = _up_to_stop(result, series, name)
    values = values / per
    # Means over the intervals that end at the samples have no first value.
    of_intervals = bool(np.isnan(values[0]))
    if not of_intervals:
        finite = np.isfinite(values)
        t = t[finite]
        values = values[finite]
    try:
        found = average_from(t, values, begin, of_intervals)
    except InputError as error:
        field = "output.run_in" if after is None and error.field == "after" else error.field
        raise InputError(field, "; ".join(filter(None, [error.problem, stop]))) from None
    notes = [stop, found.note, _schedule_note(result, found.after)]
    if name == "pull_force":
        notes.append(_drag_note(result, surface, found.mean))
    if name == "friction_force":
        notes.append(_sampling_note(result, surface, found, t[-1], per))
    return found._replace(note="; ".join(filter(None, notes)))


def _sampling_note(result: RunResult, surface: str, found: Average, end: float, per: float) -> str:
    """A note where the samples of the friction force miss a part of the motion; else empty.

    Samples at one phase of a periodic motion have a mean of their own.  The impulse of the contact,
    which is integrated, has none: it does the friction work at the surface's initial velocity.
    """
    part = result.scene.surfaces[result.scene.index_of(surface)]
    series = result[surface]
    speed, along_y = part.velocity
    in_field = result.scene.has_field(part)
    if in_field or speed == 0.0 or along_y != 0.0 or "friction_work" not in series:
        return ""
    first, last = np.searchsorted(result.t, [found.after, end])
    gained = series["friction_work"][last] - series["friction_work"][first]
    exact = -float(gained) / (speed * (end - found.after)) / per
    missed = abs(found.mean - exact)
    by_chance = 2.0 * found.half_width if np.isfinite(found.half_width) else found.spread
    if not missed > max(by_chance, NOTED_MISS * abs(exact)):
        return ""
    return (
        f"the samples miss a part of the motion: by the impulse of the contact the mean is "
        f"{exact:.4g}; record more samples, at other distances in time"
    )


def _schedule_note(result: RunResult, after: float) -> str:
    """A note where a schedule changes the conditions during an average; else empty."""
    state = result.state()
    for each in scheduled_numbers(result.scene):
        kinks = np.array(each.schedule.kinks) + begun_of(each, state.begun)
        if each.schedule.is_sine or np.any((kinks > after) & (kinks < result.t[-1])):
            of = "a field" if each.field >= 0 else f'"{result.scene.surfaces[each.surface].name}"'
            return (
                f"a schedule of {of} changes the conditions during the average; select a part "
                "with one condition by after=, or by the duration"
            )
    return ""


def _up_to_stop(result: RunResult, series: Series, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Times and values of a force up to the last time at which all forces of the surface are known.

    The last ones of a stopped run may be infinite; averages of all forces end at one time.
    """
    every = [name] if result.status == Status.COMPLETED else set(AVERAGED).intersection(series)
    known = np.logical_and.reduce([np.isfinite(series[each]) for each in every])
    end = 1 + int(np.max(np.flatnonzero(known), initial=0))
    return result.t[:end], np.asarray(series[name][:end])


def recorded_averages(result: RunResult) -> dict[str, dict[str, Average]]:
    """The averages of friction forces and of drives by surface, where they are recorded."""
    later = np.count_nonzero(result.t >= result.scene.output.run_in)
    averages = {}
    for name in ("friction_force", "pull_force"):
        of = [surface for surface, block in result.ledger.blocks.items() if name in block]
        if of and later > 2:  # the first may have no value
            averages[name] = {s: force_average(result, f"{s}.{name}") for s in of}
    return averages


def time_without_contact(result: RunResult, surface: str, after: float | None = None) -> float:
    """The fraction of time in which no bob of a surface is in contact with another surface.

    Two bobs are in contact where they repel each other: closer than the largest distance at
    which the force between them is repulsive.  Where it repels without an end, they are in
    contact if their energy is at least 1 % of the sum of the energy of torsion by 1 rad of the
    softest asperite and of k_B T.  The scene's output must ask for the series "forces".

    Parameters
    ----------
    surface : str
        Name of the surface.
    after : float, optional
        When the average begins; by default the scene's ``output.run_in`` [time].

    Returns
    -------
    float
        Between 0 and 1.

    Raises
    ------
    InputError
        If there is no such surface, `after` is no time of the run before its end, the contact was
        not recorded, or has no range, as that of Coulomb, or there are fewer than two samples.
    """
    result.scene.index_of(surface)
    begin = begin_of(result, after)
    series = result[surface]
    if "time_without_contact" not in series and not result.ledger.kept:
        raise InputError(
            "output.series",
            'does not contain "forces", or the contact has no range: time_without_contact is '
            "not recorded",
        )
    later = result.t >= begin
    t = result.t[later]
    without = series["time_without_contact"][later]
    if t.size < 2:
        stop = stop_of(result)
        problem = f"leaves {t.size} samples, and a share of time takes two"
        raise InputError("after", "; ".join(filter(None, [problem, stop])))
    return float(np.sum(0.5 * (without[1:] + without[:-1]) * np.diff(t)) / (t[-1] - t[0]))


def shares_without_contact(result: RunResult) -> dict[str, float]:
    """The share of time without contact of every surface, where it is recorded, by name."""
    if np.count_nonzero(result.t >= result.scene.output.run_in) < 2:
        return {}
    names = [n for n, b in result.ledger.blocks.items() if "time_without_contact" in b]
    return {name: time_without_contact(result, name) for name in names}


def has_mean_friction(scene: Scene) -> bool:
    """Whether sliding goes on, so that a mean friction force says something.

    Asperites that pass others meet each once: where their forces are not even recorded, or two
    asperites meet alone, the mean depends on how long the run lasts.
    """
    pulled = any(surface.drive.stage is not None for surface in scene.surfaces)
    loaded = any(load_of(surface) > 0.0 for surface in scene.surfaces)
    recorded = scene.count > 2 and "forces" in scene.output.series
    return recorded or pulled or loaded or bool(scene.fields) or scene.periodic.x is not None


def load_of(surface: Surface) -> float:
    """The load on all asperites of a surface, the largest of a schedule; zero without one."""
    return largest(surface.drive.load) * (1 if surface.drive.block else surface.count)


def _drag_note(result: RunResult, surface: str, pull: float) -> str:
    """A note where the drag of a reservoir on the bars is a large part of the pull."""
    part = result.scene.surfaces[result.scene.index_of(surface)]
    reservoir = part.reservoir("bar")
    series = result[surface]
    if reservoir is None or "x_bar" not in series:
        return ""
    still = part.velocity if reservoir.velocity is None else reservoir.velocity
    moved = series["x_bar"][-1] - series["x_bar"][0]
    velocities = moved / (result.t[-1] - result.t[0]) - still[0]
    drag = float(-np.sum(reservoir.gamma * velocities))
    if abs(drag) <= NOTED_DRAG * abs(pull):
        return ""
    return f"the reservoir's drag on the bars, {drag:.2g}, is more than a tenth of it"
