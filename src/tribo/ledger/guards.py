"""Guards of runs: energy that no work accounts for, and surfaces that pass through each other.

A run is lost where its energy grows beyond all bounds.  A step may also be too long for a few hard
collisions, of which each gives the motion a little energy that no force has done work for.

Where bars of one surface are beyond all bobs of the other, they have passed.  Bobs may change their
order in y without that: rods pass beside each other, and pendulums turn over.  A bar that is lower
than every bob of a surface below it has passed the rods there too.  A surface that carries a load
is to stay on the other; bodies without one, as those that attract each other, may pass.
"""

from collections.abc import Iterator

import numpy as np

from tribo.kernels import records as row
from tribo.kernels.records import OF_MEMBERS
from tribo.kernels.samples import BATH, SPRINGS, TORSIONAL, WITHIN
from tribo.layout.layout import Layout, once_per_layout
from tribo.ledger.ledger import Ledger, assemble
from tribo.ledger.motion import mean_velocity, motions
from tribo.ledger.quantity import Table
from tribo.ledger.samples import Samples

# Energy that appears, in units of that at the start, from which a run counts as lost: a step that
# is too long for a spring multiplies it by 1e3 in tens of steps, an inaccurate one does not.
RUNAWAY = 1e3
# Part of the energy that went through a scene with noise, of which no work may account for more
# than this.  A step that suits the mean stiffness misses 0.6 % of what reservoirs at rest exchange,
# as the kinetic temperature is as much too high; of 324 random scenes 95 % miss less than 0.11 %
# (benchmarks/missed_energy.py).
MOST_MISSED = 0.01
# Part of the bars of a surface that must pass for the surface to count as passed.
MOST_PASSED = 0.5


def lost_sample(layout: Layout, samples: Samples) -> int | None:
    """The index of the first sample at which the energy has run away; None without a ledger."""
    lost = np.flatnonzero(lost_samples(layout, samples))
    return int(lost[0]) if lost.size else None


def lost_samples(layout: Layout, samples: Samples) -> np.ndarray:
    """At which samples of runs the energy has run away, as in :func:`first_lost`.

    (times x runs,); at none without a ledger.
    """
    grown = grows(layout, samples)
    if layout.model.ledger is None or not np.any(grown):
        return np.zeros(samples.t.size, dtype=bool)
    excess, so_far = _excess(samples, assemble(layout, samples).system)
    return np.asarray(grown & (excess > so_far))


def first_lost(
    layout: Layout, samples: Samples, system: Table, known: float = 0.0
) -> tuple[int | None, float]:
    """The first sample of a run at which the energy has run away, if any, and the largest energy.

    There the energy exceeds RUNAWAY times that at the start, and its change differs from applied
    work by more than any applied work and any energy of contact or of fields so far.  `known` is
    the largest of these before the samples, the first of which is the start of the run.
    """
    excess, so_far = _excess(samples, system, known)
    lost = np.flatnonzero(grows(layout, samples) & (excess > so_far))
    return (int(lost[0]) if lost.size else None), float(so_far[-1])


@np.errstate(over="ignore", invalid="ignore")  # an energy may exceed all numbers
def _excess(samples: Samples, system: Table, known: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Energy that no work accounts for, and the largest energy of a run so far, for each sample."""
    excess = np.abs(system["total_energy_change"] - system["applied_work"])
    terms = np.abs([samples.contact, samples.field, system["applied_work"]])
    each = np.maximum(np.max(terms, axis=0), known).reshape(-1, samples.runs)
    return excess, np.maximum.accumulate(each, axis=0).ravel()


@np.errstate(over="ignore", invalid="ignore")  # an energy may exceed all numbers
def grows(layout: Layout, samples: Samples) -> np.ndarray:
    """Whether the energy exceeds RUNAWAY times that at the start, (times x runs,).

    It is the sum of the magnitudes of all energies, in the frame of the surfaces' mean velocity.
    Where it is zero at the start, the first one that is not takes its place: the work of a drive
    that begins is not known better than the little energy that it has given.
    """
    mean = mean_velocity(layout)[..., None]
    stores = samples.stored[:, :, [SPRINGS, BATH, TORSIONAL, WITHIN]]
    energy = np.sum(np.abs(stores), axis=(1, 2)) + np.abs(samples.contact) + np.abs(samples.field)
    for index in range(len(layout.parts)):
        for m in motions(layout, samples, index):
            vx, vy = m.span.velocity - mean
            moving = 0.5 * ((m.vx + vx) ** 2 + (m.vy + vy) ** 2)
            energy = energy + np.sum(moving * m.span.asperites.mass + m.energy, axis=1)
    of_runs = energy.reshape(-1, samples.runs)
    first = np.argmax(of_runs != 0.0, axis=0)
    return np.asarray(of_runs > RUNAWAY * of_runs[first, np.arange(samples.runs)]).ravel()


def missed_energy(layout: Layout, ledger: Ledger, runs: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Energy that no work accounts for at the end of runs, and that which went through the scene.

    Each (runs,).  What went through is at least what drives and reservoirs did, and what reservoirs
    exchange with a scene at their temperature.  Zeros where the ledger does not have both energies.
    """
    system = ledger.system
    if "applied_work" not in system or "total_energy_change" not in system:
        return np.zeros(runs), np.zeros(runs)
    work = system["applied_work"][-runs:]
    missed = np.abs(system["total_energy_change"][-runs:] - work)
    through = np.abs(work) + _exchanged(layout)
    for heat in ledger.series("heat"):  # of each asperite, or of the surface as a whole
        through = through + np.abs(np.sum(heat[-runs:].reshape(runs, -1), axis=1))
    return missed, through


@once_per_layout
def _exchanged(layout: Layout) -> np.ndarray:
    """Energy that reservoirs give to a scene at their temperature, and take back, in a whole run.

    (1,), or (runs,) of members with numbers of their own.  Each coordinate has T / 2, of which
    damping takes 2 gamma / m in a unit of time.
    """
    table = layout.constants
    numbers = layout.numbers
    found = np.zeros(1 if numbers is None else len(numbers.of_surfaces))
    for index, (surface, part) in enumerate(
        zip(layout.scene.surfaces, layout.parts.values(), strict=True)
    ):
        for reservoir in surface.reservoirs:
            on_bars = reservoir.on == "bar"
            if numbers is None:
                gamma, temperature = reservoir.for_each(surface.count)
            else:
                names = (name if on_bars else f"swing_{name}" for name in ("gamma", "temperature"))
                own = numbers.of_surfaces[:, index]
                gamma, temperature = (own[:, [OF_MEMBERS.index(name)]] for name in names)
            rates = gamma / table[row.MASS if on_bars else row.INERTIA, part]
            each = (2.0 if on_bars else 1.0) * temperature * (0.5 + rates * layout.run_time)
            as_one = on_bars and (surface.is_rigid_block or surface.moves_as_one)
            found += np.mean(each, axis=-1) if as_one else np.sum(each, axis=-1)
    return found


def passing_notes(layout: Layout, samples: Samples) -> Iterator[str]:
    """A note on bars that have passed another surface by the last sample."""
    pairs = facing(layout)
    if not pairs:
        return
    last = samples.ends()
    surfaces = layout.scene.surfaces
    for mine, theirs in pairs:
        if surfaces[mine].drive.holds_bars:  # the other one has moved, and has its own note
            continue
        beyond = _beyond(layout, last, mine, theirs)[-1]
        if np.any(beyond):
            yield (
                f'{np.count_nonzero(beyond)} of {beyond.size} bars of "{surfaces[mine].name}" '
                f'passed through "{surfaces[theirs].name}" by t = {last.t[-1]:.6g}; '
                f"{_what_holds_them(layout, last, mine, theirs, beyond)}"
            )


def _what_holds_them(
    layout: Layout, last: Samples, mine: int, theirs: int, beyond: np.ndarray
) -> str:
    """What keeps bars from passing that are `beyond` another surface, (asperites,)."""
    bars = _places(layout, last, mine, "bar", axis=0)[-1, beyond]
    bobs = _places(layout, last, theirs, "bob", axis=0)[-1]
    low = float(np.min(bobs))
    high = float(np.max(bobs))
    off = np.count_nonzero((bars < low) | (bars > high))
    if layout.scene.periodic.x is None and 2 * off > bars.size:
        name = layout.scene.surfaces[theirs].name
        return (
            f'{off} of them are off its ends, at x = {low:.3g} and {high:.3g}; a longer "{name}", '
            "a shorter way or periodic.x keep them over it"
        )
    return "springs between bars, a smaller load or stronger contact hold them"


def passed_through(layout: Layout, samples: Samples) -> np.ndarray:
    """Whether most bars of a surface have passed another one, (times,)."""
    passed = np.zeros(samples.t.size, dtype=bool)
    for mine, theirs in facing(layout):
        passed |= np.mean(_beyond(layout, samples, mine, theirs), axis=1) > MOST_PASSED
    return passed


@once_per_layout
def facing(layout: Layout) -> list[tuple[int, int]]:
    """Surfaces in contact that face each other, in both orders; at least one carries a load."""
    scene = layout.scene
    pairs = {pair for interaction in scene.interactions for pair in scene.pairs(interaction)}
    found = []
    for one, other in sorted(pairs):
        surfaces = scene.surfaces[one], scene.surfaces[other]
        facing = {surface.facing for surface in surfaces}
        # Members of an ensemble may have other loads; each that passes is run alone, by its own.
        differ = layout.numbers is not None
        pressed = (s.drive.presses or (differ and s.drive.load is not None) for s in surfaces)
        if len(facing) == 2 and any(pressed):
            found += [(one, other), (other, one)]
    return found


def _beyond(layout: Layout, samples: Samples, mine: int, theirs: int) -> np.ndarray:
    """Whether bars are beyond all bobs of another surface, but not at the start.

    (times, asperites).  Beyond is below for a surface that faces down, and above for the other.
    """
    down = layout.scene.surfaces[mine].facing_sign
    bars = down * _places(layout, samples, mine, "bar")
    bobs = down * _places(layout, samples, theirs, "bob")
    with np.errstate(invalid="ignore"):  # values that are not finite are beyond nothing
        beyond = bars < np.min(bobs, axis=1, keepdims=True)
    return beyond & ~np.asarray(samples.at_start(beyond), dtype=bool)


def _places(layout: Layout, samples: Samples, index: int, point: str, axis: int = 1) -> np.ndarray:
    """x (axis 0) or y of the bars or of the bobs of a surface, (times, asperites)."""
    moved = motions(layout, samples, index)
    return np.concatenate([getattr(motion, point)[axis] for motion in moved], axis=1)
