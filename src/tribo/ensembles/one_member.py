"""One member of an ensemble alone."""

from __future__ import annotations

import json
import tomllib
from typing import TYPE_CHECKING

import numpy as np

from tribo.ensembles.checked_runs import CheckedPlan
from tribo.ensembles.dataset import members_dataset
from tribo.ensembles.kept_values import Kept
from tribo.ensembles.members import Members
from tribo.ensembles.runner import policy_of
from tribo.model.scene_file import scene_from
from tribo.simulation import prepare
from tribo.validation import InputError, integer, short_repr

if TYPE_CHECKING:
    import xarray


def ensemble_member(data: xarray.Dataset, number: int) -> xarray.Dataset:
    """Run one member of an ensemble again, alone.

    Parameters
    ----------
    data : xarray.Dataset
        The data set that :func:`tribo.ensemble` returns with `keep`, or that of its file.
    number : int
        The number of the member, from 0.

    Returns
    -------
    xarray.Dataset
        The quantities of this member, with the bits in `data` if version and machine are the same.

    Raises
    ------
    InputError
        If the data set contains no members with kept quantities, or not that member.
    """
    attributes = dict(data.attrs)
    if "keep" not in attributes or "member" not in data.coords:
        raise InputError("data", "must have members, as tribo.ensemble(..., keep=...) returns them")
    integer("number", number, 0)
    found = np.flatnonzero(data["member"].values == number)
    if found.size != 1:
        raise InputError("number", f"must be that of a member, got {short_repr(number)}")
    keep = json.loads(attributes["keep"])
    plan = CheckedPlan.from_attributes(attributes) if "scales" in attributes else None
    scene = scene_from(tomllib.loads(attributes["scene"]))
    # The method of a pair's lanes takes the place of `method`, which found the scales.
    step = json.loads(attributes["step"])
    simulation = prepare(
        scene, method=attributes["method_alone"], step=step, progress=False, threads=1
    )
    kept = Kept.checked(simulation.layout, keep, "time" in data.dims)
    one = data.isel(member=found)
    names = [str(name) for name in one.coords if "." in str(name)]
    members = Members(
        one["member"].values,
        one["seed"].values,
        {name: one[name].values.reshape(1, -1) for name in names},
    )
    policy = policy_of(simulation, kept, json.loads(attributes["own_numbers"]), plan)
    return members_dataset(policy, members, policy.complete(members), attributes)
