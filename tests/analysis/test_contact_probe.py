"""Contacts of a scene at given places of its bobs."""

import numpy as np

import tribo
from tribo.analysis.contact_probe import ContactProbe


def test_a_probe_leaves_its_layout():
    """Depths in the layout are those of the scene, wherever bobs were placed before."""
    row = {"shape": (2, 1), "spacing": (1.0, 0.0), "asperite": tribo.Asperite(charge=(1.0, 2.0))}
    upper = tribo.Surface("upper", bob=(-0.3, 1.2), **row)
    lower = tribo.Surface("lower", facing="up", **row)
    probe = ContactProbe(tribo.Scene((upper, lower), tribo.Coulomb(1.0), 1.0))
    before = probe.layout.depths
    places = np.random.default_rng(3).uniform(-2.0, 2.0, (2, 4, 3))
    energies, _ = probe(places, np.full((2, 4), 0.5))
    assert np.array_equal(probe.layout.depths, before)
    assert np.array_equal(probe(places, np.full((2, 4), 0.5))[0], energies)
