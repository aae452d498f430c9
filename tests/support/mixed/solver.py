"""Scenes solved a second time: equations of motion in numpy, by scipy's DOP853.

    solution = solve(table, times)                  # a table as of a scene file
    solution = solve(table, times, start)           # from named numbers
    solution["upper"]["w1"]                         # (times, asperites)
    solution["upper"]["W"], solution[SYSTEM]["contact_energy"]

The equations are those of docs/explanation/model.md, written out again; nothing is shared with the
package.  Works are integrals of force . velocity of its point of application in the laboratory, and
pseudoworks of force . velocity of the centre of mass: no identity of the ledger is used.  Unlike
support/reference.py it takes expressions, users' classes, displaced starts and starts at any time.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from support.mixed import potentials

SYSTEM = "system"
DEFAULTS = {"m1": 1.0, "m2": 2.0, "kappa": 2.0, "length": 2.0, "bar_length": 3.0, "charge": 1.0}
DEFAULTS |= {"i2": 5.0}
WORKS = ("w1", "w2", "wL", "wR", "w_int", "w_field", "w_T")
EXTERNAL = tuple(name for name in WORKS if name != "w_int")
# Relative tolerance of a step.
TOLERANCE = 1e-7
# Absolute tolerance of a step.
FLOOR = 1e-8
# Evaluations after which a scene is given up.
MOST = 60_000


class CostlyError(RuntimeError):
    """A scene that takes too many evaluations, or whose bobs come too close."""


@dataclass
class Start:
    """Where a run begins, if not at the start of its scene.

    Attributes
    ----------
    t : float
        The time.
    surfaces : dict
        Surface -> theta, omega, phi, nu, x_cm, y_cm, vx_cm, vy_cm of each asperite, and of its
        oscillators `bath`, (asperites, oscillators, 4).
    stages : dict
        Surface -> displacement of its stage at `t`.
    fields : list
        Displacement of each field at `t`; empty for those of the scene.
    zeros : dict
        Surface -> time at which the time of its drive is zero.
    """

    t: float
    surfaces: dict[str, dict[str, np.ndarray]]
    stages: dict[str, float] = field(default_factory=dict)
    fields: list[np.ndarray] = field(default_factory=list)
    zeros: dict[str, float] = field(default_factory=dict)


def vectors(x: Any, y: Any) -> np.ndarray:
    """(n, 2) of two components."""
    found = np.empty((max(np.size(x), np.size(y)), 2))
    found[:, 0] = x
    found[:, 1] = y
    return found


class Surface:
    """The numbers of a surface."""

    def __init__(self, table: dict[str, Any], first: int) -> None:
        self.table = table
        self.name = table["name"]
        self.down = table.get("facing", "down") == "down"
        self.velocity = np.array(table.get("velocity", (0.0, 0.0)), float)
        self.bobs = self._bobs()
        self.n = len(self.bobs)
        self.part = slice(first, first + self.n)
        drive = table.get("drive", "forced")
        self.drive = {"kind": drive} if isinstance(drive, str) else dict(drive)
        self.held = self.drive["kind"] == "bars"
        own = table.get("asperite", {})
        for key, usual in DEFAULTS.items():
            setattr(self, key, self.each(own.get(key, usual)))
        self.rigid = bool(np.isinf(self.kappa[0]))
        self.turns = table.get("bars", "clamped") == "free"
        listed = table.get("langevin", [])
        self.reservoirs = [listed] if isinstance(listed, dict) else listed
        bath = table.get("bath", {}).get("oscillators", [])
        self.bath = np.array([(o["mass"], o["frequency"]) for o in bath], float).reshape(-1, 2)

    def each(self, value: Any) -> np.ndarray:
        """A number for each asperite."""
        return np.broadcast_to(np.asarray(value, float), (self.n,)).copy()

    def _bobs(self) -> np.ndarray:
        """Resting bobs (n, 3), of listed positions or of a grid."""
        table = self.table
        if "positions" in table:
            bobs = np.array(table["positions"], float)
        else:
            x, y = table.get("bob", (0.0, 0.0))
            nx, nz = table.get("shape", (1, 1))
            dx, dz = table.get("spacing", (0.0, 0.0))
            z = table.get("depth", 0.0)
            bobs = np.array([(x + i * dx, y, z + k * dz) for k in range(nz) for i in range(nx)])
        bobs[:, 1] += np.asarray(table.get("heights", 0.0), float)
        return bobs

    def springs(self, periodic: dict[str, float]) -> list[tuple[int, int, float]]:
        """(one, other, stiffness) of lattice springs."""
        table = self.table.get("springs", {})
        stiffness = np.broadcast_to(table.get("stiffness", 0.0), (2,))
        if "pairs" in table:
            return [(i, j, stiffness[0]) for i, j in table["pairs"]]
        nx, nz = self.table.get("shape", (1, 1))
        wrap = [table.get("wrap", False) and (not periodic or axis in periodic) for axis in "xz"]
        found = []
        for k in range(nz):
            for i in range(nx):
                if i + 1 < nx or (wrap[0] and nx > 1):
                    found.append((k * nx + i, k * nx + (i + 1) % nx, stiffness[0]))
                if k + 1 < nz or (wrap[1] and nz > 1):
                    found.append((k * nx + i, (k + 1) % nz * nx + i, stiffness[1]))
        return found


class Model:
    """A scene and its equations of motion."""

    def __init__(self, table: dict[str, Any], start: Start | None = None) -> None:
        self.table = table
        first = 0
        self.surfaces = []
        for own in table["surface"]:
            self.surfaces.append(Surface(own, first))
            first += self.surfaces[-1].n
        self.n = first
        self.start = start
        self.names = [s.name for s in self.surfaces]

        def joined(name: str) -> np.ndarray:
            return np.concatenate([getattr(s, name) for s in self.surfaces])

        for key in (*DEFAULTS, "bobs"):
            setattr(self, key, joined(key))
        self.m = self.m1 + self.m2
        self.l1 = self.length * self.m2 / self.m
        self.l2 = self.length * self.m1 / self.m
        self.inertia = self.m1 * self.m2 / self.m * self.length**2
        self.down = np.concatenate([np.full(s.n, 1.0 if s.down else -1.0) for s in self.surfaces])
        self.rest = np.where(self.down > 0.0, 0.0, np.pi)
        self.resting_bars = self.bobs[:, :2] + vectors(0.0, self.down * self.length)
        self.v0 = np.concatenate([np.tile(s.velocity, (s.n, 1)) for s in self.surfaces])
        self.held = np.concatenate([np.full(s.n, s.held) for s in self.surfaces])
        self.rigid = np.concatenate([np.full(s.n, s.rigid) for s in self.surfaces])
        self.turns = np.concatenate([np.full(s.n, s.turns) for s in self.surfaces])
        self.soft = np.where(self.rigid, 0.0, self.kappa)
        self.any_held = bool(np.any(self.held))
        self.periodic = table.get("periodic", {})
        self._pairs()
        self._links()
        self.baths = [len(s.bath) for s in self.surfaces]
        self.fields = table.get("field", [])
        self.evaluations = 0

    def _pairs(self) -> None:
        """Pairs of bobs that interact: (energy, one, other, charges, whether within a surface)."""
        given = self.table.get("interaction", [])
        self.contacts = []
        for table in [given] if isinstance(given, dict) else given:
            between = sorted(table["between"]) if "between" in table else None
            one = []
            other = []
            for a, s in enumerate(self.surfaces):
                for u in self.surfaces[a:]:
                    if s is u if between is None else sorted((s.name, u.name)) != between:
                        continue
                    for i in range(s.part.start, s.part.stop):
                        for j in range(i + 1 if s is u else u.part.start, u.part.stop):
                            if self._meet(table, s, u, i - s.part.start, j - u.part.start):
                                one.append(i)
                                other.append(j)
            within = between is not None and between[0] == between[1]
            pairs = np.array(one, int), np.array(other, int)
            q = self.charge[pairs[0]] * self.charge[pairs[1]]
            self.contacts.append((potentials.energy_of(table), *pairs, q, within))

    @staticmethod
    def _meet(table: dict[str, Any], s: Surface, u: Surface, i: int, j: int) -> bool:
        """Whether a potential acts between two bobs, by their species."""
        if "species" not in table:
            return True
        found = []
        for each, k in ((s, i), (u, j)):
            species = each.table.get("species", "")
            found.append(species if isinstance(species, str) else species[k])
        return sorted(found) == sorted(table["species"])

    def _links(self) -> None:
        """Lattice springs of all surfaces."""
        links = []
        for s in self.surfaces:
            for i, j, k in s.springs(self.periodic):
                links.append((s.part.start + i, s.part.start + j, k))
        table = np.array(links, float).reshape(-1, 3)
        self.one = table[:, 0].astype(int)
        self.other = table[:, 1].astype(int)
        self.stiffness = table[:, 2]

    def initial(self) -> np.ndarray:
        """The coordinates and rates of all asperites at the start, (8, n), then of the baths."""
        rows = np.zeros((8, self.n))
        baths = []
        for s in self.surfaces:
            part = s.part
            own = s.table.get("initial", {})
            phi, omega, nu = (s.each(own.get(key, 0.0)) for key in ("phi", "omega", "nu"))
            theta = self.rest[part] + s.each(own["swing"]) if "swing" in own else None
            if theta is None:
                theta = s.each(own["theta"]) if "theta" in own else phi + self.rest[part]
            x = s.bobs[:, 0] + s.each(own.get("x", 0.0))
            y = s.bobs[:, 1] + self.down[part] * self.l1[part] + s.each(own.get("y", 0.0))
            v = s.velocity + vectors(s.each(own.get("vx", 0.0)), s.each(own.get("vy", 0.0)))
            rows[:, part] = x, y, v[:, 0], v[:, 1], theta, omega, phi, nu
        if self.start is not None:
            for s in self.surfaces:
                given = self.start.surfaces[s.name]
                keys = ("x_cm", "y_cm", "vx_cm", "vy_cm", "theta", "omega", "phi", "nu")
                rows[:, s.part] = [given[key] for key in keys]
        elif self.any_held:
            self._hang(0.0, rows)
        place = self._places(rows)
        for s in self.surfaces:
            if len(s.bath):
                bars = place["bar"][s.part]
                each = np.concatenate([bars, np.tile(s.velocity, (s.n, 1))], axis=1)
                each = np.repeat(each[:, None, :], len(s.bath), axis=1)
                if self.start is not None:
                    each = self.start.surfaces[s.name]["bath"]
                baths.append(each.ravel())
        return np.concatenate([rows.ravel(), *baths])

    def _hang(self, t: float, rows: np.ndarray) -> None:
        """Put the centres of mass of driven bars where their pendulums put them."""
        bar = self.resting_bars + self.v0 * t
        sin = np.sin(rows[4])
        cos = np.cos(rows[4])
        lever = self.l2
        centre = bar + lever[:, None] * vectors(sin, -cos)
        rate = self.v0 + (lever * rows[5])[:, None] * vectors(cos, sin)
        h = self.held
        rows[0:2, h] = centre[h].T
        rows[2:4, h] = rate[h].T

    def _places(self, rows: np.ndarray) -> dict[str, np.ndarray]:
        """Positions and velocities of bobs, bars and ends of bars."""
        centre = rows[0:2].T
        v = rows[2:4].T
        theta, omega, phi, nu = rows[4:]
        out = vectors(np.sin(theta), -np.cos(theta))
        turn = vectors(np.cos(theta), np.sin(theta))
        normal = vectors(-np.sin(phi), np.cos(phi))
        l1 = self.l1[:, None]
        l2 = self.l2[:, None]
        rate = omega[:, None] * turn
        v_bar = v - l2 * rate
        reach = (0.5 * self.bar_length * nu)[:, None] * normal
        return {
            "centre": centre,
            "v": v,
            "turn": turn,
            "out": out,
            "normal": normal,
            "bob": centre + l1 * out,
            "bar": centre - l2 * out,
            "v_bob": v + l1 * rate,
            "v_bar": v_bar,
            "v_L": v_bar - reach,
            "v_R": v_bar + reach,
        }

    def _contact(
        self, place: dict[str, np.ndarray]
    ) -> tuple[np.ndarray, np.ndarray, float, np.ndarray]:
        """Forces between and within surfaces, the energy of those, and of these by asperite."""
        forces = np.zeros((2, self.n, 2))
        total = 0.0
        inner = np.zeros(self.n)
        bob = place["bob"]
        z = self.bobs[:, 2]
        for energy, one, other, q, within in self.contacts:
            if not one.size:
                continue
            d = np.column_stack([bob[one] - bob[other], z[one] - z[other]])
            for axis, name in ((0, "x"), (2, "z")):
                if name in self.periodic:
                    length = self.periodic[name]
                    d[:, axis] -= length * np.round(d[:, axis] / length)
            r = np.sqrt(np.sum(d * d, axis=1))
            value = energy(r + 1j * potentials.STEP, q)
            f = (-np.imag(value) / potentials.STEP / r)[:, None] * d[:, :2]
            k = int(within)
            np.add.at(forces[k], one, f)
            np.add.at(forces[k], other, -f)
            if within:
                np.add.at(inner, one, np.real(value))
            else:
                total += float(np.sum(np.real(value)))
        return forces[0], forces[1], total, inner

    def _field(self, t: float, place: dict[str, np.ndarray]) -> tuple[np.ndarray, float, float]:
        """Forces of the fields, their energy, and the power of what moves them."""
        forces = np.zeros((self.n, 2))
        total = 0.0
        power = 0.0
        for k, table in enumerate(self.fields):
            velocity = np.array(table.get("velocity", (0.0, 0.0)), float)
            moved = velocity * t
            if self.start is not None and self.start.fields:
                moved = self.start.fields[k] + velocity * (t - self.start.t)
            for s in self.surfaces:
                if s.name in table["on"]:
                    x, y = (place["bob"][s.part] - table.get("origin", (0.0, 0.0)) - moved).T
                    if table["kind"] == "corrugation":
                        k_x = 2.0 * np.pi / table["period"]
                        f = vectors(-table["amplitude"] * k_x * np.sin(k_x * x), 0.0)
                        u = -table["amplitude"] * np.cos(k_x * x)
                    else:
                        f = vectors(-table["along"] * x, -table["across"] * y)
                        u = 0.5 * (table["along"] * x * x + table["across"] * y * y)
                    forces[s.part] += f
                    total += float(np.sum(u))
                    power += float(np.sum(f @ velocity))
        return forces, total, power

    def _drive(self, t: float, place: dict[str, np.ndarray], f1: np.ndarray) -> np.ndarray:
        """f2 of all surfaces, zero where bars are driven."""
        f2 = np.zeros((self.n, 2))
        for s in self.surfaces:
            part = s.part
            drive = s.drive
            kind = s.drive["kind"]
            own = f1[part]
            m = self.m[part]
            own_t = t
            if self.start is not None:
                own_t = t - self.start.zeros.get(s.name, 0.0)
            x_bar = place["bar"][part]
            v_bar = place["v_bar"][part]
            x, y = -own[:, 0], -own[:, 1]
            if kind == "free":
                x = np.zeros(s.n)
                if drive.get("rigid"):
                    x = -own[:, 0] + m / m.sum() * own[:, 0].sum()
            elif kind == "pulled":
                stage = drive["speed"] * t
                if self.start is not None:
                    stage = self.start.stages.get(s.name, 0.0)
                    stage = stage + drive["speed"] * (t - self.start.t)
                x = drive["stiffness"] * (s.bobs[:, 0] + stage - x_bar[:, 0])
            elif kind == "push":
                force = drive["force"]
                rate = drive.get("rate", (0.0, 0.0))
                x = np.full(s.n, force[0] + rate[0] * own_t)
                y = np.full(s.n, force[1] + rate[1] * own_t)
            elif kind.endswith(":Shaker"):
                push = drive["strength"] * np.cos(drive["frequency"] * own_t)
                x = push - drive["damping"] * v_bar[:, 0]
            elif kind == "bars":
                x = y = np.zeros(s.n)
            if drive.get("load") is not None:
                y = np.full(s.n, -drive["load"] if s.down else drive["load"])
            f2[part] = vectors(x, y)
        return f2

    def _inside(
        self, t: float, place: dict[str, np.ndarray], baths: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, dict[str, float]]:
        """Forces of springs and baths on bars, rates of oscillators, stored energies."""
        spring, bath = np.zeros((2, self.n, 2))
        stored = {s.name: 0.0 for s in self.surfaces}
        rates = []
        first = 0
        if self.one.size:
            u = place["bar"] - self.resting_bars - self.v0 * t
            pull = -self.stiffness[:, None] * (u[self.one] - u[self.other])
            np.add.at(spring, self.one, pull)
            np.add.at(spring, self.other, -pull)
            for one, each, k in zip(self.one, pull, self.stiffness, strict=True):
                owner = next(s for s in self.surfaces if s.part.start <= one < s.part.stop)
                stored[owner.name] += 0.5 * float(each @ each) / k if k else 0.0
        for s in self.surfaces:
            if len(s.bath):
                size = s.n * len(s.bath) * 4
                q = baths[first : first + size].reshape(s.n, len(s.bath), 4)
                first += size
                m = s.bath[:, 0]
                w = s.bath[:, 1]
                pull = (m * w * w)[None, :, None] * (q[:, :, :2] - place["bar"][s.part][:, None])
                bath[s.part] = pull.sum(axis=1)
                rates.append(np.concatenate([q[:, :, 2:], -pull / m[None, :, None]], axis=2))
                stored[s.name] += 0.5 * np.sum(m[None, :, None] * q[:, :, 2:] ** 2)
                stored[s.name] += 0.5 * np.sum(pull**2 / (m * w * w)[None, :, None])
        joined = np.concatenate([each.ravel() for each in rates]) if rates else np.zeros(0)
        return spring, bath, joined, stored

    def _reservoirs(
        self, omega: np.ndarray, v_bar: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Forces on bars, torques on pendulums, and velocities of the reservoirs."""
        force = np.zeros((self.n, 2))
        flow = np.zeros((self.n, 2))
        torque = np.zeros(self.n)
        for s in self.surfaces:
            for each in s.reservoirs:
                if each.get("on", "bar") == "bar":
                    flow[s.part] = each.get("velocity", s.velocity)
                    force[s.part] = -each["gamma"] * (v_bar[s.part] - flow[s.part])
                else:
                    torque[s.part] = -each["gamma"] * omega[s.part]
        return force, torque, flow

    def evaluate(self, t: float, rows: np.ndarray, baths: np.ndarray) -> dict[str, Any]:
        """All forces, powers and energies."""
        if self.any_held:
            self._hang(t, rows)
        place = self._places(rows)
        theta, omega, phi, nu = rows[4:]
        turn = place["turn"]
        v_bar = place["v_bar"]
        f1, within, contact, inner = self._contact(place)
        field, in_fields, moving = self._field(t, place)
        f2 = self._drive(t, place, f1)
        spring, bath, rates, stored = self._inside(t, place, baths)
        f_T, torque, flow = self._reservoirs(omega, v_bar)
        twist = np.where(self.rigid, 0.0, theta - phi - self.rest)
        torsion = self.soft * twist
        on_bob = f1 + within + field
        on_bar = f2 + spring + bath + f_T
        # The torque about the centre of mass; without `on_bar` that about the bar.
        cross = self.l1 * _dot(turn, on_bob) - self.l2 * _dot(turn, on_bar)
        alpha = (cross - torsion + torque) / self.inertia
        a = (on_bob + on_bar) / self.m[:, None]
        if self.any_held:
            about = self.length * _dot(turn, on_bob) - torsion + torque
            alpha = np.where(self.held, about / (self.m1 * self.length**2), alpha)
            swung = alpha[:, None] * turn - (omega**2)[:, None] * place["out"]
            h = self.held[:, None]
            a = np.where(h, self.l2[:, None] * swung, a)
            f2 = np.where(h, f2 + self.m[:, None] * a - on_bob - on_bar, f2)
        alpha = np.where(self.rigid, 0.0, alpha)
        pull = np.where(self.rigid, cross, np.where(self.turns, 0.0, torsion)) / self.bar_length
        f_L = pull[:, None] * place["normal"]
        forces = np.stack([f1, f2, f_L, -f_L, spring + bath + within, field, f_T])
        bob = place["v_bob"]
        bar = v_bar
        points = np.stack([bob, bar, place["v_L"], place["v_R"], bar, bob, bar])
        powers = _dot(forces, points)
        powers[WORKS.index("w_int")] += _dot(within, bob - bar)
        powers[WORKS.index("w_T")] += torque * omega
        turning = np.where(self.turns, torsion / self.i2, 0.0)
        names = ("f1", "f2", "fL", "fR", "f_within", "f_field", "f_spring", "f_bath", "f_T")
        each = (f1, f2, f_L, -f_L, within, field, spring, bath, f_T)
        kinetic = self.inertia * omega**2 + self.i2 * nu**2
        return {
            "rates": np.stack([*rows[2:4], *a.T, omega, alpha, nu, turning]),
            "baths": rates,
            "powers": powers,
            "pseudo": _dot(forces, place["v"]),
            "heat": -_dot(f_T, v_bar - flow) - torque * omega,
            "external": forces.sum(axis=0) - forces[WORKS.index("w_int")],
            "moving": moving,
            "place": place,
            "e_int": 0.5 * (kinetic + torsion * twist),
            "k": 0.5 * self.m * _dot(place["v"], place["v"]),
            "energies": {"contact": contact, "field": in_fields},
            "inside": {s.name: stored[s.name] + inner[s.part].sum() for s in self.surfaces},
            "forces": dict(zip(names, each, strict=True)),
        }

    def masses(self) -> dict[str, float]:
        """The mass of each surface with its bath."""
        return {
            s.name: float(self.m[s.part].sum() + s.n * s.bath[:, 0].sum()) for s in self.surfaces
        }

    def mean_velocity(self, s: Surface, v: np.ndarray, baths: np.ndarray) -> np.ndarray:
        """The velocity of the centre of mass of a surface's asperites and oscillators."""
        momentum = self.m[s.part] @ v[s.part]
        if len(s.bath):
            first = sum(u.n * len(u.bath) * 4 for u in self.surfaces[: self.surfaces.index(s)])
            q = baths[first : first + s.n * len(s.bath) * 4].reshape(s.n, len(s.bath), 4)
            momentum = momentum + np.einsum("j,ijk->k", s.bath[:, 0], q[:, :, 2:])
        return momentum / self.masses()[s.name]

    def slope(self, t: float, y: np.ndarray) -> np.ndarray:
        """The rate of coordinates, oscillators and accounts."""
        self.evaluations += 1
        if self.evaluations > MOST:
            raise CostlyError(f"more than {MOST} evaluations until t = {t:g}")
        n = self.n
        size = sum(s.n * len(s.bath) * 4 for s in self.surfaces)
        rows = y[: 8 * n].reshape(8, n).copy()
        baths = y[8 * n : 8 * n + size]
        found = self.evaluate(t, rows, baths)
        total = []
        for s in self.surfaces:
            mean = self.mean_velocity(s, found["place"]["v"], baths)
            total.append(found["external"][s.part].sum(axis=0) @ mean)
        accounts = [found["powers"].ravel(), found["pseudo"].ravel(), found["heat"]]
        accounts += [np.array(total), np.array([found["moving"]])]
        return np.concatenate([found["rates"].ravel(), found["baths"], *accounts])


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.einsum("...i,...i->...", a, b)


def solve(
    table: dict[str, Any],
    times: np.ndarray,
    start: Start | None = None,
    tolerance: float = TOLERANCE,
) -> dict[str, dict[str, np.ndarray]]:
    """Every quantity at some times; works and changes count from the first one.

    Raises CostlyError if that takes too many evaluations.
    """
    model = Model(table, start)
    n = model.n
    size = sum(s.n * len(s.bath) * 4 for s in model.surfaces)
    y = np.concatenate([model.initial(), np.zeros(15 * n + len(model.surfaces) + 1)])
    times = np.asarray(times, float)
    with np.errstate(all="ignore"):
        run = solve_ivp(
            model.slope,
            (times[0], times[-1]),
            y,
            "DOP853",
            t_eval=times,
            rtol=tolerance,
            atol=FLOOR * tolerance / TOLERANCE,
            max_step=(times[-1] - times[0]) / 20.0,
        )
    if run.status != 0 or not np.all(np.isfinite(run.y)):
        raise CostlyError(run.message)
    samples = []
    for t, column in zip(times, run.y.T, strict=True):
        rows = column[: 8 * n].reshape(8, n).copy()
        baths = column[8 * n : 8 * n + size]
        found = model.evaluate(t, rows, baths)
        accounts = column[8 * n + size :]
        samples.append(_sample(model, rows, baths, found, accounts))
    return {
        group: {name: np.array([s[group][name] for s in samples]) for name in samples[0][group]}
        for group in samples[0]
    } | _changes(samples)


def _sample(model: Model, rows: np.ndarray, baths: np.ndarray, found: dict, accounts: np.ndarray):
    """All quantities at one time, with energies in place of their changes."""
    n = model.n
    place = found["place"]
    table = {}
    works = dict(zip(WORKS, accounts[: 7 * n].reshape(7, n), strict=True))
    pseudo = dict(zip(WORKS, accounts[7 * n : 14 * n].reshape(7, n), strict=True))
    heat = accounts[14 * n : 15 * n]
    W_ps = accounts[15 * n : -1]
    moved = accounts[-1]
    every = {"theta": rows[4], "omega": rows[5], "phi": rows[6], "nu": rows[7]}
    for name, key in (("cm", "centre"), ("bob", "bob"), ("bar", "bar")):
        every |= {f"x_{name}": place[key][:, 0], f"y_{name}": place[key][:, 1]}
    every |= {"vx_cm": place["v"][:, 0], "vy_cm": place["v"][:, 1]}
    every |= works | {f"{name}_ps": values for name, values in pseudo.items()}
    every |= {"w": sum(works.values()), "w_ps": sum(pseudo.values()), "heat": heat}
    every |= {"delta_k_trans": found["k"], "delta_e_int": found["e_int"]}
    for name, f in found["forces"].items():
        every |= {f"{name}_x": f[:, 0], f"{name}_y": f[:, 1]}
    inside = 0.0
    for k, s in enumerate(model.surfaces):
        own = {name: values[s.part] for name, values in every.items()}
        mass = model.masses()[s.name]
        v = model.mean_velocity(s, place["v"], baths)
        own["W"] = sum(own[name].sum() for name in EXTERNAL)
        own["W_ps"] = W_ps[k]
        own["delta_K"] = 0.5 * mass * (v @ v)
        total = own["delta_k_trans"].sum() + own["delta_e_int"].sum() + found["inside"][s.name]
        own["delta_E_int"] = total - own["delta_K"]
        own["friction_force"] = own["f1_x"].sum() + own["f_field_x"].sum()
        own["pull_force"] = own["f2_x"].sum()
        inside += total
        table[s.name] = own
    energies = found["energies"]
    everything = inside + sum(energies.values())
    applied = sum(works[name].sum() for name in ("w2", "wL", "wR", "w_T")) + moved
    table[SYSTEM] = {"contact_energy": energies["contact"], "applied_work": applied}
    table[SYSTEM]["total_energy_change"] = everything
    return table


def _changes(samples: list[dict]) -> dict[str, dict[str, np.ndarray]]:
    """Changes from the first sample, in place of energies."""
    found = {}
    for group, table in samples[0].items():
        values = {name: np.array([s[group][name] for s in samples]) for name in table}
        for name in values:
            if name.startswith("delta_") or name == "total_energy_change":
                values[name] = values[name] - values[name][0]
        found[group] = values
    return found
