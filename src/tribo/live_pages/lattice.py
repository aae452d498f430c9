"""The time loop of a row or grid for a page: its functions, their arguments, and their memory."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from tribo.compiler.kept import keep
from tribo.compiler.lanes_memory import room
from tribo.compiler.units import unit_codes
from tribo.integrators.methods import named
from tribo.kernels.model import Model, Neighbours
from tribo.kernels.records import Y_START
from tribo.layout.layout import Layout
from tribo.live_pages import lattice_quantities as quantities
from tribo.live_pages.image import Image, image_of
from tribo.live_pages.lattice_loop import legs_of_page, loop_of_page
from tribo.live_pages.lattice_setup import (
    CONSTANTS,
    OF_ASPERITE,
    OF_SURFACE,
    PERIOD,
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
    scene: quantities.Scene
    derived: tuple[np.ndarray, ...]  # parts of arrays that the call "setup" sets

    def image(self) -> Image:
        """The memory of all arguments."""
        every = tuple(call.arguments for calls in self.calls.values() for call in calls)
        return image_of((*every, self.plugins), self.written, self.units)


def program_of(
    layout: Layout, step: float, method: str = METHOD, accuracy: float = ACCURACY
) -> Program:
    """The program of a scene with equal steps.  Raises InputError if a plug-in does not compile."""
    loop = GeneralLoop(layout, named(method), Setting(step=step), layout.start, 0.0)
    loop.make_all_room()
    lists = layout.neighbours()
    columns = tuple(np.zeros(each.shape) for each in loop.room(layout.times.size))
    rows = len(layout.parts) * quantities.MEMBERS + quantities.WHOLE
    dimensions = np.array(quantities.dimensions_of(len(layout.parts)))
    scratch = room((layout.room[0],)), room((layout.room[0],))
    scene = _scene_of(layout)
    model = loop.model
    sines = sines_of(layout)
    y = loop.state.y
    hung = hung_in(layout, y)
    given = keep(model), scene, parameters_of(layout), sines, hung
    setup = Call("setup", live_setup, given)
    calls: dict[str, tuple[Call, ...]] = {}
    results: dict[str, dict[str, np.ndarray]] = {}
    searched = (*_found_by(lists), *_found_by(loop.neighbours))
    written: tuple[np.ndarray, ...] = (*columns, *arrays_in(searched))
    for name, times in {FULL: layout.times, SHORT: layout.times[[0, -1]]}.items():
        own = times.copy()
        series, other = np.zeros((rows, own.size)), np.zeros((rows, own.size))
        stops = np.zeros(own.size)
        of_loop = _arguments_of_loop(loop, own, columns, scene, stops)
        drawn = np.zeros((len(quantities.Drawn._fields), own.size, layout.scene.count))
        errors = np.zeros(rows)
        samples = quantities.Samples(own, *columns[:5], loop.recorded[0])  # type: ignore[call-arg]
        reached, others = np.zeros(1, np.int64), np.zeros(1, np.int64)
        of_run = scene, samples, scratch, loop.clocks, reached, series, drawn
        seen = keep(loop.model), keep(lists), *of_run
        compared = series, other, reached, others, dimensions, errors, accuracy
        calls[name] = (
            setup,
            Call("steps", loop_of_page(method), of_loop),
            Call("quantities", quantities.live_quantities, seen),
            Call("errors", quantities.live_errors, compared),
        )
        results[name] = {
            "series": series,
            "other": other,
            "drawn": drawn,
            "errors": errors,
            "reached": reached,
            "others": others,
        }
        written = *written, stops, *results[name].values()
        results[name]["times"] = own
    codes = known_units()
    words = np.concatenate([each.view(np.int64).ravel() for each in _units_of(loop.model)])
    addresses = [each for each in words.tolist() if each in codes]
    units = {address: n for n, address in enumerate(dict.fromkeys(addresses))}
    derived = (
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
    names = tuple(codes[each][0] for each in units)
    plugins = tuple(layout.plugins)
    return Program(calls, columns, written, results, units, names, method, plugins, scene, derived)


def _arguments_of_loop(
    loop: GeneralLoop, times: np.ndarray, columns: Any, scene: quantities.Scene, stops: np.ndarray
) -> tuple[Any, ...]:
    """Those of :func:`tribo.live_pages.lattice_loop.loop_of_page`."""
    every = loop.arguments(times, columns, MOST_STEPS)
    model, neighbours, method, step, clocks, state, _, record, budget, *scratch = every
    of_scene = model, neighbours
    of_run = clocks, state, record
    return step, of_scene, method, of_run, times, budget, scene.legs, stops, tuple(scratch)


def known_units() -> dict[int, tuple[str, Any]]:
    """Address -> what tells a unit apart in all processes, and the unit.

    Whether arrays of a potential can be written does not matter: copies of them in another process
    can.
    """
    return {at: (name.replace("readonly ", ""), unit) for at, (name, unit) in unit_codes().items()}


def _found_by(lists: Neighbours) -> tuple[Any, ...]:
    """What the search for neighbours writes before it reads it."""
    return lists.own, lists.others, lists.cells


def _units_of(model: Model) -> tuple[np.ndarray, ...]:
    """The arrays with addresses of units."""
    contacts = model.contacts
    fields = model.fields
    return (
        *(model.units, contacts.forces, contacts.energy, contacts.clearance),
        *(fields.forces, fields.energy, fields.power, model.drives.forces, model.ends.forces),
    )


def _scene_of(layout: Layout) -> quantities.Scene:
    """What quantities follow from beside samples."""
    origin = [*layout.origin, 0.0, 0.0]
    return quantities.Scene(
        asperites=np.ascontiguousarray(layout.asperites).view(np.recarray),
        surfaces=np.ascontiguousarray(layout.surfaces).view(np.recarray),
        numbers=np.concatenate([origin, layout.velocities.ravel()]),
        field_accounts=np.array(layout.accounts_of_fields, np.int64),
        columns=np.asarray(layout.places.columns, np.int64),
        swings=np.asarray(layout.places.q[: layout.scene.count], np.int64),
        core=layout.core,
        legs=legs_of_page(layout),
    )
