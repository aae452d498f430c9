"""Figures show the series of the run, and are written where the caller says."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib import rcParams
from matplotlib.figure import Figure

import tribo
from tribo import InputError, paper, plotting
from tribo.paper import figures as paper_figures
from tribo.plotting.picture import Picture
from tribo.plotting.pose import pose
from tribo.plotting.snapshots import encounter_times
from tribo.plotting.style import FILES, NOTE_SIZE, drawing_on
from tribo.plotting.works import spread


@pytest.fixture(scope="module")
def result():
    scene = replace(paper.scene("A"), output=tribo.Output(samples=401))
    return tribo.simulate(scene, accuracy=1e-6)


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
def test_an_asperite_is_drawn_where_it_is(result, surface):
    k = 232
    now = pose(result, result.t[k])
    with drawing_on(None, plotting.COLUMN) as ax:
        _, _, _, bars, rods, bobs, pivots, cms = Picture(ax, now, 0.01).artists
    series = result[surface]
    bob, cm, bar = (
        np.array([series[f"{axis}_{place}"][k, 0] for axis in "xy"])
        for place in ("bob", "cm", "bar")
    )
    for part, centre in (
        *((bobs, bob), (pivots, bar), (cms, cm)),
        *((rods, 0.5 * (bob + bar)), (bars, bar)),
    ):
        outline = part.get_paths()[now.index(surface, 0)].vertices[:-1]
        assert outline.mean(axis=0) == pytest.approx(centre, abs=1e-12)


def test_pseudowork_is_dashed(result):
    *lines, _ = result.plot.work("upper", 0).get_lines()
    names = [line.get_label() for line in lines]
    assert names == ["w1", "w2", "wL", "wR", "w", "w1_ps", "w2_ps"]
    for name, line in zip(names, lines, strict=True):
        assert np.array_equal(line.get_xdata(), result.t)
        assert np.array_equal(line.get_ydata(), result["upper"][name][:, 0])
        assert line.is_dashed() == name.endswith("_ps")


def test_a_sequence_measures_displacements(result):
    ax = result.plot.sequence((15.0, 23.2, 26.0))
    arrows = [a for a in ax.texts if a.arrow_patch and a.xy[1] == a.xyann[1]]
    moved = [a.xy[0] - a.xyann[0] for a in arrows]
    assert moved == pytest.approx([4.4844, 4.1, 3.3314, 0.6653, 1.4, 2.8694], abs=6e-3)


DRAWN = {
    "angles": lambda result, ax: result.plot.angles(ax=ax),
    "phase": lambda result, ax: result.plot.phase(ax=ax),
    "sequence": lambda result, ax: result.plot.sequence((15.0, 26.0), ax=ax),
}


@pytest.mark.parametrize("name", DRAWN)
def test_axes_are_given_or_made(result, name, tmp_path):
    """Axes that are given come back; without any there is a new figure in tribo's style."""
    from matplotlib.figure import Figure

    given = Figure().add_subplot()
    assert DRAWN[name](result, given) is given
    made = DRAWN[name](result, None)
    assert made.figure is not given.figure
    assert made.figure.get_figwidth() == plotting.COLUMN
    path = plotting.save(made, str(tmp_path / f"{name}.pdf"))
    assert path == tmp_path / f"{name}.pdf"
    assert b"STIX" in path.read_bytes()


@pytest.mark.parametrize("suffix", FILES)
def test_a_figure_is_always_the_same_file(result, tmp_path, suffix):
    """Two files of the same result are equal, byte for byte."""
    one, other = (plotting.save(result.plot.angles(), tmp_path / f"{k}{suffix}") for k in range(2))
    assert one.read_bytes() == other.read_bytes()


@pytest.mark.parametrize(
    ("name", "problem"),
    [
        ("figure.txt", "path: must end on .png, .pdf, .svg"),
        ("none/figure.png", "none/figure.png: must be in a folder"),
    ],
)
def test_a_file_that_cannot_be_written(result, tmp_path, name, problem):
    with pytest.raises(InputError, match=problem):
        plotting.save(result.plot.angles(), tmp_path / name)


def test_labels_keep_their_distance_and_their_order():
    levels = np.array([0.5, 0.51, 0.5, 0.99, 1.0, 0.1])
    apart = spread(levels, 0.1)
    assert np.all(np.diff(np.sort(apart)) >= 0.1 - 1e-12)
    assert np.array_equal(np.argsort(apart), np.argsort(levels, kind="stable"))
    assert apart[5] == pytest.approx(0.1)
    assert apart.max() <= 1.0 + 1e-12


def test_axes_show_labels():
    """Axes for graphs show what is set on them, with a given height or without."""
    for ax in (plotting.axes(plotting.COLUMN), plotting.axes(plotting.COLUMN, 2.0)):
        ax.set_xlabel("time")
        assert ax.axison and ax.xaxis.label.get_visible()


def test_times_of_an_encounter():
    """Equal changes of the contact energy lie between them: near the bobs' closest approach."""
    result = tribo.simulate(tribo.paper.scene("A"))
    energy = result.system["contact_energy"]
    closest = result.t[np.argmax(energy)]
    first, middle, last = encounter_times(result, 3)
    assert first < middle < last and abs(middle - closest) < 1.0 and last - first < 10.0
    apart = replace(result.scene, interactions=())
    assert encounter_times(tribo.simulate(apart), 3) == [0.0, 20.0, 40.0]
    assert len(result.plot.sequence().texts) >= 3


def test_figures_show_themselves():
    """Axes of tribo's own figures give a picture to notebooks; those of others do not."""
    import matplotlib.pyplot as plt

    result = tribo.simulate(tribo.paper.scene("A"))
    for drawn in (result.plot.work("upper"), result.plot.sequence(), result.plot.overview()):
        picture, size = drawn._repr_png_()
        assert picture.startswith(b"\x89PNG") and 300 < size["width"] < 900
    figure, ax = plt.subplots()
    shown = result.plot.work("upper", ax=ax)
    assert shown is ax and not hasattr(shown, "_repr_png_")
    plt.close(figure)


@pytest.mark.parametrize("own", [False, True])
def test_legends_have_one_size(own):
    """Every legend has no frame and the text of notes, also on Axes of another style."""
    result = tribo.simulate(tribo.paper.scene("A"))
    for draw in (
        result.plot.angles,
        lambda ax: plotting.histogram([1.0, 2.0], "W", ax=ax),
        lambda ax: plotting.reflected_histogram([1.0, -2.0], ax=ax),
    ):
        shown = draw(ax=Figure().add_subplot() if own else None).get_legend()
        assert {text.get_fontsize() for text in shown.get_texts()} == {NOTE_SIZE}
        assert not shown.get_frame_on()
    with plotting.style():
        assert rcParams["legend.fontsize"] == rcParams["legend.title_fontsize"] == NOTE_SIZE


def test_works_in_words():
    """The graph names the surface and the forces."""
    ax = tribo.simulate(tribo.paper.scene("A")).plot.work("upper")
    assert ax.get_ylabel() == "work on upper"
    words = [text.get_text() for text in ax.get_legend().get_texts()]
    assert words[:2] == ["friction", "drive"] and words[-2:] == ["all external", "pseudoworks"]
    assert ax.get_legend().get_lines()[-1].is_dashed()
