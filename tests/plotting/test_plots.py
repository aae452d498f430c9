"""Plots of whole results show the series of the run, and legibly so where asperites are many."""

from dataclasses import replace

import numpy as np
import pytest

import tribo
from support.command import main
from tribo import InputError, paper, plotting
from tribo.plotting import animation, curves
from tribo.plotting.marks import time_labels
from tribo.plotting.pose import pose
from tribo.plotting.style import with_powers_at_ticks

KINDS = ("angles", "work", "energy_budget", "phase", "snapshots")


@pytest.fixture(scope="module")
def result():
    scene = replace(paper.scene("A"), output=tribo.Output(samples=41))
    return tribo.simulate(scene, accuracy=1e-6)


@pytest.fixture(scope="module")
def many():
    """A result of 150 asperites on a grid, of which the first angles of each surface are given."""
    lower = tribo.Surface("lower", facing="up", shape=(50, 3), spacing=(2.0, 1.0), initial=INITIAL)
    scene = tribo.Scene((lower,), (), 1.0, output=tribo.Output(samples=3))
    return tribo.simulate(scene, method="verlet", step=0.1)


SWINGS = np.linspace(-0.1, 0.3, 150)
INITIAL = tribo.Initial(swing=SWINGS)


def lines_of(ax):
    return {line.get_label(): line for line in ax.get_lines()}


@pytest.mark.parametrize("kind", KINDS)
def test_axes_are_given_or_made(result, kind, tmp_path):
    from matplotlib.figure import Figure

    given = Figure().add_subplot()
    assert getattr(result.plot, kind)(ax=given) is given
    made = getattr(result.plot, kind)()
    assert made.figure is not given.figure
    assert plotting.save(made, tmp_path / "plot.png").stat().st_size > 5000


def test_curves_are_the_ledger(result):
    upper = result["upper"]
    system = result.system
    angle = lines_of(result.plot.angles())["lower"].get_ydata()
    assert np.allclose(angle, result["lower"].theta[:, 0] - np.pi, atol=1e-14)
    works = lines_of(result.plot.work("upper"))
    assert np.array_equal(works["w1"].get_ydata(), upper.w1[:, 0])
    budget = lines_of(result.plot.energy_budget())
    assert np.array_equal(budget["applied work"].get_ydata(), system["applied_work"])
    names = [name for name in budget if not name.startswith("_")]
    assert names == ["contact", "internal", "applied work"]
    stack = sum(heights_of_parts(budget, names[:2]).values())
    assert stack == pytest.approx(system["applied_work"], abs=1e-5)
    phase = result.plot.phase().get_lines()[0]
    assert np.array_equal(phase.get_ydata(), upper.omega[:, 0])


def test_a_swing_is_the_angle_to_the_bar():
    """theta less phi, of a pendulum at a bar that turns freely."""
    surface = tribo.Surface("s", bars="free", initial=tribo.Initial(phi=0.4, theta=0.5))
    scene = tribo.Scene([surface], [], 0.1, output=tribo.Output(samples=2))
    result = tribo.simulate(scene, accuracy=1e-6)
    assert curves.swing_of(result, surface)[0, 0] == pytest.approx(0.1)


def test_many_asperites_are_bands_and_points(many):
    """The band and the colours are those of the swings, and there is one mark for each asperite."""
    ax = many.plot.angles()
    (band,) = ax.collections
    (name,) = ax.get_legend().get_texts()
    assert name.get_text() == "lower: median, 5 to 95 %"
    low, high = np.percentile(SWINGS, [5.0, 95.0])
    start = band.get_paths()[0].vertices
    start = start[start[:, 0] == 0.0, 1]
    assert (start.min(), start.max()) == pytest.approx((low, high))
    _, marks = many.plot.snapshots([0.0]).collections
    assert np.allclose(marks.get_array(), SWINGS, atol=1e-12)
    assert len(marks.get_offsets()) == 150


def test_depth_is_up_and_to_the_right(many):
    bobs = pose(many, 0.0).bobs.reshape(3, 50, 2)
    rods = 4.0 / 3.0 * np.stack([np.sin(SWINGS), 1 - np.cos(SWINGS)], -1)
    upright = bobs + rods.reshape(3, 50, 2) * [1.0, 1.0]
    assert np.diff(upright, axis=0) == pytest.approx(np.broadcast_to([0.35, 0.2], (2, 50, 2)))


def test_two_results_in_one_figure(result):
    other = tribo.simulate(replace(paper.scene("B"), output=tribo.Output(samples=3)), accuracy=1e-6)
    ax = plotting.compare({"A": result, "B": other}, "angles")
    lines = lines_of(ax)
    assert len(lines["A: upper"].get_xdata()) == 41 and not lines["A: upper"].is_dashed()
    assert len(lines["B: upper"].get_xdata()) == 3 and lines["B: upper"].is_dashed()
    assert ax.get_xlim() == (0.0, 40.0)
    with pytest.raises(InputError, match="kind: must be one of angles"):
        plotting.compare({"A": result}, "nothing")
    with pytest.raises(InputError, match="surface: must be one of upper, lower"):
        result.plot.work("middle")
    with pytest.raises(InputError, match="times: must be from 0 to 40, got 41"):
        result.plot.snapshots([41.0])


def test_film(result, tmp_path):
    """It has the pictures asked for, and each shows the ledger up to its time."""
    from PIL import Image

    path = result.animate(tmp_path / "a.gif", frames=3, rate=10, width=240)
    with Image.open(path) as moving:
        assert moving.n_frames == 3
        assert moving.size[0] == 240
    film = animation.Film(result, "upper", 400)
    film.show(23)
    assert np.array_equal(film.lines["w1"].get_ydata(), result["upper"].w1[:24, 0])
    texts = [text.get_text() for text in film.figure.texts]
    work = f"{result['upper'].w1[23, 0]: .4f}".replace("-", "\N{MINUS SIGN}")
    assert work in texts and "$w_{1}$ friction" in texts
    assert result.scene.title in texts
    assert film.picture(23) == film.picture(23) != film.picture(3)
    assert film.picture(23).width == 400


def over_a_corrugation(speed):
    """A result of a tip that moves over a corrugation of period 1 with a minimum at 0.25."""
    tip = tribo.Surface("tip", bob=(0.25, 1.0), velocity=(speed, 0.0), drive="bars")
    field = tribo.Field(tribo.Corrugation(0.1, 1.0), on=["tip"], origin=(0.25, 0.0))
    scene = tribo.Scene((tip,), (), 4.0, fields=(field,), output=tribo.Output(samples=5))
    return tribo.simulate(scene, method="verlet", step=0.01)


def test_snapshots_show_the_motion_over_a_corrugation():
    """All show one stretch of the line, in which the tip moves by the way that it goes."""
    result = over_a_corrugation(1.0)
    ax = result.plot.snapshots([0.0, 4.0])
    first, last = ax.get_lines()
    shift = last.get_xydata()[0] - first.get_xydata()[0]
    assert np.allclose(last.get_xydata(), first.get_xydata() + shift)
    _, _, _, _, _, bobs, _, _ = zip(ax.collections[:8], ax.collections[8:], strict=True)
    start, end = (part.get_paths()[0].vertices[:-1].mean(axis=0) for part in bobs)
    moved = np.ptp(result["tip"].x_bob[:, 0])
    assert (end - start - shift)[0] == pytest.approx(moved)
    x, y = first.get_xydata().T
    assert y.max() < start[1]
    lowest = x[y < y.min() + 0.01 * np.ptp(y)] - start[0]
    assert lowest == pytest.approx(np.round(lowest), abs=0.05)


def test_snapshots_of_a_long_way_are_apart():
    """A tip that goes far is not drawn as a point in a long picture."""
    result = over_a_corrugation(20.0)
    first, last = result.plot.snapshots([0.0, 4.0]).get_lines()
    assert np.ptp(first.get_xdata()) == pytest.approx(np.ptp(last.get_xdata()), abs=0.2)
    assert np.ptp(first.get_xdata()) < 4.0


def test_a_corrugation_that_has_stopped_is_where_it_came_to():
    """In a run that goes on with a field at another velocity."""

    def scene(velocity, end):
        tip = tribo.Surface("tip", bob=(0.0, 1.0), drive="bars")
        field = tribo.Field(tribo.Corrugation(0.1, 1.0), on=["tip"], velocity=(velocity, 0.0))
        output = tribo.Output(samples=5)
        return tribo.Scene((tip,), (), end, fields=(field,), output=output)

    first = tribo.simulate(scene(0.5, 1.0), method="verlet", step=0.01)
    then = tribo.simulate(scene(0.0, 2.0), method="verlet", step=0.01, start=first.state())
    drawn = []
    for result in (first, then):
        (line,) = result.plot.snapshots([1.0]).get_lines()
        drawn.append(line.get_ydata() - line.get_ydata().mean())
    assert np.allclose(*drawn, atol=1e-6)


def test_springs_between_bars():
    """Each lattice spring is a line from bar to bar, but for one around a ring."""
    springs = tribo.Springs(stiffness=1.0, wrap=True)
    row = tribo.Surface("row", shape=(3, 1), spacing=(2.0, 0.0), drive="free", springs=springs)
    result = tribo.simulate(tribo.Scene([row], [], 1.0), method="verlet", step=0.1)
    ax = result.plot.snapshots([0.0])
    _, lines, *_ = ax.collections  # bath oscillators, and springs between bars
    ends = [path.vertices[[0, -1], 0] for path in lines.get_paths()]
    assert np.ptp(ends, axis=1) == pytest.approx([2.0, 2.0])


def test_a_rigid_surface_shows_its_velocity():
    """Pendulums that cannot swing have no angles to draw."""
    rigid = tribo.Asperite(m1=[1.0, 3.0], kappa=np.inf)
    upper = tribo.Surface(
        "upper", shape=(2, 1), spacing=(1.0, 0.0), asperite=rigid, drive="free", velocity=(0.5, 0.0)
    )
    result = tribo.simulate(tribo.Scene((upper,), (), 1.0), method="verlet", step=0.1)
    (line,) = result.plot.velocities().get_lines()[:1]
    assert line.get_ydata() == pytest.approx(np.full(result.t.size, 0.5))
    labels = [ax.get_ylabel() for ax in result.plot.overview().axes]
    assert "velocity (length / time)" in labels and "swing (rad)" not in labels


def test_numbers_in_si_units_are_told_apart():
    """All times of snapshots were 0.000000, and powers of ten lay over notes."""
    assert time_labels([0.0, 5.05e-9, 1e-8]) == [
        "$t = 0$",
        r"$t = 5.05 \times 10^{-9}$",
        r"$t = 1 \times 10^{-8}$",
    ]
    assert time_labels([17.4, 22.15]) == ["$t = 17.40$", "$t = 22.15$"]
    alone = tribo.Surface("upper", velocity=(5e-9, 0.0), drive="free")
    scene = tribo.Scene((alone,), (), 1e-8, output=tribo.Output(samples=5))
    ax = tribo.simulate(scene, method="verlet", step=1e-9).plot.velocities()
    ax.figure.draw_without_rendering()
    for axis in (ax.xaxis, ax.yaxis):
        assert axis.get_offset_text().get_text() == ""
        texts = {label.get_text() for label in axis.get_ticklabels()}
        assert any("e\N{MINUS SIGN}9" in text for text in texts)


def test_ticks_of_a_short_range_are_told_apart():
    """Four digits are too few for 8e-10 to 8.0005e-10, where matplotlib writes what they share."""
    from matplotlib.figure import Figure

    ax = Figure().add_subplot()
    ax.plot([8e-10, 8.0005e-10], [1e6, 1e6 + 10.0])
    with_powers_at_ticks(ax)
    ax.figure.draw_without_rendering()
    for axis in (ax.xaxis, ax.yaxis):
        texts = [label.get_text() for label in axis.get_ticklabels()]
        assert len(set(texts)) == len(texts)


def test_a_legend_is_no_wider_than_its_graph(result):
    """Long names have fewer columns."""
    ax = result.plot.angles()
    for name, columns in (("a", 3), ("upper.velocity = 0.25, duration = 80", 1)):
        found = curves.legend(ax, ax.get_lines()[:1] * 6, [name] * 6)
        assert found._ncols == columns


def test_film_that_cannot_be_written(result, tmp_path, monkeypatch):
    with pytest.raises(InputError, match=r"path: must end on \.gif or \.mp4"):
        result.animate(tmp_path / "a.avi")
    with pytest.raises(InputError, match="path: must be in a folder that exists"):
        result.animate(tmp_path / "none" / "a.gif")
    monkeypatch.setenv("PATH", str(tmp_path))  # without ffmpeg
    with pytest.raises(InputError, match=r"path: .mp4 needs ffmpeg, which is not installed"):
        result.animate(tmp_path / "a.mp4")
    assert not list(tmp_path.iterdir())


def test_command(result, tmp_path, capsys):
    file = tmp_path / "a.nc"
    result.save(file)
    assert main(["plot", str(file)]) == 0
    assert capsys.readouterr().out == f"{tmp_path / 'a.png'}\n"
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    assert main(["plot", str(file), "-o", str(tmp_path / "a.txt")]) == 2
    assert "--out: must end on .png" in capsys.readouterr().err
    scene = tmp_path / "a.toml"
    result.scene.save(scene)
    assert main(["plot", str(scene), "-o", str(tmp_path / "b.png")]) == 2
    assert "is a scene, and the file of a run is needed" in capsys.readouterr().err
    for command in ("view", "live"):
        assert main([command, str(scene), "-o", str(tmp_path / "a.pdf")]) == 2
        assert "--out: must end on .html, as it is a page" in capsys.readouterr().err
    with pytest.raises(InputError, match=r"path: must end on \.html"):
        result.to_html(tmp_path / "a.nc")
    assert tribo.load_result(file).status == "completed"


def test_energy_budget_of_a_scene_with_heat_closes():
    """Heat is a part of the stack, and is added to the applied work, which is net of it."""
    reservoir = tribo.Langevin(gamma=0.5, on="swing")
    upper = tribo.Surface("upper", bob=(-2.0, 0.3), velocity=(0.5, 0.0), langevin=reservoir)
    bath = tribo.Bath(masses=[0.5], frequencies=[2.0])
    lower = tribo.Surface("lower", facing="up", bath=bath, drive="free")
    output = tribo.Output(samples=41, series=["energies"])
    scene = tribo.Scene((upper, lower), tribo.Coulomb(0.2), 12.0, output=output)
    result = tribo.simulate(scene, accuracy=1e-8)
    ax = result.plot.energy_budget()
    order = ["kinetic", "contact", "internal", "bath", "heat"]
    lines = lines_of(ax)
    names = [name for name in lines if not name.startswith("_")]
    assert names == [*order, "applied work + heat"]
    heights = heights_of_parts(lines, order)
    heat = heights["heat"]
    assert heat == pytest.approx(result["upper"].heat[:, 0], abs=1e-12) and heat[-1] > 1e-3
    drives = sum(result[name].w2[:, 0] for name in ("upper", "lower"))
    assert sum(heights.values()) == pytest.approx(drives, abs=1e-7)
    work = lines["applied work + heat"].get_ydata()
    assert work == pytest.approx(drives, abs=1e-12)
    assert heights["bath"] == pytest.approx(result["lower"].heat_bath, abs=1e-12)
    text, _, gap = ax.texts[0].get_text().replace("\N{MINUS SIGN}", "-").partition(" ≤ ")
    assert text == "|work - sum|"
    assert 0.0 <= float(gap) < 1e-6


def heights_of_parts(lines, order):
    """Each part of a stack by its name: what it adds above zero, less what it adds below."""
    heights = {}
    top = bottom = 0.0
    for name in order:
        raised = lines[name].get_ydata()
        lower = lines.get(f"_{name} below zero")
        lowered = bottom if lower is None else lower.get_ydata()
        assert np.all(raised >= top) and np.all(lowered <= bottom)  # no two areas overlap
        heights[name] = raised - top + lowered - bottom
        top = raised
        bottom = lowered
    return heights


def test_negative_energies_are_below_zero():
    """The bulk slows down and the contact attracts; areas of parts do not overlap."""
    upper = tribo.Surface("upper", bob=(-2.0, 0.5), velocity=(0.5, 0.0), drive="free")
    lower = tribo.Surface("lower", facing="up", drive="free")
    scene = tribo.Scene((upper, lower), tribo.Coulomb(-0.2), 12.0, output=tribo.Output(samples=41))
    result = tribo.simulate(scene, accuracy=1e-8)
    ax = result.plot.energy_budget()
    heights = heights_of_parts(lines_of(ax), ["kinetic", "contact", "internal"])
    contact = result.system["contact_energy"]
    assert heights["contact"] == pytest.approx(contact - contact[0], abs=1e-12)
    assert heights["contact"].min() < -1e-2
    assert heights["kinetic"].max() > 1e-2
    assert [text.get_text() for text in ax.get_legend().get_texts()][:3] == list(heights)
    spans = [area.get_paths()[0].vertices[:, 1] for area in ax.collections]
    assert all(span.min() >= 0.0 or span.max() <= 0.0 for span in spans)
