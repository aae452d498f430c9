"""The contact force at eight places: all at once where a formula is arithmetic alone."""

from typing import NamedTuple

import pytest
from numba import NumbaError

import tribo
from tribo.compiler.plugin_methods import type_of
from tribo.kernels.potential_in_lanes import is_vectorized


class WithAName(NamedTuple):
    """A formula that fails to compile for another reason than a missing operation on Lanes."""

    scale: float

    def force_between(self, r, charge1, charge2):
        """A force."""
        return self.scale * undefined  # noqa: F821


@pytest.mark.parametrize(
    ("potential", "expected"),
    [
        (tribo.Coulomb(0.3), True),
        (tribo.Morse(0.3, 1.5, 0.6), True),
        (tribo.LennardJones(0.2, 0.5).with_cutoff(1.8), True),
        (tribo.Mie(0.2, 0.5, 12.5, 6.0), False),
    ],
)
def test_formulas_of_arithmetic_are_vectorized(potential, expected):
    """Powers that are not whole are computed one distance after another, and so are branches."""
    assert is_vectorized(type_of(potential)) is expected


def test_other_errors_are_raised():
    """Only an operation that Lanes lack leads to the slower way."""
    with pytest.raises(NumbaError, match="undefined"):
        is_vectorized(type_of(WithAName(1.0)))
