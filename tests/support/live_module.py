"""A host for the module of a live page, with Python's functions of numbers: what a browser does."""

import math
import struct

import numpy as np
import wasmtime

from tribo.live_pages import program
from tribo.live_pages.inputs import INPUTS
from tribo.live_pages.quantities import QUANTITIES
from tribo.pair import step_rows
from tribo.pair.loop import COLUMNS

# Bytes of a page of memory, of the stack, and of the clock record with room to spare.
PAGE, STACK, CLOCK = 65536, 1 << 17, 1024
# Functions that a table has room for.
TABLE = 64
FUNCTIONS = {
    **{
        name: (1, getattr(math, name))
        for name in ("sin", "cos", "tan", "exp", "log", "log1p", "sqrt")
    },
    "pow": (2, math.pow),
    "hypot": (2, math.hypot),
}


class Machine:
    """A module in memory of its own, for so many samples."""

    def __init__(self, content, potential, samples, clock_size):
        self.store = wasmtime.Store(wasmtime.Engine())
        module = wasmtime.Module(self.store.engine, content)
        self.memory = wasmtime.Memory(self.store, wasmtime.MemoryType(wasmtime.Limits(256, None)))
        imports = [import_of(self.store, self.memory, each) for each in module.imports]
        self.run_code = wasmtime.Instance(self.store, module, imports).exports(self.store)["run"]
        self.top, self.samples = 2 * STACK, samples
        self.arguments = [self._room(16), self._room(16), *self._flat(potential)]
        shapes = {
            "numbers": (INPUTS,),
            "options": (program.OPTIONS,),
            "memory": (step_rows.ROWS, 8),
            "clocks": None,
            "start": (4,),
            "times": (samples,),
            "record": (samples + 1, COLUMNS),
            "coarse": (samples + 1, COLUMNS),
            "series": (QUANTITIES, samples),
            "other": (QUANTITIES, samples),
            "errors": (QUANTITIES,),
        }
        self.places = {}
        for name, shape in shapes.items():
            size = clock_size if shape is None else 8
            place = self._room(CLOCK if shape is None else 8 * math.prod(shape))
            self.places[name] = place, shape
            self.arguments += self._array(place, (1,) if shape is None else shape, size)

    def _room(self, size):
        place = self.top
        self.top += -(-size // 64) * 64
        return place

    def _array(self, place, shape, item):
        strides, size = [], item
        for length in reversed(shape):
            strides.insert(0, size)
            size *= length
        return [0, 0, math.prod(shape), item, place, *shape, *strides]

    def _flat(self, value):
        if isinstance(value, np.ndarray):
            place = self._room(value.nbytes)
            self.memory.write(self.store, np.ascontiguousarray(value, float).tobytes(), place)
            return self._array(place, value.shape, 8)
        if isinstance(value, tuple):
            return [item for each in value for item in self._flat(each)]
        return [float(value)]

    def put(self, name, values):
        content = values.tobytes() if hasattr(values, "tobytes") else values
        self.memory.write(self.store, content, self.places[name][0])

    def get(self, name):
        place, shape = self.places[name]
        content = self.memory.read(self.store, place, place + 8 * math.prod(shape))
        return np.frombuffer(bytes(content)).reshape(shape)

    def run(self, **values):
        """Run with these arrays in place; the code of the status."""
        for name, each in values.items():
            self.put(name, np.asarray(each, float))
        raised = self.run_code(self.store, *self.arguments)
        assert raised == 0
        place = self.arguments[0]
        return struct.unpack("<i", bytes(self.memory.read(self.store, place, place + 4)))[0]


def import_of(store, memory, wanted):
    """What a module imports: the memory, a stack, a table of functions, or a function."""
    kind = wanted.type
    if isinstance(kind, wasmtime.MemoryType):
        return memory
    if isinstance(kind, wasmtime.GlobalType):
        return wasmtime.Global(store, kind, wasmtime.Val.i32(2 * STACK))
    if isinstance(kind, wasmtime.TableType):
        limits = wasmtime.Limits(TABLE, None)
        return wasmtime.Table(store, wasmtime.TableType(kind.element, limits), None)
    count, function = FUNCTIONS[wanted.name]
    number = wasmtime.ValType.f64()
    return wasmtime.Func(
        store, wasmtime.FuncType([number] * count, [number]), _with_infinities(function)
    )


def _with_infinities(function):
    """A function of Python's math with what C returns where Python raises."""

    def call(*values):
        try:
            return function(*values)
        except OverflowError:
            return math.inf
        except ValueError:
            return math.nan

    return call
