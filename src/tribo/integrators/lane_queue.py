"""Members that wait for a lane, and those that run in the lanes of registers.

A lane whose member has ended takes the next one.
"""

from typing import NamedTuple

import numpy as np

from tribo.compiler.jit import kernel
from tribo.kernels.status import CODE, COUNTS, EVALUATIONS, STEPS


class Queue(NamedTuple):
    """The members of a call, and how far it is with them."""

    held: np.ndarray  # (lanes,) the member in each lane; -1 where there is none
    waiting: np.ndarray  # (1,) the first member that has not been begun
    counts: np.ndarray  # (members, COUNTS) filled in; PAUSED of those that need another loop


def queue_of(members: int, lanes: int) -> Queue:
    """So many members, all of which wait, for Python."""
    counts = np.zeros((members, COUNTS), np.int64)
    return Queue(np.full(lanes, -1), np.zeros(1, np.int64), counts)


@kernel
def next_member(queue, lane):
    """Give a lane to the next member that waits; returns this member, -1 if there is none."""
    m = queue.waiting[0]
    if m == queue.counts.shape[0]:
        return -1
    queue.waiting[0] = m + 1
    queue.held[lane] = m
    return m


@kernel
def leave_member(queue, lane, code, steps, evaluations):
    """Let a lane be free, and note what its member took."""
    m = queue.held[lane]
    queue.held[lane] = -1
    queue.counts[m, CODE] = code
    queue.counts[m, STEPS], queue.counts[m, EVALUATIONS] = steps, evaluations
