"""A surface: asperites that share a velocity and a drive."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, TypeVar

import numpy as np

from tribo import validation as check
from tribo.model.asperite import Asperite
from tribo.model.bars import Ends, as_bars
from tribo.model.bath import Bath, as_bath, no_bath
from tribo.model.block import check_block
from tribo.model.drawn import column, is_column, with_draws
from tribo.model.drive import Drive
from tribo.model.drive_tables import as_drive
from tribo.model.drives import Forced, Moved
from tribo.model.elastic import Elastic, as_elastic, check_elastic
from tribo.model.initial import Initial
from tribo.model.langevin import Langevin, as_langevin
from tribo.model.roughness import Roughness, draw
from tribo.model.springs import Springs, as_springs
from tribo.model.tables import ComparedByValue, from_table, part
from tribo.model.topography import Grid, Sampled, Topography, as_topography, is_topography
from tribo.validation import InputError, inside, is_list, must_be

if TYPE_CHECKING:
    Number = TypeVar("Number")
    Pair = tuple[Number, Number] | list[Number] | np.ndarray
    Settings = Mapping[str, object]  # a table of a scene file


@dataclass(frozen=True, eq=False)
class Surface(ComparedByValue):
    """One asperite, a row, a grid or a list of asperites.

    Positions are those of the bobs with theta at rest and phi = 0, for any `initial`.

    Attributes
    ----------
    name : str
        Name in results and scene files: printable, without . or /.
    facing : str
        "down" (rest angle 0: the bobs hang below their bars) or "up" (rest angle pi).
    bob : (float, float)
        x, y of the first resting bob [length].
    velocity : (float, float)
        Initial velocity of all centres of mass [length / time].
    shape : (int, int)
        Number of asperites along x and along z; x runs fastest.
    spacing : (float, float)
        Distance between neighbours along x and along z [length].
    depth : float
        z of the first asperite [length].
    heights : (n,) array or Roughness or Topography, optional
        Shift in y of each asperite, positive upward for both facings [length]; or the roughness
        from which they are drawn; or the measured topography from which they are interpolated, or
        its table in a scene file, or an object of SurfaceTopography.
    positions : (n, 3) array, optional
        x, y, z of the resting bobs [length], instead of `bob`, `shape`, `spacing` and `depth`.
    drive : Drive or str or dict
        The forces or constraints that hold or move the surface: :class:`Forced`, :class:`Free`,
        :class:`Pulled`, :class:`Pushed`, :class:`DrivenBars`, :class:`Custom`; or "forced",
        "free", "bars", or its table in a scene file.
    bars : str or Ends
        "clamped", "free", or :class:`Ends` for a user's forces on the ends of the bars.
    springs : Springs or dict
        Lattice springs between neighbouring bars.
    elastic : Elastic or dict, optional
        The elastic body on whose surface the bars stand: a half-space, or a layer.
    bath : Bath or dict, optional
        Oscillators on every bar.
    langevin : Langevin or dict or list of them, optional
        A thermal reservoir at every bar, or on every swing; or a list of one each.
    species : str or tuple of str
        Species of the bobs, one for all or one each, by which interactions distinguish bobs.
    asperite : Asperite or dict
        Masses, lengths, stiffness and charge of the asperites.
    initial : Initial or dict
        Initial angles, displacements and rates, or the temperature from which they are drawn.

    Raises
    ------
    InputError
        If a value is out of range, a list has another size than the number of asperites, or two
        settings exclude each other.
    """

    name: str
    facing: str = "down"
    bob: tuple[float, float] = (0.0, 0.0)
    velocity: tuple[float, float] = (0.0, 0.0)
    shape: tuple[int, int] = (1, 1)
    spacing: tuple[float, float] = (0.0, 0.0)
    depth: float = 0.0
    heights: np.ndarray | Roughness | Topography | None = None
    positions: np.ndarray | None = None
    drive: Drive = field(default_factory=Forced)
    bars: str | Ends = "clamped"
    springs: Springs = field(default_factory=Springs)
    elastic: Elastic | None = None
    bath: Bath = field(default_factory=no_bath)
    langevin: Langevin | tuple[Langevin, Langevin] | None = None
    species: str | tuple[str, ...] = ""
    asperite: Asperite = field(default_factory=Asperite)
    initial: Initial = field(default_factory=Initial)

    if TYPE_CHECKING:
        # The constructor takes more than the fields then hold.
        def __init__(
            self,
            name: str,
            facing: str = ...,
            bob: Pair[float] = ...,
            velocity: Pair[float] = ...,
            shape: Pair[int] = ...,
            spacing: Pair[float] = ...,
            depth: float = ...,
            heights: Sequence[float] | np.ndarray | Roughness | Topography | Settings | None = ...,
            positions: Sequence[Sequence[float]] | np.ndarray | None = ...,
            drive: Drive | str | Settings = ...,
            bars: str | Ends | Settings = ...,
            springs: Springs | Settings = ...,
            elastic: Elastic | Settings | None = ...,
            bath: Bath | Settings = ...,
            langevin: Langevin | Settings | Sequence[Langevin | Settings] | None = ...,
            species: str | Sequence[str] = ...,
            asperite: Asperite | Settings = ...,
            initial: Initial | Settings = ...,
        ) -> None:
            """For type checkers: the types that `__post_init__` converts."""

    def __post_init__(self) -> None:
        """Check all values and how they go together; tables and words become objects."""
        self._check_place()
        check.fields(self, drive=part(as_drive))
        heights = as_heights(self.heights, Grid(*self._grid, self.facing_sign))
        object.__setattr__(self, "heights", heights)
        check.fields(self, bars=part(as_bars), springs=part(as_springs), bath=part(as_bath))
        if self.springs and self.positions is not None and self.springs.pairs is None:
            raise InputError("springs.pairs", "is missing; listed positions have no neighbours")
        with inside("springs"):
            self.springs.bonds(self.shape, self.count, (False, False))
        if self.bath.inertias.size and self.bars == "clamped":
            raise InputError("bath.torsional", 'cannot go with clamped bars; set bars = "free"')
        if self.elastic is not None:
            check.fields(self, elastic=part(as_elastic))
        check.fields(self, langevin=part(as_langevin), species=self._checked_species)
        self._check_reservoirs()
        with inside("asperite"):
            drawn = with_draws(self.asperite, self.name, self.count)
        object.__setattr__(self, "asperite", drawn)
        for key, kind in (("asperite", Asperite), ("initial", Initial)):
            check.fields(self, **{key: part(partial(from_table, kind))})
            with inside(key):  # arrays of another size
                _ = self.each if key == "asperite" else self.initial_of_each
        self._check_driven_bars()
        self._check_rigid()
        check_block(self)
        check_elastic(self)
        self._check_given_motion()
        if self.initial.temperature and not np.all(np.asarray(self.asperite.kappa) > 0.0):
            raise InputError("initial.temperature", "needs asperite.kappa > 0, got 0")

    def __repr__(self) -> str:
        size = f"{self.count} asperite{'s' if self.count > 1 else ''}"
        drive = type(self.drive).__name__.lower()
        at = f"first bob at ({self.first_bob[0]:g}, {self.first_bob[1]:g})"
        moves = f"velocity ({self.velocity[0]:g}, {self.velocity[1]:g})"
        return f"<Surface {self.name!r}: {size} facing {self.facing}, {drive}, {at}, {moves}>"

    def _check_driven_bars(self) -> None:
        """Refuse forces on bars that driven bars have no use for."""
        if not self.drive.holds_bars:
            return
        if self.plugin_at_ends is not None:
            raise InputError("bars", 'cannot be forces of the user\'s own where drive = "bars"')
        if self.reservoir("bar") is not None:
            raise InputError("langevin.on", 'must be "swing" where drive = "bars", got "bar"')

    def _check_given_motion(self) -> None:
        """Refuse what bars that follow a given motion have no use for."""
        if not isinstance(self.drive, Moved):
            return
        if self.bars != "clamped":
            raise InputError("bars", 'must be "clamped" where drive = "moved"')
        if self.bath:
            raise InputError("bath", 'cannot go with drive = "moved"')
        if self.reservoir("bar"):
            raise InputError("langevin.on", 'must be "swing" where drive = "moved", got "bar"')
        if self.is_noisy:
            problem = 'must be 0 where drive = "moved": no method here integrates noise on it'
            raise InputError("langevin.temperature", problem)
        first = self.drive.first_velocity
        if self.velocity != first:
            raise must_be("velocity", f"{list(first)}, that of the drive at t = 0", self.velocity)
        if self.initial.temperature:
            raise InputError("initial.temperature", 'cannot go with drive = "moved"')

    def _check_reservoirs(self) -> None:
        """Refuse reservoirs with lists of numbers that are not one for each asperite."""
        for k, reservoir in enumerate(self.reservoirs):
            place = f"[{k}]" if isinstance(self.langevin, tuple) else ""
            with inside(f"langevin{place}"):
                reservoir.for_each(self.count)

    def _check_rigid(self) -> None:
        """Refuse what would turn the pendulums of rigid asperites."""
        if not self.asperite.is_rigid:
            return
        if self.bars != "clamped":
            raise InputError("asperite.kappa", "must be finite where bars are not clamped, got inf")
        for name in ("omega",) if self.tilts else ("omega", "nu"):
            if np.any(self.initial_of_each[name]):
                raise InputError(f"initial.{name}", "must be zero where asperite.kappa = inf")
        if self.reservoir("swing") is not None:
            raise InputError("langevin.on", 'must be "bar" where asperite.kappa = inf, got "swing"')

    @property
    def moves_as_one(self) -> bool:
        """Whether its asperites move along x as one rigid body."""
        return self.drive.moves_as_one and self.count > 1

    @property
    def is_block_of_pendulums(self) -> bool:
        """Whether pendulums swing on bars that are one rigid body."""
        return self.is_rigid_block and not self.asperite.is_rigid

    @property
    def is_rigid_block(self) -> bool:
        """Whether its bars are one rigid body; on an elastic body they are displaced."""
        return self.drive.block and self.elastic is None

    @property
    def tilts(self) -> bool:
        """Whether its bars are one rigid body that turns about z."""
        return self.is_rigid_block and self.drive.tilts

    @property
    def refers_to_bars(self) -> bool:
        """Whether the coordinates x and y are those of the bars, or of the body that they form."""
        return self.is_block_of_pendulums or self.tilts or self.has_moved_pendulums

    @property
    def has_moved_pendulums(self) -> bool:
        """Whether its pendulums swing on bars that follow a given motion."""
        return self.drive.gives_motion and not self.asperite.is_rigid

    @property
    def turns_bars(self) -> bool:
        """Whether the angles of its bars are degrees of freedom."""
        return self.bars != "clamped" or self.tilts

    @property
    def plugin_at_ends(self) -> NamedTuple | None:
        """The plug-in with the user's forces on the ends of the bars, if there is one."""
        return self.bars.force if isinstance(self.bars, Ends) else None

    @property
    def roughness(self) -> Roughness | None:
        """The roughness from which its heights are drawn, if they are."""
        return self.heights if isinstance(self.heights, Roughness) else None

    @property
    def draws_heights(self) -> bool:
        """Whether its heights are drawn with a seed of the scene."""
        return self.roughness is not None and self.roughness.seed is None

    @property
    def has_given_heights(self) -> bool:
        """Whether its heights are numbers or a measured topography."""
        return isinstance(self.heights, (np.ndarray, Topography))

    @property
    def scan(self) -> Sampled | None:
        """What its scan has at its asperites, and lacks; None without one."""
        return self.heights.sampled if isinstance(self.heights, Topography) else None

    @property
    def is_noisy(self) -> bool:
        """Whether one of its reservoirs has thermal noise."""
        return any(reservoir.warmest > 0.0 for reservoir in self.reservoirs)

    @property
    def noisy_forces(self) -> tuple[str, ...]:
        """The forces on its asperites that have white noise."""
        noisy = [reservoir.on for reservoir in self.reservoirs if reservoir.warmest > 0.0]
        if "bar" in noisy:
            return ("f_T", "fL", "fR") if self.asperite.is_rigid else ("f_T",)
        return ("f2",) if noisy and self.drive.holds_bars else ()

    @cached_property
    def reservoirs(self) -> tuple[Langevin, ...]:
        """The Langevin reservoirs that damp, that at the bars first."""
        listed = self.langevin if isinstance(self.langevin, tuple) else (self.langevin,)
        return tuple(each for each in listed if each)

    def reservoir(self, on: str) -> Langevin | None:
        """The Langevin reservoir on the "bar" or the "swing", if there is one that damps."""
        return next((each for each in self.reservoirs if each.on == on), None)

    def _check_place(self) -> None:
        """Check the name, the lattice or the listed positions, and the velocity."""
        name: object = self.name
        printable = isinstance(name, str) and name.isprintable() and name.strip()
        if not printable or {".", "/"} & {*self.name} or name != self.name.strip():
            # They are names in NetCDF files, which allow no blanks at their ends.
            raise must_be("name", "a word without . or /, and without blanks at its ends", name)
        check.choice("facing", self.facing, ["down", "up"])
        lengths = check.pair(unit="length")
        velocity = check.pair(unit="length / time")
        check.fields(self, bob=lengths, velocity=velocity, spacing=lengths)
        given = check.listed("shape", self.shape, size=2)
        shape = tuple([check.integer(f"shape[{i}]", n, 1) for i, n in enumerate(given)])
        object.__setattr__(self, "shape", shape)
        check.fields(self, depth=check.one(unit="length"), positions=self._listed_positions)
        if self.count > check.LARGEST_COUNT:
            raise must_be("shape", f"at most {check.LARGEST_COUNT} asperites", self.count)

    def _listed_positions(self, field: str, given: object) -> np.ndarray:
        """The given resting bobs as a read-only array, (n, 3) [length], in place of a grid."""
        for key in ("bob", "shape", "spacing", "depth"):
            if getattr(self, key) != getattr(Surface, key):
                raise InputError(key, f"cannot go with {field}; give one or the other")
        if not is_list(given) or len(given) == 0:
            raise must_be(field, "a list of [x, y, z] [length]", given)
        row = partial(check.vector, size=3, unit="length")
        table = np.array([row(f"{field}[{i}]", each) for i, each in enumerate(given)])
        table.flags.writeable = False
        return table

    def _checked_species(self, field: str, given: object) -> str | tuple[str, ...]:
        if isinstance(given, str):
            return given
        names = tuple(given) if is_list(given) else ()
        if len(names) != self.count or not all(isinstance(name, str) for name in names):
            raise must_be(field, f"one name, or one per asperite ({self.count})", given)
        return tuple(str(name) for name in names)

    @property
    def species_names(self) -> tuple[str, ...]:
        """The species of its bobs: one, or one for each."""
        return (self.species,) if isinstance(self.species, str) else self.species

    @property
    def species_of_each(self) -> np.ndarray:
        """(n,) species of each bob."""
        return np.broadcast_to(np.array(self.species), (self.count,))

    @property
    def _grid(self) -> tuple[tuple[int, int], tuple[float, float]]:
        """Shape and spacing; listed positions have a spacing of zero."""
        if self.positions is not None:
            return (self.count, 1), (0.0, 0.0)
        return self.shape, self.spacing

    @cached_property
    def count(self) -> int:
        """Number of asperites."""
        return len(self.positions) if self.positions is not None else self.shape[0] * self.shape[1]

    @cached_property
    def each(self) -> dict[str, np.ndarray]:
        """The parameters of each asperite; see :meth:`Asperite.for_each`."""
        return self.asperite.for_each(self.count)

    @property
    def rest(self) -> float:
        """Rest angle theta - phi of the torsion spring [rad]."""
        return 0.0 if self.facing == "down" else np.pi

    @property
    def facing_sign(self) -> float:
        """+1 for a surface that faces down, -1 for one that faces up."""
        return 1.0 if self.facing == "down" else -1.0

    @cached_property
    def initial_of_each(self) -> dict[str, np.ndarray]:
        """The initial values of each asperite; see :meth:`Initial.for_each`."""
        return self.initial.for_each(self.count)

    @property
    def initial_swing(self) -> np.ndarray | None:
        """(n,) initial angles theta - rest [rad], from `theta` or `swing`; None without either."""
        given = self.initial
        each = self.initial_of_each
        if given.theta is not None:
            return each["theta"] - self.rest
        return None if given.swing is None else each["swing"]

    def resting_bobs(
        self, origin: tuple[float, float, float] = (0.0, 0.0, 0.0), seed: int | list[int] = 0
    ) -> np.ndarray:
        """(n, 3) positions of the resting bobs relative to `origin` [length].

        The origin is subtracted before positions are added up, so they keep all digits.  `seed`
        draws heights whose roughness has no seed of its own.
        """
        if self.positions is not None:
            bobs = self.positions - np.array(origin)
        else:
            index = np.arange(self.count)
            bobs = np.empty((self.count, 3))
            bobs[:, 0] = (self.bob[0] - origin[0]) + index % self.shape[0] * self.spacing[0]
            bobs[:, 1] = self.bob[1] - origin[1]
            bobs[:, 2] = (self.depth - origin[2]) + index // self.shape[0] * self.spacing[1]
        heights = self.drawn_heights(seed)
        if heights is not None:
            bobs[:, 1] += heights
        return bobs

    def drawn_heights(self, seed: int | list[int]) -> np.ndarray | None:
        """(n,) heights [length]; `seed` draws those of a roughness that has no seed of its own."""
        if isinstance(self.heights, Roughness):
            return draw(self.heights, *self._grid, np.random.default_rng(seed))
        if isinstance(self.heights, Topography):
            return self.heights.heights
        return self.heights

    @property
    def first_bob(self) -> tuple[float, float, float]:
        """Position of the first resting bob, without its height [length]."""
        if self.positions is not None:
            x, y, z = self.positions[0]
            return float(x), float(y), float(z)
        return self.bob[0], self.bob[1], self.depth


def as_heights(value: object, grid: Grid) -> np.ndarray | Roughness | Topography | None:
    """The `heights` of a surface: (nx nz,) numbers [length], a roughness, a topography, or None.

    A topography of a file is kept with its heights at the asperites; of an object, the heights are
    kept alone.  Listed positions have the shape (n, 1) and the spacing (0, 0).
    """
    if value is None:
        return None
    shape, spacing, _ = grid
    if is_column(value):
        with inside("heights"):
            value = column(value, Path())  # type: ignore[arg-type]
    if is_topography(value):
        with inside("heights"):
            topography = as_topography(value).on(grid)
        return topography if isinstance(topography.topography, str) else topography.heights
    if isinstance(value, (Roughness, Mapping)):
        with inside("heights"):
            roughness = from_table(Roughness, value, ["rms"])
            roughness.check(shape, spacing)
        return roughness
    if isinstance(value, str):
        wanted = f'{shape[0] * shape[1]} numbers [length], {{topography = "scan.npy"}}, or '
        raise check.must_be("heights", f'{wanted}{{file = "heights.csv", column = 1}}', value)
    return check.vector("heights", value, size=shape[0] * shape[1], unit="length")
