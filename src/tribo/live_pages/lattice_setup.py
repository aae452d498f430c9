"""From the parameters of asperites in a row or grid to the tables that its time loop reads.

The rules are those of :mod:`tribo.layout.tables`; ``tests/live_pages`` compares both.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from tribo.compiler.jit import inlined, kernel
from tribo.compiler.lanes import LANES
from tribo.kernels import records as rows
from tribo.kernels import schedule
from tribo.layout.layout import Layout
from tribo.layout.legs import scheduled_numbers
from tribo.layout.scene_records import resting_bobs
from tribo.layout.start import bath_slots
from tribo.live_pages.lattice_loop import set_leg
from tribo.live_pages.setup import masses_and_arms

# Rows of the table of parameters, one column an asperite.
M1, M2, LENGTH, KAPPA, BAR_LENGTH, I2, BOB_Y = range(7)
# Columns of the table of sines.
PERIOD, MEAN, AMPLITUDE, PHASE, IS_INTEGRAL, DRIFT = range(6)
SINES = 6
NAMES = ("m1", "m2", "length", "kappa", "bar_length", "i2")
# Numbers of an asperite and rows of tables that follow from the parameters.
OF_ASPERITE = ("mass", "inertia", "kappa", "l1", "l2", "i2", "bar_length", "pivot", "y")
OF_SURFACE = ("mass", "total_mass", "inverse_total_mass")
CONSTANTS = (
    *(rows.MASS, rows.INERTIA, rows.KAPPA, rows.L1, rows.L2, rows.I2, rows.BAR_LENGTH),
    *(rows.FREQUENCY, rows.INVERSE_MASS, rows.INVERSE_INERTIA, rows.INVERSE_BAR_LENGTH),
)


def parameters_of(layout: Layout) -> np.ndarray:
    """The parameters of all asperites of a scene, (7, asperites)."""
    table = np.empty((len(NAMES) + 1, layout.scene.count))
    for index, surface in enumerate(layout.scene.surfaces):
        own = layout.scene.parts[surface.name]
        for row, name in enumerate(NAMES):
            table[row, own] = surface.each[name]
        table[BOB_Y, own] = resting_bobs(layout.scene, index)[:, 1]
    return table


def sines_of(layout: Layout) -> np.ndarray:
    """The numbers of all schedules that are sines, (1 + schedules, 6), as rows of their table.

    Rows of other schedules are 0.
    """
    numbers = scheduled_numbers(layout.scene)
    table = np.zeros((1 + len(numbers), SINES))
    for row, each in enumerate(numbers, start=1):
        own = each.schedule
        if own.is_sine:
            is_integral = float(each.is_integral)
            table[row] = own.period, own.mean, own.amplitude, own.phase, is_integral, each.drift
    return table


class Hung(NamedTuple):
    """Oscillators of baths, which start at their bars, or drawn about these.

    A pendulum that starts with a swing displaces its bar, if that can move.
    """

    displaced: Any  # (2, asperites) of the bars in the start that `y` has, along x and y
    oscillators: Any  # (n, 3) asperite, axis, and place in y of each coordinate
    y: Any  # the state


@inlined
def displaced_bar(a, swing):
    """The displacement of a bar by the swing of its pendulum; 0 where the bar is held."""
    arm = (a.l2 - a.pivot) * a.facing
    half = math.sin(0.5 * swing)
    return -arm * math.sin(swing), -arm * 2.0 * (half * half)


def hung_in(layout: Layout, y: np.ndarray) -> Hung:
    """The oscillators of a scene whose start stands in `y`, as its loop has it."""
    scene = layout.scene
    swings = layout.start.tolist()
    bars = [
        displaced_bar.py_func(a, swing)
        for a, swing in zip(layout.asperites, swings[: scene.count], strict=True)
    ]
    found = []
    for surface, part in zip(scene.surfaces, scene.parts.values(), strict=True):
        own = layout.asperites[part]
        for axis, slots in enumerate(bath_slots(own, surface.bath)[:2]):
            for i, each in enumerate(layout.places.q[slots].tolist(), start=part.start):
                found += [(i, axis, place) for place in each]
    return Hung(np.array(bars).T.copy(), np.array(found, np.int64).reshape(-1, 3), y)


@kernel
def hang_baths(scene, hung):
    """Displace oscillators with their bars."""
    before = hung.displaced
    for n in range(hung.oscillators.shape[0]):
        i = hung.oscillators[n, 0]
        place = hung.oscillators[n, 2]
        now = displaced_bar(scene.asperites[i], hung.y[scene.swings[i]])
        axis = hung.oscillators[n, 1]
        change = now[0] - before[0, i] if axis == 0 else now[1] - before[1, i]
        hung.y[place] += change
    for i in range(scene.asperites.shape[0]):
        x, y = displaced_bar(scene.asperites[i], hung.y[scene.swings[i]])
        before[0, i] = x
        before[1, i] = y


@kernel
def set_sine(table, sine):
    """Set a row of a table of schedules from the numbers of a sine, or of its integral."""
    mean, amplitude, phase = sine[MEAN], sine[AMPLITUDE], sine[PHASE]
    frequency = 2.0 * math.pi / sine[PERIOD]
    table[schedule.FREQUENCY] = frequency
    if sine[IS_INTEGRAL] > 0.0:
        swing = amplitude / frequency
        table[schedule.C0] = swing * math.cos(phase)
        table[schedule.C1] = mean - sine[DRIFT]
        table[schedule.AMPLITUDE] = swing
        table[schedule.PHASE] = phase - 0.5 * math.pi
    else:
        table[schedule.C0] = mean
        table[schedule.C1] = -sine[DRIFT]
        table[schedule.AMPLITUDE] = amplitude
        table[schedule.PHASE] = phase


@kernel
def set_constants(constants, i, a, parameters):
    """Set a column of the table of constants from an asperite whose numbers are set.

    Driven bars keep their infinite mass, and rigid asperites their infinite inertia and no kappa.
    """
    pivot = a.pivot
    if not math.isinf(constants[rows.MASS, i]):
        constants[rows.MASS, i] = a.mass
    is_rigid = math.isinf(constants[rows.INERTIA, i])
    kappa = 0.0 if is_rigid else parameters[KAPPA]
    about = constants[rows.INERTIA, i] if is_rigid else a.inertia + a.mass * (pivot * pivot)
    mobility = 1.0 / about
    if a.dof_phi >= 0:
        mobility += 1.0 / parameters[I2]
    constants[rows.INERTIA, i] = about
    constants[rows.KAPPA, i] = kappa
    constants[rows.L1, i] = a.l1 + pivot
    constants[rows.L2, i] = 0.0 if pivot > 0.0 else a.l2
    constants[rows.I2, i] = parameters[I2]
    constants[rows.BAR_LENGTH, i] = parameters[BAR_LENGTH]
    constants[rows.FREQUENCY, i] = math.sqrt(kappa * mobility)
    constants[rows.INVERSE_MASS, i] = 1.0 / constants[rows.MASS, i]
    constants[rows.INVERSE_INERTIA, i] = 1.0 / about
    constants[rows.INVERSE_BAR_LENGTH, i] = 1.0 / parameters[BAR_LENGTH]


@kernel
def set_asperite(model, scene, table, i):
    """Set what follows from the parameters of an asperite; returns its mass."""
    a = scene.asperites[i]
    s = model.surfaces[a.surface]
    parameters = table[:, i]
    mass, l1, l2, inertia = masses_and_arms(parameters[M1], parameters[M2], parameters[LENGTH])
    pivot = l2 if a.pivot > 0.0 else 0.0
    a.mass = mass
    a.inertia = inertia
    a.kappa = 0.0 if s.fixed > 0 else parameters[KAPPA]
    a.l1 = l1
    a.l2 = l2
    a.i2 = parameters[I2]
    a.bar_length = parameters[BAR_LENGTH]
    a.pivot = pivot
    a.y = parameters[BOB_Y] + a.facing * l1
    column = scene.columns[i]
    model.each[rows.Y_START, column] = a.y + a.facing * pivot
    place = s.first_constants + ((column - s.start) & s.constants_mask)
    others = LANES if s.constants_mask == 0 else 1  # that share a pack of the first
    for n in range(others):
        set_constants(model.constants, place + n, a, parameters)
        if model.pivots.shape[1] > 0:
            model.pivots[0, place + n] = pivot
    return mass


def live_setup(model, scene, table, sines, hung):
    """Set all that follows from the parameters of asperites, the numbers of sines, and swings."""
    for row in range(sines.shape[0]):
        if sines[row, PERIOD] > 0.0:
            for leg in range(scene.legs.tables.shape[0]):
                set_sine(scene.legs.tables[leg, row], sines[row])
    set_leg(model, scene.legs, 0)
    i = 0
    for n in range(scene.surfaces.shape[0]):
        mass = 0.0
        while i < scene.asperites.shape[0] and scene.asperites[i].surface == n:
            mass += set_asperite(model, scene, table, i)
            i += 1
        own = scene.surfaces[n]
        theirs = model.surfaces[n]
        whole = mass + (own.total_mass - own.mass)
        own.mass = theirs.mass = mass
        own.total_mass = theirs.total_mass = whole
        own.inverse_total_mass = theirs.inverse_total_mass = 1.0 / whole
    hang_baths(scene, hung)
    return 0
