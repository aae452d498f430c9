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
