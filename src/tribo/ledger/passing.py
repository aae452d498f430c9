"""Surfaces that pass through each other: bars of one are beyond all bobs of the other.

Bobs may change their order in y without that: rods pass beside each other, and pendulums turn over.
A bar that is lower than every bob of a surface below it has passed the rods there too.  Only bars
that move along y can: those with a load, a drive of the user's own, or uncancelled forces.
"""

from __future__ import annotations

import numpy as np

from tribo.layout.layout import Layout
from tribo.ledger.motion import Motion
from tribo.ledger.samples import Samples

# Part of the bars of a surface that must pass for the surface to count as passed.
MOST = 0.5


def passing_notes(layout: Layout, samples: Samples) -> tuple[str, ...]:
    """A note on bars that have passed another surface by the last sample."""
    last, names = samples.ends(), [surface.name for surface in layout.scene.surfaces]
    notes = []
    for mine, theirs in _facing(layout):
        beyond = _beyond(layout, last, mine, theirs)[-1]
        if np.any(beyond):
            notes.append(
                f'{np.count_nonzero(beyond)} of {beyond.size} bars of "{names[mine]}" passed '
                f'through "{names[theirs]}" by t = {last.t[-1]:.6g}; springs between bars, a '
                "smaller load or stronger contact hold them"
            )
    return tuple(notes)


def passed_through(layout: Layout, samples: Samples) -> np.ndarray:
    """Whether most bars of a surface have passed another one, (times,)."""
    passed = np.zeros(samples.t.size, dtype=bool)
    for mine, theirs in _facing(layout):
        passed |= np.mean(_beyond(layout, samples, mine, theirs), axis=1) > MOST
    return passed


def _facing(layout: Layout) -> list[tuple[int, int]]:
    """Surfaces in contact that face each other, in both orders; at least one can move along y."""
    scene = layout.scene
    pairs = {pair for interaction in scene.interactions for pair in scene.pairs(interaction)}
    found = []
    for one, other in sorted(pairs):
        surfaces = scene.surfaces[one], scene.surfaces[other]
        facing = {surface.facing for surface in surfaces}
        if len(facing) == 2 and any(map(scene.slides_along_y, surfaces)):
            found += [(one, other), (other, one)]
    return found


def _beyond(layout: Layout, samples: Samples, mine: int, theirs: int) -> np.ndarray:
    """Whether bars of one surface are beyond all bobs of the other, but not at the start.

    (times, asperites).  Beyond is below for a surface that faces down, and above for the other.
    """
    down = layout.scene.surfaces[mine].facing_sign
    bars = down * _heights(layout, samples, mine, "bar")
    bobs = down * _heights(layout, samples, theirs, "bob")
    with np.errstate(invalid="ignore"):  # values that are not finite are beyond nothing
        beyond = bars < np.min(bobs, axis=1, keepdims=True)
    return beyond & ~np.asarray(samples.at_start(beyond), dtype=bool)


def _heights(layout: Layout, samples: Samples, index: int, point: str) -> np.ndarray:
    """y of the bars or of the bobs of a surface, (times, asperites)."""
    moved = (Motion(layout.view, span, samples) for span in layout.view.spans[index])
    return np.concatenate([getattr(motion, point)[1] for motion in moved], axis=1)
