"""Fields in the frame of their surface."""

import mpmath
import pytest

from support.random_scenes import random_scene
from support.scene_tables import scene_from
from tribo.layout.layout import lay_out


def test_phase_of_a_field_far_from_the_origin():
    """At 1e7 periods from x = 0 the force of a corrugation keeps its digits."""
    scene = random_scene(4, "morse")
    scene["surface"][0]["bob"] = [1e5 + 0.001, 0.0]
    field = {"on": ["upper"], "kind": "corrugation", "amplitude": 1.0, "period": 0.013}
    field["origin"] = [3e4, 0.0]
    (laid_out,) = lay_out(scene_from(scene | {"field": [field]})).model.fields
    force, _ = laid_out.potential.force_at(laid_out.origin[0], 0.0)
    with mpmath.workdps(40):
        q = 2 * mpmath.pi / mpmath.mpf(0.013)
        exact = -q * mpmath.sin(q * (mpmath.mpf(1e5 + 0.001) - mpmath.mpf(3e4)))
    assert force == pytest.approx(float(exact), rel=1e-14)
