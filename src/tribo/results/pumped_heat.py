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
from tribo.ledger.watched import Watched, levers
from tribo.results.intervals import interval

# Blocks of equal length whose rates give the interval: with fewer, Student's interval is wide.
BLOCKS = 10


def pumping_notes(layout: Layout, watched: Watched) -> tuple[str, ...]:
    """A note where drives do more work than surfaces that all receive heat could take up."""
    scene, t = layout.scene, watched.t
    later = t >= scene.output.run_in
    if np.count_nonzero(later) <= 2 * BLOCKS:
        return ()
    t, (work, friction) = t[later], watched.works[later].T
    smallest = float(np.min(levers(scene)))
    edges = np.linspace(t[0], t[-1], BLOCKS + 1)
    excess = np.diff(np.interp(edges, t, work - friction / smallest))
    mean, half_width = interval(excess)
    if not mean > half_width:
        return ()
    return (
        f"the drives do {work[-1] - work[0]:.4g} of work, which exceeds friction times distance, "
        f"{friction[-1] - friction[0]:.4g}, over the smallest m2 / (m1 + m2), {smallest:.3g}, by "
        f"{np.sum(excess):.4g} +- {BLOCKS * half_width:.2g}: at a temperature, forced drives pump "
        "heat out of a surface where m2 / (m1 + m2) differs between asperites; "
        'drive = "bars" does not',
    )
