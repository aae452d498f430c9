"""Which keys may stand together where values are bound to keys.

Values are bound by --set, `vary`, `sweep`, initial values of a run and sliders.  All of them take
the same keys and refuse the same: a value that is given twice, keys of which one replaces the
other, and a setting beside the argument that replaces it.
"""

from collections.abc import Iterable, Mapping
from typing import TypeVar

from tribo.model.scene import Scene
from tribo.validation import InputError

Value = TypeVar("Value")

# In place of the name of a surface: all surfaces.
EVERY = "*"
# Swings and rates of all pendulums of a surface, drawn together.
SWING_STATE = "swing_state"
# Values of a surface -> others of it that say the same.
EXCLUSIVE = {"swing": ("theta",), SWING_STATE: ("theta", "swing", "omega", "temperature")}
# Settings of a scene -> arguments of runs that replace them.
REPLACED_BY = {
    "numerics.accuracy": ("accuracy", "step"),
    "numerics.step": ("accuracy", "step"),
    "numerics.method": ("method",),
    "numerics.allow_unresolved": ("allow_unresolved",),
    "output.keep": ("keep",),
    "output.samples": ("samples",),
    "output.times": ("samples",),
}


def bound(scene: Scene, values: Mapping[str, Value]) -> dict[str, Value]:
    """The values with a key of each surface in place of keys of all surfaces, as "*.theta".

    A key of one surface comes before that of all.  Raises InputError if a value is given twice, as
    by "upper.initial.theta" and "upper.theta", or a key of all surfaces is left without one.
    """
    plain: dict[str, Value] = {}
    for key, value in values.items():
        name = _plain(str(key))
        if name in plain:
            raise InputError(str(key), f"is given twice, also as {name}; give it once")
        plain[name] = value
    found: dict[str, Value] = {}
    for key, value in plain.items():
        name, _, rest = key.partition(".")
        if name != EVERY or rest == SWING_STATE:  # drawn for all surfaces together
            found[key] = value
            continue
        each = [f"{surface.name}.{rest}" for surface in scene.surfaces]
        left = [own for own in each if own not in plain]
        if not left:
            raise InputError(key, "has no effect; each surface is given a value of its own")
        found |= dict.fromkeys(left, value)
    return found


def check_together(scene: Scene, keys: Iterable[str]) -> None:
    """Raise InputError about two keys, as :func:`bound` gives them, that exclude each other."""
    given: dict[str, str] = {}  # key of one surface -> as it is given
    for key in keys:
        name, _, rest = key.partition(".")
        names = [surface.name for surface in scene.surfaces] if name == EVERY else [name]
        given |= {f"{each}.{rest}": key for each in names}
    for each, key in given.items():
        name, _, rest = each.partition(".")
        for other in EXCLUSIVE.get(rest, ()):
            if f"{name}.{other}" in given:
                problem = f"cannot go with {given[f'{name}.{other}']}; give one or the other"
                raise InputError(key, problem)


def check_apart(scene: Scene, one: Iterable[str], other: Iterable[str], how: str = "swept") -> None:
    """Raise InputError about one of some keys, as :func:`bound` gives them, beside others.

    Other keys say how their values are given: they are "swept", or "set".
    """
    one = list(one)
    other = list(other)
    for key in one:
        if key in other:
            raise InputError(key, f"is {how} too; give it once")
    check_together(scene, [*other, *one])


def check_arguments(values: Mapping[str, object], arguments: Mapping[str, object]) -> None:
    """Raise InputError about a key whose value an argument replaces, if that is given."""
    keys = list(values)
    for key, value in values.items():
        if isinstance(value, Mapping):
            keys += [f"{key}.{inner}" for inner in value]
    for key in keys:
        for name in REPLACED_BY.get(key, ()):
            if arguments.get(name) not in (None, False):
                problem = f"cannot go with {name}, which replaces it; give one or the other"
                raise InputError(key, problem)


def _plain(key: str) -> str:
    """A key of a surface without the word "initial", which keys may leave out."""
    name, _, rest = key.partition(".")
    rest = rest.removeprefix("initial.")
    return f"{name}.{rest}" if rest else name
