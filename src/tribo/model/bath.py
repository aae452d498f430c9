"""Baths: oscillators on every bar of a surface that absorb its energy and return it.

A point oscillator is a mass m in the plane, tied to the bar's centre by a spring of stiffness m w^2
and zero rest length.  A torsional one is a moment of inertia tied to the bar's angle phi.
"""

from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from tribo import validation as check
from tribo.model.recurrence import KINDS, Kind
from tribo.model.spectrum import Spectrum
from tribo.model.tables import ComparedByValue
from tribo.validation import InputError, inside, must_be

# Keys that the table of a bath needs together with `spectrum`.
SPECTRAL_KEYS = ("gamma", "cutoff", "n")
KEYS = ("oscillators", "torsional", "temperature", "spectrum", *SPECTRAL_KEYS)
# Units of the keys of a listed oscillator.
UNITS = {"mass": "mass", "inertia": "mass length^2", "frequency": "rad / time"}


_none = partial(np.empty, 0)


@dataclass(frozen=True, eq=False)
class Bath(ComparedByValue):
    """Oscillators on every bar of a surface: n point oscillators and k torsional ones.

    With a `spectrum`, masses and frequencies are those of its oscillators and are not given.

    Attributes
    ----------
    masses : (n,) array
        Masses of the point oscillators [mass].
    frequencies : (n,) array
        Their angular frequencies [rad / time].
    inertias : (k,) array
        Moments of inertia of the torsional oscillators [mass length^2]; they need bars that turn.
    torsional_frequencies : (k,) array
        Their angular frequencies [rad / time].
    temperature : float
        Temperature from which they start [energy], with k_B = 1.
    spectrum : Spectrum, optional
        The continuum that the point oscillators discretise.
    """

    masses: np.ndarray = field(default_factory=_none)
    frequencies: np.ndarray = field(default_factory=_none)
    inertias: np.ndarray = field(default_factory=_none)
    torsional_frequencies: np.ndarray = field(default_factory=_none)
    temperature: float = 0.0
    spectrum: Spectrum | None = None

    def __post_init__(self) -> None:
        """Check all values; the oscillators of a spectrum become masses and frequencies."""
        put = object.__setattr__
        for sizes, rates, unit in (
            ("masses", "frequencies", "mass"),
            ("inertias", "torsional_frequencies", "mass length^2"),
        ):
            put(self, sizes, check.vector(sizes, getattr(self, sizes), check.POSITIVE, unit=unit))
            count = getattr(self, sizes).size
            given = getattr(self, rates)
            put(self, rates, check.vector(rates, given, check.POSITIVE, count, "rad / time"))
        check.fields(self, temperature=check.one(check.NOT_NEGATIVE, "energy"))
        if self.spectrum is None:
            return
        own = check.instance(Spectrum)("spectrum", self.spectrum).oscillators()
        given = (self.masses, self.frequencies)
        if self.masses.size and not all(map(np.array_equal, given, own)):
            raise InputError("masses", "cannot go with spectrum; give one or the other")
        for name, values in zip(("masses", "frequencies"), own, strict=True):
            values.flags.writeable = False
            put(self, name, values)

    def __bool__(self) -> bool:
        return self.masses.size + self.inertias.size > 0

    @property
    def mass(self) -> float:
        """Mass of all point oscillators of one bar [mass].

        The surface's `delta_K`, `W_ps` and `V` count it, so they depend on n although the motion
        converges as n grows: for a Drude spectrum it is gamma (2n - 1) / cutoff.
        """
        return float(np.sum(self.masses))

    @property
    def stiffnesses(self) -> np.ndarray:
        """(n,) stiffness of the springs to the bar's centre [force / length]."""
        return self.masses * self.frequencies**2


# The bath of most surfaces, which all of them share: none of its values can be changed.
NO_BATH = Bath()


def no_bath() -> Bath:
    return NO_BATH


def as_bath(value: object) -> Bath:
    """A bath from a table of a scene file, None (no bath), or a Bath unchanged."""
    if value is None:
        return NO_BATH
    if isinstance(value, Bath):
        return check.as_parent(value, [Bath])  # type: ignore[no-any-return]
    table = check.known_keys(value, KEYS)
    settings: dict[str, Any] = {"temperature": table.get("temperature", 0.0)}
    if "spectrum" in table:
        kind: Kind = check.choice("spectrum", table["spectrum"], KINDS)
        if "oscillators" in table:
            raise InputError("oscillators", "cannot go with spectrum; give one or the other")
        check.known_keys(table, table, SPECTRAL_KEYS)
        settings["spectrum"] = Spectrum(kind, *(table[key] for key in SPECTRAL_KEYS))
    else:
        for key in SPECTRAL_KEYS:
            if key in table:
                raise InputError("spectrum", f"is missing; {key} needs a spectrum")
        settings["masses"], settings["frequencies"] = _listed(table, "oscillators", "mass")
    settings["inertias"], settings["torsional_frequencies"] = _listed(table, "torsional", "inertia")
    return Bath(**settings)


def _listed(table: dict[str, Any], key: str, size: str) -> tuple[list[float], list[float]]:
    """Sizes (masses or moments of inertia) and frequencies of a list of oscillators."""
    items = table.get(key, [])
    if not isinstance(items, (list, tuple)):
        raise must_be(key, f"a list of {{{size}, frequency}}", items)
    columns: tuple[list[float], list[float]] = ([], [])
    for i, item in enumerate(items):
        with inside(f"{key}[{i}]"):
            check.known_keys(item, [size, "frequency"], [size, "frequency"])
            for column, name in zip(columns, (size, "frequency"), strict=True):
                column.append(check.number(name, item[name], check.POSITIVE, UNITS[name]))
    return columns


def as_table(bath: Bath) -> dict[str, Any]:
    """The table of a scene file that describes a bath, by its spectrum where it has one."""
    table: dict[str, Any] = {}
    if bath.spectrum is None:
        pairs = zip(bath.masses.tolist(), bath.frequencies.tolist(), strict=True)
        table["oscillators"] = [{"mass": m, "frequency": w} for m, w in pairs]
    else:
        table["spectrum"] = bath.spectrum.kind
        table |= {key: getattr(bath.spectrum, key) for key in SPECTRAL_KEYS}
    if bath.inertias.size:
        pairs = zip(bath.inertias.tolist(), bath.torsional_frequencies.tolist(), strict=True)
        table["torsional"] = [{"inertia": i, "frequency": w} for i, w in pairs]
    if bath.temperature:
        table["temperature"] = bath.temperature
    return table
