"""Wrong equations do not pass: every mutant of the physics is caught.

A mutant is the package with one sign, arm or function of its equations changed.  It is caught
if a run with it breaks an identity of the ledger, or ends elsewhere than the independent solver
of tests/reference.py does; it is never compared with the package itself.

Mutants run uncompiled, in a process of their own.
"""

import ast
import importlib
import multiprocessing
import os
import shutil
import sys
import warnings
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from support import reference
from support.laws import identities, kind, tables

SOURCE = Path(importlib.util.find_spec("tribo").origin).parent


# --- the scenes ----------------------------------------------------------------------------------

COULOMB = {"potential": "coulomb", "strength": 0.4}
UPPER = {
    "name": "upper",
    "bob": [-0.6, 0.5],
    "velocity": [0.75, -0.25],
    "shape": [2, 1],
    "spacing": [1.1, 0.0],
    "heights": [0.0, 0.15],
    "depth": 0.2,
    "asperite": {
        "m1": [0.7, 1.2],
        "m2": [1.5, 0.8],
        "kappa": [1.9, 1.1],
        "length": [1.3, 1.7],
        "bar_length": [2.0, 1.5],
        "i2": [0.6, 0.9],
        "charge": [1.1, 0.8],
    },
    "initial": {
        "theta": [0.5, -0.3],
        "phi": [0.25, 0.4],
        "omega": [0.6, -0.5],
        "nu": [0.5, -0.4],
    },
}
LOWER = {
    "name": "lower",
    "facing": "up",
    "bob": [0.1, -0.1],
    "depth": -0.1,
    "velocity": [-0.3, 0.2],
    "asperite": {
        "m1": 0.9,
        "m2": 1.3,
        "kappa": 1.4,
        "length": 1.2,
        "bar_length": 1.8,
        "i2": 0.7,
        "charge": 1.3,
    },
    "initial": {"theta": 3.6, "phi": 0.2, "omega": -0.5},
}
TURNING = {"initial": LOWER["initial"] | {"nu": 0.7}}
CORRUGATION = {"kind": "corrugation", "amplitude": 0.3, "period": 1.7}


def scene(upper, lower, **others):
    """A scene file's table: the two surfaces with what is said of them."""
    surfaces = [UPPER | upper, LOWER | lower]
    return {
        "duration": 1.0,
        "interaction": COULOMB,
        "surface": surfaces,
        "output": {"samples": 2},
        **others,
    }


def bath(*oscillators):
    """Oscillators given by mass and frequency."""
    return {"oscillators": [{"mass": mass, "frequency": w} for mass, w in oscillators]}


SCENES = {
    "slid": scene({}, {"drive": "free", "bars": "free"} | TURNING),
    "pulled": scene(
        {
            "drive": {"kind": "free", "rigid": True, "load": 0.3},
            "bars": "free",
            "shape": [1, 2],
            "spacing": [0.0, 0.5],
            "species": ["A", "B"],
        },
        {
            "drive": {"kind": "pulled", "stiffness": 1.2, "speed": 0.5, "load": 0.2},
            "species": "B",
        },
        interaction=[
            COULOMB | {"between": ["upper", "lower"], "species": ["A", "B"]},
            COULOMB | {"between": ["lower", "upper"], "species": ["B", "B"], "strength": 0.3},
            COULOMB | {"between": ["upper", "upper"], "strength": 0.15},
        ],
    ),
    "lattice": scene(
        {"springs": {"stiffness": 1.5}, "bath": bath((0.3, 1.5), (0.2, 2.5))},
        {"bath": bath((0.4, 2.0))} | TURNING,
        field=[CORRUGATION | {"on": ["upper", "lower"]}],
    ),
    "open": scene(
        {"drive": "free", "langevin": {"gamma": 0.4, "velocity": [-0.5, -0.2]}},
        {"langevin": {"gamma": 0.3, "velocity": [-0.3, 1.0]}} | TURNING,
        field=[CORRUGATION | {"on": ["upper", "lower"], "velocity": [0.4, 0.1]}],
    ),
}
NO_REFERENCE = {"surfaces": {}, "blocks": {}, "system": {}, "scales": {"energy": 0.5}}


class Check(NamedTuple):
    """Scenes, and how they are run: twice, with a step and with half of it.

    The errors of the limit are within a tenth of the tolerance, relative to their scales.
    """

    scenes: tuple[str, ...]
    method: str
    step: float
    order: int
    tolerance: float


STAGES = Check(("slid", "pulled", "lattice", "open"), "midpoint", 0.05, 2, 1e-3)
SPLITTING = Check(("slid", "pulled", "lattice"), "kahan-li-6", 0.25, 6, 1e-5)
SPLITTING_OPEN = Check(("open",), "verlet", 0.05, 2, 1e-5)  # its identities are exact


# --- the mutations -------------------------------------------------------------------------------

# file: function: what is changed, found once in that function -> what it becomes
MUTATIONS = {
    "model/asperite.py": {
        "for_each": [
            'each["l1"] = length * m2 -> each["l1"] = length * m1',
            'each["l2"] = length * m1 -> each["l2"] = length * m2',
            'm1 * each["l1"] ** 2 -> m2 * each["l1"] ** 2',
            'm2 * each["l2"] ** 2 -> m1 * each["l2"] ** 2',
        ],
    },
    "run/layout.py": {
        "_fill_asperites": [
            "+ surface.facing_sign -> - surface.facing_sign",
            'each["l1"] -> each["l2"]',
            "surface.velocity[0] - first.velocity[0] -> first.velocity[0] - surface.velocity[0]",
            "surface.velocity[1] - first.velocity[1] -> first.velocity[1] - surface.velocity[1]",
        ],
        "_fill_surface": [
            "= -drive.load -> = drive.load",
            "drive.speed - surface.velocity[0] -> drive.speed + surface.velocity[0]",
        ],
        "_fields": ["velocity - drift -> velocity + drift"],
        "set_bath": [
            "-arm * np.sin(swing) -> arm * np.sin(swing)",
            "-arm * 2.0 -> arm * 2.0",
            "np.sin(swing) -> np.cos(swing)",
        ],
    },
    "model/fields.py": {
        "force_at": ["return -self -> return self", "np.sin -> np.cos"],
        "energy_at": ["return -self -> return self", "np.cos -> np.sin"],
    },
    "potentials/coulomb.py": {
        "force": ["self.strength / -> -self.strength /"],
        "energy": ["self.strength / -> -self.strength /"],
        "coupling": ["one * other -> one * one"],
    },
    "kernels/contact.py": {
        "separation": ["dx * dx + dy -> dx * dx - dy", "+ dz * dz -> - dz * dz"],
        "add_contact": [
            "image(a.x - b.x -> image(a.x + b.x",
            "a.y - b.y -> a.y + b.y",
            "a.z - b.z -> a.z + b.z",
            "fx += f * dx -> fx -= f * dx",
            "fy += f * dy -> fy -= f * dy",
            "push.fx += fx -> push.fx -= fx",
            "push.fy += fy -> push.fy -= fy",
            "push.fx -= -> push.fx +=",
            "push.fy -= -> push.fy +=",
            "a.charge, b.charge) / r -> a.charge, b.charge)",
        ],
        "force_within": ["inner[i].fx -> -inner[i].fx", "inner[i].fy -> -inner[i].fy"],
        "pair_energy": [
            "a.x - b.x -> a.x + b.x",
            "a.y - b.y -> a.y + b.y",
            "a.z - b.z -> a.z + b.z",
            "energy += -> energy -=",
        ],
    },
    "kernels/neighbours.py": {
        "may_meet": [
            "species[i] == kinds[0] -> species[i] != kinds[0]",
            "return kinds[1] -> return kinds[0]",
            "species[i] == kinds[1] else -2 -> species[i] == kinds[1] else -1",
        ],
        "is_met": ["species[j] == wanted -> species[j] != wanted"],
    },
    "kernels/equations_of_motion.py": {
        "bar_angle": ["+ asperite.nu -> - asperite.nu"],
        "bar_displacement": [
            "dof_x, q) - -> dof_x, q) +",
            "dof_y, q) - -> dof_y, q) +",
            "asperite.l2 * asperite.facing * math -> asperite.l1 * asperite.facing * math",
            "asperite.l2 * asperite.facing * 2.0 -> asperite.l1 * asperite.facing * 2.0",
            "math.sin(swing) -> math.cos(swing)",
            "math.sin(0.5 * swing) -> math.cos(0.5 * swing)",
        ],
        "place_bob": [
            "math.cos -> math.sin",
            "math.sin -> math.cos",
            "a.facing * math.cos -> math.cos",
            "a.facing * math.sin -> math.sin",
            "a.x + a.vx -> a.x - a.vx",
            "a.y + a.vy -> a.y - a.vy",
            "+ displacement(a.dof_x -> - displacement(a.dof_x",
            "+ displacement(a.dof_y -> - displacement(a.dof_y",
            "+ a.l1 * b.ty -> - a.l1 * b.ty",
            "- a.l1 * b.tx -> + a.l1 * b.tx",
            "a.l1 * b.ty -> a.l2 * b.ty",
            "a.l1 * b.tx -> a.l2 * b.tx",
        ],
        "field_forces": ["ex += fx -> ex -= fx"],
        "field_energy": ["energy += -> energy -="],
        "stretch": ["xi - xj -> xi + xj", "yi - yj -> yi + yj"],
        "spring_forces": [
            "one.hx -= -> one.hx +=",
            "one.hy -= -> one.hy +=",
            "other.hx += -> other.hx -=",
            "other.hy += -> other.hy -=",
        ],
        "bath_forces": [
            "hx += -> hx -=",
            "hy += -> hy -=",
            "+ n] - x -> + n] + x",
            "+ n] - y -> + n] + y",
        ],
        "gather_contact": ["s.fx += -> s.fx -="],
        "drive_bar": [
            "gx = -b.fx -> gx = b.fx",
            "s.fx - b.fx -> s.fx + b.fx",
            "a.mass / s.mass -> a.mass / a.mass",
            "s.speed * t - -> -s.speed * t -",
            "- displacement -> + displacement",
            "+ a.l2 * b.ty -> - a.l2 * b.ty",
            "a.l2 * b.ty -> a.l1 * b.ty",
            "gx = s.stiffness -> gx = -s.stiffness",
            "= s.load -> = -s.load",
            "else -b.fy -> else b.fy",
        ],
        "friction_forces": [
            "lx = -s.gamma -> lx = s.gamma",
            "ly = -s.gamma -> ly = s.gamma",
        ],
        "bar_forces": [
            "x += d.hx -> x -= d.hx",
            "y += d.hy -> y -= d.hy",
            "x += d.lx -> x -= d.lx",
            "y += d.ly -> y -= d.ly",
        ],
        "bob_forces": ["x += b.fx -> x -= b.fx", "x += model -> x -= model"],
        "accelerate": [
            "spring = torsion -> spring = -torsion",
            "q[i] - bar_angle -> q[i] + bar_angle",
            "(b.tx * bob_x + -> (b.tx * bob_x -",
            "(b.tx * bar_x + -> (b.tx * bar_x -",
            "- a.l2 -> + a.l2",
            "torque = a.l1 -> torque = -a.l1",
            "a.l1 -> a.l2",
            "a.l2 -> a.l1",
            "torque - spring -> torque + spring",
            "= spring / a.i2 -> = -spring / a.i2",
            "spring / a.i2 -> spring / a.inertia",
            "bob_x + bar_x) -> bob_x - bar_x)",
            "bob_y + bar_y) -> bob_y - bar_y)",
        ],
        "bath_accelerations": [
            "= -square * (q[kx] -> = square * (q[kx]",
            "= -square * (q[ky] -> = square * (q[ky]",
            "q[kx] - x -> q[kx] + x",
            "q[ky] - y -> q[ky] + y",
        ],
    },
    "kernels/powers.py": {
        "at_bar": [
            "= fx\n -> = -fx\n",
            "= fy\n -> = -fy\n",
            "= -a.l2 -> = a.l2",
            "a.l2 -> a.l1",
            "b.tx * fx + b.ty -> b.tx * fx - b.ty",
            "b.tx * fx + b.ty * fy -> b.ty * fx + b.tx * fy",
            "fx * vx + fy -> fx * vx - fy",
        ],
        "book_bob": [
            "+= fx\n -> -= fx\n",
            "+= fy\n -> -= fy\n",
            "a.l1 -> a.l2",
            "b.tx * fx + -> b.tx * fx -",
            "fx * vx + -> fx * vx -",
        ],
        "clamped_ends": [
            "end = a.kappa -> end = -a.kappa",
            "q[i] - phi -> q[i] + phi",
            "-end * math.sin -> end * math.sin",
            "end * math.cos -> -end * math.cos",
            "math.sin -> math.cos",
            "math.cos -> math.sin",
            "-a.l2 -> a.l2",
            "a.l2 -> a.l1",
            "end_x * b.tx + -> end_x * b.tx -",
            "-0.5 * a.bar_length -> 0.5 * a.bar_length",
            "= with_bar + -> = with_bar -",
            "-with_bar + -> with_bar +",
            "-with_bar + turning -> -with_bar - turning",
            "= end_x\n -> = -end_x\n",
            "= end_y\n -> = -end_y\n",
            "end_x * vx + -> end_x * vx -",
        ],
        "powers_of": [
            "power[k] = b.fx -> power[k] = -b.fx",
            "power[k + 1] = b.fy -> power[k + 1] = -b.fy",
            "b.fx * omega -> -b.fx * omega",
            "b.fy * omega -> -b.fy * omega",
            "b.fx * omega * b.tx -> b.fx * omega * b.ty",
            "b.fy * omega * b.ty -> b.fy * omega * b.tx",
            "b.fx * vx -> -b.fx * vx",
            "b.fy * vy -> -b.fy * vy",
            "= d.gx\n -> = -d.gx\n",
            "= d.gy\n -> = -d.gy\n",
            "b.tx * d.gx + -> b.tx * d.gx -",
            "d.gx * vx + -> d.gx * vx -",
            "= d.ex\n -> = -d.ex\n",
            "a.l1 * omega -> a.l2 * omega",
            "(b.tx * d.ex -> (-b.tx * d.ex",
            "d.ex * vx -> -d.ex * vx",
        ],
        "field_powers": [
            "field.origin[0] + -> field.origin[0] -",
            "+= fx -> -= fx",
        ],
        "bath_momentum": ["px += -> px -=", "py += -> py -="],
        "momentum": ["px += -> px -=", "py += -> py -="],
        "external_force": [
            "b.fx + d.gx -> b.fx - d.gx",
            "b.fy + d.gy -> b.fy - d.gy",
            "+= d.ex -> -= d.ex",
            "+= d.lx -> -= d.lx",
            "+= d.ly -> -= d.ly",
        ],
        "block_powers": ["* px + -> * px -", "s.total_mass -> s.mass"],
    },
    "kernels/samples.py": {
        "energies_within": ["+= pair -> -= pair"],
        "spring_energies": ["+= 0.5 -> -= 0.5", "x * x + -> x * x -"],
        "bath_energies": [
            "+= 0.5 -> -= 0.5",
            "v[kx] ** 2 + -> v[kx] ** 2 -",
            "square += -> square -=",
            "q[kx] - x -> q[kx] + x",
            "q[ky] - y -> q[ky] + y",
        ],
    },
    "integrators/splitting.py": {
        "rotated": [
            "x - versine -> x + versine",
            "+ sin / frequency -> - sin / frequency",
            "rate - versine -> rate + versine",
            "- sin * frequency -> + sin * frequency",
        ],
        "arc_work": ["- twist -> + twist", "math.cos -> math.sin"],
        "add_end_works": [
            "arc_work(new) - -> arc_work(new) +",
            "*= -a.l2 -> *= a.l2",
            "a.l2 -> a.l1",
            "* a.facing -> / 1.0",
            "rate - new_rate -> rate + new_rate",
            "-impulse -> impulse",
            "= impulse * math.cos -> = -impulse * math.cos",
            "s[k] += -> s[k] -=",
            "s[k + 1] -= -> s[k + 1] +=",
            "end_x * vx + -> end_x * vx -",
        ],
        "add_rotating_end_works": [
            "= -pull * now * math.sin -> = pull * now * math.sin",
            "= pull * now * math.cos -> = -pull * now * math.cos",
            "= -a.l2 -> = a.l2",
            "a.l2 -> a.l1",
            "now_rate + a.nu -> now_rate - a.nu",
            "* a.facing -> / 1.0",
            "math.sin(now) -> math.cos(now)",
            "s[k] += -> s[k] -=",
            "s[k + 1] -= -> s[k + 1] +=",
            "end_x * vx + -> end_x * vx -",
        ],
        "drift_clamped": [
            "q[i] - (a.phi -> q[i] + (a.phi",
            "v[i] - a.nu -> v[i] + a.nu",
            "rate - new_rate -> rate + new_rate",
            "s[a.acc_ends] -= -> s[a.acc_ends] +=",
            "s[a.acc_ends + 1] -= -> s[a.acc_ends + 1] +=",
            "(new - twist) + -> (new - twist) -",
            "v[i] += -> v[i] -=",
        ],
        "drift_free": [
            "q[i] - q[j] -> q[i] + q[j]",
            "v[i] - v[j] -> v[i] + v[j]",
            "1.0 / a.inertia + -> 0.0 +",
            "share = a.i2 -> share = a.inertia",
            "a.inertia * v[i] + -> a.inertia * v[i] -",
            "tau + share -> tau - share",
            "tau - (1.0 -> tau + (1.0",
            "v[i] += -> v[i] -=",
            "v[j] -= -> v[j] +=",
        ],
        "drift": ["q[a.dof_x] += -> q[a.dof_x] -=", "q[a.dof_y] += -> q[a.dof_y] -="],
        "apply_kick": ["v[slot] + 0.5 -> v[slot] - 0.5", "v[slot] += -> v[slot] -="],
        "accumulate": ["s[m] += -> s[m] -="],
    },
    "integrators/bath_substep.py": {
        "push_bar": [
            "b.tx * px + -> b.tx * px -",
            "v[i] -= -> v[i] +=",
            "v[a.dof_x] += -> v[a.dof_x] -=",
            "v[a.dof_y] += -> v[a.dof_y] -=",
            "s[k] += -> s[k] -=",
            "s[k + 1] += -> s[k + 1] -=",
            "s[k + 2] -= -> s[k + 2] +=",
            "px * 0.5 -> px * 0.6",
            "(vx + v[a.dof_x]) + -> (vx + v[a.dof_x]) -",
        ],
        "rotate_oscillators": [
            "q[k] - centre -> q[k] + centre",
            "-versine * rate - -> versine * rate -",
            "rate - sin -> rate + sin",
            "rate - versine * x -> rate + versine * x",
            "v[k] += -> v[k] -=",
            "gained += -> gained -=",
        ],
        "thermal_kick": ["kept - 1.0 -> 1.0 - kept"],
        "thermalise": [
            "after_x - before_x -> after_x + before_x",
            "before_y + after_y -> before_y - after_y",
        ],
        "rotate_bath": ["-px, -py -> px, -py", "-px, -py -> -px, py"],
    },
    "run/ledger.py": {
        "pseudowork": ["self.pseudo + -> self.pseudo -", "self.jx + -> self.jx -"],
        "work": ["self.about + -> self.about -"],
        "_motion": ["a.phi + a.nu -> a.phi - a.nu"],
        "_places": [
            "velocity[0] * m.t + -> velocity[0] * m.t -",
            "velocity[1] * m.t + -> velocity[1] * m.t -",
            "a.x + -> a.x -",
            "a.y + -> a.y -",
            "m.swing + rest -> m.swing - rest",
            "np.sin(m -> np.cos(m",
            "np.cos(m -> np.sin(m",
            "velocity[0] + m.vx -> velocity[0] - m.vx",
            "velocity[1] + m.vy -> velocity[1] - m.vy",
            "x + a.l1 -> x - a.l1",
            "y - a.l1 -> y + a.l1",
            "x - a.l2 -> x + a.l2",
            "y + a.l2 -> y - a.l2",
            "x + a.l1 -> x + a.l2",
            "y - a.l1 -> y - a.l2",
            "x - a.l2 -> x - a.l1",
            "y + a.l2 -> y + a.l1",
        ],
        "_accounts": [
            "Account(a.l1 -> Account(a.l2",
            "(about_x + -> (about_x -",
            "jx, jy, slide_x + -> jx, jy, slide_x -",
            "own, -a.l2 -> own, a.l2",
            "-a.l2 * column -> -a.l1 * column",
            "a.l2 * (held -> a.l1 * (held",
            "held * about_x + -> held * about_x -",
            "-held * jx -> held * jx",
            "-jy -> jy",
            "-(held * slide_x -> (held * slide_x",
            "held * slide_x + -> held * slide_x -",
            "left + user[0], end_x -> left + user[0], -end_x",
            "- end_x -> + end_x",
            "- end_y -> + end_y",
            "- end_pseudo -> + end_pseudo",
        ],
        "_energies": [
            "a.inertia * m.omega**2 + -> a.inertia * m.omega**2 -",
            "a.i2 * m.nu**2 + -> a.i2 * m.nu**2 -",
            "m.swing - m.phi -> m.swing + m.phi",
            "* m.vx + -> * m.vx -",
            "* m.vy + -> * m.vy -",
            "m.vx**2 + -> m.vx**2 -",
            "internal - internal[0] -> internal + internal[0]",
        ],
        "_sums": [
            "0.5 * (m.vx**2 + -> 0.5 * (m.vx**2 -",
            "px=m.vx @ -> px=-m.vx @",
            "py=m.vy @ -> py=-m.vy @",
            "e.about + -> e.about -",
            "(e.jx for -> (-e.jx for",
            "(e.jy for -> (-e.jy for",
            '"w2" -> "w1"',
            '"wL" -> "wR"',
            '"wR" -> "wL"',
            '"w_T") -> "w_int")',
        ],
        "_block": [
            "sums.px + -> sums.px -",
            "(lag_x**2 + -> (lag_x**2 -",
            "* lag_x + -> * lag_x -",
            "* lag_y) + bulk -> * lag_y) - bulk",
            "sums.moving + -> sums.moving -",
            "sums.internal - bulk -> sums.internal + bulk",
            "within + stored -> within - stored",
            "SPRINGS, BATH -> SPRINGS",
            "WITHIN) -> BATH)",
            "* sums.jx + -> * sums.jx -",
            "sums.work + boost -> sums.work - boost",
            "pseudowork + boost -> pseudowork - boost",
        ],
        "_system": [
            'block["delta_K"] + -> block["delta_K"] -',
            "samples.contact + -> samples.contact -",
            "stored + change -> stored - change",
            "applied = outside -> applied = -outside",
            "applied + -> applied -",
        ],
    },
}


class Mutation(NamedTuple):
    """One change of the package's source."""

    file: str
    function: str
    old: str
    new: str

    def __str__(self):
        return f"{self.function}: {self.old.strip()} -> {self.new.strip()}"

    def mutant(self):
        """The source of the file with this change; fails if what it changes is there no more."""
        source = (SOURCE / self.file).read_text(encoding="utf-8")
        nodes = [n for n in ast.walk(ast.parse(source)) if isinstance(n, ast.FunctionDef)]
        spans = [(n.lineno - 1, n.end_lineno) for n in nodes if n.name == self.function]
        assert len(spans) == 1, f"{self.file} has {len(spans)} functions {self.function}"
        lines = source.splitlines(keepends=True)
        start, stop = spans[0]
        body = "".join(lines[start:stop])
        count = body.count(self.old)
        assert count == 1, f"{self.file}, {self.function}: {self.old!r} is there {count} times"
        return "".join([*lines[:start], body.replace(self.old, self.new), *lines[stop:]])


ALL = [
    Mutation(file, function, *change.split(" -> "))
    for file, functions in MUTATIONS.items()
    for function, changes in functions.items()
    for change in changes
]


# --- what catches a mutant -----------------------------------------------------------------------


def forget():
    """Forget every imported module of the package."""
    for name in [n for n in sys.modules if n.partition(".")[0] == "tribo"]:
        del sys.modules[name]
    importlib.invalidate_caches()


def extrapolated(coarse, fine, order):
    """The limit of runs with two steps, table by table, at the end."""
    weight = 1.0 / (2**order - 1)
    for (surface, one), (_, other) in zip(tables(coarse), tables(fine), strict=True):
        place = surface.name if surface else "system"
        yield place, {q: other[q][-1] + weight * (other[q][-1] - one[q][-1]) for q in other}


def message(scene, check, reference):
    """What is wrong with the end of a run, by the ledger's own laws or by the reference."""
    scene = importlib.import_module("tribo.model.scene_file").scene_from(scene)
    simulate = importlib.import_module("tribo.simulation").simulate
    steps = (check.step, 0.5 * check.step)
    runs = [simulate(scene, method=check.method, step=step) for step in steps]
    stopped = [run.status for run in runs if run.status != "completed"]
    if stopped:
        return f"the reference completes, not {stopped[0]}"
    tolerance = {name: check.tolerance * scale for name, scale in reference["scales"].items()}
    for place, table in extrapolated(*runs, check.order):
        for law, _, one, other in identities([table]):
            if not np.all(np.abs(one - other) <= tolerance["energy"]):
                return f"{place}: {law}"
        if np.any(table.get("heat", 0.0) < 0.0):
            return f"{place}: heat flows from a reservoir at temperature 0"
        known = reference["surfaces"] if "theta" in table else reference["blocks"]
        for name, values in (known | {"system": reference["system"]}).get(place, {}).items():
            if not np.all(np.abs(table[name] - values) <= tolerance[kind(name)]):
                return f"{place}: {name} differs from the reference"
    return ""


def verdict(folder, checks, references):
    """The first complaint about the package in a folder; empty if there is none.

    Runs in a process where nothing is compiled.
    """
    sys.path.insert(0, str(folder))
    forget()
    try:
        assert Path(importlib.import_module("tribo").__file__).parent.parent == folder
        for check in checks:
            for name in check.scenes:
                found = message(SCENES[name], check, references[name])
                if found:
                    return f"{name}, {check.method}: {found}"
        return ""
    finally:
        sys.path.remove(str(folder))
        forget()


def uncompiled():
    """Make ready a process in which kernels are plain Python."""
    os.environ["NUMBA_DISABLE_JIT"] = "1"
    sys.dont_write_bytecode = True
    warnings.simplefilter("ignore")


@pytest.fixture(scope="module")
def judge(tmp_path_factory):
    """A function that has the package judged, with one file's source replaced."""
    references = {name: reference.solve(SCENES[name]) for name in SPLITTING.scenes}
    references["open"] = NO_REFERENCE
    folder = tmp_path_factory.mktemp("mutant")
    context = multiprocessing.get_context("spawn")

    def judged(file=None, source=None):
        package = folder / "tribo"
        shutil.rmtree(package, ignore_errors=True)
        shutil.copytree(SOURCE, package, ignore=shutil.ignore_patterns("*.nbi", "*.nbc"))
        if file is not None:
            (package / file).write_text(source, encoding="utf-8")
        checks = [SPLITTING, SPLITTING_OPEN]
        if file not in ("integrators/splitting.py", "integrators/bath_substep.py"):
            checks.insert(0, STAGES)
        return pool.submit(verdict, folder, checks, references).result(timeout=120)

    with ProcessPoolExecutor(1, mp_context=context, initializer=uncompiled) as pool:
        yield judged


def test_the_package_itself_passes(judge):
    """No law is broken by the equations as they are."""
    assert judge() == ""


@pytest.mark.parametrize("mutation", ALL, ids=str)
def test_mutant_is_caught(judge, mutation):
    """Every mutant breaks a law of the ledger or departs from the reference."""
    assert judge(mutation.file, mutation.mutant()) != ""
