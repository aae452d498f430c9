"""Forces and energies of elastic bodies, as the kernels need them.

Those of few bars have a table of all pairs, and those of many Fourier transforms, which compiled
loops call.
"""

import ctypes
from collections.abc import Callable
from typing import Any

import numpy as np

from tribo.compiler.lanes import LANES
from tribo.compiler.lanes_memory import room, with_spare_lanes
from tribo.kernels import records
from tribo.kernels.model import Elastic
from tribo.model.elastic import MOST_OF_PAIRS, grid_of, has_free_edges
from tribo.model.free_edges import Grid, relaxed
from tribo.model.scene import Scene
from tribo.model.surface import Surface

NO_BODIES = Elastic(
    pairs=room((1, 0)),
    shares=room((4, 0)),
    columns=np.zeros(0, np.int64),
    grid=room((2, 0)),
    waves=room((2, 0)),
    stiffness=room((3, 0)),
    calls=np.zeros(0, np.int64),
)


def sums_over_pairs(surface: Surface) -> bool:
    """Whether the bars on an elastic body are so few that forces are sums over all pairs."""
    return surface.count <= MOST_OF_PAIRS


def elastic_surfaces(scene: Scene) -> dict[int, Surface]:
    """Index of each surface on an elastic body -> the surface."""
    return {k: each for k, each in enumerate(scene.surfaces) if each.elastic is not None}


def _waves_of(scene: Scene, surface: Surface) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """K_xx, K_yy, K_xy / i of a periodic grid in Fourier space, (nz, nx)."""
    assert surface.elastic is not None
    counts, spacing = grid_of(surface, scene.periodic)
    found: tuple[np.ndarray, ...] = surface.elastic.stiffness(counts, spacing, surface.facing_sign)
    return found[0], found[1], found[2]


def _with_edges(scene: Scene, surface: Surface) -> tuple[np.ndarray, np.ndarray]:
    """K of a grid with edges (2, n, 2, n), and the shares of its bars in a drive (2, n, 2)."""
    counts, spacing = grid_of(surface, scene.periodic)
    return relaxed(surface.elastic, Grid(counts, spacing, surface.facing_sign))


def stiffest(scene: Scene) -> dict[int, float]:
    """Index of each surface on an elastic body -> a bound on the eigenvalues of its K."""
    found = {}
    for k, surface in elastic_surfaces(scene).items():
        if has_free_edges(scene.periodic):
            stiffness = _with_edges(scene, surface)[0]
            sums = np.sum(np.abs(stiffness), axis=(2, 3))  # by Gershgorin
            found[k] = float(np.max(sums))
        else:
            xx, yy, _ = _waves_of(scene, surface)
            found[k] = float(np.max(xx + yy))  # the trace of each wave's matrix
    return found


def shares_of_edges(scene: Scene, surface: Surface) -> np.ndarray | None:
    """The shares of bars in the drive of a block (2, n, 2); None where all bars take the same."""
    return _with_edges(scene, surface)[1] if has_free_edges(scene.periodic) else None


def bodies_of(scene: Scene, surfaces: Any, columns: dict[int, np.ndarray], width: int) -> Elastic:
    """The elastic bodies of a scene with `width` columns, but for the addresses of functions.

    `columns` (n,) are those of each surface's bars.  The records of surfaces are filled in.
    """
    of_grids = {}
    waves = []
    bars = 0
    for k, surface in elastic_surfaces(scene).items():
        record = surfaces[k]
        if sums_over_pairs(surface):
            record["elastic"] = records.PAIRS
            continue
        record["elastic"] = records.WAVES
        record["elastic_row"] = bars
        of_grids[k] = columns[k]
        bars += surface.count
        halves = [each[:, : each.shape[1] // 2 + 1].ravel() for each in _waves_of(scene, surface)]
        waves.append(np.array(halves))  # of real displacements
    stiffness = with_spare_lanes(np.concatenate([np.zeros((3, 0)), *waves], axis=1))
    return Elastic(
        pairs=_pairs_of(scene, surfaces, columns),
        shares=_shares_of(scene, columns, width),
        columns=np.concatenate([np.zeros(0, np.int64), *of_grids.values()]),
        grid=room((2, bars)),
        waves=room((2, 2 * stiffness.shape[1])),
        stiffness=stiffness,
        calls=np.zeros(2, np.int64),
    )


def _pairs_of(scene: Scene, surfaces: Any, columns: dict[int, np.ndarray]) -> np.ndarray:
    """K between all bars of each elastic surface that has few, (rows, 4 LANES), after a row of 0.

    A pack of bars has a row for each bar of its surface: K_xx, K_xy, K_yx, K_yy between that bar
    and those of the pack.
    """
    tables = [np.zeros((1, 4 * LANES))]
    row = 1
    for k, surface in elastic_surfaces(scene).items():
        record = surfaces[k]
        if not sums_over_pairs(surface):
            continue
        count = surface.count
        packs = (record["stop"] - record["start"]) // LANES
        pairs = np.zeros((4, packs * LANES, count))
        bars = np.argsort(columns[k])  # in the order of the columns
        pairs[:, :count] = _between(scene, surface)[:, bars[:, None], bars]
        pairs = pairs.reshape(4, packs, LANES, count).transpose(1, 3, 0, 2)
        tables.append(pairs.reshape(-1, 4 * LANES))
        record["elastic_row"] = row
        row += packs * count
    return with_spare_lanes(np.concatenate(tables))


def _between(scene: Scene, surface: Surface) -> np.ndarray:
    """K_xx, K_xy, K_yx, K_yy between all bars, (4, n, n)."""
    n = surface.count
    if has_free_edges(scene.periodic):
        stiffness = _with_edges(scene, surface)[0]
        return stiffness.transpose(0, 2, 1, 3).reshape(4, n, n)
    xx, yy, xy = _waves_of(scene, surface)
    z, x = np.unravel_index(np.arange(n), xx.shape)
    apart = (z[:, None] - z) % xx.shape[0], (x[:, None] - x) % xx.shape[1]
    return np.array([np.fft.ifft2(wave).real[apart] for wave in (xx, 1j * xy, -1j * xy, yy)])


def _shares_of(scene: Scene, columns: dict[int, np.ndarray], width: int) -> np.ndarray:
    """The rows of `Elastic.shares`, of all blocks on elastic bodies."""
    shares = room((4, width))
    for k, surface in elastic_surfaces(scene).items():
        if not surface.drive.block:
            continue
        of_edges = shares_of_edges(scene, surface)
        if of_edges is None:
            shares[0, columns[k]] = 1.0
            shares[3, columns[k]] = 1.0
        else:
            shares[:, columns[k]] = of_edges.transpose(0, 2, 1).reshape(4, -1)
    return shares


class ElasticBodies:
    """The grids of many bars of one loop, whose transforms compiled code calls."""

    def __init__(self, scene: Scene, elastic: Elastic) -> None:
        """Take the arrays of a loop, and put the addresses of the functions among them."""
        self.error: Exception | None = None
        self.interrupted = False
        self._elastic = elastic
        # The bars and the waves of each grid.
        self._parts: list[tuple[np.ndarray, np.ndarray]] = []
        bars = waves = 0
        for surface in elastic_surfaces(scene).values():
            if sums_over_pairs(surface):
                continue
            nx, nz = surface.shape
            half = nx // 2 + 1
            grid = elastic.grid[:, bars : bars + nx * nz].reshape(2, nz, nx)
            wave = elastic.waves.view(complex)[:, waves : waves + nz * half].reshape(2, nz, half)
            self._parts.append((grid, wave))
            bars += nx * nz
            waves += nz * half
        self._forward, self._backward = _transforms()
        called = ctypes.CFUNCTYPE(None)
        self._functions = called(self._to_waves), called(self._to_grids)
        elastic.calls[:] = [
            ctypes.cast(each, ctypes.c_void_p).value or 0 for each in self._functions
        ]

    @property
    def failure(self) -> str:
        """The error that was raised, in words."""
        return f"{type(self.error).__name__}: {self.error}"

    def _to_waves(self) -> None:
        self._guarded(self._forward)

    def _to_grids(self) -> None:
        self._guarded(self._backward)

    def _guarded(self, transform: Callable[[np.ndarray, np.ndarray], None]) -> None:
        """Transform all grids; an exception is kept, since compiled code cannot raise it."""
        try:
            try:
                self._transform(transform)
            except KeyboardInterrupt:  # finish the step, so that the run's state stays consistent
                self.interrupted = True
                self._transform(transform)
        except Exception as error:
            self.error = error
            self._elastic.grid[:] = np.nan
            self._elastic.waves[:] = np.nan

    def _transform(self, transform: Callable[[np.ndarray, np.ndarray], None]) -> None:
        for grid, wave in self._parts:
            transform(grid, wave)


def _transforms() -> tuple[Any, Any]:
    """Functions of grids (2, nz, nx) and waves (2, nz, nx // 2 + 1): from one to the other, back.

    Those of ducc0, if it is installed, else those of scipy, which are slower; they agree
    to round-off.  Both leave alone what they transform.
    """
    try:
        from ducc0 import fft as fast
    except ImportError:
        from scipy import fft  # which only these scenes need

        def forward(grid: np.ndarray, wave: np.ndarray) -> None:
            wave[...] = fft.rfft2(grid)

        def backward(grid: np.ndarray, wave: np.ndarray) -> None:
            grid[...] = fft.irfft2(wave, s=grid.shape[1:])
    else:

        def forward(grid: np.ndarray, wave: np.ndarray) -> None:
            fast.r2c(grid, axes=(1, 2), out=wave, nthreads=1)

        def backward(grid: np.ndarray, wave: np.ndarray) -> None:
            width = grid.shape[2]
            fast.c2r(
                wave, axes=(1, 2), lastsize=width, forward=False, inorm=2, out=grid, nthreads=1
            )

    return forward, backward
