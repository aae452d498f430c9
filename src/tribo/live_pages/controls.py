"""The controls of a page: which values have sliders, from where to where, and under which words."""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from tribo.live_pages.keys import Key, numbers_at
from tribo.model.keys import INTERACTION
from tribo.model.parameters import with_values
from tribo.model.scene import Scene
from tribo.model.toml_errors import toml_problem
from tribo.validation import InputError, as_path, inside, is_list, known_keys, must_be, number

# Drives that a pair's module has.
DRIVES = ("forced", "free", "bars")
# Words for keys, by what follows the name of a surface.
LABELS = {
    "duration": "duration",
    "interaction.strength": "strength of the force",
    "interaction.epsilon": "depth of the potential",
    "interaction.D": "depth of the potential",
    "interaction.A": "strength of the force",
    "interaction.height": "strength of the force",
    "bob.1": "gap between the bobs",
    "velocity": "velocity",
    "asperite.kappa": "spring stiffness \N{GREEK SMALL LETTER KAPPA}",
    "asperite.m1": "bob mass m\N{SUBSCRIPT ONE}",
    "asperite.m2": "bar mass m\N{SUBSCRIPT TWO}",
    "asperite.length": "rod length",
    "drive": "drive",
    "drive.stiffness": "stiffness of the pulling spring",
    "drive.speed": "speed of the stage",
    "drive.load": "load",
}
# Parameters of potentials that are their strength, the most telling one first.
STRENGTHS = ("strength", "epsilon", "D", "height", "A", "factor")
# Parameters of asperites with a slider, which sets both surfaces.
OF_BOTH = ("asperite.kappa", "asperite.m1", "asperite.m2", "asperite.length")
# Numbers of drives that have sliders, at most.
MOST_OF_DRIVES = 4
# Ranges in units of the present value.
RANGES = {
    "asperite.kappa": (0.1, 5.0),
    "asperite.m1": (0.2, 5.0),
    "asperite.m2": (0.2, 5.0),
    "asperite.length": (0.5, 2.0),
    "velocity": (0.1, 4.0),
    "duration": (0.25, 5.0),
}
# Those of other values; of 0, from minus one to one.
OTHERS = (0.0, 3.0)
# Keys that a mapping of controls may have beside keys of the scene.
WORDS = ("title", "introduction", "questions", "panel")
# Keys of the table of a control, and of that of potentials.
OF_CONTROL = ("range", "label", "values", "own")
# Panels of a page, one of which `panel` names: that which the page opens with.
PANELS = ("End value", "Energy", "Numbers", "Many starts", "Files")


class Choice(NamedTuple):
    """A key with words for values: each sets some numbers."""

    key: str
    value: str
    words: dict[str, list[tuple[int, float]]]


@dataclass(frozen=True)
class Control:
    """A slider of a page."""

    key: str
    label: str
    low: float = 0.0
    high: float = 0.0
    value: Any = None


@dataclass(frozen=True)
class Laws:
    """Potentials among which a reader can choose: the words for the scene's own, and others."""

    label: str
    own: str
    scenes: dict[str, Scene]  # words -> the scene with that potential


@dataclass(frozen=True)
class Controls:
    """All that a reader can change: keys with their numbers, and those that have controls."""

    keys: tuple[Key, ...]
    choices: tuple[Choice, ...]
    shown: tuple[Control, ...]
    words: dict[str, str]
    laws: Laws | None = None


def controls_of(
    scene: Scene,
    given: object,
    found: list[Key],
    has_choices: bool = True,
    are_its_own: bool = True,
) -> Controls:
    """The controls of a scene: the usual ones, or those that a mapping or a TOML file gives.

    The keys are those that were `found`; the drives of a pair are choices.  Raises InputError for
    an unknown key or a range that is none.  Ranges contain the values of the scene if they
    `are_its_own`, and not those of the scene with another potential.
    """
    keys = tuple(found)
    choices = tuple(_choices(scene) if has_choices else ())
    table = _table(given)
    words = {name: table.pop(name) for name in WORDS if name in table}
    for name, text in words.items():
        if not isinstance(text, str):
            raise must_be(f"controls.{name}", "text in quotes", text)
    if words.get("panel", PANELS[0]) not in PANELS:
        raise must_be("controls.panel", f"one of {', '.join(PANELS)}", words["panel"])
    laws = _laws(scene, table.pop(INTERACTION, None))
    wanted = table or _usual(scene, keys, choices)
    known = {key.key: key.value for key in keys} | {each.key: each.value for each in choices}
    shown = tuple(_control(scene, known, key, value, are_its_own) for key, value in wanted.items())
    return Controls(keys, choices, shown, words, laws)


def of_other_law(given: object, keys: list[Key]) -> dict[str, Any]:
    """The mapping of controls for the same page with another potential, which has these keys.

    Parameters that the potential does not have are left out.
    """
    table = _table(given)
    table.pop(INTERACTION, None)
    known = {key.key for key in keys}
    return {
        key: value
        for key, value in table.items()
        if not key.startswith(f"{INTERACTION}.") or key in known
    }


def _laws(scene: Scene, given: object) -> Laws | None:
    """The potentials that a reader can choose.  Raises InputError for one that is none."""
    if given is None:
        return None
    if not isinstance(given, Mapping):
        raise must_be("controls.interaction", "a table with `values`", given)
    table = known_keys(_unquoted(INTERACTION, given), ("values", "label", "own"), ("values",))
    values = table["values"]
    if not isinstance(values, Mapping) or not values:
        raise must_be("controls.interaction.values", "potentials by the words for them", values)
    own = str(table.get("own") or type(scene.interactions[0].potential).__name__)
    if own in values:
        raise must_be("controls.interaction.values", "without the scene's own", own)
    scenes = {}
    for word, potential in values.items():
        with inside(f"controls.interaction.{word}"):
            scenes[str(word)] = with_values(scene, {INTERACTION: potential})
    return Laws(str(table.get("label") or "law of force"), own, scenes)


def _table(given: object) -> dict[str, Any]:
    """The mapping, or that of a TOML file, whose tables of surfaces may be nested."""
    if given is None:
        return {}
    if isinstance(given, (str, Path)):
        import tomllib

        try:
            text = as_path(given).read_text(encoding="utf-8")
        except (OSError, ValueError) as error:
            raise InputError("controls", f"cannot be read: {error}") from None
        try:
            return tomllib.loads(text)
        except ValueError as error:
            raise InputError("controls", f"{given} {toml_problem(error, text)}") from None
    if not isinstance(given, Mapping):
        raise must_be("controls", "a mapping of keys, or the name of a TOML file", given)
    return dict(given)


def _usual(scene: Scene, keys: tuple[Key, ...], choices: tuple[Choice, ...]) -> dict[str, Any]:
    """The keys of the usual controls, each with None."""
    known = {key.key for key in keys} | {choice.key for choice in choices}
    upper = scene.surfaces[0].name
    moving = next((s.name for s in scene.surfaces if s.velocity[0] != 0.0), upper)
    strength = next(
        (f"interaction.{each}" for each in STRENGTHS if f"interaction.{each}" in known),
        next((each for each in known if each.startswith("interaction.")), None),
    )
    wanted = [strength, f"{upper}.bob.1", f"{moving}.velocity"]
    for name in OF_BOTH:
        own = [key for key in keys if key.key.endswith(f".{name}")]
        is_one = len(own) == len(scene.surfaces) and len({key.value for key in own}) == 1
        wanted += [f"*.{name}"] if is_one else [key.key for key in own[:1]]
    wanted += [key.key for key in keys if ".drive." in key.key][:MOST_OF_DRIVES]
    wanted += [f"{upper}.drive", "duration"]
    return {key: None for key in wanted if key is not None and _plain(scene, key)[0] in known}


def _plain(scene: Scene, key: str) -> list[str]:
    """A key, or those of all surfaces that a key with * in place of a name stands for."""
    if not key.startswith("*."):
        return [key]
    return [surface.name + key[1:] for surface in scene.surfaces]


def _control(
    scene: Scene, known: Mapping[str, Any], key: str, given: Any, is_own: bool = True
) -> Control:
    """A control of a key: with None the usual range, else a range or a table of its own.

    A range that is given contains the value, if that `is_own` of the scene of the page.
    """
    every = _plain(scene, key)
    plain = every[0]
    if not all(each in known for each in every):
        if isinstance(given, Mapping):
            _unquoted(key, given)
        near = difflib.get_close_matches(key, [*known, *WORDS, INTERACTION], n=1)
        hint = f'did you mean "{near[0]}"?' if near else "`tribo play` changes all values"
        problem = "has no control: it is no number of this scene that a page can change; "
        raise InputError(f"controls.{key}", problem + hint)
    value = known[plain]
    rest = _rest(scene, plain)
    label = LABELS.get(rest, key)
    own = dict(given) if isinstance(given, Mapping) else {"range": given}
    own = known_keys(own, ("range", "label"))
    label = str(own.get("label") or label)
    if isinstance(value, str):
        return Control(key, label, value=value)
    bounds = own.get("range")
    if bounds is None:
        low, high = _usual_range(scene, rest, plain, value)
    elif is_list(bounds) and len(bounds) == 2:
        low, high = (number(f"controls.{key}", each) for each in bounds)
    else:
        raise must_be(f"controls.{key}", "a range [low, high]", bounds)
    if not low < high:
        raise must_be(f"controls.{key}", "a range whose first number is the lower one", bounds)
    if bounds is not None and is_own and not low <= value <= high:
        wanted = f"a range that contains the scene's value {value:g}"
        raise must_be(f"controls.{key}", wanted, bounds)
    for end in (low, high):
        with_values(scene, {key: end})
    return Control(key, label, low, high, value)


def _unquoted(key: str, table: Mapping[str, Any]) -> dict[str, Any]:
    """A table of a control; raises InputError if a key with points was given without quotes."""
    for inner, value in table.items():
        if inner not in OF_CONTROL and (is_list(value) or isinstance(value, Mapping)):
            whole = f'"{key}.{inner}"'
            problem = f"has no control; a key with points needs quotes in a TOML file, as {whole}"
            raise InputError(f"controls.{key}", problem)
    return dict(table)


def _rest(scene: Scene, key: str) -> str:
    """What follows the name of a surface in a key."""
    name, _, rest = key.partition(".")
    return rest if any(surface.name == name for surface in scene.surfaces) else key


def _usual_range(scene: Scene, rest: str, key: str, value: float) -> tuple[float, float]:
    """The ends of a slider that has none given, where the scene allows the lower one."""
    if rest == "bob.1":
        rod = float(scene.surfaces[0].each["length"][0])
        return _round(value - 0.5 * rod), _round(value + rod)
    if value == 0.0:
        low, high = -1.0, 1.0
    else:
        low, high = sorted(value * part for part in RANGES.get(rest, OTHERS))
        if rest.startswith("interaction.") and rest not in RANGES:
            low = -OTHERS[1] * abs(value)
            high = OTHERS[1] * abs(value)
    low = _round(low)
    high = _round(high)
    try:
        with_values(scene, {key: low})
    except InputError:
        low = 0.0 if _allowed(scene, key, 0.0) else _round(0.1 * abs(value))
    return low, high


def _allowed(scene: Scene, key: str, value: float) -> bool:
    try:
        with_values(scene, {key: value})
    except InputError:
        return False
    return True


def _round(value: float) -> float:
    """To two significant digits."""
    return float(f"{value:.2g}")


def _choices(scene: Scene) -> list[Choice]:
    """The drives of each surface: what each sets."""
    found = []
    before = numbers_at(scene)
    assert before is not None
    for surface in scene.surfaces:
        key = f"{surface.name}.drive"
        words = {}
        every = {word: _numbers(scene, key, word) for word in DRIVES}
        known = [each for each in every.values() if each is not None]
        places = []
        for place in range(before.size):
            if len({float(each[place]) for each in known}) > 1:
                places.append(place)
        for word, numbers in every.items():
            if numbers is not None:
                words[word] = [(place, float(numbers[place])) for place in places]
        kind = type(surface.drive).__name__.lower().replace("drivenbars", "bars")
        if kind in words:
            found.append(Choice(key, kind, words))
    return found


def _numbers(scene: Scene, key: str, word: str) -> Any:
    try:
        return numbers_at(with_values(scene, {key: word}))
    except InputError:
        return None


def least(scene: Scene, key: Key) -> tuple[float, bool]:
    """The smallest value of a key, and whether it may have that; minus infinity without one."""
    if _allowed(scene, key.key, -abs(key.value) - 1.0):
        return -math.inf, True
    return 0.0, _allowed(scene, key.key, 0.0)
