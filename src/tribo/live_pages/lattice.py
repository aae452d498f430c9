"""The time loop of a row or grid for a page: its functions, their arguments, and their memory."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from tribo.compiler.kept import keep
from tribo.compiler.lanes_memory import room
from tribo.compiler.units import unit_codes
from tribo.integrators.methods import named
from tribo.kernels.model import Model, Neighbours
from tribo.kernels.records import Y_START
from tribo.layout.layout import Layout
from tribo.live_pages import lattice_asperite as asperites
from tribo.live_pages import lattice_quantities as quantities
from tribo.live_pages.image import Image, image_of
from tribo.live_pages.lattice_loop import legs_of_page, loop_of_page
from tribo.live_pages.lattice_setup import (
    CONSTANTS,
    OF_ASPERITE,
    OF_SURFACE,
    PERIOD,
    Hung,
    hung_in,
    live_setup,
    parameters_of,
    sines_of,
)
from tribo.loops.general import GeneralLoop
from tribo.loops.setting import Setting
from tribo.threads.writable_memory import arrays_in

METHOD = "verlet"
# Bounds on errors relative to the largest values: less than a figure shows.
ACCURACY = 1e-4
# Steps before a run is given up.
MOST_STEPS = 2_000_000
# Runs that a page makes: of all samples, and of the first and the last alone.
FULL, SHORT = RUNS = ("full", "short")


@dataclass(frozen=True, eq=False)
class Call:
    """A function that a page calls, with arguments that stand in an image."""

    name: str
    function: Any  # of Python, compiled by numba
    arguments: tuple[Any, ...]


@dataclass(frozen=True, eq=False)
class Program:
    """What a page calls: for each of RUNS the loop, its quantities, and bounds on their errors."""

    calls: dict[str, tuple[Call, ...]]
    columns: tuple[np.ndarray, ...]  # of samples, see :func:`tribo.ledger.samples.sample_columns`
    written: tuple[np.ndarray, ...]  # arrays that need no values before a run
    results: dict[str, dict[str, np.ndarray]]  # for each of RUNS, by name
    units: dict[int, int]  # number of each unit by its address
    names: tuple[str, ...]  # what tells each unit apart in all processes
    method: str
    plugins: tuple[Any, ...]  # which may have arrays
    scene: asperites.Scene
    derived: tuple[np.ndarray, ...]  # parts of arrays that the call "setup" sets

    def image(self) -> Image:
        """The memory of all arguments."""
        every = tuple(call.arguments for calls in self.calls.values() for call in calls)
        return image_of((*every, self.plugins), self.written, self.units)


class _Shared(NamedTuple):
    """What both runs of a program share."""

    layout: Layout
    loop: GeneralLoop
    lists: Neighbours  # of the quantities
    columns: tuple[np.ndarray, ...]
    scratch: tuple[np.ndarray, ...]
    scene: asperites.Scene
    method: str
    accuracy: float


class _Run(NamedTuple):
    """The calls of a run behind the setup, their results by name, and the stops of its loop."""

    calls: tuple[Call, ...]
    results: dict[str, np.ndarray]
    stops: np.ndarray


def program_of(
    layout: Layout, step: float, method: str = METHOD, accuracy: float = ACCURACY
) -> Program:
    """The program of a scene with equal steps.  Raises InputError if a plug-in does not compile."""
    loop = GeneralLoop(layout, named(method), Setting(step=step), layout.start, 0.0)
    loop.make_all_room()
    lists = layout.neighbours()
    columns = tuple(np.zeros(each.shape) for each in loop.room(layout.times.size))
    scratch = room((layout.room[0],)), room((layout.room[0],))
    scene = _scene_of(layout)
    sines = sines_of(layout)
    hung = hung_in(layout, loop.state.y)
    setup = Call("setup", live_setup, (keep(loop.model), scene, parameters_of(layout), sines, hung))
    shared = _Shared(layout, loop, lists, columns, scratch, scene, method, accuracy)
    runs = {FULL: _run_of(shared, layout.times), SHORT: _run_of(shared, layout.times[[0, -1]])}
    searched = (*_found_by(lists), *_found_by(loop.neighbours))
    written: tuple[np.ndarray, ...] = (*columns, *arrays_in(searched))
    for run in runs.values():
        results = run.results.items()
        written = *written, run.stops, *(array for name, array in results if name != "times")
    codes = known_units()
    units = _numbered_units(loop.model, codes)
    return Program(
        calls={name: (setup, *run.calls) for name, run in runs.items()},
        columns=columns,
        written=written,
        results={name: run.results for name, run in runs.items()},
        units=units,
        names=tuple(codes[each][0] for each in units),
        method=method,
        plugins=tuple(layout.plugins),
        scene=scene,
        derived=_derived(loop, scene, sines, hung),
    )


def _run_of(shared: _Shared, times: np.ndarray) -> _Run:
    """The run with samples at some times."""
    layout = shared.layout
    loop = shared.loop
    scene = shared.scene
    own = times.copy()
    rows = len(layout.parts) * quantities.MEMBERS + quantities.WHOLE
    results = {
        "series": np.zeros((rows, own.size)),
        "other": np.zeros((rows, own.size)),
        "drawn": np.zeros((len(asperites.Drawn._fields), own.size, layout.scene.count)),
        "errors": np.zeros(rows),
        "reached": np.zeros(1, np.int64),
        "others": np.zeros(1, np.int64),
        "times": own,
    }
    series, other, drawn, errors, reached, others, _ = results.values()
    stops = np.zeros(own.size)
    of_loop = _arguments_of_loop(loop, own, shared.columns, scene, stops)
    samples = asperites.Samples(own, *shared.columns[:5], loop.recorded[0])  # type: ignore[call-arg]
    of_scene = keep(loop.model), keep(shared.lists)
    seen = of_scene, scene, samples, shared.scratch, loop.clocks, reached, series, drawn
    dimensions = np.array(quantities.dimensions_of(len(layout.parts)))
    compared = series, other, reached, others, dimensions, errors, shared.accuracy
    calls = (
        Call("steps", loop_of_page(shared.method), of_loop),
        Call("quantities", quantities.live_quantities, seen),
        Call("errors", quantities.live_errors, compared),
    )
    return _Run(calls, results, stops)


def _derived(
    loop: GeneralLoop, scene: asperites.Scene, sines: np.ndarray, hung: Hung
) -> tuple[np.ndarray, ...]:
    """The parts of arrays that the call "setup" sets."""
    model = loop.model
    y = loop.state.y
    return (
        *(scene.asperites[name] for name in OF_ASPERITE),
        *(surfaces[name] for surfaces in (scene.surfaces, model.surfaces) for name in OF_SURFACE),
        *(model.constants[row] for row in CONSTANTS),
        model.each[Y_START],
        model.pivots,
        model.schedules,
        hung.displaced,
        *(y[place : place + 1] for place in hung.oscillators[:, 2].tolist()),
        *(scene.legs.tables[:, row] for row in np.flatnonzero(sines[:, PERIOD] > 0.0)),
    )


def _arguments_of_loop(
    loop: GeneralLoop, times: np.ndarray, columns: Any, scene: asperites.Scene, stops: np.ndarray
) -> tuple[Any, ...]:
    """Those of :func:`tribo.live_pages.lattice_loop.loop_of_page`."""
    every = loop.arguments(times, columns, MOST_STEPS)
    model, neighbours, method, step, clocks, state, _, record, budget, *scratch = every
    of_scene = model, neighbours
    of_run = clocks, state, record
    return step, of_scene, method, of_run, times, budget, scene.legs, (stops, *scratch)


def known_units() -> dict[int, tuple[str, Any]]:
    """Address -> what tells a unit apart in all processes, and the unit.

    Whether arrays of a potential can be written does not matter: copies of them in another process
    can.
    """
    return {at: (name.replace("readonly ", ""), unit) for at, (name, unit) in unit_codes().items()}


def _found_by(lists: Neighbours) -> tuple[Any, ...]:
    """What the search for neighbours writes before it reads it."""
    return lists.own, lists.others, lists.cells


def _numbered_units(model: Model, codes: dict[int, tuple[str, Any]]) -> dict[int, int]:
    """The number of each unit that a model calls, by its address."""
    words = np.concatenate([each.view(np.int64).ravel() for each in _units_of(model)])
    addresses = [each for each in words.tolist() if each in codes]
    return {address: n for n, address in enumerate(dict.fromkeys(addresses))}


def _units_of(model: Model) -> tuple[np.ndarray, ...]:
    """The arrays with addresses of units."""
    contacts = model.contacts
    fields = model.fields
    return (
        *(model.units, contacts.forces, contacts.energy, contacts.clearances),
        *(fields.forces, fields.energy, fields.power, model.drives.forces, model.ends.forces),
    )


def _scene_of(layout: Layout) -> asperites.Scene:
    """What quantities follow from beside samples."""
    origin = [*layout.origin, 0.0, 0.0]
    return asperites.Scene(
        asperites=np.ascontiguousarray(layout.asperites).view(np.recarray),
        surfaces=np.ascontiguousarray(layout.surfaces).view(np.recarray),
        numbers=np.concatenate([origin, layout.velocities.ravel()]),
        field_accounts=np.array(layout.accounts_of_fields, np.int64),
        columns=np.asarray(layout.places.columns, np.int64),
        swings=np.asarray(layout.places.q[: layout.scene.count], np.int64),
        core=layout.core,
        legs=legs_of_page(layout),
    )
