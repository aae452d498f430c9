"""The times at which runs stop that are compared with one another."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

# Equal parts of the duration after which a fine run stops, so that its steps differ from those of
# the coarse runs even if there are few samples.
PARTS = 32
# Most inner stops of a coarse run: each shortens a step.
MOST_STOPS = 256
# Stops that differ by less than this fraction of the duration are one: steps between them would be
# as short as rounding.
SAME = 1e-9


class StopTimes(NamedTuple):
    """Times at which a fine run and two coarse ones stop, so that no two share their steps.

    Every fourth inner time of the fine run belongs to the first coarse run, and all others to the
    second: each recorded time is compared with one of them.
    """

    few: np.ndarray
    many: np.ndarray
    fine: np.ndarray

    @classmethod
    def for_samples(cls, times: np.ndarray) -> StopTimes:
        """For a run that is recorded at `times`, and also stops after each of PARTS equal parts."""
        parts = np.linspace(times[0], times[-1], PARTS + 1)
        k = np.searchsorted(times, parts).clip(1, times.size - 1)
        off = np.minimum(np.abs(parts - times[k - 1]), np.abs(parts - times[k]))
        return cls.split(np.union1d(times, parts[off > SAME * (times[-1] - times[0])]))

    @classmethod
    def split(cls, times: np.ndarray) -> StopTimes:
        """For a fine run that stops at `times`."""
        inner = times[1:-1]
        fourth = np.arange(inner.size) % 4 == 3
        few, many = (_thinned(times, inner[mine]) for mine in (fourth, ~fourth))
        return cls(few, many, times)


def _thinned(times: np.ndarray, inner: np.ndarray) -> np.ndarray:
    """At most MOST_STOPS of the inner times, and both ends."""
    if inner.size > MOST_STOPS:
        inner = inner[np.linspace(0, inner.size - 1, MOST_STOPS).astype(int)]
    return np.concatenate([times[:1], inner, times[-1:]])
