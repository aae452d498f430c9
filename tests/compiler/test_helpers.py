"""Jobs are compiled by several processes at once, and a helper that fails changes nothing."""

import os
import subprocess
import sys

import pytest

from support.written_job import Written
from tribo.compiler import helpers
from tribo.compiler.numba_private import NATIVE
from tribo.system import THREADS_VARIABLE

pytestmark = pytest.mark.skipif(not NATIVE, reason="helpers find what the native way keeps on disk")


@pytest.fixture
def two(monkeypatch):
    """Two processes, on a machine with any number of cores."""
    monkeypatch.setattr(helpers, "_processes", lambda: 2)


def jobs(folder, waits_for):
    """Four jobs, of which this process does the first, until a helper has written a file."""
    first, *others = (Written(folder / name) for name in ("first", "second", "third", "last"))
    return [first._replace(waits_for=waits_for), *others]


def done(folder):
    """The names of jobs that were done, and by which process."""
    return {path.name: path.read_text() for path in folder.iterdir()}


def test_a_helper_does_the_last_job(tmp_path, two):
    helpers.compile_together(jobs(tmp_path, "last"))
    by = done(tmp_path)
    assert set(by) == {"first", "second", "third", "last"}
    assert int(by["first"]) == os.getpid() != int(by["last"])


def test_an_error_elsewhere_is_left(tmp_path, two):
    """It is reported where the code is needed; the helper goes on with the next job."""
    failing = Written(tmp_path / "failing", behaviour="fails")
    helpers.compile_together([*jobs(tmp_path, "last"), failing])
    assert set(done(tmp_path)) == {"first", "second", "third", "last", "failed"}


def test_a_helper_that_ends_is_no_loss(tmp_path, two):
    """This process does all other jobs."""
    ending = Written(tmp_path / "ending", behaviour="ends the process")
    helpers.compile_together([*jobs(tmp_path, "ended"), ending])
    by = done(tmp_path)
    assert set(by) == {"first", "second", "third", "last", "ended"}
    assert int(by["last"]) == os.getpid()


def test_what_others_do_not_know_is_left(tmp_path, two):
    unknown = Written(tmp_path / "unknown", shared=False)
    helpers.compile_together([unknown, *jobs(tmp_path, "last")])
    assert set(done(tmp_path)) == {"first", "second", "third", "last"}


def test_few_jobs_are_left(tmp_path, two):
    helpers.compile_together(jobs(tmp_path, "")[1:])
    assert not done(tmp_path)


def test_one_thread_is_one_process(tmp_path, monkeypatch):
    monkeypatch.setenv(THREADS_VARIABLE, "1")
    helpers.compile_together(jobs(tmp_path, ""))
    assert not done(tmp_path)


PROGRAM = """
import numpy as np, tribo
row = {"shape": (3, 1), "spacing": (1.1, 0.0)}
upper = tribo.Surface("upper", bob=(0.0, 1.2), velocity=(0.5, 0.0), **row)
lower = tribo.Surface("lower", facing="up", **row)
scene = tribo.Scene([upper, lower], tribo.Morse(0.1, 1.0, 1.5), duration=2.0)
result = tribo.simulate(scene, method="verlet", step=0.01, progress=False)
print(*(values.tobytes().hex() for _, values in sorted(result.ledger.flat().items())))
"""


@pytest.mark.slow
def test_two_processes_leave_the_same_code(tmp_path):
    """The files on disk have the same names, and the results the same bits."""
    results = []
    files = []
    for processes in ("1", "2"):
        cache = tmp_path / processes
        environment = {**os.environ, "NUMBA_CACHE_DIR": str(cache), THREADS_VARIABLE: processes}
        command = [sys.executable, "-c", PROGRAM]
        results.append(subprocess.check_output(command, env=environment))
        files.append({path.name for path in cache.rglob("*.nbc")})
    assert results[0] == results[1] != b""
    assert files[0] == files[1] != set()
