"""Drawn heights: their spectrum, their size, their seeds, and what is refused."""

import numpy as np
import pytest

from tribo import InputError, Roughness
from tribo.model.roughness import draw
from tribo.model.surface import as_heights
from tribo.model.tables import from_table, table_of
from tribo.model.topography import Grid

ROW = (512, 1)
GRID = (96, 64)
SPACING = (0.5, 0.5)


def log_spectrum(roughness, shape, spacing=SPACING, draws=200):
    """1 / wavelength, and the mean over many draws of log |h_q|^2, of all complex waves.

    A mean of logarithms, because the scaling of every draw to its rms then shifts all waves
    alike. Waves that are their own conjugates have one degree of freedom, not two: left out.
    """
    nx, nz = shape
    rng = np.random.default_rng(1)
    fx = np.fft.rfftfreq(nx, spacing[0])
    fz = np.fft.fftfreq(nz, spacing[1]) if nz > 1 else np.zeros(1)
    complex_waves = slice(1, (nx + 1) // 2)
    logs = np.zeros((nz, fx.size))
    for _ in range(draws):
        heights = draw(roughness, shape, spacing, rng).reshape(nz, nx)
        logs += np.log(np.abs(np.fft.rfft2(heights)) ** 2 + 1e-300)
    f = np.hypot(fz[:, None], fx)
    return f[:, complex_waves], logs[:, complex_waves] / draws


def slope_and_error(x, y, draws=200):
    """Least-squares slope and its standard error; log of an exponential variate: pi^2 / 6."""
    centred = x - x.mean()
    error = np.sqrt(np.pi**2 / 6 / draws / np.sum(centred**2))
    return np.sum(centred * y) / np.sum(centred**2), error


@pytest.mark.parametrize("hurst", [0.2, 0.5, 0.8])
@pytest.mark.parametrize(("shape", "dimensions"), [(ROW, 1), (GRID, 2)])
def test_the_slope_of_the_spectrum_gives_the_hurst_exponent(hurst, shape, dimensions):
    f, logs = log_spectrum(Roughness(1.0, hurst), shape)
    inside = (f >= 1 / (shape[0] * SPACING[0])) & (f <= 1 / (2 * SPACING[0]))
    slope, error = slope_and_error(np.log(f[inside]), logs[inside])
    assert error < 0.02
    assert abs(-0.5 * (slope + dimensions) - hurst) < 2 * error  # 4 standard errors of H


def test_a_row_along_z_has_the_spectrum_of_a_row_along_x():
    one = draw(Roughness(1.0, 0.5, seed=3), (64, 1), (0.5, 0.0), np.random.default_rng())
    other = draw(Roughness(1.0, 0.5, seed=3), (1, 64), (0.0, 0.5), np.random.default_rng())
    np.testing.assert_allclose(one, other, atol=1e-14)


def test_a_grid_is_isotropic_whatever_its_spacings():
    f, logs = log_spectrum(Roughness(1.0, 0.7), (64, 48), (0.25, 0.5))
    inside = f <= 1 / (2 * 0.5)
    slope, _ = slope_and_error(np.log(f[inside]), logs[inside])
    rest = logs - slope * np.log(f)
    steep = np.abs(np.fft.fftfreq(48, 0.5))[:, None] > f / np.sqrt(2)  # nearer z than x
    along_x = rest[inside & ~steep]
    along_z = rest[inside & steep]
    error = np.sqrt(np.pi**2 / 6 / 200 * (1 / along_x.size + 1 / along_z.size))
    assert abs(along_x.mean() - along_z.mean()) < 4 * error


@pytest.mark.parametrize("shape", [ROW, GRID])
def test_cut_offs(shape):
    f, logs = log_spectrum(Roughness(1.0, 0.8, shortest=2.0, longest=16.0), shape)
    beyond = f > (1 + 1e-6) / 2.0
    rolled_off = f < (1 - 1e-6) / 16.0
    between = ~beyond & ~rolled_off
    assert logs[beyond].max() < logs[between].min() - 40.0  # nothing but rounding
    slope, error = slope_and_error(np.log(f[rolled_off]), logs[rolled_off])
    assert abs(slope) < 4 * error
    steep, error = slope_and_error(np.log(f[between]), logs[between])
    assert steep == pytest.approx(-1.6 - (1 if shape == ROW else 2), abs=4 * error)


def test_the_shortest_wavelength_is_that_of_the_coarser_spacing():
    """Two points of a wave along the axis with the larger spacing, so that all are isotropic."""
    assert Roughness(0.1, hurst=0.8).cut_offs((8, 8), (1.0, 2.0))[0] == 4.0


def spectral_integral(power, hurst, dimensions, q_long, q_short):
    """Integral of q^(D - 1 + power) C(q) / C(q_long) over the wave numbers q = |q|."""
    below = dimensions + power
    above = power - 2.0 * hurst
    flat = q_long**below / below
    return flat + q_long ** (dimensions + 2.0 * hurst) * (q_short**above - q_long**above) / above


def periodogram(heights, spacing):
    """|q| and |h_q|^2 of all waves, whose expectation is C(q)."""
    q = np.hypot(*np.meshgrid(*(2 * np.pi * np.fft.fftfreq(n, spacing) for n in heights.shape)))
    cell = np.prod([spacing for n in heights.shape if n > 1])
    return q.T, np.abs(np.fft.fft2(heights)) ** 2 * cell / heights.size


@pytest.mark.parametrize("hurst", [0.3, 0.8])
@pytest.mark.parametrize(("shape", "dimensions"), [((8192, 1), 1), ((192, 192), 2)])
def test_power_spectrum_and_rms_slope_have_their_closed_forms(hurst, shape, dimensions):
    """rms^2 is the integral of C, and the square of the slope that of q^2 C.

    A mean of 30 draws; 1 % is the sums over discrete waves against integrals.
    """
    spacing = 0.5
    rms = 0.3
    draws = 30
    q_short = 2 * np.pi / (8 * spacing)
    q_long = 2 * np.pi / (24 * spacing)
    integral = [spectral_integral(p, hurst, dimensions, q_long, q_short) for p in (0, 2)]
    roughness = Roughness(rms, hurst, 8 * spacing, 24 * spacing)
    rng = np.random.default_rng(4)
    spacings = (spacing, spacing if dimensions == 2 else 0.0)
    power = slopes = 0.0
    for _ in range(draws):
        heights = draw(roughness, shape, spacings, rng).reshape(shape[::-1])
        q, one = periodogram(heights, spacing)
        power = power + one / draws
        slopes = slopes + np.sum(q**2 * one) / draws
    # The slope's mean square is the sum over waves of q^2 C, over the area.
    area = heights.size * spacing**dimensions
    assert slopes / area == pytest.approx(rms**2 * integral[1] / integral[0], rel=0.015)
    constant = rms**2 * (2 * np.pi) ** dimensions / (2.0, 2 * np.pi)[dimensions - 1] / integral[0]
    expected = constant * np.maximum(q / q_long, 1.0) ** (-dimensions - 2.0 * hurst)
    for lower, upper in ((0.0, 1.0), (1.0, 1.7), (1.7, 3.0)):
        band = (q > lower * q_long) & (q < upper * q_long * 0.999)
        ratio = power[band] / expected[band]
        # Real heights: half of the waves are independent, each with an exponential periodogram.
        error = np.sqrt(2.0 / draws / ratio.size)
        assert ratio.mean() == pytest.approx(1.0, abs=4 * error + 0.01)


@pytest.mark.parametrize("hurst", [0.3, 0.8])
def test_the_fields_library_measures_the_same(hurst):
    """Its r.m.s. height, and its r.m.s. gradient, by differences, of well-resolved waves."""
    library = pytest.importorskip("SurfaceTopography")
    shortest = 24.0
    longest = 72.0
    roughness = Roughness(0.3, hurst, shortest, longest, seed=1)
    heights = draw(roughness, (768, 768), (1.0, 1.0), np.random.default_rng()).reshape(768, 768)
    scan = library.Topography(heights, (768.0, 768.0), periodic=True)
    assert scan.rms_height_from_area() == pytest.approx(0.3, rel=1e-12, abs=0.0)
    q = [2 * np.pi / longest, 2 * np.pi / shortest]
    slope = np.sqrt(spectral_integral(2, hurst, 2, *q) / spectral_integral(0, hurst, 2, *q))
    assert scan.rms_gradient() == pytest.approx(0.3 * slope, rel=0.03)


def test_uncorrelated_heights_have_a_flat_spectrum_and_need_no_spacing():
    f, logs = log_spectrum(Roughness(1.0), GRID)
    slope, error = slope_and_error(np.log(f), logs)
    assert abs(slope) < 4 * error
    assert draw(Roughness(1.0), (5, 4), (0.0, 0.0), np.random.default_rng(0)).shape == (20,)


@pytest.mark.parametrize("hurst", [None, 0.8])
@pytest.mark.parametrize("shape", [(7, 1), (1, 8), (9, 5), (2, 64)])
@pytest.mark.parametrize("rms", [1e-12, 0.3, 1e6])
def test_mean_zero_and_exact_rms(hurst, shape, rms):
    heights = draw(Roughness(rms, hurst), shape, SPACING, np.random.default_rng(5))
    assert heights.shape == (shape[0] * shape[1],)
    assert abs(heights.mean()) < 1e-14 * rms
    assert np.sqrt(np.mean(heights**2)) == pytest.approx(rms, rel=1e-14, abs=0.0)


def test_heights_scale_with_the_unit_of_length():
    small = draw(Roughness(0.1, 0.6, 1.0, 8.0, seed=2), GRID, (0.5, 0.5), np.random.default_rng())
    large = draw(Roughness(0.4, 0.6, 4.0, 32.0, seed=2), GRID, (2.0, 2.0), np.random.default_rng())
    np.testing.assert_allclose(4.0 * small, large, atol=1e-14)


def test_x_runs_fastest():
    """Neighbours in the array are neighbours along x: closer together than along z."""
    heights = draw(Roughness(1.0, 0.9, seed=4), (64, 8), (0.1, 1.0), np.random.default_rng())
    grid = heights.reshape(8, 64)
    assert np.std(np.diff(grid, axis=1)) < 0.5 * np.std(np.diff(grid, axis=0))


@pytest.mark.parametrize("hurst", [None, 0.5])
def test_seeds(hurst):
    def heights(own, passed):
        return draw(Roughness(1.0, hurst, seed=own), GRID, SPACING, np.random.default_rng(passed))

    np.testing.assert_array_equal(heights(None, 1), heights(None, 1))
    np.testing.assert_array_equal(heights(7, 1), heights(7, 2))
    assert np.abs(heights(None, 1) - heights(None, 2)).max() > 0.1
    assert np.abs(heights(7, 1) - heights(8, 1)).max() > 0.1


def test_a_hundred_thousand():
    heights = draw(Roughness(0.2, 0.8), (400, 250), (1.0, 1.0), np.random.default_rng(0))
    assert heights.size == 100_000
    assert np.all(np.isfinite(heights))


def test_tables_there_and_back():
    table = {"rms": 0.1, "hurst": 0.8, "shortest": 2.0, "longest": 20.0, "seed": 3}
    assert table_of(from_table(Roughness, table)) == table
    assert table_of(from_table(Roughness, {"rms": 1})) == {"rms": 1.0}
    roughness = Roughness(0.1)
    assert from_table(Roughness, roughness) is roughness


def test_heights_of_a_surface():
    assert as_heights(None, Grid((2, 1), (1.0, 0.0), 1.0)) is None
    np.testing.assert_array_equal(as_heights([1, 2], Grid((2, 1), (1.0, 0.0), 1.0)), [1.0, 2.0])
    assert as_heights({"rms": 0.1}, Grid((2, 1), (0.0, 0.0), 1.0)) == Roughness(0.1)
    with pytest.raises(InputError, match=r"^heights: must be 2 numbers \[length\], got 3$"):
        as_heights([1, 2, 3], Grid((2, 1), (1.0, 0.0), 1.0))
    with pytest.raises(InputError, match=r"^heights\.hurst: must be between 0 and 1"):
        as_heights({"rms": 0.1, "hurst": 1.0}, Grid((9, 1), (1.0, 0.0), 1.0))
    with pytest.raises(InputError, match=r"^heights\.hurst: needs a spacing"):
        as_heights(Roughness(0.1, 0.5), Grid((9, 1), (0.0, 0.0), 1.0))


@pytest.mark.parametrize(
    ("table", "field"),
    [
        ({}, "rms"),
        ({"rms": -1.0}, "rms"),
        ({"rms": "rough"}, "rms"),
        ({"rms": float("nan")}, "rms"),
        ({"rms": 1.0, "hurst": 0.0}, "hurst"),
        ({"rms": 1.0, "hurst": 1.5}, "hurst"),
        ({"rms": 1.0, "shortest": 2.0}, "shortest"),
        ({"rms": 1.0, "longest": 2.0}, "longest"),
        ({"rms": 1.0, "hurst": 0.5, "shortest": 0.0}, "shortest"),
        ({"rms": 1.0, "hurst": 0.5, "longest": -1.0}, "longest"),
        ({"rms": 1.0, "seed": -1}, "seed"),
        ({"rms": 1.0, "seed": 1.5}, "seed"),
        ({"rms": 1.0, "hirst": 0.5}, "hirst"),
        ([1.0], ""),
    ],
)
def test_tables_that_make_no_sense(table, field):
    with pytest.raises(InputError) as caught:
        from_table(Roughness, table, ["rms"])
    assert caught.value.field == field


@pytest.mark.parametrize(
    ("roughness", "shape", "spacing", "field"),
    [
        (Roughness(1.0), (1, 1), (0.0, 0.0), "rms"),
        (Roughness(1.0, 0.5), (1, 1), (1.0, 1.0), "rms"),
        (Roughness(0.0, 0.5), (1, 1), (1.0, 1.0), "hurst"),
        (Roughness(1.0, 0.5), (8, 8), (1.0, 0.0), "hurst"),
        (Roughness(1.0, 0.5), (2, 1), (1.0, 0.0), "hurst"),  # shortest = longest = 2
        (Roughness(1.0, 0.5, shortest=1.0), (8, 1), (1.0, 0.0), "shortest"),
        (Roughness(1.0, 0.5, longest=9.0), (8, 1), (1.0, 0.0), "longest"),
        (Roughness(1.0, 0.5, longest=2.0), (8, 1), (1.0, 0.0), "longest"),
        (Roughness(1.0, 0.5, shortest=8.0), (8, 1), (1.0, 0.0), "shortest"),
        (Roughness(1.0, 0.5, shortest=5.0, longest=4.0), (8, 1), (1.0, 0.0), "longest"),
    ],
)
def test_roughness_that_a_surface_cannot_have(roughness, shape, spacing, field):
    with pytest.raises(InputError) as caught:
        draw(roughness, shape, spacing, np.random.default_rng(0))
    assert caught.value.field == field


def test_one_flat_asperite():
    assert draw(Roughness(0.0), (1, 1), (0.0, 0.0), np.random.default_rng(0)).tolist() == [0.0]
