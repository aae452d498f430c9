"""Forces and energies of elastic bodies, as the kernels need them.

Those of few bars have a table of all pairs, and those of many Fourier transforms, which compiled
loops call.
"""

import ctypes
from typing import Any

import numpy as np

from tribo.compiler.lanes import LANES
from tribo.compiler.lanes_memory import with_spare_lanes
from tribo.model.elastic import grid_of
from tribo.model.scene import Scene
from tribo.model.surface import Surface

# Most bars of a surface whose forces are sums over all pairs: a step of so many bars takes 0.05 ms
# with sums, and 0.2 ms with transforms.
MOST_OF_PAIRS = 256


def sums_over_pairs(surface: Surface) -> bool:
    """Whether the bars on an elastic body are so few that forces are sums over all pairs."""
    return surface.count <= MOST_OF_PAIRS


def stiffnesses(scene: Scene) -> dict[int, tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Index of each elastic surface -> its K_xx, K_yy, K_xy / i in Fourier space, (nz, nx)."""
    found = {}
    for k, surface in enumerate(scene.surfaces):
        if surface.elastic is not None:
            counts, spacing = grid_of(surface, scene.periodic)
            found[k] = surface.elastic.stiffness(counts, spacing, surface.facing_sign)
    return found


def pairs_of(scene: Scene, surfaces: Any, columns: dict[int, np.ndarray]) -> np.ndarray:
    """K between all bars of each elastic surface that has few, (rows, 4 LANES), after a row of 0.

    A block of bars has a row for each bar of its surface: K_xx, K_xy, K_yx, K_yy between that bar
    and those of the block.  `columns` (n,) are those of each surface's bars, and the record of each
    of these surfaces gets its first row.
    """
    tables = [np.zeros((1, 4 * LANES))]
    row = 1
    for k, (xx, yy, xy) in stiffnesses(scene).items():
        record = surfaces[k]
        count = record["end"] - record["start"]
        if not sums_over_pairs(scene.surfaces[k]):
            continue
        bars = np.argsort(columns[k])  # in the order of the columns
        z, x = np.unravel_index(bars, xx.shape)
        apart = (z[:, None] - z) % xx.shape[0], (x[:, None] - x) % xx.shape[1]
        blocks = (record["stop"] - record["start"]) // LANES
        pairs = np.zeros((4, blocks * LANES, count))
        for n, wave in enumerate((xx, 1j * xy, -1j * xy, yy)):
            pairs[n, :count] = np.fft.ifft2(wave).real[apart]
        pairs = pairs.reshape(4, blocks, LANES, count).transpose(1, 3, 0, 2)
        tables.append(pairs.reshape(-1, 4 * LANES))
        record["elastic_row"] = row
        row += blocks * count
    return with_spare_lanes(np.concatenate(tables))


class ElasticBodies:
    """The elastic surfaces of many bars in one loop, as compiled code calls them.

    Forces are added to the internal ones on the bars, and the mean displacement of the bars goes
    into the surface's record.
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
        self._stiffnesses = {
            k: [each[:, : each.shape[1] // 2 + 1] for each in waves]  # of real displacements
            for k, waves in stiffnesses(scene).items()
            if not sums_over_pairs(scene.surfaces[k])
        }
        self._shapes = {k: scene.surfaces[k].shape[::-1] for k in self._stiffnesses}
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
        u = np.take(self._displaced, self._columns[k], axis=1).reshape(2, *self._shapes[k])
        xx, yy, xy = self._stiffnesses[k]
        x, y = self._fft.rfft2(u)
        wave = np.empty((2, *xx.shape), complex)
        wave[0] = xx * x + 1j * xy * y
        wave[1] = yy * y - 1j * xy * x
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
            self._surfaces[k]["ax"], self._surfaces[k]["ay"] = u.mean(axis=(1, 2))
        for k, force in forces.items():  # after all that an interrupt may repeat
            self._internal[:, self._columns[k]] -= force.reshape(2, -1)

    def _compute_energies(self) -> None:
        for k in self._stiffnesses:
            u, force = self.stretched(k)
            self._energy[k] = 0.5 * float(np.sum(u * force))
