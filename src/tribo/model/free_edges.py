"""The stiffness of few bars on a half-space that reaches beyond their grid on all sides.

A force on a bar is a uniform traction on its cell, a rectangle, and a bar is displaced as the
centre of its cell.  The displacement of any point is then an integral over the rectangle, which
A. E. H. Love, Phil. Trans. R. Soc. A 228, 377 (1929), found for normal and V. Cerruti's solution
gives for tangential tractions; K. L. Johnson, Contact Mechanics (1985), sections 3.2 to 3.6.
"""

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np


class Grid(NamedTuple):
    """The cells of bars; rows of bars follow one another along z."""

    counts: tuple[int, int]
    spacing: tuple[float, float]
    facing: float


@lru_cache(maxsize=8)
def relaxed(body: Any, grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """K between all bars (2, n, 2, n) without a uniform displacement's forces, and shares.

    The half-space is at rest far away.  It is displaced there as a whole until all its forces on
    the bars add to zero, so that a uniform displacement of the bars has no forces and no energy.
    Shares (2, n, 2) are the forces on the bars, along the first axis, where the half-space presses
    on them by n along the last axis.
    """
    n = grid.counts[0] * grid.counts[1]
    stiffness = np.linalg.inv(compliance(body, grid).reshape(2 * n, 2 * n))
    stiffness = 0.5 * (stiffness + stiffness.T)
    uniform = np.kron(np.eye(2), np.ones((n, 1)))
    by_uniform = stiffness @ uniform
    shares = by_uniform @ np.linalg.inv(uniform.T @ by_uniform)
    free = stiffness - shares @ by_uniform.T
    free = 0.5 * (free + free.T)
    return free.reshape(2, n, 2, n), n * shares.reshape(2, n, 2)


def compliance(body: Any, grid: Grid) -> np.ndarray:
    """Displacements of all bars by unit forces on all bars, (2, n, 2, n) [length / force]."""
    (nx, nz), (ax, az) = grid.counts, grid.spacing
    row, column = np.unravel_index(np.arange(nx * nz), (nz, nx))
    x = (column[:, None] - column) * ax
    z = (row[:, None] - row) * az
    poisson = body.poisson
    scale = (1.0 + poisson) / (np.pi * body.modulus * abs(ax * az))
    along, across, ahead = (_over_cell(each, x, z, abs(ax), abs(az)) for each in INTEGRALS)
    found = np.empty((2, x.shape[0], 2, x.shape[0]))
    found[0, :, 0] = scale * (along + (1.0 - poisson) * across)
    found[1, :, 1] = scale * (1.0 - poisson) * (along + across)
    mixed = grid.facing * scale * (0.5 - poisson) * ahead
    found[0, :, 1] = -mixed  # what is pressed in draws the surface towards itself
    found[1, :, 0] = mixed
    return found


def _along(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """The integral of x^2 / r^3 over x and z."""
    return z * np.arcsinh(x / np.abs(z))


def _across(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """The integral of z^2 / r^3 over x and z."""
    return x * np.arcsinh(z / np.abs(x))


def _ahead(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """The integral of x / r^2 over x and z."""
    return 0.5 * z * np.log(x**2 + z**2) + x * np.arctan(z / x)


INTEGRALS = _along, _across, _ahead


def _over_cell(integral: Any, x: np.ndarray, z: np.ndarray, ax: float, az: float) -> np.ndarray:
    """A definite integral over the cell about each (x, z), whose corners have no x or z of 0."""
    right, left = x + 0.5 * ax, x - 0.5 * ax
    far, near = z + 0.5 * az, z - 0.5 * az
    first = integral(right, far) - integral(left, far)
    found: np.ndarray = first - (integral(right, near) - integral(left, near))
    return found
