"""The time average of the friction force, its interval, and its spread.

The interval is Student's, from the averages over blocks of equal length.  It holds where a block is
much longer than the time over which the force is correlated, as the period of stick and slip.
H. Flyvbjerg, H. G. Petersen, J. Chem. Phys. 91 (1989) 461.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tribo.run.intervals import student
from tribo.validation import InputError, integer, number

# Blocks of an average: with fewer, Student's interval is wide for want of degrees of freedom; with
# more, blocks are short and correlated.
BLOCKS = 10


class FrictionForce(NamedTuple):
    """The friction force on a surface: its time average and its spread.

    Attributes
    ----------
    mean : float
        The time average [force].
    half_width : float
        Half-width of its 95 % interval, from block averages [force].
    spread : float
        The standard deviation of the force over time [force].
    """

    mean: float
    half_width: float
    spread: float


def average(t: np.ndarray, force: np.ndarray, after: float, blocks: int) -> FrictionForce:
    """The average of a series from the time `after` on.

    Parameters
    ----------
    t, force : ndarray, (times,)
        The series; between its times it is taken as linear.
    after : float
        When the average begins [time].
    blocks : int
        Number of blocks.

    Raises
    ------
    InputError
        There are fewer than two intervals between samples for each block.
    """
    integer("blocks", blocks, 2)
    number("after", after, unit="time")
    later = t >= after
    t, force = t[later], force[later]
    if t.size - 1 < 2 * blocks:
        raise InputError(
            "blocks",
            f"must be at most {max(t.size - 1, 0) // 2} for {t.size} samples after t = {after:g}, "
            f"got {blocks}; record more samples",
        )
    mean = _integral(t, force)[-1] / (t[-1] - t[0])
    spread = np.sqrt(_integral(t, (force - mean) ** 2)[-1] / (t[-1] - t[0]))
    edges = np.linspace(t[0], t[-1], blocks + 1)
    averages = np.diff(np.interp(edges, t, _integral(t, force))) / np.diff(edges)
    half_width = student(blocks - 1) * np.std(averages, ddof=1) / np.sqrt(blocks)
    return FrictionForce(float(mean), float(half_width), float(spread))


def _integral(t: np.ndarray, values: np.ndarray) -> np.ndarray:
    """The integral from the first time to each, by the trapezoidal rule."""
    parts = 0.5 * (values[1:] + values[:-1]) * np.diff(t)
    return np.concatenate([[0.0], np.cumsum(parts)])
