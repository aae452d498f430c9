"""Many runs of a pair, one after another, without Python between them."""

from tribo.compiler.jit import kernel
from tribo.compiler.potential_numbers import with_numbers
from tribo.kernels.status import CODE, EVALUATIONS, STEPS
from tribo.pair.loop import COLUMNS, pair_collocation

# The loop of a single run, for callers that are compiled.
integrate_pair = kernel(pair_collocation)


def pair_members(
    potential, pairs, numbers, rows, clocks, starts, start, times, record, samples, counts, budget
):
    """Integrate each member from its own start; a member has the bits of a single run.

    Parameters
    ----------
    potential, rows, clocks, times
        As for :func:`tribo.pair.loop.pair_collocation`.
    pairs : ndarray, (members or 1,), of PAIR
        The scene of each member, or of all.
    numbers : ndarray, (members or 1, fields)
        The numbers of the potential of each member, or of all; without columns if it has others.
    starts : ndarray, (members, 2 coordinates)
        y of the scene's layout at t = 0, for each member.
    start : ndarray, (2 coordinates,)
        Memory for the start of one member.
    record : ndarray, (times + 1, COLUMNS)
        Memory for the samples of one member.
    samples : ndarray, (times, members, COLUMNS)
        Filled in with the samples; those of a member that did not complete have no meaning.
    counts : ndarray, (members, COUNTS), of int64
        Filled in: status, steps, evaluations.
    budget : int
        Steps after which a member is left with the status PAUSED.
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
