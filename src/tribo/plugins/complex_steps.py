"""Whether a derivative by a complex step is the slope of the energy, as it is not for ``abs(x)``.

An energy that takes complex numbers need not be analytic: magnitudes, signs and real parts lose the
imaginary part by which the step measures the slope.
"""

from collections.abc import Callable, Sequence
from functools import partial

# The step of differences, relative to the number, and a shorter one, in units of that.
DIFFERENCE = 1e-5
SHORTER = 0.25
# How much the two may differ where they are the slope: not over many waves, or a jump.
KNOWN = 1e-3
# How much a derivative may differ from it.
UNLIKE = 1e-2
# Relative error of an energy.
ROUND_OFF = 1e-14
# A slope below which a complex step has too few digits: its part of 1e-100 is denormal.
FAINTEST = 1e-200
WHY = "as with abs, sign or real parts"


def unlike_slope(
    energy: Callable[..., float], slopes: Callable[..., Sequence[float]], *place: float
) -> str:
    """A part of a sentence on a derivative at a place that is not the energy's, or nothing.

    `energy` takes the numbers of the place, and `slopes` has a derivative by each of them.  Nothing
    is said where they cannot be computed.
    """
    try:
        derivatives = [float(each) for each in slopes(*place)]
    except Exception:  # of the user's code, at a place that it does not take
        return ""
    for k, (derivative, number) in enumerate(zip(derivatives, place, strict=True)):
        of_one = partial(_of_one, energy, place, k)
        try:
            long, unsure = _difference(of_one, number, DIFFERENCE)
            short, _ = _difference(of_one, number, SHORTER * DIFFERENCE)
        except Exception:  # likewise
            continue
        if abs(long - short) > KNOWN * abs(long) + unsure / SHORTER:
            continue
        if abs(derivative - long) > UNLIKE * abs(long) + unsure / SHORTER:
            where = ", ".join(f"{each:.3g}" for each in place)
            return f"{derivative:.3g} in place of {long:.3g} at {where}, {WHY}"
    return ""


def _of_one(energy: Callable[..., float], place: tuple[float, ...], k: int, number: float) -> float:
    """The energy at a place with another kth number."""
    return float(energy(*place[:k], number, *place[k + 1 :]))


def _difference(
    function: Callable[[float], float], number: float, relative: float
) -> tuple[float, float]:
    """The slope of a function of one number by a difference, and what round-off makes unsure."""
    step = relative * abs(number)
    before, after = function(number - step), function(number + step)
    unsure = ROUND_OFF * (abs(before) + abs(after)) / step
    return (after - before) / (2.0 * step), unsure + FAINTEST
