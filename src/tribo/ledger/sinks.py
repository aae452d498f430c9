"""The ledger of a run that is too large to hold, portion by portion, and what notes need of it."""

import math
from dataclasses import replace
from itertools import chain
from typing import NamedTuple, Self

import numpy as np

from tribo.kernels.probe import TABLES
from tribo.kernels.status import Status
from tribo.layout.layout import Layout, once_per_layout
from tribo.ledger.accounts import Account, Integrals
from tribo.ledger.guards import first_lost, passed_through
from tribo.ledger.ledger import Ledger, assemble
from tribo.ledger.quantities import ASPERITE_QUANTITIES, OPTIONAL_QUANTITIES
from tribo.ledger.samples import Samples
from tribo.ledger.separation import any_within_reach, touching
from tribo.model.scene import Scene

# Recorded times at which notes look for contact, at most.
MOST_LOOKS = 256
# Relative difference up to which values of m2 / (m1 + m2) are alike: round-off of their masses.
ALIKE = 1e-9
# Bytes of all samples of a run. Above it, only the first and the last sample of each asperite are
# kept: a gigabyte fits into the memory of any computer of today.
SERIES_BYTES = 2**30
# Bytes of the samples of one portion: 1/8 of the above, so that a portion needs little memory
# beside the state of the run.
PORTION_BYTES = 2**27
# Begin the names of series, and of the arrays of `Watched`, in files.
SERIES = "series "
WATCHED = "watched "
# The name of the times among series.
TIMES = "t"


class Watched(NamedTuple):
    """What notes need of all samples."""

    looks: np.ndarray  # (looks,) times at which contact was looked for
    touching: np.ndarray  # (looks, pairs) as :func:`tribo.ledger.separation.touching` then
    t: np.ndarray  # (times,) of the works; none where forced drives cannot pump heat
    works: np.ndarray  # (times, 2) of all drives, and friction times distance

    @classmethod
    def of(cls, layout: Layout, samples: Samples, first: int = 0, every: int | None = None) -> Self:
        """That of the samples from the place `first` on, with looks at each `every`-th of them."""
        every = every or look_interval(samples.t.size)
        some = samples if (first, every) == (0, 1) else samples.rows(slice(first, None, every))
        if not may_pump(layout):
            return cls(some.t.copy(), touching(layout, some), np.empty(0), np.empty((0, 2)))
        return cls(some.t.copy(), touching(layout, some), samples.t.copy(), _works(layout, samples))


@once_per_layout
def is_watched(layout: Layout) -> bool:
    """Whether :class:`Watched` finds anything that notes tell of, in any run."""
    return any_within_reach(layout) or may_pump(layout)


def look_interval(times: int) -> int:
    """The number of samples from one look for contact to the next."""
    return -(-times // MOST_LOOKS)


def levers(scene: Scene) -> np.ndarray:
    """The part of its energy that each asperite receives at the bob; all of it on driven bars."""
    found = []
    for surface in scene.surfaces:
        m1 = surface.each["m1"]
        m2 = surface.each["m2"]
        found.append(np.ones(m1.size) if surface.drive.holds_bars else m2 / (m1 + m2))
    return np.concatenate(found)


@once_per_layout
def may_pump(layout: Layout) -> bool:
    """Whether drives may pump heat: they are forced, at a temperature, and levers are unlike."""
    scene = layout.scene
    parts = levers(scene)
    held = all(s.drive.cancels_x or s.drive.holds_bars for s in scene.surfaces)
    alike = np.ptp(parts) <= ALIKE * np.max(parts)
    temperatures = []
    for surface in scene.surfaces:
        temperatures += [surface.bath.temperature, surface.initial.temperature]
        temperatures += [reservoir.warmest for reservoir in surface.reservoirs]
    warm = any(temperatures)
    return bool(held and not alike and warm and layout.model.ledger)


def _works(layout: Layout, samples: Samples) -> np.ndarray:
    """The work of all drives, and friction times distance, minus the sum of V . J1; (times, 2)."""
    work = np.zeros(samples.t.size)
    friction = np.zeros(samples.t.size)
    integrals = Integrals(samples.s)
    for span in chain.from_iterable(layout.accounted_spans):
        accounts = integrals[span]
        work += np.sum(accounts.whole(Account.work(accounts["w2"], span.velocity)), axis=1)
        along = accounts.whole(Account.boost(accounts["w1"], span.velocity))
        friction -= np.sum(along, axis=1)
    return np.column_stack([work, friction])


class StreamedLedger:
    """The ledger of a run whose samples arrive in portions.

    It has the complete series that ``output.keep`` names; without it, those of the surfaces as
    wholes and of the system, while those of the asperites are left out.  It is `guarded` where the
    energy may run away, as with equal steps.
    """

    def __init__(self, layout: Layout, guarded: bool = False) -> None:
        self._layout = layout
        self._guarded = guarded and layout.model.ledger is not None
        self._known = 0.0  # see `first_lost`
        # Series by full names, their times, and what notes need, each with the name in a file.
        self._portions: list[dict[str, np.ndarray]] = []
        self._written = 0  # portions that `new_arrays` has returned

    def add(self, samples: Samples, earlier: int) -> tuple[int, Status] | None:
        """Take in a portion after `earlier` samples that were taken in before.

        These are the first of the run and the last two, which changes and means over an interval
        are relative to, and the first from the layout's beginning on, where the series begin.
        Returns the index of the first sample at which the energy has run away, or surfaces have
        passed through each other, if there is one, and its status; those after it are left out.
        """
        ledger = assemble(self._layout, samples)
        lost = None
        if self._guarded:
            lost, self._known = first_lost(self._layout, samples, ledger.system, self._known)
        ends = [] if lost is None else [(lost, Status.ENERGY_RUNAWAY)]
        passed = np.flatnonzero(passed_through(self._layout, samples))
        ends += [(int(k), Status.PASSED_THROUGH) for k in passed[:1]]
        end = min(ends, default=None)
        first = max(earlier, samples.index_from(self._layout.beginning))
        kept = slice(first, None if end is None else end[0] + 1)
        self._keep(samples.rows(kept), ledger.rows(kept))
        return end

    @property
    def watched(self) -> Watched:
        return Watched(**_joined(self._portions, WATCHED))

    def _keep(self, samples: Samples, ledger: Ledger) -> None:
        """Keep what notes need of new samples, and the series that the scene asks for."""
        done = sum(portion[SERIES + TIMES].size for portion in self._portions)
        every = look_interval(self._layout.times.size)
        keep = self._layout.scene.output.keep
        watched = Watched.of(self._layout, samples, -done % every, every)
        some = Ledger(ledger.t, {}, ledger.blocks, ledger.system)
        series = {TIMES: ledger.t} | (some if keep is None else ledger.only(keep)).flat()
        # Copies: the loop writes the next portion into the same arrays.
        portion = {SERIES + name: np.array(values) for name, values in series.items()}
        self._portions.append(portion | {WATCHED + k: v for k, v in watched._asdict().items()})

    def new_arrays(self) -> dict[str, np.ndarray]:
        """The portions since the last call, and what the next one needs, as arrays for a file."""
        new = self._portions[self._written :]
        self._written = len(self._portions)
        return _joined(new) | {"known": np.array(self._known)}

    def take_back(self, arrays: dict[str, np.ndarray]) -> None:
        """Take in portions from the arrays of a file."""
        names = [name for name in arrays if name.startswith((SERIES, WATCHED))]
        self._portions.append({name: arrays[name] for name in names})
        self._written = len(self._portions)
        self._known = float(arrays["known"])

    def whole(self, samples: Samples) -> Ledger:
        """All series; those of asperites that are left out are at the ends of `samples`."""
        layout = self._layout
        series = _joined(self._portions, SERIES)
        kept = tuple(layout.scene.output.keep or ())
        found = Ledger.of_flat(series.pop(TIMES), series, layout.parts, kept)
        if kept:
            return found
        begun = samples.index_from(layout.beginning)
        ends = assemble(layout, samples).rows(np.unique([begun, samples.t.size - 1]))
        return replace(found, surfaces=ends.surfaces, oscillators=ends.oscillators)


def is_streamed(layout: Layout, times: int) -> bool:
    """Whether a run with a given step does not hold so many samples of all asperites."""
    if layout.scene.output.keep is None:
        return exceeds_memory(layout, times)
    return times * _sample_bytes(layout) > PORTION_BYTES


def exceeds_memory(layout: Layout, times: int) -> bool:
    """Whether so many samples of all asperites are too many to hold."""
    return times * _sample_bytes(layout) > SERIES_BYTES


def portion_size(layout: Layout) -> int:
    return max(1, PORTION_BYTES // _sample_bytes(layout))


def _joined(portions: list[dict[str, np.ndarray]], of: str = "") -> dict[str, np.ndarray]:
    """Portions one after another, of what has names that begin with `of`, without that."""
    names = [name for name in portions[0] if name.startswith(of)]
    return {k.removeprefix(of): np.concatenate([each[k] for each in portions]) for k in names}


def _sample_bytes(layout: Layout) -> int:
    """Bytes of one sample, raw and as the ledger."""
    reported = len(ASPERITE_QUANTITIES) + len(OPTIONAL_QUANTITIES)
    raw = 2 * layout.core + layout.accounts + math.prod(layout.sampled_baths)
    if "forces" in layout.scene.output.series:
        raw += 2 * TABLES * layout.model.each.shape[1]
    return 8 * (raw + 2 * reported * layout.scene.count)
