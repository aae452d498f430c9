"""Random heights of asperites: uncorrelated, or self-affine with a Hurst exponent.

A self-affine surface has the isotropic power spectrum

    C(q) ~ q^(-2 - 2H)  in two dimensions (a grid),   C(q) ~ q^(-1 - 2H)  in one (a row),

between the wave numbers 2 pi / longest and 2 pi / shortest.  At longer wavelengths the spectrum
is constant, the roll-off of real surfaces; at shorter ones it is zero.

B. N. J. Persson et al., J. Phys.: Condens. Matter 17 (2005) R1;
T. D. B. Jacobs, T. Junge, L. Pastewka, Surf. Topogr.: Metrol. Prop. 5 (2017) 013001.
"""

from dataclasses import dataclass

import numpy as np

from tribo import validation as check
from tribo.validation import InputError, must_be

FRACTION: check.Condition = (
    "must be between 0 and 1, both excluded",
    lambda x: (x > 0.0) & (x < 1.0),
)
# Ratio up to which two wavelengths are the same, in spite of rounding.
ROUNDING = 1.0 + 1e-9


@dataclass(frozen=True)
class Roughness:
    """The statistics from which the heights of a surface are drawn.

    Attributes
    ----------
    rms : float
        Root mean square of the heights about their mean [length].
    hurst : float, optional
        Hurst exponent H, 0 < H < 1; None for uncorrelated heights.
    shortest : float, optional
        Shortest wavelength [length]; None for twice the (larger) spacing.
    longest : float, optional
        Longest wavelength [length]; None for the (longer) side of the surface.
    seed : int, optional
        Seed of this surface; None for the seed of the scene.

    Raises
    ------
    InputError
        If a value is out of range, or a wavelength is given without `hurst`.
    """

    rms: float
    hurst: float | None = None
    shortest: float | None = None
    longest: float | None = None
    seed: int | None = None

    def __post_init__(self) -> None:
        wavelength = check.one(check.POSITIVE, "length")
        check.fields(self, rms=check.one(check.NOT_NEGATIVE, "length"), hurst=check.one(FRACTION))
        check.fields(self, shortest=wavelength, longest=wavelength, seed=check.count(0))
        for key in ("shortest", "longest"):
            if getattr(self, key) is not None and self.hurst is None:
                raise InputError(key, "needs a Hurst exponent; give hurst too")

    def cut_offs(self, shape: tuple[int, int], spacing: tuple[float, float]) -> tuple[float, float]:
        """The shortest and longest wavelength on a row or grid of asperites [length]."""
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
            raise must_be("shortest", f"at least twice the spacing, {finest} [length]", shortest)
        if longest > side * ROUNDING:
            raise must_be("longest", f"at most the surface's side, {side} [length]", longest)
        if shortest >= longest:
            key = next(k for k in ("longest", "shortest", "hurst") if getattr(self, k) is not None)
            raise InputError(
                key,
                f"leaves no wavelengths between the shortest, {shortest}, and longest, {longest}",
            )
        return shortest, longest

    def check(self, shape: tuple[int, int], spacing: tuple[float, float]) -> None:
        """Raise InputError if a row or grid of asperites cannot have this roughness."""
        if shape[0] * shape[1] == 1 and self.rms > 0.0:
            raise must_be("rms", "0 for one asperite", self.rms)
        if self.hurst is not None:
            self.cut_offs(shape, spacing)


def draw(
    roughness: Roughness,
    shape: tuple[int, int],
    spacing: tuple[float, float],
    rng: np.random.Generator,
) -> np.ndarray:
    """(nx nz,) heights of a row or grid of shape (nx, nz), x running fastest [length].

    White Gaussian noise is filtered to the spectrum, which gives Gaussian amplitudes and random
    phases.  Each draw is then shifted to a mean of zero and scaled to exactly `rms`: every draw
    has this root mean square, not only the average over many draws.  Self-affine heights are
    periodic over nx and nz spacings, as periodic scenes require.  `rng` is not used by a roughness
    that has a seed.
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
