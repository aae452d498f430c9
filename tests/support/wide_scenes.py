"""Random scenes with parameters over twelve decades, as the tables of scene files."""

import numpy as np

from support import draws
from support.random_scenes import POTENTIALS
from support.scene_units import in_other_units

# Scenes that share their effects and potentials, and so the compiled time loops.
BLOCK = 50
# Probability that a parameter is drawn over twelve decades instead of one.
WILD = 0.06
# Seeds from here on have tiny or huge energies of interaction, and any stiffness of torsion.
SCALED = 1_000_000
# Parameters of potentials that are energies, or in proportion to one.
ENERGIES = ("strength", "D", "epsilon", "A", "C", "factor")
# Radians that the fastest pendulum, spring or oscillator turns in most runs.
LONGEST = 1500.0


class Draw(draws.Draw):
    """Random numbers: most within a decade of a usual value, some over twelve decades."""

    def around(self, usual: float) -> float:
        """A positive number: from a third to three times the usual, or six decades off."""
        decades = self.between(-6.0, 6.0) if self.chance(WILD) else self.between(-0.5, 0.5)
        return usual * 10.0**decades

    def signed(self, usual: float) -> float:
        """The same with either sign."""
        return self.around(usual) * self.pick(-1.0, 1.0)


def wide_potential(draw: Draw, kind: str) -> dict:
    """A potential whose usual range is 0.5 and whose usual energy is 0.3."""
    size = draw.around(0.5)
    energy = draw.around(0.3)
    table = {
        "coulomb": lambda: {"strength": draw.signed(0.2)},
        "morse": lambda: {"D": energy, "alpha": draw.around(1.5) / size, "r0": size},
        "lennard-jones": lambda: {"epsilon": energy, "sigma": size},
        "yukawa": lambda: {"strength": draw.signed(0.2), "screening": 1.0 / draw.around(0.5)},
        "buckingham": lambda: {"A": 30.0 * energy, "rho": 0.2 * size, "C": energy * 1e-4 * size**6},
        "born-mayer": lambda: {"A": 10.0 * energy, "rho": 0.3 * size},
        "weeks-chandler-andersen": lambda: {"epsilon": energy, "sigma": size},
        "mie": lambda: {
            "epsilon": energy,
            "sigma": size,
            "n": draw.between(8.0, 14.0),
            "m": draw.between(3.0, 7.0),
        },
        "plummer": lambda: {"strength": draw.signed(0.2), "softening": size},
    }
    if kind == "sum":
        parts = [wide_potential(draw, part) for part in ("born-mayer", "coulomb")]
        return {"potential": "sum", "of": parts}
    if kind == "scaled":
        return {
            "potential": "scaled",
            "factor": draw.signed(1.0),
            "of": wide_potential(draw, "morse"),
        }
    return {"potential": kind} | table[kind]()


def structure_of(block: int) -> dict:
    """What decides which time loop is compiled: the effects, the potentials and their cutoffs."""
    draw = Draw(block, 1)
    kinds = (*POTENTIALS, "yukawa", "buckingham", "born-mayer", "weeks-chandler-andersen")
    kinds += ("mie", "plummer", "sum", "scaled")
    alone = block % 2 == 0  # one asperite on one
    rows = {
        "within": draw.chance(0.25),
        "species": draw.chance(0.15),
        "periodic": draw.chance(0.25),
        "springs": draw.chance(0.5),
        "third": draw.chance(0.15),
    }
    if alone:
        rows = dict.fromkeys(rows, False)
    ends = draw.chance(0.35) or rows["periodic"]
    return rows | {
        "alone": alone,
        "kinds": [draw.pick(*kinds) for _ in range(1 + rows["within"] + rows["species"])],
        "cutoff": draw.pick("switch", "switch", "truncate", "shift", "force-shift") if ends else "",
        "bath": draw.pick("", "", "", "oscillators", "spectrum"),
        "torsional": draw.chance(0.15),
        "fields": draw.pick(0, 0, 1, 2),
        "langevin": draw.chance(0.2),
        "method": draw.pick("", "", "", "", "gauss-radau-15", "dop853", "rkn8", "verlet"),
    }


def wide_asperites(draw: Draw, count: int) -> dict:
    """Parameters of the asperites of a surface."""
    usual = {"m1": 1.0, "m2": 2.0, "kappa": 2.0, "length": 2.0, "bar_length": 3.0, "i2": 5.0}
    table: dict = {name: draw.around(value) for name, value in usual.items()}
    if draw.chance(0.1):
        table["kappa"] = 0.0
    if count > 1 and draw.chance(0.3):
        name = draw.pick(*usual)
        table[name] = [table[name] * draw.between(0.5, 2.0) for _ in range(count)]
    if draw.chance(0.5):
        table["charge"] = draw.signed(1.0)
    return table


def wide_drive(draw: Draw) -> object:
    """Any drive, with a load or without."""
    table: dict = {"kind": draw.pick("forced", "forced", "forced", "free", "free", "pulled")}
    if table["kind"] == "free":
        table["rigid"] = draw.chance(0.4)
    if table["kind"] == "pulled":
        table |= {"stiffness": draw.around(0.6), "speed": draw.signed(0.4)}
    if draw.chance(0.15):
        table["load"] = draw.signed(0.01)
    return table


def wide_start(draw: Draw) -> dict:
    """Angles and rates at the start."""
    start: dict = {}
    if draw.chance(0.7):
        start["swing"] = draw.signed(0.1)
    if draw.chance(0.3):
        start["omega"] = draw.signed(0.2)
    if draw.chance(0.2):
        start |= {"phi": draw.signed(0.1), "nu": draw.signed(0.05)}
    return start


def wide_surface(draw: Draw, structure: dict, name: str) -> dict:
    """A surface whose bobs are at y = 0; place and velocity are given later."""
    shape = [1, 1] if structure["alone"] else [draw.pick(1, 2, 3, 4), draw.pick(1, 1, 2)]
    count = shape[0] * shape[1]
    table: dict = {
        "name": name,
        "facing": "up" if name == "lower" else "down",
        "shape": shape,
        "spacing": [draw.around(1.2), draw.around(1.2)],
        "drive": wide_drive(draw),
        "bars": draw.pick("clamped", "clamped", "free"),
        "asperite": wide_asperites(draw, count),
        "initial": wide_start(draw),
    }
    if count > 1:
        table["heights"] = [draw.between(-0.1, 0.1) for _ in range(count)]
    if structure["springs"]:
        table["springs"] = {"stiffness": draw.around(1.0), "wrap": draw.chance(0.3)}
    if structure["torsional"]:
        table["bars"] = "free"
    wide_bath(draw, structure, table)
    if structure["langevin"]:
        table["langevin"] = {"gamma": draw.around(0.1), "velocity": [draw.signed(0.1), 0.0]}
    if structure["species"]:
        odd = name != "upper"  # so that both species are in every scene
        table["species"] = ["A" if i % 2 == odd else "B" for i in range(count)]
    return table


def wide_bath(draw: Draw, structure: dict, table: dict) -> None:
    """Oscillators, a discretised spectrum, torsional oscillators."""
    if structure["bath"] == "oscillators":
        listed = [
            {"mass": draw.around(0.2), "frequency": draw.around(1.0)}
            for _ in range(draw.pick(1, 2))
        ]
        table["bath"] = {"oscillators": listed}
    elif structure["bath"] == "spectrum":
        kind = {"spectrum": draw.pick("drude", "ohmic", "debye"), "n": draw.pick(2, 3, 5)}
        table["bath"] = kind | {"gamma": draw.around(0.2), "cutoff": draw.around(1.0)}
    if structure["torsional"]:
        listed = [{"inertia": draw.around(1.0), "frequency": draw.around(1.0)}]
        table["bath"] = table.get("bath", {}) | {"torsional": listed}


def fastest_turn(scene: dict) -> float:
    """About the largest angular frequency of pendulums, springs and oscillators, and spin."""
    fastest = 0.0
    for surface in scene["surface"]:
        a = {name: np.asarray(value, float) for name, value in surface["asperite"].items()}
        bath = surface.get("bath", {})
        start = surface["initial"]
        listed = bath.get("oscillators", [])
        torsional = bath.get("torsional", [])
        stiffness = 8.0 * surface.get("springs", {}).get("stiffness", 0.0)
        stiffness += surface["drive"].get("stiffness", 0.0)
        stiffness += sum(o["mass"] * o["frequency"] ** 2 for o in listed)
        stiffness += bath.get("gamma", 0.0) * bath.get("cutoff", 0.0)
        turning = sum(o["inertia"] * o["frequency"] ** 2 for o in torsional)
        if surface["bars"] == "free":
            turning = turning + a["kappa"]
        squares = a["kappa"] * (1.0 / a["m1"] + 1.0 / a["m2"]) / a["length"] ** 2
        squares = squares + stiffness / a["m2"] + turning / a["i2"]
        rates = [o["frequency"] for o in listed + torsional]
        rates += [6.0 * bath.get("n", 0) * bath.get("cutoff", 0.0)]
        rates += [surface.get("langevin", {}).get("gamma", 0.0) / float(np.min(a["m2"]))]
        rates += [abs(start.get("omega", 0.0)), abs(start.get("nu", 0.0))]
        fastest = max(fastest, float(np.sqrt(np.max(squares))), *rates)
    return fastest


def wide_interactions(draw: Draw, structure: dict) -> list[dict]:
    """The potentials of a scene, with cutoffs."""
    tables = [wide_potential(draw, kind) for kind in structure["kinds"]]
    if structure["cutoff"]:
        for table in tables:
            cutoff = draw.around(2.0)
            table |= {"cutoff": cutoff, "at_cutoff": structure["cutoff"]}
            if structure["cutoff"] == "switch" and draw.chance(0.5):
                table["switch_from"] = cutoff * draw.between(0.3, 0.95)
    if structure["species"]:
        tables[0]["species"] = ["A", "A"]
        tables[1]["species"] = ["A", "B"]
    if structure["within"]:
        tables[-1]["between"] = ["upper", "upper"]
    return tables


def scale_energies(draw: Draw, scene: dict) -> None:
    """Make the energies of interaction tiny or huge, and change all torsion springs alike."""
    decades = draw.between(-24.0, -6.0) if draw.chance(0.7) else draw.between(2.0, 8.0)
    for table in scene["interaction"]:
        for part in table["of"] if table["potential"] == "sum" else [table]:
            part |= {name: part[name] * 10.0**decades for name in ENERGIES if name in part}
    stiffer = 10.0 ** draw.pick(0.0, draw.between(-12.0, 3.0))
    for surface in scene["surface"]:
        own = surface["asperite"]
        own["kappa"] = (np.array(own["kappa"]) * stiffer).tolist()


def wide_fields(draw: Draw, structure: dict, names: list[str]) -> list[dict]:
    """Fields on one surface or on all, some of which move."""
    tables = []
    for _ in range(structure["fields"]):
        on = names if draw.chance(0.5) else [names[0]]
        table = {"on": on, "kind": "corrugation"}
        table |= {"amplitude": draw.signed(0.05), "period": draw.around(1.1)}
        if draw.chance(0.3):
            table |= {"velocity": [draw.signed(0.1), 0.0], "origin": [draw.signed(0.3), 0.0]}
        tables.append(table)
    return tables


def wide_scene(seed: int) -> dict:
    """Any scene: seeds of one block share a structure; every parameter spans twelve decades."""
    structure = structure_of(seed // BLOCK)
    draw = Draw(seed, 2)
    names = ["upper", "lower", "middle"] if structure["third"] else ["upper", "lower"]
    surfaces = [wide_surface(draw, structure, name) for name in names]
    scene: dict = {
        "surface": surfaces,
        "interaction": wide_interactions(draw, structure),
        "field": wide_fields(draw, structure, names),
        "output": {"samples": draw.pick(2, 9, 33, 129)},
        "numerics": {"accuracy": 10.0 ** draw.pick(-3, -4, -5, -6, -7, -8, -9, -10, -11)},
    }
    if structure["method"]:
        scene["numerics"]["method"] = structure["method"]
    if seed >= SCALED:
        scale_energies(Draw(seed, 3), scene)
    speed = draw.around(0.5)
    duration = draw.between(4.0, 15.0) / speed
    turn = fastest_turn(scene)
    if turn * duration > LONGEST and not draw.chance(0.05):
        duration = LONGEST / turn
    duration = min(duration, 10.0 * LONGEST)
    scene["duration"] = duration
    surfaces[0] |= {"velocity": [speed, draw.pick(0.0, 0.0, 0.02 * speed)]}
    surfaces[0]["bob"] = [-draw.between(0.2, 0.9) * speed * duration, draw.around(0.3)]
    surfaces[1] |= {"velocity": [draw.pick(0.0, 0.0, -0.2 * speed), 0.0], "bob": [0.0, 0.0]}
    for surface in surfaces[2:]:
        surface |= {"velocity": [0.0, 0.0], "bob": [draw.signed(2.0), draw.around(2.0)]}
    if structure["periodic"]:
        reach = max(table["cutoff"] for table in scene["interaction"])
        scene["periodic"] = {
            axis: 2.0 * reach * draw.between(1.0, 2.0) for axis in draw.pick("x", "xz", "z")
        }
    if draw.chance(0.1):
        shift = draw.signed(1e3)
        for surface in surfaces:
            surface["bob"][0] += shift
    if draw.chance(0.4):
        return in_other_units(scene, [10.0 ** draw.between(-6.0, 6.0) for _ in range(4)])
    return scene
