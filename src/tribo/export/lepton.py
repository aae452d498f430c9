"""Energies of potentials as text that LAMMPS evaluates and differentiates (pair_style lepton).

A potential's energy is called with a formula in place of the distance, which records every
operation.  Constants are evaluated by Python, so the text has the same numbers to all digits.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from tribo.potentials.derivative import NoFormulaError
from tribo.potentials.potential import Potential

# Text of what numpy's functions and Python's operators do.
OPERATIONS = {
    np.add: "({0}+{1})",
    np.subtract: "({0}-{1})",
    np.multiply: "({0}*{1})",
    np.divide: "({0}/{1})",
    np.power: "({0})^({1})",
    np.negative: "(-{0})",
    np.positive: "{0}",
    np.square: "({0})^2",
    np.absolute: "abs({0})",
    np.minimum: "min({0},{1})",
    np.maximum: "max({0},{1})",
    # step(x) is 0 for x < 0, else 1
    np.less: "(1-step({0}-{1}))",
    np.less_equal: "step({1}-{0})",
    np.greater: "(1-step({1}-{0}))",
    np.greater_equal: "step({0}-{1})",
} | {
    function: f"{function.__name__}({{0}})"
    for function in (np.exp, np.log, np.sqrt, np.sin, np.cos, np.tan, np.sinh, np.cosh, np.tanh)
}

COMPARISONS = (np.less, np.less_equal, np.greater, np.greater_equal)


def _refuse(formula: Formula, *_: object) -> Any:
    raise NoFormulaError


class Formula(np.lib.mixins.NDArrayOperatorsMixin):
    """A quantity as the text of its formula; a `condition` is a comparison, of value 0 or 1."""

    def __init__(self, text: str, condition: bool = False) -> None:
        self.text = text
        self.condition = condition

    def __array_ufunc__(self, function: np.ufunc, method: str, *inputs: object) -> Formula:
        """The formula of a function of numpy, or of an operator."""
        if method != "__call__" or function not in OPERATIONS:
            raise NoFormulaError
        if function is np.less and inputs[1] == math.inf:
            return Formula("1", condition=True)  # below a range that has no end
        for factor, other in (inputs, inputs[::-1]) if function is np.multiply else ():
            if isinstance(factor, Formula) and factor.condition:
                # the other may be no number where the condition is false
                return Formula(f"select({factor.text},{_text(other)},0)")
        return Formula(OPERATIONS[function].format(*map(_text, inputs)), function in COMPARISONS)

    def __array_function__(
        self, function: Callable[..., Any], types: object, inputs: tuple[object, ...], _: object
    ) -> Formula:
        """The formula of ``np.where`` of a condition and two values."""
        if function is not np.where or len(inputs) != 3:
            raise NoFormulaError
        condition, chosen, other = inputs
        if not isinstance(condition, Formula):
            return Formula(_text(chosen if condition else other))
        if condition.text == "1":
            return Formula(_text(chosen))
        return Formula("select({},{},{})".format(*map(_text, inputs)))

    # A program that decides, or takes an element, by the value of a formula.
    __bool__ = __int__ = __float__ = __index__ = __complex__ = _refuse


def _text(value: object) -> str:
    if isinstance(value, Formula):
        return value.text
    number = float(value)  # type: ignore[arg-type]
    if not math.isfinite(number):
        raise NoFormulaError
    return f"({number!r})" if number < 0.0 else repr(number)


def energy_text(potential: Potential) -> str:
    """U as a formula of the distance r and the charges qi and qj of a pair.

    Raises NoFormulaError if the energy is computed otherwise, as from a table.
    """
    try:
        energy = potential.energy_between(Formula("r"), Formula("qi"), Formula("qj"))
    except (TypeError, ValueError, IndexError, AttributeError) as error:
        raise NoFormulaError from error
    return _text(energy)
