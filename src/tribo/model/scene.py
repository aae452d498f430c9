"""A scene: the physics of a run, and nothing numerical."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo import validation as check
from tribo.files import replace_file
from tribo.model import fields, topography
from tribo.model.effects import Effect, effects_of
from tribo.model.elastic import grid_of
from tribo.model.fields import Field
from tribo.model.initial import DISPLACEMENTS, UNITS
from tribo.model.interaction import Interaction, Periodic, as_interaction
from tribo.model.scene_writer import output_table, surface_table, toml, without_defaults
from tribo.model.settings import Numerics, Output
from tribo.model.smoothness import smoothness_of
from tribo.model.surface import Surface
from tribo.model.tables import ComparedByValue, field_names, from_table, part, table_of
from tribo.model.topography import Topography
from tribo.potentials import tables as potentials
from tribo.potentials.from_ase import Live
from tribo.potentials.potential import Potential
from tribo.validation import InputError, inside, must_be


@dataclass(frozen=True, eq=False)
class Scene(ComparedByValue):
    """Surfaces, the interactions between them, and the duration of a run.

    Attributes
    ----------
    surfaces : list of Surface
        At least one surface; each name once.
    interactions : list of Interaction
        Interactions between surfaces; also a single interaction or potential, or a list of
        potentials, or of tables as in scene files.
    duration : float
        End of the run, which starts at t = 0 [time].
    title : str
        Text for reports.
    seed : int
        Seed of all random numbers: heights, thermal starts and noise.
    periodic : Periodic or dict
        Periods along x and z.
    fields : list of Field or dict
        External fields on bobs.
    output : Output or dict
        The times to record. Like `numerics`, it does not change the physics.
    numerics : Numerics or dict
        Accuracy, method or step, unless the arguments of :func:`tribo.simulate` give them.

    Raises
    ------
    InputError
        If a value is out of range, a name stands for no surface, a pair of surfaces has two
        interactions, or a cutoff is longer than half a period.
    """

    surfaces: tuple[Surface, ...]
    interactions: tuple[Interaction, ...]
    duration: float
    title: str = ""
    seed: int = 0
    periodic: Periodic = field(default_factory=Periodic)
    fields: tuple[Field, ...] = ()
    output: Output = field(default_factory=Output)
    numerics: Numerics = field(default_factory=Numerics)

    if TYPE_CHECKING:
        # The constructor takes more than the fields then hold.
        def __init__(
            self,
            surfaces: Sequence[Surface],
            # or any NamedTuple
            interactions: Interaction | Potential | Live | Sequence[object] | Mapping[str, object],
            duration: float,
            title: str = ...,
            seed: int = ...,
            periodic: Periodic | Mapping[str, float] = ...,
            fields: Field | Sequence[Field | Mapping[str, object]] | Mapping[str, object] = ...,
            output: Output | Mapping[str, object] = ...,
            numerics: Numerics | Mapping[str, object] = ...,
        ) -> None:
            """For type checkers: the types that `__post_init__` converts."""

    def __post_init__(self) -> None:
        """Check all parts and how they go together; tables become objects."""
        put = object.__setattr__
        check.fields(self, duration=check.one(check.POSITIVE, "time"), seed=check.count(0))
        if self.duration < check.SHORTEST_DURATION:
            raise must_be("duration", f"at least {check.SHORTEST_DURATION:g} [time]", self.duration)
        if not isinstance(self.title, str):
            raise must_be("title", "text", self.title)
        check.fields(self, output=part(partial(from_table, Output)))
        check.fields(self, numerics=part(partial(from_table, Numerics)))
        put(self, "surfaces", self._checked_surfaces())
        put(self, "interactions", self._checked_interactions())
        put(self, "fields", self._checked_fields())
        check.fields(self, periodic=part(partial(from_table, Periodic)))
        self._check_period()
        for surface in self.surfaces:
            if surface.elastic is not None:
                grid_of(surface, self.periodic)
        for i, surface in enumerate(self.surfaces):
            with inside(f"surface[{i}].initial"):
                self._check_initial(surface)
        self._check_times()

    def _check_times(self) -> None:
        """Refuse samples after the end."""
        times = self.output.times
        if times is not None and times[-1] > self.duration:
            raise InputError(
                "output.times", f"must end by the duration {self.duration}, got {times[-1]}"
            )

    def _checked_surfaces(self) -> tuple[Surface, ...]:
        """The surfaces as a tuple, with names of their own."""
        if not isinstance(self.surfaces, (list, tuple)) or not self.surfaces:
            raise InputError("surface", "is missing; give at least one surface")
        surfaces: list[Surface] = []
        for i, item in enumerate(self.surfaces):
            surface = check.instance(Surface)(f"surface[{i}]", item)
            if surface.name in [s.name for s in surfaces]:
                raise InputError(
                    f"surface[{i}].name",
                    f'"{surface.name}" is the name of another surface; give each name once',
                )
            surfaces.append(surface)
        return tuple(surfaces)

    def _checked_interactions(self) -> tuple[Interaction, ...]:
        """The interactions as a tuple, from one potential or several, between known surfaces."""
        value: object = self.interactions
        one = isinstance(value, (Interaction, Live, Mapping)) or hasattr(value, "energy")
        listed = [value] if one else value
        if not isinstance(listed, (list, tuple)):
            raise must_be("interaction", "a potential or a list of potentials", value)
        interactions = tuple(
            check.instance(Interaction)(f"interaction[{i}]", as_interaction(item))
            for i, item in enumerate(listed)
        )
        names = [s.name for s in self.surfaces]
        for i, interaction in enumerate(interactions):
            with inside(f"interaction[{i}]"):
                _check_names("between", interaction.between, "surfaces", names)
                if interaction.species is not None:
                    _check_names("species", interaction.species, "species", self.species)
        self._refuse_two_for_one_pair(interactions)
        return interactions

    def _checked_fields(self) -> tuple[Field, ...]:
        """The fields as a tuple, from one or several, on known surfaces."""
        one = isinstance(self.fields, (Field, Mapping))
        listed = [self.fields] if one else self.fields
        if not isinstance(listed, (list, tuple)):
            raise must_be("field", "a list of fields", listed)
        names = [s.name for s in self.surfaces]
        found = tuple(part(_as_field)(f"field[{i}]", item) for i, item in enumerate(listed))
        for i, item in enumerate(found):
            _check_names(f"field[{i}].on", item.on, "surfaces", names)
        return found

    def _check_period(self) -> None:
        """Refuse potentials that reach beyond half a period, where nearest images are wrong."""
        for name in ("x", "z"):
            length = getattr(self.periodic, name)
            for i, interaction in enumerate(self.interactions):
                reach = interaction.potential.range()
                if length is not None and reach > 0.5 * length:
                    raise InputError(
                        f"interaction[{i}].cutoff",
                        f"must be at most half of periodic.{name} = {length:g} [length], "
                        f"got {reach:g}; the sum over all images (Ewald's) is not computed",
                    )

    def _check_initial(self, surface: Surface) -> None:
        """Refuse displacements of centres of mass that cannot move, and starts of nothing."""
        for name in DISPLACEMENTS:
            if getattr(surface.initial, name) is None:
                continue
            held = self._held(surface, name)
            if held:
                raise InputError(name, f"cannot be given{held}")
        if not surface.initial.temperature or not surface.asperite.is_rigid:
            return
        if not (self.slides_along_x(surface) or self.slides_along_y(surface)):
            raise InputError("temperature", "draws nothing: the asperites are rigid and are held")

    def _held(self, surface: Surface, name: str) -> str:
        """Why centres of mass cannot be displaced along an axis, in a message; else empty."""
        if surface.drive.gives_motion:
            return ', as drive = "moved" gives their motion'
        if name[-1] == "x":
            can_move = self.slides_along_x(surface)
            instead = 'drive = "free" lets them move'
        else:
            can_move = self.slides_along_y(surface)
            instead = "a load frees them"
        if not can_move:
            return f", as the drive holds the asperites along {name[-1]}; {instead}"
        if surface.is_rigid_block:
            whole = "bob" if name in ("x", "y") else "velocity"
            return f" where drive.block = true: all bars move as one; set {whole}"
        alike = name[-1] == "x" and surface.moves_as_one
        return " where drive.rigid = true: all move as one" if alike else ""

    def _refuse_two_for_one_pair(self, interactions: tuple[Interaction, ...]) -> None:
        """Raise InputError if two interactions act on the same species of a pair of surfaces."""
        seen: dict[tuple[int, int], list[set[str] | None]] = {}
        for i, interaction in enumerate(interactions):
            kinds = set(interaction.species) if interaction.species else None
            for pair in self.pairs(interaction):
                before = seen.setdefault(pair, [])
                if before and (kinds is None or None in before or kinds in before):
                    names = tuple(self.surfaces[k].name for k in pair)
                    raise InputError(
                        f"interaction[{i}].between",
                        f"{names} have another interaction; give each pair once",
                    )
                before.append(kinds)

    def pairs(self, interaction: Interaction) -> list[tuple[int, int]]:
        """Indices of the pairs of surfaces between which an interaction acts."""
        if interaction.between is None:
            return list(itertools.combinations(range(len(self.surfaces)), 2))
        one, other = sorted(map(self.index_of, interaction.between))
        return [(one, other)]

    def index_of(self, name: str) -> int:
        """The index of a surface.  Raises InputError if there is no such surface."""
        names = [surface.name for surface in self.surfaces]
        return names.index(check.one_of("surface", name, names))

    def surface_named(self, name: str) -> Surface | None:
        """The surface of a name; None if there is no such surface."""
        return next((surface for surface in self.surfaces if surface.name == name), None)

    def initial_value(self, key: object) -> tuple[Surface, str]:
        """The surface and the initial value of a key such as "upper.theta".

        Raises InputError if there is no such surface or quantity, or it is held.
        """
        name, _, quantity = str(key).rpartition(".")
        surface = self.surface_named(name)
        if surface is None or quantity not in UNITS | DISPLACEMENTS:
            known = ", ".join(UNITS | DISPLACEMENTS)
            problem = f'must name a surface and one of {known}, as "upper.theta"'
        elif quantity == "omega" and surface.asperite.is_rigid:
            problem = "cannot be changed where asperite.kappa = inf"
        elif surface.initial.temperature and quantity not in ("x", "y"):
            problem = "cannot be changed where initial.temperature draws the start"
        elif quantity in ("phi", "nu") and surface.tilts:
            problem = (
                'cannot be changed where drive.tilt = "free", since all bobs turn with the block; '
                "sweep over it, or prepare another scene"
            )
        elif quantity in ("phi", "nu") and surface.bars == "clamped":
            problem = "cannot be changed where bars are clamped; prepare another scene"
        elif quantity in DISPLACEMENTS and (held := self._held(surface, quantity)):
            problem = f"cannot be given{held}"
        else:
            return surface, quantity
        raise InputError(str(key), problem)

    def with_heights(self) -> Scene:
        """The same scene with its random heights as numbers, whatever its seed becomes."""
        if all(surface.heights is None for surface in self.surfaces):
            return self
        surfaces = [
            replace(surface, heights=surface.drawn_heights([self.seed, index, 0]))
            for index, surface in enumerate(self.surfaces)
        ]
        return replace(self, surfaces=tuple(surfaces))

    def with_settings(self, output: Output, numerics: Numerics) -> Scene:
        """The same physics with other settings: all else was checked before.

        The last one is kept, as ensembles of a scene ask for the same again.
        """
        last: Scene | None = vars(self).get("_last_with_settings")
        if last is not None and (last.output, last.numerics) == (output, numerics):
            return last
        scene = object.__new__(Scene)
        vars(scene).update(self.__getstate__(), output=output, numerics=numerics)
        scene._check_times()
        vars(self)["_last_with_settings"] = scene
        return scene

    def __getstate__(self) -> dict[str, Any]:
        """The fields, without what was computed of them."""
        return {name: getattr(self, name) for name in field_names(Scene)}

    @property
    def species(self) -> list[str]:
        """The species of the bobs, in alphabetical order."""
        return sorted(set().union(*[surface.species_names for surface in self.surfaces]))

    def has_contact_within(self, surface: Surface) -> bool:
        """Whether the bobs of the surface interact with one another."""
        return any(i.between == (surface.name, surface.name) for i in self.interactions)

    def has_field(self, surface: Surface) -> bool:
        """Whether an external field acts on the bobs of the surface."""
        return any(surface.name in item.on for item in self.fields)

    @cached_property
    def count(self) -> int:
        """Number of asperites."""
        return sum(surface.count for surface in self.surfaces)

    @cached_property
    def parts(self) -> dict[str, slice]:
        """Surface -> the place of its asperites among all, which follow surface after surface."""
        stops = list(itertools.accumulate(surface.count for surface in self.surfaces))
        names = (surface.name for surface in self.surfaces)
        return dict(zip(names, map(slice, [0, *stops], stops), strict=True))

    @cached_property
    def smoothness(self) -> float:
        """Number of continuous derivatives of all potentials; 0 if one jumps."""
        own = (smoothness_of(interaction.potential) for interaction in self.interactions)
        return max(0, min(own, default=math.inf))

    @cached_property
    def effects(self) -> frozenset[Effect]:
        """The effects that the scene calls for; no other is simulated."""
        return effects_of(self)

    @cached_property
    def is_noisy(self) -> bool:
        """Whether the scene has thermal noise."""
        return any(surface.is_noisy for surface in self.surfaces)

    @property
    def effects_of_positions(self) -> frozenset[Effect]:
        """Effects of plug-ins whose classes declare that velocities do not enter."""
        drives = [s.drive for s in self.surfaces if s.drive.effect == Effect.OWN_DRIVE]
        any_velocity = any(drive.depends_on_velocity for drive in drives)
        return frozenset() if any_velocity else frozenset({Effect.OWN_DRIVE})

    def has_uncancelled_forces(self, surface: Surface) -> bool:
        """Whether forces that the drive does not cancel act on the surface's asperites."""
        fields = self.has_field(surface)
        lattice = bool(surface.springs) or surface.bath.masses.size > 0
        lattice = lattice or surface.elastic is not None
        lattice = lattice or self.has_contact_within(surface)
        at_ends = surface.plugin_at_ends is not None
        return fields or lattice or bool(surface.reservoir("bar")) or at_ends

    def slides_along_x(self, surface: Surface) -> bool:
        """Whether the x of the surface's centres of mass are degrees of freedom.

        On driven bars they follow from the pendulum's angle.
        """
        return self._sliding[surface.name][0]

    def slides_along_y(self, surface: Surface) -> bool:
        """Whether the y of the surface's centres of mass are degrees of freedom, likewise."""
        return self._sliding[surface.name][1]

    @cached_property
    def _sliding(self) -> dict[str, tuple[bool, bool]]:
        """Surface -> whether x and y of its centres of mass are degrees of freedom."""
        found = {}
        for surface in self.surfaces:
            drive = surface.drive
            pushed = self.has_uncancelled_forces(surface)
            along_x = pushed or not drive.cancels_x
            along_y = pushed or drive.load is not None or not drive.cancels_y
            if surface.refers_to_bars:  # which their inertia moves
                along_x = True
                along_y = True
            moves = not drive.holds_bars
            found[surface.name] = (moves and along_x, moves and along_y)
        return found

    @property
    def times(self) -> np.ndarray:
        """The times to record, which include the start and the end [time]."""
        if self.output.times is None:
            return np.linspace(0.0, self.duration, self.output.samples)
        inner = [time for time in self.output.times if 0.0 < time < self.duration]
        return np.array([0.0, *inner, self.duration])

    def __repr__(self) -> str:
        surfaces = ", ".join(f"{s.name} ({s.count})" for s in self.surfaces)
        kinds = [type(i.potential).__name__ for i in self.interactions]
        parts = [surfaces, *kinds, *(type(f.potential).__name__ for f in self.fields)]
        title = f"{self.title!r}: " if self.title else ""
        return f"<Scene {title}{', '.join(parts)}, duration {self.duration:g}>"

    def save(self, path: object, defaults: bool = False) -> None:
        """Write the scene file that :func:`tribo.load_scene` reads.

        Parameters
        ----------
        path : str or path
            The file, which is replaced if it exists.
        defaults : bool
            Whether to write default values too.

        Raises
        ------
        InputError
            If the file cannot be written, or the scene has no text, as with a class that is
            defined in a notebook.
        """
        path = check.as_path(path)
        table = self.to_table() if defaults else without_defaults(self.to_table())
        for item, surface in zip(table["surface"], self.surfaces, strict=True):
            if isinstance(surface.heights, Topography):
                item["heights"] = topography.as_table(surface.heights, path.parent)
        replace_file(path, toml(table))

    def to_toml(self) -> str:
        """The text of a scene file that needs no files of topographies: heights are numbers.

        Raises InputError if the scene has no text, as with a class that is defined in a notebook.
        """
        return self._text

    @cached_property
    def _text(self) -> str:
        return toml(self.to_table()).decode("utf-8")

    def to_live_html(self, path: object, controls: object = None) -> Path:
        """Write a page that simulates the scene in the browser; see :func:`tribo.to_live_html`."""
        import tribo  # whose public names are found when they are used

        return tribo.to_live_html(self, path, controls)  # type: ignore[arg-type]

    def to_table(self) -> dict[str, Any]:
        """The nested table of that file."""
        table: dict[str, Any] = {"title": self.title} if self.title else {}
        interactions = []
        for interaction in self.interactions:
            own = potentials.as_table(interaction.potential)
            for key in ("between", "species"):
                names = getattr(interaction, key)
                if names:
                    own[key] = list(names)
            interactions.append(own)
        return table | {
            "duration": self.duration,
            "seed": self.seed,
            "output": output_table(self.output),
            "numerics": table_of(self.numerics),
            "periodic": table_of(self.periodic),
            "interaction": interactions,
            "field": [fields.as_table(item) for item in self.fields],
            "surface": [surface_table(surface) for surface in self.surfaces],
        }


def _as_field(value: object) -> Field:
    """A field from its table in a scene file, or the field itself."""
    found = fields.from_table(value, Path()) if isinstance(value, Mapping) else value
    return check.instance(Field)("", found)  # type: ignore[return-value]


def _check_names(field: str, given: Sequence[str] | None, kind: str, known: Sequence[str]) -> None:
    """Refuse names that none of the surfaces, or of the species, has."""
    for name in given or ():
        if name not in known:
            raise must_be(field, f"one of the {kind} {check.shortened(known)}", name)
