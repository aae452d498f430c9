"""Random scenes whose effects are combined: few structures, any numbers.

    scene = drawn(seed)             # scene.table, a table as of a scene file; scene.structure

A structure fixes what a time loop is compiled for: the classes of potentials and plug-ins, the
effects and the method.  Numbers, drives, starts and numbers of asperites are drawn.
"""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from support import draws
from support.mixed.potentials import PLUGINS

Table = dict[str, Any]


class Draw(draws.Draw):
    """Random numbers with four digits, so that scripts that repeat a case stay short."""

    def between(self, low: float, high: float) -> float:
        """A number from low to high."""
        return float(f"{super().between(low, high):.4g}")

    def each(self, low: float, high: float, n: int) -> list[float]:
        """Several such numbers."""
        return [self.between(low, high) for _ in range(n)]


@dataclass(frozen=True)
class Structure:
    """What scenes of one kind share.

    Attributes
    ----------
    potentials : callable
        From a Draw to the tables of interactions.
    method : str
    asperites : int
        The largest number on a surface.
    effects : tuple of str
        Of "springs", "bath", "turning", "damped bars", "damped swings", "rigid", "driven bars",
        "lower bars", "custom", "corrugation", "trap", "periodic".
    """

    potentials: Callable[[Draw], list[Table]]
    method: str = "verlet"
    asperites: int = 2
    effects: tuple[str, ...] = ()


def _coulomb(draw: Draw) -> Table:
    return {"potential": "coulomb", "strength": draw.between(0.05, 0.3)}


def _jones(draw: Draw) -> Table:
    return {
        "potential": "lennard-jones",
        "epsilon": draw.between(0.03, 0.15),
        "sigma": draw.between(0.5, 0.8),
    }


def _morse(draw: Draw) -> Table:
    shape = {"alpha": draw.between(1.0, 1.8), "r0": draw.between(0.6, 1.0)}
    return {"potential": "morse", "D": draw.between(0.1, 0.4)} | shape


def _ions(draw: Draw) -> list[Table]:
    repulsion = {"potential": "born-mayer", "A": draw.between(2.0, 8.0), "rho": 0.3}
    return [{"potential": "sum", "of": [repulsion, _coulomb(draw)]}]


def _scaled_bond(draw: Draw) -> list[Table]:
    bond = {"potential": "scaled", "factor": draw.between(0.5, 1.5), "of": _morse(draw)}
    cutoff = draw.between(1.6, 2.4)
    bond |= {"cutoff": cutoff, "switch_from": cutoff * draw.between(0.5, 0.9)}
    return [bond | {"between": ["upper", "lower"]}, _coulomb(draw) | {"between": ["upper"] * 2}]


def _shifted_jones(draw: Draw) -> list[Table]:
    return [_jones(draw) | {"cutoff": draw.between(1.5, 2.0), "at_cutoff": "force-shift"}]


def _own_class(draw: Draw) -> list[Table]:
    cap = {"potential": f"{PLUGINS}Cap", "A": draw.between(0.3, 1.2), "d": draw.between(1.0, 1.6)}
    cut = {"cutoff": cap["d"] * draw.pick(0.8, 1.3), "at_cutoff": "shift"}
    dimple = {"potential": f"{PLUGINS}Dimple", "depth": draw.between(0.05, 0.3), "width": 0.7}
    return [{"potential": "sum", "of": [cap | cut, dimple]}]


def _table(draw: Draw) -> list[Table]:
    """Points of a function that diverges; some tables begin deep in its core."""
    reach = draw.between(2.0, 3.0)
    first = draw.pick(0.05, 0.2, 0.4)
    r = np.geomspace(first, reach, draw.pick(400, 800))
    depth = draw.between(0.05, 0.15)
    size = draw.between(0.5, 0.7)
    energy = depth * ((size / r) ** 12 - 2.0 * (size / r) ** 6)
    energy -= energy[-1] * draw.pick(0.0, 1.0)
    table = {"potential": "table", "r": r.tolist(), "energy": energy.tolist()}
    hill = {"potential": "gaussian", "height": draw.between(0.05, 0.2), "width": 0.5}
    return [{"potential": "sum", "of": [table, {"potential": "scaled", "factor": 0.5, "of": hill}]}]


def _expression(draw: Draw) -> list[Table]:
    text = "height*exp(-(r/w)**2) - c/(1 + r**4)"
    numbers = {"height": draw.between(0.2, 0.8), "w": draw.between(0.4, 0.8), "c": 0.1}
    cut = {"cutoff": draw.between(1.5, 2.5), "at_cutoff": "shift"}
    return [{"potential": text} | numbers | cut]


def _screened(draw: Draw) -> list[Table]:
    yukawa = {"potential": "yukawa", "strength": draw.between(0.1, 0.5), "screening": 1.1}
    dimple = {"potential": f"{PLUGINS}Dimple", "depth": draw.between(0.05, 0.2), "width": 0.8}
    return [{"potential": "sum", "of": [yukawa, dimple]}]


def _cores(draw: Draw) -> list[Table]:
    core = {"potential": "weeks-chandler-andersen", "epsilon": draw.between(0.05, 0.2)}
    core["sigma"] = draw.between(0.7, 0.9)
    soft = {"potential": "plummer", "strength": draw.between(-0.2, 0.2), "softening": 0.5}
    return [core | {"between": ["upper", "lower"]}, soft | {"between": ["upper", "upper"]}]


def _species(draw: Draw) -> list[Table]:
    pair = {"between": ["upper", "lower"]}
    one = _morse(draw) | {"species": ["a", "b"]} | pair
    other = {"potential": "hertz", "A": draw.between(0.5, 2.0), "d": draw.between(1.0, 1.5)}
    return [one, other | {"species": ["a", "a"]} | pair]


STRUCTURES = {
    "pair": Structure(lambda draw: [_coulomb(draw)], "rkn8", asperites=1),
    "ions": Structure(_ions, "rkn8"),
    "jones": Structure(lambda draw: [_jones(draw)], "rkn8", effects=("corrugation", "lower bars")),
    "bonds": Structure(_scaled_bond, effects=("springs",)),
    "box": Structure(
        _shifted_jones, effects=("periodic", "corrugation", "damped bars", "lower bars")
    ),
    "trap": Structure(_own_class, effects=("trap", "springs")),
    "table": Structure(_table, effects=("turning", "bath")),
    "bars": Structure(_expression, "dop853", effects=("driven bars", "damped swings")),
    "custom": Structure(_screened, "dop853", effects=("custom",)),
    "tips": Structure(lambda draw: [], effects=("rigid", "corrugation", "damped bars")),
    "cores": Structure(_cores, effects=("damped bars", "lower bars")),
    "species": Structure(_species, "dop853"),
}


@dataclass
class Scene:
    """A drawn scene."""

    seed: int
    name: str
    structure: Structure
    table: Table

    def copy(self) -> Table:
        """A table that may be changed."""
        return copy.deepcopy(self.table)


def drawn(seed: int, name: str) -> Scene:
    """The scene of a seed, with a structure."""
    structure = STRUCTURES[name]
    draw = Draw(seed, 1)
    effects = structure.effects
    alone = name == "tips"
    names = ["upper"] if alone else ["upper", "lower"]
    interactions = structure.potentials(draw)
    surfaces = [_surface(draw, structure, each) for each in names]
    speed = draw.between(0.3, 0.8)
    duration = draw.between(2.5, 5.0)
    surfaces[0]["bob"] = [-draw.between(0.3, 0.9) * speed * duration, draw.between(0.7, 1.1)]
    surfaces[0]["velocity"] = [speed, 0.0]
    if not alone:
        surfaces[1]["bob"] = [0.0, 0.0]
        surfaces[1]["velocity"] = [draw.pick(0.0, 0.0, -0.2), 0.0]
    table: Table = {"duration": duration, "surface": surfaces, "interaction": interactions}
    table["output"] = {"samples": draw.pick(5, 9, 17)}
    if draw.chance(0.3):
        table["output"]["series"] = ["forces"]
    if "bath" in effects:
        table["output"]["series"] = ["forces", "oscillators"]
    if "corrugation" in effects:
        table["field"] = [_corrugation(draw, ["upper"])]
        if not alone and name == "box":
            table["field"].append(_corrugation(draw, names))
    if "trap" in effects:
        stiff = {"along": draw.between(0.3, 2.0), "across": draw.between(0.3, 2.0)}
        origin = {"origin": [draw.between(-1.0, 1.0), 1.0]}
        table["field"] = [{"kind": f"{PLUGINS}Trap", "on": ["upper"]} | stiff | origin]
        if draw.chance(0.5):
            table["field"][0]["velocity"] = [draw.between(-0.2, 0.2), 0.0]
    if "periodic" in effects:
        table["periodic"] = {"x": draw.between(4.2, 6.0)}
    return Scene(seed, name, structure, table)


def _corrugation(draw: Draw, on: list[str]) -> Table:
    wave = {"amplitude": draw.between(0.03, 0.2), "period": draw.between(0.9, 1.6)}
    table = {"kind": "corrugation", "on": on} | wave
    if draw.chance(0.5):
        table["velocity"] = [draw.between(-0.3, 0.3), 0.0]
    return table


def _surface(draw: Draw, structure: Structure, name: str) -> Table:
    """The table of a row with parameters, drive, springs, baths and start of the structure."""
    upper = name == "upper"
    effects = structure.effects
    n = structure.asperites if structure.asperites == 1 else draw.pick(1, 2, 2, 3)
    if structure.asperites > 1 and upper:
        n = max(n, 2)
    surface: Table = {"name": name, "facing": "down" if upper else "up", "shape": [n, 1]}
    surface["spacing"] = [draw.between(0.9, 1.4), 0.0]
    own = {"m1": (0.6, 2.0), "m2": (1.0, 3.0), "kappa": (0.8, 3.0), "length": (1.0, 2.0)}
    own |= {"charge": (0.5, 1.5), "i2": (2.0, 5.0), "bar_length": (1.5, 3.0)}
    surface["asperite"] = {
        key: draw.each(*limits, n) if draw.chance(0.4) else draw.between(*limits)
        for key, limits in own.items()
    }
    rigid = "rigid" in effects
    if rigid:
        surface["asperite"]["kappa"] = np.inf
    if n > 1 and draw.chance(0.5):
        surface["heights"] = draw.each(-0.08, 0.08, n)
    if "species" in str(structure.potentials):
        species = [draw.pick("a", "b") for _ in range(n)]
        if upper:  # which has several, and so both kinds
            species[:2] = draw.pick(["a", "b"], ["b", "a"])
        surface["species"] = species
    if "turning" in effects:
        surface["bars"] = "free"
    if "springs" in effects and n > 1:
        surface["springs"] = {"stiffness": draw.between(0.5, 3.0)}
    if "bath" in effects and upper:
        oscillators = [{"mass": draw.between(0.1, 0.4), "frequency": draw.between(1.0, 3.0)}]
        surface["bath"] = {"oscillators": oscillators}
    surface["drive"] = drive_of(draw, structure, upper)
    held = surface["drive"] == "bars"
    if "damped bars" in effects and not held:
        surface["langevin"] = {"gamma": draw.between(0.2, 1.5)}
        if draw.chance(0.5):
            surface["langevin"]["velocity"] = [draw.between(-0.3, 0.3), 0.0]
    if "damped swings" in effects:
        surface["langevin"] = {"gamma": draw.between(0.2, 1.0), "on": "swing"}
    if not rigid:
        surface["initial"] = _initial(draw, n, surface)
    return surface


def drive_of(draw: Draw, structure: Structure, upper: bool) -> Any:
    """A drive that the structure's loop takes."""
    effects = structure.effects
    if "driven bars" in effects or (not upper and "lower bars" in effects):
        return "bars"
    if "custom" in effects and upper:
        numbers = {"strength": draw.between(0.1, 0.8), "frequency": draw.between(0.5, 2.0)}
        return {"kind": f"{PLUGINS}Shaker", "damping": draw.between(0.1, 1.0)} | numbers
    kind = draw.pick("forced", "free", "rigid", "pulled", "pulled", "push")
    table: Table = {"kind": "free", "rigid": True} if kind == "rigid" else {"kind": kind}
    if kind == "pulled":
        table |= {"stiffness": draw.between(0.5, 3.0), "speed": draw.between(0.2, 0.8)}
    if kind == "push":
        table |= {"force": [draw.between(-0.2, 0.3), 0.0], "rate": [draw.between(0.02, 0.2), 0.0]}
    if draw.chance(0.4) and "corrugation" not in effects:
        table["load"] = draw.between(0.01, 0.1)
    return table


def _initial(draw: Draw, n: int, surface: Table) -> Table:
    """Angles and rates at the start, each in part of the scenes."""
    table: Table = {}
    if draw.chance(0.6):
        table[draw.pick("swing", "swing", "theta")] = draw.each(-0.3, 0.3, n)
        if "theta" in table and surface["facing"] == "up":
            table["theta"] = [np.pi + x for x in table["theta"]]
    if draw.chance(0.5):
        table["omega"] = draw.each(-0.3, 0.3, n)
    if draw.chance(0.4):
        table["phi"] = draw.between(-0.2, 0.2)
    if draw.chance(0.3):
        table["nu"] = draw.between(-0.2, 0.2)
    return table
