"""Initial states of a layout, with some initial values changed."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from tribo.layout.layout import Layout
from tribo.layout.start import draw_starts, start_baths
from tribo.validation import InputError, number_or_array

# Initial values by name, "surface.theta" (or swing, phi, omega, nu): a number, or one per asperite.
Start = Mapping[str, ArrayLike]
# Where a quantity of a surface stands in y, its value at rest, and the number of asperites.
Slots = tuple[int | np.ndarray, float, int]


class InitialState:
    """y at t = 0, with some initial values of the scene changed."""

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        model = layout.model
        self._has_baths = any(item is not None for item in (model.bath, model.torsional))
        self._is_drawn = any(s.initial.temperature for s in layout.scene.surfaces)
        self._scene = layout.asperites, layout.scene, layout.parts
        self._slots: dict[str, Slots] = {}

    def __call__(self, start: Start, seed: int | None = None) -> np.ndarray:
        """The state (2 coordinates,) with these initial values.

        A phi moves theta with it where neither the scene nor `start` gives a theta or swing.
        Thermal starts are drawn from `seed`; without it they are the scene's.  Raises InputError if
        a name or a value cannot be used, or both theta and swing are given.
        """
        if not isinstance(start, (dict, Mapping)):  # a dict is recognised sooner
            raise InputError("start", f"must map names to values, got {start!r}")
        y = self._layout.start.copy()
        if self._is_drawn and seed is not None:
            draw_starts(*self._scene, y[None], [seed])
        for key, value in start.items():
            known = self._slots.get(key)
            if known is None:
                known = self._slots[key] = _slots(self._layout, key)
            slots, rest, count = known
            values = number_or_array(key, value)
            if isinstance(values, np.ndarray):
                if values.size != count:
                    raise InputError(key, f"has {values.size} values for {count} asperites")
                values = values.reshape(y[slots].shape)
            y[slots] = values - rest
        self._follow(start, y)
        if self._has_baths and (start or seed is not None):
            start_baths(*self._scene, y[None], [self._layout.scene.seed if seed is None else seed])
        return y

    def of_members(self, values: Mapping[str, np.ndarray], seeds: np.ndarray) -> np.ndarray:
        """The states of many members, (members, 2 coordinates), drawn from `seeds` if thermal.

        `values` are (members, 1) or (members, asperites).  Raises InputError about a name.
        """
        y = np.tile(self._layout.start, (seeds.size, 1))
        if self._is_drawn:
            draw_starts(*self._scene, y, seeds.tolist())
        for key, rows in values.items():
            slots, rest, count = _slots(self._layout, key)
            y[:, np.atleast_1d(slots)] = np.broadcast_to(rows, (seeds.size, count)) - rest
        self._follow(values, y)
        if self._has_baths:
            start_baths(*self._scene, y, seeds.tolist())
        return y

    def _follow(self, start: Start | Mapping[str, np.ndarray], y: np.ndarray) -> None:
        """Let theta follow phi, as in :class:`tribo.Initial`, where it is given nowhere."""
        for key in start:
            name, _, quantity = key.rpartition(".")
            given = [key for key in (f"{name}.theta", f"{name}.swing") if key in start]
            if quantity == "swing" and len(given) == 2:
                raise InputError(given[1], f"cannot go with {given[0]}; give one or the other")
            if quantity == "phi" and not given:
                surface, _ = self._layout.scene.initial_value(f"{name}.theta")
                if surface.initial_swing is None:
                    swing, phi = (_slots(self._layout, f"{name}.{k}")[0] for k in ("swing", "phi"))
                    y[..., swing] = y[..., phi]


def _slots(layout: Layout, key: str) -> Slots:
    """Where the quantity of a surface stands; numpy finds an integer sooner than an array."""
    surface, quantity = layout.scene.initial_value(key)
    part = layout.parts[surface.name]
    slots = np.arange(part.start, part.stop)
    if quantity in ("phi", "nu"):
        slots = layout.asperites.dof_phi[part].astype(int)
    if quantity in ("omega", "nu"):
        slots = slots + layout.coordinates
    rest = surface.rest if quantity == "theta" else 0.0
    return slots if surface.count > 1 else int(slots[0]), rest, surface.count
