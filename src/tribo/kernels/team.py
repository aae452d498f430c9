"""Threads that share the work of a step.

A step has phases: contact, drift, kick.  Each phase has a number of pieces that depends on
the scene alone, and each piece writes where no other does, so that the results have the same bits
for any number of threads.  The thread of the time loop begins a phase and takes pieces until none
is left; assistants take pieces too.  Then it waits for the pieces that assistants have taken.  None
waits for an assistant that the operating system has stopped between two pieces.

Pieces have tickets, which are numbered through all phases.  A thread takes the next ticket with a
compare-and-swap; as long as its piece is not finished, the phase cannot change.
"""

import os
from typing import NamedTuple

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from tribo.kernels.compiled import kernel
from tribo.kernels.simd_arrays import element

# Phases.
CONTACT, REACTIONS, DRIFT, KICK = range(4)

# Places of the counters.  Those that threads write at the same time are in cache lines of their
# own, of at most 16 numbers.
TICKET, DONE, END, CLOSED, PHASE, FIRST, INTERACTION, PAIR = 0, 16, 32, 48, 49, 50, 51, 52
COUNTERS = 64

# Looks for work after which a waiting thread lets others have its core: about a microsecond.
LOOKS = 200


class Team(NamedTuple):
    """What threads share, and how their work is divided."""

    counters: np.ndarray  # (COUNTERS,): tickets taken, pieces finished, tickets there are, ...
    numbers: np.ndarray  # (2,) of the present phase: times
    tiles: np.ndarray  # (tiles, 3) surface, which of its tiles, and how many it has
    reach: np.ndarray  # (chunks, 2) columns first <= i < last of the reactions to each chunk
    reactions: np.ndarray  # (2 chunks, n) x and y of the reactions to the rows of each chunk


@intrinsic
def _load(typing_context, array, i):
    """Element i, and all that was written before it."""

    def build(context, builder, sig, args):
        place = element(context, builder, sig.args[0], *args)
        return builder.load_atomic(place, "acquire", 8)

    return types.int64(array, types.intp), build


@intrinsic
def _publish(typing_context, array, i, value):
    """Set element i, after all that was written before."""

    def build(context, builder, sig, args):
        place = element(context, builder, sig.args[0], *args[:2])
        builder.store_atomic(args[2], place, "release", 8)
        return context.get_dummy_value()

    return types.void(array, types.intp, types.int64), build


@intrinsic
def _count(typing_context, array, i):
    """Add one to element i, after all that was written before."""

    def build(context, builder, sig, args):
        place = element(context, builder, sig.args[0], *args)
        builder.atomic_rmw("add", place, ir.Constant(ir.IntType(64), 1), "acq_rel")
        return context.get_dummy_value()

    return types.void(array, types.intp), build


@intrinsic
def _claim(typing_context, array, i, value):
    """Add one to element i if it is `value`; whether it was."""

    def build(context, builder, sig, args):
        place = element(context, builder, sig.args[0], *args[:2])
        more = builder.add(args[2], ir.Constant(ir.IntType(64), 1))
        found = builder.cmpxchg(place, args[2], more, "acq_rel", "acquire")
        return builder.extract_value(found, 1)

    return types.boolean(array, types.intp, types.int64), build


@intrinsic
def _yield(typing_context):
    """Let another thread have the core, if one waits for it."""

    def build(context, builder, sig, args):
        kind = ir.FunctionType(ir.IntType(32), [])
        name = "SwitchToThread" if os.name == "nt" else "sched_yield"
        builder.call(cgutils.get_or_insert_function(builder.module, kind, name), [])
        return context.get_dummy_value()

    return types.void(), build


@kernel
def begin_phase(team, phase, pieces):
    """Offer the pieces of a phase to all threads; what else it needs is in place."""
    counters = team.counters
    counters[PHASE] = phase
    counters[FIRST] = counters[END]
    _publish(counters, END, counters[END] + pieces)


@kernel
def next_piece(team):
    """Take the next piece of the present phase; -1 where none is left."""
    counters = team.counters
    while True:
        ticket = _load(counters, TICKET)
        if ticket >= _load(counters, END):
            return -1
        if _claim(counters, TICKET, ticket):
            return ticket - counters[FIRST]


@kernel
def finish_piece(team):
    """Tell that a piece is finished."""
    _count(team.counters, DONE)


@kernel
def end_phase(team):
    """Wait until all pieces are finished."""
    counters = team.counters
    looks = 0
    while _load(counters, DONE) != counters[END]:
        looks += 1
        if looks > LOOKS:
            _yield()


@kernel
def wait_for_piece(team):
    """The next piece of this phase or of a later one, for an assistant; -1 when it may leave."""
    looks = 0
    while True:
        piece = next_piece(team)
        if piece >= 0:
            return piece
        if _load(team.counters, CLOSED) != 0:
            return -1
        looks += 1
        if looks > LOOKS:
            _yield()


@kernel
def part_of(first, last, part, parts):
    """The range of a part of a range that is divided into equal parts."""
    size = last - first
    return first + size * part // parts, first + size * (part + 1) // parts
