"""Journals: what the integrations of a run reached, on disk while the run goes on.

A journal is a file of :mod:`tribo.loops.frames`.  A run is the same sequence of integrations each
time; each has frames of samples and of its time loop's memory.  A run that resumes takes completed
integrations from the journal and continues the last one.
"""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import numpy as np

from tribo.kernels.status import Status
from tribo.ledger.samples import Samples
from tribo.ledger.sinks import StreamedLedger
from tribo.loops.frames import Arrays, Frames, as_bytes
from tribo.loops.integrate import Reached
from tribo.loops.saved_state import below, under
from tribo.loops.setting import Setting
from tribo.loops.time_loop import Columns, TimeLoop
from tribo.model.identity import Identity
from tribo.validation import InputError


class Journal(Frames):
    """The journal of a run, with `resume` and the errors of :class:`tribo.loops.frames.Frames`."""

    def __init__(self, path: Path, identity: Identity, resume: bool) -> None:
        super().__init__(path, identity, resume)
        self._number = 0  # of integrations that were begun or repeated
        self._known: dict[int, dict[Any, Arrays]] = {}  # frames of integrations by their names
        for (name, number), arrays in self.read():
            self._known.setdefault(number, {})[name] = arrays

    def integration(self, key: bytes) -> JournaledIntegration:
        """The next integration.  Raises InputError if the journal has it with another `key`."""
        number = self._number
        known = self._known.pop(self._number, {})
        self._number += 1
        if "memory" in known and known["memory"]["key"].tobytes() != key:
            raise InputError(
                str(self.path), "is of a run with other settings; start again without --resume"
            )
        return JournaledIntegration(self, number, key, known)


class JournaledIntegration:
    """One integration in a journal; :class:`tribo.loops.integrate.Checkpoints`."""

    def __init__(self, journal: Journal, number: int, key: bytes, known: dict[Any, Arrays]) -> None:
        """Take what the journal has of this integration, which `restore` fills in."""
        self.due = journal.is_due
        self._journal = journal
        self._number = number
        self._key = key
        # Frames: "memory", ("portions", number of them so far) of a streamed run, and samples of
        # portions that were under way by the numbers of the portion and of the part.
        self._known = known
        # What the journal has: portions, and of the next one parts and samples in them.
        self._portions = 0
        self._parts = 0
        self._samples = 0

    def restore(self, loop: TimeLoop, columns: Columns, streamed: StreamedLedger | None) -> Reached:
        """Fill in what the journal has, if anything: portions, samples of the next one, memory."""
        known = self._known
        self._known = {}
        if "memory" not in known:
            return Reached()
        memory = below("memory_", known["memory"])
        self._portions = last = int(memory["portions"])
        chain = []  # a kill may have left portions without the memory after them
        while last > 0:
            chain.append(known["portions", last])
            last = int(chain[-1]["first"])
        for arrays in reversed(chain):
            assert streamed is not None
            streamed.take_back(arrays)
        while (part := known.get((self._portions, self._parts))) is not None:
            stop = self._samples + len(part["column_0"])
            for k, column in enumerate(columns):
                column[self._samples : stop] = part[f"column_{k}"]
            self._parts += 1
            self._samples = stop
        loop.restore(below("loop_", memory))
        held = below("held_", memory)
        status = known["memory"]["status"].tobytes().decode()
        samples = Samples(**held) if held else None
        return Reached(self._portions, samples, Status(status) if status else None)

    def keep(
        self, loop: TimeLoop, columns: Columns, streamed: StreamedLedger | None, reached: Reached
    ) -> None:
        """Write the portions and samples since the last call, and the memory."""
        done_with = list[tuple[int, int]]()
        if reached.portions > self._portions:
            assert streamed is not None
            new = streamed.new_arrays() | {"first": np.array(self._portions)}
            self.write(("portions", reached.portions), new)
            done_with = [(self._portions, part) for part in range(self._parts)]
            self._portions = reached.portions
            self._parts = 0
            self._samples = 0
        done = int(loop.clocks["sample"][0])
        if done > self._samples:
            arrays = {f"column_{k}": c[self._samples : done] for k, c in enumerate(columns)}
            self.write((self._portions, self._parts), arrays)
            self._parts += 1
            self._samples = done
        memory = under("loop_", loop.memory()) | {"portions": np.array(reached.portions)}
        if reached.held is not None:
            memory |= under("held_", reached.held.arrays())
        about = {"status": as_bytes(str(reached.status or "")), "key": as_bytes(self._key)}
        self.write("memory", under("memory_", memory) | about)
        self._journal.forget((name, self._number) for name in done_with)

    def write(self, name: object, arrays: Arrays) -> None:
        """Append a frame; it replaces the last one of the same name.  Raises InputError."""
        self._journal.append((name, self._number), arrays)


def key_of(setting: Setting, times: np.ndarray, start: np.ndarray) -> bytes:
    """What tells one integration of a scene from another."""
    digest = hashlib.blake2b(digest_size=16)
    steps = (setting.step,) if setting.tolerance is None else setting.tolerance
    for item in (*steps, times, start):
        digest.update(np.asarray(item, float).tobytes())
    return digest.digest()
