"""Threads that share the work of a step.

A step has phases: lists of neighbours, contact, drift, kick.  Each phase has a number of pieces
that depends on the scene alone, and each piece writes where no other does, so that the results have
the same bits for any number of threads.  The thread of the time loop begins a phase and takes
pieces until none is left; assistants take pieces too.  Then it waits for the pieces that assistants
have taken.  None waits for an assistant that the operating system has stopped between two pieces.

Threads have ranks.  Each begins with the pieces of its own part of all, which are the same in every
step, so that the numbers in it stay in the memory of its core; then it looks for pieces that others
have left.  It takes a piece by a compare-and-swap of the last phase in which the piece was taken.
As long as a piece is not finished, the phase cannot change.
"""

from typing import NamedTuple

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from tribo.compiler.jit import kernel
from tribo.compiler.lanes import instruction
from tribo.compiler.lanes_memory import element
from tribo.compiler.numba_private import cgutils
from tribo.system import YIELD

# Phases.
LISTS, CONTACT, REACTIONS, DRIFT, KICK = range(5)

# Places of the counters.  Those that threads write at the same time are in cache lines of their
# own, of at most 16 numbers.
WORK = 0
DONE = 16
CLOSED = 32
PHASE = 33
END = 34
INTERACTION = 35
PAIR = 36
THREADS = 37
RANK = 48
COUNTERS = 64
# Counter WORK is the number of phases so far times this, plus the pieces of the present one.
MOST_PIECES = 1 << 20
# Places in the row of a thread.
SEEN = 0  # the last phase that it saw
TRIED = 1  # how many pieces of this phase it tried
OWN_NUMBERS = 16  # a cache line and the next one

# Looks for work after which a waiting thread lets others have its core: about a microsecond.
LOOKS = 200


class Team(NamedTuple):
    """What threads share, and how their work is divided."""

    counters: np.ndarray  # (COUNTERS,): the present phase, pieces finished, ...
    taken: np.ndarray  # (pieces,) number of the last phase in which each piece was taken
    ranks: np.ndarray  # (threads, OWN_NUMBERS) of each thread: SEEN and TRIED
    numbers: np.ndarray  # (2,) of the present phase: times
    tiles: np.ndarray  # (tiles, 3) surface, which of its tiles, and how many it has
    lengths: np.ndarray  # (chunks,) of the rows of each chunk of a list of neighbours
    begins: np.ndarray  # (chunks + 1,) where the room of each chunk begins in that list
    reach: np.ndarray  # (chunks, 2) columns first <= i < last of the reactions to each chunk
    reactions: np.ndarray  # (chunks, 2, n) the reactions to the rows of each chunk


# Of a step that threads do not share.
NO_TEAM = Team(
    counters=np.zeros(0, np.int64),
    taken=np.zeros(0, np.int64),
    ranks=np.zeros((0, OWN_NUMBERS), np.int64),
    numbers=np.zeros(0),
    tiles=np.zeros((0, 3), np.int64),
    lengths=np.zeros(0, np.int64),
    begins=np.zeros(0, np.int64),
    reach=np.zeros((0, 2), np.int64),
    reactions=np.zeros((0, 2, 0)),
)


@intrinsic
def _at(typing_context, array, i):

    def build(context, builder, sig, args):
        return element(context, builder, sig.args[0], *args)

    return types.CPointer(types.int64)(array, types.intp), build


@instruction(lambda place: types.int64(place))
def _load(builder, place):
    """The number at an address, and all that was written before it."""
    return builder.load_atomic(place, "acquire", 8)


@instruction(lambda place, value: types.void(place, types.int64))
def _publish(builder, place, value):
    """Set it, after all that was written before."""
    builder.store_atomic(value, place, "release", 8)


@instruction(lambda place: types.int64(place))
def _count(builder, place):
    """Add one to it, after all that was written before; returns what it was."""
    return builder.atomic_rmw("add", place, ir.Constant(ir.IntType(64), 1), "acq_rel")


@instruction(lambda place, value, new: types.boolean(place, types.int64, types.int64))
def _replace(builder, place, value, new):
    """Set it to `new` if it is `value`; whether it was."""
    return builder.extract_value(builder.cmpxchg(place, value, new, "acq_rel", "acquire"), 1)


@instruction(types.void)
def _yield(builder):
    """Let another thread have the core, if one waits for it."""
    kind = ir.FunctionType(ir.IntType(32), [])
    builder.call(cgutils.get_or_insert_function(builder.module, kind, YIELD), [])


@kernel
def begin_phase(team, phase, pieces):
    """Offer the pieces of a phase to all threads, and take one; what else it needs is in place.

    Like :func:`continue_phase` it returns -1 when all pieces are finished.
    """
    counters = team.counters
    counters[PHASE] = phase
    counters[END] += pieces
    number = counters[WORK] // MOST_PIECES + 1
    _publish(_at(counters, WORK), number * MOST_PIECES + pieces)
    return piece_or_end(team)


@kernel
def continue_phase(team):
    """Finish a piece, and take another one."""
    finish_piece(team)
    return piece_or_end(team)


@kernel
def piece_or_end(team):
    """The next piece for the thread of the time loop; -1 when all pieces are finished."""
    piece = next_piece(team, 0)
    looks = 0
    while piece < 0 and _load(_at(team.counters, DONE)) != team.counters[END]:
        looks += 1
        if looks > LOOKS:
            _yield()
    return piece


@kernel
def next_piece(team, rank):
    """Take the next piece of the present phase; -1 where none is left."""
    work = _load(_at(team.counters, WORK))
    phase = work // MOST_PIECES
    pieces = work % MOST_PIECES
    own = team.ranks[rank]
    if own[SEEN] != phase:
        own[SEEN] = phase
        own[TRIED] = 0
    first = rank * pieces // team.counters[THREADS]
    while own[TRIED] < pieces:
        piece = (first + own[TRIED]) % pieces
        own[TRIED] += 1
        last = _at(team.taken, piece)
        before = _load(last)
        if before < phase and _replace(last, before, phase):
            return piece
    return -1


@kernel
def next_rank(team):
    """The rank of an assistant; that of the time loop's own thread is 0."""
    return _count(_at(team.counters, RANK)) + 1


@kernel
def finish_piece(team):
    _count(_at(team.counters, DONE))


@kernel
def wait_for_piece(team, rank):
    """The next piece of this phase or of a later one, for an assistant; -1 when it may leave."""
    looks = 0
    while True:
        piece = next_piece(team, rank)
        if piece >= 0:
            return piece
        if _load(_at(team.counters, CLOSED)) != 0:
            return -1
        looks += 1
        if looks > LOOKS:
            _yield()


@kernel
def part_of(first, last, part, parts):
    """The range of a part of a range that is divided into equal parts."""
    size = last - first
    return first + size * part // parts, first + size * (part + 1) // parts
