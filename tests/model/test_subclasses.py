"""A class derived from a part of a scene is its parent, or is refused."""

import math
import re
from dataclasses import dataclass

import pytest

import tribo
from tribo import Custom, InputError
from tribo.model.drive import Drive
from tribo.potentials import Table, as_potential, from_points


class Own(tribo.Potential):
    """A force on bars needs a plug-in of another kind; this one has an energy."""

    s: float

    def energy(self, r):
        return self.s / r


def scene(drive=None, **upper) -> tribo.Scene:
    """A pair, and a bob that is driven over it."""
    drive = tribo.Forced() if drive is None else drive
    if drive.gives_motion:  # which rigid asperites follow
        upper["asperite"] = tribo.Asperite(kappa=math.inf)
    surfaces = (
        tribo.Surface("upper", bob=(-2.0, 1.0), velocity=(1.0, 0.0), drive=drive, **upper),
        tribo.Surface("lower", facing="up"),
    )
    return tribo.Scene(surfaces, tribo.Coulomb(1.0), 4.0, output=tribo.Output(samples=2))


def derived(parent):
    """A class with another name, and a method that its parent lacks."""
    return type("Mine", (parent,), {"__doc__": "The same.", "described": lambda self: "mine"})


DRIVES = [
    tribo.Forced(),
    tribo.Free(load=0.5, rigid=True),
    tribo.Pulled(stiffness=2.0, speed=1.0),
    tribo.Pushed(force=(0.1, 0.0), rate=(0.2, 0.0)),
    tribo.DrivenBars(),
    tribo.Moved(speed=(1.0, 0.0)),
]


@pytest.mark.parametrize("drive", DRIVES, ids=lambda drive: type(drive).__name__)
def test_a_derived_drive_is_its_parent(drive):
    """In the scene, in its file, and in what runs read."""
    mine = derived(type(drive))(**vars(drive))
    assert scene(mine) == scene(drive)
    assert scene(mine).to_toml() == scene(drive).to_toml()


def test_a_derived_drive_does_the_work_of_its_parent():
    """The force of a forced drive on a pair."""
    one, other = (tribo.simulate(scene(d)) for d in (tribo.Forced(), derived(tribo.Forced)()))
    assert one["upper"].w2[-1, 0] == other["upper"].w2[-1, 0]
    assert abs(one["upper"].w2[-1, 0]) > 0.5


@dataclass(frozen=True, kw_only=True)
class Damped(tribo.Pushed):
    """A number that no run reads."""

    damping: float = 1.0


class ByMethod(tribo.Forced):
    """A force that no run calls."""

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        return 0.0, 0.0


class Unrelated(Drive):
    """Of no kind that runs know."""


@pytest.mark.parametrize(
    ("drive", "said"),
    [
        (Damped(), "drive: Damped changes damping of tribo.Pushed"),
        (ByMethod(), "drive: ByMethod.force_on_bar is not called; give Custom(force=...)"),
        (Unrelated(), "drive: must be of tribo.Forced"),
    ],
)
def test_other_drives_are_refused(drive, said):
    """One sentence names the class and what it adds."""
    with pytest.raises(InputError, match=re.escape(said)):
        scene(drive)


class OwnBonds(tribo.Springs):
    """Other bonds, which a file would lose."""

    def bonds(self, shape, count, periodic):
        return super().bonds(shape, count, (True, True))


def test_other_parts_that_change_something_are_refused():
    """As springs with bonds of their own."""
    with pytest.raises(InputError, match=r"springs: OwnBonds changes bonds of tribo\.Springs"):
        scene(springs=OwnBonds(1.0))


@pytest.mark.parametrize(
    ("key", "part"),
    [
        ("springs", tribo.Springs(2.0)),
        ("langevin", tribo.Langevin(0.5, 0.1)),
        ("heights", tribo.Roughness(0.1)),
        ("bath", tribo.Bath(masses=[1.0], frequencies=[2.0])),
        ("asperite", tribo.Asperite(kappa=2.0)),
        ("initial", tribo.Initial(theta=0.1)),
    ],
)
def test_other_derived_parts_are_their_parents(key, part):
    """In the scene's file."""
    mine = derived(type(part))(**vars(part))
    upper = {"shape": (4, 1), "spacing": (1.0, 0.0)}
    assert scene(**upper, **{key: mine}).to_toml() == scene(**upper, **{key: part}).to_toml()


def test_derived_scenes_surfaces_interactions_and_fields():
    """All at once."""
    plain = tribo.Scene(
        (tribo.Surface("upper"), tribo.Surface("lower", facing="up")),
        tribo.Interaction(tribo.Coulomb(1.0)),
        1.0,
        fields=(tribo.Field(tribo.Corrugation(0.1, 1.0), ["upper"]),),
    )
    mine = derived(tribo.Scene)(
        (derived(tribo.Surface)("upper"), derived(tribo.Surface)("lower", facing="up")),
        derived(tribo.Interaction)(tribo.Coulomb(1.0)),
        1.0,
        fields=(derived(tribo.Field)(tribo.Corrugation(0.1, 1.0), ["upper"]),),
    )
    assert mine.surfaces == plain.surfaces and mine.fields == plain.fields
    assert mine.to_toml() == plain.to_toml()


class Same(tribo.LennardJones):
    """Another name."""


class SameField(tribo.Corrugation):
    """Another name."""


class Steep(tribo.Corrugation):
    """Another energy."""

    def energy_at(self, x, y):
        return self.amplitude * x**2 / self.period


def test_plugins_without_methods_of_their_own_are_their_parents():
    """Those with some are not, whatever dispatches by the class of a field."""
    assert type(as_potential(Same(1.0, 1.0))) is tribo.LennardJones
    assert type(tribo.Field(SameField(0.1, 1.0), ["upper"]).potential) is tribo.Corrugation
    assert isinstance(tribo.Field(Steep(0.1, 1.0), ["upper"]).potential, Steep)


class OtherSum(tribo.potentials.Sum):
    """Not the sum of its parts."""

    def energy(self, r):
        return 1.0 / r**3

    def range(self):
        return float("inf")


class OtherTable(Table):
    """Not what its points say."""

    def energy(self, r):
        return 0.0 * r

    def range(self):
        return 4.0


def test_changed_sums_and_tables_are_not_written_as_what_they_derive_from():
    """A file would give the sum back, and runs would take the points."""
    changed = OtherSum(Own(1.0), tribo.Coulomb(0.5))
    surfaces = (tribo.Surface("upper"), tribo.Surface("lower", facing="up"))
    with pytest.raises(InputError, match="files hold numbers alone"):
        tribo.Scene(surfaces, changed, 1.0).to_toml()
    points = from_points([1.0, 2.0, 3.0, 4.0], [3.0, 2.0, 1.0, 0.0])
    with pytest.raises(InputError, match="OtherTable derives from Table"):
        as_potential(OtherTable(*points))


def test_all_kinds_of_drives_are_known():
    """So that a new one cannot run as another."""
    known = {Custom, *(type(drive) for drive in DRIVES)}
    own = {cls for cls in Drive.__subclasses__() if cls.__module__.startswith("tribo.")}
    assert own == known
