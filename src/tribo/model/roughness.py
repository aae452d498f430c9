"""Heights of asperites, drawn: uncorrelated, or self-affine with a Hurst exponent.

A self-affine surface has the isotropic power spectrum

    C(q) ~ q^(-2 - 2H)  in two dimensions (a grid),   C(q) ~ q^(-1 - 2H)  in one (a row),

between the wave numbers 2 pi / longest and 2 pi / shortest.  At longer wavelengths the spectrum
is flat, the roll-off of real surfaces; at shorter ones it is zero.

B. N. J. Persson et al., J. Phys.: Condens. Matter 17 (2005) R1;
T. D. B. Jacobs, T. Junge, L. Pastewka, Surf. Topogr.: Metrol. Prop. 5 (2017) 013001.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from tribo.validation import (
    NOT_NEGATIVE,
    POSITIVE,
    Condition,
    InputError,
    inside,
    known_keys,
    number,
    vector,
    whole,
)

FRACTION: Condition = ("must be between 0 and 1, both excluded", lambda x: 0.0 < x < 1.0)
ROUNDING = 1.0 + 1e-9  # wavelengths whose ratio is less than this are the same


@dataclass(frozen=True)
class Roughness:
    """How rough a surface is; :func:`draw` draws its heights."""

    rms: float  # root mean square of the heights about their mean [length]
    hurst: float | None = None  # Hurst exponent H, 0 < H < 1; None: uncorrelated heights
    shortest: float | None = None  # wavelength [length]; None: twice the (larger) spacing
    longest: float | None = None  # wavelength [length]; None: the surface's (longer) side
    seed: int | None = None  # of this surface's own; None: drawn with all else in the scene

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "rms", number("rms", self.rms, NOT_NEGATIVE))
        if self.hurst is not None:
            put(self, "hurst", number("hurst", self.hurst, FRACTION))
        for key in ("shortest", "longest"):
            if getattr(self, key) is not None:
                put(self, key, number(key, getattr(self, key), POSITIVE))
                if self.hurst is None:
                    raise InputError(key, "is of no use without hurst; give hurst too")
        if self.seed is not None:
            put(self, "seed", whole("seed", self.seed, 0))

    def cut_offs(self, shape: tuple[int, int], spacing: tuple[float, float]) -> tuple[float, float]:
        """The shortest and longest wavelength of a self-affine row or grid of asperites."""
        spacings = [abs(s) for n, s in zip(shape, spacing, strict=True) if n > 1]
        if not spacings or 0.0 in spacings:
            raise InputError(
                "hurst", "needs a spacing along every direction with more than one asperite"
            )
        finest = 2.0 * max(spacings)
        side = max(n * abs(s) for n, s in zip(shape, spacing, strict=True) if n > 1)
        shortest = finest if self.shortest is None else self.shortest
        longest = side if self.longest is None else self.longest
        if shortest * ROUNDING < finest:
            raise InputError("shortest", f"must be at least twice the spacing, got {shortest}")
        if longest > side * ROUNDING:
            raise InputError("longest", f"must be at most the surface's side {side}, got {longest}")
        if shortest >= longest:
            key = next(k for k in ("longest", "shortest", "hurst") if getattr(self, k) is not None)
            raise InputError(
                key,
                f"finds no wavelengths from the shortest, {shortest}, to the longest, {longest}",
            )
        return shortest, longest

    def check(self, shape: tuple[int, int], spacing: tuple[float, float]) -> None:
        """Complain if there is no such roughness on a row or grid of asperites."""
        if shape[0] * shape[1] == 1 and self.rms > 0.0:
            raise InputError("rms", f"must be 0 for one asperite, got {self.rms}")
        if self.hurst is not None:
            self.cut_offs(shape, spacing)


def draw(
    roughness: Roughness,
    shape: tuple[int, int],
    spacing: tuple[float, float],
    rng: np.random.Generator,
) -> np.ndarray:
    """(nx nz,) heights of a row or grid of shape (nx, nz), x running fastest [length].

    White Gaussian noise, filtered to the wanted spectrum: Gaussian amplitudes and random phases.
    Each draw is then shifted to a mean of zero and scaled to exactly `rms`, so the shape of its
    spectrum is what is wanted, and the size is that of the heights drawn rather than of many.
    Self-affine heights are periodic over nx and nz spacings, as a periodic scene wants them.
    A roughness with a seed of its own leaves `rng` alone.
    """
    roughness.check(shape, spacing)
    if roughness.seed is not None:
        rng = np.random.default_rng(roughness.seed)
    nx, nz = shape
    heights = rng.standard_normal((nz, nx))
    if roughness.rms == 0.0:
        return np.zeros(nx * nz)
    if roughness.hurst is not None:
        waves = np.fft.rfft2(heights) * _amplitudes(roughness, shape, spacing)
        heights = np.fft.irfft2(waves, s=(nz, nx))
    heights -= np.mean(heights)
    return (heights * (roughness.rms / np.sqrt(np.mean(heights**2)))).ravel()


def _amplitudes(
    roughness: Roughness, shape: tuple[int, int], spacing: tuple[float, float]
) -> np.ndarray:
    """(nz, nx // 2 + 1) relative amplitudes sqrt(C) of the waves of a real Fourier transform."""
    assert roughness.hurst is not None
    shortest, longest = roughness.cut_offs(shape, spacing)
    nx, nz = shape
    along_x = np.fft.rfftfreq(nx, spacing[0] if nx > 1 else 1.0)
    along_z = np.fft.fftfreq(nz, spacing[1] if nz > 1 else 1.0)
    wave_number = np.hypot(along_z[:, None], along_x)  # 1 / wavelength
    dimensions = (nx > 1) + (nz > 1)
    amplitudes = np.maximum(wave_number * longest, 1.0) ** (-0.5 * dimensions - roughness.hurst)
    amplitudes[wave_number * shortest > ROUNDING] = 0.0
    amplitudes[0, 0] = 0.0
    return amplitudes


def as_roughness(value: Any) -> Roughness:
    """A roughness from its table in a scene file, or itself."""
    if isinstance(value, Roughness):
        return value
    return Roughness(**known_keys(value, [f.name for f in fields(Roughness)], ["rms"]))


def as_table(roughness: Roughness) -> dict[str, Any]:
    """The roughness's table in a scene file."""
    settings = {f.name: getattr(roughness, f.name) for f in fields(Roughness)}
    return {key: value for key, value in settings.items() if value is not None}


def as_heights(
    value: Any, shape: tuple[int, int], spacing: tuple[float, float]
) -> np.ndarray | Roughness | None:
    """A surface's `heights`: (nx nz,) numbers, a roughness that suits the surface, or None.

    A list of asperites, which has no spacing, is of shape (n, 1) and spacing (0, 0).
    """
    if value is None:
        return None
    if not isinstance(value, (Roughness, Mapping)):
        return vector("heights", value, size=shape[0] * shape[1])
    with inside("heights"):
        roughness = as_roughness(value)
        roughness.check(shape, spacing)
    return roughness
