"""A reference of 15 digits and more: scenes in long double or quadruple precision.

    solution = solve(tomllib.load(file))              # long double; if that falls short, quadruple
    solution = solve(table, precision="quad")         # __float128: 1e-22 or so, 20 times slower
    solution.end["surfaces"]["upper"]["w1"][0]        # as `tribo run --json`, and ["scales"]
    solution.surfaces["upper"]["w1"]                  # (times, asperites), as Result's ledger
    solution.blocks["upper"]["W"], solution.system["contact_energy"], solution.t
    solution.error["w1"]                              # by two tolerances, over all times

The equations are in reference.c, which the C compiler translates when it is first needed; they
share no code with the package.  Every work and every pseudowork is integrated in the lab frame from
its definition (force . velocity of its point of application, force . v_cm): no identity of the
ledger is used, so each of them is left to be tested.  Times, positions and forces of a scene are
exact: its numbers are those that doubles hold, and pi in `theta` is the double.

    from support.reference import compiler    # None where there is no C compiler
    pytestmark = pytest.mark.skipif(compiler() is None, reason="there is no C compiler")

It solves scenes with every built-in potential, sums and scaled ones, moving fields, springs, baths,
driven bars, rigid asperites, and reservoirs on bars and swings at temperature zero.  Conventions
where the design pages leave room:

- contact_energy is the contact between different surfaces; contact within one is in its E_int.
- `between` naming one surface twice asks for contact among its bobs. An interaction without
  `between` acts between all different surfaces; interactions on the same pair add up.
- A rigid free surface weighs what its asperites weigh: bath masses are not in M_surface.
- A forced or free drive cancels f1 only, never a field or contact within.
- wrap ties last to first along x and along z, in the directions in which the scene is periodic
  (in both where it is not periodic); a ring of two has two springs.
- Without an initial theta a pendulum starts at phi + rest.
- The mean initial velocity in the velocity scale is the plain mean over the surfaces.
- The energy scale covers the accounts of asperites that are reported (not wL_ps and wR_ps).

`UnsolvedError` is raised for a scene that cannot be solved (its `status` says why), and
NotImplementedError for one with anything else, as plug-ins and noise.
"""

from __future__ import annotations

import ctypes
import math
import shutil
import subprocess
import tempfile
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

PARAMETERS = {
    "m1": 1.0,
    "m2": 2.0,
    "kappa": 2.0,
    "length": 2.0,
    "bar_length": 3.0,
    "i2": 5.0,
    "charge": 1.0,
}
SOURCE = Path(__file__).with_name("reference.c")
POTENTIALS = {
    "coulomb": ("strength",),
    "morse": ("D", "alpha", "r0"),
    "lennard-jones": ("epsilon", "sigma"),
    "yukawa": ("strength", "screening"),
    "buckingham": ("A", "rho", "C"),
    "born-mayer": ("A", "rho"),
    "weeks-chandler-andersen": ("epsilon", "sigma"),
    "mie": ("epsilon", "sigma", "n", "m"),
    "plummer": ("strength", "softening"),
}
CHARGED = ("coulomb", "yukawa", "plummer")
CUTOFFS = ("", "switch", "truncate", "shift", "force-shift")
DRIVES = ("forced", "free", "rigid", "pulled", "bars")
STATUSES = ("done", "too costly", "step underflow", "not finite", "bobs coincide")
# The quantities of an asperite in the order of report() in the C source.
QUANTITIES = (
    *("theta", "phi", "omega", "nu", "x_cm", "y_cm", "vx_cm", "vy_cm"),
    *("x_bob", "y_bob", "x_bar", "y_bar", "w1", "w2", "wL", "wR", "w_int", "w"),
    *("w1_ps", "w2_ps", "w_int_ps", "w_ps", "delta_k_trans", "delta_e_int"),
    *("w_field", "w_field_ps", "w_T", "w_T_ps", "heat"),
)
# The velocity of the bob and the forces, which are not in the ledger.  f_int is that of springs and
# oscillators together.
FORCES = ("f1", "f2", "fL", "fR", "f_within", "f_field", "f_int")
BESIDE = ("vx_bob", "vy_bob", *(f"{force}_{axis}" for force in FORCES for axis in "xy"))
WIDTH = len(QUANTITIES) + len(BESIDE)
BLOCK = ("W", "W_ps", "delta_K", "delta_E_int")
SYSTEM = ("contact_energy", "total_energy_change", "applied_work")


class UnsolvedError(RuntimeError):
    """A scene that the reference cannot solve; `status` is one of STATUSES."""

    def __init__(self, status: str, info: Info) -> None:
        super().__init__(f"{status} at t = {info.t!r} after {info.evaluations:g} evaluations")
        self.status = status
        self.info = info


class Info(ctypes.Structure):
    """What a solution cost, and the smallest distance between two bobs."""

    _fields_ = [
        (name, ctypes.c_double) for name in ("evaluations", "steps", "smallest", "smallest_at", "t")
    ]
    evaluations: float
    steps: float
    smallest: float
    smallest_at: float
    t: float


class Arrays(ctypes.Structure):
    """The C type Scene."""

    COUNTS = ("n", "surfaces", "pairs", "terms", "fields", "springs", "oscillators", "torsionals")
    TABLES = (
        *("asperites", "surface", "pair", "term", "field", "spring"),
        *("oscillator", "torsional"),
    )
    _fields_ = [
        *((name, ctypes.c_int) for name in COUNTS),
        *((name, ctypes.POINTER(ctypes.c_double)) for name in TABLES),
        ("box_x", ctypes.c_double),
        ("box_z", ctypes.c_double),
    ]


@dataclass
class Solution:
    """All quantities at the recorded times, with a bound on their errors.

    Attributes
    ----------
    t : (times,) array
    surfaces, blocks, system : dict
        As in a Result's ledger.
    error : dict
        Quantity -> the largest difference between solutions with two tolerances.
    scales : dict
        Scales of errors, by kind: those of the scene-file page; "total" is that of the energies
        of surfaces and of the system, and "internal" the largest internal energy of an asperite.
    info : Info
    forces : dict
        Force and axis, as "f1_x" -> (times, asperites of all surfaces), and the bobs' velocities.
    """

    t: np.ndarray
    surfaces: dict[str, dict[str, np.ndarray]]
    blocks: dict[str, dict[str, np.ndarray]]
    system: dict[str, np.ndarray]
    error: dict[str, float]
    scales: dict[str, float]
    info: Info
    forces: dict[str, np.ndarray] = field(default_factory=dict)

    @property
    def end(self) -> dict[str, Any]:
        """The end state in the shape of `tribo run --json`."""
        return {
            "surfaces": {
                name: {q: v[-1].tolist() for q, v in table.items()}
                for name, table in self.surfaces.items()
            },
            "blocks": {
                name: {q: float(v[-1]) for q, v in table.items()}
                for name, table in self.blocks.items()
            },
            "system": {q: float(v[-1]) for q, v in self.system.items()},
            "scales": self.scales,
        }

    @property
    def has_work(self) -> bool:
        """Whether any force works; if none does, the scale of energies is rounding."""
        return any(np.any(series) for series in self.series("w1") + self.series("w"))

    def relative_error(self) -> float:
        """The largest error in units of its scale."""
        ratios = [0.0]
        for name, error in self.error.items():
            scale = self.scales[kind_of(name)]
            if error > 0.0:
                ratios.append(error / scale if scale > 0.0 else math.inf)
        return max(ratios)

    def as_table(self) -> dict[str, Any]:
        """All numbers as lists, which `solution_from` reads."""
        return {
            "t": self.t.tolist(),
            "surfaces": {name: _lists(table) for name, table in self.surfaces.items()},
            "blocks": {name: _lists(table) for name, table in self.blocks.items()},
            "system": _lists(self.system),
            "error": self.error,
            "scales": self.scales,
        }

    def series(self, name: str) -> list[np.ndarray]:
        """All series of a quantity."""
        tables = [self.system, *self.surfaces.values(), *self.blocks.values()]
        return [table[name] for table in tables if name in table]


def _lists(table: dict[str, np.ndarray]) -> dict[str, list]:
    return {name: values.tolist() for name, values in table.items()}


def _arrays(table: dict[str, list]) -> dict[str, np.ndarray]:
    return {name: np.array(values) for name, values in table.items()}


def solution_from(table: dict[str, Any]) -> Solution:
    """The solution that `Solution.as_table` gave."""
    return Solution(
        np.array(table["t"]),
        {name: _arrays(values) for name, values in table["surfaces"].items()},
        {name: _arrays(values) for name, values in table["blocks"].items()},
        _arrays(table["system"]),
        table["error"],
        table["scales"],
        Info(),
    )


@cache
def compiler() -> str | None:
    """The C compiler; None where there is none, or where its long double is a double."""
    if np.finfo(np.longdouble).eps > 1e-18:
        return None
    return shutil.which("gcc") or shutil.which("cc")


@cache
def library(precision: str) -> Any:
    """The compiled solver."""
    path = Path(tempfile.mkdtemp()) / "reference.so"
    quad = ["-DQUAD"] if precision == "quad" else []
    libraries = ["-lquadmath", "-lm"] if quad else ["-lm"]
    command = [compiler(), "-O2", "-std=gnu11", "-shared", "-fPIC", *quad, str(SOURCE)]
    subprocess.run([*command, "-o", str(path), *libraries], check=True)
    solver = ctypes.CDLL(str(path)).solve
    path.unlink()
    path.parent.rmdir()
    number = ctypes.c_double
    array = ctypes.POINTER(ctypes.c_double)
    solver.argtypes = [ctypes.POINTER(Arrays), ctypes.c_int, array, number, ctypes.c_int, number]
    solver.argtypes += [array, ctypes.POINTER(Info)]
    return solver


# Tolerances of a step relative to the scale of each kind, and rows of the extrapolation.
TOLERANCES = {"long double": (3e-18, 7), "quad": (1e-24, 12)}
# The looser tolerance of the second solution, in units of the first.
LOOSER = 100.0
# Time of an evaluation in quadruple precision, in units of that in long double.
SLOWER = 5.0
# Times at which steps end and the scales of a run are measured, besides the recorded ones.  The
# error of a step does not show an encounter that is jumped: with 33, one that took a hundredth of
# the run was missed in one of 2000 random scenes.
STOPS = 257
# Errors in long double, relative to the scales, above which quadruple precision is tried.
SMALL = 1e-14


def solve(
    scene: dict[str, Any],
    precision: str = "",
    most: float = 2e7,
    wanted: float = SMALL,
    stops: int = STOPS,
) -> Solution:
    """All quantities of a scene at its recorded times.

    Parameters
    ----------
    scene : dict
        What tomllib gives for a scene file.
    precision : str
        "long double" or "quad"; empty for the first if that is enough.
    most : float
        The largest number of evaluations of the forces of one solution; a fifth of it in
        quadruple precision, if that is chosen here.
    wanted : float
        Error in long double, relative to the scales, above which quadruple precision is tried.
    stops : int
        Evenly spaced times at which steps end.

    Raises
    ------
    UnsolvedError
        If bobs coincide, the steps become too short or too many, or a number is not finite.
    NotImplementedError
        If the scene has an effect that is not solved here.
    """
    if precision:
        return _solve(Tables(scene, stops), precision, most)
    solution = None
    try:
        solution = _solve(Tables(scene, stops), "long double", most)
        if solution.relative_error() <= wanted:
            return solution
    except UnsolvedError as failure:
        if failure.status == "bobs coincide":
            raise
    try:
        return _solve(Tables(scene, stops), "quad", most / SLOWER)
    except UnsolvedError:
        if solution is None:
            raise
        return solution


def _solve(model: Tables, precision: str, most: float) -> Solution:
    """The solution at a precision; its errors are estimated by one with looser tolerances."""
    tolerance, rows = TOLERANCES[precision]
    fine, info = model.solve(precision, tolerance, rows, most)
    rough, _ = model.solve(precision, LOOSER * tolerance, rows, most)
    times = model.t[model.recorded]
    kept = model.recorded
    numbers = model.named(fine[kept])
    scales = model.scales(fine)
    forces = model.beside(fine[kept])
    solution = Solution(times, *numbers, {}, scales, info, forces)
    other = Solution(times, *model.named(rough[kept]), {}, {}, info)
    for name in (*QUANTITIES, *BLOCK, *SYSTEM):
        pairs = zip(solution.series(name), other.series(name), strict=True)
        differences = [float(np.max(np.abs(one - two))) for one, two in pairs]
        if differences:
            solution.error[name] = max(differences)
    return solution


def recorded_times(scene: dict[str, Any]) -> np.ndarray:
    """The times that a run of the scene records, both ends included."""
    output = scene.get("output", {})
    duration = float(scene["duration"])
    if "times" in output:
        return np.union1d(np.array(output["times"], float), [0.0, duration])
    return np.linspace(0.0, duration, output.get("samples", 401))


def kind_of(name: str) -> str:
    """The kind of a quantity, which selects its scale."""
    if name in ("theta", "phi"):
        return "angle"
    if name in ("omega", "nu"):
        return "rate"
    if name in BLOCK or name in SYSTEM:
        return "total"
    return {"x_": "length", "y_": "length", "vx": "velocity", "vy": "velocity"}.get(
        name[:2], "energy"
    )


def two(value: Fraction) -> tuple[float, float]:
    """A number as the sum of two doubles."""
    return float(value), float(value - Fraction(float(value)))


def oscillators_of(spectrum: str, gamma: float, cutoff: float, n: int) -> list[tuple[float, float]]:
    """(mass, frequency) of a discretised spectrum, as the documentation of Spectrum defines it."""
    found = []
    for j in range(n):
        x = (j + 0.5) / n
        if spectrum == "drude":
            w = cutoff * math.tan(0.5 * math.pi * x)
            k = gamma * cutoff / n
        elif spectrum == "ohmic":
            w = -2.0 * cutoff * math.log1p(-x)
            k = 4.0 / math.pi * gamma * cutoff * (1.0 - x) / n
        else:
            w = cutoff * x
            k = 2.0 / math.pi * gamma * cutoff / n
        found.append((k / w**2, w))
    return found


def terms_of(table: dict[str, Any], factor: float = 1.0) -> list[list[float]]:
    """The terms of a potential, each as set_terms() of the C source reads it."""
    kind = table["potential"]
    mode = 0
    cutoff = float(table.get("cutoff", 0.0))
    start = 0.0
    if kind in ("sum", "scaled"):
        parts = table["of"] if kind == "sum" else [table["of"]]
        cut = {key: table[key] for key in ("cutoff", "at_cutoff", "switch_from") if key in table}
        if cut and any("cutoff" in part for part in parts):
            raise NotImplementedError("a cutoff of a sum of potentials with cutoffs")
        factor *= table.get("factor", 1.0)
        return [term for part in parts for term in terms_of(part | cut, factor)]
    if kind not in POTENTIALS:
        raise NotImplementedError(f"the potential {kind!r}")
    if cutoff:
        mode = CUTOFFS.index(table.get("at_cutoff", "switch"))
        start = float(table.get("switch_from", 0.9 * cutoff))
    numbers = [float(table[name]) for name in POTENTIALS[kind]] + [0.0] * 4
    index = float(list(POTENTIALS).index(kind))
    head = [index, float(mode), float(kind in CHARGED)]
    return [[*head, *numbers[:4], factor, cutoff, start, 0.0]]


class Tables:
    """A scene as the arrays that the C source describes."""

    def __init__(self, scene: dict[str, Any], stops: int = STOPS) -> None:
        self.scene = scene
        recorded = recorded_times(scene)
        self.t = np.union1d(recorded, np.linspace(0.0, recorded[-1], stops))
        self.recorded = np.searchsorted(self.t, recorded)
        self.names: list[str] = []
        self.counts: list[int] = []
        self.species: list[list[str]] = []
        self.fields_on: list[str] = []
        self.reservoirs: list[str] = []
        self.rows: dict[str, list[list[float]]] = {name: [] for name in Arrays.TABLES}
        for index, table in enumerate(scene["surface"]):
            self._surface(table, index)
        interactions = scene.get("interaction", [])
        for table in [interactions] if isinstance(interactions, dict) else interactions:
            self._interaction(table)
        for table in scene.get("field", []):
            self._field(table)

    def _surface(self, table: dict[str, Any], index: int) -> None:
        """Add the rows of a surface: its asperites, drive, reservoirs, springs and baths."""
        bobs = self._bobs(table)
        n = len(bobs)
        first = sum(self.counts)
        down = table.get("facing", "down") == "down"
        clamped = table.get("bars", "clamped")
        if clamped not in ("clamped", "free"):
            raise NotImplementedError("forces of a user's own on the ends of bars")

        def each(value: Any) -> list[float]:
            return [float(v) for v in np.broadcast_to(np.asarray(value, float), (n,))]

        given = table.get("asperite", {})
        parameters = [each(given.get(key, PARAMETERS[key])) for key in PARAMETERS]
        initial = table.get("initial", {})
        phi, omega, nu = (each(initial.get(key, 0.0)) for key in ("phi", "omega", "nu"))
        swings = [Fraction(x) for x in each(initial.get("swing", phi))]
        if "theta" in initial:
            rest = Fraction(0.0 if down else math.pi)
            swings = [Fraction(x) - rest for x in each(initial["theta"])]
        for i, bob in enumerate(bobs):
            places = [part for x in (*bob, swings[i]) for part in two(x)]
            row = [values[i] for values in parameters]
            row += [1.0 if down else -1.0, float(clamped == "clamped"), float(index)]
            self.rows["asperites"].append([*row, *places, phi[i], omega[i], nu[i], 0.0])
        self.names.append(table.get("name", f"surface{index}"))
        self.counts.append(n)
        species = table.get("species", "")
        self.species.append([species] * n if isinstance(species, str) else list(species))
        self._drive(table)
        self._springs(table, n, first)
        self._bath(table, n, first)

    def _bobs(self, table: dict[str, Any]) -> list[tuple[Fraction, Fraction, Fraction]]:
        """Exact places of resting bobs, of listed positions or of a grid."""
        if "positions" in table:
            bobs = [tuple(Fraction(float(x)) for x in row) for row in table["positions"]]
        else:
            numbers = (*table.get("bob", (0.0, 0.0)), *table.get("spacing", (0.0, 0.0)))
            x, y, dx, dz = (Fraction(float(v)) for v in numbers)
            z = Fraction(float(table.get("depth", 0.0)))
            nx, nz = table.get("shape", (1, 1))
            bobs = [(x + i * dx, y, z + k * dz) for k in range(nz) for i in range(nx)]
        heights = table.get("heights", 0.0)
        if isinstance(heights, dict):
            raise NotImplementedError("drawn heights")
        heights = np.broadcast_to(np.asarray(heights, float), (len(bobs),))
        return [(b[0], b[1] + Fraction(float(h)), b[2]) for b, h in zip(bobs, heights, strict=True)]

    def _drive(self, table: dict[str, Any]) -> None:
        """Add the row of a surface's drive, with its reservoir and load."""
        drive = table.get("drive", "forced")
        drive = {"kind": drive} if isinstance(drive, str) else drive
        kind = "rigid" if drive.get("rigid") else drive["kind"]
        if kind not in DRIVES:
            raise NotImplementedError(f"the drive {kind!r}")
        velocity = [float(v) for v in table.get("velocity", (0.0, 0.0))]
        langevin = table.get("langevin", {"gamma": 0.0})
        if langevin.get("temperature", 0.0):
            raise NotImplementedError("noise")
        on_bar = langevin.get("on", "bar") == "bar"
        if langevin["gamma"] > 0.0:
            self.reservoirs.append(self.names[-1])
        load = drive.get("load")
        row = [*velocity, float(DRIVES.index(kind)), drive.get("stiffness", 0.0)]
        row += [drive.get("speed", 0.0), float(load is not None), load or 0.0]
        row += [langevin["gamma"] * on_bar, *langevin.get("velocity", velocity)]
        row += [self.counts[-1], langevin["gamma"] * (not on_bar)]
        self.rows["surface"].append([float(v) for v in row])

    def _springs(self, table: dict[str, Any], n: int, first: int) -> None:
        """Add a row for each lattice spring: its ends and stiffness."""
        springs = table.get("springs", {})
        stiffness = springs.get("stiffness", 0.0)
        along = stiffness if isinstance(stiffness, (list, tuple)) else (stiffness, stiffness)
        pairs = [(i, j, along[0]) for i, j in springs.get("pairs", [])]
        if "pairs" not in springs and any(along):
            box = self.scene.get("periodic", {})
            nx, nz = table.get("shape", (1, 1))
            wrap = [springs.get("wrap", False) and (not box or axis in box) for axis in "xz"]
            for k in range(nz):
                for i in range(nx):
                    if i + 1 < nx or (wrap[0] and nx > 1):
                        pairs.append((k * nx + i, k * nx + (i + 1) % nx, along[0]))
                    if k + 1 < nz or (wrap[1] and nz > 1):
                        pairs.append((k * nx + i, (k + 1) % nz * nx + i, along[1]))
        turned = float(springs.get("turned", 0.0))
        rows = [[float(first + i), float(first + j), float(k), turned] for i, j, k in pairs if k]
        self.rows["spring"] += rows

    def _bath(self, table: dict[str, Any], n: int, first: int) -> None:
        """Add a row for each oscillator of each asperite, along the plane and torsional."""
        bath = table.get("bath", {})
        if bath.get("temperature", 0.0):
            raise NotImplementedError("a bath at a temperature")
        oscillators = [(o["mass"], o["frequency"]) for o in bath.get("oscillators", [])]
        if "spectrum" in bath:
            spectrum = [bath[key] for key in ("spectrum", "gamma", "cutoff", "n")]
            oscillators = oscillators_of(*spectrum)
        torsional = [(o["inertia"], o["frequency"]) for o in bath.get("torsional", [])]
        for name, listed in (("oscillator", oscillators), ("torsional", torsional)):
            rows = [[float(first + i), float(m), float(w)] for i in range(n) for m, w in listed]
            self.rows[name] += rows

    def _interaction(self, table: dict[str, Any]) -> None:
        """Add the terms of a potential, and a row for each pair of bobs between which it acts."""
        terms = terms_of(table)
        first = len(self.rows["term"])
        self.rows["term"] += terms
        names = sorted(table["between"]) if "between" in table else None
        kinds = sorted(table["species"]) if "species" in table else None
        starts = np.cumsum([0, *self.counts])
        for a, one in enumerate(self.names):
            for b, other in enumerate(self.names[a:], a):
                if a == b if names is None else names != sorted((one, other)):
                    continue
                for i in range(self.counts[a]):
                    for j in range(i + 1 if a == b else 0, self.counts[b]):
                        pair = sorted((self.species[a][i], self.species[b][j]))
                        if kinds is None or kinds == pair:
                            row = [starts[a] + i, starts[b] + j, first, first + len(terms), a == b]
                            self.rows["pair"].append([float(v) for v in row])

    def _field(self, table: dict[str, Any]) -> None:
        if table["kind"] != "corrugation":
            raise NotImplementedError(f"the field {table['kind']!r}")
        for name in table["on"]:
            self.fields_on.append(name)
            row = [table["amplitude"], table["period"], table.get("origin", (0.0, 0.0))[0]]
            row += [table.get("velocity", (0.0, 0.0))[0], self.names.index(name)]
            self.rows["field"].append([float(v) for v in row])

    def solve(
        self, precision: str, tolerance: float, rows: int, most: float
    ) -> tuple[np.ndarray, Info]:
        """All numbers that are recorded, a row for each time."""
        arrays = Arrays()
        kept = []
        for count, name in zip(Arrays.COUNTS, Arrays.TABLES, strict=True):
            table = np.ascontiguousarray(self.rows[name], float)
            kept.append(table)
            setattr(arrays, count, len(table))
            setattr(arrays, name, table.ctypes.data_as(ctypes.POINTER(ctypes.c_double)))
        box = self.scene.get("periodic", {})
        arrays.box_x, arrays.box_z = (float(box.get(axis, 0.0)) for axis in "xz")
        n = sum(self.counts)
        surfaces = len(self.counts)
        out = np.zeros((self.t.size, n * WIDTH + 4 * surfaces + 3))
        info = Info()
        pointer = ctypes.POINTER(ctypes.c_double)
        status = library(precision)(
            ctypes.byref(arrays),
            self.t.size,
            self.t.ctypes.data_as(pointer),
            tolerance,
            rows,
            most,
            out.ctypes.data_as(pointer),
            ctypes.byref(info),
        )
        if status:
            raise UnsolvedError(STATUSES[status], info)
        return out, info

    def named(self, out: np.ndarray) -> tuple[dict, dict, dict]:
        """Rows of numbers by surface and quantity."""
        n = sum(self.counts)
        each = self._of_asperites(out)
        surfaces = {}
        blocks = {}
        start = 0
        for k, (name, count) in enumerate(zip(self.names, self.counts, strict=True)):
            absent = () if name in self.fields_on else ("w_field", "w_field_ps")
            absent += () if name in self.reservoirs else ("w_T", "w_T_ps", "heat")
            surfaces[name] = {
                q: each[:, start : start + count, i]
                for i, q in enumerate(QUANTITIES)
                if q not in absent
            }
            first = n * WIDTH + 4 * k
            blocks[name] = {q: out[:, first + i] for i, q in enumerate(BLOCK)}
            start += count
        system = {q: out[:, i - 3] for i, q in enumerate(SYSTEM)}
        return surfaces, blocks, system

    def beside(self, out: np.ndarray) -> dict[str, np.ndarray]:
        """The velocities of bobs and the forces, (times, asperites), all surfaces together."""
        each = self._of_asperites(out)[:, :, len(QUANTITIES) :]
        return {name: each[:, :, i] for i, name in enumerate(BESIDE)}

    def _of_asperites(self, out: np.ndarray) -> np.ndarray:
        n = sum(self.counts)
        return out[:, : n * WIDTH].reshape(-1, n, WIDTH)

    def internal(self, surfaces: dict[str, dict[str, np.ndarray]]) -> float:
        """The largest internal energy of an asperite."""
        highest = 0.0
        rows = np.array(self.rows["asperites"])[:, : len(PARAMETERS) + 1]
        for table in surfaces.values():
            own = rows[: table["theta"].shape[1]].T
            rows = rows[table["theta"].shape[1] :]
            a = dict(zip((*PARAMETERS, "down"), own, strict=True))
            reduced = a["m1"] * a["m2"] / (a["m1"] + a["m2"])
            twist = table["theta"] - np.where(a["down"] > 0.0, 0.0, np.pi) - table["phi"]
            soft = np.where(np.isfinite(a["kappa"]), a["kappa"], 0.0)
            doubled = reduced * a["length"] ** 2 * table["omega"] ** 2 + soft * twist**2
            doubled += np.where(np.isfinite(a["i2"]), a["i2"], 0.0) * table["nu"] ** 2
            highest = max(highest, 0.5 * float(np.max(doubled)))
        return highest

    def scales(self, out: np.ndarray) -> dict[str, float]:
        """One scale for each kind of quantity, the largest over asperites and the run."""
        surfaces, blocks, system = self.named(out)

        def top(tables: list[dict[str, np.ndarray]], kind: str) -> float:
            values = [v for table in tables for q, v in table.items() if kind_of(q) == kind]
            return max(float(np.max(np.abs(v))) for v in values)

        beside = self.beside(out)
        velocity = np.stack([beside["vx_bob"], beside["vy_bob"]], axis=2)
        mean = np.mean([row[:2] for row in self.rows["surface"]], axis=0)
        energy = top(list(surfaces.values()), "energy")
        totals = [*blocks.values(), {q: system[q] for q in SYSTEM[1:]}]
        return {
            "internal": self.internal(surfaces),
            "angle": 1.0,
            "rate": top(list(surfaces.values()), "rate"),
            "length": max(row[3] for row in self.rows["asperites"]),
            "velocity": float(np.max(np.hypot(*np.moveaxis(velocity - mean, 2, 0)))),
            "energy": energy,
            "total": max(energy, top(totals, "total")),
        }
