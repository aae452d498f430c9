"""Which surfaces can have inactive asperites, as the kernels read it."""

from __future__ import annotations

import numpy as np

from tribo.compiler.lanes import LANES
from tribo.kernels.records import Active, Model
from tribo.layout.contacts import nowhere
from tribo.model.drives import DrivenBars, Forced
from tribo.model.scene import Scene

# How much farther than the list of neighbours the active blocks reach, in units of its skin: more
# active blocks cost more in each step, a shorter margin has them selected more often.
MARGIN = 10.0


def active_blocks(scene: Scene, model: Model, skin: float) -> Active | None:
    """All blocks, before the first selection; None where no asperite can be inactive.

    `skin` is how much farther than the cutoff the list of neighbours reaches [length].
    """
    contacts = (*model.contacts, *(model.within or ()))
    unlisted = {int(k) for each in contacts for k in each.pairs[each.rows < 0].ravel()}
    eligible = [
        _is_eligible(scene, k) and k not in unlisted and not model.surfaces[k].turning
        for k in range(len(scene.surfaces))
    ]
    if model.calculators is not None or not any(eligible):
        return None
    count, surfaces = model.each.shape[1], model.surfaces
    return Active(
        blocks=np.arange(count // LANES),
        first=np.append(surfaces.start, surfaces.stop[-1:]) // LANES,
        since=np.full(count // LANES, np.nan),
        eligible=np.array(eligible, np.int64),
        place=nowhere(count),
        selected=np.full(1, np.nan),
        margin=MARGIN * skin,
    )


def _is_eligible(scene: Scene, index: int) -> bool:
    """Whether nothing but contact acts on a surface's asperites, and its bars move uniformly."""
    surface = scene.surfaces[index]
    uniform = isinstance(surface.drive, (DrivenBars, Forced)) and surface.drive.load is None
    acted_on = scene.has_uncancelled_forces(surface) or surface.swing_reservoir is not None
    return uniform and not acted_on and surface.bath.inertias.size == 0
