"""What is said on a terminal while something takes long."""

import os
import pty
import subprocess
import sys

import pytest

import tribo
from support.package import SOURCE

SLOW = "import time; from tribo.progress import announced\nwith announced('busy'): time.sleep({})"


def said_on_a_terminal(arguments, **environment):
    """What a command writes to stderr, which is a terminal."""
    main, side = pty.openpty()
    path = str(SOURCE.parent)
    environment = os.environ | {"PYTHONPATH": path} | environment
    command = [sys.executable, *arguments]
    with subprocess.Popen(command, stderr=side, stdout=subprocess.PIPE, env=environment) as process:
        os.close(side)
        found = b""
        while True:
            try:
                part = os.read(main, 4096)
            except OSError:  # at the end, on Linux
                part = b""
            if not part:
                break
            found += part
        process.communicate()
    os.close(main)
    assert process.returncode == 0, found
    return found.decode()


def test_a_terminal_is_told_after_a_second():
    """Not before, and no file or pipe is."""
    command = [sys.executable, "-c", SLOW.format(1.6)]
    environment = os.environ | {"PYTHONPATH": str(SOURCE.parent)}
    with subprocess.Popen(command, env=environment, stderr=subprocess.PIPE) as piped:
        assert said_on_a_terminal(["-c", SLOW.format(1.6)]) == "busy\r\n"
        assert said_on_a_terminal(["-c", SLOW.format(0.1)]) == ""
        assert piped.stderr.read() == b""


COMPILING = """
import time, numba
from tribo.compiler.jit import undisturbed
for _ in range(2):
    with undisturbed():
        {}
        time.sleep(1.6)
"""


@pytest.mark.parametrize("is_compiled", [True, False])
def test_only_compiling_is_announced(is_compiled):
    """Once; machine code from disk may take a second too, and is not announced."""
    code = COMPILING.format("numba.njit(lambda x: x)(1)" if is_compiled else "pass")
    assert said_on_a_terminal(["-c", code]) == "compiling ...\r\n" * is_compiled


@pytest.mark.slow
def test_compiling_is_announced(tmp_path):
    """Once, by a command whose loops are not in the cache yet."""
    scene = tmp_path / "a.toml"
    tribo.paper.scene("A").save(scene)
    caches = {"NUMBA_CACHE_DIR": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path)}
    command = ["-m", "tribo", "run", str(scene)]
    assert said_on_a_terminal(command, **caches).count("compiling ...") == 1
    assert "compiling" not in said_on_a_terminal(command, **caches)
