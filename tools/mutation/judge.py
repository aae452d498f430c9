"""What catches a mutant: checks that run uncompiled, in a process of their own.

A check compares runs with the identities of the ledger, an independent solver, or a closed form,
never with what the package itself gave before.
"""

import gc
import importlib
import os
import signal
import sys
import warnings
from collections import defaultdict
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace
from functools import cache
from time import process_time
from types import CodeType, FunctionType
from typing import NamedTuple
from unittest import mock

import numpy as np
from scipy.linalg import expm
from tools.mutation.formulas import FORMULAS
from tools.mutation.loops import LOOPS
from tools.mutation.registers import registers_as_arrays
from tools.mutation.scenes import COULOMB, LOWER, PAIRS, SCENES
from tools.mutation.start import start_of
from tools.mutation.unit_tests import UNIT_TESTS

import tribo
from support import inactive, reference
from support.laws import identities, kind, tables
from support.package import SOURCE

ALL = SCENES | PAIRS
IDENTITIES_ALONE = ("damped twice", "waves", "damped")
NO_REFERENCE = {"surfaces": {}, "blocks": {}, "system": {}, "scales": {"energy": 0.5}}
WEAK = COULOMB | {"strength": 1e-15}
SOLVED = 1e-10  # relative error of the independent solver: the checks allow 1e-7
HANGS = 3.0  # times the processor time that a check takes without a mutant
LONGER = 8.0  # a check of the cost may take, in units of the check that it belongs to


# --- comparisons ---------------------------------------------------------------------------------


@cache
def solution(name):
    """The end of a scene by the independent solver."""
    if name == "pushed":  # the pseudoworks of the ends are not reported, and do not cancel
        return NO_REFERENCE | {"no law": "w_ps is the sum of the pseudoworks"}
    if name in IDENTITIES_ALONE:
        return NO_REFERENCE
    return reference.solve(ALL[name], wanted=SOLVED).end


def scene_of(table):
    """The scene of a scene file's table, with plug-ins where `ALL` has them by name."""
    scene = importlib.import_module("tribo.model.scene_file").scene_from(table)
    if table is ALL["by hand"]:
        upper, lower = scene.surfaces
        upper = replace(upper, drive=tribo.Custom(force=PulledByHand(1.2, 0.5, -0.6)))
        lower = replace(lower, bars=tribo.Ends(ClampedByHand(1.4 / 1.8)))
        scene = replace(scene, surfaces=(upper, lower))
    if table is ALL["pushed"]:
        upper, lower = scene.surfaces
        scene = replace(scene, surfaces=(upper, replace(lower, bars=tribo.Ends(Pushed(0.3)))))
    if table is ALL["waves"]:
        (field,) = scene.fields
        scene = replace(scene, fields=(replace(field, potential=waves(0.3, 3.1, 2.3)),))
    return scene


def simulate(table, **how):
    """A run of a scene file's table."""
    return importlib.import_module("tribo.simulation").simulate(scene_of(table), **how)


def ends(result):
    """Every table of the ledger at the end."""
    for surface, table in tables(result):
        yield surface.name if surface else "system", {q: table[q][-1] for q in table}


def extrapolated(coarse, fine, order):
    """The limit of runs with two steps, table by table, at the end."""
    weight = 1.0 / (2**order - 1)
    for (place, one), (_, other) in zip(ends(coarse), ends(fine), strict=True):
        yield place, {q: other[q] + weight * (other[q] - one[q]) for q in other}


def complaint(found, truth, tolerance):
    """What is wrong with the ledger's end, by its own laws or by the independent solution."""
    allowed = {name: tolerance * scale for name, scale in truth["scales"].items()}
    for place, table in found:
        for law, _, one, other in identities([table]):
            if law != truth.get("no law") and not np.all(np.abs(one - other) <= allowed["energy"]):
                return f"{place}: {law}"
        if np.any(table.get("heat", 0.0) < 0.0):
            return f"{place}: heat flows from a reservoir at temperature 0"
        known = truth["surfaces"] if "theta" in table else truth["blocks"]
        for name, values in (known | {"system": truth["system"]}).get(place, {}).items():
            if not np.all(np.abs(table[name] - values) <= allowed[kind(name)]):
                return f"{place}: {name} differs from the reference"
    return ""


def stopped(*results):
    """The status of the first run that did not complete."""
    for result in results:
        if result.status != "completed":
            return f"stops with {result.status}"
    return ""


# --- checks --------------------------------------------------------------------------------------


class Steps(NamedTuple):
    """The limit of two runs, with a step and with half of it, agrees with the solution."""

    scene: str
    method: str
    step: float
    order: int
    tolerance: float

    def __call__(self):
        steps = (self.step, 0.5 * self.step)
        runs = [simulate(ALL[self.scene], method=self.method, step=h) for h in steps]
        found = extrapolated(*runs, self.order)
        return stopped(*runs) or complaint(found, solution(self.scene), self.tolerance)


class Accurate(NamedTuple):
    """A run to an accuracy agrees with the solution, and takes about as many steps as it should."""

    scene: str
    method: str
    accuracy: float
    tolerance: float

    def __call__(self):
        run = simulate(ALL[self.scene], method=self.method, accuracy=self.accuracy)
        return stopped(run) or complaint(ends(run), solution(self.scene), self.tolerance)


class Limited(NamedTuple):
    """The same with lower limits, so that a small scene counts as large."""

    check: Callable[[], str]
    limits: dict[str, int]  # by their places in the package

    def __call__(self):
        with ExitStack() as stack:
            for place, limit in self.limits.items():
                stack.enter_context(mock.patch(f"tribo.{place}", limit))
            return self.check()


class AsPair(NamedTuple):
    """The loop for one asperite on one, with arrays in place of registers."""

    scene: str
    accuracy: float
    tolerance: float

    def __call__(self):
        with registers_as_arrays():
            run = simulate(ALL[self.scene], method="gauss-radau-15", accuracy=self.accuracy)
        return stopped(run) or complaint(ends(run), solution(self.scene), self.tolerance)


class Agrees(NamedTuple):
    """The limits of two methods for small steps agree, where no independent solution exists."""

    scene: str
    one: str
    other: str
    step: float
    tolerance: float

    def __call__(self):
        limits = []
        for method in (self.one, self.other):
            steps = (self.step, 0.5 * self.step)
            runs = [simulate(ALL[self.scene], method=method, step=h) for h in steps]
            limits.append(list(extrapolated(*runs, 2)))
            said = stopped(*runs) or complaint(limits[-1], NO_REFERENCE, self.tolerance)
            if said:
                return f"{method}: {said}"
        for (place, one), (_, other) in zip(*limits, strict=True):
            for quantity in one:
                if not np.allclose(one[quantity], other[quantity], 0.0, self.tolerance):
                    return f"{place}: {quantity} by {self.one} and by {self.other}"
        return ""


class PulledByHand(NamedTuple):
    """The stage and its spring as a plug-in."""

    stiffness: float
    speed: float
    start: float  # of the bar

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        """f2."""
        return self.stiffness * (self.start + self.speed * t - x), -fy


class ClampedByHand(NamedTuple):
    """What holds the ends of a bar that does not turn, as a plug-in."""

    stiffness: float  # kappa / bar_length

    def end_forces(self, t, phi, nu, twist):
        """f_L and f_R."""
        end = self.stiffness * twist
        x = -end * np.sin(phi)
        y = end * np.cos(phi)
        return x, y, -x, -y


class Pushed(NamedTuple):
    """Forces on the ends of a bar that move it along and across, and turn it."""

    strength: float

    def end_forces(self, t, phi, nu, twist):
        """f_L and f_R."""
        f = self.strength
        return f, 2.0 * f * twist, -3.0 * f * np.cos(t), f + 0.5 * f * nu


def touching(table, start, first, second):
    """Which pairs of bobs have a contact, in a scene whose contacts are of all species."""
    contacts = table["interaction"]
    contacts = [contacts] if isinstance(contacts, dict) else contacts
    names = [surface["name"] for surface in table["surface"]]
    of = np.repeat(names, start.counts)
    met = of[first] != of[second]
    for contact in contacts:
        one, other = contact.get("between", names)
        met |= (of[first] == one) & (of[second] == other)
    return met


class Encounters(NamedTuple):
    """A first step is refused if a pair of bobs can cover its distance in it, and no other.

    Bobs that interact by 1 / r change their force over their distance.
    """

    scene: str

    def __call__(self):
        table = ALL[self.scene]
        start = start_of(table)
        swing = np.hypot(start.omega, start.frequency * start.twist)
        first, second = np.triu_indices(start.omega.size, 1)
        speed = np.hypot(*(start.velocity[:, first] - start.velocity[:, second]))
        speed += (start.arm * swing)[first] + (start.arm * swing)[second]
        places = np.vstack([start.bob, start.depth])
        distance = np.linalg.norm(places[:, first] - places[:, second], axis=0)
        rate = np.max((speed / distance)[touching(table, start, first, second)])
        for part in (0.99, 1.01):
            h = part / rate
            run = simulate(table | {"duration": 4.0 * h}, method="midpoint", step=h)
            if (run.cost.steps == 0) != (part > 1.0):
                return f"{part} of the longest step: {run.cost.steps} steps"
        return ""


class Efficient(NamedTuple):
    """A run to an accuracy agrees with the solution, and costs no more than it should.

    The bounds are a tenth above the cost when they were set: a mutant of step control or of a
    prediction changes no result, but makes more and shorter steps.
    """

    scene: str
    method: str
    accuracy: float
    most: int  # force evaluations, estimates of the error included

    def __call__(self):
        with registers_as_arrays() if self.scene in PAIRS else ExitStack():
            run = simulate(ALL[self.scene], method=self.method, accuracy=self.accuracy)
        if run.cost.force_evaluations > self.most:
            return f"{run.cost.force_evaluations} evaluations, at most {self.most} expected"
        found = complaint(ends(run), solution(self.scene), 3.0 * self.accuracy)
        return stopped(run) or found


class Torsional(NamedTuple):
    """A bar with torsional oscillators and its pendulum, without other forces, is linear."""

    method: str
    step: float
    tolerance: float

    def __call__(self):
        surface = ALL["twisting"]["surface"][1]
        table = ALL["twisting"] | {"interaction": WEAK}
        run = simulate(table, method=self.method, step=self.step)["lower"]
        a = surface["asperite"]
        initial = surface["initial"]
        mass = a["m1"] * a["m2"] / (a["m1"] + a["m2"])
        springs = [(o["inertia"], o["frequency"]) for o in surface["bath"]["torsional"]]
        inertia = np.array([mass * a["length"] ** 2, a["i2"], *(i for i, _ in springs)])
        stiffness = np.zeros((4, 4))
        ties = [(0, 1, a["kappa"]), *((2 + n, 1, i * w * w) for n, (i, w) in enumerate(springs))]
        for one, other, k in ties:
            stiffness[[one, other], [one, other]] += k
            stiffness[[one, other], [other, one]] -= k
        x = np.array([initial["theta"] - np.pi, *3 * [initial["phi"]]])
        v = np.array([initial["omega"], initial["nu"], 0.0, 0.0])
        generator = np.zeros((8, 8))
        generator[:4, 4:] = np.eye(4)
        generator[4:, :4] = -stiffness / inertia[:, None]
        end = expm(generator) @ np.concatenate([x, v])
        found = [run[q][-1, 0] for q in ("theta", "phi", "omega", "nu")]
        truth = [end[0] + np.pi, end[1], end[4], end[5]]
        return "" if np.allclose(found, truth, 0.0, self.tolerance) else "not the linear motion"


class Thermal(NamedTuple):
    """Reservoirs on bars and swings give pendulums at rest the covariance of linear friction.

    Of the velocity v of the centre of mass along the arc, across it, and of the rate omega: with
    the force F = -gamma (v - l2 omega) + noise on the bar, M v' = F and I omega' = -l2 F + T, where
    T = -gamma omega + noise is the torque of a reservoir on the swing.
    """

    step: float
    reservoirs: list[dict[str, float | str]]

    def __call__(self):
        count = 1000
        asperite = LOWER["asperite"] | {"kappa": 0.0}
        surface = {
            "name": "upper",
            "asperite": asperite,
            "shape": [count, 1],
            "spacing": [1.0, 0.0],
            "drive": "free",
            "initial": {"theta": 0.7},
            "langevin": self.reservoirs,
        }
        far = LOWER | {"depth": 10.0}
        table = {"duration": self.step, "interaction": WEAK, "surface": [surface, far]}
        run = simulate(table | {"output": {"samples": 2}}, method="verlet", step=self.step)
        vx, vy, omega = (run["upper"][name][-1] for name in ("vx_cm", "vy_cm", "omega"))
        # At the kick, with half a step of rest before and after.
        tx = np.cos(0.7)
        ty = np.sin(0.7)
        found = np.array([tx * vx + ty * vy, tx * vy - ty * vx, omega])
        expected = self.covariance(*(float(asperite[name]) for name in ("m1", "m2", "length")))
        deviation = np.sqrt(np.diag(expected)) + 1e-12  # of the weak contact
        if np.any(abs(np.mean(found, axis=1)) > 5.0 * deviation / np.sqrt(count)):
            return "drift"
        off = abs(found @ found.T / count - expected)
        if np.any(off > 5.0 * np.sqrt(2.0 / count) * np.outer(deviation, deviation)):
            return f"covariance {found @ found.T / count}, expected {expected}"
        return ""

    def covariance(self, m1, m2, length):
        """Of the three velocities after the step: the integral of exp(-A t) Q exp(-A^T t)."""
        l2 = length * m1 / (m1 + m2)
        inverse = np.diag([1.0 / (m1 + m2), 1.0 / (m1 + m2), (m1 + m2) / (m1 * m2 * length**2)])
        friction, noise = np.zeros((2, 3, 3))
        for reservoir in self.reservoirs:
            arms = [[1.0, 0.0, -l2], [0.0, 1.0, 0.0]]
            arms = np.array([[0.0, 0.0, 1.0]] if reservoir.get("on") == "swing" else arms)
            friction += reservoir["gamma"] * arms.T @ arms
            noise += 2.0 * reservoir["gamma"] * reservoir["temperature"] * arms.T @ arms
        a = inverse @ friction
        q = inverse @ noise @ inverse
        both = expm(self.step * np.block([[-a, q], [np.zeros((3, 3)), a.T]]))  # after van Loan
        return both[:3, 3:] @ both[:3, :3].T


class Ledgers(NamedTuple):
    """What runs with different ledgers keep is the same."""

    scene: str
    method: str

    def __call__(self):
        from support import ledgers  # builds scenes, which takes the package

        return "; ".join(ledgers.wrong_with(self.scene, self.method)[:1])


def waves(*numbers):
    """A field that depends on both coordinates, as a plug-in of a new class without a force."""

    class Waves(NamedTuple):
        amplitude: float
        kx: float
        ky: float

        def energy_at(self, x, y):
            """U."""
            return -self.amplitude * np.cos(self.kx * x) * np.cos(self.ky * y)

    return Waves(*numbers)


class Friction(NamedTuple):
    """A short step changes the momentum by -gamma (velocity of the bar - that of the reservoir)."""

    method: str
    step: float
    tolerance: float

    def __call__(self):
        table = ALL["open"] | {"duration": self.step, "field": [], "interaction": WEAK}
        start = start_of(table)
        run = simulate(table, method=self.method, step=self.step)
        for surface, part in zip(table["surface"], start.parts, strict=True):
            gamma = surface["langevin"]["gamma"]
            velocity = surface["langevin"]["velocity"]
            wanted = -gamma * (start.bar_velocity[:, part] - np.array(velocity)[:, None])
            wanted /= start.mass[part]
            own = run[surface["name"]]
            found = np.array([np.diff(own[q], axis=0)[0] for q in ("vx_cm", "vy_cm")]) / self.step
            if surface["name"] == "lower":  # which its drive keeps at its velocity along x
                found[0] = 0.0
                wanted[0] = 0.0
            if not np.allclose(found, wanted, 0.0, self.tolerance):
                return f"{surface['name']}: {found} instead of {wanted}"
        return ""


class DraggedByHand(NamedTuple):
    """The free drive with the friction of a reservoir, as a plug-in."""

    gamma: float
    x: float  # velocity of the reservoir
    y: float

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        """f2."""
        return -self.gamma * (vx - self.x), -fy - self.gamma * (vy - self.y)


class Dragged(NamedTuple):
    """A drive that is friction moves the surfaces as a reservoir does."""

    method: str
    step: float
    tolerance: float

    def __call__(self):
        table = ALL["open"] | {"field": []}
        lower = table["surface"][1] | {"drive": "free"}
        table |= {"surface": [table["surface"][0], lower]}
        scene = importlib.import_module("tribo.model.scene_file").scene_from(table)
        by_hand = replace(scene, surfaces=tuple(map(dragged, scene.surfaces)))
        run = importlib.import_module("tribo.simulation").simulate
        one, other = (run(s, method=self.method, step=self.step) for s in (scene, by_hand))
        for name in ("upper", "lower"):
            for quantity in ("theta", "omega", "x_cm", "y_cm", "vx_cm", "vy_cm"):
                if not np.allclose(one[name][quantity], other[name][quantity], 0, self.tolerance):
                    return f"{name}: {quantity}"
        return ""


def dragged(surface):
    """The surface without its reservoir, and with a drive instead."""
    drag = DraggedByHand(surface.langevin.gamma, *surface.langevin.velocity)
    return replace(surface, langevin=None, drive=tribo.Custom(force=drag))


def equal_steps():
    """Between two samples the steps are equal, and as few as the longest step allows."""
    for method in ("midpoint", "verlet"):
        table = ALL["slid"] | {"duration": 0.7, "output": {"samples": 3}}
        run = simulate(table, method=method, step=0.2)
        if run.cost.steps != 4:
            return f"{method}: {run.cost.steps} steps of at most 0.2 through 0.35 and 0.7"
    return ""


def bars_that_stand():
    """Driven bars at rest receive no work, though their pendulums swing."""
    upper, lower = ALL["held"]["surface"]
    initial = upper["initial"] | {"nu": 0.0}
    upper = upper | {"velocity": [0.0, 0.0], "initial": initial}
    table = ALL["held"] | {"surface": [upper, lower | {"velocity": [0.3, 0.0]}]}
    for method in ("midpoint", "verlet"):
        run = simulate(table, method=method, step=0.05)
        works = run[upper["name"]]
        if not np.max(np.abs(works["w1"])) > 1e-3:
            return f"{method}: the bob receives no work"
        for name in ("w2", "wL", "wR"):
            if np.max(np.abs(works[name])) > 1e-14:
                return f"{method}: {name} = {np.max(np.abs(works[name]))}"
    return ""


def named_plugins():
    """Every plug-in of a scene goes with the field that it is in."""
    lay_out = importlib.import_module("tribo.layout.layout").lay_out
    plugins_of = importlib.import_module("tribo.model.identity").plugins_of
    contact = "interaction[0].potential"
    for name, fields in {
        "by hand": [contact, "surface[0].drive", "surface[1].bars"],
        "waves": [contact, "field[0].kind"],
        "rows": [contact, "interaction[1].potential", "interaction[2].potential"],
    }.items():
        layout = lay_out(scene_of(ALL[name]))
        found = plugins_of(layout.scene)
        if [field for field, _ in found] != fields:
            return f"{name}: {found}"
        if {id(plugin) for _, plugin in found} != {id(plugin) for plugin in layout.plugins}:
            return f"{name}: not those of the kernels"
    return ""


def further_series() -> str:
    """The sum of all forces changes the momentum, that of all energies with the total energy."""
    tribo = importlib.import_module("tribo")
    scene = importlib.import_module("support.everything").everything(0.4)
    bath = tribo.Bath((0.1, 0.2), (1.3, 2.0), inertias=(0.3,), torsional_frequencies=(1.5,))
    push = tribo.Pushed(force=(0.4, -0.2), rate=(0.5, 0.7))
    upper, lower = scene.surfaces
    surfaces = (replace(upper, bath=bath), replace(lower, drive=push, velocity=(0.0, 0.3)))
    output = tribo.Output(samples=41, series=("forces", "energies", "oscillators"))
    scene = replace(scene, surfaces=surfaces, output=output)
    result = tribo.simulate(scene, method="verlet", step=0.01)
    total = result.system["contact_energy"] + result.system["field_energy"]
    for name, masses in (("upper", np.array([3.0, 3.5])), ("lower", 3.0)):
        table = result[name]
        for axis in "xy":
            keys = [k for k in table if k.startswith("f") and k.endswith(f"_{axis}")]
            force = sum(table[k] for k in keys)
            velocity = table[f"v{axis}_cm"]
            impulse = np.sum(force[:-2:2] + 4.0 * force[1:-1:2] + force[2::2], axis=0) / 300.0
            if np.max(np.abs(masses * (velocity[-1] - velocity[0]) - impulse)) > 1e-4:
                return f"momentum of {name} along {axis}"
        for key, values in table.items():
            # The springs of stages are not part of the system.
            if key.startswith(("k_", "e_")) and key != "e_pull":
                total = total + (values if values.ndim == 1 else values.sum(axis=1))
        heat = table.k_bath + table.e_bath
        if np.any(table.k_bath <= 0.0) or np.any(table.e_bath < -1e-15):
            return f"energies of the bath of {name}"
        own = next(each.bath for each in surfaces if each.name == name)
        stretch = np.einsum(
            "m,tamx->xta", own.masses * own.frequencies**2, result.oscillators(name)
        )
        if np.max(np.abs(stretch - [table.f_bath_x, table.f_bath_y])) > 1e-12:
            return f"oscillators of the bath of {name}"
        if name == "upper" and abs(heat[0] - 0.5 * 2.0 * 0.3 * 0.4**2) > 1e-12:
            return "kinetic energy of the bath at the start"
    if np.max(np.abs(total - total[0] - result.system["total_energy_change"])) > 1e-12:
        return "sum of all energies"
    plain = replace(scene, duration=0.01, output=tribo.Output(samples=2))
    if tribo.simulate(plain, method="verlet", step=0.01).ledger.oscillators:
        return "oscillators that are not asked for"
    return ""


def asperites_out_of_reach() -> str:
    """Those that are not stepped, in a short run, and how that is decided."""
    turning = inactive.crossing((2.1,), 24, 2)
    clamped = inactive.crossing((2.1,), 24, 2, "clamped", 7.5)
    return inactive.check_paths(turning) or inactive.check(clamped)


CHECKS: dict[str, Callable[[], str]] = (
    UNIT_TESTS
    | FORMULAS
    | LOOPS
    | {
        "bars that stand": bars_that_stand,
        "named plug-ins": named_plugins,
        "equal steps": equal_steps,
        "further series": further_series,
    }
)
for _scene in ("slid", "pulled", "lattice", "open", "twisting", "held", "swinging"):
    CHECKS[f"midpoint, {_scene}"] = Steps(_scene, "midpoint", 0.05, 2, 1e-3)
for _scene in ("slid", "pulled", "lattice", "twisting"):
    CHECKS[f"kahan-li-6, {_scene}"] = Steps(_scene, "kahan-li-6", 0.25, 6, 1e-5)
CHECKS["midpoint, by hand"] = Steps("by hand", "midpoint", 0.05, 2, 1e-3)
CHECKS["torsional oscillators, gauss-8"] = Torsional("gauss-8", 0.2, 1e-8)
CHECKS["torsional oscillators, kahan-li-6"] = Torsional("kahan-li-6", 0.1, 1e-6)
CHECKS["midpoint, pushed"] = Steps("pushed", "midpoint", 0.1, 2, 1e-3)
CHECKS["midpoint, waves"] = Steps("waves", "midpoint", 0.05, 2, 1e-3)
for _method in ("midpoint", "verlet"):
    CHECKS[f"friction, {_method}"] = Friction(_method, 1e-4, 1e-3)
CHECKS["drag, midpoint"] = Dragged("midpoint", 0.05, 1e-12)
CHECKS["drag, verlet"] = Dragged("verlet", 0.05, 5e-5)  # two methods of second order
CHECKS["verlet, pushed"] = Steps("pushed", "verlet", 0.1, 2, 1e-5)
ON_BAR = {"gamma": 4.0, "temperature": 0.5}
ON_SWING = {"gamma": 3.0, "temperature": 0.2, "on": "swing"}
CHECKS["thermal kicks of bars"] = Thermal(0.1, [ON_BAR])
CHECKS["thermal kicks of swings"] = Thermal(0.1, [ON_SWING])
CHECKS["thermal kicks of both"] = Thermal(0.1, [ON_BAR, ON_SWING])
for _scene in ("slid", "pulled", "slid, slowly"):
    CHECKS[f"encounters, {_scene}"] = Encounters(_scene)
CHECKS["verlet, open"] = Steps("open", "verlet", 0.05, 2, 1e-5)  # its identities are exact
CHECKS["kahan-li-6, loaded"] = Steps("loaded", "kahan-li-6", 0.25, 6, 1e-5)
CHECKS["verlet and midpoint, damped"] = Agrees("damped", "verlet", "midpoint", 0.05, 1e-3)
CHECKS["verlet and midpoint, damped twice"] = Agrees(
    "damped twice", "verlet", "midpoint", 0.05, 1e-3
)
for _scene in ("held", "swinging"):
    CHECKS[f"verlet, {_scene}"] = Steps(_scene, "verlet", 0.05, 2, 1e-3)
CHECKS["rk4, slid"] = Steps("slid", "rk4", 0.1, 4, 1e-4)
CHECKS["rk4, slid, streamed"] = Limited(
    CHECKS["rk4, slid"], {"ledger.sinks.SERIES_BYTES": 0, "ledger.sinks.PORTION_BYTES": 0}
)
CHECKS["rk4, slid, in batches"] = Limited(CHECKS["rk4, slid"], {"layout.span.SPAN_SIZE": 1})
CHECKS["gauss-8, slid"] = Steps("slid", "gauss-8", 0.25, 8, 1e-6)
for _method in ("dop853", "rkn8", "rkn12", "gauss-radau-15"):
    CHECKS[f"{_method}, slid"] = Accurate("slid", _method, 1e-8, 1e-7)
CHECKS["all pairs"] = Steps("rows", "midpoint", 0.02, 2, 1e-3)
LISTS = {"layout.contacts.UNLISTED_PAIRS": 0}
CHECKS["listed pairs"] = Limited(CHECKS["all pairs"], LISTS)
CHECKS["listed pairs, verlet"] = Limited(Steps("rows", "verlet", 0.02, 2, 1e-3), LISTS)
NEAR = LISTS | {"layout.contacts.MARGIN": 2}
CHECKS["inactive asperites"] = Limited(asperites_out_of_reach, NEAR)
for _scene in ("forced on free", "free on free"):
    CHECKS[f"pair, {_scene}"] = AsPair(_scene, 1e-8, 1e-7)
for _scene in ("arms alike", "pulled and loaded", "driven bars", "rigid asperites", "reservoirs"):
    CHECKS[f"ledgers, {_scene}"] = Ledgers(_scene, "verlet")
for _method in ("verlet", "midpoint"):
    _scene = "springs, baths and a moving field"
    CHECKS[f"ledgers, {_scene}, {_method}"] = Ledgers(_scene, _method)
# Longer than the rest.  They reach the functions that the check named here reaches.
COSTS = {
    "dop853, slid": Efficient("slid, slowly", "dop853", 1e-7, 2450),
    "rkn8, slid": Efficient("slid, slowly", "rkn8", 1e-7, 2740),
    "rkn12, slid": Efficient("slid, slowly", "rkn12", 1e-7, 1780),
    "gauss-radau-15, slid": Efficient("slid, slowly", "gauss-radau-15", 1e-7, 2470),
    "pair, forced on free": Efficient("forced on free, slowly", "gauss-radau-15", 1e-7, 2230),
    "pair, free on free": Efficient("free on free, slowly", "gauss-radau-15", 1e-7, 2190),
}
# Checks that the sample of mutants goes without: they take half of the time of all.
LONG = {
    "all pairs",
    "inactive asperites",
    "listed pairs",
    "midpoint, by hand",
    "midpoint, pushed",
    "verlet and midpoint, damped",
    *(f"{method}, slid" for method in ("dop853", "rkn8", "rkn12", "gauss-radau-15")),
}


# --- the process ---------------------------------------------------------------------------------


class Hangs(BaseException):
    """A check takes far longer than it should."""


class Baseline(NamedTuple):
    """What the checks reach, and at what cost, when nothing is changed."""

    seconds: dict[str, float]  # processor time of each check
    reached: dict[tuple[str, str], list[str]]  # checks that call a function, the cheapest first
    functions: dict[tuple[str, str], list[FunctionType]]


def where(code: CodeType) -> tuple[str, str]:
    """File and qualified name of a function of the package."""
    return os.path.relpath(code.co_filename, SOURCE), code.co_qualname


def uncompiled():
    """Make ready a process in which kernels are plain Python."""
    os.environ["NUMBA_DISABLE_JIT"] = "1"
    sys.dont_write_bytecode = True
    warnings.simplefilter("ignore")
    np.seterr(all="ignore")


@cache
def baseline(without: frozenset[str] = frozenset()) -> Baseline:
    """Run every check once, but for some; raises AssertionError if one of them complains."""
    seconds = {}
    called = defaultdict(set)
    here = str(SOURCE)
    for name in ALL:
        solution(name)
    for name, check in CHECKS.items():
        if name in without:
            continue
        codes: dict[int, CodeType] = {}

        def note(frame, event, _, codes=codes):  # of calls alone, since it returns nothing
            codes[id(frame.f_code)] = frame.f_code

        began = process_time()
        sys.settrace(note)
        try:
            said = check()
        finally:
            sys.settrace(None)
        seconds[name] = process_time() - began
        assert not said, f"{name}: {said}"
        for code in codes.values():
            if code.co_filename.startswith(here):
                called[where(code)].add(name)
    functions = defaultdict(list)
    for item in gc.get_objects():
        if isinstance(item, FunctionType) and item.__code__.co_filename.startswith(here):
            functions[where(item.__code__)].append(item)
    reached = {key: sorted(names, key=seconds.__getitem__) for key, names in called.items()}
    return Baseline(seconds, reached, functions)


def complaints() -> list[str]:
    """What the checks say about the package as it is."""
    baseline()
    return [f"{name}: {said}" for name, check in COSTS.items() if (said := check())]


def codes_within(code: CodeType):
    """All code within, with its qualified name."""
    for item in code.co_consts:
        if isinstance(item, CodeType):
            yield item
            yield from codes_within(item)


def verdict(file: str, function: str, source: str, without: frozenset[str] = frozenset()) -> str:
    """What the first check says that a mutant does not pass; empty if it passes all.

    All but those to be gone without.
    """
    base = baseline(without)
    key = file, function
    if key not in base.reached:
        return ""
    (new,) = (
        c for c in codes_within(compile(source, str(SOURCE / file), "exec")) if where(c) == key
    )
    changed = base.functions[key]
    old = changed[0].__code__
    for item in changed:
        item.__code__ = new
    try:
        names = base.reached[key]
        checks = [(name, CHECKS[name], HANGS) for name in names]
        if file.startswith(("integrators/", "pair/")):  # nothing else changes the cost alone
            checks += [(f"cost of {n}", COSTS[n], HANGS * LONGER) for n in names if n in COSTS]
        for name, check, times in checks:
            said = judged(check, times * base.seconds[name.removeprefix("cost of ")] + 0.5)
            if said:
                return f"{name}: {said}"
        return ""
    finally:
        for item in changed:
            item.__code__ = old


def judged(check: Callable[[], str], seconds: float) -> str:
    """What a check says, which may take so much processor time."""

    def stop(*_):
        raise Hangs

    signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        return check()
    except (Exception, Hangs) as error:  # a mutant may fail in any way
        return f"{type(error).__name__}: {error}"
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
