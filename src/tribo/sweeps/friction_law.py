"""The friction force of a surface over load, speed and temperature, in one call."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from tribo.kernels.status import Status
from tribo.ledger.separation import has_contact_distance
from tribo.model.number import changes, constant
from tribo.model.scene import Scene
from tribo.model.surface import Surface
from tribo.results.averages import interval
from tribo.sweeps import sweep
from tribo.validation import (
    ANY,
    NOT_NEGATIVE,
    POSITIVE,
    InputError,
    instance,
    is_list,
    must_be,
    number,
)

if TYPE_CHECKING:
    import xarray

# Parts of a sliding distance that are left out as run-in.
RUN_IN = 0.25
# Units of the coordinates.
UNITS = {"load": "force", "speed": "length time^-1", "temperature": "energy"}


class _Axis(NamedTuple):
    """Values of a quantity, and the keys and rows by which a sweep takes them."""

    values: np.ndarray
    keys: tuple[str, ...]
    rows: list[tuple[float, ...]]

    @property
    def swept(self) -> tuple[str | tuple[str, ...], list[Any]]:
        """The key or keys of a sweep, and its values."""
        if len(self.keys) == 1:
            return self.keys[0], [row[0] for row in self.rows]
        return self.keys, self.rows


def friction_law(
    scene: Scene,
    loads: Sequence[float] | None = None,
    speeds: Sequence[float] | None = None,
    temperatures: Sequence[float] | None = None,
    *,
    surface: str | None = None,
    distance: float | None = None,
    seeds: Sequence[int] | None = None,
    members: int | None = None,
    **settings: Any,
) -> xarray.Dataset:
    """The friction force F(N, v, T) of a surface, with 95 % intervals.

    Parameters
    ----------
    scene : Scene
        The scene, in which the surface slides.
    loads : sequence of float, optional
        Loads on each asperite of the surface [force]; its drive has a load.
    speeds : sequence of float, optional
        Speeds of its stage, or of the surface itself without one, along x [length / time]; all of
        one sign.
    temperatures : sequence of float, optional
        Temperatures of all reservoirs of the scene [energy].
    surface : str, optional
        Name of the surface; by default the first that a stage pulls, that has a load, or that
        moves.
    distance : float, optional
        How far the stage or surface slides at each speed [length], of which the first quarter is
        run-in.  Without it, durations and the run-in are those of the scene.
    seeds : sequence of int, optional
        Seeds of the scene, each of another rough surface, over which the mean is taken.
    members : int, optional
        Number of runs at each point with other noise, over which the mean is taken.
    **settings
        Others of :func:`tribo.sweep`: accuracy, method, step, engine, threads, out, resume, ...

    Returns
    -------
    xarray.Dataset
        ``friction``, positive where it resists the sliding, and its ``friction_half_width``
        (load, speed, temperature) of those that are given [force]; with a load
        ``friction_coefficient`` and its half-width; ``contact_share`` where contacts have a range;
        and ``completed``, the number of runs that completed, over which means are taken.
        Half-widths are of Student's intervals over members, or over seeds (of the means over the
        members of each), or of the average over time of a single run, and NaN where there is none.

    Raises
    ------
    InputError
        If nothing is given to vary, the surface has no load, does not slide, or no reservoir has a
        temperature.
    """
    instance(Scene)("scene", scene)
    part = _surface_of(scene, surface)
    axes: dict[str, _Axis] = {}
    if loads is not None:
        axes["load"] = _loads(part, loads)
    if speeds is not None:
        axes["speed"] = _speeds(part, speeds, distance)
    elif distance is not None:
        raise InputError("distance", "needs speeds, by which durations follow from it")
    if temperatures is not None:
        axes["temperature"] = _temperatures(scene, temperatures)
    if not axes:
        raise InputError("loads", "is missing; give loads, speeds or temperatures")
    if unknown := settings.keys() & {"keep", "at", "statistics", "half_width", "point"}:
        raise InputError(min(unknown), "cannot be given: friction_law keeps averages over time")
    keep = [f"{part.name}.friction_force"]
    if has_contact_distance(scene, part):
        keep.append(f"{part.name}.contact_share")
    swept: dict[Any, Any] = dict(axis.swept for axis in axes.values())
    if seeds is not None:
        swept["seed"] = list(seeds)
    data = sweep(scene, swept, members, keep=keep, **settings)
    samples = (seeds is not None) + (members is not None)
    return _law(data, part, axes, samples)


def _law(
    data: xarray.Dataset, part: Surface, axes: Mapping[str, _Axis], samples: int
) -> xarray.Dataset:
    """The friction of a sweep over the axes and over so many dimensions of samples."""
    import xarray

    force = f"{part.name}.friction_force"
    share = f"{part.name}.contact_share"
    names = tuple(axes)
    sign = -_direction(part, axes.get("speed"))
    mean, half_width = _mean(_independent(data, force, len(axes), samples))
    if samples == 0:
        half_width = data[f"{force}_time_half_width"].values
    completed = np.sum(_samples(data, "status", len(axes), samples) == str(Status.COMPLETED), -1)
    about = {"units": "force", "long_name": f"friction force on {part.name}"}
    variables: dict[str, Any] = {
        "friction": (names, sign * mean, about),
        "friction_half_width": (names, half_width, about),
        "completed": (names, completed, {"units": "1", "long_name": "runs that completed"}),
    }
    total = _total_load(part, axes, mean.ndim)
    if total is not None:
        with np.errstate(divide="ignore", invalid="ignore"):
            variables["friction_coefficient"] = names, sign * mean / total, {"units": "1"}
            variables["friction_coefficient_half_width"] = names, half_width / total, {"units": "1"}
    if share in data:
        shares = _mean(_independent(data, share, len(axes), samples))[0]
        variables["contact_share"] = names, shares, {"units": "1"}
    coordinates = {name: (name, axis.values, {"units": UNITS[name]}) for name, axis in axes.items()}
    if "load" in coordinates:
        of_whom = "the block" if part.drive.block else "each asperite"
        coordinates["load"][2]["long_name"] = f"load on {of_whom}"
    attributes = {"surface": part.name, "notes": data.attrs["notes"]}
    over = [name for name in ("seed", "member") if name in data[force].dims]
    attributes["intervals"] = f"{over[0]}s" if over else "average over time"
    return xarray.Dataset(variables, coordinates, attributes)


def _surface_of(scene: Scene, name: str | None) -> Surface:
    """The surface of which the friction is found.  Raises InputError."""
    if name is not None:
        return scene.surfaces[scene.index_of(name)]
    for wanted in (
        lambda each: each.drive.stage is not None,
        lambda each: bool(each.drive.load),
        lambda each: each.velocity[0] != 0.0,
    ):
        for each in scene.surfaces:
            if wanted(each):
                return each
    raise InputError("surface", "is missing, and no surface of the scene slides; name one")


def _values(field: str, values: object, condition: Any, unit: str) -> np.ndarray:
    if not is_list(values) or len(values) == 0:
        raise must_be(field, "a list of numbers", values)
    return np.array([number(f"{field}[{i}]", v, condition, unit) for i, v in enumerate(values)])


def _loads(part: Surface, loads: object) -> _Axis:
    found = _values("loads", loads, NOT_NEGATIVE, "force")
    if part.drive.load is None:
        raise InputError("loads", f'need a surface whose drive has a load; "{part.name}" has none')
    return _Axis(found, (f"{part.name}.drive.load",), [(value,) for value in found.tolist()])


def _speeds(part: Surface, speeds: object, distance: float | None) -> _Axis:
    """Speeds, with durations and run-ins for one sliding distance."""
    found = _values("speeds", speeds, ANY, "length / time")
    if np.any(found == 0.0) or np.any(np.sign(found) != np.sign(found[0])):
        raise must_be("speeds", "all positive or all negative", speeds)
    key = f"{part.name}.velocity" if part.drive.stage is None else f"{part.name}.drive.speed"
    keys: tuple[str, ...] = (key,)
    columns = [found]
    if distance is not None:
        length = number("distance", distance, POSITIVE, "length")
        durations = length / np.abs(found)
        keys += ("duration", "output.run_in")
        columns += [durations, RUN_IN * durations]
    return _Axis(found, keys, list(map(tuple, np.array(columns).T.tolist())))


def _temperatures(scene: Scene, temperatures: object) -> _Axis:
    """Temperatures of all reservoirs.  Raises InputError if there is none."""
    found = _values("temperatures", temperatures, NOT_NEGATIVE, "energy")
    keys = []
    for each in scene.surfaces:
        parts = [f".{reservoir.on}" for reservoir in each.reservoirs]
        if len(parts) == 1:  # a reservoir alone needs no name
            parts = [""]
        keys += [f"{each.name}.langevin{part}.temperature" for part in parts]
    if not keys:
        raise InputError("temperatures", "need a reservoir (langevin), of which the scene has none")
    return _Axis(found, tuple(keys), [(value,) * len(keys) for value in found.tolist()])


def _direction(part: Surface, speeds: _Axis | None) -> float:
    """The sign of the sliding velocity along x.  Raises InputError if nothing slides."""
    stage = part.drive.stage
    speed = part.velocity[0] if stage is None else stage.speed
    if speeds is not None:
        speed = float(speeds.values[0])
    if changes(speed):
        raise InputError("speeds", f'are missing, and that of "{part.name}" follows a schedule')
    if speed == 0.0:
        raise InputError("speeds", f'are missing, and "{part.name}" does not slide')
    return float(np.sign(constant(speed)))


def _total_load(part: Surface, axes: Mapping[str, _Axis], dimensions: int) -> np.ndarray | None:
    """The load on the whole surface, along the dimension of loads; None without one."""
    count = 1 if part.drive.block else part.count
    if "load" not in axes:
        load = part.drive.load
        if changes(load):
            raise InputError("loads", f'are missing, and that of "{part.name}" follows a schedule')
        return None if not load else np.array(abs(constant(load)) * count)
    place = list(axes).index("load")
    shape = [1] * dimensions
    shape[place] = axes["load"].values.size
    return count * axes["load"].values.reshape(shape)


def _samples(data: xarray.Dataset, name: str, axes: int, samples: int) -> np.ndarray:
    """Values (axes..., samples) of a quantity, samples of seeds and members together."""
    array = data[name]
    values = array.values
    if samples == 0:
        return values[..., None]
    return values.reshape(*values.shape[:axes], -1)


def _independent(data: xarray.Dataset, name: str, axes: int, samples: int) -> np.ndarray:
    """Values (axes..., samples) of a quantity that are independent of one another.

    Members of one seed share its surface, and those of one number their noise at all seeds: with
    both, these are the means over the members of each seed.
    """
    if samples < 2:
        return _samples(data, name, axes, samples)
    return _mean(data[name].values)[0]


def _mean(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Means over the samples that completed, and half-widths of their intervals."""
    rows = values.reshape(-1, values.shape[-1])
    means = np.full(len(rows), np.nan)
    widths = means.copy()
    for k, row in enumerate(rows):
        known = row[np.isfinite(row)]
        if known.size:
            means[k] = np.mean(known)
        if known.size > 1:
            widths[k] = interval(known).half_width
    return means.reshape(values.shape[:-1]), widths.reshape(values.shape[:-1])
