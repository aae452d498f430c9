"""States: all of a run at one time, from which another run continues."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from tribo.layout.layout import Layout
from tribo.layout.legs import BEGUN
from tribo.layout.span import columns
from tribo.layout.start import bath_slots
from tribo.ledger.motion import about_mean, about_pivots
from tribo.ledger.quantity import Table
from tribo.ledger.samples import Samples
from tribo.loops.integrate import Integration
from tribo.loops.time_loop import Memory
from tribo.model.identity import version
from tribo.model.scene import Scene
from tribo.model.surface import Surface

# Rows of coordinates in the tables of a state, and those of their rates.
MOTIONS = {"swing": "omega", "phi": "nu", "x": "vx", "y": "vy"}
OF_BATHS = {"x": "vx", "y": "vy", "phi": "nu"}


@dataclass(frozen=True, eq=False)
class State:
    """The full state of a run at one time; :func:`tribo.simulate` continues from it.

    Attributes
    ----------
    t : float
        The time [time].
    surfaces : dict
        Surface -> quantity -> (asperites,): the angles ``swing`` and ``phi`` from rest, the rates
        ``omega`` and ``nu``, the displacement ``x``, ``y`` of each centre of mass from its uniform
        motion with the surface's initial velocity, and its rate ``vx``, ``vy``.  They have values
        also where the drive or clamps hold a coordinate.
    baths : dict
        Surface with a bath -> quantity -> (asperites, oscillators): displacements ``x``, ``y`` of
        oscillators from the resting bar in its uniform motion, their rates ``vx``, ``vy``, and the
        angle ``phi`` of torsional ones with its rate ``nu``.
    y : ndarray, (2 coordinates,)
        The coordinates of `surfaces` and `baths` that can move in this scene, and their rates, in
        the order of the time loops.
    s : ndarray, (accounts,)
        The accounts of work and pseudowork.
    first : Samples
        The first sample of the run, from which changes are counted.
    anchors : ndarray, (surfaces + fields, 2)
        Displacement of each pulling stage and of each field at t = 0, if they had moved at their
        present velocities all the time; zero unless a velocity was changed between two runs.
    phases : ndarray, (surfaces + fields, 2)
        Displacement of each pulling stage and of each field at `t`.
    begun : ndarray, (surfaces + fields, 10)
        When the own times were zero: of each surface's drive, of a user's forces on the ends of its
        bars, of its stage, its load, and its reservoirs on bars and swings; of each field; of each
        surface's push along x and y; and of each field's modulation. Zero unless a run from a state
        began with others.
    memory : dict
        Data that the method needs to continue bit for bit, and the random generator.
    method : str
        The method's name; empty where nothing has run.
    scene : Scene
        The scene that was run or relaxed.
    version : str
        The version of this package that made it: another may order `y`, `s` and `memory` otherwise.
    cut : bool
        Whether it is an earlier sample of a run, to which this was cut back: `y` of baths and
        `memory` are those of a later time, and no run continues from it.
    """

    t: float
    surfaces: Mapping[str, Table]
    y: np.ndarray
    s: np.ndarray
    first: Samples
    anchors: np.ndarray
    phases: np.ndarray
    begun: np.ndarray
    baths: Mapping[str, Table]
    memory: Memory
    method: str
    scene: Scene
    version: str
    cut: bool = False

    def __repr__(self) -> str:
        counts = ", ".join(f'{each.count} of "{each.name}"' for each in self.scene.surfaces)
        return f"State at t = {self.t:g}: asperites {counts}; {self.method or 'at rest'}"

    @property
    def heights(self) -> dict[str, np.ndarray | None]:
        """Surface -> (asperites,) heights, those that were drawn too; None without any."""
        return {
            surface.name: surface.drawn_heights([self.scene.seed, index, 0])
            for index, surface in enumerate(self.scene.surfaces)
        }

    @property
    def digest(self) -> str:
        """A hash of everything that a run depends on [32 hex digits]."""
        digest = hashlib.blake2b(self.scene.to_toml().encode(), digest_size=16)
        digest.update(f"{self.version} {self.method}".encode())
        for name, array in self.arrays().items():
            digest.update(f"{name} {array.shape}".encode() + array.tobytes())
        return digest.hexdigest()

    def arrays(self) -> dict[str, np.ndarray]:
        """Everything as arrays by name, for files."""
        found = {"t": np.array(self.t), "cut": np.array(self.cut)}
        found |= {name: getattr(self, name) for name in ("y", "s", "anchors", "phases", "begun")}
        found |= under("first_", self.first.arrays()) | under("memory_", self.memory)
        for kind, tables in (("surface", self.surfaces), ("bath", self.baths)):
            for surface, table in tables.items():
                found |= {f"{kind}_{name}_{surface}": array for name, array in table.items()}
        return found

    @classmethod
    def of_arrays(cls, arrays: dict[str, np.ndarray], method: str, scene: Scene, by: str) -> State:
        """The inverse of :meth:`arrays`; `by` is the version that made the state."""
        return cls(
            t=float(arrays["t"]),
            cut=bool(arrays["cut"]),
            surfaces=_tables("surface_", arrays),
            baths=_tables("bath_", arrays),
            begun=_begun(arrays, scene),
            first=Samples(**{"baths": np.empty((1, 0, 0))} | below("first_", arrays)),
            memory=below("memory_", arrays),
            method=method,
            scene=scene,
            version=by,
            **{name: arrays[name] for name in ("y", "s", "anchors", "phases")},
        )


def _tables(prefix: str, arrays: Mapping[str, np.ndarray]) -> dict[str, dict[str, np.ndarray]]:
    """The tables by surface, from arrays whose names have a prefix, a quantity and a surface."""
    tables: dict[str, dict[str, np.ndarray]] = {}
    for key, array in below(prefix, arrays).items():
        name, _, surface = key.partition("_")
        tables.setdefault(surface, {})[name] = array
    return tables


def state_of(layout: Layout, method: str, run: Integration) -> State:
    """The state at the last sample of a run, which a later run can continue from."""
    last = run.samples.last()
    core = layout.core
    n = layout.coordinates
    y = last.y[0].copy()
    if "y" in run.memory:
        y = run.memory["y"].reshape(2, -1)[:, layout.places.q].ravel()
    # A sample has the coordinates of the asperites at its time; a loop may be behind with them.
    y[:core] = last.y[0, :core]
    y[n : n + core] = last.y[0, core:]
    return replace(
        _state(layout, float(last.t[0]), y, last.s[0], run.samples.first()),
        memory=run.memory,
        method=method,
        cut=run.cut,
    )


def state_at_rest(layout: Layout, q: np.ndarray) -> State:
    """The state at t = 0 with coordinates q, (coordinates,), that all move with their surfaces."""
    first = Samples.at_zero(layout)
    return _state(layout, 0.0, np.concatenate([q, np.zeros(q.size)]), first.s[0], first)


def _state(layout: Layout, t: float, y: np.ndarray, s: np.ndarray, first: Samples) -> State:
    """The state of a scene at a time, without what a method needs to continue."""
    return State(
        t=t,
        surfaces={name: _surface(layout, part, t, y) for name, part in layout.parts.items()},
        baths={
            surface.name: _bath(layout, surface, y)
            for surface in layout.scene.surfaces
            if surface.bath
        },
        y=y,
        s=s,
        first=first,
        anchors=layout.anchors,
        phases=layout.anchors + layout.moved(t),
        begun=layout.begun,
        memory={},
        method="",
        scene=layout.scene,
        version=version(),
    )


def _surface(layout: Layout, part: slice, t: float, y: np.ndarray) -> Table:
    """The coordinates of a surface's asperites and their rates, by name."""
    a = layout.asperites[part]
    n = layout.coordinates
    table = {"swing": y[:n][part], "omega": y[n:][part]}
    clamped = np.array([a.phi + a.nu * t, a.nu])
    for name, absent in (("phi", clamped), ("x", 0.0), ("y", 0.0)):
        slots = a[f"dof_{name}"]
        table[name], table[MOTIONS[name]] = columns(slots, y.reshape(2, n), absent)
    if np.any(a.pivot > 0.0):
        about = about_pivots(a, table["swing"], table["omega"])
        tilted = about_mean(a, table["phi"], table["nu"])
        for name, values, more in zip(("x", "y", "vx", "vy"), about, tilted, strict=True):
            table[name] = table[name] + values + more
    return {name: np.array(values) for name, values in table.items()}


def _begun(arrays: Mapping[str, np.ndarray], scene: Scene) -> np.ndarray:
    """When own times were zero; earlier versions, from whose states no run continues, had fewer.

    There, pushes had the time of their drive, and modulations that of their field.
    """
    begun = np.zeros((len(scene.surfaces) + len(scene.fields), len(BEGUN)))
    known = arrays.get("begun", np.zeros((0, 0)))
    begun[: len(known), : known.shape[1]] = known
    for name, before in (("push_x", "drive"), ("push_y", "drive"), ("modulation", "field")):
        if BEGUN.index(name) >= known.shape[1]:
            begun[:, BEGUN.index(name)] = begun[:, BEGUN.index(before)]
    return begun


def _bath(layout: Layout, surface: Surface, y: np.ndarray) -> Table:
    """The coordinates of the oscillators on a surface's bars and their rates, by name."""
    slots = bath_slots(layout.asperites[layout.parts[surface.name]], surface.bath)
    table = {}
    for (name, rate), own in zip(OF_BATHS.items(), slots, strict=True):
        table[name], table[rate] = y.reshape(2, -1)[:, own]
    return table


def under(prefix: str, arrays: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Arrays with a prefix before their names."""
    return {prefix + name: array for name, array in arrays.items()}


def below(prefix: str, arrays: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The arrays whose names begin with a prefix, by the rest of their names."""
    names = (name for name in arrays if name.startswith(prefix))
    return {name.removeprefix(prefix): arrays[name] for name in names}
