"""The contacts of a scene at given positions of its bobs, through the kernels that runs use."""

from dataclasses import replace

import numpy as np

from tribo.compiler.lanes_memory import with_spare_lanes
from tribo.kernels.probe import contact_probe
from tribo.kernels.records import CHARGE
from tribo.layout.layout import lay_out
from tribo.ledger.separation import nearest_images
from tribo.model.scene import Scene
from tribo.threads.writable_memory import Probe


class ContactProbe:
    """Contact energies and forces of a scene, also of ASE's calculators, at given places of bobs.

    Bobs are numbered surface after surface, as in ``layout.parts``.
    """

    def __init__(self, scene: Scene) -> None:
        self.layout = lay_out(scene)
        tables = self.layout.model
        own = tables._replace(each=with_spare_lanes(tables.each))  # which the kernel writes
        self._probe = Probe(replace(self.layout, model=own), contact_probe)
        self.charges = self.layout.model.each[CHARGE, self.layout.places.columns]  # (n,)
        self.depths = self.layout.depths  # (n,) z of the bobs, from the first bob [length]

    def positions(self, bobs: np.ndarray) -> np.ndarray:
        """(k, n, 3) positions of bobs at x and y as in a result, (k, n, 2), and at their depths."""
        depths = np.broadcast_to(self.depths[:, None], (*bobs.shape[:2], 1))
        return np.concatenate([bobs - self.layout.origin, depths], axis=2)

    def __call__(
        self, positions: np.ndarray, charges: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Energies (k,) and contact forces f1 on the bobs (k, n, 2) of k arrangements.

        `positions` is (k, n, 3), `charges` (k, n), by default the bobs' own; contact within a
        surface is left out.  Raises InputError if a potential does not compile, or a calculator
        fails.
        """
        if charges is None:
            charges = np.tile(self.charges, (len(positions), 1))
        energies = np.empty(len(positions))
        forces = np.empty((*positions.shape[:2], 2))
        columns = self.layout.places.columns
        self._probe(len(positions), columns, positions, charges, energies, forces)
        return energies, forces

    def distances(self, positions: np.ndarray, bob: int) -> np.ndarray:
        """(n,) distances from one bob to the nearest image of every bob at `positions` (n, 3)."""
        return np.linalg.norm(nearest_images(self.layout, positions - positions[bob]), axis=1)
