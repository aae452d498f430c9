"""The contacts of a scene at given positions of its bobs, through the kernels that runs use."""

from __future__ import annotations

import numpy as np

from tribo.compiler.jit import time_loop
from tribo.compiler.lanes_memory import with_spare_lanes
from tribo.kernels.probe import contact_probe, distance_probe
from tribo.kernels.records import CHARGE
from tribo.layout.contacts import raise_calculator_errors, with_room
from tribo.layout.layout import lay_out
from tribo.layout.loop_memory import own_model
from tribo.model.scene import Scene
from tribo.plugins import sources
from tribo.plugins.compile_errors import compiling


class ContactProbe:
    """Contact energies and forces of a scene whose bobs are placed by the caller.

    Bobs are numbered surface after surface, as in ``layout.parts``.  Calculators of ASE are called
    too.
    """

    def __init__(self, scene: Scene) -> None:
        self.layout = lay_out(scene)
        model, self._calls = own_model(self.layout)
        self._model = model._replace(each=with_spare_lanes(model.each))
        self.charges = self.layout.model.each[CHARGE, self.layout.places.columns]  # (n,)
        self.depths = self.layout.depths  # (n,) z of the bobs, from the first bob [length]
        self._stamp = sources.source_stamp(self.layout.plugins)

    def __call__(self, positions: np.ndarray, charges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Energies (k,) and contact forces f1 on the bobs (k, n, 2) of k arrangements.

        `positions` is (k, n, 3), `charges` (k, n); contact within a surface is left out.  Raises
        InputError if a potential does not compile, or a calculator fails.
        """
        energies, forces = np.empty(len(positions)), np.empty((*positions.shape[:2], 2))
        probe = time_loop(contact_probe, self._stamp)
        neighbours, done = self.layout.neighbours(), 0
        with compiling(probe, self.layout.named_plugins):
            while done < len(positions):
                neighbours = with_room(neighbours)
                arrays = self.layout.places.columns, positions, charges
                done = probe(self._model, neighbours, *arrays, done, energies, forces)
        raise_calculator_errors(self._calls)
        return energies, forces

    def distances(self, positions: np.ndarray, bob: int) -> np.ndarray:
        """(n,) distances from one bob to the nearest image of every bob at `positions` (n, 3)."""
        distances = np.empty(len(positions))
        probe = time_loop(distance_probe, self._stamp)
        probe(self._model, positions, bob, distances)
        return distances
