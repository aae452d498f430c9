"""Many runs of a pair, one after another, without Python between them."""

from tribo.compiler.jit import kernel
from tribo.compiler.numbers_in_lanes import with_numbers
from tribo.kernels.status import CODE, EVALUATIONS, STEPS
from tribo.pair.loop import COLUMNS, pair_collocation

# The loop of a single run, for callers that are compiled.
integrate_pair = kernel(pair_collocation)


def pair_members(
    potential, pairs, numbers, rows, clocks, starts, start, times, record, samples, counts, budget
):
    """Run members with the steps of :func:`tribo.pair.loop.pair_collocation`.

    `pairs` (members or 1,) of PAIR, and `numbers` (members or 1, fields) of the potential, without
    columns if it has others, are those of each member, or of all.  `starts` are (members, 2
    coordinates); `start` and `record` are memory for one member.  `samples` (times, members,
    COLUMNS) have no meaning for members that did not complete; `counts` (members, COUNTS) are
    PAUSED after `budget` steps.
    """
    clock = clocks[0]
    for member in range(starts.shape[0]):
        for i in range(start.size):
            start[i] = starts[member, i]
        clock.evaluations = 0
        own = member if pairs.size > 1 else 0
        mine = with_numbers(potential, numbers, own)
        code = integrate_pair(pairs[own:], mine, rows, clocks, start, times, record, budget)
        counts[member, CODE] = code
        counts[member, STEPS] = clock.steps
        counts[member, EVALUATIONS] = clock.evaluations
        for k in range(times.size):
            for m in range(COLUMNS):
                samples[k, member, m] = record[k, m]
