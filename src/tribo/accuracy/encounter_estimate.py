"""Encounters ahead, before anything is run: of bobs that slide as they begin, and do not swing."""

from __future__ import annotations

from typing import Any

import numpy as np

from tribo.accuracy.search import NEAR
from tribo.run.layout import Layout

LOOKS = 129  # at most, at the bobs on their way
PAIR_LOOKS = 2e7  # at most, for each two surfaces
FOLLOWED = 8  # bobs of a surface that are followed


def steps_towards(layout: Layout) -> float:
    """How many steps there are at least that none jumps an encounter, bobs sliding as they begin.

    Of surfaces of many, some bobs are followed.
    """
    a = layout.model.asperites
    swing = a.facing * np.sin(layout.start[: a.size])
    upright = a.facing * np.cos(layout.start[: a.size])
    place = np.array([a.x + a.l1 * swing, a.y - a.l1 * upright, layout.model.bobs.z])
    swinging = float(np.max(a.l1 * np.abs(layout.start[layout.coordinates :][: a.size])))
    rates = [0.0]
    for contact in layout.model.contacts:
        for one, other in contact.pairs:
            mine, theirs = (layout.model.surfaces[k] for k in (one, other))
            first = np.linspace(mine.start, mine.stop - 1, min(FOLLOWED, mine.stop - mine.start))
            followed = place[:, first.astype(int)]
            others = place[:, theirs.start : theirs.stop]
            drift = layout.velocity[mine.start] - layout.velocity[theirs.start]
            looks = int(np.clip(PAIR_LOOKS / (followed.shape[1] * others.shape[1]), 5, LOOKS))
            speed = float(np.hypot(*drift)) + 2.0 * swinging
            times = np.linspace(0.0, layout.scene.duration, looks)
            near = [_nearest(followed, others, drift * t, layout.model.box) for t in times]
            clear = np.array([contact.potential.clearance(r) for r in near])
            if np.max(clear) > 0.0:  # bobs that stay at one place have no run
                rates.append(float(np.mean(speed / np.maximum(clear, 1e-3 * np.max(clear)))))
    return max(rates) * layout.scene.duration / NEAR


def _nearest(some: np.ndarray, others: np.ndarray, shift: np.ndarray, box: Any) -> float:
    """The smallest distance of two bobs, (3, n) and (3, m), the first of which are shifted."""
    dx = (some[0] + shift[0])[:, None] - others[0]
    dy = (some[1] + shift[1])[:, None] - others[1]
    dz = some[2][:, None] - others[2]
    if box is not None:
        dx = dx - box.x * np.round(dx / box.x) if box.x > 0.0 else dx
        dz = dz - box.z * np.round(dz / box.z) if box.z > 0.0 else dz
    return float(np.sqrt(np.min(dx * dx + dy * dy + dz * dz)))
