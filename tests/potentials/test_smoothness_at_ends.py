"""Potentials that end, and declare no smoothness."""

import math

import numpy as np
import pytest

import tribo


class Power(tribo.Potential):
    """A (1 - r / d)^p up to d; no smoothness is declared."""

    A: float
    d: float
    p: float

    def energy(self, r):
        return self.A * max(1.0 - r / self.d, 0.0) ** self.p

    def force(self, r):
        return self.A * self.p / self.d * max(1.0 - r / self.d, 0.0) ** (self.p - 1.0)

    def range(self):
        return self.d


class Bump(Power):
    """All derivatives vanish at the end."""

    def energy(self, r):
        x = 1.0 - r / self.d
        return self.A * np.exp(-1.0 / x) if x > 0.0 else 0.0

    def force(self, r):
        x = 1.0 - r / self.d
        return self.A * np.exp(-1.0 / x) / (self.d * x * x) if x > 0.0 else 0.0

    def range(self):
        return self.d


class Declared(Power):
    def smoothness(self):
        return 5


def impact(potential):
    """Two rigid asperites that meet head-on, and exchange their velocities."""
    rigid = tribo.Asperite(m1=1.0, m2=2.0, kappa=math.inf)
    upper = tribo.Surface(
        "upper", bob=(-1.5, 0.0), velocity=(0.5, 0.0), drive="free", asperite=rigid
    )
    lower = tribo.Surface("lower", facing="up", velocity=(-0.5, 0.0), drive="free", asperite=rigid)
    return tribo.Scene((upper, lower), potential, 4.0, output=tribo.Output(samples=5))


@pytest.mark.parametrize(
    ("potential", "smoothness"),
    [
        (Power(3.0, 1.2, 1.0), 0),
        (Power(3.0, 1.2, 1.5), 1),
        (Power(3.0, 1.2, 2.0), 1),
        (Power(3.0, 1.2, 2.5), 2),
        (Power(3.0, 1.2, 3.0), 2),
        (Power(3.0, 1.2, 2.5) + tribo.Coulomb(0.1), 2),
        (2.0 * Power(3.0, 1.2, 2.5), 2),
        (Bump(3.0, 1.2, 0.0), math.inf),
        (Declared(3.0, 1.2, 2.5), 5),
        (tribo.Coulomb(0.1), math.inf),
    ],
)
def test_smoothness_at_the_range(potential, smoothness):
    """The number of continuous derivatives follows from the power with which U vanishes."""
    assert impact(potential).smoothness == smoothness


@pytest.mark.slow  # a potential of its own is compiled
def test_impact_keeps_a_strict_accuracy():
    """The estimate was 94 times the request, where the error was a fortieth of it."""
    result = tribo.simulate(impact(Power(10.0, 1.0, 2.5)), accuracy=1e-10, progress=False)
    assert result.met, result.notes
    error = abs(result["upper"].vx_cm[-1, 0] + 0.5)
    assert error <= result.error_estimate["vx_cm"] <= 1e-10
