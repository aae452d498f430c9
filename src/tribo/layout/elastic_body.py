"""Forces and energies of elastic bodies, by Fourier transforms that compiled loops call."""

import ctypes
from typing import Any

import numpy as np

from tribo.model.elastic import grid_of
from tribo.model.scene import Scene


def stiffnesses(scene: Scene) -> dict[int, tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Index of each elastic surface -> its K, halves of the Fourier space of real displacements."""
    found = {}
    for k, surface in enumerate(scene.surfaces):
        if surface.elastic is not None:
            counts, spacing = grid_of(surface, scene.periodic)
            whole = surface.elastic.stiffness(counts, spacing, surface.facing_sign)
            half = counts[0] // 2 + 1
            xx, yy, xy = (each[:, :half] for each in whole)
            found[k] = xx, yy, xy
    return found


class ElasticBodies:
    """The elastic surfaces of one loop, as compiled code calls them.

    Forces are added to the internal ones on the bars; where a surface is a block, the mean
    displacement of its bars goes into its record.
    """

    def __init__(
        self,
        scene: Scene,
        surfaces: Any,
        columns: dict[int, np.ndarray],
        displaced: np.ndarray,
        internal: np.ndarray,
        energy: np.ndarray,
    ) -> None:
        """Take the arrays of a loop: `columns` (n,) of the bars of each elastic surface."""
        from scipy import fft  # which only these scenes need

        self._fft = fft
        self.error: Exception | None = None
        self.interrupted = False
        self._stiffnesses = stiffnesses(scene)
        self._shapes = {k: scene.surfaces[k].shape[::-1] for k in self._stiffnesses}
        self._blocks = [k for k in self._stiffnesses if scene.surfaces[k].drive.block]
        self._surfaces = surfaces
        self._columns = columns
        self._displaced = displaced
        self._internal = internal
        self._energy = energy
        called = ctypes.CFUNCTYPE(None)
        self._functions = called(self._add_forces), called(self._set_energies)
        self.addresses = np.array(
            [ctypes.cast(each, ctypes.c_void_p).value or 0 for each in self._functions]
        )

    @property
    def failure(self) -> str:
        """The error that was raised, in words."""
        return f"{type(self.error).__name__}: {self.error}"

    def stretched(self, k: int) -> tuple[np.ndarray, np.ndarray]:
        """Displacements u of the bars of surface k, and K u, each (2, nz, nx)."""
        u = self._displaced[:, self._columns[k]].reshape(2, *self._shapes[k])
        xx, yy, xy = self._stiffnesses[k]
        x, y = self._fft.rfft2(u)
        wave = np.array([xx * x + 1j * xy * y, yy * y - 1j * xy * x])
        return u, self._fft.irfft2(wave, s=self._shapes[k])

    def _add_forces(self) -> None:
        self._guarded(self._compute_forces)

    def _set_energies(self) -> None:
        self._guarded(self._compute_energies)

    def _guarded(self, compute: Any) -> None:
        """Compute; an exception is kept, since compiled code cannot raise it."""
        try:
            try:
                compute()
            except KeyboardInterrupt:  # finish the step, so that the run's state stays consistent
                self.interrupted = True
                compute()
        except Exception as error:
            self.error = error
            self._internal[:] = np.nan

    def _compute_forces(self) -> None:
        forces = {}
        for k in self._stiffnesses:
            u, forces[k] = self.stretched(k)
            if k in self._blocks:
                self._surfaces[k]["ax"], self._surfaces[k]["ay"] = u.mean(axis=(1, 2))
        for k, force in forces.items():  # after all that an interrupt may repeat
            self._internal[:, self._columns[k]] -= force.reshape(2, -1)

    def _compute_energies(self) -> None:
        for k in self._stiffnesses:
            u, force = self.stretched(k)
            self._energy[k] = 0.5 * float(np.sum(u * force))
