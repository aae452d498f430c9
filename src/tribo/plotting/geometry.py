"""Where asperites are at one time, and the contact forces there."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tribo.analysis.contact_probe import ContactProbe
from tribo.model.scene import Scene
from tribo.model.surface import Surface
from tribo.results.run_result import RunResult
from tribo.validation import InputError


@dataclass(frozen=True, eq=False)
class AsperiteGeometry:
    """Positions and angles of one asperite, and the sizes that are drawn.

    Attributes
    ----------
    cm, bob, bar : ndarray, (2,)
        Centre of mass, centre of the bob and centre of the bar [length].
    theta : float
        Angle of the rod from straight down [rad].
    phi : float
        Angle of the bar [rad].
    bar_length : float
        [length]
    facing : str
        "down" where the bar is above the bob, else "up".
    depth : float
        z of the bob [length].
    """

    cm: np.ndarray
    bob: np.ndarray
    bar: np.ndarray
    theta: float
    phi: float
    bar_length: float
    facing: str = "down"
    depth: float = 0.0

    @property
    def length(self) -> float:
        """Length of the rod."""
        return float(np.hypot(*(self.bob - self.bar)))

    @property
    def ends(self) -> np.ndarray:
        """(2, 2) left and right end of the bar."""
        half = 0.5 * self.bar_length * np.array([np.cos(self.phi), np.sin(self.phi)])
        return np.array([self.bar - half, self.bar + half])

    @property
    def up(self) -> float:
        """+1 if the bar is above the bob, -1 if it is below."""
        return 1.0 if self.facing == "down" else -1.0

    def shifted(self, shift: np.ndarray | tuple[float, float]) -> AsperiteGeometry:
        """The same asperite elsewhere."""
        return replace(self, cm=self.cm + shift, bob=self.bob + shift, bar=self.bar + shift)


SceneGeometry = dict[str, list[AsperiteGeometry]]  # the asperites of each surface


def scene_geometry(result: RunResult, t: float) -> SceneGeometry:
    """All asperites at a time.

    Between samples, centres of mass and angles are cubic Hermite interpolants of the samples and
    their rates.

    Parameters
    ----------
    result : RunResult
    t : float
        Time, from the first sample to the last [time].

    Returns
    -------
    dict of str to list of AsperiteGeometry
        The asperites of each surface.

    Raises
    ------
    InputError
        If `t` is before the first sample or after the last.
    """
    if not result.t[0] <= t <= result.t[-1]:
        raise InputError("t", f"must be from {result.t[0]:g} to {result.t[-1]:g}, got {t}")
    return {surface.name: _asperites(result, surface, t) for surface in result.scene.surfaces}


def shifted(geometry: SceneGeometry, shift: np.ndarray | tuple[float, float]) -> SceneGeometry:
    """The same scene at another place.

    Parameters
    ----------
    geometry : SceneGeometry
        The asperites.
    shift : array_like, (2,)
        Displacement in x and y [length].

    Returns
    -------
    SceneGeometry
    """
    return {name: [each.shifted(shift) for each in group] for name, group in geometry.items()}


def _asperites(result: RunResult, surface: Surface, t: float) -> list[AsperiteGeometry]:
    series = result[surface.name]
    k = int(np.searchsorted(result.t, t, side="right")) - 1

    def at(name: str, rate: str) -> np.ndarray:
        return _interpolated(result.t[k : k + 2], series[name][k:], series[rate][k:], t)

    theta, phi = at("theta", "omega"), at("phi", "nu")
    cm = np.stack([at("x_cm", "vx_cm"), at("y_cm", "vy_cm")], axis=1)

    def rigidly(point: str) -> np.ndarray:
        """A point of the pendulum, which turns with the rod about the centre of mass."""
        x, y = (series[f"{axis}_{point}"][k] - series[f"{axis}_cm"][k] for axis in "xy")
        cos, sin = np.cos(theta - series["theta"][k]), np.sin(theta - series["theta"][k])
        return cm + np.stack([cos * x - sin * y, sin * x + cos * y], axis=1)

    bob, bar = rigidly("bob"), rigidly("bar")
    bar_length = surface.each["bar_length"]
    depth = surface.resting_bobs()[:, 2]
    return [
        AsperiteGeometry(
            cm[i], bob[i], bar[i], theta[i], phi[i], bar_length[i], surface.facing, depth[i]
        )
        for i in range(surface.count)
    ]


def _interpolated(times: np.ndarray, values: np.ndarray, rates: np.ndarray, t: float) -> np.ndarray:
    """Values (n,) at `t`, from those and their rates at one time or two, the first at most `t`."""
    from scipy.interpolate import CubicHermiteSpline

    if times[0] == t:
        return values[0]
    return np.asarray(CubicHermiteSpline(times, values[:2], rates[:2])(t))


def joined_bars(surface: Surface) -> np.ndarray:
    """(n, 2) indices of the bars that lattice springs join, but for springs around a period."""
    ends, _ = surface.springs.bonds(surface.shape, surface.count, (False, False))
    closes_ring = surface.springs.wrap & (ends[:, 0] > ends[:, 1])
    return np.asarray(ends[~closes_ring])


class Contacts:
    """Contact forces and distances of the bobs of a scene, as the kernels of runs compute them.

    Parameters
    ----------
    scene : Scene
    geometry : SceneGeometry
        All asperites of the scene, at one time.

    Raises
    ------
    InputError
        If a calculator of the scene fails.
    """

    def __init__(self, scene: Scene, geometry: SceneGeometry) -> None:
        self._probe = ContactProbe(scene)
        self._parts = self._probe.layout.parts
        bobs = np.array([each.bob for name in self._parts for each in geometry[name]])
        bobs = bobs - self._probe.layout.origin
        self._positions = np.column_stack([bobs, self._probe.depths])
        _, (forces,) = self._probe(self._positions[None], self._probe.charges[None])
        self._forces = forces

    def force(self, surface: str, asperite: int) -> np.ndarray:
        """(2,) force f1 on a bob from the bobs of other surfaces."""
        return self._forces[self._parts[surface]][asperite]

    def nearest(self, surface: str, asperite: int) -> tuple[str, int, float] | None:
        """The nearest bob of another surface, as surface and asperite, and its distance [length].

        None if there is no other surface.
        """
        own = self._parts[surface]
        distances = self._probe.distances(self._positions, own.start + asperite)
        distances[own] = np.inf
        nearest = int(np.argmin(distances))
        for name, part in self._parts.items():
            if name != surface and part.start <= nearest < part.stop:
                return name, nearest - part.start, float(distances[nearest])
        return None
