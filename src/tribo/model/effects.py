"""Effects: which keys of a scene call for each, and what a scene without it lacks."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from enum import StrEnum
from typing import Any

import numpy as np

from tribo.model.drives import Moved
from tribo.model.interaction import Interaction
from tribo.model.schedule import Schedule
from tribo.model.surface import Surface
from tribo.potentials.tables import as_table
from tribo.validation import short_repr


class Effect(StrEnum):
    """Something that a scene can call for; `description` says what it is."""

    description: str

    CONTACT = "contact", "forces between the bobs of different surfaces"
    SWING = "swing", "pendulums on torsion springs"
    SLIDING = "sliding", "centres of mass that can leave their uniform motion"
    RIGID = "rigid asperites", "asperites whose pendulums are fixed to clamped bars"
    BLOCK = "block", "a surface whose bars are one rigid body"
    BLOCK_OF_PENDULUMS = (
        "block of pendulums",
        "pendulums that swing on the bars of one rigid body, and accelerate it",
    )
    MOVED_PENDULUMS = "moved pendulums", "pendulums that swing on bars with a given motion"
    TILTING_BLOCK = "tilting block", "a block that turns about z"
    DAMPED_BLOCK = "damped block", "dampers between a block and its stage"
    DRIVEN_BARS = "driven bars", "bars that a constraint moves uniformly, or holds"
    TURNING_BARS = "turning bars", "bars that rotate freely"
    CLAMPED_ENDS = (
        "clamped ends",
        "forces on the ends of clamped bars that have a torsion spring to hold",
    )
    PULL = "pull", "springs to a moving stage"
    PUSH = "push", "a force on each bar that is constant, or grows"
    SCHEDULE = "schedule", "a number that changes with time: speed, load, push, temperature, field"
    LOAD = "load", "a force that presses the surfaces together"
    OWN_DRIVE = "own drive", "forces f2 of the user's own"
    OWN_ENDS = "own ends", "forces of the user's own on the ends of bars"
    SPRINGS = "springs", "lattice springs between neighbouring bars"
    ELASTIC = "elastic body", "bars that stand on an elastic half-space or layer"
    BATH = "bath", "oscillators on every bar"
    TORSIONAL_BATH = "torsional bath", "torsional oscillators on every bar"
    LANGEVIN = "langevin", "damping and noise at every bar"
    SWING_LANGEVIN = "swing langevin", "damping and noise on every pendulum"
    FIELD = "field", "external fields on bobs"
    CALCULATOR = "calculator", "contact computed by an ASE calculator, at its own cost"
    CONTACT_WITHIN = "contact within", "forces among the bobs of one surface"
    CUTOFF = (
        "cutoff",
        "interactions that end at a distance, by neighbour lists where there are many bobs",
    )
    PERIODIC = "periodic", "nearest images along x or z"

    def __new__(cls, name: str, description: str) -> Effect:
        effect = str.__new__(cls, name)
        effect._value_ = name
        effect.description = description
        return effect


# Yields the keys of a scene that call for an effect, with their values.
Finder = Callable[[Any], Iterator[str]]
# Most keys that a reason names.
MOST_NAMED = 3


def effects_of(scene: Any) -> frozenset[Effect]:
    """The effects that a scene calls for."""
    return frozenset([effect for effect, (_, find) in EFFECTS.items() if any(find(scene))])


def reason_for(scene: Any, effect: Effect) -> str:
    """The first keys of a scene that call for an effect; empty if the scene does not have it."""
    keys = list(EFFECTS[effect][1](scene))
    more = f" and {len(keys) - MOST_NAMED} more" if len(keys) > MOST_NAMED else ""
    return "; ".join(keys[:MOST_NAMED]) + more


def potential_name(item: Interaction) -> str:
    if item.calculator is not None:
        return type(item.calculator.calculator).__name__
    return f'"{as_table(item.potential)["potential"]}"'


def _class(value: object) -> str:
    return f'"{value}"' if isinstance(value, str) else type(value).__name__


def _surfaces(key: str, value: Callable[[Surface], object | None]) -> Finder:
    """Finds the surfaces whose `value` is not None."""
    return lambda scene: (
        f"surface[{i}].{key} = {found}"
        for i, surface in enumerate(scene.surfaces)
        if (found := value(surface)) is not None
    )


def _drives(effect: Effect) -> Finder:
    """Finds the drives that declare an effect."""
    return lambda scene: (
        f"surface[{i}].drive{surface.drive.cause}"
        for i, surface in enumerate(scene.surfaces)
        if surface.drive.effect == effect
    )


def _reservoirs(on: str) -> Finder:
    """Finds the reservoirs on "bar" or "swing"; of two, by its place, which is 0 for the bars."""

    def found(scene: Any) -> Iterator[str]:
        for i, surface in enumerate(scene.surfaces):
            for j, reservoir in enumerate(surface.reservoirs):
                if reservoir.on == on:
                    place = f"[{j}]" if len(surface.reservoirs) == 2 else ""
                    yield f"surface[{i}].langevin{place}.gamma = {short_repr(reservoir.gamma)}"

    return found


def _interactions(wanted: Callable[[Any, Interaction], bool]) -> Finder:
    return lambda scene: (
        f"interaction[{i}].potential = {potential_name(item)}"
        for i, item in enumerate(scene.interactions)
        if wanted(scene, item)
    )


def _swings(scene: Any) -> Iterator[str]:
    finite = [i for i, surface in enumerate(scene.surfaces) if not surface.asperite.is_rigid]
    if len(finite) == len(scene.surfaces):
        yield "every asperite"
    else:
        yield from (f"surface[{i}].asperite.kappa is finite" for i in finite)


def _slides(scene: Any) -> Iterator[str]:
    """Reasons why surfaces can leave their uniform motion, one for each that can."""
    for i, surface in enumerate(scene.surfaces):
        if not (scene.slides_along_x(surface) or scene.slides_along_y(surface)):
            continue
        drive = surface.drive
        if not drive.cancels_x or (drive.load is None and not drive.cancels_y):
            yield f'surface[{i}].drive is not "forced"'
        elif scene.has_uncancelled_forces(surface):
            yield f"surface[{i}] has forces that its drive does not cancel"
        elif surface.is_block_of_pendulums:
            yield f"surface[{i}].drive.block = true, and its pendulums swing"
        else:
            yield f"surface[{i}].drive.load = {drive.load:g}"


def _clamped(surface: Surface) -> str | None:
    held = not surface.turns_bars and np.any(np.asarray(surface.asperite.kappa) > 0.0)
    return '"clamped"' if held else None


def _schedules(scene: Any) -> Iterator[str]:
    """Numbers that follow schedules."""
    for i, surface in enumerate(scene.surfaces):
        drive = surface.drive
        numbers: dict[str, object] = {"drive.load": drive.load}
        if drive.stage is not None:
            numbers |= {"drive.speed": drive.stage.speed, "drive.position": drive.stage.position}
        if drive.ramp is not None:
            numbers |= {f"drive.force[{k}]": each for k, each in enumerate(drive.ramp.force)}
        if isinstance(drive, Moved):
            numbers |= {f"drive.speed[{k}]": each for k, each in enumerate(drive.speed)}
        for each in surface.reservoirs:
            numbers[f"langevin.temperature (on {each.on})"] = each.temperature
        for key, number in numbers.items():
            if isinstance(number, Schedule):
                yield f"surface[{i}].{key} = {number}"
    for i, item in enumerate(scene.fields):
        if item.modulation is not None:
            yield f"field[{i}].modulation = {item.modulation}"


def _count(number: int, thing: str) -> str | None:
    return f"{number} {thing}{'s' if number > 1 else ''}" if number else None


# Why an effect is absent, and what finds the keys that call for it.
EFFECTS: dict[Effect, tuple[str, Finder]] = {
    Effect.CONTACT: (
        "no interaction acts between two surfaces",
        _interactions(lambda scene, item: any(i != j for i, j in scene.pairs(item))),
    ),
    Effect.SWING: ("every asperite is rigid", _swings),
    Effect.SLIDING: ("each drive cancels all forces on its centres of mass", _slides),
    Effect.TURNING_BARS: (
        "all bars are clamped",
        _surfaces("bars", lambda s: None if s.bars == "clamped" else _class(s.bars)),
    ),
    Effect.CLAMPED_ENDS: ("no clamped bar holds a torsion spring", _surfaces("bars", _clamped)),
    Effect.PULL: ('no drive is "pulled"', _drives(Effect.PULL)),
    Effect.PUSH: ('no drive is "push"', _drives(Effect.PUSH)),
    Effect.SCHEDULE: ("no number follows a schedule", _schedules),
    Effect.LOAD: ("no drive has a load", _surfaces("drive.load", lambda s: s.drive.load)),
    Effect.OWN_DRIVE: ("no drive is a plug-in", _drives(Effect.OWN_DRIVE)),
    Effect.OWN_ENDS: (
        "no bars have a plug-in",
        _surfaces("bars", lambda s: s.plugin_at_ends and type(s.plugin_at_ends).__name__),
    ),
    Effect.SPRINGS: (
        "no surface has springs",
        _surfaces("springs.stiffness", lambda s: s.springs.stiffness if s.springs else None),
    ),
    Effect.ELASTIC: (
        "no surface has an elastic body",
        _surfaces("elastic.modulus", lambda s: s.elastic and s.elastic.modulus),
    ),
    Effect.BATH: (
        "no surface has a bath of point oscillators",
        _surfaces("bath", lambda s: _count(s.bath.masses.size, "point oscillator")),
    ),
    Effect.TORSIONAL_BATH: (
        "no surface has a bath of torsional oscillators",
        _surfaces("bath", lambda s: _count(s.bath.inertias.size, "torsional oscillator")),
    ),
    Effect.RIGID: (
        "no asperites have kappa = inf",
        _surfaces("asperite.kappa", lambda s: "inf" if s.asperite.is_rigid else None),
    ),
    Effect.BLOCK: (
        "no drive has block = true",
        _surfaces("drive.block", lambda s: "true" if s.drive.block else None),
    ),
    Effect.BLOCK_OF_PENDULUMS: (
        "no pendulums swing on a block",
        _surfaces("asperite.kappa", lambda s: "finite" if s.is_block_of_pendulums else None),
    ),
    Effect.MOVED_PENDULUMS: (
        'no drive with pendulums is "moved"',
        _surfaces("asperite.kappa", lambda s: "finite" if s.has_moved_pendulums else None),
    ),
    Effect.TILTING_BLOCK: (
        'no drive has tilt = "free"',
        _surfaces("drive.tilt", lambda s: '"free"' if s.tilts else None),
    ),
    Effect.DAMPED_BLOCK: (
        "no block has dampers",
        _surfaces("drive.damping", lambda s: s.drive.damps or None),
    ),
    Effect.DRIVEN_BARS: ('no drive is "bars"', _drives(Effect.DRIVEN_BARS)),
    Effect.LANGEVIN: ("no surface has langevin on its bars", _reservoirs("bar")),
    Effect.SWING_LANGEVIN: ('no surface has langevin with on = "swing"', _reservoirs("swing")),
    Effect.FIELD: (
        "the scene has no field",
        lambda scene: (
            f"field[{i}].kind = {type(item.potential).__name__}"
            for i, item in enumerate(scene.fields)
        ),
    ),
    Effect.CALCULATOR: (
        "no interaction is an ASE calculator",
        _interactions(lambda scene, item: item.calculator is not None),
    ),
    Effect.CONTACT_WITHIN: (
        "no interaction is between a surface and itself",
        _interactions(lambda scene, item: any(i == j for i, j in scene.pairs(item))),
    ),
    Effect.CUTOFF: (
        "no interaction has a cutoff",
        lambda scene: (
            f"interaction[{i}] ends at {item.potential.range():g}"
            for i, item in enumerate(scene.interactions)
            if np.isfinite(item.potential.range())
        ),
    ),
    Effect.PERIODIC: (
        "the scene has no periods",
        lambda scene: (
            f"periodic.{axis} = {getattr(scene.periodic, axis):g}"
            for axis in ("x", "z")
            if getattr(scene.periodic, axis) is not None
        ),
    ),
}
