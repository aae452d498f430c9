"""Exact rotations of harmonic oscillators: torsion pendulums, and those of baths."""

import numpy as np

from tribo.compiler.jit import apart, inlined, kernel
from tribo.compiler.lanes import LANES, where_less
from tribo.compiler.lanes_functions import sine_cosine
from tribo.compiler.lanes_memory import pack, room, set_pack
from tribo.kernels import packs
from tribo.kernels.records import FREQUENCY

# Rows of a table of rotations, see :func:`rotation`.
VERSINE, OVER, TIMES = range(3)


def empty_rotations(table: np.ndarray, times: int) -> np.ndarray:
    """Room for the rotations of the columns of a table in some times, and for these times."""
    rotations = room((times, TIMES + 1, table.shape[1] + LANES))
    rotations[:] = np.nan
    return rotations


@inlined
def rotation(frequency, tau):
    """The rotation of oscillators in tau: 1 - cos, and sin over and times the frequency."""
    sin, cos = sine_cosine(frequency * (0.5 * tau))
    versine = 2.0 * sin * sin
    sin = 2.0 * sin * cos
    return versine, where_less(0.0, frequency, sin / frequency, tau), sin * frequency


@inlined
def changes(x, rate, turn):
    """How a rotation changes harmonic oscillators, and their rates.

    Rounding of cos^2 + sin^2 causes no energy drift.
    """
    versine, over, times = turn
    return over * rate - versine * x, -versine * rate - times * x


@kernel
def set_rotations(frequencies, tau, rotations):
    """Set every oscillator's rotation in tau, which is kept in the last column."""
    last = frequencies.size
    if rotations[0, last] == tau:
        return
    rotations[0, last] = tau
    for i in range(0, last, LANES):
        set_rotation(frequencies, i, tau, rotations)


@inlined
def set_active_rotations(model, active, tau, rotations):
    """The same of pendulums in active packs; the time of their selection is kept as well."""
    last = model.constants.shape[1]
    selected = 0.0
    if active is not None:
        if active.packs.size > 0:
            selected = active.selected[0]
    if rotations[0, last] != tau or rotations[0, last + 1] != selected:
        set_other_rotations(model, active, tau, selected, rotations)


@apart
def set_other_rotations(model, active, tau, selected, rotations):
    """The same for another time, or other active packs, than those that are in place."""
    frequencies = model.constants[FREQUENCY]
    last = frequencies.size
    rotations[0, last] = tau
    rotations[0, last + 1] = selected
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if s.constants_mask == 0:
            set_rotation(frequencies, s.first_constants, tau, rotations)
        else:
            for n in range(*packs.active_range(active, s, k)):
                i = packs.column_of_constants(s, packs.column_of(active, n))
                set_rotation(frequencies, i, tau, rotations)


@kernel
def set_rotation(frequencies, i, tau, rotations):
    """Set the rotations of a pack of oscillators in tau."""
    versine, over, times = rotation(pack(frequencies, i), tau)
    set_pack(rotations[VERSINE], i, versine)
    set_pack(rotations[OVER], i, over)
    set_pack(rotations[TIMES], i, times)


@inlined
def rotation_of(rotations, i):
    """The rotations of a pack of oscillators, as :func:`rotation` returns them."""
    return pack(rotations[VERSINE], i), pack(rotations[OVER], i), pack(rotations[TIMES], i)
