"""Random scenes: what hypothesis draws for the laws of the ledger and the invariances.

Places and velocities are multiples of 1/64, so that a distant place and a fast frame can
represent them.  Bobs of different surfaces pass each other close enough to swing, and seldom so
close that the motion is chaotic.
"""

import math
from collections import defaultdict
from dataclasses import replace
from functools import cache

import numpy as np
from hypothesis import Phase, assume, given, seed, settings
from hypothesis import strategies as st

from tribo import (
    Asperite,
    Corrugation,
    Coulomb,
    DrivenBars,
    Field,
    Forced,
    Free,
    Initial,
    Interaction,
    Langevin,
    LennardJones,
    Morse,
    Output,
    Pulled,
    Result,
    Scene,
    Springs,
    Surface,
    simulate,
)

DURATION = 5.0
SAMPLES = 33
ACCURACY = 1e-9
# Scenes of each strategy that all tests share, unless they search.
SHARED = 2
# Scenes that are drawn, from which these are taken.
DRAWN = 24
REST = {"down": 0.0, "up": math.pi}


def run(scene: Scene, accuracy: float = ACCURACY) -> Result:
    """The scene's result, by one method for all scenes.

    Two runs that are compared then differ only in what a test changes.
    """
    result = simulate(scene, accuracy=accuracy, method="dop853")
    # Surfaces pass each other along y, which a rotation turns.
    assume(result.status != "PassedThrough")
    assert result.status == "completed"
    return result


def bar(result: Result, *names: str) -> float:
    """What the errors of these quantities may amount to together, as the run itself has it.

    Infinite for those without bounds, as of pulling springs.
    """
    bounds = [result.error_estimate[name] for name in names]
    return math.inf if None in bounds else sum(bounds)


def assert_within(bound: float, one: np.ndarray, other: np.ndarray, law: str) -> None:
    """Equal within the bound at every time and for every asperite."""
    worst = float(np.max(np.abs(one - other)))
    assert worst <= bound, f"{law}: off by {worst:.2e}, may be {bound:.2e}"


@cache
def dyadic(low: float, high: float, bits: int = 6) -> st.SearchStrategy[float]:
    """Multiples of 2^-bits."""
    return st.integers(round(low * 2**bits), round(high * 2**bits)).map(lambda k: k / 2**bits)


@cache
def vectors(size: float) -> st.SearchStrategy[tuple[float, float]]:
    """Two components of at most `size`."""
    return st.tuples(dyadic(-size, size), dyadic(-size, size))


@cache
def each(count: int | None, values: st.SearchStrategy[float]) -> st.SearchStrategy:
    """One value per asperite, or one number for all."""
    if count is None:
        return values
    return st.lists(values, min_size=count, max_size=count)


@cache
def coulombs() -> st.SearchStrategy[Coulomb]:
    """Attraction or repulsion."""
    return st.builds(Coulomb, dyadic(-0.25, 0.25, bits=8).filter(bool))


@cache
def potentials() -> st.SearchStrategy:
    """One of long range and either sign, a bond, a hard core."""
    return st.one_of(
        coulombs(),
        st.builds(Morse, D=dyadic(0.05, 0.3), alpha=dyadic(0.75, 2.0), r0=dyadic(0.25, 1.0)),
        st.builds(LennardJones, epsilon=dyadic(0.05, 0.3), sigma=dyadic(0.25, 0.6)),
    )


@cache
def drives() -> st.SearchStrategy:
    """Every kind of drive, with a load of either sign or without."""
    load = st.none() | dyadic(-0.05, 0.05, bits=8)
    return st.one_of(
        st.builds(Forced, load=load),
        st.builds(Free, load=load, rigid=st.booleans()),
        st.builds(Pulled, load=load, stiffness=dyadic(0.0, 1.0), speed=dyadic(-0.5, 1.0)),
        st.just(DrivenBars()),
    )


@cache
def forced() -> st.SearchStrategy[Forced]:
    """The drive that keeps every centre of mass at its velocity."""
    return st.just(Forced())


@cache
def rigid() -> st.SearchStrategy[Free]:
    """The drive that keeps the centres of mass of a surface at one velocity."""
    return st.just(Free(rigid=True))


@cache
def asperites(count: int | None) -> st.SearchStrategy[Asperite]:
    """Parameters of its own for every asperite; for None, the same for all."""
    return st.builds(
        Asperite,
        m1=each(count, dyadic(0.5, 2.0)),
        m2=each(count, dyadic(0.5, 4.0)),
        kappa=each(count, dyadic(0.5, 4.0)),
        length=each(count, dyadic(1.0, 2.5)),
        bar_length=each(count, dyadic(1.0, 4.0)),
        i2=each(count, dyadic(1.0, 6.0)),
        charge=each(count, dyadic(0.5, 1.5)),
    )


@cache
def initials(count: int, facing: str, turning: bool = True) -> st.SearchStrategy[Initial]:
    """Swings and bars at angles of their own and, unless told otherwise, bars with a rate."""
    angles = each(count, dyadic(-0.4, 0.4))
    return st.builds(
        Initial,
        theta=angles.map(lambda swings: [REST[facing] + swing for swing in swings]),
        phi=angles,
        omega=angles,
        nu=angles if turning else st.none(),
    )


@cache
def lattices() -> st.SearchStrategy[dict]:
    """What lies within a surface: springs between its bars, and a bath on every bar."""
    oscillator = {"mass": dyadic(0.125, 0.5), "frequency": dyadic(0.5, 3.0)}
    oscillators = st.lists(st.fixed_dictionaries(oscillator), min_size=1, max_size=2)
    return st.fixed_dictionaries(
        {
            "springs": st.builds(Springs, stiffness=dyadic(0.25, 2.0)),
            "bath": st.fixed_dictionaries({"oscillators": oscillators}),
        }
    )


@cache
def reservoirs() -> st.SearchStrategy[dict]:
    """Friction on the swings, or on the bars, in the frame of the surface or in one of its own."""
    gamma = dyadic(0.0625, 0.25)
    on_bars = st.builds(Langevin, gamma=gamma, velocity=st.none() | vectors(0.5))
    on_swings = st.builds(Langevin, gamma=gamma, on=st.just("swing"))
    return st.fixed_dictionaries({"langevin": on_bars | on_swings})


def rigid_asperites(surface: Surface) -> Surface:
    """The surface with rigid asperites on clamped bars, its reservoir on the bars."""
    initial = replace(surface.initial, omega=None, nu=None)
    langevin = surface.langevin and replace(surface.langevin, on="bar")
    asperite = replace(surface.asperite, kappa=math.inf)
    return replace(surface, asperite=asperite, initial=initial, bars="clamped", langevin=langevin)


def fields(names: tuple[str, ...]) -> st.SearchStrategy[list[Field]]:
    """A corrugation, at rest or moving, under some of the surfaces."""
    return st.lists(
        st.builds(
            Field,
            st.builds(Corrugation, amplitude=dyadic(0.03, 0.25), period=dyadic(1.0, 3.0)),
            on=st.lists(st.sampled_from(names), min_size=1, unique=True),
            origin=vectors(1.0),
            velocity=st.just((0.0, 0.0)) | vectors(0.5),
        ),
        min_size=1,
        max_size=1,
    )


# Of the first resting bob: x, y and depth, and the velocity along x.
PLACES = {
    "upper": (dyadic(-3.0, -1.5), dyadic(0.6, 1.0), dyadic(0.0, 0.25), dyadic(0.5, 1.25)),
    "lower": (dyadic(-0.5, 0.5), dyadic(-0.1, 0.0), dyadic(-0.25, 0.0), dyadic(-0.25, 0.25)),
    "third": (dyadic(-0.5, 1.0), dyadic(0.0, 0.5), dyadic(-1.5, -1.0), dyadic(-0.5, 0.25)),
}
FACINGS = {"upper": ("down",), "lower": ("up",), "third": ("down", "up")}


@st.composite
def surfaces(
    draw,
    name,
    drive,
    bars=("clamped", "free"),
    counts=(1, 2, 3),
    turning=True,
    alike=False,
    inside=None,
    kappas=("finite", "finite", "finite", "infinite"),
):
    """A row along x or along z of asperites, of different kinds or alike, at different heights."""
    x, y, depth, speed = PLACES[name]
    facing = draw(st.sampled_from(FACINGS[name]))
    count = draw(st.sampled_from(counts))
    drive = draw(drive)
    extras = {} if inside is None else draw(inside)
    if isinstance(drive, DrivenBars) and "langevin" in extras:
        extras["langevin"] = Langevin(extras["langevin"].gamma, on="swing")
    surface = Surface(
        name,
        facing=facing,
        bob=(draw(x), draw(y)),
        depth=draw(depth),
        velocity=(draw(speed), draw(dyadic(-0.05, 0.05))),
        shape=draw(st.sampled_from([(count, 1), (1, count)])),
        spacing=(draw(dyadic(0.75, 1.5)), draw(dyadic(1.5, 2.5))),
        heights=draw(each(count, dyadic(-0.1, 0.1))),
        drive=drive,
        bars=draw(st.sampled_from(bars)),
        asperite=draw(asperites(None if alike else count)),
        initial=draw(initials(count, facing, turning)),
        **extras,
    )
    can_be_rigid = "clamped" in bars and not (isinstance(drive, DrivenBars) and surface.langevin)
    infinite = can_be_rigid and draw(st.sampled_from(kappas)) == "infinite"
    return rigid_asperites(surface) if infinite else surface


def shared(strategy: st.SearchStrategy[Scene]) -> st.SearchStrategy[Scene]:
    """A few scenes of the strategy, the same for all tests; in a search, the strategy itself."""
    few = st.deferred(lambda: st.sampled_from(drawn(strategy)))
    return few if settings.default.derandomize else strategy


def drawn(strategy: st.SearchStrategy[Scene]) -> list[Scene]:
    """Scenes of a strategy that share one time loop: those with the most effects."""
    alike = defaultdict(list)

    @settings(max_examples=DRAWN, database=None, phases=[Phase.generate])
    @seed(0)
    @given(strategy)
    def collect(scene):
        alike[effects(scene)].append(scene)

    collect()
    enough = [kind for kind in alike if len(alike[kind]) >= SHARED]
    return alike[max(enough, key=lambda kind: sum(kind[1:]))]


def effects(scene: Scene) -> tuple:
    """What the time loop of a scene of these strategies is compiled for."""
    reservoirs = {surface.langevin and surface.langevin.on for surface in scene.surfaces}
    return (
        type(scene.interactions[0].potential).__name__,
        any(surface.asperite.is_rigid for surface in scene.surfaces),
        any(isinstance(surface.drive, DrivenBars) for surface in scene.surfaces),
        any(surface.bars == "free" for surface in scene.surfaces),
        "bar" in reservoirs,
        "swing" in reservoirs,
    )


@st.composite
def any_scenes(draw, potential=None, drive=None, field=None, **of_surfaces):
    """Two or three surfaces that pass each other; the keywords restrict what they can be."""
    drive = drives() if drive is None else drive
    names = draw(st.sampled_from([("upper", "lower"), ("upper", "lower", "third")]))
    return Scene(
        tuple(draw(surfaces(name, drive, **of_surfaces)) for name in names),
        (Interaction(draw(potentials() if potential is None else potential)),),
        DURATION,
        fields=() if field is None else draw(field(names)),
        output=Output(samples=SAMPLES),
    )


@cache
def scenes(**restricted):
    """Two or three surfaces that pass each other."""
    return shared(any_scenes(**restricted))


def lattice_scenes(**restricted):
    """Scenes whose surfaces are lattices with baths."""
    few = {"potential": coulombs(), "counts": (2, 3), "inside": lattices()}
    return scenes(**few | restricted)


def open_scenes(**restricted):
    """Scenes with external fields and reservoirs."""
    few = {"potential": coulombs(), "inside": reservoirs(), "field": fields}
    return scenes(**few | restricted)


def all_scenes():
    """Scenes of every kind, mostly without extras."""
    return st.one_of(scenes(), scenes(potential=coulombs()), lattice_scenes(), open_scenes())
