"""What catches a mutant: checks that run uncompiled, in a process of their own.

A check compares runs with the identities of the ledger, an independent solver, or a closed form,
never with what the package itself gave before.
"""

import gc
import importlib
import os
import signal
import sys
import warnings
from collections import defaultdict
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace
from functools import cache
from time import process_time
from types import CodeType, FunctionType, SimpleNamespace
from typing import NamedTuple
from unittest import mock

import numpy as np

from support import reference
from support.laws import identities, kind, tables
from support.mutation_scenes import PAIRS, SCENES
from support.package import SOURCE

WITH_REFERENCE = [name for name in SCENES if name not in ("open", "twisting")]
NO_REFERENCE = {"surfaces": {}, "blocks": {}, "system": {}, "scales": {"energy": 0.5}}
HANGS = 20.0  # times the processor time that a check takes without a mutant


# --- comparisons ---------------------------------------------------------------------------------


@cache
def solution(name):
    """The end of a scene by the independent solver."""
    if name in WITH_REFERENCE or name in PAIRS:
        return reference.solve((SCENES | PAIRS)[name])
    return NO_REFERENCE


def table_of(name):
    """The scene's table."""
    return (SCENES | PAIRS)[name]


def simulate(scene, **how):
    """A run of a scene, or of a scene file's table."""
    if isinstance(scene, dict):
        scene = importlib.import_module("tribo.model.scene_file").scene_from(scene)
    return importlib.import_module("tribo.simulation").simulate(scene, **how)


def ends(result):
    """Every table of the ledger at the end."""
    for surface, table in tables(result):
        yield surface.name if surface else "system", {q: table[q][-1] for q in table}


def extrapolated(coarse, fine, order):
    """The limit of runs with two steps, table by table, at the end."""
    weight = 1.0 / (2**order - 1)
    for (place, one), (_, other) in zip(ends(coarse), ends(fine), strict=True):
        yield place, {q: other[q] + weight * (other[q] - one[q]) for q in other}


def complaint(found, truth, tolerance):
    """What is wrong with the ledger's end, by its own laws or by the independent solution."""
    allowed = {name: tolerance * scale for name, scale in truth["scales"].items()}
    for place, table in found:
        for law, _, one, other in identities([table]):
            if not np.all(np.abs(one - other) <= allowed["energy"]):
                return f"{place}: {law}"
        if np.any(table.get("heat", 0.0) < 0.0):
            return f"{place}: heat flows from a reservoir at temperature 0"
        known = truth["surfaces"] if "theta" in table else truth["blocks"]
        for name, values in (known | {"system": truth["system"]}).get(place, {}).items():
            if not np.all(np.abs(table[name] - values) <= allowed[kind(name)]):
                return f"{place}: {name} differs from the reference"
    return ""


def stopped(*results):
    """The status of the first run that did not complete."""
    for result in results:
        if result.status != "completed":
            return f"stops with {result.status}"
    return ""


# --- checks --------------------------------------------------------------------------------------


class Steps(NamedTuple):
    """Two runs of a scene, with a step and with half of it, agree with the solution in the limit."""

    scene: str
    method: str
    step: float
    order: int
    tolerance: float

    def __call__(self):
        steps = (self.step, 0.5 * self.step)
        runs = [simulate(table_of(self.scene), method=self.method, step=h) for h in steps]
        found = extrapolated(*runs, self.order)
        return stopped(*runs) or complaint(found, solution(self.scene), self.tolerance)


class Accurate(NamedTuple):
    """A run to an accuracy agrees with the solution, and takes about as many steps as it should."""

    scene: str
    method: str
    accuracy: float
    tolerance: float

    def __call__(self):
        run = simulate(table_of(self.scene), method=self.method, accuracy=self.accuracy)
        return stopped(run) or complaint(ends(run), solution(self.scene), self.tolerance)


class Listed(NamedTuple):
    """The same with lists of neighbours."""

    check: Steps | Accurate

    def __call__(self):
        with mock.patch("tribo.run.contacts.FEW", 0):
            return self.check()


class AsPair(NamedTuple):
    """The loop for one asperite on one, with arrays in place of registers."""

    scene: str
    accuracy: float
    tolerance: float

    def __call__(self):
        with registers_as_arrays():
            run = simulate(
                table_of(self.scene), method="gauss-radau-15", accuracy=self.accuracy
            )
        return stopped(run) or complaint(ends(run), solution(self.scene), self.tolerance)


class PulledByHand(NamedTuple):
    """The stage and its spring as a plug-in."""

    stiffness: float
    speed: float
    start: float  # of the bar

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        """f2."""
        return self.stiffness * (self.start + self.speed * t - x), -fy


class ClampedByHand(NamedTuple):
    """What holds the ends of a bar that does not turn, as a plug-in."""

    stiffness: float  # kappa / bar_length

    def end_forces(self, t, phi, nu, twist):
        """f_L and f_R."""
        end = self.stiffness * twist
        x, y = -end * np.sin(phi), end * np.cos(phi)
        return x, y, -x, -y


CHECKS: dict[str, Callable[[], str]] = {}
for _scene in ("slid", "pulled", "lattice", "open", "twisting"):
    CHECKS[f"midpoint, {_scene}"] = Steps(_scene, "midpoint", 0.05, 2, 1e-3)
for _scene in ("slid", "pulled", "lattice", "twisting"):
    CHECKS[f"kahan-li-6, {_scene}"] = Steps(_scene, "kahan-li-6", 0.25, 6, 1e-5)
CHECKS["verlet, open"] = Steps("open", "verlet", 0.05, 2, 1e-5)  # its identities are exact
CHECKS["rk4, slid"] = Steps("slid", "rk4", 0.1, 4, 1e-4)
CHECKS["gauss-8, slid"] = Steps("slid", "gauss-8", 0.25, 8, 1e-6)
for _method in ("dop853", "rkn8", "rkn12", "gauss-radau-15"):
    CHECKS[f"{_method}, slid"] = Accurate("slid", _method, 1e-8, 1e-7)
CHECKS["all pairs"] = Steps("rows", "midpoint", 0.02, 2, 1e-3)
CHECKS["listed pairs"] = Listed(CHECKS["all pairs"])
CHECKS["listed pairs, verlet"] = Listed(Steps("rows", "verlet", 0.02, 2, 1e-3))
for _scene in PAIRS:
    CHECKS[f"pair, {_scene}"] = AsPair(_scene, 1e-8, 1e-7)


# --- registers -----------------------------------------------------------------------------------


def _put(x, i, value):
    new = np.array(x)
    new[i] = value
    return new


def _store(rows, k, x):
    rows[k] = x


ARRAYS = {
    "root": np.sqrt,
    "magnitude": np.abs,
    "total": lambda x: float(np.sum(x)),
    "totals": lambda xs: np.array([np.sum(x) for x in xs]),
    "highest": lambda x: float(np.max(x)),
    "where_less": lambda x, y, one, other: np.where(x < y, one, other),
    "lanes_of": lambda x: np.full(8, x),
    "lane": lambda x, i: float(x[i]),
    "put": _put,
    "rows_of": lambda array: array,
    "load": lambda rows, k: rows[k].copy(),
    "store": _store,
}


def with_fields(loop):
    """The loop, told of fields by name, as compiled code is."""

    def call(*arguments):
        return loop(*(x.view(np.recarray) if named(x) else x for x in arguments))

    def named(x):
        return isinstance(x, np.ndarray) and x.dtype.names is not None

    return call


def registers_as_arrays():
    """The loop for pairs without a compiler."""
    stack = ExitStack()
    for name in ("kernels.simd", "pair.forces", "pair.step", "pair.loop"):
        module = importlib.import_module(f"tribo.{name}")
        own = {key: value for key, value in ARRAYS.items() if hasattr(module, key)}
        stack.enter_context(mock.patch.multiple(module, **own))
    adapter = "tribo.run.pair_adapter"
    importlib.import_module(adapter)
    config = SimpleNamespace(DISABLE_JIT=False)
    stack.enter_context(mock.patch(f"{adapter}.config", config))
    stack.enter_context(mock.patch(f"{adapter}.entry", lambda loop, *_: with_fields(loop)))
    return stack


# --- the process ---------------------------------------------------------------------------------


class Hangs(BaseException):
    """A check takes far longer than it should."""


class Baseline(NamedTuple):
    """What the checks reach, and at what cost, when nothing is changed."""

    seconds: dict[str, float]  # processor time of each check
    reached: dict[tuple[str, str], list[str]]  # checks that call a function, the cheapest first
    functions: dict[tuple[str, str], list[FunctionType]]


def where(code: CodeType) -> tuple[str, str]:
    """File and qualified name of a function of the package."""
    return os.path.relpath(code.co_filename, SOURCE), code.co_qualname


def uncompiled():
    """Make ready a process in which kernels are plain Python."""
    os.environ["NUMBA_DISABLE_JIT"] = "1"
    sys.dont_write_bytecode = True
    warnings.simplefilter("ignore")
    np.seterr(all="ignore")


@cache
def baseline() -> Baseline:
    """Run every check once; raises AssertionError if one of them complains."""
    seconds, called = {}, defaultdict(set)
    here = str(SOURCE)
    for name, check in CHECKS.items():
        check()  # solutions by other means, and what is made once

        def note(frame, event, argument, name=name):
            if event == "call" and frame.f_code.co_filename.startswith(here):
                called[where(frame.f_code)].add(name)

        began = process_time()
        sys.setprofile(note)
        try:
            said = check()
        finally:
            sys.setprofile(None)
        seconds[name] = process_time() - began
        assert not said, f"{name}: {said}"
    functions = defaultdict(list)
    for item in gc.get_objects():
        if isinstance(item, FunctionType) and item.__code__.co_filename.startswith(here):
            functions[where(item.__code__)].append(item)
    reached = {key: sorted(names, key=seconds.__getitem__) for key, names in called.items()}
    return Baseline(seconds, reached, functions)


def codes(code: CodeType):
    """All code within, with its qualified name."""
    for item in code.co_consts:
        if isinstance(item, CodeType):
            yield item
            yield from codes(item)


def verdict(file: str, function: str, source: str) -> str:
    """What the first check says that a mutant does not pass; empty if it passes all."""
    base = baseline()
    key = file, function
    (new,) = (c for c in codes(compile(source, str(SOURCE / file), "exec")) if where(c) == key)
    changed = base.functions[key]
    old = changed[0].__code__
    for item in changed:
        item.__code__ = new
    try:
        for name in base.reached.get(key, []):
            said = judged(CHECKS[name], HANGS * base.seconds[name] + 1.0)
            if said:
                return f"{name}: {said}"
        return ""
    finally:
        for item in changed:
            item.__code__ = old


def judged(check: Callable[[], str], seconds: float) -> str:
    """What a check says, which may take so much processor time."""

    def stop(*_):
        raise Hangs

    signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        return check()
    except (Exception, Hangs) as error:  # a mutant may fail in any way
        return f"{type(error).__name__}: {error}"
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
