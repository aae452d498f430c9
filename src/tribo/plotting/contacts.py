"""Contact forces on bobs at one time, and the arrows that show them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tribo.analysis.contact_probe import ContactProbe
from tribo.model.scene import Scene
from tribo.plotting.marks import arrow, note
from tribo.plotting.picture import BOB
from tribo.plotting.pose import Pose

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Contacts:
    """Contact forces and distances of bobs at places (n, 2), as the kernels of runs compute them.

    Raises InputError if a calculator of the scene fails.
    """

    def __init__(self, scene: Scene, bobs: np.ndarray) -> None:
        self._probe = ContactProbe(scene)
        self._parts = self._probe.layout.parts
        self._positions = self._probe.positions(bobs[None])
        _, (self._forces,) = self._probe(self._positions)

    def force(self, surface: str, asperite: int) -> np.ndarray:
        """(2,) force f1 on a bob from the bobs of other surfaces."""
        return np.asarray(self._forces[self._parts[surface]][asperite])

    def nearest(self, surface: str, asperite: int) -> tuple[str, int, float] | None:
        """The nearest bob of another surface, as surface and asperite, and its distance [length].

        None if there is no other surface.
        """
        own = self._parts[surface]
        distances = self._probe.distances(self._positions[0], own.start + asperite)
        distances[own] = np.inf
        nearest = int(np.argmin(distances))
        for name, part in self._parts.items():
            if name != surface and part.start <= nearest < part.stop:
                return name, nearest - part.start, float(distances[nearest])
        return None


def force_arrows(ax: Axes, scene: Scene, now: Pose, drawn: Pose, surface: str, k: int) -> None:
    """Arrows of the contact forces on asperite `k` of a surface and on its nearest neighbour.

    They start at the bobs of `drawn`, which may be `now` elsewhere.  Where no force acts, or there
    is no other surface, there is none.
    """
    contacts = Contacts(scene, now.bobs - now.aside)
    nearest = contacts.nearest(surface, k)
    if nearest is None:
        return
    for name, asperite in ((surface, k), nearest[:2]):
        force = contacts.force(name, asperite)
        i = drawn.index(name, asperite)
        if not (np.any(force) and np.all(np.isfinite(force))):
            continue
        direction = force / np.hypot(*force)
        length = drawn.rods[i]
        bob = drawn.bobs[i]
        # Two forces that point at each other do not touch.
        reach = min(0.55 * length, max(0.43 * nearest[2], 2.0 * BOB * length))
        start = bob + BOB * length * direction
        tip = bob + reach * direction
        arrow(ax, start, tip)
        aside = np.array([-direction[1], direction[0]])
        aside *= 10.0 * np.copysign(1.0, aside[1] * drawn.up[i])
        letter = "f" if drawn.up[i] > 0.0 else "F"
        note(ax, 0.5 * (start + tip), rf"$\vec{{{letter}}}_1$", (float(aside[0]), float(aside[1])))
