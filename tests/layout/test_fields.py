"""Fields in the frame of their surface."""

import mpmath
import pytest

import tribo


def test_phase_of_a_field_far_from_the_origin():
    """At 1e7 periods from x = 0 the force of a corrugation keeps its digits."""
    place = 1e5 + 0.001
    origin = 3e4
    period = 0.013
    surface = tribo.Surface("upper", bob=(place, 0.0))
    field = tribo.Field(tribo.Corrugation(1.0, period), on=("upper",), origin=(origin, 0.0))
    output = tribo.Output(samples=2, series=("forces",))
    scene = tribo.Scene((surface,), (), 1e-6, fields=(field,), output=output)
    force = tribo.simulate(scene, method="verlet", step=1e-6)["upper"].f_field_x[0, 0]
    with mpmath.workdps(40):
        q = 2 * mpmath.pi / mpmath.mpf(period)
        exact = -q * mpmath.sin(q * (mpmath.mpf(place) - mpmath.mpf(origin)))
    assert force == pytest.approx(float(exact), rel=1e-14, abs=0.0)
