"""Journals: what the integrations of a run reached, on disk while the run goes on.

A journal is a file of :mod:`tribo.loops.frames`.  A run is the same sequence of integrations each
time; each has frames of samples and of its time loop's memory.  A run that resumes takes completed
integrations from the journal and continues the last one.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Self

import numpy as np

from tribo.integrators.step_control import Tolerance
from tribo.kernels.status import Status
from tribo.ledger.samples import Samples
from tribo.ledger.sinks import StreamedLedger
from tribo.loops.frames import PART, Arrays, Frames, as_bytes
from tribo.loops.integrate import Columns, Memory, Reached, Setting, TimeLoop
from tribo.loops.state import below
from tribo.model.identity import Identity
from tribo.validation import InputError

__all__ = ["PART", "Journal", "key_of"]


@dataclass
class KeptIntegration:
    """What a journal has of one integration."""

    key: bytes
    # Samples of portions that were under way, by the numbers of the portion and of the part.
    parts: dict[tuple[int, int], Columns] = field(default_factory=dict)
    # By the number of portions up to there, of a streamed run.
    portions: dict[int, Arrays] = field(default_factory=dict)
    memory: Memory | None = None
    status: Status | None = None

    def take_in(self, arrays: Arrays) -> object:
        """Add a frame; returns its name."""
        if "key" in arrays:
            return "key"
        if "status" in arrays:
            self.memory = below("memory_", arrays)
            status = arrays["status"].tobytes().decode()
            self.status = Status(status) if status else None
            return "memory"
        if "portions" in arrays:
            number = int(arrays["portions"])
            self.portions[number] = below("portion_", arrays)
            return "portions", number
        place, columns = tuple(arrays["place"].tolist()), below("column_", arrays)
        self.parts[place] = tuple(columns[str(k)] for k in range(len(columns)))
        return place


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
            self._frames.name_last((self._kept[number].take_in(arrays), number))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self._frames.__exit__(*error)

    def remove(self) -> None:
        """Remove the file, as the result is complete."""
        self._frames.remove()

    def is_due(self) -> bool:
        """Whether it is time to write what was reached."""
        return self._frames.is_due()

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

    def forget(self, number: int, names: Iterable[object]) -> None:
        """Need some frames of an integration no longer."""
        self._frames.forget((name, number) for name in names)

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
        self.due = journal.is_due
        # What the journal has: portions, and of the next one parts and samples in them.
        self._portions, self._parts, self._samples = 0, 0, 0

    def restore(self, loop: TimeLoop, columns: Columns, streamed: StreamedLedger | None) -> Reached:
        """Fill in what the journal has, if anything: portions, samples of the next one, memory."""
        kept, memory = self._kept, self._kept.memory
        if memory is None:
            return Reached()
        self._portions = last = int(memory["portions"])
        chain = []  # a kill may have left portions without the memory after them
        while last > 0:
            chain.append(kept.portions[last])
            last = int(chain[-1]["first"])
        for arrays in reversed(chain):
            assert streamed is not None
            streamed.take_back(arrays)
        while (values := kept.parts.get((self._portions, self._parts))) is not None:
            stop = self._samples + len(values[0])
            for column, some in zip(columns, values, strict=True):
                column[self._samples : stop] = some
            self._parts, self._samples = self._parts + 1, stop
        kept.parts, kept.portions = {}, {}
        loop.restore(below("loop_", memory))
        held = below("held_", memory)
        return Reached(self._portions, Samples(**held) if held else None, kept.status)

    def keep(
        self, loop: TimeLoop, columns: Columns, streamed: StreamedLedger | None, reached: Reached
    ) -> None:
        """Write the portions and samples since the last call, and the memory."""
        number, done_with = np.array(reached.portions), list[tuple[int, int]]()
        if reached.portions > self._portions:
            assert streamed is not None
            new = streamed.new_arrays() | {"first": np.array(self._portions)}
            arrays = {f"portion_{name}": array for name, array in new.items()}
            self._write(("portions", reached.portions), arrays | {"portions": number})
            done_with = [(self._portions, part) for part in range(self._parts)]
            self._portions, self._parts, self._samples = reached.portions, 0, 0
        done = int(loop.clocks["sample"][0])
        if done > self._samples:
            arrays = {f"column_{k}": c[self._samples : done] for k, c in enumerate(columns)}
            place = self._portions, self._parts
            self._write(place, arrays | {"place": np.array(place)})
            self._parts, self._samples = self._parts + 1, done
        memory = {f"loop_{name}": array for name, array in loop.memory().items()}
        if reached.held is not None:
            memory |= {f"held_{f.name}": getattr(reached.held, f.name) for f in fields(Samples)}
        memory = {
            f"memory_{name}": array for name, array in (memory | {"portions": number}).items()
        }
        self._write("memory", memory | {"status": as_bytes(str(reached.status or ""))})
        self._journal.forget(self._number, done_with)

    def _write(self, name: object, arrays: Arrays) -> None:
        self._journal.write(self._number, name, arrays)


def key_of(setting: Setting, times: np.ndarray, start: np.ndarray) -> bytes:
    """What tells one integration of a scene from another."""
    digest = hashlib.blake2b(digest_size=16)
    for item in (*(setting if isinstance(setting, Tolerance) else (setting,)), times, start):
        digest.update(np.asarray(item, float).tobytes())
    return digest.digest()
