"""Ensembles as labelled data: variables of members, their coordinates, and what all share."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from tribo.ensembles.batches import Policy
from tribo.ensembles.kept_values import Kept, KeptValues
from tribo.ensembles.members import VELOCITY, Members, is_start
from tribo.ensembles.runner import Runs
from tribo.ledger.quantities import EVERY_QUANTITY
from tribo.ledger.quantity import UNITS
from tribo.model.initial import DISPLACEMENTS
from tribo.model.scene import Scene
from tribo.results.result_file import Variable

if TYPE_CHECKING:
    import xarray

# Numbers that each run has beside its values.
COUNTS = {
    "steps": "steps of the run",
    "force_evaluations": "evaluations of all forces in the run",
    "level": "level of the tolerances; NaN where settings were searched for",
    "error": "difference from a finer run, relative; NaN where not checked",
}
# The same of runs with noise.
EXCESS = {
    "excess": "part by which the step makes the kinetic temperature too high, by the stiffness of "
    "the forces; NaN of runs of their own",
}


def counts_of(scene: Scene) -> dict[str, str]:
    """What each run of a scene has beside its values, with the meaning."""
    return COUNTS | (EXCESS if scene.is_noisy else {})


def members_dataset(
    policy: Policy, members: Members, found: KeptValues, attributes: Mapping[str, str | float]
) -> xarray.Dataset:
    """The data set of some members: their values, numbers, seeds, statuses and what is varied."""
    import xarray

    kept = policy.kept
    variables: dict[str, Variable] = {}
    for name in kept.names:
        # The name of a start that is varied is taken.
        own = f"{name}_end" if name in members.values else name
        variables[own] = ("member", *kept.dimensions(name)), found[name], kept.about(name)
    for name, meaning in counts_of(policy.simulation.scene).items():
        variables[name] = ("member",), found[name], {"long_name": meaning}
    coordinates: dict[str, Variable] = {
        **member_coordinates(members),
        "status": (("member",), found["status"], {"long_name": "end of its run"}),
        **times_of(kept, policy.simulation.scene),
    }
    return xarray.Dataset(variables, coordinates, attributes)


def member_coordinates(members: Members, seed: str = "seed") -> dict[str, Variable]:
    """Numbers of members, their seeds under the name `seed`, and their varied values."""
    coordinates: dict[str, Variable] = {
        "member": (("member",), members.numbers, {"long_name": "member"}),
        seed: (("member",), members.seeds, {"long_name": "seed of the member"}),
    }
    for key, values in members.values.items():
        surface, _, kind = key.rpartition(".")
        if kind == VELOCITY:
            about = {"units": UNITS["velocity"], "long_name": "initial velocity of the surface"}
            coordinates[key] = (("member", "axis"), values, about)
            coordinates["axis"] = (("axis",), np.array(["x", "y"]), {"long_name": "axis"})
        elif not is_start(key):
            coordinates[key] = (("member",), values[:, 0], {"long_name": key})
        else:
            coordinates[key] = (("member", f"{surface}_asperite"), values, about_start(key))
    return coordinates


def about_start(key: str) -> dict[str, str]:
    """The units and the meaning of an initial value."""
    kind = key.rpartition(".")[2]
    if kind in DISPLACEMENTS:
        what = "velocity" if kind[0] == "v" else "displacement"
        meaning = f"{what} of the centre of mass along {kind[-1]}, beyond the surface's"
        return {"units": DISPLACEMENTS[kind], "long_name": f"initial {meaning}"}
    quantity = EVERY_QUANTITY["theta" if kind == "swing" else kind]
    return {"units": quantity.units, "long_name": f"initial {quantity.long_name}"}


def times_of(kept: Kept, scene: Scene) -> dict[str, Variable]:
    if kept.at_samples:
        return {"time": (("time",), scene.times, {"units": "time", "long_name": "time"})}
    return {"time": ((), scene.duration, {"units": "time", "long_name": "time of the end"})}


def settings_attributes(runs: Runs) -> dict[str, str | float]:
    """How all members of an ensemble are run."""
    plan = runs.policy.simulation.plan
    return {
        "method": plan.method,
        "method_alone": plan.method,
        "step": json.dumps(plan.setting.step if plan.accuracy is None else None),
        **({"automatic": 1, "interval": json.dumps(plan.interval)} if plan.automatic else {}),
        "accuracy": json.dumps(plan.accuracy),
        "seed": str(runs.variation.seed),
    }


def kept_attributes(runs: Runs) -> dict[str, str | float]:
    """The same, and what is kept of each."""
    policy = runs.policy
    return settings_attributes(runs) | {
        "keep": json.dumps(policy.kept.names),
        "own_numbers": json.dumps(runs.variation.own_numbers),
        **({} if policy.plan is None else policy.plan.attributes),
    }
