"""Forced drives that pump heat out of a surface.

With f2 = -f1 the work of contact at the bobs, about the centres of mass, is the part lambda = m2 /
(m1 + m2) of the energy A that an asperite receives, and the drive's work is the rest of it:

    work of the drives = sum of A + change of U
    friction times distance = sum of lambda A + change of U

Where every A is positive the first is at most the second over the smallest lambda, apart from U.
At a temperature, with unlike lambda, A may be negative on average, without bound: the drives then
heat one surface with energy of the reservoir of another.
"""

from __future__ import annotations

import numpy as np

from tribo.layout.layout import Layout
from tribo.ledger.accounts import Account, Integrals
from tribo.ledger.samples import Samples
from tribo.model.drives import DrivenBars, Forced
from tribo.model.surface import Surface
from tribo.results.intervals import student

# Blocks of equal length whose rates give the interval: with fewer, Student's interval is wide.
BLOCKS = 10
# Relative difference up to which values of lambda are alike: round-off of their masses.
ALIKE = 1e-9


def pumping_notes(layout: Layout, samples: Samples) -> tuple[str, ...]:
    """A note where drives do more work than surfaces that all receive heat could take up."""
    scene = layout.scene
    parts = np.concatenate([_lever(surface) for surface in scene.surfaces])
    held = all(isinstance(surface.drive, Forced | DrivenBars) for surface in scene.surfaces)
    alike = np.ptp(parts) <= ALIKE * np.max(parts)
    warm = any(map(_is_warm, scene.surfaces))
    later = samples.t >= max(scene.output.run_in, samples.t[0])
    if alike or not (held and warm) or layout.model.ledger is None:
        return ()
    if np.count_nonzero(later) <= 2 * BLOCKS:
        return ()
    t, (work, friction) = samples.t[later], (each[later] for each in _works(layout, samples))
    smallest = float(np.min(parts))
    edges = np.linspace(t[0], t[-1], BLOCKS + 1)
    excess = np.diff(np.interp(edges, t, work - friction / smallest))
    half_width = student(BLOCKS - 1) * np.std(excess, ddof=1) / np.sqrt(BLOCKS)
    if not np.mean(excess) > half_width:
        return ()
    return (
        f"the drives do {work[-1] - work[0]:.4g} of work, which exceeds friction times distance, "
        f"{friction[-1] - friction[0]:.4g}, over the smallest m2 / (m1 + m2), {smallest:.3g}, by "
        f"{np.sum(excess):.4g} +- {BLOCKS * half_width:.2g}: at a temperature, forced drives pump "
        "heat out of a surface where m2 / (m1 + m2) differs between asperites; "
        'drive = "bars" does not',
    )


def _works(layout: Layout, samples: Samples) -> tuple[np.ndarray, np.ndarray]:
    """The work of all drives, and friction times distance, minus the sum of V . J1; (times,)."""
    work, friction = np.zeros(samples.t.size), np.zeros(samples.t.size)
    integrals = Integrals(samples.s)
    for span in (span for spans in layout.accounted_spans for span in spans):
        accounts = integrals.of(span)
        work += np.sum(accounts.whole(Account.work(accounts["w2"], span.velocity)), axis=1)
        along = accounts.whole(Account.boost(accounts["w1"], span.velocity))
        friction -= np.sum(along, axis=1)
    return work, friction


def _lever(surface: Surface) -> np.ndarray:
    """The part of its energy that an asperite receives at the bob; all of it on driven bars."""
    each = surface.each
    if isinstance(surface.drive, DrivenBars):
        return np.ones(surface.count)
    return np.asarray(each["m2"] / (each["m1"] + each["m2"]))


def _is_warm(surface: Surface) -> bool:
    """Whether a reservoir, a bath or a start of a surface has a temperature."""
    own = (surface.bath.temperature, surface.initial.temperature)
    return any((*own, *(each.temperature for each in surface.reservoirs)))
