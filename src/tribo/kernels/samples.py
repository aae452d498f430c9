"""Samples of a state: the asperites' coordinates, the accounts, and stored energies."""

from typing import Any, NamedTuple

import numpy as np

from tribo.compiler.jit import inlined, kernel
from tribo.compiler.lanes_memory import room, with_spare_lanes
from tribo.compiler.units import call_unit
from tribo.kernels import baths
from tribo.kernels.contact import contact_energy, energy_of_pair
from tribo.kernels.fields import field_energy
from tribo.kernels.packs import (
    absent,
    clear,
    column_range,
    halves,
)
from tribo.kernels.records import BATH_SAMPLES as BATH_SAMPLES_UNIT
from tribo.kernels.records import ELASTIC_ENERGIES
from tribo.kernels.records import SAMPLE as SAMPLE_UNIT
from tribo.kernels.springs import spring_energies

SPRINGS, BATH, TORSIONAL, WITHIN, MOMENTUM_X, MOMENTUM_Y, STORED = range(7)

# Rows of what samples may have of the baths: their force on each bar, and their kinetic energy.
# Displacements of oscillators from the bar follow on request: a row of each x, then of each y.
PULL_X, PULL_Y, KINETIC, BATH_ROWS = range(4)

# Ranges of axes of oscillators: those along x and y, and the torsional ones.
ALONG = (0, 2)
TURNING = (2, 3)


class State(NamedTuple):
    """Coordinates and velocities y = (q, v), accounts s, rounding errors, and rates of change.

    Splitting methods need neither rounding errors nor rates of change: theirs are empty.
    """

    y: np.ndarray
    y_low: np.ndarray  # rounding error of y
    s: np.ndarray
    s_low: np.ndarray  # rounding error of s
    acceleration: np.ndarray  # (coordinates,) q''
    power: np.ndarray  # (accounts,) s'
    memory: np.ndarray  # (k, coordinates) what a method keeps of its last step


class Attempt(NamedTuple):
    """A step that is tried.

    Where the lanes of packs are members of an ensemble, the times are Lanes.
    """

    t: Any  # where it begins [time]
    h: Any  # its length [time]
    end: Any  # where it ends [time]
    new: State  # room for the state there


def initial_state(y: np.ndarray, accounts: int, remembers: int, splits: bool) -> State:
    """The state at the start of a run, for a method that keeps `remembers` rows of memory."""
    n = y.size // 2
    return State(
        y=with_spare_lanes(y),
        y_low=room((0 if splits else y.size,)),
        s=room((accounts,)),
        s_low=room((0 if splits else accounts,)),
        acceleration=room((0 if splits else n,)),
        power=room((0 if splits else accounts,)),
        memory=room((remembers, n)),
    )


class Record(NamedTuple):
    """The samples of a run, one row each."""

    y: np.ndarray  # (times, 2 coordinates) without the baths
    s: np.ndarray  # (times, accounts)
    contact: np.ndarray  # (times,) energy of all contacts
    field: np.ndarray  # (times,) energy in all external fields
    stored: np.ndarray  # (times, surfaces, STORED) energies within, and the baths' momentum
    baths: np.ndarray  # (times, rows, n) the bath of each bar; empty where not asked for
    y_places: np.ndarray  # (2 coordinates,) where the kernels have them
    s_places: np.ndarray  # (accounts,) the same


# For the types of both in units.
EXAMPLE_OF_STATE = initial_state(np.zeros(0), 0, 0, splits=True)
EXAMPLE_OF_RECORD = Record(
    y=np.empty((0, 0)),
    s=np.empty((0, 0)),
    contact=np.empty(0),
    field=np.empty(0),
    stored=np.empty((0, 0, 0)),
    baths=np.empty((0, 0, 0)),
    y_places=np.empty(0, np.int64),
    s_places=np.empty(0, np.int64),
)


@kernel
def copy(source, target):
    """Make one array equal to another of its length.

    For `target[:] = source` numba takes a second to compile the message for unequal lengths.
    """
    for m in range(source.size):
        target[m] = source[m]


@kernel
def copy_rows(source, target):
    for i in range(target.shape[0]):
        copy(source[i], target[i])


def empty_state(state: State) -> State:
    """Room for another state like this one, for Python."""
    return State(*(room(array.shape) for array in state))


@kernel
def copy_state(source, target):
    copy(source.y, target.y)
    copy(source.y_low, target.y_low)
    copy(source.s, target.s)
    copy(source.s_low, target.s_low)
    copy(source.acceleration, target.acceleration)
    copy(source.power, target.power)
    copy_rows(source.memory, target.memory)


@kernel
def energies_within(model, neighbours, stored, lane):
    """Add the energies of interactions within a surface to what it stores."""
    contacts = model.contacts
    for n in range(contacts.energy.size):
        if contacts.within[n] == 1:
            for k in range(contacts.first[n], contacts.first[n + 1]):
                stored[contacts.pairs[k, 0], WITHIN] += energy_of_pair(
                    model, neighbours, n, k, lane
                )


@kernel
def bath_energies(model, table, axes, t, q, v, stored, lane):
    """Energy and momentum of oscillators, in the frame of their surface's initial velocity."""
    if not absent(table):
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            for i in range(*column_range(s, lane)):
                energy = 0.0
                for axis in range(*axes):
                    oscillators = baths.oscillators_of(s, i, axis)
                    bar = baths.place_of_bar(model, model.displaced, s, i, axis, t, q)
                    energy += baths.oscillator_energy(table, oscillators, q, v, bar)[0]
                    if axis < 2:
                        momentum = baths.oscillator_momentum(table, oscillators, v)
                        stored[k, MOMENTUM_X + axis] += momentum
                stored[k, BATH if axes[0] == 0 else TORSIONAL] += energy


@kernel
def write_baths(model, table, axes, t, q, v, record):
    """Record the force of the bath on each bar, its kinetic energy, and displacements from the bar.

    Those of as many oscillators as have rows; the record is clear before.
    """
    if not absent(table):
        half = (record.shape[0] - BATH_ROWS) // 2
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            for i in range(s.start, s.end):
                for axis in range(*axes):
                    oscillators = baths.oscillators_of(s, i, axis)
                    bar = baths.place_of_bar(model, model.displaced, s, i, axis, t, q)
                    record[KINETIC, i] += baths.oscillator_energy(table, oscillators, q, v, bar)[1]
                    if axis < 2:
                        record[PULL_X + axis, i] = baths.pull(table, oscillators, q, bar)
                        _, count, slot = oscillators
                        for n in range(min(half, count)):
                            record[BATH_ROWS + axis * half + n, i] = q[slot + n] - bar


@inlined
def first_place(place, lane):
    """A place in a vector, where that of the member in lane 0 is `place`."""
    return place + max(lane, 0)


@kernel
def write_row(model, neighbours, t, state, record, k, lane):
    """Record the state at time t in row k, that of one member in a lane; the bobs are in place."""
    call_unit(model.units[SAMPLE_UNIT], (model, neighbours, t, state, record, k, lane))


def sample_unit(model, neighbours, t, state, record, k, lane):
    """The unit of :func:`write_row`, which all loops share."""
    q, v = halves(state.y)
    for m in range(record.y_places.size):
        record.y[k, m] = state.y[first_place(record.y_places[m], lane)]
    for m in range(record.s_places.size):
        record.s[k, m] = state.s[first_place(record.s_places[m], lane)]
    record.contact[k] = contact_energy(model, neighbours, lane)
    record.field[k] = field_energy(model, t, lane)
    for m in range(record.stored.shape[1]):
        for j in range(STORED):
            record.stored[k, m, j] = 0.0
    spring_energies(model, model.springs, record.stored[k], SPRINGS, lane)
    if model.bodies:
        call_unit(model.units[ELASTIC_ENERGIES], (model, record.stored[k], SPRINGS))
    energies_within(model, neighbours, record.stored[k], lane)
    if not (absent(model.bath) and absent(model.torsional)):
        samples = record.stored[k], record.baths[k], lane
        call_unit(model.units[BATH_SAMPLES_UNIT], (model, t, q, v, *samples))
    return 0.0


def bath_samples(model, t, q, v, stored, baths, lane):
    """Record the energies and momenta of baths, and what else of them is asked for."""
    bath_energies(model, model.bath, ALONG, t, q, v, stored, lane)
    bath_energies(model, model.torsional, TURNING, t, q, v, stored, lane)
    if baths.shape[0] > 0:
        clear(baths)
        write_baths(model, model.bath, ALONG, t, q, v, baths)
        write_baths(model, model.torsional, TURNING, t, q, v, baths)
    return 0.0
