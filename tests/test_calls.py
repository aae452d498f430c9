"""Python calls of runs, which cost more time than their time loops do.

They hardly depend on the machine.  A bound that a change exceeds is work done for each run: find
what is the same for all of them, and compute it once.
"""

import os
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

import tribo

PACKAGE = os.path.dirname(tribo.__file__)
CASE_A = tribo.paper.scene("A")

# Most calls of functions in Python and in C, in all frames, of a run of a prepared pair, of a run
# with an estimate, and of `simulate`; measured: 40, 608 and 3,810, and two more for each run of a
# pair once there are plug-ins of the user's.
PREPARED = 42
ESTIMATED = 617
SIMULATED = 3920
# The same of three asperites on three by adaptive steps; measured: 1,084, 4,379 and 12,511.
PREPARED_LATTICE = 1115
ESTIMATED_LATTICE = 4510
SIMULATED_LATTICE = 12790
# Of 100 members, and of 121 points of a grid; measured: 9,996 and 16,656.
MEMBERS = 10290
POINTS = 17150
# Of 100 members in frames of tribo's own; measured: 5,357.
OWN_OF_MEMBERS = 5510
# Of each further thousand of members that differ in starts; measured: 48, a third of which because
# the pilot consists of the first 4096 members, and of all where they are few.
EACH_THOUSAND = 49
# Of each further thousand of members that differ in numbers; measured: 50.
EACH_THOUSAND_OWN = 52
# Of each further thousand of points; measured: none.
EACH_THOUSAND_POINTS = 400


def calls(function):
    """The number of calls of Python's and of C's functions in a warm call."""
    return calls_of_all_and_own(function)[0]


def calls_of_all_and_own(function):
    """The same, and of these the calls of tribo's functions, and of C's functions by these."""
    function()
    function()
    count = own = 0

    def profile(frame, event, argument):
        nonlocal count, own
        if event in ("call", "c_call"):
            count += 1
            own += frame.f_code.co_filename.startswith(PACKAGE)

    sys.setprofile(profile)
    try:
        function()
    finally:
        sys.setprofile(None)
    return count, own


def test_prepared_pair():
    """From the call to the number, without and with its error estimate."""
    scene = tribo.paper.scene("A")
    ends = replace(scene, output=tribo.Output(samples=2))
    starts = iter(range(1, 100))
    prepared = tribo.prepare(ends, accuracy=1e-6)

    def number():
        start = {"upper.theta": next(starts) * 1e-9}
        return prepared.run(start, estimate=False)["upper"].w1[-1, 0]

    assert calls(number) <= PREPARED
    prepared = tribo.prepare(scene, accuracy=1e-8)
    assert calls(lambda: prepared.run()["upper"].w1[-1, 0]) <= ESTIMATED


def test_simulate():
    assert calls(lambda: tribo.simulate(CASE_A, accuracy=1e-8, progress=False)) <= SIMULATED


def test_lattice():
    """What its runs have in common, such as the units of its plug-ins, is made once."""
    row = {"shape": (3, 1), "spacing": (1.1, 0.0)}
    upper = tribo.Surface("upper", bob=(0.0, 1.2), velocity=(0.5, 0.0), **row)
    lower = tribo.Surface("lower", facing="up", **row)
    scene = tribo.Scene([upper, lower], tribo.Morse(0.1, 1.0, 1.5), duration=20.0)
    settings = {"accuracy": 1e-6, "method": "dop853"}
    prepared = tribo.prepare(scene, **settings)
    assert calls(lambda: prepared.run(estimate=False)["upper"].w1[-1]) <= PREPARED_LATTICE
    assert calls(lambda: prepared.run()["upper"].w1[-1]) <= ESTIMATED_LATTICE
    simulated = calls(lambda: tribo.simulate(scene, **settings, progress=False))
    assert simulated <= SIMULATED_LATTICE


def test_settings_of_an_ensemble():
    """A looser accuracy takes no more rounds until settings are found that keep it.

    Where the error of a step hardly depends on its tolerance, levels once approached the one that
    suffices in forty rounds.
    """
    morse = replace(tribo.paper.scene("A"), interactions=tribo.Morse(0.1, 1.0, 1.5))
    swings = {"upper.swing": np.linspace(0.0, 0.1, 2000)}

    def ensemble(accuracy):
        kept = ["upper.w1", "upper.w2", "upper.delta_e_int"]
        return tribo.ensemble(
            morse, 2000, vary=swings, accuracy=accuracy, keep=kept, threads=1, progress=False
        )

    assert calls(lambda: ensemble(1e-4)) <= 2 * calls(lambda: ensemble(1e-8))


def test_modules_of_a_run():
    """Where machine code is on disk, a process imports nothing that compiles it or reads files."""
    program = """
import sys, tribo
tribo.simulate(tribo.paper.scene("A"), accuracy=1e-6, progress=False)
unused = {"scipy.linalg", "numba.np.arraymath", "netCDF4", "xarray", "matplotlib", "numpy.ma"}
print(*sorted(unused & sys.modules.keys()))
"""
    subprocess.run([sys.executable, "-c", program], check=True)  # compiles, if that is needed
    found = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True)
    assert found.stdout.split() == []


def ensemble(members, **vary):
    vary = {"upper.theta": stats.norm(0.0, 0.1)} | vary
    options = {"keep": ["upper.w1"], "seed": 1, "threads": 1, "progress": False}
    return tribo.ensemble(CASE_A, members, vary, **options)


@pytest.mark.parametrize(
    ("vary", "each_thousand"),
    [({}, EACH_THOUSAND), ({"upper.asperite.kappa": stats.uniform(1.0, 2.0)}, EACH_THOUSAND_OWN)],
)
def test_members(vary, each_thousand):
    """Members make no calls of their own: what grows with them are batches of some thousands."""
    few, own = calls_of_all_and_own(lambda: ensemble(100, **vary))
    if not vary:
        assert few <= MEMBERS
        assert own <= OWN_OF_MEMBERS
    assert calls(lambda: ensemble(4100, **vary)) - few <= 4 * each_thousand


def test_points():
    """As members do; a sweep is an ensemble over a grid."""

    def sweep(places):
        values = {
            "upper.asperite.kappa": np.linspace(1.0, 3.0, places),
            "interaction.strength": np.linspace(0.3, 0.7, places),
        }
        return tribo.sweep(CASE_A, values, keep=["upper.w1"], threads=1, progress=False)

    few = calls(lambda: sweep(11))
    assert few <= POINTS
    more = (33**2 - 11**2) / 1000
    assert calls(lambda: sweep(33)) - few <= more * EACH_THOUSAND_POINTS
