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

    Bobs are numbered surface after surface.  Calculators of ASE are called too.

    Parameters
    ----------
    scene : Scene
        Its interactions, species and periods apply; nothing in it moves.

    Attributes
    ----------
    layout : Layout
        The scene as the kernels see it; ``layout.parts`` has the bobs of each surface.
    """

    def __init__(self, scene: Scene) -> None:
        self.layout = lay_out(scene)
        model, self._calls = own_model(self.layout)
        self._model = model._replace(each=with_spare_lanes(model.each))
        self._stamp = sources.source_stamp(self.layout.plugins)

    @property
    def charges(self) -> np.ndarray:
        """(n,) charges of the bobs in the scene."""
        return self.layout.model.each[CHARGE, self.layout.places.columns]

    @property
    def depths(self) -> np.ndarray:
        """(n,) z of the bobs in the scene, from the first bob [length]."""
        return self.layout.depths

    def __call__(self, positions: np.ndarray, charges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Evaluate every contact between surfaces.

        Parameters
        ----------
        positions : ndarray, (k, n, 3)
            Bobs of k arrangements [length].
        charges : ndarray, (k, n)
            Charges of the bobs.

        Returns
        -------
        energies : ndarray, (k,)
            Contact energy of each arrangement.
        forces : ndarray, (k, n, 2)
            Force f1 on each bob; contact within a surface is not in it.

        Raises
        ------
        InputError
            If a potential does not compile, or a calculator fails.
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
