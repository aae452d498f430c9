"""Two rows of asperites with any of the effects, for benchmarks/effects.py."""

import numpy as np
from user_forces import Hinge, Push

import tribo

# Asperites of each row.
ROW = 24

# Asperites of each row where a cutoff makes contact go by a neighbour list: from 64 squared pairs.
LONG_ROW = 80

# Oscillators of each kind on a bar.
OSCILLATORS = 10

# Cutoff of the contact [length].
CUTOFF = 6.0

# Effects that need others.
NEEDS = {
    "torsional bath": ("turning bars",),
    "periodic": ("cutoff",),
    "neighbour list": ("long rows",),
}

# Effects that are measured alone only: the others would take place in other scenes.
APART = (
    "sliding",
    "load",
    "pull",
    "driven bars",
    "rigid asperites",
    "swing langevin",
    "neighbour list",
    "sums alone",
    "no ledger",
)

# What of the works these keep.
LEDGERS = {"sums alone": "surfaces", "no ledger": "none"}

# The effects that are measured alone and together.
TOGETHER = (
    "turning bars",
    "springs",
    "bath",
    "torsional bath",
    "langevin",
    "field",
    "own drive",
    "own ends",
    "cutoff",
    "contact within",
    "species",
    "periodic",
)


def with_needs(effect: str) -> frozenset[str]:
    """An effect and all that it needs."""
    return frozenset({effect, *NEEDS.get(effect, ())})


def scene(effects: frozenset[str]) -> tribo.Scene:
    """The scene with these effects; without any, two forced rows with Coulomb contact."""
    count = LONG_ROW if "long rows" in effects else ROW
    row = {"shape": (count, 1), "asperite": tribo.Asperite(kappa=20.0)}
    (ledger,) = {LEDGERS[name] for name in effects & LEDGERS.keys()} or {"asperites"}
    periodic = tribo.Periodic(x=3.0 * count) if "periodic" in effects else tribo.Periodic()
    return tribo.Scene(
        (
            tribo.Surface("upper", **row | _upper(effects)),
            tribo.Surface("lower", facing="up", **row | _lower(effects)),
        ),
        _interactions(effects),
        1e6,
        periodic=periodic,
        fields=[tribo.Field(tribo.Corrugation(0.01, 1.0), on=("upper",))]
        if "field" in effects
        else [],
        output=tribo.Output(samples=2, ledger=ledger),
    )


def _upper(effects: frozenset[str]) -> dict[str, object]:
    settings: dict[str, object] = {
        "bob": (0.3, 1.2),
        "velocity": (0.01, 0.0),
        "spacing": (1.5, 0.0),
        "species": "A",
    }
    if "springs" in effects:
        settings["springs"] = tribo.Springs(4.0)
    if "own drive" in effects:
        settings["drive"] = tribo.Custom(force=Push(1e-3))
    if "sliding" in effects:
        settings["drive"] = "free"
    if "driven bars" in effects:
        settings["drive"] = "bars"
    if "rigid asperites" in effects:
        settings["asperite"] = tribo.Asperite(kappa=np.inf)
    if "pull" in effects:
        settings["drive"] = tribo.Pulled(stiffness=1.0, speed=0.01)
    if "load" in effects:
        settings["drive"] = tribo.Forced(load=1e-3)
    if "own ends" in effects:
        settings["bars"] = tribo.Ends(Hinge(1.0))
    if "bath" in effects:
        frequencies = np.linspace(1.0, 20.0, OSCILLATORS)
        settings["bath"] = tribo.Bath(np.full(OSCILLATORS, 0.01), frequencies)
    return settings


def _lower(effects: frozenset[str]) -> dict[str, object]:
    settings: dict[str, object] = {"spacing": (1.5, 0.0), "species": "B"}
    if "turning bars" in effects:
        settings["bars"] = "free"
    if "torsional bath" in effects:
        settings["bath"] = tribo.Bath(
            inertias=np.full(OSCILLATORS, 0.01),
            torsional_frequencies=np.linspace(1.0, 20.0, OSCILLATORS),
        )
    if "langevin" in effects:
        settings["langevin"] = tribo.Langevin(0.1, 0.01)
    if "swing langevin" in effects:
        settings["langevin"] = tribo.Langevin(0.1, 0.01, on="swing")
    return settings


def _interactions(effects: frozenset[str]) -> list[tribo.Interaction]:
    potential = tribo.Coulomb(0.001)
    if effects & {"cutoff", "neighbour list"}:
        potential = potential.with_cutoff(CUTOFF)
    species = ("A", "B") if "species" in effects else None
    found = [tribo.Interaction(potential, between=("upper", "lower"), species=species)]
    if "contact within" in effects:
        found.append(tribo.Interaction(potential, between=("upper", "upper")))
    return found
