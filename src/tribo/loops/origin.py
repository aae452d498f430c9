"""Where runs begin that do not begin at the start of their scene: states of other runs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tribo.layout.layout import Layout, lay_out
from tribo.layout.legs import BEGUN
from tribo.ledger.samples import Samples
from tribo.loops.fitted_scene import fitted
from tribo.loops.fitted_start import fitted_start
from tribo.loops.general import GeneralLoop
from tribo.loops.saved_state import MOTIONS, OF_BATHS, State
from tribo.model.drives import Pushed
from tribo.model.identity import first_difference, loaded, plain_table, version
from tribo.model.scene import Scene
from tribo.validation import InputError

# Rounding of a block's bars, whose places follow from those of centres of mass.
SAME = 1e-12
# Keys of a scene that are no part of its physics.
NO_PHYSICS = ("title", "duration", "output", "numerics")
# What a loop remembers in arrays whose lengths depend on the run, and which it reads accordingly.
OF_ANY_LENGTH = ("noise", "neighbours_index")


@dataclass(frozen=True, eq=False)
class Origin:
    """Where the runs of a scene begin, if not at its start."""

    state: State
    given: Scene  # as it was before it took heights and angles from the state
    same_scene: bool  # whether the state is of the same scene, whose accounts go on
    notes: tuple[str, ...] = ()

    @property
    def first(self) -> Samples | None:
        """The first sample of the run that goes on; None where a run begins."""
        earlier = self.same_scene and self.state.first.t[0] < self.state.t
        return self.state.first if earlier else None

    def place(self, loop: GeneralLoop, method: str, exactly: bool) -> None:
        """Let a loop begin from the state; `exactly` if its coordinates were not changed."""
        state = self.state
        loop.before = self.first
        if exactly and self.same_scene and method == state.method and "y" in state.memory:
            wanted = {name: array.shape for name, array in loop.memory().items()}
            _check_shapes("memory.", state.memory, wanted)
            fraction = loop.clocks["encounter_fraction"].copy()
            loop.restore(state.memory)
            loop.clocks["encounter_fraction"] = fraction
            loop.clocks["sample"] = 0
            return
        loop.clocks["t"] = state.t
        if self.same_scene:
            loop.state.s[loop.layout.places.s] = state.s
        if self.given.seed == state.scene.seed:
            loop.restore_noise(state.memory)


def digest_of(origin: Origin | None) -> str | None:
    """What tells the state where a run begins from others; None for the scene's own start."""
    return None if origin is None else origin.state.digest


def continued(given: Scene, state: State) -> tuple[Layout, Origin]:
    """The layout of a scene that starts from a state, which may be of a scene with other forces.

    Raises InputError if the state does not fit the scene, or another version made it.
    """
    _check_state(state)
    scene, notes = fitted(loaded(given), state)
    if scene.duration <= state.t:
        raise InputError(
            "duration", f"must be later than the state's t = {state.t:g}, got {scene.duration:g}"
        )
    old = plain_table(state.scene)
    new = plain_table(scene)
    before = {key: value for key, value in old.items() if key not in NO_PHYSICS}
    now = {key: value for key, value in new.items() if key not in NO_PHYSICS}
    # Works go on only where the same ones are kept.
    same_ledger = state.scene.output.ledger == scene.output.ledger
    same_scene = first_difference(before, now) is None and same_ledger
    layout = lay_out(scene)
    _check_arrays(layout, state, same_scene)
    start = fitted_start(layout, state)
    if same_scene:
        if not _is_whole(layout, state, start):
            problem = "must be a whole state, but its y is not that of its surfaces"
            raise InputError("start", problem)
        start = state.y.copy()
    anchors = state.anchors
    begun = state.begun
    if not same_scene:
        for surface in scene.surfaces:
            if surface.drive.gives_motion:
                raise InputError(
                    f"{surface.name}.drive",
                    "gives a motion, which cannot continue from a state of another scene; simulate "
                    "the scene from t = 0",
                )
        begun = _begun(layout, state, old, new)
        anchors = _anchors(replace(layout, begun=begun), state, old, new)
        if 0.0 < scene.output.run_in <= state.t:
            notes += (
                f"output.run_in = {scene.output.run_in:g} is before the state's t = {state.t:g}: "
                "averages take the whole run",
            )
    layout = replace(layout.begun_at(begun, anchors), start=start, beginning=state.t)
    return layout, Origin(state, given, same_scene, notes)


def _is_whole(layout: Layout, state: State, start: np.ndarray) -> bool:
    """Whether a state's y is that of its surfaces, in rounding of the places of blocks' bars."""
    surfaces = layout.surfaces
    if np.any((surfaces.block > 0) | (surfaces.elastic_block > 0) | (surfaces.tilting > 0)):
        return np.allclose(state.y, start, rtol=SAME, atol=SAME * float(np.max(np.abs(start))))
    return np.array_equal(state.y, start)


def _check_state(state: object) -> None:
    """Raise InputError unless a run of this version ended in a state."""
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


def _check_arrays(layout: Layout, state: State, same_scene: bool) -> None:
    """Raise InputError unless a state has the numbers of its scene, and those that go on here."""
    surfaces = layout.scene.surfaces
    moved = len(surfaces) + len(state.scene.fields)
    wanted: dict[str, tuple[int, ...]] = dict.fromkeys(("anchors", "phases"), (moved, 2))
    wanted["begun"] = moved, len(BEGUN)
    for surface in surfaces:
        for name in (*MOTIONS, *MOTIONS.values()):
            wanted[f"surface_{name}_{surface.name}"] = (surface.count,)
        sizes = [surface.bath.masses.size] * 2 + [surface.bath.inertias.size]
        for pair, size in zip(OF_BATHS.items(), sizes if surface.bath else (), strict=False):
            for name in pair:
                wanted[f"bath_{name}_{surface.name}"] = surface.count, size
    if same_scene:
        if state.y.shape != layout.start.shape:
            raise InputError("start", "must be a state of this scene, but has other coordinates")
        wanted["s"] = (layout.accounts,)
        first = Samples.at_zero(layout).arrays()
        del first["baths"]  # which depends on the series that are asked for
        wanted |= {f"first_{name}": array.shape for name, array in first.items()}
    _check_shapes("", state.arrays(), wanted)


def _check_shapes(
    part: str, arrays: Mapping[str, np.ndarray], wanted: Mapping[str, tuple[int, ...]]
) -> None:
    """Raise InputError about an array of a state that is missing, or has another shape."""
    for name, shape in wanted.items():
        found = np.shape(arrays[name]) if name in arrays else None
        if found is None or (found != shape and name not in OF_ANY_LENGTH):
            other = "is missing" if found is None else f"has the shape {found} in place of {shape}"
            raise InputError("start", f"must be a whole state, but its {part}{name} {other}")


def _anchors(layout: Layout, state: State, old: dict[str, Any], new: dict[str, Any]) -> np.ndarray:
    """Displacements at t = 0 of pulling stages and fields that go on from their places.

    Those that the state's scene lacks are at rest places when the run begins.
    """
    before = {surface.name: surface.drive.stage for surface in state.scene.surfaces}
    places = list(before)
    # The place of each in the state, and whether its speed is the same.
    known: list[tuple[int | None, bool]] = []
    for surface in layout.scene.surfaces:
        stage = surface.drive.stage
        other = before[surface.name]
        if stage is None or other is None:
            known.append((None, False))
        else:
            known.append((places.index(surface.name), stage.moves_as(other)))
    ones = old.get("field", [])
    others = new.get("field", [])
    found = _known_fields(ones, others, state.phases[len(places) :])
    for place, field in zip(found, others, strict=True):
        same = place is not None and ones[place]["velocity"] == field["velocity"]
        known.append((None if place is None else len(places) + place, same))
    anchors = -layout.moved(state.t)
    for k, (place, same) in enumerate(known):
        if place is not None:
            anchors[k] = state.anchors[place] if same else state.phases[place] + anchors[k]
    return anchors


def _known_fields(
    ones: list[dict[str, Any]], others: list[dict[str, Any]], phases: np.ndarray
) -> list[int | None]:
    """The place of each of the other fields among the first ones; None for new fields.

    Raises InputError where several with different displacements could be the same one.
    """
    found: list[int | None] = [None] * len(others)
    for same in (_is_same, _is_same_but_for_velocity, _is_of_same_kind):
        for k, other in enumerate(others):
            if found[k] is not None:
                continue
            like = [i for i, one in enumerate(ones) if i not in found and same(one, other)]
            if like and np.ptp(phases[like], axis=0).any():
                raise InputError(
                    f"field[{k}]",
                    "may continue several fields of the state that have moved apart; change the "
                    "fields of the state one at a time",
                )
            found[k] = like[0] if like else None
    return found


def _is_same(one: dict[str, Any], other: dict[str, Any]) -> bool:
    return one == other


def _is_same_but_for_velocity(one: dict[str, Any], other: dict[str, Any]) -> bool:
    return one | {"velocity": None} == other | {"velocity": None}


def _is_of_same_kind(one: dict[str, Any], other: dict[str, Any]) -> bool:
    """Whether fields differ in numbers of their potentials, and in velocities, alone."""
    return all(one[key] == other[key] for key in ("kind", "on", "origin"))


def _begun(layout: Layout, state: State, old: dict[str, Any], new: dict[str, Any]) -> np.ndarray:
    """When the own times of drives, forces on ends, schedules and fields were zero.

    Those that are the same as in the state's scene go on; others begin with the run.
    """
    begun = np.full(layout.begun.shape, state.t)
    before = {table["name"]: (k, table) for k, table in enumerate(old["surface"])}
    for k, table in enumerate(new["surface"]):
        place, other = before[table["name"]]
        theirs = _timed(other)
        for column, mine in _timed(table).items():
            if mine == theirs[column]:
                begun[k, BEGUN.index(column)] = state.begun[place, BEGUN.index(column)]
    fields_before = old.get("field", [])
    fields = new.get("field", [])
    first_before = len(old["surface"])
    first = len(new["surface"])
    at, modulated = BEGUN.index("field"), BEGUN.index("modulation")
    found = _known_fields(fields_before, fields, state.phases[first_before:])
    for k, (known, field) in enumerate(zip(found, fields, strict=True)):
        if known is None:
            continue
        since = state.begun[first_before + known]
        if _is_same_but_for_velocity(fields_before[known], field):
            begun[first + k, at] = since[at]
        if fields_before[known].get("modulation") == field.get("modulation"):
            begun[first + k, modulated] = since[modulated]
    return begun


def _timed(surface: dict[str, Any]) -> dict[str, object]:
    """What depends on time in the table of a surface, by the names in `BEGUN`."""
    drive = surface["drive"]
    pushes = zip(drive["force"], drive["rate"], strict=True) if drive["kind"] == Pushed.kind else ()
    push_x, push_y = tuple(pushes) or (None, None)
    given = surface.get("langevin", [])
    reservoirs = given if isinstance(given, list) else [given]
    warm = {each["on"]: each["temperature"] for each in reservoirs}
    return {
        "drive": {k: v for k, v in drive.items() if k != "load"},
        "ends": surface["bars"],
        "stage": [drive.get(key) for key in ("kind", "speed", "position")],
        "load": drive.get("load"),
        "heat": warm.get("bar"),
        "swing_heat": warm.get("swing"),
        "push_x": push_x,
        "push_y": push_y,
    }
