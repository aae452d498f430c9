"""Lattice springs: which bars they join, and rest vectors that are turned."""

import numpy as np
import pytest

import tribo


def test_springs_around_a_ring():
    """Four bars have four springs, also in a scene that is not periodic."""
    ends, _ = tribo.Springs(1.0, wrap=True).bonds((4, 1), 4, (False, False))
    assert len(ends) == 4


def test_springs_whose_rest_vectors_are_turned():
    """Bars 1 apart along x store k / 2 |d - d0|^2, with d0 turned by 0.3 rad toward y."""
    stiffness, angle = 2.0, 0.3
    surface = tribo.Surface(
        "s",
        asperite=tribo.Asperite(kappa=np.inf),
        shape=(2, 1),
        spacing=(1.0, 0.0),
        drive=tribo.Free(load=0.0),
        springs=tribo.Springs(stiffness, turned=angle),
    )
    output = tribo.Output(samples=2, series=["energies"])
    scene = tribo.Scene([surface], [], 1.0, output=output)
    table = tribo.simulate(scene, accuracy=1e-8)["s"]
    assert table.e_springs[0] == pytest.approx(stiffness * (1.0 - np.cos(angle)), rel=1e-9)
    assert table.vy_cm[-1, 1] > 0.0 > table.vy_cm[-1, 0]
