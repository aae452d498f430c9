"""Potentials against their formulae in 50 digits; combined potentials against their parts."""

import math
import tomllib
from typing import NamedTuple

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tribo
from support.scene_tables import scene_from
from tribo import InputError
from tribo.integrators.methods import METHODS
from tribo.layout.layout import lay_out
from tribo.potentials import (
    BUILT_IN,
    BornMayer,
    Buckingham,
    Coulomb,
    Gaussian,
    Hertz,
    LennardJones,
    Mie,
    Morse,
    Plummer,
    SoftSphere,
    WeeksChandlerAndersen,
    Yukawa,
    as_potential,
    expression,
    from_csv,
    from_points,
    named,
    tabulated,
)
from tribo.potentials.cutoff import AT_CUTOFF
from tribo.potentials.derivative import FUNCTIONS
from tribo.potentials.tables import as_table
from tribo.results.notes import run_notes

mpmath.mp.dps = 50
ROUND_OFF = 2e-14  # relative to the largest term of a formula


def numbers(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers distributed over all orders of magnitude between two ends."""
    return st.floats(math.log(low), math.log(high)).map(math.exp)


class Entry(NamedTuple):
    """The parameters of a built-in potential and the terms of its formula."""

    drawn: st.SearchStrategy
    terms: object  # of r and the parameters, as numbers of 50 digits
    charged: bool = False


def lennard_jones(r, p):
    return [4 * p.epsilon * (p.sigma / r) ** 12, -4 * p.epsilon * (p.sigma / r) ** 6]


def mie(r, p):
    c = p.n / (p.n - p.m) * (p.n / p.m) ** (p.m / (p.n - p.m)) * p.epsilon
    return [c * (p.sigma / r) ** p.n, -c * (p.sigma / r) ** p.m]


def morse(r, p):
    x = p.alpha * (r - p.r0)
    return [p.D * mpmath.exp(-2 * x), -2 * p.D * mpmath.exp(-x)]


def weeks_chandler_andersen(r, p):
    inside = r < mpmath.mpf(2) ** (mpmath.mpf(1) / 6) * p.sigma
    return [*lennard_jones(r, p), p.epsilon] if inside else [mpmath.mpf(0)]


def hertz(r, p):
    """The round-off is that of 1 - r/d, so r/d is a term."""
    overlap = max(1 - r / p.d, mpmath.mpf(0))
    return [p.A * r / p.d, p.A * (overlap ** mpmath.mpf(2.5) - r / p.d)]


DEPTH = numbers(1e-3, 1e3)
LENGTH = numbers(0.1, 3.0)
REGISTRY = {
    "coulomb": Entry(st.builds(Coulomb, st.floats(-5.0, 5.0)), lambda r, p: [p.strength / r], True),
    "yukawa": Entry(
        st.builds(Yukawa, st.floats(-5.0, 5.0), st.just(0.0) | LENGTH),
        lambda r, p: [p.strength * mpmath.exp(-p.screening * r) / r],
        True,
    ),
    "plummer": Entry(
        st.builds(Plummer, st.floats(-5.0, 5.0), LENGTH),
        lambda r, p: [p.strength / mpmath.sqrt(r**2 + p.softening**2)],
        True,
    ),
    "morse": Entry(st.builds(Morse, DEPTH, LENGTH, LENGTH), morse),
    "lennard-jones": Entry(st.builds(LennardJones, DEPTH, LENGTH), lennard_jones),
    "weeks-chandler-andersen": Entry(
        st.builds(WeeksChandlerAndersen, DEPTH, LENGTH), weeks_chandler_andersen
    ),
    "mie": Entry(st.builds(Mie, DEPTH, LENGTH, st.floats(8.0, 20.0), st.floats(3.0, 7.0)), mie),
    "born-mayer": Entry(
        st.builds(BornMayer, DEPTH, LENGTH), lambda r, p: [p.A * mpmath.exp(-r / p.rho)]
    ),
    "buckingham": Entry(
        st.builds(Buckingham, DEPTH, LENGTH, DEPTH),
        lambda r, p: [p.A * mpmath.exp(-r / p.rho), -p.C / r**6],
    ),
    "hertz": Entry(st.builds(Hertz, DEPTH, LENGTH), hertz),
    "soft-sphere": Entry(
        st.builds(SoftSphere, DEPTH, LENGTH, st.floats(3.0, 20.0)),
        lambda r, p: [p.epsilon * (p.sigma / r) ** p.n],
    ),
    "gaussian": Entry(
        st.builds(Gaussian, st.floats(-5.0, 5.0), LENGTH),
        lambda r, p: [p.height * mpmath.exp(-((r / p.width) ** 2) / 2)],
    ),
}


def precisely(name, potential, r):
    """U and -dU/dr in 50 digits, and the size of the largest term of each."""
    entry = REGISTRY[name]
    p = type(potential)(*map(mpmath.mpf, potential))
    r = mpmath.mpf(r)
    terms = entry.terms(r, p)
    slopes = [mpmath.diff(lambda x, k=k: entry.terms(x, p)[k], r) for k in range(len(terms))]
    sizes = (max(map(abs, terms)), max(map(abs, slopes)))
    return sum(terms), -sum(slopes), *map(float, sizes)


def test_every_built_in_has_an_entry():
    """Every built-in potential is tested here and is on the page on potentials."""
    assert set(REGISTRY) == set(BUILT_IN)


@pytest.mark.parametrize("name", REGISTRY)
@given(data=st.data())
def test_energy_and_force_are_the_formula(name, data):
    """Energy and force are right to round-off, for arrays as for numbers."""
    potential = as_potential(data.draw(REGISTRY[name].drawn))
    assert type(potential) is BUILT_IN[name]
    places = np.array(data.draw(st.lists(numbers(0.05, 20.0), min_size=1, max_size=4)))
    energies = potential.energy(places)
    forces = potential.force(places)
    steep = 20.0 + 40.0 / np.min(places)  # an exponent's round-off, magnified by itself
    for r, energy, force in zip(places, energies, forces, strict=True):
        exact, slope, size, steepest = precisely(name, potential, r)
        assert abs(energy - exact) <= ROUND_OFF * steep * size + 1e-300
        assert abs(force - slope) <= ROUND_OFF * steep * steepest + 1e-300
        assert abs(potential.energy(r) - energy) <= ROUND_OFF * steep * size + 1e-300


@pytest.mark.parametrize("name", REGISTRY)
@given(data=st.data(), one=st.floats(-3.0, 3.0), other=st.floats(-3.0, 3.0))
def test_charges_multiply_charged_potentials_only(name, data, one, other):
    """Charged potentials are multiplied by the charges; others are not."""
    potential = as_potential(data.draw(REGISTRY[name].drawn))
    factor = one * other if REGISTRY[name].charged else 1.0
    assert potential.energy_between(1.3, one, other) == factor * potential.energy(1.3)
    assert potential.force_between(1.3, one, other) == factor * potential.force(1.3)


HAVE_MINIMA = [name for name, cls in BUILT_IN.items() if hasattr(cls, "minimum")]


@pytest.mark.parametrize("name", HAVE_MINIMA)
@given(data=st.data())
def test_minimum(name, data):
    """The declared minimum has zero slope, and the depth and the curvature of the formula."""
    potential = data.draw(REGISTRY[name].drawn)
    r, energy, curvature = potential.minimum()
    p = type(potential)(*map(mpmath.mpf, potential))

    def exact(x):
        return sum(REGISTRY[name].terms(x, p))

    if not math.isfinite(r):
        assert name == "buckingham"
        slopes = [mpmath.diff(exact, mpmath.mpf(x)) for x in np.geomspace(0.1, 200.0, 60)]
        assert all(slope > 0 for slope in slopes)
        return
    place = mpmath.findroot(lambda x: mpmath.diff(exact, x), mpmath.mpf(r))
    bend = mpmath.diff(exact, place, 2)
    assert bend > 0
    assert r == pytest.approx(float(place), rel=1e-6)
    assert energy == pytest.approx(float(exact(place)), rel=1e-9)
    assert curvature == pytest.approx(float(bend), rel=1e-5)


def test_potentials_with_a_minimum():
    """Every potential with a minimum declares it."""
    assert set(HAVE_MINIMA) == {"morse", "lennard-jones", "mie", "buckingham"}


def test_buckingham_is_valid_outside_its_barrier():
    """At the near end of its domain the slope is zero and the curvature negative."""
    potential = Buckingham(1000.0, 0.3, 50.0)
    near, far = potential.domain()
    assert far == math.inf
    assert potential.force(near) == pytest.approx(0.0, abs=1e-9)
    assert potential.force(0.99 * near) < 0.0 < potential.force(1.01 * near)


def test_relations_between_potentials():
    """Special cases of one potential equal another."""
    r = np.linspace(0.5, 3.0, 26)
    jones = LennardJones(0.3, 0.9)
    assert Mie(0.3, 0.9, 12.0, 6.0).energy(r) == pytest.approx(jones.energy(r), rel=1e-12, abs=0.0)
    assert Yukawa(0.4, 0.0).force(r) == pytest.approx(Coulomb(0.4).force(r), rel=1e-15, abs=0.0)
    core = WeeksChandlerAndersen(0.3, 0.9)
    plain = jones.with_cutoff(2.0 ** (1 / 6) * 0.9, "shift")
    assert core.energy(r) == pytest.approx(plain.energy(r), abs=1e-14)
    assert core.force(r) == pytest.approx(plain.force(r), abs=1e-14)
    twelve = SoftSphere(1.2, 0.9, 12.0)
    six = SoftSphere(1.2, 0.9, 6.0)
    assert twelve.force(r) - six.force(r) == pytest.approx(jones.force(r), rel=1e-12, abs=1e-12)
    assert Plummer(0.4, 0.5).energy(0.0) == pytest.approx(0.8)


# --- combined potentials -------------------------------------------------------------------------

PARTS = st.one_of(*(entry.drawn for entry in REGISTRY.values())).map(as_potential)
CHARGES = st.tuples(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0))
PLACES = np.linspace(0.4, 4.0, 19)


def near(one, other):
    """The arrays are equal to round-off of their largest value."""
    return one == pytest.approx(other, rel=1e-11, abs=1e-11 * float(np.max(np.abs(other))) + 1e-200)


@given(parts=st.lists(PARTS, min_size=2, max_size=4), charges=CHARGES, factor=st.floats(-3.0, 3.0))
def test_sums_and_scaled_copies(parts, charges, factor):
    """Energy and force between any two charges are the parts' sum, times the factor."""
    whole = factor * sum(parts)
    for method in ("energy_between", "force_between"):
        each = [getattr(part, method)(PLACES, *charges) for part in parts]
        size = np.max(np.abs(each), axis=0)
        off = getattr(whole, method)(PLACES, *charges) - factor * np.sum(each, axis=0)
        assert np.all(np.abs(off) <= 1e-13 * abs(factor) * size)
    assert whole.energy(1.2) == whole.energy_between(1.2, 1.0, 1.0)
    assert whole.clearance(0.9) == min(part.clearance(0.9) for part in parts)
    assert whole.range() == max(part.range() for part in parts)
    assert whole.smoothness() == min(part.smoothness() for part in parts)


@pytest.mark.parametrize("at_cutoff", AT_CUTOFF)
@given(one=PARTS, other=PARTS, charges=CHARGES, factor=st.floats(-3.0, 3.0))
def test_a_cutoff_is_linear(at_cutoff, one, other, charges, factor):
    """A cutoff of a sum is the sum of the cutoffs of its parts, charged or not."""
    whole = (one + factor * other).with_cutoff(2.5, at_cutoff)
    first, second = (part.with_cutoff(2.5, at_cutoff) for part in (one, other))
    for method in ("energy_between", "force_between"):
        a, b = (getattr(part, method)(PLACES, *charges) for part in (first, second))
        off = getattr(whole, method)(PLACES, *charges) - (a + factor * b)
        ends = [getattr(p, method)(np.array([0.4, 2.5]), *charges) for p in (one, other)]
        assert np.all(np.abs(off) <= 1e-11 * (1.0 + abs(factor)) * np.max(np.abs(ends)) + 1e-250)
    assert whole.range() == min(2.5, max(one.range(), other.range()))


def slope(potential, r, h=1e-4):
    """-dU/dr between charges of 1.5 and -2, by differences of order 6."""
    weights = {1: 0.75, 2: -0.15, 3: 1.0 / 60.0}
    energy = {k: potential.energy_between(r + k * h, 1.5, -2.0) for k in (-3, -2, -1, 1, 2, 3)}
    return -sum(w * (energy[k] - energy[-k]) for k, w in weights.items()) / h


MIXED = Coulomb(0.3) + 0.5 * LennardJones(0.2, 1.0)
MADE = {
    "sum": MIXED,
    "ionic": BornMayer(40.0, 0.3) + Yukawa(0.5, 0.4).with_cutoff(3.0),
    **{kind: MIXED.with_cutoff(2.5, kind) for kind in AT_CUTOFF},
    "table": from_points(np.linspace(0.5, 3.0, 40), np.sin(3.0 * np.linspace(0.5, 3.0, 40))),
    "a table cut off": from_points(
        np.linspace(0.5, 3.0, 40), np.sin(3.0 * np.linspace(0.5, 3.0, 40))
    ).with_cutoff(2.5),
}


@pytest.mark.parametrize("name", MADE)
def test_force_is_the_slope(name):
    """The force of every combined potential is minus the slope, between charges."""
    for r in np.linspace(0.75, 2.45, 18) + 0.0123:
        force = MADE[name].force_between(r, 1.5, -2.0)
        assert force == pytest.approx(slope(MADE[name], r), rel=2e-7, abs=2e-7)


POINTS = np.linspace(0.8, 2.0, 25)
SMOOTHNESS = {
    "truncate": (Coulomb(1.0).with_cutoff(2.0, "truncate"), -1),
    "shift": (Coulomb(1.0).with_cutoff(2.0, "shift"), 0),
    "force-shift": (Coulomb(1.0).with_cutoff(2.0, "force-shift"), 1),
    "switch": (Coulomb(1.0).with_cutoff(2.0, "switch"), 2),
    "a core": (WeeksChandlerAndersen(0.3, 2.0 ** (5 / 6)), 1),
    "a core cut off farther out": (
        WeeksChandlerAndersen(0.3, 2.0 ** (5 / 6)).with_cutoff(3.0, "truncate"),
        1,
    ),
    "a table that ends in a jump": (from_points(POINTS, POINTS), -1),
    "a table that ends in a corner": (from_points(POINTS, 2.0 - POINTS), 0),
    "a table that ends in a parabola": (from_points(POINTS, (2.0 - POINTS) ** 2), 1),
    "a table that ends in a cubic": (from_points(POINTS, (2.0 - POINTS) ** 3), 2),
    "a table that is switched off": (from_points(POINTS, POINTS).with_cutoff(2.0), 2),
    "a sum": (Coulomb(1.0) + Morse(1.0, 1.0, 1.0).with_cutoff(2.0, "shift"), 0),
}


@pytest.mark.parametrize("name", SMOOTHNESS)
def test_smoothness_is_as_declared(name):
    """The first derivative of U that jumps at r = 2 is the one after those declared."""
    potential, smoothness = SMOOTHNESS[name]
    assert potential.smoothness() == smoothness
    h = 1e-4
    sides = [2.0 + side * h * np.array([1.0, 2.0, 3.0, 4.0]) for side in (-1.0, 1.0)]
    values = [np.array([potential.energy(r) for r in side]) for side in sides]
    fits = [np.polynomial.Polynomial.fit(r, u, 3) for r, u in zip(sides, values, strict=True)]
    for order in range(4):
        before, after = (fit.deriv(order)(2.0) if order else fit(2.0) for fit in fits)
        jumps = abs(after - before) > 0.02
        assert jumps == (order > smoothness) or order > smoothness + 1, order


@pytest.mark.parametrize(
    ("word", "meant"),
    [("coulumb", "coulomb"), ("lj", "lennard-jones"), ("Lennard_Jones", "lennard-jones")],
)
def test_a_misspelt_name_has_a_nearest_one(word, meant):
    with pytest.raises(InputError, match=f'is not a known name; did you mean "{meant}"'):
        tribo.potentials.named(word, strength=1.0)


def test_what_lies_beyond_a_cutoff_does_not_count():
    """Parts of a sum end, jump or bend there, where the sum has ended."""
    charge = Coulomb(0.1)
    table = from_points(POINTS, POINTS)  # which ends in a jump at r = 2
    core = WeeksChandlerAndersen(0.3, 2.0 ** (5 / 6))  # which ends in a bend there
    for part, whole in ((table, -1), (core, 1)):
        both = part + charge
        assert both.with_cutoff(1.5).smoothness() == 2
        assert both.with_cutoff(1.5, "shift").smoothness() == 0
        assert both.with_cutoff(3.0).smoothness() == whole
        assert (both.with_cutoff(1.5) + charge).smoothness_below(1.0) == 2


# --- tables --------------------------------------------------------------------------------------


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-9])
def test_a_table_of_a_function_is_within_its_stated_error(tolerance):
    """Between its points the error is below the tolerance and close to the stated error."""
    jones = LennardJones(0.3, 1.0)
    table = tabulated(jones.energy, 0.8, 4.0, tolerance)
    r = np.linspace(0.8, 4.0, 200_000)[:-1]
    worst = np.max(np.abs(table.energy(r) - jones.energy(r)))
    assert worst <= table.error <= tolerance
    assert worst > 0.02 * table.error
    assert table.domain() == (0.8, 4.0)


def test_an_error_of_points_is_not_below_the_true_one():
    """The error of every other point is larger than the error between all points."""
    for n in (20, 40, 80):
        r = np.linspace(0.9, 3.0, n)
        jones = LennardJones(0.3, 1.0)
        table = from_points(r, jones.energy(r))
        fine = np.linspace(0.9, 3.0, 5001)[:-1]
        worst = np.max(np.abs(table.energy(fine) - jones.energy(fine)))
        assert worst <= table.error <= 100.0 * worst


def test_a_table_is_the_spline():
    """A table equals scipy's spline at its points and between them."""
    from scipy.interpolate import CubicSpline

    r = np.array([0.5, 0.6, 0.9, 1.0, 1.7, 2.0])
    u = np.array([3.0, -1.0, 0.5, 0.2, 0.0, 0.7])
    table = from_points(r, u)
    spline = CubicSpline(r, u)
    x = np.linspace(0.5, 1.9999, 801)
    assert table.energy(x) == pytest.approx(spline(x), abs=1e-13)
    assert table.force(x) == pytest.approx(-spline(x, 1), abs=1e-12)
    assert [table.energy(place) for place in r[:-1]] == pytest.approx(u[:-1], abs=1e-14)
    assert table.energy(2.0) == table.force(7.0) == 0.0
    with np.errstate(invalid="ignore"):
        assert math.isnan(table.energy(0.4999)) and math.isnan(table.force(0.0))


def test_a_table_from_a_file(tmp_path):
    """A file has two columns, separated by commas or spaces, and may have comments."""
    path = tmp_path / "curve.csv"
    path.write_text("# r, U\n0.5, 4.0\n\n1.0 2.0\n1.5,1.0\n2.0\t0.5\n")
    assert from_csv(path) == from_points([0.5, 1.0, 1.5, 2.0], [4.0, 2.0, 1.0, 0.5])
    assert from_csv(path) != from_points([0.5, 1.0, 1.5, 2.0], [4.0, 2.0, 1.0, 0.6])
    assert hash(from_csv(path)) == hash(from_csv(path))
    path.write_text("0.5, 4.0\n1.0, x\n")
    with pytest.raises(InputError, match=r'two numbers in each line, got "1\.0, x" in line 2'):
        from_csv(path)


LAMMPS = "# a comment\n\n{}\nN 4 R 0.5 2.0\n\n" + "".join(
    f"{k} {r} {u} 0.0\n" for k, r, u in ((1, 0.5, 4.0), (2, 1.0, 2.0), (3, 1.5, 1.0), (4, 2.0, 0.5))
)


@pytest.mark.parametrize(
    ("text", "settings"),
    [
        ("\ufeff0.5,4\n1,2\n1.5,1\n2,0.5\n", {}),
        ("r;energy\n0.5;4\n1;2\n1.5;1\n2;0.5\n", {}),
        ("U,r\n4,0.5\n2,1\n1,1.5\n0.5,2\n", {}),
        ("x y\n0.5 .4D+01\n1 2d0\n1.5 1.D0\n2 5D-1\n", {}),
        ("1 0.5 4 0\n2 1 2 0\n3 1.5 1 0\n4 2 0.5 0\n", {"columns": [2, 3]}),
        (
            "a b c\n4 x 1\n".replace("x", "0.5") + "2 1 1\n1 1.5 1\n.5 2 1\n",
            {"columns": ["b", "a"]},
        ),
        (LAMMPS.format("AR"), {}),
        (LAMMPS.format("KR") + LAMMPS.format("AR"), {"section": "AR"}),
    ],
)
def test_files_of_columns(text, settings, tmp_path):
    (tmp_path / "curve.csv").write_text(text, encoding="utf-8")
    expected = from_points([0.5, 1.0, 1.5, 2.0], [4.0, 2.0, 1.0, 0.5])
    assert from_csv(tmp_path / "curve.csv", **settings) == expected


@pytest.mark.parametrize(
    ("text", "settings", "message"),
    [
        ("1 2 3 4\n", {}, "columns: is missing: .* has 4 columns; give the numbers or headings"),
        ("1 2 3 4\n", {"columns": [1, 5]}, r"columns\[1\]: must be a number from 1 to 4, got 5"),
        ("1 2\n1 2 3\n", {}, 'two numbers in each line, got "1 2 3" in line 2'),
        (LAMMPS.format("A") + LAMMPS.format("B"), {}, 'section: must be one of .*: "A", "B"'),
        (LAMMPS.format("A")[:-14], {}, "must have as many rows as N in line 4 says"),
        ("1 2\n", {"section": "A"}, "section: cannot be given"),
        ("0,8;10,5\n1,2;3,5\n", {"columns": [1, 3]}, "decimal comma in the line '0,8;10,5'; write"),
        ("r U\n0,8 10\n1,2 3,5\n", {"columns": [1, 2]}, "decimal comma in the line '0,8 10'"),
        ("8,05e-01\t2,1E+01\n1\t3\n", {"columns": [1, 3]}, "decimal comma"),
        ("r,U\n0,8,10,5\n", {"columns": [1, 2]}, "got 2 headings and 4 columns"),
    ],
)
def test_columns_that_are_not_clear(text, settings, message, tmp_path):
    (tmp_path / "curve.csv").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=message):
        from_csv(tmp_path / "curve.csv", **settings)


@pytest.mark.slow
def test_a_run_below_a_table_stops():
    """Below its first point a table is nan, which stops a run."""
    r = np.linspace(0.6, 4.0, 60)
    scene = pair(from_points(r, -1.0 / r).with_cutoff(3.5))
    with pytest.warns(tribo.TriboWarning, match="NotFinite"):
        result = tribo.simulate(scene, method="midpoint", step=0.01)
    assert result.status == "NotFinite"
    assert 0.0 < result.t[-1] < scene.duration


# --- expressions ---------------------------------------------------------------------------------

FORMULAE = [
    ("a*(exp(-2*b*(r-c)) - 2*exp(-b*(r-c)))", {"a": 0.4, "b": 1.6, "c": 0.7}),
    ("a*((s/r)**12 - (s/r)**6)", {"a": 1.2, "s": 0.9}),
    ("a*exp(-r/b) - c/r**6 + q/r", {"a": 50.0, "b": 0.3, "c": 1.0, "q": -1.0}),
    ("k*r", {"k": 2.0}),
    ("-k*(r - x)**2/2", {"k": 2.0, "x": 0.5}),
    ("a**r + r**a + r**r", {"a": 1.7}),
    ("a*sin(pi*r)*cos(r)/tan(r/4)", {"a": 0.3}),
    ("a*sinh(r)/cosh(2*r) + tanh(1/r)", {"a": 0.3}),
    ("log(1 + a*r)*sqrt(r*r + +a) - r**-a", {"a": 0.7}),
    ("q*q/sqrt(r**2 + s**2)/(1 + r)/2**r", {"q": 3.0, "s": 0.2}),
    ("(r - a)/(r + a) - (a/r - r/a)**3", {"a": 0.9}),
    ("a*max(1 - r/d, 0)**2.5 - min(r, d)**3/r", {"a": 2.0, "d": 2.1}),
    ("sqrt(max(d - r, 0))*(d - r)**2 + r", {"d": 2.1}),
    ("a*(d - r)**3 if r < d else -a*log(r/d)**2", {"a": 2.0, "d": 2.1}),
]


@pytest.mark.parametrize(("text", "parameters"), FORMULAE)
def test_expressions_and_their_derivatives(text, parameters):
    """Energy and force equal the expression and its derivative in 50 digits, to round-off."""
    potential = expression(text, **parameters)
    names = {name: getattr(mpmath, name) for name in ("pi", *FUNCTIONS)} | {"max": max, "min": min}
    names |= {name: mpmath.mpf(value) for name, value in parameters.items()}

    def exact(r):
        return eval(text, names, {"r": r})

    for r in (0.3, 0.77, 1.0, 1.9, 3.3):
        energy = exact(mpmath.mpf(r))
        force = -mpmath.diff(exact, mpmath.mpf(r))
        assert potential.energy(r) == pytest.approx(float(energy), rel=1e-12, abs=1e-13)
        assert potential.force(r) == pytest.approx(float(force), rel=1e-11, abs=1e-12)
    both = potential.energy(np.array([0.3, 1.9]))
    assert both[1] == pytest.approx(potential.energy(1.9), rel=1e-15, abs=0.0)


REFUSED = [
    ("1/r + q^2", "must be an expression with ** for powers instead of ^"),
    ("foo(r)", "not 'foo(r)' at its character 1"),
    ("s*r.real", "not 'r.real' at its character 3"),
    ("__import__('os').system('true')*r", "not \"__import__('os').system('true')\""),
    ("s*(lambda: r)()", "not '(lambda: r)()'"),
    ("[r][0]*1", "not '[r][0]'"),
    ("s*r if r else 2/r", "not 's*r if r else 2/r'"),
    ("where(r, s*r, 2/r)", "where(r < d, a, b) only, not 'where(r, s*r, 2/r)'"),
    ("max(s)*r", "max(a, b) and where(r < d, a, b) only, not 'max(s)'"),
    ("exp(r, r)", "not 'exp(r, r)'"),
    ("exp(x=r)", "not 'exp(x=r)'"),
    ("exp*r", "not 'exp'"),
    ("s*True*r", "not 'True' at its character 3"),
    ("s*1j*r", "not '1j'"),
    ("s*'r'", "not \"'r'\""),
    ("s*r > 0*r", "not 's*r > 0*r'"),
    ("s*r//2", "not 's*r//2'"),
    ("s*1e999*r", "must be an expression with finite numbers"),
    ("s*(r", "must be an expression with valid syntax ('(' was never closed"),
    ("s + t*2", "must be an expression with the distance r"),
    ("energy*r", 'must be an expression with another name for the parameter "energy"'),
    ("cutoff*r", 'must be an expression with another name for the parameter "cutoff"'),
    ("_s*r", 'must be an expression with another name for the parameter "_s"'),
    ("mose", 'did you mean "morse"?'),
    ("lenard-jones", 'did you mean "lennard-jones"?'),
    ("r", 'must be "coulomb", "yukawa"'),
]


@pytest.mark.parametrize(("text", "problem"), REFUSED)
def test_invalid_expressions(text, problem):
    """The message names the part that is not allowed and its position."""
    with pytest.raises(InputError) as caught:
        named(text, s=1.0)
    assert str(caught.value).startswith("potential: ")
    assert problem in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("parameters", "sentence"),
    [
        ({"s": 1.0}, "n: is missing"),
        ({"s": 1.0, "n": 2.0, "m": 1.0}, "m: is not a known key; known here: s, n"),
        ({"s": 1.0, "n": "2"}, "n: must be a number, got '2'"),
    ],
)
def test_parameters_of_an_expression(parameters, sentence):
    """Parameters of expressions are checked like those of any potential."""
    with pytest.raises(InputError) as caught:
        expression("s/r**n", **parameters)
    assert str(caught.value) == sentence


def pair(potential, duration=4.0, charge=1.0):
    """Two asperites that pass one another at a short distance."""
    upper = tribo.Surface(
        "upper", bob=(-1.5, 0.3), velocity=(0.8, 0.0), asperite=tribo.Asperite(charge=charge)
    )
    lower = tribo.Surface("lower", facing="up", drive=tribo.Free())
    return tribo.Scene((upper, lower), potential, duration, output=tribo.Output(samples=9))


def series(potential, charge=1.0):
    """Every series of the upper surface."""
    result = tribo.simulate(pair(potential, charge=charge), method="gauss-radau-15")
    assert result.status == "completed"
    return dict(result["upper"].items())


def test_an_expression_is_the_built_in():
    """Both runs agree in every quantity."""
    one = series(Morse(0.4, 1.6, 0.7))
    text = "D*(exp(-2*a*(r-r0)) - 2*exp(-a*(r-r0)))"
    other = series(expression(text, D=0.4, a=1.6, r0=0.7))
    for name, values in one.items():
        assert np.max(np.abs(values - other[name])) < 1e-10, name


class Both(NamedTuple):
    """Coulomb and Morse with a switch, written out as one potential."""

    strength: float
    D: float

    def energy(self, r):
        return self.energy_between(r, 1.0, 1.0)

    def energy_between(self, r, one, other):
        u = np.minimum(np.maximum((r - 1.8) / 0.2, 0.0), 1.0)
        e = np.exp(-2.0 * (r - 0.6))
        plain = one * other * self.strength / r + self.D * e * (e - 2.0)
        return plain * (1.0 - 10.0 * u**3 + 15.0 * u**4 - 6.0 * u**5)

    def force_between(self, r, one, other):
        return -self.energy_between(r + 1e-8, one, other) / 2e-8 + (
            self.energy_between(r - 1e-8, one, other) / 2e-8
        )


def test_a_sum_in_a_run():
    """Charged and uncharged parts with a cutoff, against the same written out by hand."""
    parts = Coulomb(0.3) + Morse(0.2, 2.0, 0.6)
    one = series(parts.with_cutoff(2.0), charge=-1.5)
    other = series(Both(0.3, 0.2), charge=-1.5)
    for name, values in one.items():
        assert np.max(np.abs(values - other[name])) < 1e-6, name
    assert np.max(np.abs(one["w1"])) > 1e-3


# --- files ---------------------------------------------------------------------------------------

FILE = """
duration = 1.0
[interaction]
{}
[[surface]]
name = "upper"
bob = [-3.0, 0.0]
[[surface]]
name = "lower"
facing = "up"
"""
WRITTEN = {
    "a sum": """potential = "sum"
        of = [{potential = "coulomb", strength = 0.2},
              {potential = "lennard-jones", epsilon = 0.1, sigma = 1.0, cutoff = 2.5}]
        cutoff = 4.0
        at_cutoff = "force-shift" """,
    "a sum of three": """potential = "sum"
        of = [{potential = "coulomb", strength = 0.2}, {potential = "born-mayer", A = 3, rho = 0.3},
              {potential = "sum", of = [{potential = "plummer", strength = 1.0, softening = 0.1},
                                        {potential = "k*r", k = 0.1}]}]""",
    "a scaled copy": """potential = "scaled"
        factor = -0.5
        of = {potential = "mie", epsilon = 0.1, sigma = 1.0, n = 10, m = 5, cutoff = 2.5}
        cutoff = 2.0 """,
    "a table": """potential = "table"
        r = [0.5, 1.0, 1.5, 2.0, 3.0]
        energy = [4.0, 2, 1, 0.5, 0.0]
        cutoff = 2.5 """,
    "a table of its own error": """potential = "table"
        r = [0.5, 1.0, 1.5, 2.0, 3.0]
        energy = [4.0, 2, 1, 0.5, 0.0]
        error = 0.125 """,
    "a table in a file": 'potential = "table"\nfile = "curve.csv"',
    "an expression": 'potential = "s*exp(-r/l)/r"\ns = 2\nl = 0.5\ncutoff = 3.0',
    "one in a module": 'potential = "own_potentials.soft:Soft"\ns = 2\ncutoff = 3.0',
    **{
        name: f'potential = "{name}"\n'
        + "\n".join(f"{field} = {1.5 + k}" for k, field in enumerate(reversed(cls._fields)))
        for name, cls in BUILT_IN.items()
    },
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with a curve in a file, and a package to import."""
    (tmp_path / "curve.csv").write_text("0.5,4\n1.0,2\n1.5,1\n2.0,0.5\n3.0,0\n")
    package = tmp_path / "own_potentials"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "soft.py").write_text(
        "from typing import NamedTuple\n"
        "class Soft(NamedTuple):\n"
        "    s: float\n"
        "    def energy(self, r): return self.s / (1.0 + r * r)\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    return tmp_path


@pytest.mark.parametrize("name", WRITTEN)
def test_round_trip(folder, name):
    """A potential that is read, written and read again is the same, and is the expected one."""
    scene = scene_from(tomllib.loads(FILE.format(WRITTEN[name])), folder)
    (potential,) = (i.potential for i in scene.interactions)
    again = scene_from(tomllib.loads(scene.to_toml()))
    assert type(again.interactions[0].potential) is type(potential)
    assert again.interactions[0].potential == potential
    assert as_table(again.interactions[0].potential) == as_table(potential)
    if name.startswith("a table of"):
        assert potential.error == 0.125
    if name == "one in a module":
        assert as_table(potential)["potential"] == "own_potentials.soft:Soft"


def test_a_result_keeps_its_potential(tmp_path):
    """A result file keeps a sum with a table and an expression."""
    parts = (
        tabulated(Morse(0.4, 1.6, 0.7).energy, 0.1, 9.0, 1e-4),
        expression("s/r**n", s=0.1, n=1),
    )
    scene = pair(sum(parts), duration=0.5)
    result = tribo.simulate(scene, method="midpoint", step=0.1)
    result.save(tmp_path / "result.nc")
    loaded = tribo.load_result(tmp_path / "result.nc")
    assert loaded.scene.interactions[0].potential == scene.interactions[0].potential


WRONG = [
    ('potential = "sum"', "interaction.of: is missing"),
    ('potential = "sum"\nof = 5', "interaction.of: must be a list of potentials, got 5"),
    ('potential = "sum"\nof = []', "interaction.of: must be two or more potentials, got 0"),
    (
        'potential = "sum"\nof = [{potential = "coulomb", strength = 1}, {potential = "mie"}]',
        "interaction.of[1].epsilon: is missing",
    ),
    ('potential = "sum"\nof = [5, 6]', "interaction.of[0]: must be a table, got 5"),
    (
        'potential = "scaled"\nfactor = 2\nof = {potential = "mose"}',
        "interaction.of.potential: 'mose' is not a known name; ",
    ),
    ('potential = "scaled"\nof = {potential = "mose"}', "interaction.factor: is missing"),
    ('potential = "table"\nr = [1, 2, 3]', "interaction.energy: is missing"),
    (
        'potential = "table"\nr = [1, 2, 3]\nenergy = [1, 2, 3]',
        "interaction.r: must be at least 4 numbers, got 3",
    ),
    (
        'potential = "table"\nr = [1, 2, 3, 4]\nenergy = [1, 2, 3]',
        "interaction.energy: has 3 values for 4 distances",
    ),
    (
        'potential = "table"\nr = [1, 3, 2, 4]\nenergy = [1, 2, 3, 4]',
        "interaction.r[2]: must be above r[1] = 3, got 2",
    ),
    ('potential = "table"\nfile = "no.csv"', "interaction.file: "),
    ('potential = "table"\nfile = 5', "interaction.file: must be the name of a file, got 5"),
    (
        'potential = "mie"\nepsilon = 1\nsigma = 1\nn = 6\nm = 12',
        "interaction.n: must be above m = 12, got 6",
    ),
    ('potential = "morse"\nD = 1\nalpha = 0\nr0 = 1', "interaction.alpha: must be positive [1"),
    ('potential = "yukawa"\nstrength = 1\nscreening = -1', "interaction.screening: must not be n"),
    ('potential = "nowhere:Own"', 'interaction.potential: the module "nowhere" cannot be loaded'),
    ('potential = "math:Own"', "interaction.potential: math defines no Own"),
]


@pytest.mark.parametrize(("text", "sentence"), WRONG)
def test_wrong_potentials_in_a_file(tmp_path, text, sentence):
    """The message names the key."""
    with pytest.raises(InputError) as caught:
        scene_from(tomllib.loads(FILE.format(text)), tmp_path)
    assert str(caught.value).startswith(sentence) and "\n" not in str(caught.value)


CALLS = [
    (lambda: Coulomb(1.0) + 5, "potential: can be added to potentials only, not to 5"),
    (lambda: "x" + Coulomb(1.0), "potential: can be added to potentials only, not to 'x'"),
    (lambda: Coulomb(1.0) * "a", "factor: must be a number, got 'a'"),
    (lambda: math.nan * Coulomb(1.0), "factor: must be a finite number, got nan"),
    (lambda: as_potential((1.0, 2.0)), "potential: must be a potential, of a class that derives"),
    (lambda: Coulomb(1.0).with_cutoff(2.0).with_cutoff(1.0), "cutoff: must be given once"),
    (lambda: tabulated(math.exp, 1.0, 2.0, 0.0), "tolerance: must be positive [energy], got 0.0"),
    (lambda: tabulated(np.exp, 2.0, 1.0, 1e-3), "high: must be above low = 2 [length], got 1"),
    (lambda: tabulated(lambda r: 1.0 * (r < 1.7), 1.0, 2.0, 1e-3), "tolerance: must be more than"),
    (lambda: tabulated(np.cos, 1.0, 9.0, 1e-17), "tolerance: must be more than 1e-17 [energy]"),
    (lambda: from_points([1, 2, 3, 4], [1, 2, math.nan, 4]), "energy[2]: must be a finite number"),
]


@pytest.mark.parametrize(("call", "sentence"), CALLS, ids=range(len(CALLS)))
def test_wrong_potentials_in_python(call, sentence):
    """The functions raise the same errors."""
    with pytest.raises(InputError) as caught:
        call()
    assert str(caught.value).startswith(sentence)


# --- methods -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("at_cutoff", "method", "note"),
    [
        ("truncate", "midpoint", "the energy of 'coulomb' jumps"),
        ("shift", "midpoint", "'coulomb' has 0 continuous derivatives; midpoint needs 1"),
        ("force-shift", "midpoint", None),
        ("force-shift", "kahan-li-6", "'coulomb' has 1 continuous derivatives; kahan-li-6 needs 2"),
        ("switch", "kahan-li-6", None),
    ],
)
def test_notes_on_smoothness(at_cutoff, method, note):
    """A note names a potential that is not smooth enough for the method, and no other."""
    scene = pair(Coulomb(0.2).with_cutoff(1.8, at_cutoff), duration=0.2)
    notes = run_notes(lay_out(scene), METHODS[method], None)
    assert (not notes) if note is None else notes[0].startswith(note)


def test_no_function_of_a_user_is_written_to():
    """The methods of this package are documented; a function without documentation stays so."""

    def inverse(self, r):
        return self.s / r

    class Own(tribo.Potential):
        s: float
        energy = inverse

    assert inverse.__doc__ is None and Own(0.2).force(2.0) == pytest.approx(0.05)
    assert "[energy]" in tribo.Coulomb.energy.__doc__ and "positive" in tribo.Morse.force.__doc__
