"""Potentials as tables of scene files: a name or an expression, and numbers."""

import difflib
import functools
import operator
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from tribo.plugins import classes as plugins
from tribo.plugins.unloaded import left
from tribo.potentials import charges, exponentials, from_ase, inverse_powers, soft_cores
from tribo.potentials.combined import Scaled, Sum
from tribo.potentials.dimers import from_dimer
from tribo.potentials.expression import class_of, is_expression
from tribo.potentials.potential import AT_CUTOFF, Potential, as_potential, complete
from tribo.potentials.spline import Table, from_csv, from_points
from tribo.validation import InputError, inside, is_list, known_keys, must_be, shortened

# The files of formulas.
FORMULAS = (charges, exponentials, inverse_powers, soft_cores)


def _with_keys() -> dict[str, type]:
    """The classes in the files of formulas that have a key of their own."""
    found: dict[str, type] = {}
    for file in FORMULAS:
        for each in vars(file).values():
            if isinstance(each, type) and "_key" in vars(each):
                found[vars(each)["_key"]] = each
    return found


# The built-in potentials, by their names in scene files.
BUILT_IN = _with_keys()
# Keys of a cutoff.
CUTOFF_KEYS = ("cutoff", "at_cutoff", "switch_from")


def named(name: str, /, **parameters: object) -> Potential:
    """A potential by its name.

    Parameters
    ----------
    name : str
        The name of a built-in potential as in scene files, ``file.py:Class`` or
        ``package.module:Class`` of a user's own, or an expression in r.
    **parameters : float
        Its parameters; also `cutoff`, `at_cutoff` and `switch_from`.

    Raises
    ------
    InputError
        If there is no such potential, or a parameter is missing or invalid.
    """
    return from_table({"potential": name} | parameters, Path())


def from_table(table: Any, folder: Path) -> Any:
    """The potential that a table of a scene file describes, with its parameters and cutoff."""
    parameters = known_keys(table, table, ["potential"])
    name = parameters.pop("potential")
    stand_in = left(name, parameters)
    if stand_in is not None:
        return stand_in
    if name == "ase":
        return from_ase.from_table(parameters)
    cutoff = {key: parameters.pop(key) for key in CUTOFF_KEYS if key in parameters}
    if isinstance(name, str) and name in MADE:
        potential = MADE[name](parameters, folder)
    else:
        potential = as_potential(plugins.instance(class_named(name, folder), parameters))
    return with_settings(potential, cutoff)


def with_settings(potential: Potential, cutoff: dict[str, Any]) -> Potential:
    """The potential with the cutoff that some of `CUTOFF_KEYS` describe; unchanged without any."""
    if cutoff and "cutoff" not in cutoff:
        raise InputError(next(iter(cutoff)), "needs a cutoff")
    return potential.with_cutoff(**cutoff) if cutoff else potential


def without_cutoff(potential: Any) -> tuple[Any, dict[str, Any]]:
    """The potential without its cutoff, and the settings of that."""
    for word, kind in AT_CUTOFF.items():
        if type(potential) is kind:
            settings = potential._asdict() | {"at_cutoff": word}
            return settings.pop("potential"), settings
    return potential, {}


def class_named(name: object, folder: Path) -> type:
    """The class of a built-in potential, of one in a file or a module, or of an expression."""
    if not isinstance(name, str):
        raise must_be("potential", "a name", name)
    if plugins.is_named(name):
        return complete(plugins.class_named("potential", name, folder))  # type: ignore[no-any-return]
    if name in BUILT_IN:
        return BUILT_IN[name]
    if is_expression(name):
        return complete(class_of(name))
    names = (*BUILT_IN, *MADE, "ase")
    near = _nearest(name, names)
    if near:
        raise InputError("potential", f'{name!r} is not a known name; did you mean "{near}"?')
    known = shortened(f'"{known}"' for known in names)
    raise must_be("potential", f'{known}, "file.py:Class" or an expression in r', name)


def _nearest(name: str, names: Sequence[str]) -> str:
    """The name that is most like another one, or has it as its initials; empty if none does."""
    word = "-".join(name.lower().replace("_", " ").split())
    initials = [each for each in names if "".join(part[0] for part in each.split("-")) == word]
    return next(iter(initials or difflib.get_close_matches(word, names, n=1)), "")


def as_table(potential: Any) -> dict[str, Any]:
    """The table of a scene file that `from_table` reads."""
    if isinstance(potential, from_ase.Live):
        return {"potential": "ase"} | from_ase.as_table(potential)
    inner, cutoff = without_cutoff(potential)
    if cutoff:
        return as_table(inner) | cutoff
    if type(potential) is Sum:
        return {"potential": "sum", "of": [as_table(part) for part in _parts(potential)]}
    if type(potential) is Scaled:
        of = as_table(potential.potential)
        return {"potential": "scaled", "factor": potential.factor, "of": of}
    if type(potential) is Table:
        points = {"r": potential.r.tolist(), "energy": potential.values.tolist()}
        return {"potential": "table", "error": potential.error} | points
    name = getattr(potential, "expression_text", None) or plugins.name_of(potential, BUILT_IN)
    table: dict[str, Any] = potential._asdict()
    for key, value in table.items():
        if hasattr(value, "_fields"):
            raise InputError(key, f"is a potential; files hold numbers alone of {name}")
    return {"potential": name} | table


def _parts(potential: Any) -> list[Potential]:
    """The parts of a potential that is a sum, possibly of sums."""
    if type(potential) is not Sum:
        return [potential]
    return [potential.first, *_parts(potential.second)]


def _sum(parameters: dict[str, Any], folder: Path) -> Potential:
    """The sum of the potentials in a list of tables, which errors name by their places in it."""
    items = known_keys(parameters, ["of"], ["of"])["of"]
    if not is_list(items):
        raise must_be("of", "a list of potentials", items)
    parts = []
    for i, item in enumerate(items):
        with inside(f"of[{i}]"):
            parts.append(from_table(item, folder))
    if len(parts) < 2:
        raise InputError("of", f"must be two or more potentials, got {len(parts)}")
    return functools.reduce(operator.add, parts)


def _scaled(parameters: dict[str, Any], folder: Path) -> Potential:
    parameters = known_keys(parameters, ["factor", "of"], ["factor", "of"])
    with inside("of"):
        potential = from_table(parameters["of"], folder)
    return potential * parameters["factor"]


def _table(parameters: dict[str, Any], folder: Path) -> Table:
    if "file" in parameters:
        parameters = known_keys(parameters, ["file", "error", "columns", "section"])
        if not isinstance(parameters["file"], str):
            raise must_be("file", "the name of a file", parameters["file"])
        return from_csv(folder / parameters.pop("file"), **parameters)
    return from_points(**known_keys(parameters, ["r", "energy", "error"], ["r", "energy"]))


def _dimer(parameters: dict[str, Any], folder: Path) -> Table:
    required = ["calculator", "symbols", "low", "high", "tolerance"]
    return from_dimer(**known_keys(parameters, [*required, "arguments", "many_body"], required))


# Potentials whose tables do not list the fields of a class.
MADE = {"sum": _sum, "scaled": _scaled, "table": _table, "ase-dimer": _dimer}
