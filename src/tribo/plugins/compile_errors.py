"""Messages for plug-ins that do not compile: the line of their source, and what is wrong there."""

import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from types import FunctionType
from typing import Any, NamedTuple

from numba import NumbaError, UnsupportedBytecodeError, njit, types

from tribo.compiler.jit import is_compiled
from tribo.compiler.plugin_methods import METHOD_ARGUMENTS, formula, type_of
from tribo.plugins import classes as plugins
from tribo.plugins.sources import is_own
from tribo.validation import InputError

# Prefixes of numba's names of number types.
NUMBERS = ("float", "int", "complex", "bool")
# Exceptions that numba's compiler raises.
COMPILE_ERRORS = (NumbaError, UnsupportedBytecodeError)


@contextmanager
def compiling(loop: Any, placed: Sequence[tuple[str, NamedTuple]]) -> Iterator[None]:
    """Raise InputError in place of the compiler's errors, in a context that compiles a `loop`.

    The methods of the user's plug-ins, each `placed` in a field of the scene, are compiled by
    themselves first, unless the loop has been compiled before: a mistake is then found in a
    fraction of the time that the loop takes.
    """
    try:
        if not is_compiled(loop):
            for _, plugin in _foreign(placed):
                for method in _methods_of(plugin):
                    _check_method(plugin, method)
        yield
    except COMPILE_ERRORS as error:
        raise compile_error(placed, error) from None


@contextmanager
def compiling_units(placed: Sequence[tuple[str, NamedTuple]]) -> Iterator[None]:
    """The same in a context that compiles units of plug-ins, see `tribo.compiler.units`."""
    try:
        yield
    except COMPILE_ERRORS as error:
        raise compile_error(placed, error) from None


def _foreign(placed: Iterable[tuple[str, NamedTuple]]) -> list[tuple[str, NamedTuple]]:
    """The plug-ins that are not this package's, and those among the fields of plug-ins."""
    parts = [(field, part) for field, plugin in placed for part in plugins.parts(plugin)]
    return [(field, plugin) for field, plugin in parts if not is_own(type(plugin))]


def _methods_of(plugin: NamedTuple) -> list[str]:
    """The names of methods that a plug-in may have: its numbers may be called as others are."""
    return [method for method in METHOD_ARGUMENTS if method not in plugin._fields]


def _is_complex_step(function: Any) -> bool:
    """Whether a method is a derivative that follows from another by a complex step."""
    return bool(function.__name__.startswith("_complex_step"))


def _check_method(plugin: NamedTuple, method: str) -> None:
    """Compile a method that the user wrote, or that is made from one.  Raises numba's errors."""
    function = getattr(type(plugin), method, None)
    if function is None or (is_own(function) and not _is_complex_step(function)):
        return
    compiled = _compiled(plugin, method, types.float64)
    (returned,) = (signature.return_type for signature in compiled.nopython_signatures)
    items: list[types.Type] = [returned]
    if isinstance(returned, types.BaseTuple):
        items = list(returned)  # type: ignore[call-overload]
    numbers = all(isinstance(item, (types.Number, types.Boolean)) for item in items)
    if not numbers or len(items) != plugins.RETURN_COUNTS.get(method, 1):
        raise NumbaError(f"{method} returns {returned}")


def compile_error(placed: Iterable[tuple[str, NamedTuple]], error: Exception) -> InputError:
    """The error to raise when the loop for a scene does not compile, by one of COMPILE_ERRORS.

    Each method of each plug-in is called and compiled by itself, to find the line that fails.
    """
    foreign = _foreign(placed)
    for field, plugin in foreign:
        for method in _methods_of(plugin):
            try:
                _try(plugin, field, method)
            except InputError as found:
                return found
    names = ", ".join(type(plugin).__name__ for _, plugin in foreign)
    return InputError("plug-in", f"{names or 'the scene'} does not compile: {_reason(error)}")


# Methods that follow from others by a complex step.
DERIVED = {"energy": "force", "energy_at": "force_at", "energy_at_time": "force_at_time"}


def _try(plugin: NamedTuple, field: str, method: str) -> None:
    """Call a method, and compile it by itself.  Raises InputError if either fails."""
    function = getattr(type(plugin), method, None)
    if function is None or is_own(function):
        return
    count = METHOD_ARGUMENTS[method]
    plugins.returned_numbers(plugin, field, method, *(1.0,) * count)
    _compile(plugin, field, method, types.float64)
    derived = DERIVED.get(method)
    if derived and _is_complex_step(getattr(type(plugin), derived)):
        try:
            plugins.call_method(plugin, field, method, *(1.0 + 1e-100j,) * count)
            _compile(plugin, field, method, types.complex128)
        except InputError as error:
            raise InputError(
                field,
                f"{error.problem}; without a {derived}(self, ...) it is called with complex "
                "numbers, unless it has assignments, if and return alone",
            ) from None


def _compile(plugin: NamedTuple, field: str, method: str, number: types.Type) -> None:
    """Compile a method.  Raises InputError, with the line that fails."""
    try:
        _compiled(plugin, method, number)
    except COMPILE_ERRORS as error:
        line = _line(getattr(type(plugin), method), error)
        raise InputError(field, plugins.located(plugin, method, line, _reason(error))) from None


def _compiled(plugin: NamedTuple, method: str, number: types.Type) -> Any:
    """A method compiled by itself, for arguments of a type.  Raises COMPILE_ERRORS."""
    compiled = njit(error_model="numpy")(formula(getattr(type(plugin), method)))
    try:
        compiled.compile((type_of(plugin), *(number,) * METHOD_ARGUMENTS[method]))
    except TypeError as error:  # another number of arguments
        raise NumbaError(str(error)) from None
    return compiled


def _line(function: FunctionType, error: Exception) -> int | None:
    """The line of a function's source that the compiler's message names, if it names one."""
    place = getattr(error, "loc", None)
    file = function.__code__.co_filename
    if place is not None and place.filename == file:
        return int(place.line)
    returns = re.findall(
        r"Return of: .*, type '(.*)', location:\s+File \".*\", line (\d+)", _text(error)
    )
    if returns:  # several types, in no order: the first that is not a number
        return min((kind.startswith(NUMBERS), int(line)) for kind, line in returns)[1]
    if "NameError: name '" in _text(error):
        return None
    found = re.search(r'File ".*", line (\d+)|\((\d+)\)\s*$', _text(error), re.MULTILINE)
    return int(found[1] or found[2]) if found else None


def _text(error: Exception) -> str:
    """A compiler's message without colours."""
    return re.sub(r"\x1b\[\d*m", "", str(error))


def _reason(error: Exception) -> str:
    """The reason in a compiler's message, on one line."""
    noise = ("Failed in nopython", "During", "- Resolution failure")
    lines = [line.strip() for line in _text(error).splitlines()]
    lines = [line for line in lines if line and not line.startswith(noise)]
    reason = lines[0] if lines else type(error).__name__
    if reason.endswith(":") and len(lines) > 1:
        reason += " " + lines[1].removeprefix(">>>").strip()
    reason = re.sub(r"\.*\s*Raised from .*", "", reason)
    if "type of <class 'function'>" in reason:
        reason += "; a function that it calls must be compiled too, by @numba.njit"
    return reason
