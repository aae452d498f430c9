"""What notes need of all samples of a run: a streamed run collects it from its portions."""

from __future__ import annotations

from typing import NamedTuple, Self

import numpy as np

from tribo.layout.layout import Layout
from tribo.ledger.accounts import Account, Integrals
from tribo.ledger.samples import Samples
from tribo.ledger.separation import touching
from tribo.model.drives import DrivenBars, Forced
from tribo.model.scene import Scene

# Recorded times at which notes look for contact, at most.
MOST_LOOKS = 256
# Relative difference up to which values of m2 / (m1 + m2) are alike: round-off of their masses.
ALIKE = 1e-9


class Watched(NamedTuple):
    """What notes need of all samples."""

    looks: np.ndarray  # (looks,) times at which contact was looked for
    touching: np.ndarray  # (looks, pairs) as :func:`tribo.ledger.separation.touching` then
    t: np.ndarray  # (times,) of the works; none where forced drives cannot pump heat
    works: np.ndarray  # (times, 2) of all drives, and friction times distance

    @classmethod
    def of(cls, layout: Layout, samples: Samples, first: int = 0, every: int | None = None) -> Self:
        """That of the samples from the place `first` on, with looks at each `every`-th of them."""
        some = samples.rows(slice(first, None, every or look_interval(samples.t.size)))
        if not may_pump(layout):
            return cls(some.t.copy(), touching(layout, some), np.empty(0), np.empty((0, 2)))
        return cls(some.t.copy(), touching(layout, some), samples.t.copy(), _works(layout, samples))

    @classmethod
    def joined(cls, parts: list[Self]) -> Self:
        """That of portions one after another."""
        return cls(*map(np.concatenate, zip(*parts, strict=True)))


def look_interval(times: int) -> int:
    """The number of samples from one look for contact to the next."""
    return -(-times // MOST_LOOKS)


def levers(scene: Scene) -> np.ndarray:
    """The part of its energy that each asperite receives at the bob; all of it on driven bars."""
    each = ((s.each["m1"], s.each["m2"], s.drive) for s in scene.surfaces)
    return np.concatenate(
        [
            np.ones(m1.size) if isinstance(drive, DrivenBars) else m2 / (m1 + m2)
            for m1, m2, drive in each
        ]
    )


def may_pump(layout: Layout) -> bool:
    """Whether drives may pump heat: they are forced, at a temperature, and levers are unlike."""
    scene = layout.scene
    parts = levers(scene)
    held = all(isinstance(surface.drive, Forced | DrivenBars) for surface in scene.surfaces)
    alike = np.ptp(parts) <= ALIKE * np.max(parts)
    warm = any(
        any((s.bath.temperature, s.initial.temperature, *(r.temperature for r in s.reservoirs)))
        for s in scene.surfaces
    )
    return bool(held and not alike and warm and layout.model.ledger)


def _works(layout: Layout, samples: Samples) -> np.ndarray:
    """The work of all drives, and friction times distance, minus the sum of V . J1; (times, 2)."""
    work, friction = np.zeros(samples.t.size), np.zeros(samples.t.size)
    integrals = Integrals(samples.s)
    for span in (span for spans in layout.accounted_spans for span in spans):
        accounts = integrals.of(span)
        work += np.sum(accounts.whole(Account.work(accounts["w2"], span.velocity)), axis=1)
        along = accounts.whole(Account.boost(accounts["w1"], span.velocity))
        friction -= np.sum(along, axis=1)
    return np.column_stack([work, friction])
