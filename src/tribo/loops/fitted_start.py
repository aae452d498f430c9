"""The coordinates of a scene from those of a state, by surface, asperite and name.

A state knows the places and velocities of all asperites, also where its drives or clamps held them.
A scene in which they can move more freely takes them from there; one that holds a coordinate must
hold it where it is in the state.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from tribo.kernels.kinematics import versine
from tribo.layout.layout import Layout
from tribo.layout.start import bath_slots
from tribo.ledger.motion import about_mean
from tribo.loops.saved_state import MOTIONS, OF_BATHS, State
from tribo.model.surface import Surface
from tribo.validation import InputError

# Displacement of what a scene holds, in units of the rods, and its velocity, in units of the
# largest of the state, up to which they are zero: above all rounding.
HELD = 1e-9
# What lets centres of mass move along an axis.
CURES = {"x": 'drive = "free" lets them move', "y": "a load frees them"}


def fitted_start(layout: Layout, state: State) -> np.ndarray:
    """y at the state's time, (2 coordinates,).  Raises InputError about what the scene holds."""
    y = np.zeros(2 * layout.coordinates)
    q, v = np.split(y, 2)
    before = {surface.name: surface for surface in state.scene.surfaces}
    fastest = _largest_speed(state)
    for surface in layout.scene.surfaces:
        part = layout.parts[surface.name]
        own = layout.asperites[part]
        table = dict(state.surfaces[surface.name])
        _move_centres(table, own, surface.facing_sign, before[surface.name])
        for problem, size, speed in _held(surface, before[surface.name], own, table):
            if size > HELD * float(np.max(own.l1 + own.l2)) or speed > HELD * fastest:
                moved = f"are displaced by {size:.3g} and move" if size else "move"
                raise InputError("start", f"{problem}, but they {moved} at {speed:.3g}")
        if surface.is_rigid_block or surface.refers_to_bars:
            _join_bars(table, own, surface.facing_sign)
        slots = {"swing": np.arange(part.start, part.stop)}
        slots |= {name: own[f"dof_{name}"] for name in ("phi", "x", "y")}
        for name, places in slots.items():
            if places[0] >= 0:
                q[places] = table[name]
                v[places] = table[MOTIONS[name]]
        if surface.bath:
            oscillators = zip(OF_BATHS.items(), bath_slots(own, surface.bath), strict=True)
            for (name, rate), places in oscillators:
                bath = state.baths[surface.name]
                q[places] = bath[name]
                v[places] = bath[rate]
    return y


def _join_bars(table: dict[str, np.ndarray], own: Any, facing: float) -> None:
    """Replace the centres of mass of a block by its bars, which are displaced alike."""
    for name, bars in _bars_of_block(table, own, facing).items():
        table[name] = np.full(bars.size, bars[0])


def _bars_of_block(table: dict[str, np.ndarray], own: Any, facing: float) -> dict[str, np.ndarray]:
    """Displacements and velocities of a block's bars, less those by its tilt about their mean."""
    about = _about_bars(table, facing * own.pivot)
    tilted = about_mean(own, table["phi"], table["nu"])
    every = zip(("x", "y", "vx", "vy"), about, tilted, strict=True)
    return {name: table[name] - one - other for name, one, other in every}


def _move_centres(table: dict[str, np.ndarray], own: Any, facing: float, before: Surface) -> None:
    """Move the centres of mass of a surface's table along the rods, where masses are others.

    Bobs and bars stay where they are, and keep their velocities.
    """
    farther = facing * (own.l2 - before.each["l2"])  # from the bar
    if not np.any(farther):
        return
    for name, change in zip(("x", "y", "vx", "vy"), _about_bars(table, farther), strict=True):
        table[name] = table[name] + change


def _about_bars(table: dict[str, np.ndarray], arm: np.ndarray) -> tuple[np.ndarray, ...]:
    """Displacements x, y and velocities of points of the rods, relative to those of the bars.

    `arm` is their distance from the bar, negative where asperites face up.
    """
    swing = table["swing"]
    omega = table["omega"]
    sin = np.sin(swing)
    cos = np.cos(swing)
    return arm * sin, arm * versine(swing), arm * cos * omega, arm * sin * omega


def _held(
    surface: Surface, before: Surface, own: Any, table: dict[str, np.ndarray]
) -> Iterator[tuple[str, float, float]]:
    """What a scene holds: what a state must have, its largest displacement and velocity.

    The displacement is 0 where that is not held.
    """
    name = f'"{surface.name}"'
    if surface.drive.holds_bars:
        x, y, vx, vy = _about_bars(table, surface.facing_sign * own.l2)
        moved = np.hypot(table["x"] - x, table["y"] - y)
        speed = np.hypot(table["vx"] - vx, table["vy"] - vy)
        problem = f'must have the bars of {name} in uniform motion, as drive = "bars" holds them'
        yield problem, _largest(moved), _largest(speed)
    else:
        for axis, cure in CURES.items():
            if own[f"dof_{axis}"][0] < 0:
                problem = (
                    f"must have the centres of mass of {name} in uniform motion along {axis}, as "
                    f"the drive holds them ({cure})"
                )
                yield problem, _largest(table[axis]), _largest(table[f"v{axis}"])
    # Forces other than those of contact move asperites of such a body apart: it goes on from there.
    if surface.moves_as_one and not before.moves_as_one:
        problem = f"must have asperites of {name} that move as one, as drive.rigid = true"
        yield problem, 0.0, float(np.ptp(table["vx"]))
    if surface.is_rigid_block:
        bars = _bars_of_block(table, own, surface.facing_sign)
        x, y, vx, vy = (np.ptp(each) for each in bars.values())
        problem = f"must have the bars of {name} displaced alike, as drive.block = true joins them"
        yield problem, max(x, y), max(vx, vy)
    if surface.tilts:
        size = float(np.max(own.l1 + own.l2))
        problem = f'must have bars of {name} that turn together, as drive.tilt = "free"'
        yield problem, size * np.ptp(table["phi"]), size * np.ptp(table["nu"])
    if surface.asperite.is_rigid:
        problem = f"must have asperites of {name} that do not swing, as asperite.kappa = inf"
        turning = table["nu"] if surface.tilts else 0.0
        yield problem, 0.0, _largest((table["omega"] - turning) * (own.l1 + own.l2))


def _largest(values: np.ndarray) -> float:
    return float(np.max(np.abs(values)))


def _largest_speed(state: State) -> float:
    """The largest speed of a bob or a surface in a state."""
    speeds = [0.0]
    for surface in state.scene.surfaces:
        table = state.surfaces[surface.name]
        rods = surface.each["length"]
        speeds += [_largest(table["vx"]), _largest(table["vy"]), _largest(table["omega"] * rods)]
        speeds.append(float(np.hypot(*surface.velocity)))
    return max(speeds)
