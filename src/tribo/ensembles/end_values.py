"""Quantities at the end of the runs of many members, as labelled data."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from tribo.ensembles.dataset import varied_coordinates
from tribo.ensembles.members import Variation
from tribo.kernels.status import Status
from tribo.model.scene_writer import scene_text
from tribo.prepared import Simulation
from tribo.run.dataset import Variable
from tribo.run.quantities import QUANTITIES
from tribo.validation import InputError, short_repr

if TYPE_CHECKING:
    import xarray

# The status of a member whose accuracy is out of reach.
MISSED = "AccuracyMissed"
# Of an array of names of statuses.
STATUS_TYPE = f"U{max(map(len, [MISSED, *Status]))}"


@dataclass(eq=False)
class EndValues:
    """Quantities at the end of many runs.

    Attributes
    ----------
    values : dict
        Name -> (members, asperites) or (members,); NaN of members that did not complete.
    status : ndarray, (members,), of str
        How each run ended.
    steps : ndarray, (members,)
        Of each run.
    level : ndarray, (members,)
        Of the tolerances of each run; NaN of members that had a run of their own, or a given step.
    error : ndarray, (members,)
        The largest difference of a member from a finer run, relative to its scales; NaN of members
        that were not checked.
    attributes : dict
        How the setting of all was found, to run a member again.
    interrupted : bool
        Whether an interrupt ended the runs.
    """

    values: dict[str, np.ndarray]
    status: np.ndarray
    steps: np.ndarray
    level: np.ndarray
    error: np.ndarray
    attributes: dict[str, str | float] = field(default_factory=dict)
    interrupted: bool = False


def checked_names(simulation: Simulation, keep: Sequence[str]) -> list[str]:
    """The names of the kept quantities, each once.  Raises InputError."""
    if isinstance(keep, str) or not isinstance(keep, Sequence) or not keep:
        raise InputError("keep", f'must list quantities, as ["upper.w1"], got {short_repr(keep)}')
    ledger = simulation.empty_ledger
    surfaces = simulation.layout.parts
    for name in keep:
        surface, _, _ = str(name).rpartition(".")
        alone = not surface and str(name) not in ledger.system
        if alone or not ledger.series(str(name)):
            raise InputError(
                f"keep.{name}",
                f'must be a quantity of a surface, as "{next(iter(surfaces))}.w1", or one of the '
                'system, as "contact_energy"',
            )
    return list(dict.fromkeys(map(str, keep)))


def end_dataset(
    simulation: Simulation, variation: Variation, found: EndValues, seconds: float
) -> xarray.Dataset:
    """The data set of an ensemble that took `seconds`."""
    import xarray

    count = found.status.size
    variables: dict[str, Variable] = {}
    for name, values in found.values.items():
        surface, _, kind = name.rpartition(".")
        quantity = QUANTITIES[kind]
        about = {"units": quantity.units, "long_name": f"{quantity.long_name}, at the end"}
        dimensions = ("member", f"{surface}_asperite")[: values.ndim]
        # The name of a start that is varied is taken.
        own = f"{name}_end" if name in variation.sizes else name
        variables[own] = (dimensions, values, about)
    of_members = {
        "steps": (found.steps, "steps of the run"),
        "level": (found.level, "level of the tolerances; NaN where settings were searched for"),
        "error": (found.error, "difference from a finer run, relative; NaN where not checked"),
    }
    for name, (values, meaning) in of_members.items():
        variables[name] = ("member",), values, {"long_name": meaning}
    return xarray.Dataset(
        variables,
        _coordinates(simulation, variation, found, count),
        _attributes(simulation, variation, found, seconds),
    )


def _coordinates(
    simulation: Simulation, variation: Variation, found: EndValues, count: int
) -> dict[str, Variable]:
    """The time, and the number, the seed, the status and the varied values of each member."""
    end = {"units": "time", "long_name": "time of the end"}
    coordinates: dict[str, Variable] = {
        "member": (("member",), np.arange(count), {"long_name": "member"}),
        "seed": (("member",), variation.seeds(0, count), {"long_name": "seed of the member"}),
        "status": (("member",), found.status, {"long_name": "end of its run"}),
        "time": ((), simulation.scene.duration, end),
    }
    values = {
        key: np.broadcast_to(variation.rows(key, 0, count), (count, size))
        for key, size in variation.sizes.items()
    }
    return coordinates | varied_coordinates(values)


def _attributes(
    simulation: Simulation, variation: Variation, found: EndValues, seconds: float
) -> dict[str, str | float]:
    """Properties of the whole ensemble; text is JSON where it is no word."""
    from tribo import __version__

    plan = simulation.plan
    return {
        "tribo_version": __version__,
        "numpy_version": np.__version__,
        "scene": scene_text(simulation.scene),
        "status": str(Status.INTERRUPTED if found.interrupted else Status.COMPLETED),
        "method": plan.method,
        "step": json.dumps(plan.setting if plan.tuned is None else None),
        "accuracy": json.dumps(plan.accuracy),
        "seed": str(variation.seed),
        "notes": json.dumps(_notes(found)),
        "seconds": seconds,
        **found.attributes,
    }


def _notes(found: EndValues) -> list[str]:
    """How many members were refined, and how many have no values."""
    notes = []
    stopped = found.status != str(Status.COMPLETED)
    if stopped.any():
        names = ", ".join(sorted(set(found.status[stopped])))
        notes.append(f"{stopped.sum()} of {stopped.size} members have no values ({names})")
    checked = np.isfinite(found.error)
    if checked.any():
        common = np.nanmax(found.level)
        alone = np.isnan(found.level).sum()
        notes.append(
            f"{checked.sum()} members were run again with finer settings; "
            f"{int((found.level < common).sum() + alone)} needed them"
        )
    return notes
