"""Parameters of a scene by dotted keys, as "upper.asperite.kappa" and "interaction.strength"."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from tribo.model.interaction import Interaction
from tribo.model.scene import Scene
from tribo.model.surface import Surface
from tribo.validation import inside

# The parts of a surface whose numbers can be varied.
PARTS = ("asperite", "drive", "langevin", "bath")
# The name of the only interaction of a scene.
INTERACTION = "interaction"


def is_parameter(scene: Scene, key: str) -> bool:
    """Whether a key names a number of a scene: of a part of a surface, or of its interaction."""
    name, _, parameter = key.rpartition(".")
    if name == INTERACTION:
        known = [item.potential for item in scene.interactions]
        return len(known) == 1 and _is_number(known[0]._asdict().get(parameter))
    surface, _, part = name.rpartition(".")
    found = next((s for s in scene.surfaces if s.name == surface), None)
    return part in PARTS and _is_number(getattr(getattr(found, part, None), parameter, None))


def with_parameters(scene: Scene, values: Mapping[str, float]) -> Scene:
    """The scene with other numbers, by their keys.  Raises InputError."""
    surfaces = tuple(_changed_surface(surface, values) for surface in scene.surfaces)
    start, interactions = f"{INTERACTION}.", scene.interactions
    own = {key.removeprefix(start): v for key, v in values.items() if key.startswith(start)}
    if own:
        interactions = (_changed_interaction(interactions[0], own),)
    return replace(scene, surfaces=surfaces, interactions=interactions)


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _changed_surface(surface: Surface, values: Mapping[str, float]) -> Surface:
    for part in PARTS:
        start = f"{surface.name}.{part}."
        own = {key.removeprefix(start): v for key, v in values.items() if key.startswith(start)}
        if own:
            with inside(start.removesuffix(".")):
                surface = replace(surface, **{part: replace(getattr(surface, part), **own)})
    return surface


def _changed_interaction(interaction: Interaction, own: Mapping[str, float]) -> Interaction:
    potential = interaction.potential
    with inside(INTERACTION):
        return replace(interaction, potential=type(potential)(**(potential._asdict() | dict(own))))
