"""Where asperites are drawn at one time."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tribo.model.surface import Surface
from tribo.plotting.marks import Box
from tribo.plotting.oscillators import oscillator_dots
from tribo.results.run_result import RunResult
from tribo.validation import InputError

# Displacement in the drawing for a depth of 1, to the right and upward (oblique projection).
OBLIQUE = np.array([0.35, 0.2])


@dataclass(frozen=True, eq=False)
class Pose:
    """Places of n asperites in a drawing; those at a depth are shifted right and upward."""

    parts: dict[str, slice]  # the asperites of each surface
    bars: np.ndarray  # (n, 2) centres of the bars [length]
    cms: np.ndarray  # (n, 2) of mass
    bobs: np.ndarray  # (n, 2)
    phi: np.ndarray  # (n,) angles of the bars [rad]
    theta: np.ndarray  # (n,) of the rods from straight down
    bar_lengths: np.ndarray  # (n,) [length]
    up: np.ndarray  # (n,) +1 where the bar is above the bob, else -1
    is_twisted: np.ndarray  # (n,) whether a torsion spring is drawn
    aside: np.ndarray  # (n, 2) the shift for the depth [length]
    joined: np.ndarray  # (m, 2) pairs of asperites whose bars a lattice spring joins
    dots: np.ndarray  # (m, 2) bath oscillators, where they are drawn [length]

    @property
    def rods(self) -> np.ndarray:
        """(n,) lengths of the rods."""
        return np.asarray(np.hypot(*(self.bobs - self.bars).T))

    @property
    def swing(self) -> np.ndarray:
        """(n,) angles of the pendulums from their rest [rad]."""
        return np.asarray(self.theta - self.phi - np.where(self.up > 0.0, 0.0, np.pi))

    @property
    def ends(self) -> np.ndarray:
        """(n, 2, 2) left and right end of each bar."""
        half = np.stack([np.cos(self.phi), np.sin(self.phi)], axis=1)
        half = 0.5 * self.bar_lengths[:, None] * half
        return np.stack([self.bars - half, self.bars + half], axis=1)

    @property
    def box(self) -> Box:
        """What the parts cover."""
        size = float(self.rods.max())
        ends = self.ends.reshape(-1, 2)
        room = np.array([0.2, 0.1]) * size  # around bobs
        low = np.concatenate([ends - 0.06 * size, self.bobs - room, self.dots]).min(axis=0)
        high = np.concatenate([ends + 0.06 * size, self.bobs + room, self.dots]).max(axis=0)
        return Box(float(low[0]), float(high[0]), float(low[1]), float(high[1]))

    def index(self, surface: str, asperite: int) -> int:
        """The place of an asperite among all."""
        return int(self.parts[surface].start) + asperite

    def shifted(self, shift: np.ndarray | tuple[float, float]) -> Pose:
        moved = {name: getattr(self, name) + shift for name in ("bars", "cms", "bobs", "dots")}
        return replace(self, **moved)


def pose(result: RunResult, t: float, bath: bool = False, wrap: bool = False) -> Pose:
    """All asperites at a time, with `wrap` within one period of a periodic scene.

    Between samples, centres of mass and angles are cubic Hermite interpolants of the samples and
    their rates; bath oscillators are those of the nearest sample.  Raises InputError for a time
    outside of the run, and where places are not kept.
    """
    sample = nearest_sample(result, t)
    surfaces = result.scene.surfaces
    parts = result.scene.parts
    places = [_places(result, surface, t) for surface in surfaces]
    aside = [np.asarray(s.resting_bobs()[:, 2:] * OBLIQUE) for s in surfaces]
    if wrap:
        turns = [_turns(result, bars[:, 0]) for bars, *_ in places]
        aside = [own + turn for own, turn in zip(aside, turns, strict=True)]
    shifts = dict(zip((s.name for s in surfaces), aside, strict=True))
    dots = oscillator_dots(result, np.array([sample])) if bath else {}
    rows = [(d[0] + shifts[name][:, None]).reshape(-1, 2) for name, d in dots.items()]
    joined = [joined_bars(s) + parts[s.name].start for s in surfaces]
    shift = np.concatenate(aside)
    bars, cms, bobs, phi, theta = map(np.concatenate, zip(*places, strict=True))
    pairs = np.concatenate(joined)
    if wrap and result.scene.periodic.x is not None:
        apart = np.abs(np.diff((bars + shift)[pairs, 0], axis=1)[:, 0])
        pairs = pairs[apart < 0.5 * result.scene.periodic.x]  # not across the picture
    return Pose(
        parts=parts,
        bars=bars + shift,
        cms=cms + shift,
        bobs=bobs + shift,
        phi=phi,
        theta=theta,
        bar_lengths=np.concatenate([s.each["bar_length"] for s in surfaces]),
        up=np.concatenate([np.full(s.count, s.facing_sign) for s in surfaces]),
        is_twisted=np.concatenate([has_spring(s) for s in surfaces]),
        aside=shift,
        joined=pairs,
        dots=np.concatenate([np.empty((0, 2)), *rows]),
    )


def _turns(result: RunResult, x: np.ndarray) -> np.ndarray:
    """(n, 2) shifts by whole periods along x that bring bars into the period of the first surface.

    It begins half a spacing to the left of the surface's first bar, at the start.
    """
    found = np.zeros((x.size, 2))
    period = result.scene.periodic.x
    if period is not None:
        first = result.scene.surfaces[0]
        start = float(np.min(result[first.name]["x_bar"][0]))
        apart = first.spacing[0] if first.positions is None and first.shape[0] > 1 else period
        found[:, 0] = -period * np.floor((x - start + 0.5 * min(apart, period)) / period)
    return found


def nearest_sample(result: RunResult, t: float) -> int:
    """The sample whose time is nearest.  Raises InputError for a time outside of the run."""
    if not result.t[0] <= t <= result.t[-1]:
        raise InputError("times", f"must be from {result.t[0]:g} to {result.t[-1]:g}, got {t}")
    return int(np.argmin(np.abs(result.t - t)))


def has_spring(surface: Surface) -> np.ndarray:
    """(n,) whether a torsion spring ties the pendulum of each asperite to its bar."""
    stiffness = np.broadcast_to(surface.each["kappa"], surface.count)
    return np.asarray((stiffness > 0.0) & (not surface.asperite.is_rigid))


def joined_bars(surface: Surface) -> np.ndarray:
    """(m, 2) indices of the bars that lattice springs join, but for springs around a period."""
    ends, _ = surface.springs.bonds(surface.shape, surface.count, (False, False))
    closes_ring = surface.springs.wrap & (ends[:, 0] > ends[:, 1])
    return np.asarray(ends[~closes_ring])


def _places(result: RunResult, surface: Surface, t: float) -> tuple[np.ndarray, ...]:
    """Bars, centres of mass and bobs (n, 2), and the angles phi and theta (n,), of a surface."""
    from scipy.interpolate import CubicHermiteSpline

    series = result[surface.name]
    if len(series["theta"]) != len(result.t):
        raise InputError("output.samples", "must be fewer, to keep the places of single asperites")
    k = int(np.searchsorted(result.t, t, side="right")) - 1
    if result.t[k] == t:

        def recorded(point: str) -> np.ndarray:
            return np.stack([series[f"x_{point}"][k], series[f"y_{point}"][k]], axis=1)

        places = recorded("bar"), recorded("cm"), recorded("bob")
        return *places, series["phi"][k], series["theta"][k]

    def at(name: str, rate: str) -> np.ndarray:
        both = (series[each][k : k + 2] for each in (name, rate))
        return np.asarray(CubicHermiteSpline(result.t[k : k + 2], *both)(t))

    phi = at("phi", "nu")
    theta = at("theta", "omega")
    cms = np.stack([at("x_cm", "vx_cm"), at("y_cm", "vy_cm")], axis=1)
    rods = np.stack([np.sin(theta), -np.cos(theta)], axis=1)  # directions from bars to bobs
    l1, l2 = (surface.each[name][:, None] for name in ("l1", "l2"))
    return cms - l2 * rods, cms, cms + l1 * rods, phi, theta
