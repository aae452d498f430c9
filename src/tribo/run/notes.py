"""What a reader of a result should know about its scene and its method."""

from __future__ import annotations

import numpy as np

from tribo.integrators.methods import Method
from tribo.model.scene import Scene
from tribo.model.spectrum import believed_until
from tribo.potentials.tables import as_table
from tribo.run.layout import Layout
from tribo.validation import shown


def scene_notes(scene: Scene, method: Method) -> tuple[str, ...]:
    """Notes on potentials that are too rough for the method, and on baths of a continuum."""
    return (*_on_potentials(scene, method), *_on_baths(scene))


def calculator_notes(layout: Layout) -> tuple[str, ...]:
    """Notes on errors that ASE calculators raised in the last run."""
    return tuple(
        f"the calculator raised {type(call.error).__name__}: {call.error}"
        for call in layout.calculator_calls
        if call.error is not None
    )


def _on_potentials(scene: Scene, method: Method) -> list[str]:
    """Potentials that are less smooth than the method needs them to be."""
    notes = []
    for interaction in scene.interactions:
        smoothness = interaction.potential.smoothness()
        name = shown(as_table(interaction.potential)["potential"])
        if smoothness < 0:
            notes.append(
                f"the energy of {name} jumps, which no force accounts for: the ledger does not "
                "close where bobs cross the jump"
            )
        elif smoothness < method.smoothness:
            notes.append(
                f"{name} has {smoothness} continuous derivatives; {method.name} needs "
                f"{method.smoothness} for errors of order {method.order}"
            )
    return notes


def _on_baths(scene: Scene) -> list[str]:
    """Baths that represent a continuum for less than the duration of the run."""
    notes = []
    for surface in scene.surfaces:
        if surface.bath.spectrum is None:
            continue
        each = surface.asperite.for_each(surface.count)
        frequency = float(np.max(np.sqrt(each["kappa"] / each["inertia"])))
        until = believed_until(surface.bath.spectrum, float(np.min(each["mass"])), frequency)
        if until < scene.duration:
            notes.append(
                f'the bath of "{surface.name}" stands for a continuum until t = {until:.4g}; the '
                f"run lasts {scene.duration:g}, so give it more oscillators"
            )
    return notes
