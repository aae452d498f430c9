"""Numbers of potentials by dotted keys, also of the parts of sums and of scaled potentials.

    strength, cutoff, at_cutoff     parameters of a potential, and of its cutoff
    first.KEY, second.KEY           of the parts of a sum; of three, second.first and second.second
    factor, of.KEY                  of a scaled potential

Those of a user's class whose fields are potentials have the names of these fields.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tribo.plugins.classes import instance
from tribo.potentials.tables import (
    CUTOFF_KEYS,
    MADE,
    class_named,
    from_table,
    with_settings,
    without_cutoff,
)
from tribo.validation import POSITIVE, InputError, inside, known_keys, number

# The field of a scaled potential, whose name in keys is that of a kind, and the word in its place.
POTENTIAL = "potential"
OF = "of"


def values_by_key(potential: Any) -> dict[str, Any]:
    """The parameters of a potential or field, with those of its cutoff and of its parts."""
    inner, found = without_cutoff(potential)
    if not hasattr(inner, "_asdict"):
        return found
    parts = _parts(inner)
    found |= {k: v for k, v in inner._asdict().items() if k not in parts.values()}
    for word, name in parts.items():
        own = values_by_key(getattr(inner, name))
        found |= {f"{word}.{key}": value for key, value in own.items()}
    return found


def _parts(potential: Any) -> dict[str, str]:
    """Words in keys of the fields of a potential that are potentials -> their names."""
    fields = [name for name, value in potential._asdict().items() if hasattr(value, "_fields")]
    return {OF if name == POTENTIAL else name: name for name in fields}


def with_values(potential: Any, own: Mapping[str, Any]) -> Any:
    """A potential with other parameters or cutoff, reduced from the same fraction of it.

    Raises InputError.
    """
    if POTENTIAL in own:  # another kind, which keeps the parameters that both kinds have
        kind = None if own[POTENTIAL] in (*MADE, "ase") else class_named(own[POTENTIAL], Path())
        known = (*getattr(kind, "_fields", ()), *CUTOFF_KEYS) if kind else ()
        kept = {key: value for key, value in values_by_key(potential).items() if key in known}
        return from_table(kept | dict(own), Path())
    if not hasattr(potential, "_asdict"):
        raise InputError(next(iter(own)), "is not a known key; a calculator has none")
    cutoff = {key: value for key, value in own.items() if key in CUTOFF_KEYS}
    rest = {key: value for key, value in own.items() if key not in CUTOFF_KEYS}
    potential, present = without_cutoff(potential)
    if "cutoff" in cutoff and "switch_from" in present:
        ratio = number("cutoff", cutoff["cutoff"], POSITIVE, "length") / present["cutoff"]
        present["switch_from"] *= ratio
    if "at_cutoff" in cutoff:
        present.pop("switch_from", None)
    if rest:
        potential = _with_parameters(potential, rest)
    return with_settings(potential, present | cutoff)


def _with_parameters(potential: Any, own: Mapping[str, Any]) -> Any:
    """A potential without a cutoff, with other numbers of its own and of its parts."""
    fields = potential._asdict()
    parts = _parts(potential)
    of_parts: dict[str, dict[str, Any]] = {}
    for key, value in own.items():
        part, dot, rest = key.partition(".")
        if dot and part in parts:
            of_parts.setdefault(part, {})[rest] = value
        elif key in parts:
            raise InputError(key, f'is a potential; give its numbers, as "{key}.KEY"')
        else:
            fields |= known_keys({key: value}, values_by_key(potential))
    for part, values in of_parts.items():
        with inside(part):
            fields[parts[part]] = with_values(fields[parts[part]], values)
    return instance(type(potential), fields)
