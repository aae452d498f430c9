"""Random scenes as the tables of scene files."""

import numpy as np

POTENTIALS = {
    "coulomb": {"potential": "coulomb", "strength": 0.2},
    "morse": {"potential": "morse", "D": 0.4, "alpha": 1.6, "r0": 0.7},
    "lennard-jones": {"potential": "lennard-jones", "epsilon": 0.3, "sigma": 0.45},
}


RANGES = {
    "m1": (0.5, 3.0),
    "m2": (0.5, 4.0),
    "kappa": (0.5, 3.0),
    "length": (1.0, 2.0),
    "bar_length": (1.0, 3.0),
    "i2": (2.0, 6.0),
    "charge": (-1.0, 1.5),
}


DRIVES = (
    "forced",
    "free",
    {"kind": "free", "rigid": True},
    {"kind": "pulled", "stiffness": 0.6, "speed": 0.4},
    {"kind": "forced", "load": 0.01},
    {"kind": "free", "rigid": True, "load": 0.01},
)


def pick(rng, options):
    """One of the options."""
    return options[rng.integers(len(options))]


def parameters(rng, count: int) -> dict:
    """Some parameters, each for all asperites or one for each."""
    table = {}
    for name, (low, high) in RANGES.items():
        kind = rng.integers(3)
        if kind:
            values = rng.uniform(low, high, count)
            table[name] = values.tolist() if kind == 1 else float(values[0])
    return table


def random_surface(rng, name: str, place: tuple[float, float], speed: float) -> dict:
    """A row of one to three asperites with any drive, bars and start."""
    count = int(rng.integers(1, 4))
    facing = "down" if name == "upper" else "up"
    rest = 0.0 if name == "upper" else np.pi
    bars = pick(rng, ("clamped", "clamped", "free"))
    initial = {"theta": (rest + rng.uniform(-0.3, 0.3, count)).tolist()}
    if rng.random() < 0.5:
        initial |= {"omega": float(rng.uniform(-0.3, 0.3)), "phi": float(rng.uniform(-0.2, 0.2))}
        initial |= {"nu": float(rng.uniform(-0.1, 0.1))}
    return {
        "name": name,
        "facing": facing,
        "bob": list(place),
        "velocity": [speed, float(pick(rng, (0.0, 0.02)))],
        "shape": [count, 1],
        "spacing": [float(rng.uniform(0.8, 1.5)), 0.0],
        "heights": rng.uniform(-0.1, 0.1, count).tolist(),
        "drive": pick(rng, DRIVES),
        "bars": bars,
        "asperite": parameters(rng, count),
        "initial": initial,
    }


def random_scene(seed: int, potential: str) -> dict:
    """Two surfaces that meet."""
    rng = np.random.default_rng(seed)
    gap = float(rng.uniform(0.5, 0.8))
    return {
        "duration": 9.0,
        "interaction": dict(POTENTIALS[potential]),
        "surface": [
            random_surface(rng, "upper", (-2.5, gap), float(rng.uniform(0.3, 0.8))),
            random_surface(rng, "lower", (0.0, 0.0), float(pick(rng, (0.0, -0.1)))),
        ],
        "output": {"samples": 3},
    }


def rich_scene(seed: int) -> dict:
    """Grids with springs, baths, a field, a cutoff and a period, all at once."""
    rng = np.random.default_rng(seed)
    scene = random_scene(seed, "morse")
    scene["interaction"] |= {"cutoff": 2.6, "at_cutoff": "switch"}
    scene["periodic"] = {"x": 8.0, "z": 6.0}
    scene["field"] = [{"on": ["upper"], "kind": "corrugation", "amplitude": 0.05, "period": 1.1}]
    for surface in scene["surface"]:
        count = surface["shape"][0]
        surface["shape"] = [count, 2]
        surface["spacing"][1] = 0.9
        for table in (surface["asperite"], surface["initial"]):
            table |= {k: v * 2 for k, v in table.items() if isinstance(v, list)}
        surface["heights"] = surface["heights"] * 2
        surface["springs"] = {"stiffness": float(rng.uniform(0.5, 4.0)), "wrap": seed % 2 == 0}
        surface["bath"] = {
            "oscillators": [
                {"mass": float(rng.uniform(0.05, 0.3)), "frequency": float(rng.uniform(0.5, 4.0))}
                for _ in range(2)
            ]
        }
    return scene


def driven(surface: dict, damping: float = 0.0) -> dict:
    """The surface on driven bars, its swings damped."""
    reservoir = {"langevin": {"gamma": damping, "on": "swing"}} if damping else {}
    return surface | {"drive": "bars"} | reservoir


def rigid(surface: dict, damping: float = 0.0) -> dict:
    """The surface with rigid asperites on clamped bars, which are damped."""
    start = {key: surface["initial"][key] for key in ("theta", "phi") if key in surface["initial"]}
    fixed = {"bars": "clamped", "initial": start}
    fixed["asperite"] = surface["asperite"] | {"kappa": np.inf}
    return surface | fixed | ({"langevin": {"gamma": damping}} if damping else {})


def constrained_scene(seed: int, damping: float = 0.0) -> dict:
    """A rich scene with driven bars above and rigid asperites below, or both in one surface."""
    scene = rich_scene(seed)
    upper, lower = scene["surface"]
    upper["initial"]["omega"] = 0.2
    lower["drive"] = DRIVES[seed % len(DRIVES)]
    scene["surface"] = [driven(upper, damping), rigid(lower, damping)]
    return scene


# --- scenes with parameters over twelve decades ---------------------------------------------------

# Scenes that share their effects and potentials, and so the compiled time loops.
BLOCK = 50
# Probability that a parameter is drawn over twelve decades instead of one.
WILD = 0.06
# Radians that the fastest pendulum, spring or oscillator turns in most runs.
LONGEST = 1500.0


class Draw:
    """Random numbers: most within a decade of a usual value, some over twelve decades."""

    def __init__(self, *seed: int) -> None:
        self.rng = np.random.default_rng(seed)

    def chance(self, probability: float) -> bool:
        """True with a probability."""
        return bool(self.rng.random() < probability)

    def between(self, low: float, high: float) -> float:
        """A number from low to high."""
        return float(self.rng.uniform(low, high))

    def pick(self, *options):
        """One of the options."""
        return options[self.rng.integers(len(options))]

    def around(self, usual: float) -> float:
        """A positive number: from a third to three times the usual, or six decades off."""
        decades = self.between(-6.0, 6.0) if self.chance(WILD) else self.between(-0.5, 0.5)
        return usual * 10.0**decades

    def signed(self, usual: float) -> float:
        """The same with either sign."""
        return self.around(usual) * self.pick(-1.0, 1.0)


def wide_potential(draw: Draw, kind: str) -> dict:
    """A potential whose usual range is 0.5 and whose usual energy is 0.3."""
    size, energy = draw.around(0.5), draw.around(0.3)
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
        bath, start = surface.get("bath", {}), surface["initial"]
        listed, torsional = bath.get("oscillators", []), bath.get("torsional", [])
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
        tables[0]["species"], tables[1]["species"] = ["A", "A"], ["A", "B"]
    if structure["within"]:
        tables[-1]["between"] = ["upper", "upper"]
    return tables


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
    structure, draw = structure_of(seed // BLOCK), Draw(seed, 2)
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
    return in_other_units(scene, draw) if draw.chance(0.4) else scene


# Powers of length, mass, time and charge of every key of a scene that has a unit.
UNITS_OF = {
    "duration": (0, 0, 1, 0),
    "bob": (1, 0, 0, 0),
    "spacing": (1, 0, 0, 0),
    "heights": (1, 0, 0, 0),
    "velocity": (1, 0, -1, 0),
    "speed": (1, 0, -1, 0),
    "origin": (1, 0, 0, 0),
    "m1": (0, 1, 0, 0),
    "m2": (0, 1, 0, 0),
    "mass": (0, 1, 0, 0),
    "kappa": (2, 1, -2, 0),
    "length": (1, 0, 0, 0),
    "bar_length": (1, 0, 0, 0),
    "i2": (2, 1, 0, 0),
    "inertia": (2, 1, 0, 0),
    "charge": (0, 0, 0, 1),
    "omega": (0, 0, -1, 0),
    "nu": (0, 0, -1, 0),
    "frequency": (0, 0, -1, 0),
    "stiffness": (0, 1, -2, 0),
    "load": (1, 1, -2, 0),
    "gamma": (0, 1, -1, 0),
    "D": (2, 1, -2, 0),
    "epsilon": (2, 1, -2, 0),
    "A": (2, 1, -2, 0),
    "amplitude": (2, 1, -2, 0),
    "C": (8, 1, -2, 0),
    "strength": (3, 1, -2, -2),
    "alpha": (-1, 0, 0, 0),
    "screening": (-1, 0, 0, 0),
    "period": (1, 0, 0, 0),
    "x": (1, 0, 0, 0),
    "z": (1, 0, 0, 0),
    "switch_from": (1, 0, 0, 0),
    "r0": (1, 0, 0, 0),
    "sigma": (1, 0, 0, 0),
    "softening": (1, 0, 0, 0),
    "rho": (1, 0, 0, 0),
}


def in_other_units(scene: dict, draw: Draw) -> dict:
    """The same scene in other units of length, mass, time and charge, by factors of up to 1e6."""
    units = [10.0 ** draw.between(-6.0, 6.0) for _ in range(4)]

    def rescaled(key: str, value, bath: bool):
        if isinstance(value, dict):
            return {k: rescaled(k, v, bath or key == "bath") for k, v in value.items()}
        if isinstance(value, list):
            return [rescaled(key, item, bath) for item in value]
        powers = UNITS_OF.get(key, (0, 0, 0, 0))
        if key == "cutoff":  # of a potential a length, of a spectrum a frequency
            powers = (0, 0, -1, 0) if bath else (1, 0, 0, 0)
        if isinstance(value, str) or not any(powers):
            return value
        return value * float(np.prod([unit**p for unit, p in zip(units, powers, strict=True)]))

    return {key: rescaled(key, value, False) for key, value in scene.items()}
