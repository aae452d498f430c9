"""Initial states of a layout, with some initial values changed."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from tribo.layout.layout import Layout
from tribo.layout.start import draw_starts, start_baths
from tribo.model.binding import bound, check_together
from tribo.model.scene import Scene
from tribo.validation import InputError, number, number_or_array

# Initial values by name, "surface.theta" (or swing, phi, omega, nu, and x, y, vx, vy of asperites
# that can move): a number, or one per asperite.
Start = Mapping[str, ArrayLike]
# Coordinates of the quantities that have slots beside those of the swing.
COORDINATES = {"phi": "dof_phi", "nu": "dof_phi"}
COORDINATES |= {"x": "dof_x", "vx": "dof_x", "y": "dof_y", "vy": "dof_y"}
RATES = ("omega", "nu", "vx", "vy")
Key = TypeVar("Key")
Value = TypeVar("Value")
Values = dict[str, float | np.ndarray]  # one number, or one for each asperite, by keys


class Known(dict[Key, Value]):
    """The values of a function, each of which is computed when it is first needed."""

    def __init__(self, function: Callable[[Key], Value]) -> None:
        super().__init__()
        self._function = function

    def __missing__(self, key: Key) -> Value:
        value = self[key] = self._function(key)
        return value


class Changes(NamedTuple):
    """What initial values with some keys, each of one surface, change whichever they are."""

    places: Mapping[str, tuple[slice, float]]  # in y, and the value at rest, of each key
    # Where the swings stand that follow phi, and where that stands.
    following: tuple[tuple[slice, slice], ...]


class InitialState:
    """y at the start of a layout, with some initial values of the scene changed.

    Where a run `continues` from a state, this gives all that is not changed: baths, and angles
    theta that would follow phi.
    """

    def __init__(self, layout: Layout, continues: bool = False) -> None:
        """Prepare the starts of runs of a layout; runs that continue others draw nothing."""
        self._layout = layout
        model = layout.model
        baths = any(item is not None for item in (model.bath, model.torsional))
        self._starts_baths = baths and not continues
        drawn = any(s.initial.temperature for s in layout.scene.surfaces)
        self._is_drawn = drawn and not continues
        self._scene = layout.asperites, layout.scene
        self._bound = Known(partial(_bound, layout.scene))
        self._changes = Known(partial(_changes, layout, continues))

    def __call__(self, start: Start, seed: int | None = None) -> np.ndarray:
        """The state (2 coordinates,) with these initial values.

        A phi moves theta with it where neither the scene nor `start` gives a theta or swing.
        Thermal starts are drawn from `seed`; without it they are the scene's.  Raises InputError if
        a name or a value cannot be used, or both theta and swing are given.
        """
        if type(start) is not dict and not isinstance(start, Mapping):
            raise InputError("start", f"must map names to values, got {start!r}")
        keys, given = self._bound[tuple(start)]
        changes = self._changes[keys]
        values: Values = {}
        for key, name in zip(keys, given, strict=True):
            value = start[name]
            values[key] = number(key, value) if type(value) is float else self._of_each(key, value)
        y = self._layout.start.copy()
        self._change(y, changes, values, None if seed is None else [seed])
        return y

    def _of_each(self, key: str, value: ArrayLike) -> float | np.ndarray:
        """One number, or one for each asperite of the key's surface; else raises InputError."""
        slots, _ = _slots(self._layout, key)
        own = number_or_array(key, value)
        count = slots.stop - slots.start
        if type(own) is not float and np.size(own) != count:
            raise InputError(key, f"has {np.size(own)} values for {count} asperites")
        return own

    def of_members(self, values: Mapping[str, np.ndarray], seeds: np.ndarray) -> np.ndarray:
        """The states of many members, (members, 2 coordinates), drawn from `seeds` if thermal.

        `values` are (members, 1) or (members, asperites).  Raises InputError about a name.
        """
        y = self._layout.start[None].repeat(seeds.size, axis=0)
        self._change(y, self._changes[tuple(values)], values, seeds.tolist())
        return y

    def _change(
        self,
        y: np.ndarray,
        changes: Changes,
        values: Mapping[str, float | np.ndarray],
        seeds: list[int] | None,
    ) -> None:
        """Change starts y (2 coordinates,) or (members, 2 coordinates) of the layout.

        `values` are one number, one for each asperite, or (members, 1 or asperites).
        """
        if self._is_drawn and seeds:
            draw_starts(*self._scene, np.atleast_2d(y), seeds)
        for key in values:
            slots, rest = changes.places[key]
            y[..., slots] = values[key] - rest
        for swing, phi in changes.following:
            y[..., swing] = y[..., phi]
        if self._starts_baths and (values or seeds):
            start_baths(*self._scene, np.atleast_2d(y), seeds or [self._layout.scene.seed])


def _following(scene: Scene, continues: bool, keys: tuple[str, ...]) -> tuple[str, ...]:
    """The surfaces whose theta follows phi, as in :class:`tribo.Initial`: it is given nowhere."""
    names = [key.rpartition(".")[0] for key in keys if key.endswith(".phi") and not continues]
    return tuple(
        name
        for name in names
        if not {f"{name}.theta", f"{name}.swing"} & set(keys)
        and scene.initial_value(f"{name}.theta")[0].initial_swing is None
    )


def _changes(layout: Layout, continues: bool, keys: tuple[str, ...]) -> Changes:
    """What keys of single surfaces change.  Raises InputError about one that is none."""
    following = tuple(
        (_slots(layout, f"{name}.swing")[0], _slots(layout, f"{name}.phi")[0])
        for name in _following(layout.scene, continues, keys)
    )
    return Changes({key: _slots(layout, key) for key in keys}, following)


def _bound(scene: Scene, keys: tuple[str, ...]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The keys of single surfaces, and those of `keys` that give their values, or InputError."""
    found = bound(scene, {key: key for key in keys})
    check_together(scene, found)
    return tuple(found), tuple(found.values())


def _slots(layout: Layout, key: str) -> tuple[slice, float]:
    """Where a quantity of a surface stands in y, and its value at rest."""
    surface, quantity = layout.scene.initial_value(key)
    first: int = layout.parts[surface.name].start
    if quantity in COORDINATES:
        index = layout.asperites.surface[first]
        first = int(layout.surfaces[COORDINATES[quantity]][index])
    if quantity in RATES:
        first += layout.coordinates
    return slice(first, first + surface.count), surface.rest if quantity == "theta" else 0.0
