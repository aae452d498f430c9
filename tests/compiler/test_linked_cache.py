"""Kernels that only other kernels call are kept on disk between processes."""

import itertools
import json
import math
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tribo.compiler.numba_private import NATIVE

if NATIVE:
    from tribo.compiler.cache import whole_parts

pytestmark = pytest.mark.skipif(not NATIVE, reason="numba keeps no kernels without machine code")

# Loops that call kernels of this package, some of which call others; what each of them gives, and
# the kernels of this package that were compiled for it.
PROGRAM = """
import json, sys
from tribo.compiler.jit import compilations, time_loop
from tribo.compiler.lanes import broadcast, lane
from tribo.compiler.lanes_functions import sine_cosine, sine_cosine_versine

def sine(x):
    return lane(sine_cosine(broadcast(x))[0], 0)

def versine(x):
    return lane(sine_cosine_versine(broadcast(x))[2], 0)

loops = {"sine": sine, "versine": versine}
found = {}
for name in sys.argv[1:]:
    with compilations() as recorded:
        value = time_loop(loops[name], kept=False)(0.7)
    starts = [event.data["dispatcher"].py_func for _, event in recorded.buffer if event.is_start]
    found[name] = value, sorted(each.__name__ for each in starts if "tribo" in each.__module__)
print(json.dumps(found))
"""
# What both call.
SHARED = {"lane_by_lane", "near_zero", "reduced", "sine_cosine_versine"}


def run(folder, *loops):
    """Values and compiled kernels of some loops, in a process of its own."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(folder)}
    command = [sys.executable, "-c", PROGRAM, *loops]
    return json.loads(subprocess.check_output(command, env=environment, text=True))


def codes(folder):
    """The code of each kernel on disk, without its types, whose numbers each process counts."""
    return {
        name: next(itertools.islice(whole_parts(path), 1, 2))[0]
        for name, path in files(folder).items()
    }


def files(folder):
    """Kernels on disk."""
    return {path.name: path for path in folder.rglob("linked_cache.*.nbc")}


@pytest.fixture(scope="module")
def full(tmp_path_factory):
    """A folder with the kernels of one loop, and what that gave."""
    folder = tmp_path_factory.mktemp("cache")
    return folder, run(folder, "sine")["sine"]


def copy_of(folder, place):
    """The same files in another folder, to be changed."""
    return Path(shutil.copytree(folder, place / "cache"))


def test_the_next_loop_takes_kernels_from_disk(full, tmp_path):
    """It compiles none of those that an earlier one called, and gives what it gives alone."""
    folder, (sine, compiled) = full
    assert sine == pytest.approx(math.sin(0.7), rel=1e-15)
    assert set(compiled) >= SHARED
    value, compiled = run(copy_of(folder, tmp_path), "versine")["versine"]
    assert not SHARED & set(compiled)
    alone, compiled = run(tmp_path / "empty", "versine")["versine"]
    assert value == alone
    assert set(compiled) >= SHARED


def test_the_same_code_in_whatever_order(full, tmp_path):
    """Nothing in the code on disk depends on what a process compiled before it."""
    run(tmp_path, "versine", "sine")
    ones, others = codes(full[0]), codes(tmp_path)
    assert len(ones) > len(SHARED)
    assert ones.items() <= others.items()


@pytest.mark.parametrize(
    "harm", [pytest.param("damaged", marks=pytest.mark.thorough), "removed", "another"]
)
def test_kernels_that_are_not_whole_are_compiled_again(full, tmp_path, harm):
    """So is a kernel whose file is whole, but which calls one that is not what it was."""
    folder = copy_of(full[0], tmp_path)
    (path,) = (path for name, path in files(folder).items() if ".near_zero" in name)
    content = path.read_bytes()
    if harm == "damaged":
        path.write_bytes(content[:-1] + bytes([content[-1] ^ 1]))
    elif harm == "removed":
        path.unlink()
    else:
        (other,) = (path for name, path in files(folder).items() if ".reduced" in name)
        path.write_bytes(other.read_bytes())
    value, compiled = run(folder, "versine")["versine"]
    assert {"near_zero", "sine_cosine_versine"} <= set(compiled)
    assert "reduced" not in compiled
    assert value == pytest.approx(1.0 - math.cos(0.7), rel=1e-15)
    assert run(folder, "sine")["sine"][0] == full[1][0]
