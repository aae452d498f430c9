"""What a reader of a result should know about its scene and its method."""

import math
from collections.abc import Iterator, Mapping

import numpy as np

from tribo.analysis.deep_core import core_notes
from tribo.integrators.methods import Method
from tribo.kernels.encounters import NEGLIGIBLE
from tribo.kernels.records import CLOCK
from tribo.kernels.status import Status
from tribo.layout.layout import Layout, once_per_layout
from tribo.ledger.ledger import Ledger, assemble
from tribo.ledger.samples import Samples
from tribo.ledger.separation import asperite_names, closest_bobs
from tribo.ledger.sinks import Watched, levers
from tribo.loops.integrate import Integration, reach_of
from tribo.loops.resolution import longest_step, pendulum_frequency, turn_of_step
from tribo.model.drives import RIGID_IS_OLD
from tribo.model.scene import Scene
from tribo.model.smoothness import smoothness_of
from tribo.model.spectrum import valid_until
from tribo.plugins.classes import parts
from tribo.plugins.sources import is_own
from tribo.potentials.tables import as_table
from tribo.results.averages import interval
from tribo.validation import short_repr

# Noted phase of the fastest pendulum between two kicks [rad]: static deflections are 2 % too small.
NOTED_TURN = 0.5
# Noted part of the given step that is taken.  Above it, errors are those of the given step within
# 10 % for a method of order 2, and a third for order 8: half the step changes more at any order.
NOTED_CUT = 0.95
# Noted part of the other drives' work: below it, that is the dissipated energy to one digit.
NOTED_WORK = 0.1
# A seam of n neighbours is noted where their r.m.s. step is larger than elsewhere by this over
# sqrt(n): three standard deviations.
SEAM = 2.1
# Noted excess of the kinetic temperature, relative: the rule of chosen steps.
NOTED_EXCESS = 0.01
# What notes on energy say of which a ledger knows no source, and on a step that heats.
NO_WORK = "no work accounts for"
HEATS = "heat: by the stiffness of the forces that the motion met"
# Blocks of equal length whose rates give the interval of a pumped heat; fewer make it wide.
BLOCKS = 10
# Part of a period by which lengths that were meant to be equal may differ.
ROUNDED = 1e-9
# Recorded times at which the distances of bobs are looked at, at most: 0.1 ms each for a pair.
MOST_LOOKS = 256


def run_notes(layout: Layout, method: Method, step: float | None) -> tuple[str, ...]:
    """Notes on starts, rough potentials, given steps, and baths that are too small."""
    scene = layout.scene
    steps = [] if step is None else [*_on_cut(layout, step), *_on_step(layout, method, step)]
    starts = [*core_notes(layout), *_on_places(scene), *scene_notes(scene)]
    return (*starts, *_on_potentials(scene, method), *steps, *_on_baths(scene))


def scene_notes(scene: Scene) -> list[str]:
    """Notes on what a scene contains, which hold for all its members too."""
    of_starts = [*_on_images(scene), *_on_angles(scene), *_on_scans(scene), *_on_seams(scene)]
    return [*of_starts, *_on_rigid(scene), *_on_interactions(scene)]


def _on_rigid(scene: Scene) -> Iterator[str]:
    """A note on each surface whose asperites move as one along x alone."""
    for surface in scene.surfaces:
        if surface.moves_as_one:
            yield f'"{surface.name}" has drive.rigid = true, which {RIGID_IS_OLD}'


def _on_interactions(scene: Scene) -> Iterator[str]:
    """Interactions for which there is no pair of surfaces."""
    for number, interaction in enumerate(scene.interactions):
        if not scene.pairs(interaction):
            only = ", ".join(f'"{surface.name}"' for surface in scene.surfaces)
            yield (
                f"interaction {number} ({short_repr(as_table(interaction.potential)['potential'])})"
                f" acts on nothing: {only} is the only surface, and it has no `between`; add a "
                "[[surface]] that faces it"
            )


def _on_scans(scene: Scene) -> Iterator[str]:
    """Scans some of whose points have no height, or one that may stand for none."""
    for surface in scene.surfaces:
        scan = surface.scan
        if scan is None:
            continue
        of = f'of {scan.points} points of the scan of "{surface.name}" have'
        if scan.undefined:
            yield f"{scan.undefined} {of} no height, and are interpolated from those around"
        if scan.outliers:
            yield f"{scan.outliers} {of} heights far from all others; give nan where there is none"


def _on_seams(scene: Scene) -> Iterator[str]:
    """A note where given heights have a larger step at the end of a period than elsewhere."""
    for surface in scene.surfaces:
        given = surface.has_given_heights
        heights = surface.drawn_heights(0) if given and surface.positions is None else None
        if heights is None:
            continue
        heights = heights.reshape(surface.shape[::-1])
        for axis, name in enumerate("zx"):
            period = getattr(scene.periodic, name)
            spacing = abs(surface.spacing[1 - axis])
            steps = np.diff(heights, axis=axis)
            if period is None or steps.size == 0 or spacing == 0.0:
                continue
            gap = period - steps.shape[axis] * spacing
            ends = np.take(heights, 0, axis) - np.take(heights, -1, axis)
            seam, inner = (math.sqrt(np.mean(each**2)) for each in (ends, steps))
            # Neighbours within a step and a half; the mean of n squares differs by chance.
            bound = (1.0 + SEAM / math.sqrt(ends.size)) * inner * max(gap / spacing, 1.0)
            if gap < 1.5 * spacing and seam > bound:
                yield (
                    f'the heights of "{surface.name}" have a seam where the scene repeats along '
                    f"{name}: neighbours differ by {seam:.3g} there and by {inner:.3g} elsewhere "
                    '(r.m.s.); heights of a periodic surface have none, with detrend = "mean"'
                )


def budget_notes(layout: Layout, ledger: Ledger, bounds: Mapping[str, float]) -> tuple[str, ...]:
    """A note where the energy budget does not close with potentials or fields of the user's own."""
    own = _users_potentials(layout)
    if not own or "applied_work" not in ledger.system:
        return ()
    system = ledger.system
    change = system["total_energy_change"]
    work = system["applied_work"]
    gap = float(np.max(np.abs(change - work)))
    bound = bounds["total_energy_change"] + bounds["applied_work"]
    if not gap > bound:
        return ()
    return (
        f"the energy budget does not close: the total energy and the work applied differ by "
        f"{gap:.1e}, more than their errors of {bound:.1e}; the force of {' or '.join(own)} is not "
        "conservative, or less smooth than it declares; tribo check tells which",
    )


@once_per_layout
def _users_potentials(layout: Layout) -> tuple[str, ...]:
    """The names of the classes of potentials that are not tribo's own."""
    scene = layout.scene
    potentials = [each.potential for each in scene.interactions]
    potentials += [each.potential for each in scene.fields]
    inner = [type(part) for each in potentials for part in parts(each)]
    return tuple(dict.fromkeys(kind.__name__ for kind in inner if not is_own(kind)))


def passage_notes(layout: Layout, run: Integration) -> Iterator[str]:
    """A note on encounters that steps of a run with noise have passed."""
    count, *bobs = run.passages
    yield (
        f"in {count} steps bobs passed one another within the step, "
        f"{asperite_names(layout, bobs)} last; their potential energy is below {NEGLIGIBLE:g} "
        "k_B T there and does not affect the motion, but works of their contact are "
        "inaccurate; a smaller step resolves them"
    )


def drive_notes(layout: Layout, samples: Samples) -> Iterator[str]:
    """What the drive does of every forced surface at rest, if its bars swing and it does work.

    A single encounter, as in the cases of the paper, measures no friction: its works are the
    result, and a note on them would read as a fault.
    """
    at_rest = _held_at_rest(layout)
    if not at_rest:
        return
    surfaces = layout.scene.surfaces
    ledger = assemble(layout, samples.ends())
    works = {s.name: float(np.add.reduce(ledger.of(s.name)["w2"][-1])) for s in surfaces}
    others = sum(work for name, work in works.items() if name not in at_rest)
    for name in at_rest:
        if abs(works[name]) > NOTED_WORK * abs(others) > 0.0:
            yield (
                f'the force that holds the centre of mass of "{name}" also does work, '
                f"{works[name]:.3g} (other drives: {others:.3g}), because its bars move; with "
                'drive = "bars" it does none'
            )


@once_per_layout
def _held_at_rest(layout: Layout) -> tuple[str, ...]:
    """The surfaces about whose drives :func:`drive_notes` may have something to say."""
    surfaces = layout.scene.surfaces
    single = all(s.count == 1 for s in surfaces)
    if layout.model.ledger is None or single:
        return ()
    return tuple([s.name for s in surfaces if s.drive.cancels_x and s.velocity == (0.0, 0.0)])


def pumping_notes(layout: Layout, watched: Watched) -> Iterator[str]:
    """A note where forced drives do more work than surfaces that all receive heat could take up.

    With f2 = -f1 the work of contact at the bobs, about the centres of mass, is the part lambda =
    m2 / (m1 + m2) of the energy A that an asperite receives, and the drive's work is the rest:

        work of the drives = sum of A + change of U
        friction times distance = sum of lambda A + change of U

    Where every A is positive the first is at most the second over the smallest lambda, apart from
    U.  At a temperature, with unlike lambda, A may be negative on average, without bound: the
    drives then heat one surface with energy of the reservoir of another.
    """
    scene = layout.scene
    t = watched.t
    later = t >= scene.output.run_in
    if np.count_nonzero(later) <= 2 * BLOCKS:
        return
    t = t[later]
    work, friction = watched.works[later].T
    smallest = float(np.min(levers(scene)))
    edges = np.linspace(t[0], t[-1], BLOCKS + 1)
    excess = np.diff(np.interp(edges, t, work - friction / smallest))
    mean, half_width = interval(excess)
    if mean > half_width:
        yield (
            f"the drives do {work[-1] - work[0]:.4g} of work, which exceeds friction times "
            f"distance, {friction[-1] - friction[0]:.4g}, over the smallest m2 / (m1 + m2), "
            f"{smallest:.3g}, by {np.sum(excess):.4g} +- {BLOCKS * half_width:.2g}: at a "
            "temperature, forced drives pump heat out of a surface where m2 / (m1 + m2) differs "
            'between asperites; drive = "bars" does not'
        )


def stop_notes(layout: Layout, run: Integration) -> Iterator[str]:
    """Why and where a run stopped, the closest bobs, and what a whole run would take."""
    yield from (f"the calculator raised {failure}" for failure in run.failures)
    if run.status in (Status.COMPLETED, Status.INTERRUPTED, Status.PASSED_THROUGH):
        return
    clock = dict(zip(CLOCK.names or (), run.memory["clock"], strict=True))
    taken = clock["last_step"]
    cure = ""
    step = f"after a last step of {taken:.3g}" if taken > 0.0 else "before the first step"
    t, near = _closest_at_end(layout, run)
    if run.status == Status.ENCOUNTER_JUMPED and clock["encounter_rate"] > 0.0:
        cure = f"; a step below {1.0 / clock['encounter_rate']:.2g} resolves this encounter"
    yield f"stopped at t = {t:.9g}, {step}{near}{cure}"
    done = t - layout.beginning
    if run.status == Status.NO_PROGRESS and done > 0.0:
        whole = run.evaluations * (layout.scene.duration - layout.beginning) / done
        yield f"at its mean rate, {reach_of(layout.scene, whole, layout.beginning)}"


def too_long(layout: Layout, run: Integration) -> str:
    """Why the steps of a run that did not complete are too long: the end of a sentence."""
    t, near = _closest_at_end(layout, run)
    if run.status == Status.ENCOUNTER_JUMPED:
        return f"would have passed an encounter at t = {t:.4g}{near}"
    if run.status == Status.STEP_TOO_LONG and run.stiffness is not None:
        return (
            f"do not resolve the stiffest motion up to t = {t:.4g}, at "
            f"{float(run.stiffness.frequency):.3g} rad per unit of time"
        )
    return f"are too long for the motion, which runs away at t = {t:.4g}"


def missed_energy(missed: float, through: float) -> str:
    """What no work accounts for, of the energy that went through a scene: a part of a sentence."""
    return f"{NO_WORK} {missed:.2g} of the {through:.2g} that reservoirs and drives exchange"


def repeat_note(step: float, why: str, shorter: float) -> str:
    """A note on an automatic step that was too long for the motion of a run."""
    return f"steps of {step:.3g} {why}; the run was repeated with steps of {shorter:.3g}"


def missed_note(missed: str, step: float) -> Iterator[str]:
    """A note on a run with noise that misses energy, by `missed_energy`; none where it does not."""
    if missed:
        yield (
            f"{missed}, with steps of {step:.3g}; shorter steps resolve hard collisions, unless a "
            "force is not conservative (tribo check tells)"
        )


def excess_note(excess: float, step: float) -> Iterator[str]:
    """A note on steps that heat a scene with noise, by the excess of the kinetic temperature."""
    if not excess > NOTED_EXCESS:
        return
    part = excess / (1.0 + excess) if math.isfinite(excess) else 1.0
    times = f"{1.0 + excess:.3g} times" if math.isfinite(excess) else "beyond any multiple of"
    yield (
        f"steps of {step:.3g} {HEATS}, the kinetic temperature is {times} that of the "
        f"reservoir; steps of {0.9 * step * math.sqrt(NOTED_EXCESS / part):.2g} keep this below 1 %"
    )


def _closest_at_end(layout: Layout, run: Integration) -> tuple[float, str]:
    """The time at which a run ended, and the closest bobs then, as a part of a sentence."""
    last = run.samples.last()
    bobs = closest_bobs(layout, last)
    if bobs is None:
        return float(last.t[0]), ""
    both = asperite_names(layout, bobs[1:])
    return float(last.t[0]), f"; the closest bobs, of {both}, were {bobs.distance:.3g} apart"


def approach_notes(layout: Layout, run: Integration) -> Iterator[str]:
    """Where the bobs of a run that missed its accuracy were closest, among its recorded times."""
    samples = run.samples
    looked_at = np.linspace(0, samples.t.size - 1, min(samples.t.size, MOST_LOOKS)).astype(int)
    looks = ((closest_bobs(layout, samples.at(np.array([t]))), t) for t in samples.t[looked_at])
    found = [(*bobs, float(t)) for bobs, t in looks if bobs is not None]
    if found:
        distance, *both, t = min(found)
        yield (
            f"among the recorded times, bobs were closest at t = {t:.9g}: those of "
            f"{asperite_names(layout, both)} were {distance:.3g} apart"
        )


def _on_places(scene: Scene) -> Iterator[str]:
    """Surfaces of which several asperites are on one place."""
    for surface in scene.surfaces:
        number = surface.count
        if surface.positions is None:
            shape = surface.shape
            spacing = surface.spacing
            places = math.prod(n if d else 1 for n, d in zip(shape, spacing, strict=True))
            advice = "give a spacing [length] for each axis of shape"
        else:
            places = len(np.unique(surface.positions, axis=0))
            advice = "give other positions"
        if places < number:
            yield (
                f'the {number} asperites of "{surface.name}" are on {places} '
                f"place{'s' if places > 1 else ''}, where alike ones act as one; {advice}"
            )


def _on_images(scene: Scene) -> Iterator[str]:
    """Grids that are longer than the period, whose asperites stand among images of their own."""
    for surface in scene.surfaces:
        if surface.positions is not None:
            continue
        for axis, name in enumerate("xz"):
            period = getattr(scene.periodic, name)
            number = surface.shape[axis]
            spacing = abs(surface.spacing[axis])
            if period is not None and (number - 1) * spacing >= period * (1.0 - ROUNDED):
                yield (
                    f'"{surface.name}" has {number} asperites {spacing:.4g} apart along {name}, in '
                    f"a period of {period:.4g}, so that they stand among images of one another; "
                    f"{math.floor(period / spacing * (1.0 + ROUNDED))} fit in it"
                )


def _on_angles(scene: Scene) -> Iterator[str]:
    """Initial angles beyond a whole turn, which may be degrees."""
    for surface in scene.surfaces:
        phi = surface.initial_of_each["phi"]
        swing = surface.initial_swing
        for name, angles in (("swing from rest", swing), ("phi", phi)):
            largest = 0.0 if angles is None else float(np.max(np.abs(angles)))
            if largest > 2.0 * math.pi:
                yield (
                    f'"{surface.name}" starts with a {name} of {largest:.4g} rad, more than a '
                    f"whole turn; {largest:.4g} degrees would be {math.radians(largest):.4g}"
                )


def _on_potentials(scene: Scene, method: Method) -> Iterator[str]:
    """Potentials that are less smooth than the method needs them to be."""
    for interaction in scene.interactions:
        smoothness = smoothness_of(interaction.potential)
        if smoothness >= method.smoothness:
            continue
        name = short_repr(as_table(interaction.potential)["potential"])
        if smoothness < 0:
            yield (
                f"the energy of {name} jumps, which no force accounts for: the ledger does not "
                "close where bobs cross the jump"
            )
        else:
            yield (
                f"{name} has {smoothness:g} continuous derivatives; {method.name} needs "
                f"{method.smoothness} for errors of order {method.order}"
            )


def _on_cut(layout: Layout, step: float) -> Iterator[str]:
    """A note on steps that are shorter than the given one, since samples are closer together."""
    taken = longest_step(layout, step)
    interval = float(np.max(np.diff(layout.times)))
    longer = f"a step that divides {interval:.4g} is taken as it is given"
    if step > interval:
        longer = "fewer samples allow longer steps"
    if taken < NOTED_CUT * step:
        yield (
            f"steps are at most {taken:.4g} long in place of {step:.4g}: they are equal parts of "
            f"the time between two samples, at most {interval:.4g}; {longer}"
        )


def _on_step(layout: Layout, method: Method, step: float) -> Iterator[str]:
    """A note on pendulums that a given step of a splitting method hardly resolves."""
    if not method.splits:
        return
    turn = turn_of_step(layout, method, step, pendulum_frequency(layout))
    if turn > NOTED_TURN:
        right = 0.5 * turn / math.tan(0.5 * turn)
        yield (
            f"the fastest pendulum rotates by {turn:.2g} rad from one kick to the next, so "
            f"constant forces deflect it by {right:.2g} of the right angle; steps up to "
            f"{step * NOTED_TURN / turn:.2g} keep this error below 2 %"
        )


def _on_baths(scene: Scene) -> Iterator[str]:
    """Baths that represent a continuum for less than the duration of the run."""
    for surface in scene.surfaces:
        if surface.bath.spectrum is None:
            continue
        each = surface.each
        stiffness = 0.0 if surface.asperite.is_rigid else each["kappa"]
        frequency = float(np.max(np.sqrt(stiffness / each["inertia"])))
        until = valid_until(surface.bath.spectrum, float(np.min(each["mass"])), frequency)
        if until < scene.duration:
            yield (
                f'the bath of "{surface.name}" stands for a continuum until t = {until:.4g}; the '
                f"run lasts {scene.duration:g}, so give it more oscillators"
            )
