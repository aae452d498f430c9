"""An estimate of the steps that encounters take, made before a run.

Bobs slide with the initial velocity of their surface and the swing they start with.  A step goes at
most a fraction of the way to the nearest bob, so the steps are about the integral of
speed / clearance over time.
"""

import numpy as np

from tribo.accuracy.levels import NEAR
from tribo.kernels.kinematics import bob_position, nearest_image
from tribo.kernels.records import Box
from tribo.layout.layout import Layout
from tribo.ledger.motion import swing_direction

# Most times at which clearances are computed.
MOST_TIMES = 129
# Most distances computed for two surfaces: they take a quarter of a second.
MOST_DISTANCES = 2e7
# Distances that are computed at once: their arrays stay in the cache of a core.
DISTANCES_AT_ONCE = 1e5
# Bobs of the first of two surfaces whose clearances are computed.
FOLLOWED = 8


def steps_towards(layout: Layout) -> float:
    """The fewest steps that jump no encounter, with bobs that slide and keep their initial swing.

    Of each surface at most FOLLOWED bobs are followed.
    """
    a = layout.asperites
    tx, ty = swing_direction(a.facing, layout.start[: a.size])
    place = np.array([*bob_position(a.x, a.y, a.l1, tx, ty), layout.depths])
    swinging = float(np.max(a.l1 * np.abs(layout.start[layout.coordinates :][: a.size])))
    rates = [0.0]
    for contact in layout.model.contacts:
        for one, other in contact.pairs:
            mine, theirs = (layout.surfaces[k] for k in (one, other))
            first = np.linspace(mine.start, mine.stop - 1, min(FOLLOWED, mine.stop - mine.start))
            followed = place[:, first.astype(int)]
            others = place[:, theirs.start : theirs.stop]
            drift = layout.velocities[one] - layout.velocities[other]
            count = MOST_DISTANCES / (followed.shape[1] * others.shape[1])
            times = np.linspace(0.0, layout.scene.duration, int(np.clip(count, 5, MOST_TIMES)))
            speed = float(np.hypot(*drift)) + 2.0 * swinging
            at_once = max(1, int(DISTANCES_AT_ONCE / (followed.shape[1] * others.shape[1])))
            near = [
                r
                for k in range(0, times.size, at_once)
                for r in _nearest(
                    followed, others, np.outer(drift, times[k : k + at_once]), layout.model.box
                )
            ]
            clear = np.array([contact.potential.clearance(r) for r in near])
            if np.max(clear) > 0.0:  # bobs that stay at one place have no run
                rates.append(float(np.mean(speed / np.maximum(clear, 1e-3 * np.max(clear)))))
    return max(rates) * layout.scene.duration / NEAR


def _nearest(
    some: np.ndarray, others: np.ndarray, shifts: np.ndarray, box: Box | None
) -> list[float]:
    """The smallest distances of bobs (3, n), shifted by each of (2, k), from bobs (3, m)."""
    dx = (some[0] + shifts[0, :, None])[:, :, None] - others[0]
    dy = (some[1] + shifts[1, :, None])[:, :, None] - others[1]
    dz = some[2][:, None] - others[2]
    if box is not None:
        dx, dz = nearest_image(dx, box.x), nearest_image(dz, box.z)
    found: list[float] = np.sqrt(np.min(dx * dx + dy * dy + dz * dz, axis=(1, 2))).tolist()
    return found
