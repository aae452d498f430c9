"""The elastic body of a surface: what couples the displacements of its bars beside springs.

Bars of a grid stand on the surface of a half-space, or of a layer on a rigid base.  A force on a
bar is a traction on its cell of the grid, and displaces all bars.  On a periodic grid each wave is
displaced by itself in Fourier space: along the wave vector q and into the body by a matrix of two
rows, across q in the surface by one number.  For grids with edges see `model.free_edges`.

K. L. Johnson, Contact Mechanics (1985), chapter 3, for the half-space; the layer's matrix is the
solution of Navier's equations for each wave, with the base at rest.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from tribo import validation as check
from tribo.kernels import records
from tribo.model.tables import from_table
from tribo.validation import InputError, must_be

# Depth of a layer in units of 1 / q from which it is a half-space to round-off.
DEEP = 40.0
# Relative difference up to which a period is the length of a grid.
SAME = 1e-9
# Most bars of a surface whose forces are sums over all pairs: a step of so many bars takes 0.05 ms
# with sums.  Those of more bars are found by transforms, which need a periodic grid.
MOST_OF_PAIRS = 256


@dataclass(frozen=True)
class Elastic:
    """An isotropic elastic body: a half-space, or a layer on a rigid base.

    Attributes
    ----------
    modulus : float
        Young's modulus E [force / length^2].
    poisson : float
        Poisson's ratio, above -1 and at most 0.5; below 0.5 for a layer.
    thickness : float, optional
        Thickness of the layer [length]; None for a half-space.

    Raises
    ------
    InputError
        If a value is out of range.
    """

    modulus: float
    poisson: float
    thickness: float | None = None

    def __post_init__(self) -> None:
        """Check the values."""
        check.fields(self, modulus=check.one(check.POSITIVE, "force / length^2"))
        check.fields(self, poisson=check.one(unit=""))
        if self.thickness is not None:
            check.fields(self, thickness=check.one(check.POSITIVE, "length"))
        if not -1.0 < self.poisson <= 0.5:
            raise must_be("poisson", "above -1 and at most 0.5", self.poisson)
        if self.poisson == 0.5 and self.thickness is not None:
            raise InputError("poisson", "must be below 0.5 for a layer, got 0.5")

    def waves(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Displacements by unit tractions of wave numbers q > 0 (n,) [length^3 / force].

        Along q by traction along q, into the body by traction into it, i times that along q by
        traction into the body, and across q by traction across q.
        """
        poisson = self.poisson
        compliance = (1.0 + poisson) / (self.modulus * q)
        along = 2.0 * (1.0 - poisson) * compliance
        mixed = (1.0 - 2.0 * poisson) * compliance
        across = 2.0 * compliance
        inward = along
        if self.thickness is not None:
            depth = q * self.thickness
            across = across * np.tanh(depth)
            thin = depth < DEEP
            solved = _layer(depth[thin], poisson)
            along = along.copy()
            inward = along.copy()
            mixed = mixed.copy()
            # In units of 1 / (mu q), and mu is E / (2 (1 + poisson)).
            unit = 2.0 * compliance[thin]
            along[thin] = unit * solved[0]
            inward[thin] = unit * solved[1]
            mixed[thin] = unit * solved[2]
        return along, inward, mixed, across

    def stiffness(
        self,
        counts: tuple[int, int],
        spacing: tuple[float, float],
        facing: float,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """K of a periodic grid (nx, nz) in Fourier space, three arrays (nz, nx) [force / length].

        Rows of bars follow one another along z.  K_xx and K_yy are real, and K_xy is i times the
        third array; K_yx is minus that.  The uniform displacement has no force.
        """
        qx, qz = (2.0 * np.pi * np.fft.fftfreq(n, a) for n, a in zip(counts, spacing, strict=True))
        qx, qz = np.meshgrid(qx, qz)
        q = np.hypot(qx, qz)
        q[0, 0] = 1.0
        along, inward, mixed, across = (each.reshape(q.shape) for each in self.waves(q.ravel()))
        xx = (along * qx**2 + across * qz**2) / q**2
        # Where a wave is its own opposite, nothing tells its direction.
        own = np.zeros(q.shape, bool)
        if counts[0] % 2 == 0:
            own[:, counts[0] // 2] = True
        xy = np.where(own, 0.0, facing * mixed * qx / q)
        area = abs(spacing[0] * spacing[1])
        determinant = xx * inward - xy**2
        determinant[0, 0] = 1.0
        scale = area / determinant
        found = scale * inward, scale * xx, -scale * xy
        for each in found:
            each[0, 0] = 0.0
        return found


def _layer(depth: np.ndarray, poisson: float) -> np.ndarray:
    """Displacements of the surface of a layer, (3, n), in units of 1 / (shear modulus x q).

    With the depth z in units of 1 / q, u_along = i U and u_inward = W solve Navier's equations for
    (U, W) = (1, -1) e^-z and (-z, 3 - 4 poisson + z) e^-z, and their images from the base.
    """
    n = depth.size
    shear = 1.0
    first = 2.0 * shear * poisson / (1.0 - 2.0 * poisson)

    def modes(z: np.ndarray) -> tuple[np.ndarray, ...]:
        """U, W, U', W' of the four modes at z, each (4, n)."""
        down = np.exp(-z)
        up = np.exp(z - depth)
        c = 3.0 - 4.0 * poisson
        u = np.array([down, -z * down, up, -z * up])
        w = np.array([-down, (c + z) * down, up, (c - z) * up])
        du = np.array([-down, (z - 1.0) * down, up, (-1.0 - z) * up])
        dw = np.array([down, (1.0 - c - z) * down, up, (c - z - 1.0) * up])
        return u, w, du, dw

    u, w, du, dw = modes(np.zeros(n))
    matrix = np.empty((n, 4, 4))
    matrix[:, 0] = (-shear * (du + w)).T  # traction along q, over i
    matrix[:, 1] = (-(first * (dw - u) + 2.0 * shear * dw)).T  # traction into the body
    at_base = modes(depth)
    matrix[:, 2] = at_base[0].T
    matrix[:, 3] = at_base[1].T
    right = np.zeros((n, 4, 2))
    right[:, 0, 0] = right[:, 1, 1] = 1.0
    solved = np.linalg.solve(matrix, right)
    found = np.einsum("mn,nmk->nk", u, solved), np.einsum("mn,nmk->nk", w, solved)
    return np.array([found[0][:, 0], found[1][:, 1], found[0][:, 1]])


def as_elastic(value: object) -> Elastic | None:
    """An elastic body from a table of a scene file, None, or the body unchanged."""
    return None if value is None else from_table(Elastic, value, ["modulus", "poisson"])


def check_elastic(surface: Any) -> None:
    """Refuse bars that do not stand on a grid, or that a constraint holds.  Raises InputError."""
    if surface.elastic is None:
        return
    if surface.positions is not None or surface.count < 2:
        raise InputError("elastic", "needs a grid of bars: give shape and spacing, not positions")
    if surface.drive.holds_bars:
        raise InputError("elastic", 'cannot go with drive = "bars", whose bars are not displaced')
    if surface.drive.gives_motion:
        raise InputError("elastic", 'cannot go with drive = "moved", which moves all bars alike')
    if surface.drive.block and surface.drive.plugin is not None:
        raise InputError("elastic", "cannot go with block = true in a drive of the user's own")
    if surface.drive.block and surface.drive.damps:
        raise InputError("elastic", "cannot go with the damping of a block; langevin damps bars")


def has_free_edges(periodic: Any) -> bool:
    """Whether the body reaches beyond the grids of a scene with this period."""
    return periodic.x is None and periodic.z is None


def grid_of(surface: Any, periodic: Any) -> tuple[tuple[int, int], tuple[float, float]]:
    """Numbers of bars along x and z, and their spacings, of the grid on an elastic body.

    A single row stands on cells as wide as the period along z.  Raises InputError.
    """
    name = f"{surface.name}.elastic"
    if has_free_edges(periodic):
        _check_free_edges(surface, name)
        return surface.shape, surface.spacing
    spacings = []
    for n, axis, given in zip(surface.shape, "xz", surface.spacing, strict=True):
        period = getattr(periodic, axis)
        if period is None:
            other = "x" if axis == "z" else "z"
            problem = f"needs periodic.{axis} too, beside periodic.{other}; or neither, for edges"
            raise InputError(name, problem)
        spacing = given if n > 1 else period
        if abs(n * abs(spacing) - period) > SAME * period:
            problem = f"needs periodic.{axis} = {n * abs(spacing):g}, {n} times the spacing of bars"
            raise InputError(name, f"{problem}, got {period:g}")
        spacings.append(spacing)
    return surface.shape, (spacings[0], spacings[1])


def _check_free_edges(surface: Any, name: str) -> None:
    """Refuse what has no stiffness on a body that reaches beyond the grid."""
    if surface.elastic.thickness is not None:
        problem = "a layer needs periodic.x and periodic.z, the lengths of the grid; a half-space "
        raise InputError(f"{name}.thickness", problem + "may have edges")
    if surface.count > MOST_OF_PAIRS:
        problem = f"needs periodic.x and periodic.z for more than {MOST_OF_PAIRS} bars"
        raise InputError(name, f"{problem}, got {surface.count}")
    if 0.0 in surface.spacing:
        problem = "must not be 0 along x or z on an elastic body with edges, even of a single row"
        raise InputError(f"{surface.name}.spacing", f"{problem}, got {list(surface.spacing)}")
    drive = surface.drive
    cancels = drive.load is None or drive.law == records.FORCED
    if drive.block and cancels:
        problem = "needs a load where its elastic body has edges, and cannot be forced"
        raise InputError(f"{surface.name}.drive", problem)
