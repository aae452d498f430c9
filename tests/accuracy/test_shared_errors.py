"""Errors that all runs of an estimate share, and that their differences do not show."""

import numpy as np
import pytest

import tribo


@pytest.mark.filterwarnings("ignore::tribo.TriboWarning")  # the start is deep in a core
def test_errors_of_a_deep_start_that_grow_to_the_scale():
    """Three runs share the error of the first steps in a core, which grows by a million times.

    They differed by 0.008 of the scale where all were wrong by half of it.
    """
    upper = tribo.Surface(
        "upper",
        facing="down",
        bob=(-0.17000273390517465, 0.5349387910916708),
        velocity=(0.06371678850878497, 0.0),
        drive="forced",
        asperite=tribo.Asperite(
            m1=1.0423769354393337, m2=2.7838900199354106, kappa=0.14358768841488487
        ),
    )
    lower = tribo.Surface(
        "lower",
        facing="up",
        drive="forced",
        asperite=tribo.Asperite(
            m1=0.40244886563943993, m2=2.5738686837012508, kappa=0.41029699636698225
        ),
    )
    potential = tribo.LennardJones(0.13323701963492682, 1.0)
    output = tribo.Output(samples=9)
    scene = tribo.Scene((upper, lower), potential, 8.027556155787998, output=output)
    truth, coarse = (
        tribo.simulate(scene, accuracy=accuracy, progress=False) for accuracy in (1e-5, 0.1)
    )
    assert truth.met and truth.error_estimate["omega"] < 1e-3
    for name in ("upper", "lower"):
        error = np.max(np.abs(coarse[name].omega - truth[name].omega))
        assert error <= coarse.error_estimate["omega"]
    assert coarse.met
