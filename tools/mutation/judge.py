"""Whether tests catch a mutant, in a process of its own where kernels are plain Python."""

import gc
import os
import signal
import sys
import warnings
from collections import defaultdict
from collections.abc import Callable
from contextlib import redirect_stdout
from functools import cache, partial
from pathlib import Path
from time import process_time
from types import CodeType, FunctionType
from typing import Any, NamedTuple

import numpy as np
import pytest

from support.package import SOURCE

ROOT = Path(__file__).parents[2]
# Tests that judge a mutant: those for uncompiled kernels, and others of single functions that take
# up to 2 s uncompiled.  They have no fixtures.
TESTS = (
    "uncompiled",
    "kernels/test_kinematics.py::test_nearest_image",
    "kernels/test_kinematics.py::test_rods_are_rigid",
    "kernels/test_kinematics.py::test_rotational_power",
    "kernels/test_kinematics.py::test_end_forces_hold_the_bar",
    "layout/test_starts.py::test_thermal_start",
    "layout/test_starts.py::test_thermal_start_of_held_and_rigid",
    "model/test_bath_spectra.py::test_thermal_start_shares_the_energy_evenly",
    "model/test_bath_spectra.py::test_thermal_torsional_start",
    "model/test_bath_spectra.py::test_a_cold_start_is_at_rest",
)
# A test of the cost has in brackets the name of the test that reaches the same functions.
COST = "test_cost"
HANGS = 3.0  # times the processor time that a test takes without a mutant
LONGER = 8.0  # times that, a test of the cost


class Hangs(BaseException):
    """A test takes far longer than it should."""


class Collector:
    """A plug-in of pytest that keeps what was collected."""

    def pytest_collection_finish(self, session: pytest.Session) -> None:
        """Keep the tests."""
        self.items = session.items


class Baseline(NamedTuple):
    """What the tests reach, and at what cost, when nothing is changed."""

    tests: dict[str, Callable[[], Any]]
    costs: dict[str, Callable[[], Any]]  # tests of the cost, by the test that belongs to each
    seconds: dict[str, float]  # processor time of each test
    reached: dict[tuple[str, str], list[str]]  # tests that call a function, the cheapest first
    functions: dict[tuple[str, str], list[FunctionType]]


def uncompiled() -> None:
    """Make ready a process in which kernels are plain Python."""
    os.environ["NUMBA_DISABLE_JIT"] = "1"
    sys.dont_write_bytecode = True
    warnings.simplefilter("ignore")
    np.seterr(all="ignore")


def collected(marks: str) -> dict[str, Callable[[], Any]]:
    """The tests with some marks, as functions without arguments, by name."""
    collector = Collector()
    places = [str(ROOT / "tests" / test) for test in TESTS]
    options = ["--collect-only", "-q", "-m", marks, "-p", "no:cacheprovider"]
    with open(os.devnull, "w") as nowhere, redirect_stdout(nowhere):
        code = pytest.main([*options, f"--rootdir={ROOT}", *places], plugins=[collector])
    assert code == pytest.ExitCode.OK, f"pytest collects no tests: {code!r}"
    found = {}
    for item in collector.items:
        arguments = item.callspec.params if hasattr(item, "callspec") else {}
        assert set(item.fixturenames) <= set(arguments), f"{item.nodeid} has fixtures"
        assert item.name not in found, f"two tests have the name {item.name}"
        found[item.name] = partial(item.obj, **arguments)
    return found


def where(code: CodeType) -> tuple[str, str]:
    """File and qualified name of a function of the package."""
    return os.path.relpath(code.co_filename, SOURCE), code.co_qualname


def traced(test: Callable[[], Any]) -> tuple[set[tuple[str, str]], float]:
    """The functions of the package that a test calls, and its processor time."""
    codes: dict[int, CodeType] = {}

    def note(frame, event, _):  # of calls alone, since it returns nothing
        codes[id(frame.f_code)] = frame.f_code

    began = process_time()
    sys.settrace(note)
    try:
        test()
    finally:
        sys.settrace(None)
    seconds = process_time() - began
    own = (code for code in codes.values() if code.co_filename.startswith(str(SOURCE)))
    return set(map(where, own)), seconds


@cache
def baseline(marks: str = "") -> Baseline:
    """Run every test with some marks once; raises AssertionError if one of them fails."""
    tests = collected(marks)
    costs = {}
    for name in [name for name in tests if name.startswith(COST)]:
        costs[name.removeprefix(f"{COST}[").removesuffix("]")] = tests.pop(name)
    seconds = {}
    called = defaultdict(list)
    for name, test in tests.items():
        reached, seconds[name] = traced(test)
        for function in reached:
            called[function].append(name)
    functions = defaultdict(list)
    for item in gc.get_objects():
        if isinstance(item, FunctionType) and item.__code__.co_filename.startswith(str(SOURCE)):
            functions[where(item.__code__)].append(item)
    cheapest = {key: sorted(names, key=seconds.__getitem__) for key, names in called.items()}
    return Baseline(tests, costs, seconds, cheapest, functions)


def failing_costs() -> list[str]:
    """Tests of the cost that fail when nothing is changed, and how."""
    said = {name: judged(test, 3600.0) for name, test in baseline().costs.items()}
    return [f"cost of {name}: {failure}" for name, failure in said.items() if failure]


def codes_within(code: CodeType):
    """All code within some code."""
    for item in code.co_consts:
        if isinstance(item, CodeType):
            yield item
            yield from codes_within(item)


def verdict(file: str, function: str, source: str, marks: str = "") -> str:
    """What the first test says that a mutant fails; empty if it passes all with some marks."""
    base = baseline(marks)
    key = file, function
    if key not in base.reached:
        return ""
    code = compile(source, str(SOURCE / file), "exec")
    (new,) = (found for found in codes_within(code) if where(found) == key)
    changed = base.functions[key]
    old = changed[0].__code__
    for item in changed:
        item.__code__ = new
    try:
        names = base.reached[key]
        tests = [(name, base.tests[name], HANGS * base.seconds[name]) for name in names]
        if file.startswith(("integrators/", "pair/")):  # nothing else changes the cost alone
            for name in names:
                if name in base.costs:
                    seconds = HANGS * LONGER * base.seconds[name]
                    tests.append((f"cost of {name}", base.costs[name], seconds))
        for name, test, seconds in tests:
            failure = judged(test, seconds + 0.5)
            if failure:
                return f"{name}: {failure}"
        return ""
    finally:
        for item in changed:
            item.__code__ = old


def judged(test: Callable[[], Any], seconds: float) -> str:
    """How a test fails, which may take so much processor time; empty if it passes."""

    def stop(*_):
        raise Hangs

    signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        test()
    except (Exception, Hangs, pytest.fail.Exception) as error:  # a mutant may fail in any way
        return f"{type(error).__name__}: {error}"
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
    return ""
