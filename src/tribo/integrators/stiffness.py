"""The stiffness of the forces in kicks, from two kicks that follow each other.

With noise, a run watches the curvature that its motion meets: between two kicks a coordinate moves
by d, and its acceleration changes by c.  A harmonic force of frequency w has c = -w^2 d for any
step, and a thermal motion in any potential has mean(-c d) / mean(d^2) = w^2 with the mean
curvature.  The accelerations are known, so this takes no evaluation of forces.
"""

from tribo.compiler.jit import apart

# One pair of kicks in so many steps is watched: the sums then take no time that can be measured.
EVERY = 8
# The last rows of a method's memory where there are reservoirs: coordinates and accelerations at
# the first kick of a pair, and sums over pairs of d^2, of -c d, and of c^2, for each coordinate.
PLACE, ACCELERATION, MOVED, TOGETHER, CHANGED, WATCH_ROWS = range(6)


@apart
def watch_kick(model, steps, q, memory, acceleration):
    """Keep the first kick of a pair, or add up the changes to the second."""
    phase = steps % EVERY
    first = memory.shape[0] - WATCH_ROWS
    if phase == 0:
        for m in range(model.core):
            memory[first + PLACE, m] = q[m]
            memory[first + ACCELERATION, m] = acceleration[m]
    elif phase == 1:
        for m in range(model.core):
            moved = q[m] - memory[first + PLACE, m]
            change = acceleration[m] - memory[first + ACCELERATION, m]
            memory[first + MOVED, m] += moved * moved
            memory[first + TOGETHER, m] -= moved * change
            memory[first + CHANGED, m] += change * change
