"""The decision after a round, by tables: no run is made."""

import math
from dataclasses import replace

import pytest

from tribo.accuracy.decision import LONG_RUN, Limits, Round, Stop, best, decide, is_too_long

ADAPTIVE = Limits(wanted=1e-6, order=12, adaptive=True, finest=1e-13, amplification=10.0)
EQUAL = replace(ADAPTIVE, order=2, adaptive=False)


def rounds(*excesses, level=1e-6):
    """Completed rounds, each at a tenth of the level of the one before."""
    return [
        Round(level * 0.1**k, None, excess, excess, steps=100) for k, excess in enumerate(excesses)
    ]


def stopped(status, level=1e-7):
    return Round(level, status)


@pytest.mark.parametrize(
    ("history", "limits", "wanted"),
    [
        (rounds(0.9), ADAPTIVE, Stop.MET),
        (rounds(1.1), replace(ADAPTIVE, exhausted=True), Stop.EXHAUSTED),
        (rounds(1.1), replace(ADAPTIVE, finest=1e-6), Stop.FINEST),
        (rounds(8.0, 6.0, 4.0), ADAPTIVE, Stop.STALLED),
        (rounds(8.0), replace(ADAPTIVE, amplification=None), Stop.OUT_OF_REACH),
        (rounds(8.0), replace(ADAPTIVE, amplification=1e11), Stop.OUT_OF_REACH),
        ([stopped("Interrupted")], ADAPTIVE, Stop.ENDED),
        ([*rounds(8.0), stopped("NoProgress", 4e-7)], ADAPTIVE, Stop.BRACKETED),
        # Levels: a tenth where the excess is small, else what the excess asks for.
        (rounds(2.0), ADAPTIVE, 1e-7),
        (rounds(60.0), ADAPTIVE, 1e-6 * 0.3 / 60.0),
        (rounds(math.inf), ADAPTIVE, 1e-8),
        (rounds(60.0), replace(ADAPTIVE, finest=1e-7), 1e-7),
        (rounds(8.0, 6.0), ADAPTIVE, 1e-7 * 0.3 / 6.0),  # one stalled round is chance
        (rounds(8.0, 6.0, 1.5, 1.2), ADAPTIVE, 1e-10),  # a gain between two stalls
        # Between a level at which runs stop and one at which they do not.
        ([*rounds(8.0), stopped("NoProgress", 1e-8)], ADAPTIVE, 1e-7),
        ([stopped("NoProgress", 1e-8)], replace(ADAPTIVE, reached=1e-4), 1e-6),
        ([stopped("NoProgress", 1e-8)], ADAPTIVE, Stop.BRACKETED),
        # Equal steps that are too long: a quarter of the step, by a method of order 2.
        ([stopped("NotFinite", 1e-6)], EQUAL, 1e-6 / 16.0),
        (rounds(2e6), EQUAL, 1e-6 / 16.0),
        (rounds(8.0, 7.0), EQUAL, 1e-7 * 0.3 / 7.0),
    ],
)
def test_the_decision_after_a_round(history, limits, wanted):
    found = decide(history, limits)
    if isinstance(wanted, Stop):
        assert found is wanted
    else:
        assert not isinstance(found, Stop)
        assert found == pytest.approx(wanted, rel=1e-12, abs=0.0)


def test_long_runs_are_not_repeated_with_shorter_steps():
    """Equal steps of a long run are not called too long: a shorter one would take longer still."""
    long = Round(1e-6, "NotFinite", work=LONG_RUN)
    assert is_too_long([stopped("NotFinite")], EQUAL)
    assert not is_too_long([long], EQUAL)
    assert not is_too_long([stopped("NotFinite")], ADAPTIVE)


def test_the_best_round():
    """The finest of those about as good as the best; where finer ones stop, the finest known."""
    one, two, three = rounds(0.5, 0.3, 0.4)
    assert best([one, two, three], ADAPTIVE) is three
    assert best([one, two, Round(1e-9, None, 0.9, 0.9)], ADAPTIVE) is two
    bad = rounds(0.5 / ADAPTIVE.wanted)
    stop = stopped("NoProgress", 1e-9)
    assert best([*bad, stop], ADAPTIVE) is stop
    assert best([one, stop], ADAPTIVE) is one
