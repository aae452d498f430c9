"""Where kicks act after the samples of a run with noise.

A splitting samples positions and velocities between two kicks, and with noise the positions at its
kicks have another distribution.  Momentum balance holds for the forces in the kicks: their mean on
a loaded surface is the load, at any step, while that of forces in the samples differs by O(step^2).
"""

from dataclasses import replace

import numpy as np

from tribo.integrators.step_control import count_of_steps
from tribo.kernels import records as row
from tribo.layout.layout import Layout
from tribo.ledger.samples import Samples


def at_next_kicks(layout: Layout, samples: Samples, step: float) -> Samples:
    """The samples, moved by the drift of half a step to the kick that follows each."""
    times = layout.times
    if times.size < 2:
        return samples
    # The samples may be a part of the run's: the interval after the last one is among its times.
    after = np.clip(np.searchsorted(times, samples.t, side="right"), 1, times.size - 1)
    intervals = times[after] - times[after - 1]
    kinks = np.append(layout.legs.kinks, np.inf)
    left = kinks[layout.legs.of_times(samples.t)] - samples.t  # where a leg ends before a sample
    intervals = np.where(left > 0.0, np.minimum(intervals, left), intervals)
    steps = intervals / count_of_steps(intervals, step)
    lags = 0.5 * steps[:, None]
    y = samples.y.copy()
    q = y[:, : layout.core]
    v = y[:, layout.core :]
    a = layout.asperites
    constants = layout.constants
    for slots in (a.dof_x, a.dof_y):
        mine = slots[slots >= 0]
        q[:, mine] += lags * v[:, mine]
    swings = np.flatnonzero(np.isfinite(constants[row.INERTIA]))
    free = swings[a.dof_phi[swings] >= 0]
    clamped = swings[a.dof_phi[swings] < 0]
    _rotate_clamped(q, v, clamped, constants[:, clamped], samples.t[:, None], lags)
    if free.size:
        _rotate_free(q, v, free, a.dof_phi[free], constants[:, free], lags)
    return replace(samples, t=samples.t + lags[:, 0], y=y)


def _turned(
    twist: np.ndarray, rate: np.ndarray, frequency: np.ndarray, lags: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """A harmonic oscillator after some times, and its rate."""
    angle = frequency * lags
    over = np.where(
        frequency > 0.0, np.sin(angle) / np.where(frequency > 0.0, frequency, 1.0), lags
    )
    cos = np.cos(angle)
    return cos * twist + over * rate, cos * rate - frequency * np.sin(angle) * twist


def _rotate_clamped(
    q: np.ndarray,
    v: np.ndarray,
    swings: np.ndarray,
    constants: np.ndarray,
    t: np.ndarray,
    lags: np.ndarray,
) -> None:
    """Rotate swings on bars that rest or turn uniformly."""
    start = constants[row.PHI_START]
    nu = constants[row.NU_START]
    twist = q[:, swings] - (start + nu * t)
    rate = v[:, swings] - nu
    twist, rate = _turned(twist, rate, constants[row.FREQUENCY], lags)
    q[:, swings] = twist + (start + nu * (t + lags))
    v[:, swings] = rate + nu


def _rotate_free(
    q: np.ndarray,
    v: np.ndarray,
    swings: np.ndarray,
    bars: np.ndarray,
    constants: np.ndarray,
    lags: np.ndarray,
) -> None:
    """Rotate swings and bars that turn freely, about their common mean."""
    share = constants[row.I2] / (constants[row.INERTIA] + constants[row.I2])
    mean_rate = (1.0 - share) * v[:, swings] + share * v[:, bars]
    mean = (1.0 - share) * q[:, swings] + share * q[:, bars] + mean_rate * lags
    twist = q[:, swings] - q[:, bars]
    rate = v[:, swings] - v[:, bars]
    twist, rate = _turned(twist, rate, constants[row.FREQUENCY], lags)
    q[:, swings] = mean + share * twist
    q[:, bars] = mean - (1.0 - share) * twist
    v[:, swings] = mean_rate + share * rate
    v[:, bars] = mean_rate - (1.0 - share) * rate
