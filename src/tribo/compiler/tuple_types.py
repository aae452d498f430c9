"""Types of the named tuples of kernels, cheap however many members they have.

numba hashes the type of a tuple with the types of all its members, writes them wherever LLVM's text
names the type, and passes each number of a tuple to a function as an argument of its own.  Those of
a scene have some three hundred numbers.  Here a type is hashed once, has a short name in LLVM's
text, and a tuple is one argument.
"""

import functools
import hashlib
import re
from collections.abc import Iterable
from typing import Any

from llvmlite import ir
from llvmlite.binding import parse_assembly
from numba import types
from numba.extending import models, register_model

# A struct of this module in LLVM's text; a name is a digest of the struct's members.
NAMED_STRUCT = re.compile(r'%"?(tribo\.[0-9a-f]{16})"?')


class NamedStruct(ir.IdentifiedStructType):
    """A struct of no context of llvmlite: those write all their structs into every module."""

    def __init__(self, name: str, members: list[ir.Type]) -> None:
        super().__init__(None, name)
        self.set_body(*members)

    @functools.cache  # noqa: B019 (structs are kept as long as the process runs)
    def get_abi_size(self, target_data: Any, context: Any = None) -> int:
        """Its size in memory [bytes]."""
        module = Module()
        ir.GlobalVariable(module, self, "example")
        with parse_assembly(str(module)) as parsed:
            example = parsed.get_global_variable("example")
            return int(target_data.get_abi_size(example.global_value_type))


_structs: dict[str, NamedStruct] = {}


class KernelTuple(types.NamedTuple):
    """The type of a named tuple, made by a class, inside of time loops."""

    def __init__(self, kinds: Iterable[types.Type], made_by: type) -> None:
        super().__init__(kinds, made_by)
        self.name = f"{made_by.__name__}_{_digest(self.name)}"
        self._hash = hash(self.key)

    def __hash__(self) -> int:
        """Computed once; the members are types, too."""
        return self._hash

    def __reduce__(self) -> Any:
        """Each process computes the hash again."""
        return KernelTuple, (self.types, self.instance_class)

    @property
    def mangling_args(self) -> tuple[str, tuple[()]]:
        """The type in the names of functions."""
        return self.name, ()


@register_model(KernelTuple)
class _Model(models.TupleModel):
    """A struct with a name; one argument of a function."""

    def get_value_type(self) -> NamedStruct:
        if self._value_type is None:
            self._value_type = _named_struct([each.get_value_type() for each in self._models])
        return self._value_type

    def get_argument_type(self) -> NamedStruct:
        return self.get_value_type()

    def as_argument(self, builder: ir.IRBuilder, value: ir.Value) -> ir.Value:
        return value

    def from_argument(self, builder: ir.IRBuilder, value: ir.Value) -> ir.Value:
        return value


def _digest(text: str) -> str:
    return hashlib.blake2b(text.encode(), digest_size=8).hexdigest()


def _named_struct(members: list[ir.Type]) -> NamedStruct:
    """The struct of these members."""
    name = "tribo." + _digest(", ".join(str(each) for each in members))
    if name not in _structs:
        _structs[name] = NamedStruct(name, members)
    return _structs[name]


class Module(ir.Module):
    """A module of LLVM's text that declares the named structs which it uses."""

    def _get_body_lines(self) -> list[str]:
        lines = [str(value) for value in self.globals.values()]
        return _declarations("\n".join(lines)) + lines


def _declarations(text: str) -> list[str]:
    """Declarations of all named structs in a text, and of those in these declarations."""
    found: dict[str, str] = {}
    waiting = [text]
    for each in waiting:
        for name in set(NAMED_STRUCT.findall(each)) - found.keys():
            found[name] = _structs[name].get_declaration()
            waiting.append(found[name])
    return list(found.values())
