"""Energies that take complex numbers, but lose the imaginary part by which slopes are measured."""

from typing import NamedTuple

import numpy as np
import pytest

from tribo import Field, InputError, Interaction, Potential


class Magnitude(Potential):
    """A formula: its source is differentiated, on either side of each kink."""

    height: float
    centre: float

    def energy(self, r):
        x = abs(r - self.centre)
        return self.height * np.exp(-x) + self.height * np.abs(r) ** -2


class Peaks(Potential):
    """No formula, since it has a loop; `analytic` is whether complex numbers pass."""

    height: float
    analytic: float

    def energy(self, r):
        total = 0.0
        for place in range(1, 4):
            x = r - place
            total = total + (np.exp(-x * x) if self.analytic > 0.0 else np.exp(-abs(x)))
        return self.height * total


class Far(Potential):
    """Waves, steep walls, and values that are denormal."""

    height: float

    def energy(self, r):
        total = 0.0
        for power in (36, 12):
            total = total + self.height / r**power
        return total + self.height * np.cos(80.0 * r) * np.exp(-r * r)


class Kinked(NamedTuple):
    depth: float

    def energy_at(self, x, y):
        return self.depth * np.abs(x) * y


class Smooth(NamedTuple):
    depth: float

    def energy_at(self, x, y):
        return self.depth * np.cos(60.0 * x) * np.exp(-y * y)


class KinkedInTime(NamedTuple):
    depth: float

    def energy_at_time(self, t, x, y):
        return self.depth * x * abs(np.sin(t))


class Swinging(NamedTuple):
    depth: float

    def energy_at_time(self, t, x, y):
        return self.depth * x * y * np.sin(40.0 * t)


FIELDS = {each.__name__: each for each in (Kinked, Smooth, KinkedInTime, Swinging)}


@pytest.mark.parametrize("r", [0.3, 1.1, 2.9])
def test_magnitudes_are_differentiated(r):
    own = Magnitude(0.3, 1.3)
    slope = (own.energy(r + 1e-6) - own.energy(r - 1e-6)) / 2e-6
    assert own.force(r) == pytest.approx(-slope, rel=1e-6)
    assert own.force.__func__.__name__ == "force"


def test_potentials_whose_steps_are_no_slopes_are_refused():
    with pytest.raises(InputError, match=r"Peaks has no force.*in place of.*define force"):
        Interaction(Peaks(0.3, 0.0))
    for right in (Peaks(0.3, 1.0), Far(0.3), Magnitude(0.3, 1.3)):
        Interaction(right)


@pytest.mark.parametrize(
    ("name", "lacking"),
    [("Kinked", "force_at"), ("KinkedInTime", "power_at_time"), ("Smooth", ""), ("Swinging", "")],
)
def test_fields_whose_steps_are_no_slopes_are_refused(name, lacking):
    field = FIELDS[name](0.1)
    if not lacking:
        assert Field(field, ["upper"]).on == ("upper",)
        return
    with pytest.raises(InputError, match=f"has no {lacking}.*define {lacking}"):
        Field(field, ["upper"])
