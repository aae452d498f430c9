"""Why each effect is present in a scene or absent: by which key of the scene."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from tribo.model.drives import Custom, DrivenBars, Ends, Forced, Pulled, Pushed
from tribo.model.effects import Effect
from tribo.model.interaction import Interaction
from tribo.model.scene import Scene
from tribo.model.surface import Surface
from tribo.potentials.from_ase import Live
from tribo.potentials.tables import as_table
from tribo.validation import short_repr

# Why an effect is absent.
ABSENT = {
    Effect.CONTACT: "no interaction acts between two surfaces",
    Effect.SWING: "every asperite is rigid",
    Effect.SLIDING: "each drive cancels all forces on its centres of mass",
    Effect.TURNING_BARS: "all bars are clamped",
    Effect.CLAMPED_ENDS: "no clamped bar holds a torsion spring",
    Effect.PULL: 'no drive is "pulled"',
    Effect.PUSH: 'no drive is "push"',
    Effect.LOAD: "no drive has a load",
    Effect.OWN_DRIVE: "no drive is a plug-in",
    Effect.OWN_ENDS: "no bars have a plug-in",
    Effect.SPRINGS: "no surface has springs",
    Effect.BATH: "no surface has a bath of point oscillators",
    Effect.TORSIONAL_BATH: "no surface has a bath of torsional oscillators",
    Effect.RIGID: "no asperites have kappa = inf",
    Effect.DRIVEN_BARS: 'no drive is "bars"',
    Effect.LANGEVIN: "no surface has langevin on its bars",
    Effect.SWING_LANGEVIN: 'no surface has langevin with on = "swing"',
    Effect.FIELD: "the scene has no field",
    Effect.CALCULATOR: "no interaction is an ASE calculator",
    Effect.CONTACT_WITHIN: "no interaction is between a surface and itself",
    Effect.CUTOFF: "no interaction has a cutoff",
    Effect.PERIODIC: "the scene has no periods",
}

# Most keys that a reason names.
MOST_NAMED = 3

Named = Iterator[str]  # keys of a scene with their values


def why_present(scene: Scene, effect: Effect) -> str:
    """The keys of the scene that call for an effect."""
    find = PRESENT.get(effect)
    found = list(find(scene)) if find is not None else []
    if not found:
        return effect.description
    more = f" and {len(found) - MOST_NAMED} more" if len(found) > MOST_NAMED else ""
    return "; ".join(found[:MOST_NAMED]) + more


def why_absent(effect: Effect) -> str:
    """Why an effect is absent."""
    return ABSENT.get(effect, "no key of the scene calls for it")


def _surfaces(key: str, value: Callable[[Surface], object | None]) -> Callable[[Scene], Named]:
    """Finds the surfaces whose `value` is not None, and names it."""

    def find(scene: Scene) -> Named:
        for i, surface in enumerate(scene.surfaces):
            found = value(surface)
            if found is not None:
                yield f"surface[{i}].{key} = {found}"

    return find


def _reservoirs(on: str) -> Callable[[Scene], Named]:
    """Finds the reservoirs on "bar" or "swing"; of two, by its place, which is 0 for the bars."""

    def find(scene: Scene) -> Named:
        for i, surface in enumerate(scene.surfaces):
            for j, reservoir in enumerate(surface.reservoirs):
                if reservoir.on == on:
                    place = f"[{j}]" if len(surface.reservoirs) == 2 else ""
                    yield f"surface[{i}].langevin{place}.gamma = {reservoir.gamma}"

    return find


def _interactions(wanted: Callable[[Scene, Interaction], bool]) -> Callable[[Scene], Named]:
    """Finds the interactions that are wanted."""

    def find(scene: Scene) -> Named:
        for i, item in enumerate(scene.interactions):
            if wanted(scene, item):
                yield f"interaction[{i}].potential = {potential_name(item)}"

    return find


def potential_name(item: Interaction) -> str:
    """The name of a potential in a scene file."""
    if isinstance(item.potential, Live):
        return type(item.potential.calculator).__name__
    name = as_table(item.potential)["potential"]
    return f'"{name}"' if isinstance(name, str) else short_repr(name)


def _swings(scene: Scene) -> Named:
    finite = [i for i, surface in enumerate(scene.surfaces) if not surface.asperite.is_rigid]
    if len(finite) == len(scene.surfaces):
        yield "every asperite"
    else:
        yield from (f"surface[{i}].asperite.kappa is finite" for i in finite)


def _slides(scene: Scene) -> Named:
    for i, surface in enumerate(scene.surfaces):
        if not (scene.slides_along_x(surface) or scene.slides_along_y(surface)):
            continue
        if not isinstance(surface.drive, Forced):
            yield f'surface[{i}].drive is not "forced"'
        elif scene.has_uncancelled_forces(surface):
            yield f"surface[{i}] has forces that its drive does not cancel"
        else:
            yield f"surface[{i}].drive.load = {surface.drive.load:g}"


def _clamped(surface: Surface) -> str | None:
    held = surface.bars == "clamped" and np.any(np.asarray(surface.asperite.kappa) > 0.0)
    return '"clamped"' if held else None


def _turning(surface: Surface) -> str | None:
    return None if surface.bars == "clamped" else _spelled(surface.bars)


def _spelled(value: object) -> str:
    """A name, or the class of a plug-in."""
    return f'"{value}"' if isinstance(value, str) else type(value).__name__


def _count(number: int, thing: str) -> str | None:
    return f"{number} {thing}{'s' if number > 1 else ''}" if number else None


def _fields(scene: Scene) -> Named:
    for i, item in enumerate(scene.fields):
        yield f"field[{i}].kind = {type(item.potential).__name__}"


def _periods(scene: Scene) -> Named:
    for name in ("x", "z"):
        length = getattr(scene.periodic, name)
        if length is not None:
            yield f"periodic.{name} = {length:g}"


def _cutoffs(scene: Scene) -> Named:
    for i, item in enumerate(scene.interactions):
        reach = item.potential.range()
        if np.isfinite(reach):
            yield f"interaction[{i}] ends at {reach:g}"


# Finds the keys that call for an effect.
PRESENT: dict[Effect, Callable[[Scene], Named]] = {
    Effect.CONTACT: _interactions(
        lambda scene, item: any(one != other for one, other in scene.pairs(item))
    ),
    Effect.SWING: _swings,
    Effect.SLIDING: _slides,
    Effect.TURNING_BARS: _surfaces("bars", _turning),
    Effect.CLAMPED_ENDS: _surfaces("bars", _clamped),
    Effect.PULL: _surfaces(
        "drive.stiffness", lambda s: s.drive.stiffness if isinstance(s.drive, Pulled) else None
    ),
    Effect.PUSH: _surfaces(
        "drive.force", lambda s: list(s.drive.force) if isinstance(s.drive, Pushed) else None
    ),
    Effect.LOAD: _surfaces("drive.load", lambda s: s.drive.load),
    Effect.OWN_DRIVE: _surfaces(
        "drive", lambda s: _spelled(s.drive.force) if isinstance(s.drive, Custom) else None
    ),
    Effect.OWN_ENDS: _surfaces(
        "bars", lambda s: _spelled(s.bars.force) if isinstance(s.bars, Ends) else None
    ),
    Effect.SPRINGS: _surfaces(
        "springs.stiffness", lambda s: s.springs.stiffness if s.springs else None
    ),
    Effect.BATH: _surfaces("bath", lambda s: _count(s.bath.masses.size, "point oscillator")),
    Effect.TORSIONAL_BATH: _surfaces(
        "bath",
        lambda s: _count(s.bath.inertias.size, "torsional oscillator"),
    ),
    Effect.RIGID: _surfaces("asperite.kappa", lambda s: "inf" if s.asperite.is_rigid else None),
    Effect.DRIVEN_BARS: _surfaces(
        "drive", lambda s: '"bars"' if isinstance(s.drive, DrivenBars) else None
    ),
    Effect.LANGEVIN: _reservoirs("bar"),
    Effect.SWING_LANGEVIN: _reservoirs("swing"),
    Effect.FIELD: _fields,
    Effect.CALCULATOR: _interactions(lambda scene, item: isinstance(item.potential, Live)),
    Effect.CONTACT_WITHIN: _interactions(
        lambda scene, item: any(one == other for one, other in scene.pairs(item))
    ),
    Effect.CUTOFF: _cutoffs,
    Effect.PERIODIC: _periods,
}
