"""What a reader of a result should know about its scene and its method."""

from __future__ import annotations

import numpy as np

from tribo.integrators.methods import Method
from tribo.kernels.contact import NEGLIGIBLE
from tribo.model.scene import Scene
from tribo.model.spectrum import valid_until
from tribo.potentials.tables import as_table
from tribo.run.integrate import Integration
from tribo.run.layout import Layout
from tribo.validation import short_repr


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


def passage_notes(layout: Layout, run: Integration) -> tuple[str, ...]:
    """A note on encounters that steps of a run with noise have passed."""
    count, *bobs = run.passages
    if count == 0:
        return ()
    one, other = (asperite_name(layout, bob) for bob in bobs)
    return (
        f"in {count} steps bobs passed one another within the step, {one} and {other} last; "
        f"their potential energy is below {NEGLIGIBLE:g} k_B T there and does not affect the "
        "motion, but works of their contact are inaccurate; a smaller step resolves them",
    )


def asperite_name(layout: Layout, index: int) -> str:
    """An asperite by its surface and its place there, from 0 on."""
    for name, part in layout.parts.items():
        if part.start <= index < part.stop:
            return f'asperite {index - part.start} of "{name}"'
    raise IndexError(index)


def _on_potentials(scene: Scene, method: Method) -> list[str]:
    """Potentials that are less smooth than the method needs them to be."""
    notes = []
    for interaction in scene.interactions:
        smoothness = interaction.potential.smoothness()
        name = short_repr(as_table(interaction.potential)["potential"])
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
        until = valid_until(surface.bath.spectrum, float(np.min(each["mass"])), frequency)
        if until < scene.duration:
            notes.append(
                f'the bath of "{surface.name}" stands for a continuum until t = {until:.4g}; the '
                f"run lasts {scene.duration:g}, so give it more oscillators"
            )
    return notes
