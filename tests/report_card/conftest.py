"""Cards that take less time: without compiled code."""

import numpy as np
import pytest

from tribo.report_card import scan


@pytest.fixture
def uncompiled(monkeypatch):
    """Contacts of bobs in numpy, where a card has them from the kernels."""
    monkeypatch.setattr(scan, "ContactProbe", contact_in_numpy)


def contact_in_numpy(scene):
    """Energy and forces between two bobs, as of a ContactProbe."""
    potential = scene.interactions[0].potential

    def probe(positions, charges):
        """Energies and forces as from compiled contact, by the potential's methods for arrays."""
        apart = positions[:, :1, None] - positions[:, None, 1:]
        with np.errstate(all="ignore"):
            r = np.sqrt(np.sum(apart * apart, axis=-1))
            pairs = (r, charges[:, :1, None], charges[:, None, 1:])
            energy = of_arrays(potential.energy_between)(*pairs)
            force = of_arrays(potential.force_between)(*pairs)
            inside = r < potential.range()
            energy = np.where(inside, energy, 0.0)
            force = np.where(inside, force, 0.0)
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
