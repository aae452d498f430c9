"""Tests of single functions as checks: those that pytest runs too, which need no compiler.

A mutant may fail them in any way; see `judge`.
"""

from collections.abc import Callable
from importlib import import_module
from typing import Any

# Below tests/, as "file::test".  They take up to 2 s uncompiled, and no fixtures.
TESTS = (
    *(
        "kernels.test_kinematics::test_nearest_image",
        "kernels.test_kinematics::test_rods_are_rigid",
    ),
    "kernels.test_kinematics::test_rotational_power",
    "kernels.test_kinematics::test_end_forces_hold_the_bar",
    "layout.test_starts::test_thermal_start",
    "layout.test_starts::test_thermal_start_of_held_and_rigid",
    "model.test_bath_spectra::test_thermal_start_shares_the_energy_evenly",
    "model.test_bath_spectra::test_thermal_torsional_start",
    "model.test_bath_spectra::test_a_cold_start_is_at_rest",
)


def as_check(place: str) -> Callable[[], str]:
    """A check that runs a test for all of its parameters."""
    module, _, name = place.partition("::")

    def check() -> str:
        test = getattr(import_module(module), name)
        for given in parameters_of(test):
            test(*given)
        return ""

    return check


def parameters_of(test: Any) -> list[tuple[Any, ...]]:
    """The values of a test's only list of parameters; none of a test without."""
    marks = [mark for mark in getattr(test, "pytestmark", []) if mark.name == "parametrize"]
    if not marks:
        return [()]
    (mark,) = marks
    return [(value,) for value in mark.args[1]]


UNIT_TESTS = {place: as_check(place) for place in TESTS}
