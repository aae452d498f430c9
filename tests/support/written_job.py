"""A job for helpers of the compiler, in a module that other processes find."""

import os
from pathlib import Path
from typing import NamedTuple


class Written(NamedTuple):
    """A job that writes the number of the process that does it into a file."""

    path: Path
    waits_for: str = ""  # a file beside it that another job writes
    behaviour: str = ""
    shared: bool = True

    def is_missing(self):
        return not self.path.exists()

    def is_shared(self):
        return self.shared

    def compile(self):
        while self.waits_for and not self.path.with_name(self.waits_for).exists():
            pass
        if self.behaviour == "fails":
            self.path.with_name("failed").touch()
            raise ValueError
        if self.behaviour == "ends the process":
            self.path.with_name("ended").touch()
            os._exit(1)
        self.path.write_text(str(os.getpid()))
