"""Positions, velocities and end forces: plain functions that kernels compile."""

import numpy as np
import pytest
from numba import njit

from tribo.kernels import kinematics

ARGUMENTS = {
    "nearest_image": (2.3, 1.5),
    "rod_position": (0.3, -0.2, 1.4, 0.6, 0.8),
    "rod_velocity": (0.3, -0.2, 1.7, 1.4, 0.6, 0.8),
    "end_force": (0.4, 1.3, 0.6, 0.8),
    "rotational_power": (1.4, 1.7, 0.6, 0.8, -0.3, 0.2),
}


@pytest.mark.parametrize("name", ARGUMENTS)
def test_compiled_as_written(name):
    """Compiled, the numbers are the same to the last bit, and arrays broadcast."""
    function = getattr(kinematics, name)
    arguments = ARGUMENTS[name]
    compiled = njit(error_model="numpy")(lambda *values: function(*values))
    expected = function(*arguments)
    assert compiled(*arguments) == expected
    several = function(np.full(3, arguments[0]), *arguments[1:])
    if not isinstance(expected, tuple):
        several = (several,)
        expected = (expected,)
    assert all(np.all(one == other) for one, other in zip(several, expected, strict=True))


@pytest.mark.parametrize("difference", [-3.2, -1.0, -0.75, 0.0, 0.74, 0.75, 2.0, 1e6])
def test_nearest_image(difference):
    """It differs by a whole number of periods, and is within half a period."""
    image = kinematics.nearest_image(difference, 1.5)
    assert -0.75 <= image < 0.75
    assert (difference - image) / 1.5 == np.rint((difference - image) / 1.5)
    assert kinematics.nearest_image(0.5 * difference, 0.75) == 0.5 * image
    assert kinematics.nearest_image(difference, 0.0) == difference


def test_rods_are_rigid():
    """Bob and bar lie along the rod, and their velocities are the derivatives of the positions."""
    l1 = 0.7
    l2 = 1.1
    omega = 1.3
    step = 1e-6

    def places(t):
        theta = 0.4 + omega * t
        tx = np.cos(theta)
        ty = np.sin(theta)
        bob = kinematics.rod_position(0.2 * t, 0.1, l1, tx, ty)
        bar = kinematics.rod_position(0.2 * t, 0.1, -l2, tx, ty)
        return np.array([bob, bar])

    bob, bar = places(0.0)
    assert np.hypot(*(bob - bar)) == pytest.approx(l1 + l2)
    assert bob - bar == pytest.approx((l1 + l2) * np.array([np.sin(0.4), -np.cos(0.4)]))
    rates = (places(step) - places(-step)) / (2.0 * step)
    tx = np.cos(0.4)
    ty = np.sin(0.4)
    assert rates[0] == pytest.approx(kinematics.rod_velocity(0.2, 0.0, omega, l1, tx, ty))
    assert rates[1] == pytest.approx(kinematics.rod_velocity(0.2, 0.0, omega, -l2, tx, ty))


def test_rotational_power():
    """The power of a force about the centre of mass is force times relative velocity."""
    tx = np.cos(0.4)
    ty = np.sin(0.4)
    force = np.array([-0.3, 0.2])
    bob = kinematics.rod_velocity(0.0, 0.0, 1.3, 0.7, tx, ty)
    bar = kinematics.rod_velocity(0.0, 0.0, 1.3, -1.1, tx, ty)
    assert kinematics.rotational_power(0.7, 1.3, tx, ty, *force) == pytest.approx(force @ bob)
    assert kinematics.rotational_power(-1.1, 1.3, tx, ty, *force) == pytest.approx(force @ bar)


def test_end_forces_hold_the_bar():
    """f_L and f_R = -f_L are across the bar, and their couple is minus the spring's torque."""
    torque = 0.4
    length = 1.3
    phi = 0.3
    left = np.array(kinematics.end_force(torque, 1.0 / length, np.sin(phi), np.cos(phi)))
    along = np.array([np.cos(phi), np.sin(phi)])
    assert left @ along == pytest.approx(0.0, abs=1e-15)
    arm = -0.5 * length * along
    couple = 2.0 * (arm[0] * left[1] - arm[1] * left[0])
    assert couple == pytest.approx(-torque)
