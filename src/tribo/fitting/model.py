"""The series of a scene at the times of a measurement, for many values of parameters at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from tribo.ensembles.members import is_random
from tribo.ensembles.request import SAMPLES
from tribo.fitting.data import Trace
from tribo.model.scene import Scene
from tribo.sweeps import sweep
from tribo.validation import InputError, is_list, number

# Tries of a step, each half of the one before.
HALVINGS = 12
# Samples between which the first step that is tried fits so often.
STEPS = 4.0


class Box(NamedTuple):
    """The ranges of the parameters."""

    keys: tuple[str, ...]
    low: np.ndarray  # (parameters,)
    high: np.ndarray  # (parameters,)

    @classmethod
    def of(cls, ranges: object) -> Box:
        """The box of a mapping from keys to (low, high).  Raises InputError."""
        if not isinstance(ranges, Mapping) or not ranges:
            raise InputError(
                "ranges", 'must map keys to (low, high), as {"field.amplitude": (0.1, 0.4)}'
            )
        bounds = []
        for key, pair in ranges.items():
            if not is_list(pair) or len(pair) != 2:
                raise InputError(f"ranges.{key}", "must be (low, high)")
            low, high = (number(f"ranges.{key}", each) for each in pair)
            if not low < high:
                raise InputError(
                    f"ranges.{key}", f"must grow from low to high, got {low:g}, {high:g}"
                )
            bounds.append((low, high))
        return cls(tuple(map(str, ranges)), *np.array(bounds).T)

    def values(self, parts: np.ndarray) -> np.ndarray:
        """The values of parts of the ranges between 0 and 1, (..., parameters)."""
        return np.asarray(self.low + parts * (self.high - self.low))


class Modelled(NamedTuple):
    """Series of several candidates, NaN of those that have none."""

    values: np.ndarray  # (candidates, times)
    error: np.ndarray  # (candidates, times) standard errors of means over members, else 0


class Model:
    """Series of a scene at the times of a trace, as functions of its parameters."""

    def __init__(
        self,
        scene: Scene,
        trace: Trace,
        quantity: str,
        box: Box,
        members: int | None,
        settings: Mapping[str, Any],
    ) -> None:
        """Check what can be checked before the first run.  Raises InputError."""
        if trace.t[-1] > scene.duration * (1.0 + 1e-9):
            raise InputError(
                "data.t",
                f"must end within the scene's duration, {scene.duration:g}, got {trace.t[-1]:g}",
            )
        end = min(scene.duration, float(trace.t[-1]))
        times = [t for t in trace.t.tolist() if t < end]
        output = replace(scene.output, times=times or None, keep=None, series=())
        self.scene = replace(scene, duration=end, output=output)
        self.random = is_random(scene)
        if self.random and members is None:
            raise InputError(
                "members",
                "is missing: the scene has noise, so that means over members are fitted; give the "
                "number of members",
            )
        if members is not None and not self.random:
            raise InputError("members", "cannot be given: nothing in the scene is random")
        self._trace = trace
        self._quantity = quantity
        self._box = box
        self._members = members
        self._settings = dict(settings)
        self.runs = 0  # points that have been simulated

    def __call__(self, parts: np.ndarray) -> Modelled:
        """The series at points of the unit box, (points, parameters)."""
        return self._run(parts, self._settings)

    def _run(self, parts: np.ndarray, settings: Mapping[str, Any]) -> Modelled:
        """Run each distinct row of parts of the box, (candidates, keys), once."""
        parts = np.atleast_2d(parts)
        unique, places = np.unique(parts, axis=0, return_inverse=True)
        keys = self._box.keys
        rows = self._box.values(unique)
        swept: dict[Any, Sequence[Any]] = {keys: [tuple(row) for row in rows.tolist()]}
        if len(keys) == 1:
            swept = {keys[0]: rows[:, 0].tolist()}
        data = sweep(
            self.scene,
            swept,
            self._members,
            keep=[self._quantity],
            at=SAMPLES,
            progress=False,
            **settings,
        )
        self.runs += len(rows)
        name = f"{self._quantity}_mean" if self._members else self._quantity
        values = self._at_times(data[name])
        error = np.zeros_like(values)
        if self._members:
            from tribo.results.averages import student

            half_width = self._at_times(data[f"{self._quantity}_half_width"])
            error = half_width / student(self._members - 1)
        places = places.reshape(-1)
        return Modelled(values[places], error[places])

    def _at_times(self, table: Any) -> np.ndarray:
        """Values (points, times) at the times of the trace."""
        found = table.values.reshape(*table.shape[:2], -1)
        if found.shape[2] != 1:
            raise InputError(
                "quantity",
                f'must have one value at a time; "{self._quantity}" has {found.shape[2]}',
            )
        recorded = self.scene.times
        # The scene records these times; the last one may be later than its end by round-off.
        at = np.minimum(np.searchsorted(recorded, self._trace.t), recorded.size - 1)
        return np.asarray(found[:, at, 0], float)

    def with_step(self, parts: np.ndarray, tolerance: float) -> Model:
        """The same with the longest step that changes its series by a tolerance at most.

        Each candidate would otherwise take a search for settings of its own.  Where no such step
        is found, the accuracy of single runs stays.
        """
        given = {name: self._settings.get(name) for name in ("accuracy", "method", "step")}
        numerics = self.scene.numerics
        if self.random or any(given.values()) or numerics.step is not None:
            return self
        length = float(np.median(np.diff(self._trace.t))) / STEPS
        coarse: np.ndarray | None = None
        for _ in range(HALVINGS):
            settings = self._settings | {"method": "verlet", "step": length}
            try:
                fine = self._run(parts, settings).values
            except InputError:  # too long, or no scene for this method
                length *= 0.5
                continue
            change = np.inf if coarse is None else float(np.max(np.abs(fine - coarse)))
            if change <= tolerance:  # not where either has no value
                self._settings = settings
                return self
            coarse = fine
            length *= 0.5
        return self
