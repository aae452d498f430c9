"""What must not matter: the place, the frame, the direction of time, the units, the view.

Each test changes a scene, and says of every quantity that a run reports what becomes of it.  The
tolerances are what the two runs say of their own errors.
"""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from support.laws import FORCES, kind, tables
from support.strategies import (
    all_scenes,
    assert_within,
    bar,
    coulombs,
    drives,
    dyadic,
    forced,
    lattice_scenes,
    open_scenes,
    rigid,
    run,
    scenes,
    vectors,
)
from support.transformations import (
    boosted,
    in_units,
    reflected,
    rotated,
    translated,
    turned_back,
    upside_down,
)
from tribo import DrivenBars, Pulled, simulate

POINTS = ("cm", "bob", "bar")


def assert_image(one, other, image=lambda surface, table: {}):
    """`other` reports what `one` does, but for what `image` says of a table.

    The image is a mapping from names to pairs: what `other` must report, and how uncertain that
    is on the part of `one`.
    """
    theirs = {(s.name if s else None, name): v for s, t in tables(other) for name, v in t.items()}
    for surface, table in tables(one):
        images = image(surface, table)
        for name, values in table.items():
            want, bound = images.get(name, (values, bar(one, name)))
            place = surface.name if surface else None
            assert_within(bound + bar(other, name), theirs[place, name], want, f"{place}.{name}")


def negated(result, table, *names):
    """Images of quantities that change sign, among those that the table has."""
    return {name: (-table[name], bar(result, name)) for name in names if name in table}


def ends_exchanged(result, table):
    """Images of the works on the ends of the bars where right is left."""
    pairs = (("wL", "wR"), ("wR", "wL"))
    return {a: (table[b], bar(result, b)) for a, b in pairs if b in table}


def places(axis):
    """Names of all coordinates along an axis."""
    return [f"{axis}_{point}" for point in POINTS]


def shifted(result, table, axis, by):
    """Images of all coordinates along an axis, shifted by a number or by a column over time."""
    return {name: (table[name] + by, bar(result, name)) for name in places(axis) if name in table}


# --- translation ---------------------------------------------------------------------------------


@given(all_scenes(), vectors(100.0), dyadic(-10.0, 10.0))
def test_translation(scene, by, along_z):
    """Places move along; nothing else knows."""
    one, other = run(scene), run(translated(scene, by, along_z))

    def image(surface, table):
        return shifted(one, table, "x", by[0]) | shifted(one, table, "y", by[1])

    assert_image(one, other, image)


# --- Galilean boost ------------------------------------------------------------------------------


def momentum_gained(result, surface):
    """M (v_cm - its first value) of each asperite: the impulse of all forces on it together."""
    mass = surface.asperite.for_each(surface.count)["mass"]
    table = result[surface.name]
    return [mass * (table[name] - table[name][0]) for name in ("vx_cm", "vy_cm")]


def momentum_bars(result, surface):
    """How uncertain `momentum_gained` is."""
    mass = np.max(surface.asperite.for_each(surface.count)["mass"])
    return [2.0 * mass * bar(result, name) for name in ("vx_cm", "vy_cm")]


def shift_by_impulse(result, surface, u):
    """u . J of all forces on each asperite, and its uncertainty."""
    parts = zip(u, momentum_gained(result, surface), strict=True)
    bounds = zip(u, momentum_bars(result, surface), strict=True)
    return sum(a * j for a, j in parts), sum(abs(a) * b for a, b in bounds)


@given(scenes() | open_scenes(), vectors(2.0))
def test_boost(scene, u):
    """w -> w + u . J and w_ps -> w_ps + u . J, J being the impulse of all forces, M delta v.

    Surfaces without baths, whose momentum could not be told from what is reported.
    """
    one, other = run(scene), run(boosted(scene, u))
    shifts = {s.name: shift_by_impulse(one, s, u) for s in scene.surfaces}
    of_blocks = {k: (np.sum(j, axis=1), j.shape[1] * b) for k, (j, b) in shifts.items()}
    of_all = sum(j for j, _ in of_blocks.values()), sum(b for _, b in of_blocks.values())

    def moved(table, shift, *names):
        by, bound = shift
        return {n: (table[n] + by, bar(one, n) + bound) for n in names}

    def image(surface, table):
        if surface is None:
            return moved(table, of_all, "total_energy_change", "applied_work")
        if "W" in table:
            works = [run[surface.name]["w1"] for run in (one, other)]
            # Minus the impulse of the contact, times a velocity: its works differ by the opposite.
            by = np.sum(works[0] - works[1], axis=1)
            bound = works[0].shape[1] * (bar(one, "w1") + bar(other, "w1"))
            friction = moved(table, (by, bound + bar(other, "friction_work")), "friction_work")
            return friction | moved(table, of_blocks[surface.name], "W", "W_ps", "delta_K")
        images = moved(table, shifts[surface.name], "w", "w_ps", "delta_k_trans")
        for axis, speed in zip("xy", u, strict=True):
            images |= shifted(one, table, axis, speed * one.t[:, None])
            name = f"v{axis}_cm"
            images[name] = (table[name] + speed, bar(one, name))
        single = [*FORCES, *(f"{name}_ps" for name in FORCES), "wL", "wR"]
        elsewhere = {n: (table[n], np.inf) for n in single if n in table}  # in the next test
        return images | elsewhere

    assert_image(one, other, image)


@given(all_scenes(), vectors(2.0))
def test_boost_of_each_force(scene, u):
    """Each force has an impulse J of its own, by which its work and pseudowork depend on the frame.

    J is measured by two observers and predicts what a third one sees.  The impulses of contact
    forces, of forces on the ends of a bar, and of springs cancel.
    """
    runs = [run(boosted(scene, v)) for v in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0), u)]
    size = 2.0 * (1.0 + abs(u[0]) + abs(u[1]))  # of the coefficients of works in what follows

    def bound(*names):
        return size * sum(bar(result, *names) for result in runs)

    def impulse(name, entry):
        rest, x, y, _ = (result[name][entry] for result in runs)
        return np.array([x - rest, y - rest])

    def assert_shifted(name, entries):
        """All entries shift by one u . J."""
        j = impulse(name, entries[0])
        for entry in entries:
            want = runs[0][name][entry] + u[0] * j[0] + u[1] * j[1]
            assert_within(bound(entry, entries[0]), runs[3][name][entry], want, f"{entry} + u . J")

    contact = 0.0
    for name in [s.name for s in scene.surfaces]:
        for force in FORCES:
            if force in runs[0][name]:
                assert_shifted(name, [force, f"{force}_ps"])
        for entries in (["w", "w_ps", "delta_k_trans"], ["W", "W_ps", "delta_K"], ["wL"], ["wR"]):
            assert_shifted(name, entries)
        ends = impulse(name, "wL") + impulse(name, "wR")
        assert_within(bound("wL", "wR"), ends, 0.0, "impulses of the ends")
        contact = contact + np.sum(impulse(name, "w1"), axis=2)
    assert_within(scene.count * bound("w1"), contact, 0.0, "impulses of contact forces")


# --- far and fast --------------------------------------------------------------------------------


def frame_free(result):
    """Everything that every observer agrees on, however far away and however fast."""
    agreed = ("phi", "omega", "nu", "delta_e_int", "delta_E_int", "contact_energy")
    for surface, table in tables(result):
        place = surface.name if surface else "system"
        for name in agreed:
            if name in table:
                yield f"{place}.{name}", table[name]
        for work in ("w", "W", *FORCES):
            if work in table:
                yield f"{place}.{work} - {work}_ps", table[work] - table[f"{work}_ps"]
        if "theta" in table:
            yield f"{place}.swing", table["theta"] - surface.rest


def last_digit(result):
    """What writing down the works of a run costs, where the largest is a sum of the others."""
    works = [np.max(np.abs(t[n])) for _, t in tables(result) for n in t if kind(n) == "energy"]
    return 8.0 * np.finfo(float).eps * max(works)


def assert_same_far_and_fast(scene, u, **numerics):
    """Places 1e9 away and velocities of 1e6 cost no digit of what observers agree on.

    Only the digits that works of that size cannot hold are missing from their differences.
    """
    one = simulate(scene, **numerics)
    other = simulate(boosted(translated(scene, (1e9, -1e9), 1e9), u), **numerics)
    lost = last_digit(other)
    for (name, values), (_, seen) in zip(frame_free(one), frame_free(other), strict=True):
        bound = 1e-11 * np.max(np.abs(values)) + (lost if "_ps" in name else 0.0)
        if "delta" in name:  # of rigid asperites it is round-off alone
            bound += last_digit(one)
        assert_within(bound, values, seen, name)


FAST = st.sampled_from([(1e6, -1e6), (-1e6, 1e6)])


@given(all_scenes(), FAST)
def test_far_and_fast(scene, u):
    """With steps that are chosen."""
    assert_same_far_and_fast(scene, u, method="dop853", accuracy=1e-12)


@given(scenes(potential=coulombs()), FAST)
def test_far_and_fast_in_equal_steps(scene, u):
    """With steps that are given."""
    assert_same_far_and_fast(scene, u, method="midpoint", step=0.02)


# --- time reversal -------------------------------------------------------------------------------


def one_by_one():
    """Drives under which the asperites of a surface go their own ways; none pulled by a stage."""
    return drives().filter(lambda drive: not isinstance(drive, Pulled))


@given(
    scenes(drive=forced() | rigid() | st.just(DrivenBars()), potential=coulombs())
    | scenes(drive=one_by_one(), counts=(1,), potential=coulombs())
)
def test_time_reversal(scene):
    """Turned back at its end, a scene returns to its start and gives back all works.

    The way out is made a hundred times finer, for its errors grow on the way back.
    """
    one = run(scene, accuracy=1e-11)
    other = run(turned_back(one))

    def image(surface, table):
        images = {}
        for name, values in table.items():
            back, bound = values[::-1], bar(one, name)
            if name in ("omega", "nu", "vx_cm", "vy_cm"):
                back = -back
            elif kind(name) == "energy" and name not in ("contact_energy", "swing_energy"):
                back, bound = back - values[-1], 2.0 * bound
            if name == "friction_work":  # at the velocity at the start, which is another one
                bound = np.inf
            images[name] = (back, bound)
        return images

    assert_image(one, other, image)


# --- units ---------------------------------------------------------------------------------------


def kinds(length, mass, time):
    """What each kind of quantity is multiplied by in other units."""
    return {
        "angle": 1.0,
        "rate": 1.0 / time,
        "length": length,
        "velocity": length / time,
        "energy": mass * length**2 / time**2,
    }


@given(all_scenes(), *[st.sampled_from([1e-10, 0.3, 7.0, 1e6])] * 3)
def test_units(scene, length, mass, time):
    """In other units every quantity is multiplied by its own factor; errors are as small."""
    one, other = run(scene), run(in_units(scene, length, mass, time))
    factors = kinds(length, mass, time)

    def image(surface, table):
        scaled = {name: factors[kind(name)] for name in table}
        return {name: (table[name] * f, bar(one, name) * f) for name, f in scaled.items()}

    assert_image(one, other, image)


POWERS_OF_TWO = st.integers(-40, 40).map(lambda n: 2.0**n)


@given(scenes(potential=coulombs()), POWERS_OF_TWO, POWERS_OF_TWO, POWERS_OF_TWO)
def test_units_of_powers_of_two(scene, length, mass, time):
    """Such units change no digit of a run with a given step."""
    one = simulate(scene, method="midpoint", step=0.03)
    other = simulate(in_units(scene, length, mass, time), method="midpoint", step=0.03 * time)
    factors = kinds(length, mass, time)
    for (_, before), (_, after) in zip(tables(one), tables(other), strict=True):
        for name, values in before.items():
            assert np.array_equal(values * factors[kind(name)], after[name]), name


# --- views ---------------------------------------------------------------------------------------


@given(all_scenes())
def test_reflection(scene):
    """In a mirror the ledger is the same, but for the left and the right end of every bar."""
    one, other = run(scene), run(reflected(scene))

    def image(surface, table):
        images = negated(one, table, "phi", "omega", "nu", "vx_cm", *places("x"))
        if "theta" in table:
            images["theta"] = (2.0 * surface.rest - table["theta"], bar(one, "theta"))
        return images | ends_exchanged(one, table)

    assert_image(one, other, image)


@given(all_scenes())
def test_exchange_of_surfaces(scene):
    """Turned upside down, the upper surface is the lower one, and the ledger is the same."""
    one, other = run(scene), run(upside_down(scene))

    def image(surface, table):
        images = negated(one, table, "vx_cm", "vy_cm", *places("x"), *places("y"))
        if "theta" in table:
            images["theta"] = (table["theta"] + np.pi - 2.0 * surface.rest, bar(one, "theta"))
        return images | ends_exchanged(one, table)

    assert_image(one, other, image)


def without_direction():
    """Drives for which no direction is special."""
    return forced() | st.just(DrivenBars())


@given(
    scenes(drive=without_direction(), potential=coulombs())
    | lattice_scenes(drive=without_direction(), alike=True),
    dyadic(-4.0, 4.0),
)
def test_rotation(scene, angle):
    """With forced and with driven bars no direction is special.

    Springs between bars of asperites that are alike rest where the bars are placed.
    """
    one, other = run(scene), run(rotated(scene, angle))
    cos, sin = np.cos(angle), np.sin(angle)

    def image(surface, table):
        images = {}
        for name in ("theta", "phi"):
            if name in table:
                images[name] = (table[name] + angle, bar(one, name))
        for x, y in [(f"x_{p}", f"y_{p}") for p in POINTS] + [("vx_cm", "vy_cm")]:
            if x in table:
                bound = bar(one, x, y)
                images[x] = (cos * table[x] - sin * table[y], bound)
                images[y] = (sin * table[x] + cos * table[y], bound)
        return images

    assert_image(one, other, image)
