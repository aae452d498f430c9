"""Short scenes that between them reach every equation, as tables of scene files."""

import math

from support.random_scenes import POTENTIALS

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
SWINGING = {"theta": [0.5, -0.3], "omega": [0.6, -0.5]}
CORRUGATION = {"kind": "corrugation", "amplitude": 0.3, "period": 1.7}


def scene(upper, lower, **others):
    """Two surfaces, changed as given."""
    surfaces = [UPPER | upper, LOWER | lower]
    return {
        "duration": 1.0,
        "interaction": COULOMB,
        "surface": surfaces,
        "output": {"samples": 2},
        **others,
    }


def bath(*oscillators, **others):
    """Oscillators given by mass and frequency."""
    return {"oscillators": [{"mass": mass, "frequency": w} for mass, w in oscillators]} | others


# More oscillators than a vector register has lanes.
MANY = [(0.05, 0.4 * k) for k in range(1, 10)]

SPECIES = [
    COULOMB | {"between": ["upper", "lower"], "species": ["A", "B"]},
    COULOMB | {"between": ["lower", "upper"], "species": ["B", "B"], "strength": 0.3},
    COULOMB | {"between": ["upper", "upper"], "strength": 0.15},
]
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
        interaction=SPECIES,
    ),
    "lattice": scene(
        {"springs": {"stiffness": 1.5, "turned": 0.4}, "bath": bath((0.3, 1.5), (0.2, 2.5))},
        {"bath": bath(*MANY)} | TURNING,
        field=[CORRUGATION | {"on": ["upper", "lower"]}],
    ),
    "rows": scene(
        {
            "shape": [3, 2],
            "bob": [-0.6, 0.8],
            "spacing": [0.9, 0.7],
            "heights": [0.0, 0.05, -0.1, 0.1, -0.05, 0.02],
            "species": ["A", "A", "B", "A", "B", "A"],
            "asperite": {"kappa": 1.5},
            "initial": {"omega": 0.8},
            "springs": {"stiffness": 0.7, "wrap": True},
        },
        {
            "shape": [4, 1],
            "spacing": [0.8, 0.0],
            "bob": [-0.7, -0.1],
            "species": ["A", "B", "A", "A"],
            "drive": "free",
        },
        interaction=[
            POTENTIALS["lennard-jones"]
            | {
                "cutoff": 1.2,
                "switch_from": 0.6,
                "species": ["A", "B"],
                "between": ["upper", "lower"],
            },
            POTENTIALS["morse"]
            | {
                "cutoff": 1.3,
                "switch_from": 0.6,
                "species": ["A", "A"],
                "between": ["upper", "lower"],
            },
            POTENTIALS["morse"]
            | {
                "cutoff": 1.1,
                "switch_from": 0.5,
                "D": 0.1,
                "between": ["upper", "upper"],
                "species": ["A", "A"],
            },
        ],
        periodic={"x": 4.4, "z": 2.9},
        duration=0.6,
    ),
    # Without a solution by other means: the identities alone.
    "loaded": scene(
        {"drive": {"kind": "forced", "load": 0.3}}, {"drive": {"kind": "free", "load": -0.2}}
    ),
    "held": scene(
        {"drive": "bars"},
        {
            "drive": "free",
            "asperite": LOWER["asperite"] | {"kappa": math.inf},
            "initial": {"theta": 3.6, "phi": 0.2},
        },
    ),
    "open": scene(
        {"drive": "free", "langevin": {"gamma": 0.4, "velocity": [-0.5, -0.2]}},
        {"langevin": {"gamma": 0.3, "velocity": [-0.3, 1.0]}} | TURNING,
        field=[CORRUGATION | {"on": ["upper", "lower"], "velocity": [0.4, 0.1]}],
    ),
    "swinging": scene(
        {"drive": "free", "langevin": {"gamma": 0.4, "on": "swing"}}, {"bars": "free"}
    ),
    # Bars that are one rigid body, which moves, or which turns as well.
    "block": scene(
        {
            "drive": {"kind": "pulled", "stiffness": 1.2, "speed": 0.5, "load": 0.3, "block": True},
            "initial": SWINGING,
        },
        {"drive": "free"},
        duration=0.5,
    ),
    "tilting": scene(
        {
            "drive": {"kind": "free", "load": 0.3, "block": True, "tilt": "free"},
            "initial": SWINGING | {"nu": 0.3},
        },
        {"drive": "free"},
        duration=0.5,
    ),
    "damped twice": scene(
        {"drive": "free", "langevin": [{"gamma": 0.3}, {"gamma": 0.4, "on": "swing"}]},
        {"bars": "free"},
    ),
    "twisting": scene(
        {"bars": "free", "bath": bath((0.3, 1.5), torsional=[{"inertia": 0.4, "frequency": 1.1}])},
        {
            "bars": "free",
            "bath": {
                "torsional": [
                    {"inertia": 0.3, "frequency": 1.7},
                    {"inertia": 0.7, "frequency": 0.8},
                ]
            },
        }
        | TURNING,
    ),
}
# Every bath and reservoir at once: what methods do to them is compared.
SCENES["damped"] = SCENES["twisting"] | {
    "surface": [
        surface
        | {
            "drive": "free",
            "langevin": {"gamma": gamma, "velocity": [-0.4, 0.2]},
            "bath": surface["bath"] | {"temperature": 0.2},  # it has momentum at the start
        }
        for surface, gamma in zip(SCENES["twisting"]["surface"], (0.4, 0.3), strict=True)
    ]
}
ONE = {name: values[0] for name, values in UPPER["asperite"].items()}

ALONE = {"shape": [1, 1], "heights": [0.0], "asperite": ONE}


def pair(upper_drive, lower_drive):
    """One asperite on one, bars clamped at rest."""
    return scene(
        ALONE | {"drive": upper_drive, "initial": {"theta": [0.5], "omega": [0.6]}},
        {"drive": lower_drive, "initial": {"theta": 3.6, "omega": -0.5}},
    )


# Run with a drive and with forces on the ends of bars that are plug-ins.
SCENES["by hand"] = scene(
    ALONE
    | {
        "drive": {"kind": "pulled", "stiffness": 1.2, "speed": 0.5},
        "bars": "free",
        "initial": {"theta": [0.5], "omega": [0.6]},
    },
    {"drive": "free"} | TURNING,
)
# Run with other forces on the ends of bars, which no reference has: the identities alone.
SCENES["pushed"] = SCENES["by hand"] | {"duration": 0.8}
# Run with a field that is a plug-in: the identities alone.
SCENES["waves"] = scene(
    {"drive": "free"},
    {"drive": "free"},
    field=[CORRUGATION | {"on": ["upper", "lower"], "origin": [0.2, 0.3], "velocity": [0.4, 0.1]}],
)
PAIRS = {"forced on free": pair("forced", "free"), "free on free": pair("free", "free")}
# Farther apart and slower: errors limit the steps, not encounters.
SLOW = {"bob": [-2.0, 2.2], "velocity": [0.3, 0.0]}
for _name in ("slid", "forced on free", "free on free"):
    _fast = SCENES.get(_name) or PAIRS[_name]
    _upper, _lower = _fast["surface"]
    _lower = _lower | {"velocity": [0.0, 0.0]}
    _scenes = SCENES if _name in SCENES else PAIRS
    _scenes[f"{_name}, slowly"] = _fast | {"duration": 10.0, "surface": [_upper | SLOW, _lower]}
