"""Heights from scans: places, units, trends and what is refused; roughness as scans measure it."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import tribo
from tribo import InputError, Roughness, Surface
from tribo.model.roughness import draw

SCAN = Path(__file__).parents[2] / "examples" / "scan.x3p"


@dataclass
class Scan:
    """What tribo uses of a topography: the heights of a function at pixels."""

    physical_sizes: tuple = (4.0, 3.0)
    pixels: tuple = (81, 61)
    unit: str | None = "um"
    is_periodic: bool = False
    is_uniform: bool = True
    height: object = lambda x, z: 0.1 * x + 0.2 * z * x
    factor: float = 1.0

    def heights(self):
        axes = [np.arange(n) * s / n for n, s in zip(self.pixels, self.physical_sizes, strict=True)]
        return self.factor * self.height(*np.meshgrid(*axes, indexing="ij"))

    def to_unit(self, unit):
        factor = {"um": 1.0, "nm": 1000.0}[unit]
        sizes = tuple(factor * size for size in self.physical_sizes)
        return Scaled(self, factor, sizes)


class Scaled(Scan):
    def __init__(self, scan, factor, sizes):
        super().__init__(sizes, scan.pixels, "nm", scan.is_periodic)
        self._scan, self._factor = scan, factor

    def heights(self):
        return self._factor * self._scan.heights()


def surface(heights, **settings):
    settings = {"shape": (4, 3), "spacing": (0.31, 0.43), "bob": (7.0, 5.0)} | settings
    return Surface("lower", facing="up", heights=heights, **settings)


def lattice(origin, spacing=(0.31, 0.43)):
    z, x = np.meshgrid(origin[1] + spacing[1] * np.arange(3), origin[0] + spacing[0] * np.arange(4))
    return x.T.ravel(), z.T.ravel()


def test_places_and_units():
    """A scan linear in each direction is found exactly; x runs fastest."""
    x, z = lattice((0.5, 0.6))
    table = {"topography": Scan(), "detrend": "none", "origin": (0.5, 0.6)}
    assert surface(table).heights == pytest.approx(0.1 * x + 0.2 * x * z, abs=1e-14)
    middle = [80 * 4.0 / 81 / 2 - 1.5 * 0.31, 60 * 3.0 / 61 / 2 - 0.43]
    x, z = lattice(middle)
    centred = surface({"topography": Scan(), "detrend": "none", "scale": -2.0})
    assert centred.heights == pytest.approx(-0.2 * x - 0.4 * x * z, abs=1e-14)
    in_nm = {"topography": Scan(), "detrend": "none", "unit": "nm"}
    finer = surface(in_nm, spacing=(310.0, 430.0))
    assert finer.heights == pytest.approx(1000.0 * (0.1 * x + 0.2 * x * z), abs=1e-11)
    points = np.column_stack([x[::-1], 0.0 * x, z[::-1]])
    listed = Surface("a", positions=points, heights={"topography": Scan(), "detrend": "none"})
    assert listed.heights == pytest.approx(0.1 * x[::-1] + 0.2 * (x * z)[::-1], abs=1e-14)


@pytest.mark.parametrize(
    ("detrend", "trend"),
    [
        ("mean", lambda x, z: 3.0 + 0.0 * x),
        ("plane", lambda x, z: 3.0 + 0.4 * x - 0.7 * z),
        ("curvature", lambda x, z: 1.0 + 0.4 * x - z + 0.3 * x**2 - 0.2 * x * z + 0.1 * z**2),
    ],
)
def test_trends(detrend, trend):
    """A trend of the kind goes, whatever else is there; that of the next kind does not."""
    waves = Scan(height=lambda x, z: 0.01 * np.cos(9.0 * x) * np.cos(7.0 * z))
    both = Scan(height=lambda x, z: waves.height(x, z) + trend(x, z))
    table = {"detrend": detrend}
    found, flat = (surface(table | {"topography": scan}).heights for scan in (both, waves))
    assert found == pytest.approx(flat, abs=1e-12) and np.ptp(found) > 0.01
    cubic = Scan(height=lambda x, z: x**3)
    assert np.ptp(surface(table | {"topography": cubic}).heights) > 0.05
    default = surface(both).heights
    assert (np.max(np.abs(default - flat)) < 0.01) == (detrend != "curvature")


def test_periodic_scans_repeat():
    """Asperites beyond the edge of a periodic scan are in its next image."""
    wave = Scan(
        (2.0, 1.0), (200, 100), is_periodic=True, height=lambda x, z: np.cos(np.pi * (x + 2 * z))
    )
    found = surface({"topography": wave, "detrend": "none", "origin": (1.9, 0.3)}).heights
    x, z = lattice((1.9, 0.3))
    assert found == pytest.approx(np.cos(np.pi * (x + 2 * z)), abs=2e-3)


class Gap(Scan):
    def heights(self):
        return np.ma.masked_greater(super().heights(), 0.5)


@pytest.mark.parametrize(
    ("heights", "settings", "problem"),
    [
        (
            Scan(),
            {"spacing": (2.0, 0.4)},
            "topography: has 3.951 by 2.951 .* span 6 by 0.8;",
        ),
        (Gap(), {}, r"topography: is undefined at \d+ asperites"),
        (Scan(is_uniform=False), {}, "topography: must be on a uniform grid"),
        (
            {"topography": 5},
            {},
            "topography: must be a file, or a topography .* got 5",
        ),
        ({"topography": Scan(), "format": "x3p"}, {}, "format: is that of a file"),
        ({"topography": Scan(unit=None), "unit": "nm"}, {}, "unit: cannot be used"),
        ({"topography": Scan(), "unit": "ell"}, {}, 'unit: must be a unit of length, as "nm"'),
        ({"topography": Scan(), "detrend": "line"}, {}, 'detrend: must be "none" or'),
        ({"topography": Scan(), "origin": (3.9, 0.0)}, {}, "topography: .* unit or origin"),
        ({"topography": Scan(), "rms": 0.1}, {}, "rms: "),
        ({"topography": "no_such.x3p"}, {}, "topography: .*(needs SurfaceTop|cannot be read)"),
    ],
)
def test_refused(heights, settings, problem):
    """One sentence with the key below `heights`."""
    with pytest.raises(InputError, match=r"^heights\." + problem):
        surface(heights, **settings)


def test_a_file_of_an_instrument(tmp_path):
    """The scan that the example ships, in a scene file beside it and as an object."""
    topographies = pytest.importorskip("SurfaceTopography")
    (tmp_path / SCAN.name).write_bytes(SCAN.read_bytes())
    (tmp_path / "scene.toml").write_text(
        'duration = 1.0\n[[surface]]\nname = "lower"\nfacing = "up"\nshape = [8, 8]\n'
        'spacing = [0.4, 0.4]\nheights = {topography = "scan.x3p", unit = "um"}\n'
    )
    (lower,) = tribo.load_scene(tmp_path / "scene.toml").surfaces
    scan = topographies.read_topography(str(SCAN)).to_unit("um")
    same = surface(scan, shape=(8, 8), spacing=(0.4, 0.4))
    assert np.array_equal(lower.heights, same.heights) and np.ptp(lower.heights) > 0.05
    flat = scan.detrend("height")
    again = {"topography": flat, "detrend": "none"}
    assert surface(again, shape=(8, 8), spacing=(0.4, 0.4)).heights == pytest.approx(same.heights)


SHAPE, SPACING = (96, 64), (0.5, 0.25)


def slopes(heights):
    """The mean squares of the slopes between neighbours along x and z, across the edges too."""
    grid = heights.reshape(SHAPE[::-1])
    return [np.mean(((np.roll(grid, -1, a) - grid) / SPACING[1 - a]) ** 2) for a in (1, 0)]


@pytest.mark.parametrize("hurst", [0.3, 0.8])
def test_slopes_of_random_roughness(hurst):
    """Mean squares of slopes are the sums over its spectrum; SurfaceTopography finds the same."""
    roughness = Roughness(0.2, hurst, shortest=2.0, longest=12.0)
    rng = np.random.default_rng(5)
    draws = [draw(roughness, SHAPE, SPACING, rng) for _ in range(60)]
    q = [2.0 * np.pi * np.fft.fftfreq(n, s) for n, s in zip(SHAPE, SPACING, strict=True)]
    qx, qz = np.meshgrid(*q)
    size = np.hypot(qx, qz)
    # C(q) = q^(-2 - 2H) from 2 pi / longest to 2 pi / shortest, constant below.
    spectrum = np.maximum(size, 2.0 * np.pi / 12.0) ** (-2.0 - 2.0 * hurst)
    spectrum[(size > np.pi * (1.0 + 1e-9)) | (size == 0.0)] = 0.0
    for axis, (wave, spacing) in enumerate(zip((qx, qz), SPACING, strict=True)):
        transfer = (2.0 / spacing * np.sin(0.5 * wave * spacing)) ** 2
        expected = 0.2**2 * np.sum(spectrum * transfer) / np.sum(spectrum)
        found = [slopes(heights)[axis] for heights in draws]
        error = np.std(found) / np.sqrt(len(found))
        assert error < 0.03 * expected
        assert np.mean(found) == pytest.approx(expected, abs=4.0 * error)
    try:
        from SurfaceTopography import Topography
    except ImportError:
        return
    sizes = tuple(n * s for n, s in zip(SHAPE, SPACING, strict=True))
    scan = Topography(draws[0].reshape(SHAPE[::-1]).T, sizes, periodic=True)
    assert scan.rms_height_from_area() == pytest.approx(0.2, rel=1e-12)
    assert scan.rms_gradient() ** 2 == pytest.approx(sum(slopes(draws[0])), rel=0.02)
