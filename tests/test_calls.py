"""Python calls of single runs, which cost more time than their time loops do.

They hardly depend on the machine.  A bound that a change exceeds is work done for each run: find
what is the same for all of them, and compute it once.
"""

import sys
from dataclasses import replace

import tribo

# Calls of functions in Python and in C, in all frames; measured: 58, 822 and 10,623.
PREPARED, ESTIMATED, SIMULATED = 66, 900, 11700


def calls(function):
    """The numbers of calls of Python's and of C's functions in a warm call."""
    function()
    function()
    count = 0

    def profile(frame, event, argument):
        nonlocal count
        count += event in ("call", "c_call")

    sys.setprofile(profile)
    try:
        function()
    finally:
        sys.setprofile(None)
    return count


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
    scene = tribo.paper.scene("A")
    assert calls(lambda: tribo.simulate(scene, accuracy=1e-8, progress=False)) <= SIMULATED
