"""A host for the module of a page with a row or grid: what a browser does."""

import numpy as np
import wasmtime

from support.live_module import PAGE, STACK, import_of
from tribo.live_pages.arguments import flat_arguments

RESULTS = 64  # bytes for what a function returns


class LatticeMachine:
    """A module with the image of a program in its memory."""

    def __init__(self, content, program):
        self.program, self.image = program, program.image()
        self.words = self.image.words
        self.store = wasmtime.Store(wasmtime.Engine())
        module = wasmtime.Module(self.store.engine, content)
        pages = (2 * STACK + RESULTS + self.image.size) // PAGE + 1
        limits = wasmtime.Limits(max(pages, 256), None)
        self.memory = wasmtime.Memory(self.store, wasmtime.MemoryType(limits))
        imports = [import_of(self.store, self.memory, each) for each in module.imports]
        self.functions = wasmtime.Instance(self.store, module, imports).exports(self.store)
        self.results = 2 * STACK
        self.base = self.results + RESULTS

    def load(self):
        """Put the image, or the present `words` of it, at its place."""
        words = self.words.copy()
        words[self.image.addresses] += self.base
        for place, number in self.image.units:
            words[place] = self.functions["unit"](self.store, int(number))
        self.memory.write(self.store, words.tobytes(), self.base)

    def call(self, call, step=None):
        """Call a function; the code that it returns.  The loop has a `step` of its own."""
        values = [self.results, self.results + 32]
        for kind, value in flat_arguments(call.arguments, self.image):
            if kind == "number":
                values.append(float(value if step is None else step))
            else:
                values.append(int(value) + (self.base if kind == "place" else 0))
        raised = self.functions[call.name](self.store, *values)
        assert raised == 0
        return int(np.frombuffer(self.read(self.results, 4), np.int32)[0])

    def run(self, name, step=None):
        """A run and its quantities; the code of its status."""
        setup, steps, seen, _ = self.program.calls[name]
        self.load()
        self.call(setup)
        code = self.call(steps, step)
        self.call(seen)
        return code

    def get(self, array):
        """The values that an array of the program has in the module's memory."""
        place = self.base + self.image.place_of(array)
        return np.frombuffer(self.read(place, array.nbytes), array.dtype).reshape(array.shape)

    def read(self, place, size):
        return bytes(self.memory.read(self.store, place, place + size))
