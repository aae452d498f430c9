"""A second, independent solution of the friction model, to test the first one against.

It shares nothing with the package but the two design pages: plain numpy, all pairs, the vectors
of the paper (r1, r2, rL, rR, f1, f2, fL, fR), SciPy's DOP853 at a tight tolerance. Every work and
every pseudowork is a component of the differential equation, integrated in the lab frame from its
definition (force . velocity of its point of application, force . v_cm); no identity of the ledger
is used, so each of them is left to be tested.

    end = solve(tomllib.load(file))
    end["surfaces"]["upper"]["w1"][0], end["blocks"]["upper"]["W"], end["scales"]["energy"]

Conventions where the design pages leave room:
- contact_energy is the contact between different surfaces; contact within one is in its E_int.
- `between` naming one surface twice asks for contact among its bobs. An interaction without
  `between` acts between all different surfaces; interactions on the same pair add up.
- A rigid free surface weighs what its asperites weigh: bath masses are not in M_surface.
- A forced or free drive cancels f1 only, never a field or contact within.
- wrap ties last to first along x and along z, in the directions in which the scene is periodic
  (in both where it is not periodic); a ring of two has two springs.
- The mean initial velocity in the velocity scale is the plain mean over the surfaces.
- The energy scale covers the accounts of asperites that are reported (not wL_ps and wR_ps).

Arrays of vectors have shape (2, n): a row of x, a row of y. The state holds departures from
uniform motion, so that a weak encounter keeps all its digits: theta = theta0 + d_theta,
r_cm = r_cm0 + v0 t + d_r, v_cm = v0 + d_v, and bath masses likewise.
"""

from __future__ import annotations

from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq

PARAMETERS = {
    "m1": 1.0,
    "m2": 2.0,
    "kappa": 2.0,
    "length": 2.0,
    "bar_length": 3.0,
    "i2": 5.0,
    "charge": 1.0,
}
FORCES = ("1", "2", "L", "R", "_int", "_field")
REPORTED_PS = ("w1_ps", "w2_ps", "w_int_ps")


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The z component of a x b."""
    return a[0] * b[1] - a[1] * b[0]


def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """a . b in the plane."""
    return a[0] * b[0] + a[1] * b[1]


def speed_of_turning(rate: np.ndarray, arm: np.ndarray) -> np.ndarray:
    """Velocity of the end of an arm that turns at a rate: rate z x arm."""
    return np.array([-rate * arm[1], rate * arm[0]])


def differences(n: int, first: list[int], second: list[int]) -> np.ndarray:
    """The matrix D with (r @ D)[p] = r[first[p]] - r[second[p]]; f @ D.T adds +f and -f."""
    D = np.zeros((n, len(first)))
    for p, (i, j) in enumerate(zip(first, second, strict=True)):
        D[i, p] += 1.0
        D[j, p] -= 1.0
    return D


class Surface:
    """One [[surface]] table: its asperites at rest, their parameters, drive, springs, bath."""

    def __init__(self, table: dict, index: int) -> None:
        if "langevin" in table:
            raise ValueError("the reference has no reservoirs: it is deterministic")
        self.name = table.get("name", f"surface{index}")
        self.sign = {"down": 1.0, "up": -1.0}[table.get("facing", "down")]
        self.rest = 0.0 if self.sign > 0 else np.pi
        self.shape = None if "positions" in table else tuple(table.get("shape", (1, 1)))
        bobs = self._bobs(table)
        self.n = n = len(bobs)
        self.z = bobs[:, 2]

        def each(value: Any) -> np.ndarray:
            return np.broadcast_to(np.asarray(value, float), (n,)).copy()

        given = table.get("asperite", {})
        self.parameters = {key: each(given.get(key, PARAMETERS[key])) for key in PARAMETERS}
        m1, m2, length = (self.parameters[key] for key in ("m1", "m2", "length"))
        self.bobs = bobs[:, :2].T
        self.r_cm = self.bobs + np.array([np.zeros(n), self.sign * length * m2 / (m1 + m2)])
        self.r2_rest = self.bobs + np.array([np.zeros(n), self.sign * length])

        self.velocity = np.asarray(table.get("velocity", (0.0, 0.0)), float)
        initial = table.get("initial", {})
        self.theta = each(initial.get("theta", self.rest))
        self.phi, self.omega, self.nu = (each(initial.get(k, 0.0)) for k in ("phi", "omega", "nu"))

        drive = table.get("drive", "forced")
        drive = {"kind": drive} if isinstance(drive, str) else drive
        self.kind = drive.get("kind", "forced")
        if self.kind not in ("forced", "free", "pulled"):
            raise ValueError(f"the reference has no drive {self.kind!r}")
        self.rigid = self.kind == "free" and drive.get("rigid", False)
        self.load = drive.get("load")
        self.stiffness, self.speed = drive.get("stiffness", 0.0), drive.get("speed", 0.0)

        species = table.get("species", "")
        self.species = [species] * n if isinstance(species, str) else list(species)

        self.bars = table.get("bars", "clamped")
        if self.bars not in ("clamped", "free"):
            raise ValueError(f"the reference has no bars {self.bars!r}")
        springs = table.get("springs", {})
        self.spring, self.wrap = springs.get("stiffness", 0.0), springs.get("wrap", False)
        self.turned = springs.get("turned", 0.0)
        if self.spring and self.shape is None:
            raise ValueError("springs need a shape, not positions")
        bath = table.get("bath", {})
        if "spectrum" in bath or bath.get("temperature", 0.0):
            raise ValueError("the reference has baths of listed oscillators at temperature 0 alone")
        self.oscillators = [(o["mass"], o["frequency"]) for o in bath.get("oscillators", [])]

    def _bobs(self, table: dict) -> np.ndarray:
        """Resting bobs, one row (x, y, z) per asperite; x runs fastest."""
        if "positions" in table:
            bobs = np.array(table["positions"], float)
        else:
            (x, y), (nx, nz) = table.get("bob", (0.0, 0.0)), self.shape
            dx, dz = table.get("spacing", (0.0, 0.0))
            z = table.get("depth", 0.0)
            bobs = np.array(
                [(x + i * dx, y, z + k * dz) for k in range(nz) for i in range(nx)], float
            )
        heights = table.get("heights", 0.0)
        if isinstance(heights, dict):
            raise ValueError("the reference has listed heights alone")
        bobs[:, 1] += np.asarray(heights, float)
        return bobs

    def neighbours(self, wrap_x: bool, wrap_z: bool) -> list[tuple[int, int]]:
        """Pairs of this surface's asperites that a lattice spring joins."""
        if not self.spring:
            return []
        nx, nz = self.shape
        pairs = []
        for k in range(nz):
            for i in range(nx):
                if i + 1 < nx or (wrap_x and nx > 1):
                    pairs.append((k * nx + i, k * nx + (i + 1) % nx))
                if k + 1 < nz or (wrap_z and nz > 1):
                    pairs.append((k * nx + i, (k + 1) % nz * nx + i))
        return pairs


class Contact:
    """One interaction: its formula, its cutoff and the pairs of bobs that it acts on.

    `breaks` are the distances at which the formula changes; `region` says, pair by pair, between
    which of them the pair is. The integration stops at each change, so that between stops
    everything is smooth.
    """

    def __init__(self, table: dict, surfaces: list[Surface], starts: list[int], n: int) -> None:
        self.kind = table["potential"]
        self.p = table
        if self.kind not in ("coulomb", "morse", "lennard-jones"):
            raise ValueError(f"the reference has no potential {self.kind!r}")
        names = sorted(table["between"]) if "between" in table else None
        self.pairs: list[tuple[int, int, bool]] = []

        def met(table: dict, one: str, other: str) -> bool:
            return "species" not in table or sorted(table["species"]) == sorted((one, other))

        for a, A in enumerate(surfaces):
            for b, B in enumerate(surfaces[a:], a):
                if a == b if names is None else names != sorted((A.name, B.name)):
                    continue
                self.pairs += [
                    (starts[a] + i, starts[b] + j, a == b)
                    for i in range(A.n)
                    for j in range(B.n)
                    if (a != b or i < j) and met(table, A.species[i], B.species[j])
                ]
        first, second = [p[0] for p in self.pairs], [p[1] for p in self.pairs]
        self.within = np.array([p[2] for p in self.pairs], bool)
        self.D = differences(n, first, second)
        charge = np.concatenate([s.parameters["charge"] for s in surfaces])
        charged = self.kind == "coulomb"
        self.qq = charge[first] * charge[second] if charged else np.ones(len(first))
        self.mix = self.D.T * ~self.within[:, None], self.D.T * self.within[:, None]
        self.any_within = bool(self.within.any())

        self.cutoff = table.get("cutoff")
        self.mode = table.get("at_cutoff", "switch")
        self.breaks = np.array([])
        if self.cutoff is not None:
            self.start = table.get("switch_from", 0.9 * self.cutoff)
            switched = self.mode == "switch"
            self.breaks = np.array([self.start, self.cutoff] if switched else [self.cutoff])
            self.at_cutoff = self._plain(np.array([self.cutoff]))
        self.region = np.zeros(len(first), int)

    def _plain(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """U and dU/dr without charges and without a cutoff."""
        p = self.p
        if self.kind == "coulomb":
            return p["strength"] / r, -p["strength"] / r**2
        if self.kind == "morse":
            e = np.exp(-p["alpha"] * (r - p["r0"]))
            return p["D"] * (e * e - 2.0 * e), -2.0 * p["alpha"] * p["D"] * (e * e - e)
        s6 = (p["sigma"] / r) ** 6
        return 4.0 * p["epsilon"] * (s6 * s6 - s6), -24.0 * p["epsilon"] * (2.0 * s6 * s6 - s6) / r

    def energy_and_slope(self, r: np.ndarray, region: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """U and dU/dr of each pair, with its charges and its cutoff."""
        U, dU = self._plain(r)
        if self.cutoff is not None:
            Uc, dUc = self.at_cutoff
            if self.mode == "switch":
                width = self.cutoff - self.start
                u = np.where(region == 1, (r - self.start) / width, 0.0)
                S = 1.0 - 10.0 * u**3 + 15.0 * u**4 - 6.0 * u**5
                dS = (-30.0 * u**2 + 60.0 * u**3 - 30.0 * u**4) / width
                U, dU = U * S, dU * S + U * dS
            elif self.mode == "shift":
                U = U - Uc
            elif self.mode == "force-shift":
                U, dU = U - Uc - (r - self.cutoff) * dUc, dU - dUc
            elif self.mode != "truncate":
                raise ValueError(f"the reference has no at_cutoff {self.mode!r}")
            inside = region < len(self.breaks)
            U, dU = np.where(inside, U, 0.0), np.where(inside, dU, 0.0)
        return self.qq * U, self.qq * dU

    def lengths(self) -> list[float]:
        """The distances over which this interaction changes."""
        found = [] if self.cutoff is None else [self.cutoff]
        if self.mode == "switch" and self.cutoff is not None:
            found.append(self.cutoff - self.start)
        if self.kind == "morse":
            found.append(1.0 / self.p["alpha"])
        if self.kind == "lennard-jones":
            found.append(self.p["sigma"])
        return found


class Model:
    """The scene as arrays over all asperites, and the right-hand side of its equations."""

    def __init__(self, scene: dict) -> None:
        self.duration = float(scene["duration"])
        self.surfaces = [Surface(table, i) for i, table in enumerate(scene["surface"])]
        ends = np.cumsum([s.n for s in self.surfaces])
        self.n = n = int(ends[-1])
        starts = [int(e) - s.n for e, s in zip(ends, self.surfaces, strict=True)]
        self.slices = [slice(a, a + s.n) for a, s in zip(starts, self.surfaces, strict=True)]

        def join(values: list) -> np.ndarray:
            return np.concatenate(values, axis=-1)

        get = {key: join([s.parameters[key] for s in self.surfaces]) for key in PARAMETERS}
        m1, m2 = get["m1"], get["m2"]
        self.M, self.length = m1 + m2, get["length"]
        self.l1, self.l2 = self.length * m2 / self.M, self.length * m1 / self.M
        self.inertia = m1 * self.l1**2 + m2 * self.l2**2
        self.kappa, self.bar_length, self.i2 = get["kappa"], get["bar_length"], get["i2"]
        self.clamped = join([np.full(s.n, s.bars == "clamped") for s in self.surfaces])
        self.z = join([s.z for s in self.surfaces])
        self.theta0 = join([s.theta for s in self.surfaces])
        self.phi0 = join([s.phi for s in self.surfaces])
        self.omega0 = join([s.omega for s in self.surfaces])
        self.nu0 = join([s.nu for s in self.surfaces])
        rest = join([np.full(s.n, s.rest) for s in self.surfaces])
        self.twist0 = self.theta0 - self.phi0 - rest
        self.r0 = join([s.r_cm for s in self.surfaces])
        self.v0 = join([np.tile(s.velocity[:, None], s.n) for s in self.surfaces])
        # member[i, s] is 1 where asperite i belongs to surface s: x @ member sums by surface
        self.member = np.zeros((n, len(self.surfaces)))
        for s, part in enumerate(self.slices):
            self.member[part, s] = 1.0

        self._contacts_and_fields(scene, starts)
        self._springs(starts)
        self._bath()
        self.M_tot = self.M @ self.member + self.bath_m @ self.bath_member
        self.V0 = np.array([s.velocity for s in self.surfaces]).T
        self.max_step = self._max_step()

    def _contacts_and_fields(self, scene: dict, starts: list[int]) -> None:
        tables = scene.get("interaction", [])
        tables = [tables] if isinstance(tables, dict) else tables
        self.contacts = [Contact(table, self.surfaces, starts, self.n) for table in tables]
        self.box = scene.get("periodic", {})
        if self.box and any(c.cutoff is None for c in self.contacts):
            raise ValueError("a periodic scene needs a cutoff of at most half the box")
        self.fields = []  # (wavenumber, amplitude of each asperite)
        self.has_field = [False] * len(self.surfaces)
        for table in scene.get("field", []):
            if table["kind"] != "corrugation":
                raise ValueError(f"the reference has no field {table['kind']!r}")
            on = [s.name in table["on"] for s in self.surfaces]
            self.has_field = [a or b for a, b in zip(self.has_field, on, strict=True)]
            amplitude = table["amplitude"] * (self.member @ np.array(on, float))
            self.fields.append((2.0 * np.pi / table["period"], amplitude))

    def _springs(self, starts: list[int]) -> None:
        first, second, k, owner = [], [], [], []
        for s, (surface, start) in enumerate(zip(self.surfaces, starts, strict=True)):
            wrap_x = surface.wrap and (not self.box or "x" in self.box)
            wrap_z = surface.wrap and (not self.box or "z" in self.box)
            for i, j in surface.neighbours(wrap_x, wrap_z):
                first.append(start + i)
                second.append(start + j)
                k.append(surface.spring)
                owner.append(s)
        self.spring_k = np.array(k)
        self.spring_D = differences(self.n, first, second)
        r2_rest = np.concatenate([s.r2_rest for s in self.surfaces], axis=1)
        turned = np.array([self.surfaces[s].turned for s in owner])
        x, y = r2_rest @ self.spring_D
        cos, sin = np.cos(turned), np.sin(turned)
        self.spring_rest = np.array([cos * x - sin * y, sin * x + cos * y])
        self.spring_member = np.eye(len(self.surfaces))[owner].reshape(-1, len(self.surfaces))

    def _bath(self) -> None:
        owner, m, w = [], [], []
        for surface, part in zip(self.surfaces, self.slices, strict=True):
            for i in range(part.start, part.stop):
                for mass, frequency in surface.oscillators:
                    owner.append(i)
                    m.append(mass)
                    w.append(frequency)
        self.owner, self.bath_m = np.array(owner, int), np.array(m)
        self.bath_k = self.bath_m * np.array(w) ** 2
        self.bath_bar = np.eye(self.n)[self.owner].reshape(-1, self.n)  # f @ bath_bar: sum by bar
        self.bath_member = self.bath_bar @ self.member
        lever = np.array([-np.sin(self.theta0), np.cos(self.theta0)])
        self.bath_r0 = (self.r0 + self.l2 * lever)[:, self.owner]
        self.bath_v0 = self.v0[:, self.owner]

    def _max_step(self) -> float:
        """At most 1/200 of the run, and a quarter of the shortest length at the initial speeds."""
        lengths = [float(self.length.min())]
        lengths += [x for contact in self.contacts for x in contact.lengths()]
        lengths += [2.0 * np.pi / wavenumber for wavenumber, _ in self.fields]
        moving = list(self.V0.T)
        moving += [np.array([s.speed, 0.0]) for s in self.surfaces if s.kind == "pulled"]
        moving += [np.zeros(2)] if self.fields else []
        speed = max(np.hypot(*(a - b)) for a in moving for b in moving)
        speed += 2.0 * float(np.abs(self.omega0 * self.length).max())
        return min(self.duration / 200.0, 0.25 * min(lengths) / max(speed, 1e-300))

    # --- the state -------------------------------------------------------------------------

    def sizes(self) -> list[int]:
        """angles, centres of mass and bath; their rates; accounts."""
        n, b = self.n, len(self.bath_m)
        return [2 * n, 2 * n + 2 * b, 2 * n, 2 * n + 2 * b, 12 * n + 2 * len(self.surfaces) + 1]

    def start(self) -> np.ndarray:
        """The initial state: no departure, the initial rates, empty accounts."""
        parts = [np.zeros(size) for size in self.sizes()]
        parts[2] = np.concatenate([self.omega0, self.nu0])
        return np.concatenate(parts)

    def split(self, y: np.ndarray) -> list[np.ndarray]:
        """d_theta, d_phi, d_r, d_s (bath), omega, nu, d_v, d_u (bath), accounts."""
        n, b = self.n, 2 * len(self.bath_m)
        c = 4 * n + b
        return [
            y[:n],
            y[n : 2 * n],
            y[2 * n : 4 * n].reshape(2, n),
            y[4 * n : c].reshape(2, -1),
            y[c : c + n],
            y[c + n : c + 2 * n],
            y[c + 2 * n : c + 4 * n].reshape(2, n),
            y[c + 4 * n : 2 * c].reshape(2, -1),
            y[2 * c :],
        ]

    def motion(self, t: float, y: np.ndarray) -> SimpleNamespace:
        """Positions and velocities of every named point, in the lab frame."""
        m = SimpleNamespace()
        m.d_theta, m.d_phi, d_r, d_s, m.omega, m.nu, m.d_v, m.d_u, m.accounts = self.split(y)
        m.theta, m.phi = self.theta0 + m.d_theta, self.phi0 + m.d_phi
        m.twist = self.twist0 + (m.d_theta - m.d_phi)
        m.r, m.v = self.r0 + self.v0 * t + d_r, self.v0 + m.d_v
        down = np.array([np.sin(m.theta), -np.cos(m.theta)])
        m.arm1, m.arm2 = self.l1 * down, -self.l2 * down
        m.r1, m.v1 = m.r + m.arm1, m.v + speed_of_turning(m.omega, m.arm1)
        m.r2, m.v2 = m.r + m.arm2, m.v + speed_of_turning(m.omega, m.arm2)
        m.s, m.u = self.bath_r0 + self.bath_v0 * t + d_s, self.bath_v0 + m.d_u
        return m

    def separation(self, contact: Contact, m: SimpleNamespace) -> tuple[np.ndarray, np.ndarray]:
        """The vectors (x, y, z) from second to first bob, nearest image, and their lengths."""
        d = np.vstack([m.r1, self.z]) @ contact.D
        for row, axis in ((0, "x"), (2, "z")):
            if axis in self.box:
                d[row] -= self.box[axis] * np.round(d[row] / self.box[axis])
        return d, np.sqrt(d[0] ** 2 + d[1] ** 2 + d[2] ** 2)

    # --- forces ----------------------------------------------------------------------------

    def forces(self, t: float, m: SimpleNamespace) -> SimpleNamespace:
        """Every force on every asperite: f1, within, field (bob); f2, f_int (bar); fL, fR."""
        f = SimpleNamespace()
        f.f1, f.within, f.field = (np.zeros((2, self.n)) for _ in range(3))
        for contact in self.contacts:
            d, r = self.separation(contact, m)
            _, slope = contact.energy_and_slope(r, contact.region)
            pull = d[:2] * (-slope / r)
            across, inside = contact.mix
            f.f1 += pull @ across
            if contact.any_within:
                f.within += pull @ inside
        for wavenumber, amplitude in self.fields:
            f.field[0] -= amplitude * wavenumber * np.sin(wavenumber * m.r1[0])

        f.f2 = -f.f1
        for surface, part in zip(self.surfaces, self.slices, strict=True):
            if surface.kind == "free":
                f.f2[0, part] = 0.0
                if surface.rigid:
                    M, f1_x = self.M[part], f.f1[0, part]
                    f.f2[0, part] = -f1_x + M / M.sum() * f1_x.sum()
            elif surface.kind == "pulled":
                anchor = surface.r2_rest[0] + surface.speed * t
                f.f2[0, part] = surface.stiffness * (anchor - m.r2[0, part])
            if surface.load is not None:
                f.f2[1, part] = -surface.sign * surface.load

        m.rR = 0.5 * self.bar_length * np.array([np.cos(m.phi), np.sin(m.phi)])
        m.rL = -m.rR
        f.torsion = self.kappa * m.twist
        across_bar = np.array([-np.sin(m.phi), np.cos(m.phi)])
        f.fL = np.where(self.clamped, f.torsion / self.bar_length, 0.0) * across_bar
        f.fR = -f.fL

        f.f_int = -(self.spring_k * (m.r2 @ self.spring_D - self.spring_rest)) @ self.spring_D.T
        f.on_bath = self.bath_k * (m.r2[:, self.owner] - m.s)
        f.f_int = f.f_int - f.on_bath @ self.bath_bar
        return f

    def rhs(self, t: float, y: np.ndarray) -> np.ndarray:
        """Time derivative of the state: equations of motion, and every power and pseudopower."""
        m = self.motion(t, y)
        f = self.forces(t, m)
        on_bob, on_bar = f.f1 + f.field + f.within, f.f2 + (f.fL + f.fR) + f.f_int

        a = (f.f1 + f.f2 + (f.fL + f.fR) + f.f_int + f.within + f.field) / self.M
        alpha = (cross(m.arm1, on_bob) + cross(m.arm2, on_bar) - f.torsion) / self.inertia
        beta = (f.torsion + cross(m.rR, f.fR) + cross(m.rL, f.fL)) / self.i2

        vL, vR = m.v2 + speed_of_turning(m.nu, m.rL), m.v2 + speed_of_turning(m.nu, m.rR)
        p1, p2, pL, pR = dot(f.f1, m.v1), dot(f.f2, m.v2), dot(f.fL, vL), dot(f.fR, vR)
        p_int = dot(f.f_int, m.v2) + dot(f.within, m.v1)
        p_field = dot(f.field, m.v1)
        pseudo = [dot(g, m.v) for g in (f.f1, f.f2, f.fL, f.fR, f.f_int + f.within, f.field)]

        F_ext = (f.f1 + f.f2 + (f.fL + f.fR) + f.field) @ self.member
        W = (p1 + p2 + pL + pR + p_field) @ self.member
        W_ps = dot(F_ext, self.V0 + self.departure_of_v(m))
        applied = np.sum(p2 + pL + pR)

        rates = [m.omega, m.nu, m.d_v[0], m.d_v[1], m.d_u[0], m.d_u[1]]
        kicks = [alpha, beta, a[0], a[1], *(f.on_bath / self.bath_m)]
        powers = [p1, p2, pL, pR, p_int, p_field, *pseudo, W, W_ps, [applied]]
        return np.concatenate(rates + kicks + powers)

    def departure_of_v(self, m: SimpleNamespace) -> np.ndarray:
        """V - V0 of each surface: asperites and bath masses together."""
        total = (self.M * m.d_v) @ self.member + (self.bath_m * m.d_u) @ self.bath_member
        return total / self.M_tot

    # --- energies --------------------------------------------------------------------------

    def potentials(self, m: SimpleNamespace) -> SimpleNamespace:
        """Contact between surfaces, field; by surface: springs, bath springs, contact within."""
        e = SimpleNamespace(contact=0.0, field=0.0, stored=np.zeros(len(self.surfaces)))
        for contact in self.contacts:
            _, r = self.separation(contact, m)
            U, _ = contact.energy_and_slope(r, np.searchsorted(contact.breaks, r, side="right"))
            e.contact += float(U[~contact.within].sum())
            for u, (i, _, within) in zip(U, contact.pairs, strict=True):
                e.stored += u * self.member[i] if within else 0.0
        for wavenumber, amplitude in self.fields:
            e.field -= float(np.sum(amplitude * np.cos(wavenumber * m.r1[0])))
        stretch = m.r2 @ self.spring_D - self.spring_rest
        e.stored += (0.5 * self.spring_k * dot(stretch, stretch)) @ self.spring_member
        stretch = m.r2[:, self.owner] - m.s
        e.stored += (0.5 * self.bath_k * dot(stretch, stretch)) @ self.bath_member
        return e

    def delta_k_trans(self, d_v: np.ndarray) -> np.ndarray:
        """1/2 M (v^2 - v0^2), from v - v0."""
        return self.M * (dot(self.v0, d_v) + 0.5 * dot(d_v, d_v))

    def delta_e_int(self, omega: Any, nu: Any, d_twist: Any) -> np.ndarray:
        """e_int now less e_int at the start."""
        spin = self.inertia * (omega**2 - self.omega0**2) + self.i2 * (nu**2 - self.nu0**2)
        return 0.5 * (spin + self.kappa * d_twist * (2.0 * self.twist0 + d_twist))

    # --- changes of formula at a cutoff ------------------------------------------------------

    def set_regions(self, t: float, y: np.ndarray) -> None:
        """Fix each pair's region; a pair just at a break belongs to the side that it moves to."""
        m = self.motion(t, y)
        for contact in self.contacts:
            if len(contact.breaks):
                d, r = self.separation(contact, m)
                drift = dot(d[:2], m.v1 @ contact.D) / r
                ahead = r.copy()
                for x in contact.breaks:
                    at = np.abs(r - x) < 1e-11 * x
                    ahead[at] = x * (1.0 + 1e-11 * np.sign(drift[at]))
                contact.region = np.searchsorted(contact.breaks, ahead, side="right")

    def gap(self, c: int, pair: int, x: float, t: float, y: np.ndarray) -> tuple[float, float]:
        """How far a pair of contact c is beyond the distance x, and how fast that grows."""
        m = self.motion(t, y)
        d, r = self.separation(self.contacts[c], m)
        drift = dot(d[:2], m.v1 @ self.contacts[c].D) / r
        return float(r[pair] - x), float(drift[pair])

    def changed(self, t: float, y: np.ndarray) -> list[tuple[int, int, float]]:
        """(contact, pair, break) of all pairs that are no longer in the region set for them."""
        m = self.motion(t, y)
        found = []
        for c, contact in enumerate(self.contacts):
            if len(contact.breaks):
                _, r = self.separation(contact, m)
                region = np.searchsorted(contact.breaks, r, side="right")
                for p in np.flatnonzero(region != contact.region):
                    outward = region[p] > contact.region[p]
                    x = contact.breaks[contact.region[p] - (0 if outward else 1)]
                    found.append((c, int(p), float(x)))
        return found


def run_to(model: Model, t: float, y: np.ndarray, t_end: float, rtol: float, atol: Any) -> Any:
    """The state at t_end (either side of t), regions kept as they are."""
    if t_end == t:
        return y
    solver = DOP853(model.rhs, t, y, t_end, rtol=rtol, atol=atol, first_step=abs(t_end - t))
    while solver.status == "running":
        solver.step()
    if solver.status == "failed":
        raise RuntimeError(f"step underflow at t = {solver.t!r}")
    return solver.y


def first_change(model: Model, times: np.ndarray, dense: Any) -> tuple[float, Any] | None:
    """The time in this step at which a pair first leaves its region, and which (or None)."""
    for a, b in pairwise(times):
        crossings = []
        for c, p, x in model.changed(b, dense(b)):

            def gap(t: float, c: int = c, p: int = p, x: float = x) -> float:
                return model.gap(c, p, x, t, dense(t))[0]

            crossed = gap(a) * gap(b) < 0.0
            crossings.append((brentq(gap, a, b, xtol=1e-14) if crossed else b, (c, p, x)))
        if crossings:
            return min(crossings)
    return None


def integrate(model: Model, rtol: float, atol: Any, dense: int) -> tuple[np.ndarray, np.ndarray]:
    """States from 0 to the end at every step and `dense` times inside it, rows of the result."""
    t, y, h = 0.0, model.start(), None
    T, ts, ys = model.duration, [0.0], [y]
    watched = any(len(c.breaks) for c in model.contacts)
    while t < T:
        model.set_regions(t, y)
        h = None if h is None else min(h, T - t)
        solver = DOP853(
            model.rhs, t, y, T, rtol=rtol, atol=atol, max_step=model.max_step, first_step=h
        )
        while solver.status == "running":
            y_old = solver.y
            solver.step()
            if solver.status == "failed":
                raise RuntimeError(f"step underflow at t = {solver.t!r}")
            t_old, t, y, h = solver.t_old, solver.t, solver.y, solver.step_size
            inner = solver.dense_output() if watched or dense else None
            times = np.linspace(t_old, t, 2 + max(dense, 4 if watched else 0))
            change = first_change(model, times, inner) if watched else None
            if change:
                t, (c, p, x) = change
                y = run_to(model, t_old, y_old, t, rtol, atol)
                for _ in range(2):  # polish the time of the crossing
                    gap, drift = model.gap(c, p, x, t, y)
                    if 0.0 < abs(gap) < 1e-3 * h * abs(drift):
                        y = run_to(model, t, y, t - gap / drift, rtol, atol)
                        t -= gap / drift
            if dense:
                times = times[(times > t_old) & (times < t)]
                ts += list(times)
                ys += list(inner(times).T) if len(times) else []
            ts.append(t)
            ys.append(y)
            if change:
                break
    return np.array(ts), np.array(ys)


def scales_of_state(model: Model, ys: np.ndarray) -> list[float]:
    """What displacements, velocities and accounts reach: the scales for absolute tolerances."""
    angles, places, rates, speeds, accounts = (
        float(np.abs(part).max()) for part in np.split(ys, np.cumsum(model.sizes())[:-1], axis=1)
    )
    rod = float(model.length.max())
    displacement, velocity = max(places, rod * angles), max(speeds, rod * rates)
    kinds = [displacement / rod, displacement, velocity / rod, velocity, accounts]
    return [kind or 1.0 for kind in kinds]


def tolerances(model: Model, kinds: list[float], factor: float) -> np.ndarray:
    """One absolute tolerance per component of the state."""
    return factor * np.repeat(kinds, model.sizes())


def accuracy_scales(model: Model, ys: np.ndarray) -> dict[str, float]:
    """One scale per kind of quantity, the largest over all asperites and the run."""
    mean = model.V0.mean(axis=1)[:, None]
    rate = velocity = energy = 0.0
    for y in ys:
        m = model.motion(0.0, y)
        rate = max(rate, np.abs(m.omega).max(), np.abs(m.nu).max())
        velocity = max(velocity, np.hypot(*(m.v1 - mean)).max())
        w = accounts_of(model, m.accounts)
        d_e = model.delta_e_int(m.omega, m.nu, m.d_theta - m.d_phi)
        w["k"], w["e"] = model.delta_k_trans(m.d_v), d_e
        del w["wL_ps"], w["wR_ps"]
        energy = max(energy, max(np.abs(values).max() for values in w.values()))
    return {
        "angle": 1.0,
        "rate": float(rate),
        "length": float(model.length.max()),
        "velocity": float(velocity),
        "energy": float(energy),
        "total": float(energy),  # at least
    }


def accounts_of(model: Model, accounts: np.ndarray) -> dict[str, np.ndarray]:
    """Every work and pseudowork of every asperite, and their sums w and w_ps."""
    names = [f"w{k}" for k in FORCES] + [f"w{k}_ps" for k in FORCES]
    table = accounts[: 12 * model.n].reshape(12, model.n)
    w = dict(zip(names, table, strict=True))
    w["w"], w["w_ps"] = table[:6].sum(axis=0), table[6:].sum(axis=0)
    return w


def solve(scene: dict, rtol: float = 1e-12, atol_factor: float = 1e-13) -> dict:
    """The end state of a scene, as `tribo run --json` names it, and the scales of its accuracy.

    scene: what tomllib gives for a scene file. atol_factor: the absolute tolerance of each kind of
    component, relative to what that kind reaches in the run (found by a run at lower accuracy).
    """
    model = Model(scene)
    m0 = model.motion(0.0, model.start())
    for contact in model.contacts:
        if len(contact.pairs) and model.separation(contact, m0)[1].min() == 0.0:
            raise ValueError("two bobs coincide at the start")

    kinds, wanted = [1.0] * 5, 1e-7
    for _ in range(4):
        atol = tolerances(model, kinds, wanted)
        _, ys = integrate(model, 1e-6, atol, dense=0)
        tried, kinds = kinds, scales_of_state(model, ys)
        if all(wanted * a <= 1e-3 * b for a, b in zip(tried, kinds, strict=True)):
            break
    atol = tolerances(model, kinds, atol_factor)
    _, ys = integrate(model, rtol, atol, dense=4)
    return report(model, m0, ys)


def report(model: Model, m0: SimpleNamespace, ys: np.ndarray) -> dict:
    """The end state under the names of the scene-file page."""
    m = model.motion(model.duration, ys[-1])
    w = accounts_of(model, m.accounts)
    d_k = model.delta_k_trans(m.d_v)
    d_e = model.delta_e_int(m.omega, m.nu, m.d_theta - m.d_phi)
    values = {
        **{name: getattr(m, name) for name in ("theta", "phi", "omega", "nu")},
        **dict(zip(("x_cm", "y_cm", "vx_cm", "vy_cm"), (*m.r, *m.v), strict=True)),
        **dict(zip(("x_bob", "y_bob", "x_bar", "y_bar"), (*m.r1, *m.r2), strict=True)),
        **{name: w[name] for name in ("w1", "w2", "wL", "wR", "w_int", "w")},
        **{name: w[name] for name in (*REPORTED_PS, "w_ps")},
        "delta_k_trans": d_k,
        "delta_e_int": d_e,
    }
    field = {name: w[name] for name in ("w_field", "w_field_ps")}

    before, after = model.potentials(m0), model.potentials(m)
    d_V = model.departure_of_v(m)
    d_K = model.M_tot * (dot(model.V0, d_V) + 0.5 * dot(d_V, d_V))
    bath = model.bath_m * (dot(model.bath_v0, m.d_u) + 0.5 * dot(m.d_u, m.d_u))
    d_E = (d_k + d_e) @ model.member + bath @ model.bath_member + after.stored - before.stored
    d_E_int = d_E - d_K

    end: dict[str, Any] = {"surfaces": {}, "blocks": {}}
    S = len(model.surfaces)
    W, W_ps = m.accounts[12 * model.n :][:S], m.accounts[12 * model.n + S :][:S]
    for s, (surface, part) in enumerate(zip(model.surfaces, model.slices, strict=True)):
        shown = values | field if model.has_field[s] else values
        end["surfaces"][surface.name] = {k: [float(x) for x in v[part]] for k, v in shown.items()}
        end["blocks"][surface.name] = {
            "W": float(W[s]),
            "W_ps": float(W_ps[s]),
            "delta_K": float(d_K[s]),
            "delta_E_int": float(d_E_int[s]),
        }
    change = d_E.sum() + after.contact - before.contact + after.field - before.field
    end["system"] = {
        "contact_energy": after.contact,
        "total_energy_change": float(change),
        "applied_work": float(m.accounts[-1]),
    }
    end["scales"] = accuracy_scales(model, ys)
    return end
