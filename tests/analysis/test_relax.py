"""Equilibria: against energies written by hand, closed forms, and runs that stay at rest."""

import numpy as np
import pytest
from scipy.optimize import minimize

import tribo
from tribo import Asperite, Bath, Corrugation, Coulomb, Field, InputError, Pulled, Surface

# Parameters of case A: distances of bob and bar from the centre of mass, and the rod.
L1 = 4.0 / 3.0
L2 = 2.0 / 3.0
ROD = 2.0
COLUMNS = np.array([0.0, 1.2, 2.4])


def pressed(drive, amplitude=0.05, x=0.2, **settings):
    """A row on lattice springs over a row with held bars in a corrugation."""
    upper = Surface(
        "upper",
        bob=(x, 1.5),
        shape=(3, 1),
        spacing=(1.2, 0.0),
        drive=drive,
        springs=tribo.Springs(0.7),
        bath=Bath([0.1], [2.0]),
        **settings,
    )
    lower = Surface("lower", facing="up", shape=(3, 1), spacing=(1.2, 0.0), drive="bars")
    field = Field(Corrugation(amplitude, 2.0), ["lower"])
    return tribo.Scene((upper, lower), Coulomb(0.2), 5.0, fields=(field,))


def energy(coordinates, stiffness, load, amplitude, x):
    """The energy of `pressed`, from swings, x and y of the upper row and swings of the lower."""
    swing, dx, dy, turned = coordinates.reshape(4, 3)
    bar_x = x + COLUMNS + dx - L2 * np.sin(swing)
    bar_y = 1.5 + L1 + dy + L2 * np.cos(swing)
    bob_x = bar_x + ROD * np.sin(swing)
    bob_y = bar_y - ROD * np.cos(swing)
    other_x = COLUMNS - ROD * np.sin(turned)
    other_y = -ROD + ROD * np.cos(turned)
    r = np.sqrt((bob_x[:, None] - other_x) ** 2 + (bob_y[:, None] - other_y) ** 2)
    found = np.sum(0.2 / r) - np.sum(amplitude * np.cos(np.pi * other_x)) + load * np.sum(bar_y)
    found += np.sum(0.5 * stiffness * (bar_x - x - COLUMNS) ** 2)
    stretch = (np.diff(bar_x) - 1.2) ** 2 + np.diff(bar_y) ** 2
    return found + np.sum(0.5 * 0.7 * stretch) + np.sum(swing**2 + turned**2)


def gradient(coordinates, *scene):
    """Its derivatives, by complex steps: exact to rounding."""
    steps = 1e-30j * np.eye(coordinates.size)
    return np.array([energy(coordinates + step, *scene).imag for step in steps]) * 1e30


def found_coordinates(state):
    upper = state.surfaces["upper"]
    lower = state.surfaces["lower"]
    return np.concatenate([upper["swing"], upper["x"], upper["y"], lower["swing"]])


def test_a_pressed_row_against_its_energy():
    """Swings, centres of mass, springs, a load and a corrugation; baths end at their bars."""
    scene = 2.0, 0.12, 0.05, 0.2
    state = tribo.relax(pressed(Pulled(stiffness=2.0, load=0.12)))
    found = found_coordinates(state)
    assert np.max(np.abs(gradient(found, *scene))) < 1e-14
    lowest = minimize(energy, np.zeros(12), scene, jac=gradient, tol=1e-10)
    assert lowest.x == pytest.approx(found, abs=1e-8) and np.max(np.abs(found)) > 0.1
    swing, x, y = found[:9].reshape(3, 3)
    bars = np.array([x - L2 * np.sin(swing), y - L2 * (1.0 - np.cos(swing))])
    # Coordinates are those of asperites, then x of all oscillators of a bar, then y.
    oscillators = state.y[12:18].reshape(3, 2).T
    assert oscillators == pytest.approx(bars, abs=1e-15)


def facing_pair(gap, charge, x=0.0, drive="forced"):
    """Two asperites whose bobs are above one another, or nearly so."""
    upper = Surface("upper", bob=(x, gap), asperite=Asperite(charge=charge))
    lower = Surface("lower", facing="up", drive=drive)
    return tribo.Scene((upper, lower), Coulomb(0.2), 8.0, output=tribo.Output(samples=5))


def test_no_equilibrium():
    """Bobs that repel fly apart; the message names an asperite and the force on it."""
    problem = r"after 400 steps forces do not vanish, where the force on asperite 0 of \"lower\""
    with pytest.raises(tribo.NoEquilibriumError, match=problem) as error:
        tribo.relax(facing_pair(1.0, 1.0, 0.1, tribo.Free()))
    assert error.value.asperite == 'asperite 0 of "lower"'
    assert -0.01 < error.value.residual < 0.0
    with pytest.raises(InputError, match=r"^scene: must be a tribo\.Scene, got 5"):
        tribo.relax(5)


def test_the_force_that_no_spring_takes_up_is_left():
    """A push on a free bar finds no equilibrium: the force that is left is the push."""
    asperite = Asperite(kappa=1.0, length=1.7)
    pushed = Surface("s", asperite=asperite, drive=tribo.Pushed(force=(0.3, 0.0)))
    with pytest.raises(tribo.NoEquilibriumError, match="where the force on") as error:
        tribo.relax(tribo.Scene([pushed], [], 1.0))
    assert abs(error.value.residual) == pytest.approx(0.3, rel=1e-6)


def test_the_torque_that_no_spring_takes_up_is_left():
    """Bobs at one place in a core: the message names the pendulum and the torque on it."""
    surfaces = Surface("a"), Surface("b", facing="up")
    with pytest.raises(tribo.NoEquilibriumError, match="the torque on asperite 0"):
        tribo.relax(tribo.Scene(surfaces, tribo.LennardJones(1.0, 1.0), 1.0))


def test_an_unstable_start_is_left():
    """Bobs that push hard buckle their pendulums; a load below the critical one does not."""

    def torque(swing, gap):
        """Of the springs less that of contact: bobs are images of each other."""
        across = 2.0 * L1 * np.sin(swing)
        along = gap + 2.0 * L1 * (1.0 - np.cos(swing))
        push = 0.2 / np.hypot(across, along) ** 3
        return 2.0 * swing - ROD * push * (np.cos(swing) * across + np.sin(swing) * along)

    for gap in (0.9, 0.45):
        state = tribo.relax(facing_pair(gap, 1.0))
        upper, lower = (state.surfaces[name]["swing"][0] for name in ("upper", "lower"))
        assert upper == pytest.approx(lower, abs=1e-14)
        assert torque(upper, gap) == pytest.approx(0.0, abs=1e-14)
        assert (abs(upper) > 0.1) == (gap == 0.45)


def test_a_run_from_an_equilibrium_stays_there():
    """Also with a drive that cancels f1, whose forces have no energy."""
    scene = facing_pair(0.7, -1.0, 0.4, tribo.Free())
    state = tribo.relax(scene)
    assert state.surfaces["lower"]["x"][0] == pytest.approx(0.4, abs=1e-12)
    from_start = tribo.simulate(scene, method="rk4", step=0.02)
    assert np.max(np.abs(from_start["lower"]["w"])) > 1e-3
    result = tribo.simulate(scene, method="rk4", step=0.02, start=state)
    assert result.t.tolist() == [0.0, 2.0, 4.0, 6.0, 8.0]
    for table in (result["upper"], result["lower"]):
        assert np.ptp(table["theta"]) < 1e-13 and np.max(np.abs(table["w"])) < 1e-13


@pytest.mark.parametrize("x", [0.1, 0.2, 0.3])
def test_a_run_from_an_equilibrium_of_a_rigid_block(x):
    """Its bars, which are found one by one, differ in rounding; four of ten runs were refused."""
    rigid = tribo.Asperite(kappa=np.inf)
    drive = tribo.Pulled(stiffness=1.0, speed=0.0, load=0.2, block=True)
    row = {"shape": (3, 1), "spacing": (1.1, 0.0)}
    upper = tribo.Surface("upper", bob=(x, 1.2), asperite=rigid, drive=drive, **row)
    lower = tribo.Surface("lower", facing="up", shape=(5, 1), drive="bars", spacing=(1.0, 0.0))
    contact = tribo.LennardJones(0.1, 1.0).with_cutoff(2.5)
    scene = tribo.Scene((upper, lower), contact, 2.0, output=tribo.Output(samples=5))
    result = tribo.simulate(scene, start=tribo.relax(scene), method="verlet", step=0.01)
    assert result.status == "completed"
    assert np.max(np.abs(result["upper"].vx_cm)) < 1e-6
