"""The link step: a WebAssembly object becomes a module that exports some of its functions.

LLVM writes an object in the form of a module.  Function and memory addresses in it are those of a
module that consists of it alone, so that nothing has to be relocated.  What it lacks is an export,
whose function the symbol table names.  References: the binary format, sections and LEB128 integers,
https://webassembly.github.io/spec/core/binary/modules.html; the section "linking" of objects,
https://github.com/WebAssembly/tool-conventions/blob/main/Linking.md.
"""

from collections.abc import Iterator, Mapping

HEADER = 8  # bytes: the magic number and the version
# Identities of sections.
CUSTOM = 0
EXPORTS = 7
# In the section "linking": the subsection with symbols, kinds of symbols, and their flags.
SYMBOL_TABLE = 8
FUNCTION_SYMBOL = 0
DATA_SYMBOL = 1
SECTION_SYMBOL = 3
UNDEFINED = 0x10
EXPLICIT_NAME = 0x40


class Reader:
    """Reads bytes from the front."""

    def __init__(self, content: bytes) -> None:
        self.content = content
        self.at = 0

    def byte(self) -> int:
        self.at += 1
        return self.content[self.at - 1]

    def number(self) -> int:
        """An unsigned integer in LEB128: seven bits a byte, the lowest first."""
        result = shift = 0
        while True:
            byte = self.byte()
            result |= (byte & 0x7F) << shift
            shift += 7
            if byte < 0x80:
                return result

    def bytes(self, count: int) -> bytes:
        self.at += count
        return self.content[self.at - count : self.at]

    def name(self) -> str:
        return self.bytes(self.number()).decode()

    def ended(self) -> bool:
        return self.at >= len(self.content)


def number(value: int) -> bytes:
    """An unsigned integer in LEB128."""
    found = bytearray()
    while value >= 0x80:
        found.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes([*found, value])


def sections(content: bytes) -> Iterator[tuple[int, bytes]]:
    """The sections of a module: identities and contents."""
    reader = Reader(content)
    reader.bytes(HEADER)
    while not reader.ended():
        kind = reader.byte()
        yield kind, reader.bytes(reader.number())


def functions_in(symbols: bytes) -> dict[str, int]:
    """Names and indices of the functions that a symbol table defines."""
    reader = Reader(symbols)
    found = {}
    for _ in range(reader.number()):
        kind = reader.byte()
        flags = reader.number()
        if kind == SECTION_SYMBOL:
            reader.number()
        elif kind == DATA_SYMBOL:
            reader.name()
            for _ in range(0 if flags & UNDEFINED else 3):  # segment, offset and size
                reader.number()
        else:
            index = reader.number()
            if not flags & UNDEFINED or flags & EXPLICIT_NAME:
                name = reader.name()
                if kind == FUNCTION_SYMBOL and not flags & UNDEFINED:
                    found[name] = index
    return found


def symbol_table(parts: list[tuple[int, bytes]]) -> bytes:
    """The symbols in the section "linking"."""
    for kind, content in parts:
        reader = Reader(content)
        if kind != CUSTOM or reader.name() != "linking":
            continue
        reader.number()  # its version
        while not reader.ended():
            subsection = reader.byte()
            body = reader.bytes(reader.number())
            if subsection == SYMBOL_TABLE:
                return body
    raise ValueError("the object has no symbols")


def linked(content: bytes, functions: Mapping[str, str]) -> bytes:
    """The module of an object, which exports `functions` under their names."""
    parts = list(sections(content))
    known = functions_in(symbol_table(parts))
    export = number(len(functions))
    for name, function in functions.items():
        label = name.encode()
        export += number(len(label)) + label + b"\0" + number(known[function])
    kept = [(kind, body) for kind, body in parts if kind != CUSTOM]
    before = [part for part in kept if part[0] < EXPORTS]
    behind = [part for part in kept if part[0] > EXPORTS]
    ordered = [*before, (EXPORTS, export), *behind]
    return content[:HEADER] + b"".join(
        bytes([kind]) + number(len(body)) + body for kind, body in ordered
    )
