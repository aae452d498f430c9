"""Cards that take less time: without runs, or without compiled code."""

import numpy as np
import pytest

from tribo import report_card
from tribo.report_card import scan


@pytest.fixture
def no_runs(monkeypatch):
    """A card without the runs, each of which compiles a time loop."""
    monkeypatch.setattr(report_card, "check_motion", lambda scan: [])


@pytest.fixture
def uncompiled(monkeypatch):
    """Contacts of bobs in numpy, where a card has them from the kernels."""
    monkeypatch.setattr(scan, "_contact_probe", contact_in_numpy)


def contact_in_numpy(potential, count):
    """Energy and forces between two surfaces of `count` bobs, as of a ContactProbe."""

    def probe(positions, charges):
        apart = positions[:, :count, None] - positions[:, None, count:]
        with np.errstate(all="ignore"):
            r = np.sqrt(np.sum(apart * apart, axis=-1))
            pairs = (r, charges[:, :count, None], charges[:, None, count:])
            energy = of_arrays(potential.energy_between)(*pairs)
            force = of_arrays(potential.force_between)(*pairs)
            inside = r < potential.range()
            energy, force = np.where(inside, energy, 0.0), np.where(inside, force, 0.0)
            forces = (force / r)[..., None] * apart[..., :2]
        return energy.sum(axis=(1, 2)), np.hstack([forces.sum(axis=2), -forces.sum(axis=1)])

    return probe


def of_arrays(function):
    """The function, called for one distance after another if it takes no arrays."""

    def call(*arguments):
        try:
            return function(*arguments)
        except ValueError:
            return np.vectorize(function, otypes=[float])(*arguments)

    return call
