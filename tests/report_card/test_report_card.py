"""Report cards: every potential of the package passes, and every kind of flaw is found.

Each flaw is put into a correct potential by itself.  The check for it must fail, and checks of
other properties must pass.
"""

import json
import shlex
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from support.command import main
from tribo import InputError, Potential, check
from tribo.potentials import (
    BUILT_IN,
    LennardJones,
    Morse,
    as_potential,
    expression,
)
from tribo.potentials.cutoff import AT_CUTOFF
from tribo.potentials.expression import is_expression
from tribo.potentials.tables import MADE, from_table
from tribo.report_card.agreement import check_agreement, check_third_law
from tribo.report_card.derivatives import check_force, curves, derivative
from tribo.report_card.scan import PotentialScan
from tribo.report_card.smoothness import strengths

LJ = {"potential": "lennard-jones", "epsilon": 1.0, "sigma": 1.0}
COULOMB = {"potential": "coulomb", "strength": 0.5}
PLACES = np.linspace(0.8, 3.0, 60)

# Parameters of every built-in potential: soft, stiff, or in unusual units.
PARAMETERS = {
    "coulomb": [{"strength": 0.2}, {"strength": -2.3e-28}],
    "lennard-jones": [{"epsilon": 1.0, "sigma": 1.0}, {"epsilon": 1.65e-21, "sigma": 3.4e-10}],
    "morse": [{"D": 1.0, "alpha": 2.0, "r0": 1.5}, {"D": 4.7, "alpha": 500.0, "r0": 1.0}],
    "yukawa": [{"strength": 1.0, "screening": 2.0}, {"strength": -1.0, "screening": 0.01}],
    "buckingham": [
        {"A": 1388.8, "rho": 0.36, "C": 175.0},
        {"A": 1e-3, "rho": 0.3, "C": 5.0},
        {"A": 2.0, "rho": 0.3, "C": 0.0},
    ],
    "born-mayer": [{"A": 1000.0, "rho": 0.3}, {"A": 1e-17, "rho": 2e-11}],
    "weeks-chandler-andersen": [{"epsilon": 1.0, "sigma": 1.0}, {"epsilon": 2.0, "sigma": 1e-9}],
    "mie": [
        {"epsilon": 1.0, "sigma": 1.0, "n": 9.0, "m": 6.0},
        {"epsilon": 1.0, "sigma": 2.0, "n": 36.0, "m": 35.0},
        {"epsilon": 0.2, "sigma": 2.0, "n": 50.0, "m": 6.0},
    ],
    "plummer": [{"strength": 1.0, "softening": 0.1}, {"strength": -1.0, "softening": 10.0}],
    "hertz": [{"A": 2.0, "d": 1.3}, {"A": 1e-18, "d": 1e-9}],
    "soft-sphere": [{"epsilon": 1.0, "sigma": 2.0, "n": 9.5}],
    "gaussian": [{"height": 1.0, "width": 0.3}, {"height": -2.0, "width": 20.0}],
    "sum": [{"of": [LJ, COULOMB]}, {"of": [LJ | {"cutoff": 2.5}, COULOMB | {"cutoff": 4.0}]}],
    "scaled": [{"factor": -2.0, "of": LJ}],
    "ase-dimer": [
        {
            "calculator": "ase.calculators.lj:LennardJones",
            "arguments": {"epsilon": 1.0, "sigma": 1.0, "rc": 1e4},
            "symbols": ["Ar", "Ar"],
            "low": 0.85,
            "high": 3.0,
            "tolerance": 1e-6,
        }
    ],
    "table": [{"r": PLACES.tolist(), "energy": LennardJones(1.0, 1.0).energy(PLACES).tolist()}],
    "a*exp(-(r - b)**2/c**2) - cos(k*r)/r": [{"a": 1.0, "b": 3.0, "c": 0.5, "k": 6.0}],
}
RUN = {"lennard-jones"}  # compiled in the default set


def failed(report):
    """Names of the checks that failed."""
    return {line.name for line in report.checks if not line.passed}


def test_every_built_in_has_an_entry():
    """Every potential of the registry has parameters above."""
    assert {name for name in PARAMETERS if not is_expression(name)} == {*BUILT_IN, *MADE}


@pytest.mark.parametrize(
    ("name", "parameters"),
    [
        pytest.param(name, item, marks=[pytest.mark.slow] if k > 0 or name not in RUN else [])
        for name, sets in PARAMETERS.items()
        for k, item in enumerate(sets)
    ],
)
def test_built_in(name, parameters, tmp_path):
    """Every check passes."""
    report = check(from_table({"potential": name} | parameters, tmp_path))
    assert report.passed, str(report)
    lines = {line.name for line in report.checks}
    if name in ("lennard-jones", "morse", "mie"):
        assert "minimum" in lines


@pytest.mark.parametrize("name", [name for name in PARAMETERS if name not in RUN])
def test_built_in_uncompiled(name, tmp_path, uncompiled):
    """Without compiled code, which test_lanes compares."""
    report = check(from_table({"potential": name} | PARAMETERS[name][0], tmp_path))
    assert report.passed, str(report)
    assert len(report.checks) >= 8


@pytest.mark.parametrize("at_cutoff", AT_CUTOFF)
def test_cutoffs(at_cutoff, uncompiled):
    """Each cutoff is as smooth as declared, and has no bound where it declares nothing."""
    report = check(LennardJones(1.0, 1.0).with_cutoff(2.5, at_cutoff))
    assert report.passed, str(report)
    names = ["energy at the cutoff", "force at the cutoff", "slope at the cutoff"]
    promised = {"truncate": 0, "shift": 1, "force-shift": 2, "switch": 3}[at_cutoff]
    assert [report[name].bound is not None for name in names] == [k < promised for k in range(3)]
    at_end = LennardJones(1.0, 1.0).energy(2.5)
    unit = report.curves.length
    if at_cutoff == "truncate":
        ratio = report[names[0]].value / report[names[1]].value
        assert ratio == pytest.approx(abs(at_end / LennardJones(1.0, 1.0).force(2.5)) / unit)


# --- flaws ---------------------------------------------------------------------------------------

AT = 1.3  # distance of flaws at a single distance [length]


class Flawed(NamedTuple):
    """Lennard-Jones of unit depth and length, with a flaw."""

    force_off: float = 0.0  # relative error of the force
    energy_off: float = 0.0  # relative error of the energy
    jump: float = 0.0  # of U at AT
    turn: float = 0.0  # jump of the force at AT, with the kink of U
    bend: float = 0.0  # kink of the force at AT, with the bend of U
    hole: float = 0.0  # distance at which U is nan
    drag: float = 0.0  # constant force
    last: float = 0.0  # distance from which the force is nan, if not 0
    end: float = 0.0  # cutoff, if not 0
    deep: float = 1.0  # declared depth

    def energy(self, r):
        s6 = (1.0 / r) ** 6
        past = np.maximum(r - AT, 0.0)
        extra = self.jump * (r > AT) - self.turn * past - 0.5 * self.bend * past**2
        whole = (1.0 + self.energy_off) * 4.0 * s6 * (s6 - 1.0) + extra * np.exp(-past)
        return whole / np.where(r == self.hole, np.nan, 1.0)

    def force(self, r):
        s6 = (1.0 / r) ** 6
        past = np.maximum(r - AT, 0.0)
        extra = self.jump * (r > AT) - self.turn * past - 0.5 * self.bend * past**2
        rate = self.turn * (r > AT) + self.bend * past
        whole = (1.0 + self.force_off) * 24.0 / r * s6 * (2.0 * s6 - 1.0)
        whole += (rate + extra * (r > AT)) * np.exp(-past) + self.drag
        return whole / np.where((self.last > 0.0) & (r > self.last), np.nan, 1.0)

    def feature(self):
        return 1.0 / 6.0, 2.0

    def range(self):
        return self.end if self.end > 0.0 else np.inf

    def minimum(self):
        return 2.0 ** (1.0 / 6.0), -self.deep, 72.0 / 2.0 ** (1.0 / 3.0)


AT_END = {"energy at the cutoff", "force at the cutoff", "slope at the cutoff"}
JUMPS = {"jumps of energy", "jumps of force", "kinks of force"}

# Each flaw, the check for it, and other checks that it also affects.
# The curvature at the minimum is that of the force, so a wrong force fails that check too.
FLAWS = {
    "force off": ({"force_off": 1e-7}, "force", {"minimum"}),
    "force off a little": ({"force_off": -1e-9}, "force", {"minimum"}),
    "energy in other units": ({"energy_off": 0.0364}, "force", {"minimum"}),
    "both in other units": ({"energy_off": 0.0364, "force_off": 0.0364}, "minimum", set()),
    "jump": ({"jump": 1e-6}, "jumps of energy", JUMPS),
    "kink of the energy": ({"turn": 1e-6}, "jumps of force", {"kinks of force"}),
    "kink of the force": ({"bend": 1e-2}, "kinks of force", set()),
    "hole": ({"hole": 1.5}, "finite", {"minimum"}),
    "drag": ({"drag": 1e-6}, "limits", {"force"}),
    "nothing far away": ({"last": 1e3}, "limits", set()),
    "jump at the end": ({"end": 3.0}, "energy at the cutoff", AT_END | JUMPS),
    "depth": ({"deep": 1.0 + 1e-8}, "minimum", set()),
}


@pytest.mark.slow
def test_no_flaw():
    assert failed(check(Flawed())) == set()


@pytest.mark.parametrize("flaw", FLAWS)
def test_flaw(flaw):
    """The check for it fails, and checks of other properties pass."""
    how, meant, others = FLAWS[flaw]
    report = check(Flawed(**how))
    assert meant in failed(report), str(report)
    assert failed(report) <= {meant} | others, str(report)
    assert not report.passed


@pytest.mark.thorough
@given(st.floats(-9.0, -2.0), st.sampled_from([-1.0, 1.0]))
def test_size_of_a_flaw(digits, sign):
    """The error on the card is that of the force."""
    off = sign * 10.0**digits
    line = check_force(curves(PotentialScan(as_potential(Flawed(force_off=off)))))
    assert not line.passed
    assert 0.3 * abs(off) < line.value < 1.01 * abs(off)


@pytest.mark.parametrize(
    ("flaw", "name", "place"),
    [
        ("jump", "jumps of energy", AT),
        ("kink of the force", "kinks of force", AT),
        ("hole", "finite", 1.5),
        ("jump at the end", "energy at the cutoff", 3.0),
    ],
)
def test_place(flaw, name, place):
    """The card has the distance of the flaw, within a cell of the scan."""
    report = check(Flawed(**FLAWS[flaw][0]))
    assert report[name].where == pytest.approx(place, rel=0.03)
    assert f"r = {report[name].where:.9g}" in str(report)


def test_strength_of_a_flaw():
    """Jumps and kinks have the right size, in units of the scale."""
    for how, k, size in (({"jump": 1e-4}, 0, 1e-4), ({"turn": 1e-4}, 1, 1e-4)):
        scan = PotentialScan(as_potential(Flawed(**how)))
        found = strengths(scan, lambda r, k=k, s=scan: s.compiled(r)[k], 1 - k)[0].max()
        unit = scan.scale(AT) * (AT if k == 0 else 1.0)
        assert found * unit == pytest.approx(size, rel=0.05)


class OneSided(NamedTuple):
    """A coupling that is not symmetric in the two bobs."""

    strength: float

    def energy(self, r):
        return self.strength / r

    def force(self, r):
        return self.strength / (r * r)

    def coupling(self, one, other):
        return one * one * other


def test_third_law():
    """A symmetric coupling passes, and one that is not fails."""
    scan = PotentialScan(as_potential(OneSided(1.0)))
    assert not check_third_law(scan).passed
    scan.potential = BUILT_IN["coulomb"](1.0)
    assert check_third_law(scan).passed


class OfScalars(NamedTuple):
    """A potential that takes no arrays, which no run needs."""

    strength: float

    def energy(self, r):
        return self.strength / r if r > 0.01 else 100.0 * self.strength

    def force(self, r):
        return self.strength / (r * r) if r > 0.01 else 0.0


def test_arrays():
    arrays, compiled = check_agreement(PotentialScan(as_potential(OfScalars(1.0))))
    assert compiled.passed and arrays.passed
    assert "np.where" in arrays.note


class OfTheLargest(NamedTuple):
    """An array of energies is that of its largest distance."""

    strength: float

    def energy(self, r):
        return self.strength / np.max(r) + 0.0 * r

    def force(self, r):
        return self.strength / (r * r)


def test_wrong_arrays():
    scan = PotentialScan(as_potential(Flawed()))
    scan.potential = OfTheLargest(1.0)
    scan.potential = as_potential(scan.potential)
    arrays, _ = check_agreement(scan)
    assert not arrays.passed and arrays.advice


# --- a stale cache -------------------------------------------------------------------------------

OWN = """
from typing import NamedTuple
from own_factor import FACTOR
class Own(NamedTuple):
    s: float
    def energy(self, r): return FACTOR * self.s / r
    def force(self, r): return FACTOR * self.s / (r * r)
"""
STALE = """
import io, pickle, sys
from pathlib import Path
from tribo.compiler import cache
from tribo.potentials.tables import from_table
from tribo.report_card.agreement import check_agreement
from tribo.report_card.scan import PotentialScan
def of_any_version(self, key):
    unit = self._name.partition("_unit_")[0]
    for path in self._folder.glob(f"{unit}_unit_*.nbc"):
        stream = io.BytesIO(path.read_bytes()[cache.CHECKSUM:])
        pickle.load(stream)
        return pickle.load(stream)
if sys.argv[2] == "wrong":
    cache.CodeFiles.load = of_any_version
own = from_table({"potential": "own.py:Own", "s": 1.0}, Path(sys.argv[1]))
print(*(line.name for line in check_agreement(PotentialScan(own)) if not line.passed))
"""


@pytest.mark.parametrize("stamp", ["right", "wrong"])
def test_stale_cache(tmp_path, server, stamp):
    """If the disk cache served an old version, the check of compiled code would fail."""
    (tmp_path / "own.py").write_text(OWN)
    place = {"folders": [tmp_path], "NUMBA_CACHE_DIR": tmp_path / "cache"}
    said = []
    for factor in (1.0, 1.0 + 1e-9):
        (tmp_path / "own_factor.py").write_text(f"FACTOR = {factor!r}\n")
        said.append(server.run(STALE, tmp_path, stamp, **place).split())
    assert said == [[], ["compiled"] if stamp == "wrong" else []]


# --- derivatives ---------------------------------------------------------------------------------


@pytest.mark.parametrize("r", [0.3, 1.0, 7.0])
def test_a_derivative_knows_its_error(r):
    """The error is within a few uncertainties, and both are far below round-off of U'."""
    for function, slope in (
        (lambda x: x**-12, lambda x: -12.0 * x**-13),
        (lambda x: np.exp(-5.0 * x), lambda x: -5.0 * np.exp(-5.0 * x)),
    ):
        found, uncertainty = derivative(function, r, 0.1 * r)
        truth = float(slope(np.longdouble(r)))
        assert uncertainty < 1e-12 * abs(truth)
        assert abs(found - truth) <= 3.0 * uncertainty


def test_a_derivative_of_pieces():
    """Beside a kink, and beside the end of the domain, differences are short enough."""

    def pieces(x):
        return x**3 if x < 1.0 else (x**2 if x < 1.5 else np.nan)

    r = np.array([0.99, 1.01, 1.49])
    found, uncertainty = derivative(np.vectorize(pieces, otypes=[np.longdouble]), r, 0.1 * r)
    assert np.all(uncertainty < 1e-12)
    assert np.all(np.abs(found - [3.0 * 0.99**2, 2.0 * 1.01, 2.0 * 1.49]) <= 3.0 * uncertainty)


def test_a_noisy_energy_is_not_judged(uncompiled):
    """A noisy energy has no derivative to ten digits: the check fails and says so."""

    class Noisy(NamedTuple):
        s: float

        def energy(self, r):
            return self.s / r * (1.0 + 1e-8 * np.sin(1e7 * r))

        def force(self, r):
            return self.s / (r * r)

    line = check_force(curves(PotentialScan(as_potential(Noisy(1.0)))))
    assert not line.passed and line.failed
    assert "dU/dr is known at only" in line.note


# --- text, JSON, figure, status ------------------------------------------------------------------


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    """Call ``tribo check`` in an empty folder; returns status, stdout and stderr."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments):
        status = main(["check", *map(str, arguments)])
        return status, *capsys.readouterr()

    return call


def test_status_and_text(run):
    status, out, err = run("lennard-jones", "epsilon=1", "sigma=1")
    assert status == 0 and err == ""
    assert out.startswith("lennard-jones epsilon=1 sigma=1, from r = ")
    assert out.splitlines()[-1].startswith("passed: all ")


def test_a_formula_that_begins_with_a_minus(run):
    """It is no option; the one for help still is."""
    status, out, _ = run("-h/r**3", "h=0.1", "--json")
    assert status == 0 and json.loads(out)["passed"]
    with pytest.raises(SystemExit, match=r"^0$"):
        run("-h")


WRONG = """
from typing import NamedTuple
class Wrong(NamedTuple):
    epsilon: float
    sigma: float
    def energy(self, r):
        s6 = (self.sigma / r) ** 6
        return 4.0 * self.epsilon * s6 * (s6 - 1.0)
    def force(self, r):
        s6 = (self.sigma / r) ** 6
        return 24.0000024 * self.epsilon / r * s6 * (2.0 * s6 - 1.0)
"""


def test_a_wrong_file(run, tmp_path):
    """A force with an error of 1e-7 fails, and the card has the distance and the error."""
    (tmp_path / "own.py").write_text(WRONG)
    status, out, _ = run("own.py:Wrong", "epsilon=1", "sigma=1", "--json")
    card = json.loads(out)
    line = next(line for line in card["checks"] if line["name"] == "force")
    assert status == 1 and not card["passed"] and not line["passed"]
    assert 3e-8 < line["value"] <= 1.01e-7
    assert line["grade"] == round(np.log10(line["value"] / 2.0**-52), 1)
    assert line["where"] > 0.0
    report = check(from_table({"potential": "own.py:Wrong", "epsilon": 1, "sigma": 1}, tmp_path))
    assert (report.potential, report.title) == (
        "own.py:Wrong epsilon=1 sigma=1",
        "Wrong epsilon=1 sigma=1",
    )


def test_json(run):
    """The keys of the contract; a cutoff is given as in a scene file."""
    status, out, _ = run(
        *("lennard-jones", "epsilon=1", "sigma=1", "cutoff=3", "at_cutoff=shift", "--json")
    )
    card = json.loads(out)
    assert status == 0
    assert set(card) == {"potential", "passed", "checks"}
    assert card["potential"] == "lennard-jones epsilon=1 sigma=1 cutoff=3 at_cutoff=shift"
    for line in card["checks"]:
        assert {"name", "passed", "value", "bound", "grade"} <= set(line)
        assert isinstance(line["passed"], bool) and isinstance(line["value"], float)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["gravity"], "potential: must be "),
        (["coulomb"], "strength: is missing"),
        (["coulomb", "strength"], "parameter: must be KEY=VALUE, got 'strength'"),
        (["coulomb", "strength=1", "strength=2"], "parameter strength: is given twice"),
        (["coulomb", "strength=strong"], "strength: must be a number, got 'strong'"),
        (["coulomb", "strength=1", "cutoff=3", "at_cutoff=bend"], "at_cutoff: must be "),
        (["none.py:None", "s=1"], "potential: there is no file"),
        (["broken.py:Broken", "s=1"], "potential: Broken.energy fails in line 4 of "),
        (["coulomb", "strength=1", "--figure", "card.txt"], "--figure: must end on .png"),
        (["coulomb", "strength=1", "--figure", "none/card.png"], "--figure: must be in a folder"),
    ],
)
def test_wrong_input(run, tmp_path, arguments, message):
    """Status 2, and one line that names the field."""
    (tmp_path / "broken.py").write_text(
        "from typing import NamedTuple\n"
        "class Broken(NamedTuple):\n"
        "    s: float\n"
        "    def energy(self, r): return open(r)\n"
        "    def force(self, r): return open(r)\n"
    )
    status, out, err = run(*arguments)
    assert status == 2 and out == ""
    assert err.startswith(f"tribo: {message}") and err.count("\n") == 1


def test_other_objects_are_refused():
    with pytest.raises(InputError, match=r"^potential: "):
        check(3.0)


def test_a_calculator_of_all_bobs(run, uncompiled):
    """The refusal has a command that gives a card."""
    status, _, err = run("ase", "calculator=ase.calculators.emt:EMT")
    assert status == 2 and err.startswith("tribo: potential: must be a potential of pairs")
    suggested = shlex.split(err.partition("tribo check ")[2])
    assert suggested[0] == "ase-dimer"
    assert run(*suggested)[1].startswith("table ")


class Odd(NamedTuple):
    """A narrow hill, which may have a hole, or raise an exception."""

    place: float
    hole: float = 0.0  # distance below which the energy is nan
    end: float = 0.0  # distance from which it raises, if not 0

    def energy(self, r):
        if 0.0 < self.end < r:
            raise ValueError("too far")
        return np.exp(-(((r - self.place) / 0.1) ** 2)) / np.where(r < self.hole, np.nan, 1.0)

    def force(self, r):
        return 200.0 * (r - self.place) * self.energy(r)


def test_odd_potentials():
    """Faint values are not judged by their digits; nan fails; exceptions are refused."""
    assert failed(check(Odd(3.0))) == set()
    assert {"finite", "force"} <= failed(check(Odd(3.0, hole=1e90)))
    with pytest.raises(InputError, match=r"^potential: Odd raises ValueError: too far"):
        check(Odd(3.0, end=5.0))


@pytest.mark.parametrize(
    "kind", ["png", *(pytest.param(kind, marks=pytest.mark.thorough) for kind in ("pdf", "svg"))]
)
def test_figure(run, tmp_path, kind):
    """The figure is written in the format that its name says."""
    status, _, _ = run("lennard-jones", "epsilon=1", "sigma=1", "--figure", f"card.{kind}")
    begins = {"png": b"\x89PNG", "pdf": b"%PDF", "svg": b"<?xml"}[kind]
    assert status == 0
    assert (tmp_path / f"card.{kind}").read_bytes().startswith(begins)


def test_figure_shows_the_curves():
    """Energy, force and disagreement at the card's own distances, and the cutoff."""
    from tribo.report_card.figure import card_figure

    report = check(LennardJones(1.0, 1.0).with_cutoff(3.0))
    energy, force, disagreement = card_figure(report.curves, report.title).axes
    assert energy.get_title() == report.title == report.potential
    for ax, values in ((energy, report.curves.energy), (force, report.curves.force)):
        line = max(ax.get_lines(), key=lambda line: len(line.get_xdata()))
        assert np.array_equal(line.get_xdata(), report.curves.r)
        shown = np.abs(values) < 0.5 * ax.get_ylim()[1]
        assert np.array_equal(np.asarray(line.get_ydata())[shown], values[shown])
    assert any(list(line.get_xdata()) == [3.0, 3.0] for line in disagreement.get_lines())


# --- another program -----------------------------------------------------------------------------


def test_a_given_calculator():
    """A potential passes with its own calculator, and fails with another one."""
    from ase.calculators.morse import MorsePotential

    peer = MorsePotential(epsilon=2.0, r0=1.5, rho0=4.5, rcut1=1e4, rcut2=2e4)
    assert check(Morse(2.0, 3.0, 1.5), ase=peer)["ase"].passed
    assert not check(Morse(2.0, 3.0001, 1.5), ase=peer)["ase"].passed


class Charged(Potential):
    """Coulomb's potential with a flaw between some charges."""

    strength: float
    unlike: float = 1.0  # factor of the force between unlike charges
    silent: float = 0.0  # whether unlike charges are said not to act

    def energy(self, r):
        return self.strength / r

    def energy_between(self, r, one, other):
        return one * other * self.strength / r

    def force_between(self, r, one, other):
        factor = self.unlike if one * other < 0.0 else 1.0
        return factor * one * other * self.strength / r**2

    def acts_between(self, one, other):
        return one * other > 0.0 or (one * other < 0.0 and self.silent == 0.0)


@pytest.mark.parametrize("flaw", [{}, {"unlike": 1.01}, {"unlike": -1.0}, {"silent": 1.0}])
def test_charges_of_either_sign(flaw):
    report = check(Charged(0.3, **flaw))
    assert failed(report) == ({"charges"} if flaw else set()), str(report)
    if flaw:
        assert ("acts_between" if "silent" in flaw else "0.7 and -1.3") in report["charges"].note


class Ending(Potential):
    """U = height (1 - r / d)^power below d; `cut` is whether it declares the range."""

    height: float
    d: float
    power: float
    cut: float = 0.0

    def energy(self, r):
        return self.height * np.maximum(1.0 - r / self.d, 0.0) ** self.power

    def range(self):
        return self.d if self.cut > 0.0 else np.inf


@pytest.mark.parametrize("d", [0.3, 0.7, 1.0, 5.0])
def test_a_kink_where_the_force_vanishes_is_found(d):
    """It lies at the end of the distances at which the force is felt."""
    assert failed(check(Ending(1.0, d, 2.0))) == {"kinks of force"}


def test_a_force_that_ends_as_a_root_does_not_jump():
    """The slope of the force does, as the card says."""
    assert failed(check(Ending(1.0, 1.5, 1.5, 1.0))) == {"slope at the cutoff"}


class Powers(Potential):
    """Integer powers: a division by zero near r = 0, and infinities far away."""

    strength: float

    def energy(self, r):
        return self.strength * (r**-12 - 1.0 / r**36)


def test_integer_powers_pass():
    assert failed(check(Powers(-1.0))) == set()


class Step(Potential):
    """A step of the energy, without any force."""

    h: float
    d: float

    def energy(self, r):
        return np.where(r < self.d, self.h, 0.0)


class Corner(Potential):
    """An energy with a kink, and its force by the sign of r - d."""

    h: float
    d: float

    def energy(self, r):
        return self.h * np.abs(r - self.d)


@pytest.mark.parametrize("h", [3.0, -3.0])
@pytest.mark.parametrize("d", [1e-9, 0.3, 0.7, 1.0, 2.3, 5.0, 1e6])
def test_a_step_is_found_and_located(d, h, uncompiled):
    """The scan contains it, and its distance is known to the last halving."""
    report = check(Step(h, d))
    assert failed(report) == {"jumps of energy"}
    assert report["jumps of energy"].where == pytest.approx(d, rel=1e-10)
    assert report.curves.r[0] < d < report.curves.r[-1]


def test_two_steps_that_are_close(uncompiled):
    """Cells around parameters are short."""
    shell = expression("where(r < a, 0.0, where(r < b, h, 0.0))", a=0.2, b=0.2001, h=1.0)
    assert failed(check(shell)) == {"jumps of energy"}


@pytest.mark.parametrize("d", [0.2, 0.7, 1.3])
def test_one_kink_is_one_advice(d):
    """The compiled value at the kink is that of a neighbour of r, and no difference."""
    report = check(Corner(3.0, d))
    assert failed(report) == {"jumps of force", "kinks of force"}
    assert report["jumps of force"].where == pytest.approx(d, rel=1e-9)
    assert report["kinks of force"].advice.startswith("see jumps of force")
    assert "smoothness" in report["jumps of force"].advice


def test_compiled_values_differ_at_a_jump(uncompiled):
    """Only the values of the next distances are taken for the same."""
    scan = PotentialScan(as_potential(Corner(3.0, 0.7)))
    before = scan.compiled
    scan.compiled = lambda r: tuple(1.0001 * each for each in before(r))
    _, compiled = check_agreement(scan)
    assert not compiled.passed and compiled.value == pytest.approx(1e-4, rel=0.5)


class OfPower(Potential):
    """A power with its exponent as a field."""

    n: float
    e: float = 1.0

    def energy(self, r):
        return self.e / r**self.n


class OfNamedPower(Potential):
    """The same with a name for the power."""

    n: float
    e: float = 1.0

    def energy(self, r):
        power = r**self.n
        return self.e / power


@pytest.mark.parametrize("kind", [OfPower, OfNamedPower])
@pytest.mark.parametrize("n", [6.5, 8.5, 11.5, 12.0, 36.0])
def test_powers_of_any_exponent(kind, n, uncompiled):
    """Their forces do not overflow where their energies do not, and no overflow is a length."""
    report = check(kind(n))
    assert report.passed, str(report)
    assert report.curves.length == 1.0
    for r in (1e-8, 1e8, 1e200 ** (1.0 / n)):
        assert kind(n).force(r) == pytest.approx(n * r ** (-n - 1.0), rel=1e-12)


@pytest.mark.parametrize(
    ("factor", "note"),
    [(-1.0, "the force has the wrong sign"), (0.5, "the force is 0.5 times -dU/dr"), (1.0, "")],
)
def test_a_force_that_is_a_multiple(factor, note, uncompiled):
    class Multiple(NamedTuple):
        s: float

        def energy(self, r):
            return self.s * np.exp(-r) / r

        def force(self, r):
            return factor * self.s * np.exp(-r) * (r + 1.0) / r**2

    line = check(Multiple(1.0))["force"]
    assert line.passed == (factor == 1.0)
    assert note in line.note and bool(note) == bool(line.note)
    assert "correct force()" in line.advice or line.passed


def test_advice_for_a_derived_force(uncompiled):
    """A class that defines none has none to correct."""

    class Rough(NamedTuple):
        s: float

        def energy(self, r):
            return (1e14 + self.s / r) - 1e14

    line = check(Rough(1.0))["force"]
    assert not line.passed
    assert line.advice.startswith("the force is derived from energy()")


def test_an_energy_that_collapses_is_noted(uncompiled):
    """Within a barrier, U falls without end; it does not in a core, and an attraction has none."""
    buckingham = expression("A*exp(-r/rho) - C/r**6", A=1000.0, rho=0.3, C=30.0)
    note = check(buckingham)["limits"].note
    assert "inside its barrier at r = 1.1" in note and "domain()" in note
    attractions = BUILT_IN["coulomb"](-1.0), BUILT_IN["gaussian"](-1.0, 1.0)
    for other in (LennardJones(1.0, 1.0), *attractions):
        assert "barrier" not in check(other)["limits"].note


def test_the_figure_marks_what_failed(uncompiled):
    """An energy that rises with r does not hide its kink."""
    from tribo.report_card.figure import card_figure

    report = check(Corner(1.0, 1.0))
    where = report["jumps of force"].where
    marks = {"jumps of force": where, "limits": 1e19}
    axes = card_figure(report.curves, report.title, marks).axes
    assert axes[0].get_ylim()[1] < 20.0
    assert [text.get_text() for text in axes[0].texts] == ["jumps of force"]
    for ax in axes:
        assert any(np.allclose(line.get_xdata(), where, rtol=1e-5) for line in ax.get_lines())
