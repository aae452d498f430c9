"""Times of drives in runs from states: what is new begins with the run, the same goes on."""

from dataclasses import replace

import numpy as np
import pytest

import tribo
from tribo import Corrugation, Field, Pulled, Pushed
from tribo.layout.legs import BEGUN
from tribo.loops.saved_state import _begun

HOW = {"method": "verlet", "step": 0.02}


def scene(drive, end, fields=((1.0, 0.0), (1.5, 0.3)), **output):
    """A rigid tip far from x = 0, in two corrugations, of which one moves."""
    tip = tribo.Surface(
        "tip",
        bob=(4.2, 0.0),
        asperite=tribo.Asperite(kappa=np.inf),
        drive=drive,
        langevin=tribo.Langevin(gamma=2.0),
    )
    own = [Field(Corrugation(0.1, a), ["tip"], velocity=(v, 0.0)) for a, v in fields]
    output = {"samples": 401, "series": ["forces"]} | output
    return tribo.Scene([tip], [], end, fields=own, output=tribo.Output(**output))


@pytest.mark.parametrize("series", [["forces"], []])
@pytest.mark.parametrize("moving", [Pulled(stiffness=3.0, speed=0.1), Pushed(rate=(0.05, 0.0))])
def test_depinning_after_a_rest(moving, series):
    """The force is the recorded one, wherever the tip is, however long it rested."""
    still = replace(moving, speed=0.0) if isinstance(moving, Pulled) else tribo.Free()
    one = [(1.0, 0.0), (1.5, 0.0)]
    for rest in (10.0, 40.0):
        resting = tribo.simulate(scene(still, rest, one), **HOW)
        state = resting.state()
        result = tribo.simulate(scene(moving, rest + 40.0, one), **HOW, start=state)
        force = result["tip"].f2_x[:, 0]
        # A stage keeps its position, a push begins at zero.
        at_rest = resting["tip"].f2_x[-1, 0] if isinstance(moving, Pulled) else 0.0
        assert force[0] == pytest.approx(at_rest, abs=1e-6)
        alone = tribo.simulate(
            scene(moving, rest + 40.0, one, series=series), **HOW, start=state
        ).depinning("tip", 0.5)
        slid = np.argmax(result["tip"].x_bar[:, 0] - result["tip"].x_bar[0, 0] >= 0.5)
        assert alone.mean == pytest.approx(np.max(force[:slid]), rel=1e-12, abs=0.0)


def test_ramps_go_on_or_begin():
    """A load that changes leaves a ramp; a rate that changes begins one at zero."""
    ramp = Pushed(rate=(0.02, 0.0))
    state = tribo.simulate(scene(ramp, 10.0), **HOW).state()
    for drive, force in (
        (replace(ramp, load=0.1), 0.2),
        (ramp, 0.2),
        (Pushed(rate=(0.03, 0.0)), 0.0),
    ):
        result = tribo.simulate(scene(drive, 20.0), **HOW, start=state)
        assert result["tip"].f2_x[0, 0] == pytest.approx(force, abs=1e-12)


def test_a_push_that_begins_with_the_run_grows_from_its_beginning():
    """M v = r (t - t0)^2 / 2 along y, with t0 the time of the state."""
    rigid = tribo.Asperite(kappa=np.inf)

    def run(drive, end, **how):
        tip = tribo.Surface("tip", asperite=rigid, drive=drive)
        output = tribo.Output(samples=11)
        return tribo.simulate(tribo.Scene([tip], [], end, output=output), accuracy=1e-9, **how)

    state = run("free", 2.0).state()
    later = run(Pushed(force=(0.0, 0.0), rate=(0.0, 0.3)), 5.0, start=state)
    mass = later.scene.surfaces[0].each["mass"][0]
    expected = 0.5 * 0.3 * 3.0**2 / mass
    assert later["tip"].vy_cm[-1, 0] == pytest.approx(expected, rel=1e-7)


def test_fields_in_another_order_stay_in_place():
    """Each is known again by what it is; a new one that moves begins at its place."""
    free = tribo.Free()
    first = tribo.simulate(scene(free, 10.0), **HOW)
    other = scene(free, 20.0, [(1.5, 0.3), (1.0, 0.0)])
    after = tribo.simulate(other, **HOW, start=first.state())
    assert after["tip"].f_field_x[0] == pytest.approx(first["tip"].f_field_x[-1], abs=1e-12)
    more = scene(free, 20.0, [(1.0, 0.0), (1.5, 0.3), (2.0, 0.4)])
    placed = tribo.simulate(more, **HOW, start=first.state()).state()
    assert placed.phases[1:, 0] == pytest.approx([0.0, 0.3 * 20.0, 0.4 * 10.0])


def test_times_in_states_of_earlier_versions():
    """There, a push had the time of its drive, and a modulation that of its field."""
    fields = ((1.0, 0.0),)
    old = {"begun": np.array([[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0], [0, 0, 0, 0, 0, 0, 8.0]])}
    of_tip, of_field = _begun(old, scene(Pulled(stiffness=1.0, speed=0.1), 4.0, fields))
    assert [of_tip[BEGUN.index(name)] for name in ("stage", "push_x", "push_y")] == [3.0, 1.0, 1.0]
    assert of_field[BEGUN.index("field")] == of_field[BEGUN.index("modulation")] == 8.0
