"""Derivatives of end values and means by parameters: which number matters."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from tribo.accuracy.comparison import Accuracy
from tribo.derivatives.differences import Derivative, Differences, best_of_ladder
from tribo.ensembles.engines import Engine
from tribo.ensembles.members import Sampler, Source
from tribo.kernels.status import Status
from tribo.model.parameters import value_of, with_values
from tribo.model.scene import Scene
from tribo.model.settings import names_of_quantities
from tribo.progress import Shown
from tribo.sweeps import sweep
from tribo.sweeps.figure import with_single_asperites_as_numbers
from tribo.validation import POSITIVE, InputError, instance, is_list, must_be, number

if TYPE_CHECKING:
    import xarray

# The accuracy of single runs where neither an argument nor the scene gives one.
ACCURACY = 1e-9
# The largest step relative to the value of a key, and the number of halvings.
LARGEST = 0.04
HALVINGS = 6
LADDER = LARGEST * 0.5 ** np.arange(HALVINGS)
# Values that are zero have no size of their own; those that are angles [rad].
ANGLES = ("theta", "phi", "swing")
# Endings of the variables of a sweep with errors of its quantities.
ERRORS = ("_error", "_time_half_width")
VELOCITY = "velocity"


def sensitivity(
    scene: Scene,
    quantities: Sequence[str],
    keys: Sequence[str],
    *,
    scales: Mapping[str, float] | None = None,
    members: int | None = None,
    vary: Mapping[str, Source] | None = None,
    sampler: Sampler | None = None,
    seed: int = 0,
    progress: Shown = None,
    accuracy: Accuracy | None = None,
    method: str | None = None,
    step: float | None = None,
    threads: int | None = None,
    engine: Engine | None = None,
    allow_unresolved: bool = False,
) -> xarray.Dataset:
    """The derivatives of quantities by parameters, with their errors.

    Central differences at steps from 4 % of a value down, each half of the one before, and
    Richardson's extrapolation of two of them.  Of these, the one with the smallest error is
    taken: of the extrapolation, by the differences of its neighbours, and of the runs, by their
    error estimates or the spread of the members.  All runs are points of one sweep.

    Parameters
    ----------
    scene : Scene
        The scene, at whose values the derivatives are.
    quantities : sequence of str
        Quantities with one value at the end of a run, or averages over time, as for `keep` of
        :func:`tribo.sweep`: "upper.W", "upper.friction_force".
    keys : sequence of str
        Numbers of the scene, as "upper.drive.stiffness"; of a velocity, its x component.
    scales : mapping, optional
        Key -> size of its changes, of which 4 % is the largest step; by default the value itself,
        and 1 rad of angles that are zero.
    members : int, optional
        Number of runs at each point, for means over noise or `vary`.  All points have the same
        seeds, so that derivatives are means of differences of single members.
    vary, sampler, seed, progress
        As for :func:`tribo.sweep`; progress is in runs of its points.
    accuracy, method, step, threads, engine, allow_unresolved
        As for :func:`tribo.sweep`; by default the scene's, or an accuracy of 1e-9 without noise.

    Returns
    -------
    xarray.Dataset
        ``derivative``, its ``half_width``, ``relative`` (the relative change of the quantity over
        that of the key, NaN where either is zero) and its ``relative_half_width``, and the ``step``
        that was taken, (quantity, key); and ``value`` (key,) and ``quantity_value`` (quantity,).
        Without members, half-widths are bounds by error estimates; with members they are those of
        95 % intervals.  Where a derivative does not exist, as where a slip happens or does not, the
        half-width is large.

    Raises
    ------
    InputError
        If an argument cannot be used, a key has no number, or a run at a changed value fails.
    """
    instance(Scene)("scene", scene)
    names = names_of_quantities("quantities", quantities)
    if not is_list(keys) or len(keys) == 0 or not all(isinstance(key, str) for key in keys):
        raise must_be("keys", 'a list of keys, as ["upper.drive.stiffness"]', keys)
    keys = tuple(dict.fromkeys(keys))
    values = np.array([_value_of(scene, key) for key in keys])
    sizes = np.array([_size(key, value, scales) for key, value in zip(keys, values, strict=True)])
    points = _points(values, sizes)
    swept: dict[Any, Any] = {keys: [tuple(point) for point in points.tolist()]}
    if len(keys) == 1:
        swept = {keys[0]: points[:, 0].tolist()}
    given = scene.numerics
    has_setting = (accuracy, step, given.accuracy, given.step) != (None,) * 4
    if not has_setting and members is None:
        accuracy = ACCURACY
    found = sweep(
        scene,
        swept,
        members,
        vary,
        keep=names,
        sampler=sampler,
        seed=seed,
        progress=progress,
        accuracy=accuracy,
        method=method,
        step=step,
        threads=threads,
        engine=engine,
        allow_unresolved=allow_unresolved,
    )
    data = with_single_asperites_as_numbers(found)
    tables = [_values_of(data, name, members is not None) for name in names]
    best = np.empty((len(names), len(keys), 3))
    for n, table in enumerate(tables):
        for k in range(len(keys)):
            best[n, k] = _best(data, table, keys, k, sizes)
    notes = json.loads(data.attrs.get("notes", "[]"))
    unknown = [name for name, each in zip(names, tables, strict=True) if not each.known]
    if unknown:
        whose = "runs with a given step" if step is not None else ", ".join(unknown)
        notes.append(
            f"{whose} have no error estimates: half-widths are those of the differences alone"
        )
    attributes = {"notes": json.dumps(notes), "runs": len(points) * (members or 1)}
    of_scene = np.array([np.mean(each.values[0]) for each in tables])
    return _dataset(names, keys, best, of_scene, values).assign_attrs(attributes)


class _Table(NamedTuple):
    """Values of a quantity at all points."""

    name: str
    values: np.ndarray  # (points, members)
    errors: np.ndarray  # (points,)
    known: bool  # whether these are


def _points(values: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """Values of the keys, (points, keys): the scene's, and each up and down by each step."""
    points = [values]
    for k, size in enumerate(sizes):
        for part in LADDER:
            for sign in (1.0, -1.0):
                point = values.copy()
                point[k] += sign * part * size
                points.append(point)
    return np.array(points)


def _best(
    data: xarray.Dataset, table: _Table, keys: Sequence[str], k: int, sizes: np.ndarray
) -> Derivative:
    """The derivative by the kth key.  Raises InputError if no step gives one."""
    rows = 1 + 2 * HALVINGS * k + np.arange(2 * HALVINGS)
    up = rows[::2]
    down = rows[1::2]
    differences = Differences(LADDER * sizes[k], table.values[up], table.values[down])
    best = best_of_ladder(differences, table.errors[up] + table.errors[down])
    if best is None:
        raise InputError(f"keys.{keys[k]}", _failure(data, table, rows))
    return best


def _dataset(
    names: Sequence[str],
    keys: Sequence[str],
    best: np.ndarray,
    of_scene: np.ndarray,
    values: np.ndarray,
) -> xarray.Dataset:
    """The derivatives as they are and as relative changes.

    `best` is (quantities, keys, 3), `of_scene` the quantities' values and `values` the keys'.
    """
    import xarray

    derivative, half_width, step = np.moveaxis(best, 2, 0)
    known = (of_scene[:, None] != 0.0) & (values != 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(known, values / of_scene[:, None], np.nan)
    both = ("quantity", "key")
    relative = {"units": "1", "long_name": "relative change of the quantity over that of the key"}
    variables = {
        "derivative": (both, derivative, {"long_name": "derivative of the quantity by the key"}),
        "half_width": (both, half_width, {"long_name": "half-width of its interval, or bound"}),
        "relative": (both, ratio * derivative, relative),
        "relative_half_width": (both, np.abs(ratio) * half_width, {"units": "1"}),
        "step": (both, step, {"long_name": "step of the key"}),
        "value": ("key", values, {"long_name": "value of the key"}),
        "quantity_value": ("quantity", of_scene, {"long_name": "value of the quantity"}),
    }
    return xarray.Dataset(variables, {"quantity": list(names), "key": list(keys)})


def _value_of(scene: Scene, key: str) -> float:
    """The number at a key.  Raises InputError if there is none."""
    try:
        value = value_of(scene, key)
        if value is None:
            with_values(scene, {key: 1.0})  # which says why, if it is no key
    except InputError as error:
        raise error.under("keys") from None
    if key.endswith(f".{VELOCITY}") and is_list(value):
        value = value[0]
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise InputError(f"keys.{key}", f"must be a number of the scene, got {value!r}")
    if not np.isfinite(value):
        raise InputError(f"keys.{key}", f"must be finite to change, got {value!r}")
    return float(value)


def _size(key: str, value: float, scales: Mapping[str, float] | None) -> float:
    """The size of the changes of a key."""
    if scales is not None and key in scales:
        return number(f"scales.{key}", scales[key], POSITIVE)
    if value != 0.0:
        return abs(value)
    if key.rpartition(".")[2] in ANGLES:
        return 1.0
    raise InputError(
        f"scales.{key}", "is missing: the value is zero, so give the size of its changes"
    )


def _values_of(data: xarray.Dataset, name: str, has_members: bool) -> _Table:
    """The values of a quantity.  Raises InputError if it has more than one at the end of a run."""
    label = f"{name}_end" if name not in data.data_vars and f"{name}_end" in data else name
    array = data[label]
    expected = 2 if has_members else 1
    if array.ndim != expected:
        raise InputError(
            "quantities",
            f'must have one value at the end of a run; "{name}" has {array.shape[expected:]}',
        )
    table = array.values.reshape(array.shape[0], -1).astype(float)
    errors = np.zeros(len(table))
    if has_members:
        return _Table(name, table, errors, True)
    for ending in ERRORS:
        if f"{name}{ending}" in data:
            known = data[f"{name}{ending}"].values.astype(float)
            return _Table(name, table, np.where(np.isfinite(known), known, np.inf), True)
    return _Table(name, table, errors, False)


def _failure(data: xarray.Dataset, table: _Table, rows: np.ndarray) -> str:
    """Why a key has no derivative: the statuses of its runs, or errors that are not known."""
    ends = np.unique(data["status"].values[rows].astype(str)).tolist()
    others = [end for end in ends if end != Status.COMPLETED]
    if others:
        return f"has no derivative: runs at its steps end by {', '.join(others)}"
    unknown = np.count_nonzero(~np.isfinite(table.errors[rows]))
    if unknown:
        return (
            f"has no derivative: in {unknown} of {rows.size} runs at its steps the error of "
            f'"{table.name}" is not known; averages need a longer run, or a later output.run_in'
        )
    return f'has no derivative: "{table.name}" is not finite at its steps'
