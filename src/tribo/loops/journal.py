"""Journals: what the integrations of a run reached, on disk while the run goes on.

A journal is a file of :mod:`tribo.loops.frames`.  A run is the same sequence of integrations each
time; each has frames of samples and of its time loop's memory.  A run that resumes takes completed
integrations from the journal and continues the last one.
"""

from __future__ import annotations

import hashlib
import time
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Self

import numpy as np

from tribo.integrators.step_control import Tolerance
from tribo.kernels.status import Status
from tribo.ledger.samples import Samples
from tribo.ledger.sinks import StreamedLedger
from tribo.loops.frames import INTERVAL, PART, RELATIVE_INTERVAL, Arrays, Frames, as_bytes
from tribo.loops.integrate import Columns, Memory, Setting, TimeLoop
from tribo.loops.state import below
from tribo.model.identity import Identity
from tribo.validation import InputError

__all__ = ["PART", "Journal", "key_of"]


@dataclass
class KeptIntegration:
    """What a journal has of one integration."""

    key: bytes
    samples: list[Columns] = field(default_factory=list)
    # Of a streamed run, in place of samples: by the number of portions up to there.
    portions: dict[int, Arrays] = field(default_factory=dict)
    memory: Memory | None = None
    status: Status | None = None


class Journal:
    """The journal of a run; a context manager.

    With `resume` it continues what the file has; else the first integration replaces the file.
    Raises InputError if the file is of another run, cannot be read, or is in use.
    """

    def __init__(self, path: Path, identity: Identity, resume: bool) -> None:
        self._kept: list[KeptIntegration] = []
        self._number = 0  # of integrations that were begun or repeated
        self._frames = Frames(path, identity, resume)
        for arrays in self._frames.read():
            number = int(arrays["number"])
            if "key" in arrays:
                self._kept.append(KeptIntegration(arrays["key"].tobytes()))
            self._frames.name_last((_take_in(self._kept[number], arrays), number))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self._frames.__exit__(*error)

    def remove(self) -> None:
        """Remove the file, as the result is complete."""
        self._frames.remove()

    def integration(self, key: bytes) -> JournaledIntegration:
        """The next integration of the run; `key` identifies its settings.

        Raises InputError if the one in the journal has other settings, or the file cannot be
        written.
        """
        number = self._number
        self._number += 1
        if number == len(self._kept):
            self._kept.append(KeptIntegration(key))
            self.write(number, "key", {"key": as_bytes(key)})
        elif self._kept[number].key != key:
            raise InputError(
                str(self._frames.path),
                "is of a run with other settings; start again without --resume",
            )
        return JournaledIntegration(self, number, self._kept[number])

    def write(self, number: int, name: object, arrays: Arrays) -> None:
        """Append a frame of an integration; it replaces the last one of the same name.

        Raises InputError.
        """
        self._frames.append((name, number), {"number": np.array(number)} | arrays)


class JournaledIntegration:
    """One integration in a journal; :class:`tribo.loops.integrate.Checkpoints`."""

    def __init__(self, journal: Journal, number: int, kept: KeptIntegration) -> None:
        self._journal = journal
        self._number = number
        self._kept = kept
        self._done = 0  # samples that the journal has, or portions of a streamed run
        self._took = 0.0
        self._last = time.perf_counter()

    def restore(self, loop: TimeLoop, columns: Columns) -> Status | None:
        """Fill in what the journal has, if anything; the status of an integration that ended."""
        if self._kept.memory is None:
            return None
        for part in self._kept.samples:
            stop = self._done + len(part[0])
            for column, values in zip(columns, part, strict=True):
                column[self._done : stop] = values
            self._done = stop
        self._kept.samples = []
        loop.restore(self._kept.memory)
        return self._kept.status

    def due(self) -> bool:
        """Whether it is time to keep what was reached."""
        waited = time.perf_counter() - self._last
        return waited > max(INTERVAL, RELATIVE_INTERVAL * self._took)

    def keep(self, loop: TimeLoop, columns: Columns, status: Status | None) -> None:
        """Write the samples so far and the memory, and the status if the integration ended."""
        began = time.perf_counter()
        done = int(loop.clocks["sample"][0])
        if done > self._done:
            rows = {f"column_{k}": c[self._done : done] for k, c in enumerate(columns)}
            self._journal.write(self._number, ("samples", self._done), rows)
            self._done = done
        self._keep_memory(loop.memory(), str(status or ""), began)

    def _keep_memory(self, memory: Memory, status: str, began: float) -> None:
        """Write what the loop needs to continue, at the end of a write that `began` then."""
        arrays = {f"memory_{name}": array for name, array in memory.items()}
        self._journal.write(self._number, "memory", arrays | {"status": as_bytes(status)})
        self._last = time.perf_counter()
        self._took = self._last - began

    def restore_portions(
        self, loop: TimeLoop, streamed: StreamedLedger
    ) -> tuple[int, Samples | None]:
        """The same for a streamed run: the portions that were kept, and the last samples held."""
        memory = self._kept.memory
        if memory is None:
            return 0, None
        self._done = int(memory["portions"])
        chain, last = [], self._done  # a kill may have left portions without the memory after them
        while last > 0:
            chain.append(self._kept.portions[last])
            last = int(chain[-1]["first"])
        for arrays in reversed(chain):
            streamed.take_back(arrays)
        self._kept.portions = {}
        loop.restore(below("loop_", memory))
        return self._done, Samples(**below("held_", memory))

    def keep_portions(
        self, loop: TimeLoop, streamed: StreamedLedger, number: int, held: Samples
    ) -> None:
        """Write what a streamed run has taken in since the last call, after so many portions."""
        began = time.perf_counter()
        new = streamed.new_arrays() | {"first": np.array(self._done)}
        new = {f"portion_{name}": array for name, array in new.items()}
        new["portions"] = np.array(number)
        self._journal.write(self._number, ("portions", number), new)
        self._done = number
        memory = {f"loop_{name}": array for name, array in loop.memory().items()}
        memory |= {f"held_{each.name}": getattr(held, each.name) for each in fields(held)}
        self._keep_memory(memory | {"portions": np.array(number)}, "", began)


def _take_in(kept: KeptIntegration, arrays: Arrays) -> object:
    """Add a frame to what is kept of its integration; returns the frame's name."""
    if "key" in arrays:
        return "key"
    if "status" in arrays:
        kept.memory = below("memory_", arrays)
        status = arrays["status"].tobytes().decode()
        kept.status = Status(status) if status else None
        return "memory"
    if "portions" in arrays:
        number = int(arrays["portions"])
        kept.portions[number] = below("portion_", arrays)
        return "portions", number
    columns = below("column_", arrays)
    name = ("samples", sum(len(part[0]) for part in kept.samples))
    kept.samples.append(tuple(columns[str(k)] for k in range(len(columns))))
    return name


def key_of(setting: Setting, times: np.ndarray, start: np.ndarray) -> bytes:
    """What tells one integration of a scene from another."""
    digest = hashlib.blake2b(digest_size=16)
    for item in (*(setting if isinstance(setting, Tolerance) else (setting,)), times, start):
        digest.update(np.asarray(item, float).tobytes())
    return digest.digest()
