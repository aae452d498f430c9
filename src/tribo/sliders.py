"""Values of a scene that a reader of a page changes: their ranges, and the runs at them."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.model.binding import bound, check_together
from tribo.model.parameters import value_of, with_values
from tribo.model.scene import Scene
from tribo.result import Result
from tribo.simulation import simulate
from tribo.validation import is_list, must_be, number, one_of
from tribo.viewer.contents import MOST_ARROWS, contents
from tribo.viewer.html import document

if TYPE_CHECKING:
    from tribo.viewer.widget import Player

# Values of a slider in a page without Python, by the number of sliders; more than that are refused.
POINTS = {1: 41, 2: 11, 3: 5}
# Most runs of a page without Python.
MOST_RUNS = 1000
# Most force evaluations of a run that a page asks for, which end it within some seconds.
MOST_EVALUATIONS = 2e6


@dataclass(frozen=True)
class Slider:
    """A value of a scene that can be changed: in a range, or to one of some `values`."""

    # As for tribo.model.parameters.with_values; several keys with commas between them change
    # together, and their values are words.
    key: str
    value: Any  # at the beginning
    low: float = 0.0
    high: float = 0.0
    values: tuple[Any, ...] | None = None
    rows: Mapping[str, tuple[Any, ...]] = field(default_factory=dict)  # word -> a value of each key

    def settings(self, value: Any) -> dict[str, Any]:
        """The values of the keys of the scene."""
        if not self.rows:
            return {self.key: value}
        return dict(zip(self.key.split(","), self.rows[value], strict=True))

    def as_json(self) -> dict[str, Any]:
        """What the page needs to know."""
        if self.values is not None:
            return {"key": self.key, "value": self.value, "values": list(self.values)}
        return {"key": self.key, "value": self.value, "low": self.low, "high": self.high}

    def checked(self, value: object) -> Any:
        """A value that was asked for.  Raises InputError outside of what can be chosen."""
        if self.values is not None:
            return one_of(self.key, value, self.values)
        found = number(self.key, value)
        if not self.low <= found <= self.high:
            raise must_be(self.key, f"from {self.low:g} to {self.high:g}", found)
        return found

    def on_a_grid(self, points: int) -> Slider:
        """The same with a list of evenly spaced values in place of a range."""
        if self.values is not None:
            return self
        spaced = np.linspace(self.low, self.high, points)
        values = [float(f"{value:.12g}") for value in spaced]
        # The value of the scene is one of them, in place of the nearest.
        values[int(np.argmin(np.abs(spaced - self.value)))] = self.value
        return replace(self, values=tuple(values))


def sliders_of(scene: Scene, given: Mapping[Any, Any]) -> list[Slider]:
    """The sliders of a scene: key -> (low, high), or a list of words or of other values.

    Keys with commas between them, or a tuple of keys, change together: a list of rows.  Raises
    InputError if a range is none, the scene cannot have one of its ends or values, or two keys
    exclude each other.
    """
    named = {",".join(key) if isinstance(key, tuple) else str(key): v for key, v in given.items()}
    check_together(scene, bound(scene, {one: None for key in named for one in key.split(",")}))
    return [
        _joined(scene, key, values) if "," in key else _slider(scene, key, values)
        for key, values in named.items()
    ]


def _joined(scene: Scene, key: str, given: object) -> Slider:
    """A slider of several keys, whose values are rows with a value of each."""
    keys = key.split(",")
    rows = dict[str, tuple[Any, ...]]()
    if not is_list(given) or len(given) < 2:
        raise must_be(key, "a list of rows, as [0.5, 40], [0.25, 80]", given)
    for row in given:
        if not is_list(row) or len(row) != len(keys):
            raise must_be(key, f"a list of rows of {len(keys)} values", row)
        with_values(scene, dict(zip(keys, row, strict=True)))
        rows[", ".join(f"{each:g}" if _is_number(each) else str(each) for each in row)] = tuple(row)
    present = tuple(value_of(scene, each) for each in keys)
    first = next((word for word, row in rows.items() if row == present), next(iter(rows)))
    return Slider(key, first, values=tuple(rows), rows=rows)


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _slider(scene: Scene, key: str, given: object) -> Slider:
    """The slider of a key, from a range (low, high) or a list of values that the scene accepts."""
    if not is_list(given) or len(given) < 2:
        raise must_be(key, "a range (low, high), or a list of values", given)
    for each in given:
        with_values(scene, {key: each})
    surface, _, rest = key.partition(".")
    present = value_of(scene, f"{scene.surfaces[0].name}.{rest}" if surface == "*" else key)
    if len(given) == 2 and isinstance(given, tuple):
        low, high = (number(key, each) for each in given)
        if not low < high:
            raise must_be(key, "a range whose first number is the lower one", given)
        start = min(max(float(present), low), high) if _is_number(present) else low  # type: ignore[arg-type]
        return Slider(key, start, low, high)
    values = tuple(given)
    return Slider(key, present if present in values else values[0], values=values)


def shown(scene: Scene, bath: bool = False) -> Scene:
    """The scene with the series that a page draws: forces of few asperites, heat of baths."""
    series = list(scene.output.series)
    if bath:
        series.append("oscillators")
    if scene.output.keep is None:
        series += ["forces"] if scene.count <= MOST_ARROWS else []
        series += ["energies"] if any(surface.bath for surface in scene.surfaces) else []
    return replace(scene, output=replace(scene.output, series=tuple(series)))


class Playing:
    """A scene whose runs a page asks for, and the sliders of the values that change."""

    def __init__(self, scene: Scene, sliders: Sequence[Slider]) -> None:
        given = scene.numerics.max_evaluations or MOST_EVALUATIONS
        numerics = replace(scene.numerics, max_evaluations=min(given, MOST_EVALUATIONS))
        self._scene = replace(shown(scene), numerics=numerics)
        self._sliders = {slider.key: slider for slider in sliders}

    def run(self, values: object) -> dict[str, Any]:
        """What the page shows of the run at some values.

        Raises InputError if there is another key than the declared ones, or a value out of its
        range, or the scene with these values cannot be run.
        """
        return contents(self.simulated(values))

    def simulated(self, values: object) -> Result:
        """The run at some values.  Raises InputError as `run`."""
        if not isinstance(values, dict):
            raise must_be("values", "a value for each key", values)
        known = self._sliders
        checked: dict[str, Any] = {}
        for key, value in values.items():
            slider = known[one_of(str(key), key, known)]
            checked |= slider.settings(slider.checked(value))
        return simulate(with_values(self._scene, checked), progress=False)

    def source(self) -> dict[str, Any]:
        """What the page begins with: the sliders, and the run at their first values.

        All words that can be chosen are run before, so that they are compiled.
        """
        first = {key: slider.value for key, slider in self._sliders.items()}
        for slider in self._sliders.values():
            for value in slider.values or ():
                if isinstance(value, str) and value != slider.value:
                    self.run(first | {slider.key: value})
        sliders = [slider.as_json() for slider in self._sliders.values()]
        return {"run": self.run(first), "sliders": sliders}


def grid_page(scene: Scene, sliders: Sequence[Slider], bath: bool = False) -> str:
    """The page, without Python, with the runs of every combination of the values of sliders.

    Raises InputError if there are more than three sliders or 1000 runs, or a run cannot be made.
    """
    if len(sliders) not in POINTS:
        raise must_be("--slider", f"given at most {max(POINTS)} times", len(sliders))
    grid = [slider.on_a_grid(POINTS[len(sliders)]) for slider in sliders]
    combinations = list(itertools.product(*(slider.values or () for slider in grid)))
    if len(combinations) > MOST_RUNS:
        raise must_be("--slider", f"at most {MOST_RUNS} combinations", len(combinations))
    recorded = shown(scene, bath)
    runs = []
    for chosen in combinations:
        values: dict[str, Any] = {}
        for slider, value in zip(grid, chosen, strict=True):
            values |= slider.settings(value)
        runs.append(contents(simulate(with_values(recorded, values), progress=False), bath))
    first = runs[combinations.index(tuple(slider.value for slider in grid))]
    return document({"run": first, "runs": runs, "sliders": [s.as_json() for s in grid]})


def play(scene: Scene, sliders: Mapping[str, Any]) -> Player:
    """Show a scene in a notebook with sliders that simulate it again.

    Parameters
    ----------
    scene : Scene
        The scene.
    sliders : mapping
        Key -> range (low, high), or a list of values: ``{"upper.velocity": (0.1, 2.0)}`` or
        ``{"upper.drive": ["forced", "free"]}``.

    Returns
    -------
    anywidget.AnyWidget
        The page.  A notebook that is exported shows the :func:`live` page with these sliders
        instead, or the first run where the scene cannot go into one.

    Raises
    ------
    InputError
        If a key or a value does not suit the scene, or anywidget is not installed.
    """
    from tribo.live_pages.page import live
    from tribo.viewer.widget import Player

    own = sliders_of(scene, sliders)
    controls = {each.key: None if each.values else (each.low, each.high) for each in own}
    playing = Playing(scene, own)
    return Player(playing.source(), playing.run, lambda: live(scene, controls))
