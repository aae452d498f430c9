"""A scene: the physics of a run, and nothing numerical."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tribo.checks import POSITIVE, inside, number, vector, whole
from tribo.drives import Forced, Free, Pulled
from tribo.errors import InputError
from tribo.potentials.plugin import as_potential
from tribo.surface import Surface

EFFECTS = {
    "contact": "forces between the bobs of different surfaces",
    "swing": "pendulums on torsion springs",
    "sliding": "centres of mass that can leave their uniform motion",
    "turning bars": "bars that are free to turn",
    "clamped ends": "forces on the ends of clamped bars that have a torsion spring to hold",
    "pull": "springs to a moving stage",
    "load": "a force that presses the surfaces together",
}


@dataclass(frozen=True)
class Interaction:
    """A potential, and the two surfaces whose bobs it acts between (None: every two)."""

    potential: Any
    between: tuple[str, str] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "potential", as_potential(self.potential))


@dataclass(frozen=True)
class Output:
    """When to record: evenly spaced samples, both ends included, or given times."""

    samples: int = 401
    times: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        whole("samples", self.samples, 2)
        if self.times is not None:
            times = vector("times", self.times)
            if times.size == 0 or np.any(np.diff(times) <= 0.0) or times[0] < 0.0:
                raise InputError("times", "must increase from 0 or later")
            object.__setattr__(self, "times", tuple(times.tolist()))


@dataclass(frozen=True)
class Numerics:
    """How to compute, as a file may say it; :func:`tribo.simulate` has the last word."""

    accuracy: float | None = None
    method: str | None = None
    step: float | None = None

    def __post_init__(self) -> None:
        if self.accuracy is not None:
            check_accuracy(self.accuracy)
        if self.step is not None:
            number("step", self.step, POSITIVE)


def check_accuracy(value: Any) -> float:
    """An accuracy that double precision can hold out."""
    accuracy = number("accuracy", value, POSITIVE)
    if not 1e-13 <= accuracy <= 0.1:
        raise InputError("accuracy", f"must be from 1e-13 to 0.1, got {value}")
    return accuracy


@dataclass(frozen=True, eq=False)
class Scene:
    """Surfaces, what acts between them, and for how long.

    `output` and `numerics` travel with the file that a scene came from, not with the physics.
    """

    surfaces: tuple[Surface, ...]
    interactions: tuple[Interaction, ...]
    duration: float
    title: str = ""
    seed: int = 0
    output: Output = field(default_factory=Output)
    numerics: Numerics = field(default_factory=Numerics)

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "duration", number("duration", self.duration, POSITIVE))
        put(self, "seed", whole("seed", self.seed, 0))
        if not isinstance(self.title, str):
            raise InputError("title", f"must be text, got {self.title!r}")
        put(self, "surfaces", self._checked_surfaces())
        put(self, "interactions", self._checked_interactions())
        times = self.output.times
        if times is not None and times[-1] > self.duration:
            raise InputError(
                "output.times", f"must end by the duration {self.duration}, got {times[-1]}"
            )

    def _checked_surfaces(self) -> tuple[Surface, ...]:
        if not isinstance(self.surfaces, (list, tuple)) or not self.surfaces:
            raise InputError("surface", "is missing; a scene has at least one surface")
        for i, surface in enumerate(self.surfaces):
            if not isinstance(surface, Surface):
                raise InputError(f"surface[{i}]", f"must be a tribo.Surface, got {surface!r}")
            if surface.name in [s.name for s in self.surfaces[:i]]:
                raise InputError(f"surface[{i}].name", f'"{surface.name}" is taken; give another')
        return tuple(self.surfaces)

    def _checked_interactions(self) -> tuple[Interaction, ...]:
        value = self.interactions
        if isinstance(value, Interaction) or hasattr(value, "energy"):
            value = [value]  # type: ignore[list-item]
        if not isinstance(value, (list, tuple)):
            raise InputError("interaction", f"must be a potential or a list of them, got {value!r}")
        interactions = tuple(
            item if isinstance(item, Interaction) else Interaction(item) for item in value
        )
        names = [s.name for s in self.surfaces]
        for i, interaction in enumerate(interactions):
            with inside(f"interaction[{i}]"):
                for name in interaction.between or ():
                    if name not in names:
                        raise InputError("between", f'names no surface "{name}"; there are {names}')
                if interaction.between and interaction.between[0] == interaction.between[1]:
                    raise InputError("between", "must name two different surfaces")
        self._refuse_two_for_one_pair(interactions)
        return interactions

    def _refuse_two_for_one_pair(self, interactions: tuple[Interaction, ...]) -> None:
        seen: set[tuple[int, int]] = set()
        for i, interaction in enumerate(interactions):
            for pair in self.pairs(interaction):
                if pair in seen:
                    names = tuple(self.surfaces[k].name for k in pair)
                    raise InputError(
                        f"interaction[{i}].between",
                        f"{names} interact already; give each pair once",
                    )
                seen.add(pair)

    def pairs(self, interaction: Interaction) -> list[tuple[int, int]]:
        """Indices of the pairs of surfaces between which an interaction acts."""
        if interaction.between is None:
            return list(itertools.combinations(range(len(self.surfaces)), 2))
        names = [s.name for s in self.surfaces]
        one, other = sorted(names.index(name) for name in interaction.between)
        return [(one, other)]

    @property
    def count(self) -> int:
        """How many asperites there are."""
        return sum(surface.count for surface in self.surfaces)

    @property
    def effects(self) -> frozenset[str]:
        """The effects that the scene calls for, by their names in EFFECTS; no other is simulated."""
        present = {"swing"}
        if any(self.pairs(i) for i in self.interactions):
            present.add("contact")
        for s in self.surfaces:
            if not isinstance(s.drive, Forced) or s.drive.load is not None:
                present.add("sliding")
            if isinstance(s.drive, Pulled):
                present.add("pull")
            if s.drive.load is not None:
                present.add("load")
            if s.bars == "free":
                present.add("turning bars")
            elif np.any(np.asarray(s.asperite.kappa) > 0.0):
                present.add("clamped ends")
        return frozenset(present)

    @property
    def times(self) -> np.ndarray:
        """The times to be recorded; the start and the end are always among them."""
        if self.output.times is None:
            return np.linspace(0.0, self.duration, self.output.samples)
        return np.union1d(np.array(self.output.times), [0.0, self.duration])

    def save(self, path: Any) -> None:
        """Write the scene file that :func:`tribo.load_scene` reads."""
        from tribo.scene_file import save_scene

        save_scene(self, path)


__all__ = ["EFFECTS", "Free", "Interaction", "Numerics", "Output", "Scene"]
