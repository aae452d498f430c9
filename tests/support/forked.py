"""New processes that begin with the package imported, so that each need not import it again.

A server imports the package and forks for every program that it is told to run.  A program finds
no plug-in and no compiled code of earlier ones, but what is on disk.
Where processes cannot fork, as on Windows, every program imports the package in a
process of its own.
"""

import io
import json
import os
import subprocess
import sys
import traceback
from contextlib import redirect_stdout
from pathlib import Path

FORKS = hasattr(os, "fork")


class Server:
    """A process that has imported the package; it ends with its `with` block."""

    def __enter__(self):
        self._process = subprocess.Popen(
            [sys.executable, __file__], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        return self

    def __exit__(self, *error):
        self._process.communicate()

    def run(self, program, *arguments, folders=(), **environment):
        """What a program prints in a new process.

        `folders` come first in the search for modules.
        """
        task = {
            "program": program,
            "arguments": [str(argument) for argument in arguments],
            "folders": [str(folder) for folder in folders],
            "environment": {key: str(value) for key, value in environment.items()},
        }
        print(json.dumps(task), file=self._process.stdin, flush=True)
        answer = json.loads(self._process.stdout.readline())
        if not FORKS:
            self.__exit__()
            self.__enter__()
        assert "printed" in answer, answer["error"]
        return answer["printed"]


def answer_to(task):
    """Run the program of a task in this process."""
    from numba.core import config

    os.environ.update(task["environment"])
    config.reload_config()
    sys.argv = ["-c", *task["arguments"]]
    sys.path[:0] = task["folders"]
    sys.dont_write_bytecode = True  # edits within a second would go unnoticed
    try:
        with redirect_stdout(io.StringIO()) as printed:
            exec(task["program"], {"__name__": "__main__"})
    except BaseException:
        return {"error": traceback.format_exc()}
    return {"printed": printed.getvalue()}


def serve():
    """Answer each task on the standard input, in a process of its own."""
    sys.path.remove(str(Path(__file__).parent))
    from numba import njit

    import tribo.report_card.scan
    import tribo.simulation  # noqa: F401

    njit(lambda x: x + 1.0)(1.0)  # the first compilation of a process imports more of numba
    for line in sys.stdin:
        child = os.fork() if FORKS else 0
        if child == 0:
            print(json.dumps(answer_to(json.loads(line))), flush=True)
            os._exit(0)
        _, status = os.waitpid(child, 0)
        if status:
            print(json.dumps({"error": f"the process ended with status {status}"}), flush=True)


if __name__ == "__main__":
    serve()
