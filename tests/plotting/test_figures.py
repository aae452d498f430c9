"""The drawings hold what the runs computed, and land where they are told to."""

from dataclasses import replace

import numpy as np
import pytest

import tribo
from tribo import paper, plotting
from tribo.paper import figures as paper_figures
from tribo.plotting.geometry import contact_force, poses
from tribo.validation import InputError


@pytest.fixture(scope="module")
def result():
    scene = replace(paper.scene("A"), output=tribo.Output(samples=401))
    return tribo.simulate(scene, accuracy=1e-6)


@pytest.fixture
def ax():
    return plotting.axes(plotting.COLUMN, 2.0)


def test_case_a_is_drawn(tmp_path):
    folder = tmp_path / "new" / "figures"
    written = paper_figures.draw(folder, ["A"])
    names = ["fig01_model", "fig02_A_angle", "fig03_A_snapshots", "fig04_A_work"]
    names.append("fig05_A_sequence")
    assert written == [folder / f"{name}{end}" for name in names for end in (".pdf", ".png")]
    for path in written:
        start = b"%PDF" if path.suffix == ".pdf" else b"\x89PNG"
        assert path.read_bytes().startswith(start)
        assert path.stat().st_size > 5000


def test_every_case_has_its_figures():
    assert {figure.case for figure in paper_figures.FIGURES} == {"", *paper.CASES}
    assert len({figure.name for figure in paper_figures.FIGURES}) == 11


@pytest.mark.parametrize("end", ["", "below"])
def test_a_file_is_no_folder(tmp_path, end):
    (tmp_path / "file").write_text("taken")
    with pytest.raises(InputError, match="--figures") as caught:
        paper_figures.draw(tmp_path / "file" / end, ["A"])
    assert caught.value.field == "--figures"
    assert (tmp_path / "file").read_text() == "taken"


@pytest.mark.parametrize("surface", ["upper", "lower"])
def test_an_asperite_is_drawn_where_it_is(result, ax, surface):
    k = 232
    (pose,) = poses(result, result.t[k])[surface]
    parts = plotting.draw_asperite(ax, pose)
    series = result[surface]
    for name, place in (("bob", "bob"), ("cm", "cm"), ("pivot", "bar")):
        expected = [series[f"{axis}_{place}"][k, 0] for axis in "xy"]
        assert parts[name].center == pytest.approx(expected, abs=1e-12)
    rod = parts["rod"].get_corners().mean(axis=0)
    assert rod == pytest.approx((pose.bob + pose.bar) / 2)
    assert parts["bar"].get_corners().mean(axis=0) == pytest.approx(pose.bar)


def test_between_samples_the_motion_is_followed(result):
    coarse = tribo.simulate(replace(paper.scene("A"), output=tribo.Output(samples=101)), 1e-6)
    (exact,) = poses(result, 22.1)["upper"]
    (followed,) = poses(coarse, 22.1)["upper"]
    assert followed.bob == pytest.approx(exact.bob, abs=1e-3)
    with pytest.raises(InputError, match="t: must be from 0 to 40"):
        poses(result, 41.0)


def test_pseudowork_is_dashed(result, ax):
    lines = plotting.work_curves(ax, result, "upper")
    assert list(lines) == ["w1", "w2", "wL", "wR", "w", "w1_ps", "w2_ps"]
    for name, line in lines.items():
        assert np.array_equal(line.get_xdata(), result.t)
        assert np.array_equal(line.get_ydata(), result["upper"][name][:, 0])
        assert line.is_dashed() == name.endswith("_ps")


def test_the_force_is_the_slope_of_the_potential(result):
    there = poses(result, 20.0)
    away = there["upper"][0].bob - there["lower"][0].bob
    force = contact_force(result, there, "upper", 0)
    assert force == pytest.approx(0.2 * away / np.hypot(*away) ** 3)
    assert contact_force(result, there, "lower", 0) == pytest.approx(-force)


def test_a_sequence_measures_displacements(result):
    ax = plotting.axes(plotting.COLUMN)
    plotting.sequence(ax, result, (15.0, 23.2, 26.0))
    arrows = [a for a in ax.texts if a.arrow_patch and a.xy[1] == a.xyann[1]]
    moved = [a.xy[0] - a.xyann[0] for a in arrows]
    assert moved == pytest.approx([4.4844, 4.1, 3.3314, 0.6653, 1.4, 2.8694], abs=6e-3)


def test_labels_keep_their_distance_and_their_order():
    places = np.array([0.5, 0.51, 0.5, 0.99, 1.0, 0.1])
    apart = plotting.spread(places, 0.1)
    assert np.all(np.diff(np.sort(apart)) >= 0.1 - 1e-12)
    assert np.array_equal(np.argsort(apart), np.argsort(places, kind="stable"))
    assert apart[5] == pytest.approx(0.1)
    assert apart.max() <= 1.0 + 1e-12
