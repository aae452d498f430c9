"""Heights from a scan: resampled, in the scene's unit, without its tilt; files; what is refused."""

import codecs
import shutil
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

import tribo
from support.synthetic_scan import FILE, PIXEL, POINTS, TILT, scan_heights
from tribo import InputError, Scene, Surface, Topography
from tribo.model import topography
from tribo.model.identity import plain_table

EXAMPLE = FILE.with_name("measured_surface.toml")


@dataclass(frozen=True)
class Scan:
    """What tribo uses of SurfaceTopography's maps and line scans; only the mean is a trend."""

    values: np.ndarray
    pixel: float = 1.0
    unit: str | None = None
    has_undefined_data: bool = False

    @property
    def dim(self):
        return self.values.ndim

    def detrend(self, mode):
        assert mode in ("center", "height")
        return replace(self, values=self.values - self.values.mean())

    def positions_and_heights(self):
        places = (self.pixel * np.arange(n) for n in self.values.shape)
        return *np.meshgrid(*places, indexing="ij"), self.values


X, Y = np.meshgrid(np.arange(7.0), np.arange(5.0), indexing="ij")
MAP = Scan(X**2 - 10.0 * Y)  # 7 by 5 points


def heights(scan=MAP, shape=(7, 5), spacing=(1.0, 1.0), facing="up", **settings):
    """The heights of a surface, (nz, nx)."""
    settings = {"detrend": "none"} | settings
    surface = Surface(
        "s", facing, shape=shape, spacing=spacing, heights=Topography(scan, **settings)
    )
    return surface.drawn_heights(0).reshape(shape[::-1])


def test_the_grid_of_the_scan_has_its_heights():
    """x of the scan is x, y is z; x runs fastest; peaks point toward the other surface."""
    np.testing.assert_array_equal(heights(), MAP.values.T)
    np.testing.assert_array_equal(heights(facing="down"), -MAP.values.T)
    np.testing.assert_array_equal(heights(spacing=(-1.0, 1.0)), MAP.values[::-1].T)
    given = Surface("s", "up", shape=(7, 5), spacing=(1.0, 1.0), heights=MAP).heights
    np.testing.assert_array_equal(given, (MAP.values - MAP.values.mean()).T.ravel())


def test_other_grids_are_interpolated_linearly():
    finer = heights(shape=(13, 9), spacing=(0.5, 0.5))
    np.testing.assert_array_equal(finer[::2, ::2], MAP.values.T)
    np.testing.assert_allclose(finer[1::2], 0.5 * (finer[:-1:2] + finer[2::2]), rtol=1e-14)
    np.testing.assert_allclose(finer[:, 1::2], 0.5 * (finer[:, :-1:2] + finer[:, 2::2]), rtol=1e-14)
    part = heights(shape=(2, 2), spacing=(2.0, 1.0), origin=(1.0, 3.0))
    np.testing.assert_array_equal(part, MAP.values[1:4:2, 3:5].T)


@pytest.mark.parametrize("shape", [(7, 1), (1, 7)])
def test_a_line_scan_on_a_row(shape):
    line = Scan(np.arange(7.0) ** 2)
    spacing = (1.0, 0.0) if shape[0] > 1 else (0.0, 1.0)
    np.testing.assert_array_equal(heights(line, shape, spacing).ravel(), line.values)


def test_units():
    """A scan in micrometres on a surface whose lengths are in nanometres, or in 2 nm."""
    scan = replace(MAP, unit="um", pixel=1e-3, values=1e-3 * MAP.values)
    np.testing.assert_allclose(heights(scan, unit="nm"), MAP.values.T, rtol=1e-12)
    half = heights(scan, unit=2e-9, spacing=(0.5, 0.5))
    np.testing.assert_allclose(half, 0.5 * MAP.values.T, rtol=1e-12)


@pytest.mark.parametrize(
    ("message", "settings"),
    [
        ("unit: is missing; the scan is in um", {"scan": replace(MAP, unit="um")}),
        ("unit: has no meaning for a scan without a unit", {"unit": "nm"}),
        ('unit: must be "m" or "mm" or', {"unit": "inch"}),
        ('topography: must have a unit of length, got "V"', {"scan": replace(MAP, unit="V")}),
        ("origin: is missing: the surface is smaller than the scan along x", {"shape": (6, 5)}),
        ("origin: is missing: .* along z", {"shape": (7, 1)}),
        ("topography: must cover the surface along x: .* from 0 to 7", {"shape": (8, 5)}),
        ("topography: must cover the surface along z: .* from 1 to 5", {"origin": (0.0, 1.0)}),
        ("topography: must cover the surface along x", {"origin": (-1.0, 0.0)}),
        ("topography: needs a spacing along every direction", {"spacing": (1.0, 0.0)}),
        ("topography: is a line scan; the surface must be a row", {"scan": Scan(np.zeros(9))}),
        ("topography: must have finite heights", {"scan": Scan(np.full((7, 5), np.nan))}),
        ("topography: must have two or more points", {"scan": Scan(np.zeros((7, 1)))}),
        ("topography: must have positions that increase", {"scan": Scan(MAP.values, -1.0)}),
        ('detrend: must be "plane" or "mean"', {"detrend": "tilt"}),
        ("topography: must be a file or a topography, got 3", {"scan": 3}),
    ],
)
def test_what_is_refused(message, settings):
    with pytest.raises(InputError, match=rf"^(heights\.)?{message}"):
        heights(**settings)


def test_files_that_cannot_be_read(tmp_path, monkeypatch):
    with pytest.raises(InputError, match=r"topography: .*nothing\.x3p cannot be read \(no such"):
        heights(tmp_path / "nothing.x3p")
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)
    with pytest.raises(
        InputError, match=r"topography: needs .* install '.\[topography\]' in the checkout$"
    ):
        heights(FILE)
    with pytest.raises(InputError, match=r"^surface\[0\]\.heights\.topography: needs Surface"):
        tribo.load_scene(EXAMPLE)


def scene_of(path):
    """A measured row over a flat one."""
    row = {"shape": (7, 1), "spacing": (1.0, 0.0)}
    upper = Surface("upper", bob=(0.0, 9.0), **row, heights=Topography(path, detrend="mean"))
    return Scene([upper, Surface("lower", "up", **row)], tribo.Coulomb(0.2), 0.1)


@pytest.fixture
def read(monkeypatch):
    """The paths of all files that were read, each a parabola."""
    paths = []
    monkeypatch.setattr(topography, "_read", lambda p: paths.append(p) or Scan(np.arange(7.0) ** 2))
    return paths


def test_a_scene_file_names_the_scan(tmp_path, monkeypatch, read):
    """Relative to its own folder, wherever the reader is; another grid reads it again."""
    scene = scene_of(tmp_path / "scans" / "line.x3p")
    scene.save(tmp_path / "scene.toml")
    assert 'topography = "scans/line.x3p"' in (tmp_path / "scene.toml").read_text()
    monkeypatch.chdir("/")
    assert tribo.load_scene(tmp_path / "scene.toml") == scene
    assert read == [str(tmp_path / "scans" / "line.x3p")] * 2
    replace(scene.surfaces[0], name="another")
    assert len(read) == 2
    coarse = replace(scene.surfaces[0], shape=(4, 1), spacing=(2.0, 0.0))
    np.testing.assert_array_equal(coarse.heights.heights, scene.surfaces[0].heights.heights[::2])


def test_a_result_keeps_the_heights(tmp_path, monkeypatch, read):
    scene = tribo.paper.scene("A")
    upper = replace(scene.surfaces[0], heights=Topography("line.x3p", origin=(2.0, 0.0)))
    scene = replace(scene, surfaces=(upper, scene.surfaces[1]), duration=0.1)
    tribo.simulate(scene).save(tmp_path / "result.nc")
    monkeypatch.setattr(topography, "_read", None)
    kept = tribo.load_result(tmp_path / "result.nc").scene.surfaces[0]
    np.testing.assert_array_equal(kept.heights, 13.0 - 2.0**2)


def test_the_scan_that_ships():
    """The file has the heights that the script gives it, and loses its tilt."""
    read_topography = pytest.importorskip("SurfaceTopography").read_topography
    whole = {"shape": POINTS, "spacing": (PIXEL, PIXEL), "unit": "nm"}
    np.testing.assert_allclose(heights(FILE, **whole), scan_heights().T, atol=1e-12)
    level = heights(FILE, **whole, detrend="plane")
    for slope, axis in zip(TILT, (1, 0), strict=True):
        steps = np.diff(heights(FILE, **whole) - level, axis=axis)
        np.testing.assert_allclose(steps, steps[0, 0], atol=1e-12)
        assert steps[0, 0] / PIXEL == pytest.approx(slope, abs=0.03)
    assert np.sqrt(np.mean(level**2)) < 0.35 < np.sqrt(np.mean(scan_heights() ** 2))
    scan = read_topography(str(FILE))
    np.testing.assert_array_equal(heights(scan, **whole), heights(FILE, **whole))


def test_undefined_points_are_filled_in():
    library = pytest.importorskip("SurfaceTopography")
    hole = (X == 3.0) & (Y == 2.0)
    scan = library.Topography(np.ma.masked_array(np.where(hole, 99.0, X), hole), (7.0, 5.0))
    assert heights(scan)[2, 3] == pytest.approx(3.0, abs=1e-9)


def test_undefined_points_are_counted(tmp_path):
    """Also those of arrays that are not finite; a scan without a height has none to interpolate."""
    pytest.importorskip("SurfaceTopography")
    values = X.copy()
    values[3, 2] = np.inf
    values[5, 4] = np.nan
    np.save(tmp_path / "holes.npy", values)
    np.save(tmp_path / "empty.npy", np.full((7, 5), np.nan))
    scan = Topography(tmp_path / "holes.npy", size=(7.0, 5.0), detrend="none")
    upper = Surface("upper", shape=(7, 5), spacing=(1.0, 1.0), bob=(0.0, 12.0), heights=scan)
    np.testing.assert_allclose(-upper.drawn_heights(0).reshape(5, 7).T, X, atol=1e-9)
    scene = Scene((upper, Surface("lower", facing="up")), tribo.Coulomb(0.1), 0.1)
    notes = tribo.simulate(scene, method="verlet", step=0.1).notes
    assert any('2 of 35 points of the scan of "upper" have no height' in note for note in notes)
    with pytest.raises(InputError, match="no point of the scan has one"):
        heights(tmp_path / "empty.npy", size=(7.0, 5.0))


def test_points_that_are_no_grid_are_no_matrix(tmp_path):
    """A list of places without some of them would be read as three columns of heights."""
    pytest.importorskip("SurfaceTopography")
    rows = np.stack([X.ravel(), Y.ravel(), (X**2).ravel()], axis=1)
    np.savetxt(tmp_path / "holes.xyz", np.delete(rows, [8, 20], axis=0))
    with pytest.raises(InputError, match="33 of 7 x 5 points; give those that are missing"):
        heights(tmp_path / "holes.xyz", size=(7.0, 5.0))
    scattered = np.random.default_rng(0).uniform(0.0, 6.0, (200, 3))
    np.savetxt(tmp_path / "twice.xyz", np.append(rows, rows[:5], axis=0))
    np.savetxt(tmp_path / "scattered.xyz", scattered)
    for name in ("twice.xyz", "scattered.xyz", "holes.xyz"):
        for size in (None, (7.0, 5.0)):  # that a size is missing would be misleading
            with pytest.raises(InputError, match="has three columns"):
                heights(tmp_path / name, size=size)
    rows[[8, 20], 2] = np.nan
    np.savetxt(tmp_path / "whole.xyz", rows)
    np.testing.assert_allclose(heights(tmp_path / "whole.xyz").T, X**2, atol=1.0)


def test_heights_far_from_all_others_are_noted(tmp_path):
    """Instruments write -9999 where they measure nothing."""
    pytest.importorskip("SurfaceTopography")
    values = np.random.default_rng(1).normal(size=X.shape)
    notes = []
    for name, lost in (("scan.npy", []), ("marked.npy", [3, 8])):
        values.flat[lost] = -9999.0
        np.save(tmp_path / name, values)
        scan = Topography(tmp_path / name, size=(7.0, 5.0), detrend="none")
        grid = {"shape": (7, 5), "spacing": (1.0, 1.0)}
        scene = Scene([Surface("upper", **grid, heights=scan)], (), 0.1)
        found = tribo.simulate(scene, method="verlet", step=0.05).notes
        notes.append([note for note in found if "far from all others" in note])
    # An ensemble has the note of a run, though its members have heights alone.
    for kept in ({"keep": ["upper.W"]}, {}):
        members = tribo.ensemble(
            scene, 2, {"upper.theta": [0.1, 0.2]}, method="verlet", step=0.05, **kept
        )
        assert "far from all others" in str(members.attrs["notes"])
    peak = np.exp(-((X - 3.0) ** 2) - (Y - 2.0) ** 2)
    np.save(tmp_path / "peak.npy", peak)
    scan = Topography(tmp_path / "peak.npy", size=(7.0, 5.0), detrend="none")
    assert Surface("upper", **grid, heights=scan).scan.outliers == 0
    assert notes[0] == []
    assert notes[1] == [
        '2 of 35 points of the scan of "upper" have heights far from all others; give nan where '
        "there is none"
    ]


def test_a_low_point_of_a_plateau_is_far_from_all_others():
    """Instruments may write 0 where they measure nothing; heights count from their median."""
    values = 1000.0 + np.random.default_rng(0).uniform(-1.0, 1.0, (20, 20))
    values[3, 4] = 0.0
    assert topography._outliers(Scan(values)) == 1


def test_a_matrix_as_text_is_turned(tmp_path):
    """Each of its lines runs along x; of an array the first index is that of x."""
    pytest.importorskip("SurfaceTopography")
    values = X + 10.0 * Y
    np.save(tmp_path / "scan.npy", values)
    np.savetxt(tmp_path / "scan.txt", values.T)
    for name in ("scan.npy", "scan.txt"):
        np.testing.assert_allclose(heights(tmp_path / name, size=(7.0, 5.0)), values.T)
    with pytest.raises(InputError, match=r"got an array; SurfaceTopography makes one of it"):
        Topography(values)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("nothing", r"scan\.txt cannot be read: it has no format that SurfaceTopography knows; "),
        ("1,2.5,3,4\n" * 4, "blanks between numbers, got commas between numbers; write blanks"),
        ("1,2,3,4\n" * 4, "got commas between numbers; write blanks"),
        ("1;2;3;4\n" * 4, "got semicolons between numbers; write blanks"),
        ("1,5 2,5 3\n" * 4, "got a decimal comma in the line '1,5 2,5 3'; write 0.5 for 0,5"),
        ("1 2 3 4\n" * 4, r"scan\.txt cannot be read \(.*sizes.*\); in Python, give the object"),
    ],
)
def test_files_without_a_scan_or_its_size(text, message, tmp_path):
    pytest.importorskip("SurfaceTopography")
    (tmp_path / "scan.txt").write_text(text)
    with pytest.raises(InputError, match=rf"^heights\.topography: .*{message}"):
        heights(tmp_path / "scan.txt")


def test_the_example(tmp_path):
    """In its folder and in another, and what a result keeps of it."""
    pytest.importorskip("SurfaceTopography")
    for path in (FILE, EXAMPLE):
        shutil.copy(path, tmp_path)
    scene = tribo.load_scene(tmp_path / EXAMPLE.name)
    kept = plain_table(scene)["surface"][0]["heights"]
    assert np.ptp(kept) > 1.0
    assert Path(scene.surfaces[0].heights.topography) == tmp_path / FILE.name


def wave(n=16):
    """A period of a sine along x, sampled at n points."""
    library = pytest.importorskip("SurfaceTopography")
    heights = np.sin(2.0 * np.pi * np.arange(n) / n)
    return library.UniformLineScan(heights, (float(n),), periodic=True), heights


def notes_of(given):
    """The notes of a run with these heights in a periodic box of 16."""
    row = {"shape": (16, 1), "spacing": (1.0, 0.0)}
    upper = Surface("upper", bob=(0.0, 9.0), **row, heights=given)
    potential = tribo.Coulomb(0.2).with_cutoff(4.0)
    scene = Scene([upper, Surface("lower", "up", **row)], potential, 0.1, periodic={"x": 16.0})
    return [
        note for note in tribo.simulate(scene, method="verlet", step=0.05).notes if "seam" in note
    ]


def test_periodic_scans_keep_their_ends_together():
    """The mean is subtracted by default, no plane; another surface's step at the seam is noted."""
    scan, expected = wave()
    surface = Surface("s", "up", shape=(16, 1), spacing=(1.0, 0.0), heights=scan)
    np.testing.assert_allclose(surface.drawn_heights(0), expected, atol=1e-12)
    assert notes_of(scan) == notes_of(expected) == []
    for given in (Topography(scan, detrend="plane"), np.linspace(0.0, 1.0, 16)):
        (note,) = notes_of(given)
        assert 'heights of "upper" have a seam where the scene repeats along x' in note
    assert "differ by 1 there and by 0.0667 elsewhere" in note


def test_undefined_points_of_unequal_steps_are_filled_in():
    library = pytest.importorskip("SurfaceTopography")
    x = np.array([0.0, 1.0, 2.5, 3.0, 5.0, 6.0])
    scan = library.NonuniformLineScan(x, np.where((x == 2.5) | (x == 6.0), np.nan, 2.0 * x))
    found = heights(scan, (7, 1), (1.0, 0.0)).ravel()
    np.testing.assert_allclose(found, [0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 10.0], atol=1e-12)


def test_sizes_are_one_for_each_axis(tmp_path):
    """Of grids, as text and as numpy keeps them, and of line scans."""
    pytest.importorskip("SurfaceTopography")
    grid = np.random.default_rng(0).normal(size=(5, 4))
    np.savetxt(tmp_path / "grid.txt", grid)
    np.save(tmp_path / "grid.npy", grid)
    np.savetxt(tmp_path / "line.txt", np.column_stack([np.arange(5.0), grid[:, 0]]))
    for name, size, wanted in (
        ("grid.txt", 2.5, r"size: must be two lengths, \[x, z\], of a grid, got 2.5"),
        ("grid.npy", 2.5, r"size: must be two lengths"),
        ("line.txt", (2.5, 8.0), r"size: must be one length, of a line scan"),
    ):
        with pytest.raises(InputError, match=wanted):
            heights(tmp_path / name, (5, 4), (0.5, 2.0), size=size)


def test_channels_and_sizes_of_files(tmp_path):
    """A matrix has no size, which a key gives; a channel has a name and a number."""
    pytest.importorskip("SurfaceTopography")
    path = tmp_path / "scan.txt"
    np.savetxt(path, np.arange(20.0).reshape(4, 5))
    found = heights(path, (5, 4), (0.5, 2.0), size=(2.5, 8.0))
    assert np.ptp(found) == 19.0
    marked = tmp_path / "marked.txt"  # as programs of Windows write it
    marked.write_bytes(codecs.BOM_UTF8 + path.read_bytes())
    np.testing.assert_array_equal(heights(marked, (5, 4), (0.5, 2.0), size=(2.5, 8.0)), found)
    (name,) = (channel.name for channel in opened_channels(path))
    for channel in (0, name):
        again = heights(path, (5, 4), (0.5, 2.0), size=(2.5, 8.0), channel=channel)
        np.testing.assert_array_equal(again, found)
    with pytest.raises(InputError, match=rf'channel: must be one of "{name}", or a number below 1'):
        heights(path, size=(2.5, 8.0), channel="other")
    with pytest.raises(InputError, match="size: must be left out: the file states the size"):
        heights(FILE, unit="nm", size=(1.0, 1.0))
    with pytest.raises(InputError, match="size: needs a file as the topography"):
        heights(MAP, size=(1.0, 1.0))


def opened_channels(path):
    import SurfaceTopography

    with SurfaceTopography.open_topography(str(path)) as reader:
        return reader.channels
