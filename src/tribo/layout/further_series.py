"""The series that a scene reports on request: forces and energies."""

from __future__ import annotations

from tribo.layout.contact_distance import has_contact_distance
from tribo.model.scene import Scene
from tribo.model.surface import Surface

ALWAYS = ("f1", "f2", "fL", "fR")


def force_names(scene: Scene, surface: Surface) -> list[str]:
    """The forces that act on a surface's asperites, and what is said of the surface as a whole.

    A force with noise is known by the impulses of each asperite, which only their ledger has.
    """
    present = {
        "f_within": scene.has_contact_within(surface),
        "f_field": scene.has_field(surface),
        "f_spring": bool(surface.springs),
        "f_bath": surface.bath.masses.size > 0,
        "f_T": surface.bar_reservoir is not None,
    }
    unknown = surface.noisy_forces if scene.output.ledger != "asperites" else ()
    names = [*ALWAYS, *(name for name, acts in present.items() if acts)]
    names = [name for name in names if name not in unknown]
    sums = ["friction_force", *(["contact_force", "field_force"] if present["f_field"] else [])]
    sums += ["pull_force"] * ("f2" in names)
    sums += ["time_without_contact"] * has_contact_distance(scene, surface)
    return [*sums, *(f"{name}_{axis}" for name in names for axis in "xy")]


def energy_names(scene: Scene, surface: Surface) -> list[str]:
    """The energies of a surface and of its asperites."""
    has_bath = surface.bath.masses.size + surface.bath.inertias.size > 0
    present = {
        "e_springs": bool(surface.springs),
        "e_within": scene.has_contact_within(surface),
        **dict.fromkeys(("k_bath", "e_bath", "heat_bath"), has_bath),
    }
    always = ("k_trans", "k_swing", "k_bar", "e_torsion")
    return [*always, *(name for name, there in present.items() if there)]


def system_names(scene: Scene) -> list[str]:
    """The energies of the system that the scene's output asks for."""
    return ["field_energy"] if "energies" in scene.output.series and scene.fields else []


def further_series(scene: Scene, surface: Surface) -> frozenset[str]:
    """The names of the series of a surface that the scene's output asks for."""
    asked = scene.output.series
    forces = force_names(scene, surface) if "forces" in asked else []
    energies = energy_names(scene, surface) if "energies" in asked else []
    return frozenset((*forces, *energies))
