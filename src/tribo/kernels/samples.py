"""Samples of a state: the asperites' coordinates, the accounts, and stored energies."""

from typing import NamedTuple

import numpy as np
from numba import literal_unroll

from tribo.compiler.jit import inlined, kernel
from tribo.compiler.lanes_memory import room, with_spare_lanes
from tribo.kernels import baths
from tribo.kernels.blocks import clear, first_column, halves, stride_of
from tribo.kernels.contact import contact_energy, pair_energy
from tribo.kernels.fields import field_energy
from tribo.kernels.springs import spring_energies

SPRINGS, BATH, TORSIONAL, WITHIN, MOMENTUM_X, MOMENTUM_Y, STORED = range(7)

# Rows of what samples may have of the baths: their force on each bar, and their kinetic energy.
# Displacements of oscillators from the bar follow on request: a row of each x, then of each y.
PULL_X, PULL_Y, KINETIC, BATH_ROWS = range(4)


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


@kernel
def copy(source, target):
    """Make one array equal to another of its length.

    For `target[:] = source` numba takes a second to compile the message for unequal lengths.
    """
    for m in range(source.size):
        target[m] = source[m]


@kernel
def copy_rows(source, target):
    """Make the rows of one array equal to those of another."""
    for i in range(target.shape[0]):
        copy(source[i], target[i])


def empty_state(state: State) -> State:
    """Room for another state like this one, for Python."""
    return State(*(room(array.shape) for array in state))


@kernel
def copy_state(source, target):
    """Make one state equal to another."""
    copy(source.y, target.y)
    copy(source.y_low, target.y_low)
    copy(source.s, target.s)
    copy(source.s_low, target.s_low)
    copy(source.acceleration, target.acceleration)
    copy(source.power, target.power)
    copy_rows(source.memory, target.memory)


@kernel
def bath_energies(model, bath, q, v, stored, lane):
    """Energy and momentum of each surface's bath, in the frame of its initial velocity."""
    if bath is not None:
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            first = s.first_oscillator
            count = s.oscillators
            if count > 0:
                for i in range(first_column(s, lane), s.end, stride_of(lane)):
                    energy = 0.0
                    for axis in range(2):
                        m = baths.first_slot(s, i) + axis * count
                        bar = model.displaced[axis, i]
                        energy += baths.oscillator_energy(bath, first, count, q, v, m, bar)
                        momentum = baths.oscillator_momentum(bath, first, count, v, m)
                        stored[k, MOMENTUM_X + axis] += momentum
                    stored[k, BATH] += energy


@kernel
def energies_within(model, within, neighbours, stored, lane):
    """Energy of the contact among each surface's own bobs."""
    if within is not None:
        for contact in literal_unroll(within):
            for k in range(contact.pairs.shape[0]):
                owner = contact.pairs[k, 0]
                stored[owner, WITHIN] += pair_energy(model, contact, k, neighbours, lane)


@kernel
def torsional_energies(model, torsional, t, q, v, stored, lane):
    """Energy of each surface's torsional oscillators."""
    if torsional is not None:
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            first = s.first_torsional
            count = s.torsionals
            if count > 0:
                for i in range(first_column(s, lane), s.end, stride_of(lane)):
                    phi = baths.bar_angle(model, s, i, t, q)
                    m = baths.torsional_slot(s, i)
                    energy = baths.oscillator_energy(torsional, first, count, q, v, m, phi)
                    stored[k, TORSIONAL] += energy


@kernel
def write_baths(model, bath, q, v, record):
    """Record the force of the bath on each bar, its kinetic energy, and displacements from the bar.

    Those of as many oscillators as have rows; the record is clear before.
    """
    if bath is not None:
        half = (record.shape[0] - BATH_ROWS) // 2
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            first = s.first_oscillator
            count = s.oscillators
            for i in range(s.start, s.end):
                for axis in range(2):
                    m = baths.first_slot(s, i) + axis * count
                    bar = model.displaced[axis, i]
                    record[PULL_X + axis, i] = baths.pull(bath, first, count, q, m, bar)
                    record[KINETIC, i] += baths.oscillator_kinetic(bath, first, count, v, m)
                    for n in range(min(half, count)):
                        record[BATH_ROWS + axis * half + n, i] = q[m + n] - bar


@kernel
def add_torsional_kinetic(model, torsional, v, record):
    """Add the kinetic energy of the torsional oscillators on each bar."""
    if torsional is not None:
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            for i in range(s.start, s.end):
                m = baths.torsional_slot(s, i)
                energy = baths.oscillator_kinetic(torsional, s.first_torsional, s.torsionals, v, m)
                record[KINETIC, i] += energy


@inlined
def first_place(place, lane):
    """A place in a vector, where that of the member in lane 0 is `place`."""
    if lane is None:
        return place
    return place + lane


@kernel
def write_sample(model, neighbours, clock, state, record):
    """Record the state as the next sample; the bobs are in place."""
    write_row(model, neighbours, clock.t, state, record, clock.sample, None)
    clock.sample += 1


@kernel
def write_row(model, neighbours, t, state, record, k, lane):
    """Record the state at time t in row k of a record, for `lane` that of one member."""
    q, v = halves(state.y)
    for m in range(record.y_places.size):
        record.y[k, m] = state.y[first_place(record.y_places[m], lane)]
    for m in range(record.s_places.size):
        record.s[k, m] = state.s[first_place(record.s_places[m], lane)]
    record.contact[k] = contact_energy(model, neighbours, lane)
    record.field[k] = field_energy(model, model.fields, t, lane)
    for m in range(record.stored.shape[1]):
        for j in range(STORED):
            record.stored[k, m, j] = 0.0
    spring_energies(model, model.springs, record.stored[k], SPRINGS, lane)
    energies_within(model, model.within, neighbours, record.stored[k], lane)
    bath_energies(model, model.bath, q, v, record.stored[k], lane)
    torsional_energies(model, model.torsional, t, q, v, record.stored[k], lane)
    if record.baths.shape[1] > 0:
        clear(record.baths[k])
        write_baths(model, model.bath, q, v, record.baths[k])
        add_torsional_kinetic(model, model.torsional, v, record.baths[k])
