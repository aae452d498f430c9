"""States: all of a run at one time, from which another run continues."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tribo.layout.layout import Layout
from tribo.layout.span import columns
from tribo.ledger.motion import about_pivots
from tribo.ledger.quantities import Table
from tribo.ledger.samples import Samples
from tribo.loops.general import GeneralLoop
from tribo.loops.integrate import Integration, Memory
from tribo.model.identity import first_difference, plain_table, version
from tribo.model.scene import Scene
from tribo.validation import InputError

# Keys of a scene that are no part of its physics.
NO_PHYSICS = ("title", "duration", "output", "numerics")
# Keys of a surface that place it: displacements in a state are relative to them.
PLACES = (
    *("name", "facing", "bob", "velocity", "shape", "spacing", "depth", "heights", "positions"),
    *("species", "bars"),
)
# What a loop remembers in arrays whose lengths depend on the run, and which it reads accordingly.
OF_ANY_LENGTH = ("noise", "neighbours_index")


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
        motion with the surface's initial velocity, and its rate ``vx``, ``vy``.
    y : ndarray, (2 coordinates,)
        The same coordinates and those of baths, in the order of the time loops.
    s : ndarray, (accounts,)
        The accounts of work and pseudowork.
    first : Samples
        The first sample of the run, from which changes are counted.
    anchors : ndarray, (surfaces + fields, 2)
        Displacement of each pulling stage and of each field at t = 0, if they had moved at their
        present velocities all the time; zero unless a velocity was changed between two runs.
    phases : ndarray, (surfaces + fields, 2)
        Displacement of each pulling stage and of each field at `t`.
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
    memory: Memory
    method: str
    scene: Scene
    version: str
    cut: bool = False

    def __repr__(self) -> str:
        counts = ", ".join(f'{each.count} of "{each.name}"' for each in self.scene.surfaces)
        return f"State at t = {self.t:g}: asperites {counts}; {self.method or 'at rest'}"

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
        found |= {name: getattr(self, name) for name in ("y", "s", "anchors", "phases")}
        found |= under("first_", self.first.arrays()) | under("memory_", self.memory)
        for surface, table in self.surfaces.items():
            found |= {f"surface_{name}_{surface}": array for name, array in table.items()}
        return found

    @classmethod
    def of_arrays(cls, arrays: dict[str, np.ndarray], method: str, scene: Scene, by: str) -> State:
        """The inverse of :meth:`arrays`; `by` is the version that made the state."""
        surfaces: dict[str, dict[str, np.ndarray]] = {}
        for key, array in below("surface_", arrays).items():
            name, _, surface = key.partition("_")
            surfaces.setdefault(surface, {})[name] = array
        return cls(
            t=float(arrays["t"]),
            cut=bool(arrays["cut"]),
            surfaces=surfaces,
            first=Samples(**{"baths": np.empty((1, 0, 0))} | below("first_", arrays)),
            memory=below("memory_", arrays),
            method=method,
            scene=scene,
            version=by,
            **{name: arrays[name] for name in ("y", "s", "anchors", "phases")},
        )


@dataclass(frozen=True, eq=False)
class Origin:
    """Where the runs of a scene begin, if not at its start."""

    state: State
    same_scene: bool  # whether the state is of the same scene, whose accounts go on

    @property
    def first(self) -> Samples | None:
        """The first sample of the run that goes on; None where a run begins."""
        earlier = self.same_scene and self.state.first.t[0] < self.state.t
        return self.state.first if earlier else None

    def place(self, loop: GeneralLoop, method: str, exactly: bool) -> None:
        """Let a loop begin from the state; `exactly` if its coordinates were not changed."""
        state = self.state
        if exactly and self.same_scene and method == state.method and "y" in state.memory:
            wanted = {name: array.shape for name, array in loop.memory().items()}
            _check_shapes("memory.", state.memory, wanted)
            fraction = loop.clocks["encounter_fraction"].copy()
            loop.restore(state.memory)
            loop.clocks["encounter_fraction"], loop.clocks["sample"] = fraction, 0
            return
        loop.clocks["t"] = state.t
        if self.same_scene:
            loop.state.s[loop.layout.places.s] = state.s
        loop.restore_noise(state.memory)


def digest_of(origin: Origin | None) -> str | None:
    """What tells the state where a run begins from others; None for the scene's own start."""
    return None if origin is None else origin.state.digest


def state_of(layout: Layout, method: str, run: Integration) -> State:
    last = run.samples.last()
    core, n = layout.core, layout.coordinates
    y = last.y[0].copy()
    if "y" in run.memory:
        y = run.memory["y"].reshape(2, -1)[:, layout.places.q].ravel()
    # A sample has the coordinates of the asperites at its time; a loop may be behind with them.
    y[:core], y[n : n + core] = last.y[0, :core], last.y[0, core:]
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
        surfaces={name: _surface(layout, part, y) for name, part in layout.parts.items()},
        y=y,
        s=s,
        first=first,
        anchors=layout.anchors,
        phases=layout.anchors + layout.drifts * t,
        memory={},
        method="",
        scene=layout.scene,
        version=version(),
    )


def _surface(layout: Layout, part: slice, y: np.ndarray) -> Table:
    """The coordinates of a surface's asperites and their rates, by name."""
    a, n = layout.asperites[part], layout.coordinates
    table = {"swing": y[:n][part], "omega": y[n:][part]}
    for name, rate, slots in (("phi", "nu", a.dof_phi), ("x", "vx", a.dof_x), ("y", "vy", a.dof_y)):
        table[name], table[rate] = columns(slots, y.reshape(2, n))
    if np.any(a.pivot > 0.0):
        about = about_pivots(a, table["swing"], table["omega"])
        for name, values in zip(("x", "y", "vx", "vy"), about, strict=True):
            table[name] = table[name] + values
    return {name: np.array(values) for name, values in table.items()}


def continued(layout: Layout, state: State) -> tuple[Layout, Origin]:
    """The layout of a scene that starts from a state, which may be of a scene with other forces.

    Fields that only one of the scenes has are where that scene puts them.  Raises InputError if the
    state does not fit the scene, or another version made it.
    """
    if not isinstance(state, State):
        raise InputError("start", f"must be a tribo.State, got {type(state).__name__}")
    made_by = getattr(state, "version", "an earlier version")
    if made_by != version():
        raise InputError(
            "start",
            f"must be a state of this version of tribo, {version()}, but {made_by} made it, which "
            "may order its numbers otherwise; repeat the run that it comes from",
        )
    if state.cut:
        raise InputError(
            "start",
            f"must be a state in which a run ended, but this run was cut back to t = {state.t:g} "
            "because surfaces passed through each other or its energy ran away; start from an "
            "earlier state",
        )
    old, new = plain_table(state.scene), plain_table(layout.scene)
    before, now = ({k: v for k, v in each.items() if k not in NO_PHYSICS} for each in (old, new))
    # Works go on only where the same ones are kept.
    ledgers = state.scene.output.ledger, layout.scene.output.ledger
    same_scene = first_difference(before, now) is None and ledgers[0] == ledgers[1]
    places, others = ({"surface": list(map(_places_of, t["surface"]))} for t in (old, new))
    if (other := first_difference(places, others)) is not None:
        raise InputError("start", f"must be a state of this scene, but {other}")
    if state.y.size != layout.start.size:
        raise InputError("start", "must be a state of this scene, but has other coordinates")
    if layout.scene.duration <= state.t:
        raise InputError(
            "duration", f"must be later than the state's t = {state.t:g}, got {new['duration']:g}"
        )
    _check_arrays(layout, state, same_scene)
    anchors = state.anchors
    if not same_scene:
        # Fields that are others are where the scene has them.
        known = slice(None) if len(anchors) == len(layout.drifts) else slice(len(layout.parts))
        anchors = layout.anchors
        anchors[known] = state.phases[known] - layout.drifts[known] * state.t
    layout = replace(layout.anchored(anchors), start=state.y, beginning=state.t)
    return layout, Origin(state, same_scene)


def _check_arrays(layout: Layout, state: State, same_scene: bool) -> None:
    """Raise InputError unless a state has the numbers of its scene, and those that go on here."""
    moved = len(state.scene.surfaces) + len(state.scene.fields)
    wanted: dict[str, tuple[int, ...]] = dict.fromkeys(("anchors", "phases"), (moved, 2))
    if same_scene:
        wanted["s"] = (layout.accounts,)
        first = Samples.at_zero(layout).arrays()
        del first["baths"]  # which depends on the series that are asked for
        wanted |= {f"first_{name}": array.shape for name, array in first.items()}
    _check_shapes("", state.arrays(), {"y": layout.start.shape, **wanted})


def _check_shapes(
    part: str, arrays: Mapping[str, np.ndarray], wanted: Mapping[str, tuple[int, ...]]
) -> None:
    """Raise InputError about an array of a state that is missing, or has another shape."""
    for name, shape in wanted.items():
        found = np.shape(arrays[name]) if name in arrays else None
        if found is None or (found != shape and name not in OF_ANY_LENGTH):
            other = "is missing" if found is None else f"has the shape {found} in place of {shape}"
            raise InputError("start", f"must be a whole state, but its {part}{name} {other}")


def _places_of(surface: dict[str, Any]) -> dict[str, object]:
    """Settings of a surface on which the meaning of its coordinates depends."""
    places = {key: surface.get(key) for key in PLACES}
    places["drive.kind"] = "bars" if surface["drive"]["kind"] == "bars" else None
    places["asperite.kappa"] = np.inf if np.all(np.isinf(surface["asperite"]["kappa"])) else None
    return places


def under(prefix: str, arrays: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Arrays with a prefix before their names."""
    return {prefix + name: array for name, array in arrays.items()}


def below(prefix: str, arrays: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The arrays whose names begin with a prefix, by the rest of their names."""
    names = (name for name in arrays if name.startswith(prefix))
    return {name.removeprefix(prefix): arrays[name] for name in names}
