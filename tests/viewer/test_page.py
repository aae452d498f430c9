"""The page that plays a run: what it holds, and what it does in a browser."""

import re
from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest

import tribo
from support.command import main
from support.pages import ARGUMENTS, CHROMIUM, assert_same, held, numbers
from tribo import Coulomb, InputError, Output, Scene, Surface
from tribo.analysis.contact_probe import ContactProbe
from tribo.plotting import animation
from tribo.plotting.works import WORKS
from tribo.viewer import contents

NUMERICS = tribo.Numerics(method="verlet", step=0.01)


@pytest.fixture(scope="module")
def result():
    """The paper's case A at 41 times."""
    surfaces = (
        Surface("upper", bob=(-10.0, 0.0), velocity=(0.5, 0.0)),
        Surface("lower", facing="up"),
    )
    scene = Scene(surfaces, Coulomb(0.2), 40.0, title="A < B [[DATA]]", output=Output(samples=41))
    return tribo.simulate(scene, accuracy=1e-8)


@pytest.fixture(scope="module")
def page(result, tmp_path_factory):
    """The file of its page."""
    return result.to_html(tmp_path_factory.mktemp("page") / "a.html")


def test_the_page_holds_the_run(result, page):
    """Curves to six digits, places to single precision, forces as the kernels compute them."""
    data = held(page)["run"]
    assert data["title"] == result.scene.title
    assert np.array_equal(numbers(data["times"]), result.t)
    groups = {group["name"]: group["curves"] for group in data["groups"]}
    assert list(groups) == ["upper", "lower", "system"]
    for name, curves in groups.items():
        table = result.system if name == "system" else result[name]
        for curve in curves:
            want = table[curve["name"]].reshape(len(result.t), -1)[:, 0]
            for one, other in zip(numbers(curve["values"]), want, strict=True):
                assert f"{one:.6g}" == f"{other:.6g}", (name, curve["name"])
    drawn = [curve["name"] for curve in groups["upper"] if curve["drawn"]]
    assert drawn == ["w1", "w1_ps", "w2", "w2_ps", "W", "W_ps"]
    for surface in data["surfaces"]:
        for name in contents.PLACES:
            places = numbers(surface["places"][name]).reshape(len(result.t), 1)
            assert places == pytest.approx(result[surface["name"]][name], rel=1e-6, abs=1e-6)
        assert numbers(surface["centre"]) == pytest.approx([1.0 / 3.0])  # m1 = 1, m2 = 2
    (x, y), (x2, y2) = (
        [numbers(v).reshape(-1, 2) for v in data["forces"][f]] for f in ("f1", "f2")
    )
    bobs = [[[result[s][x][20, 0] for x in ("x_bob", "y_bob")] for s in ("upper", "lower")]]
    distance = np.subtract(*bobs[0])
    want = 0.2 * distance / np.hypot(*distance) ** 3
    assert (x[20, 0], y[20, 0]) == pytest.approx(want, rel=1e-5)
    assert (x[20, 1], y[20, 1]) == pytest.approx(-want, rel=1e-5)
    assert (x2[20, 0], y2[20, 0]) == pytest.approx(-want, rel=1e-5)  # forced


def sentence_of(result):
    """The sentence of the page of a run."""
    return contents.contents(result)["sentence"]


def along_the_force(result, name):
    """The integral of contact forces along the motion of bobs relative to centres of mass."""
    table = result[name]
    part = 2.0 / 3.0  # of the rod, from the centre of mass to the bob: m1 = 1 and m2 = 2
    total = 0.0
    for axis in "xy":
        offset = part * (table[f"{axis}_bob"] - table[f"{axis}_bar"])
        force = table[f"f1_{axis}"]
        total += np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(offset, axis=0))
    return total


def test_the_sentence(result):
    """It says which of work and pseudowork is larger, and whether friction drives the swing."""
    w1, pseudowork = (result["upper"][name][-1, 0] for name in ("w1", "w1_ps"))
    said = sentence_of(result)
    assert f'more work on "upper" ({w1:.3g}) than pseudowork ({pseudowork:.3g}).' in said
    assert f"The difference, {w1 - pseudowork:.3g}, is its work on the motion of the bob" in said
    assert said.endswith(
        "positive: friction drives that motion more than it holds that motion back."
    )
    output = Output(samples=801, series=["forces"])
    fine = tribo.simulate(replace(result.scene, output=output), accuracy=1e-8)
    assert along_the_force(fine, "upper") == pytest.approx(w1 - pseudowork, rel=1e-3)
    rigid = replace(result.scene.surfaces[0], asperite=tribo.Asperite(kappa=np.inf))
    scene = replace(result.scene, surfaces=(rigid, result.scene.surfaces[1]))
    assert "equals its pseudowork" in sentence_of(tribo.simulate(scene, accuracy=1e-8))


@pytest.mark.parametrize("case", "BCDE")
def test_the_sentence_of_the_paper(case):
    """Each of the forces does more work than pseudowork, whether the bob ends ahead or behind."""
    said = sentence_of(tribo.simulate(tribo.paper.scene(case), accuracy=1e-6))
    # In case E too, where it begins at rest on a table that moves.
    assert said.startswith('Friction does more work on "upper" (')
    assert said.endswith(
        "positive: friction drives that motion more than it holds that motion back."
    )


def test_the_sentence_where_work_is_less():
    """Bobs that swing at the start give energy to the contact."""
    upper, lower = tribo.paper.scene("A").surfaces
    swinging = tribo.Initial(omega=-1.0)
    upper = replace(upper, shape=(2, 1), spacing=(3.0, 0.0), initial=swinging)
    scene = replace(tribo.paper.scene("A"), surfaces=(upper, lower))
    said = sentence_of(tribo.simulate(scene, accuracy=1e-5))
    assert said.startswith('Friction does less work on "upper" (-1.83) than pseudowork (-0.284).')
    assert said.endswith("friction holds those motions back more than it drives those motions.")


@pytest.mark.thorough
def test_a_periodic_page_says_what_is_not_drawn(result):
    """Places are not wrapped, so that a block leaves the other surface while it is in contact."""
    assert contents.PERIODIC not in contents.contents(result)["notes"]
    repulsion = Coulomb(0.2).with_cutoff(3.0)
    scene = Scene(result.scene.surfaces, repulsion, 0.1, periodic=tribo.Periodic(x=30.0))
    periodic = tribo.simulate(replace(scene, numerics=NUMERICS))
    drawn = periodic.plot.overview()
    assert any("one period" in ax.get_title() for ax in drawn.axes)
    assert not any("one period" in ax.get_title() for ax in result.plot.overview().axes)
    assert contents.PERIODIC in contents.contents(periodic)["notes"]


def test_a_run_before_the_encounter(result):
    """Its page says that its works are not those of the encounter, and which duration is."""
    scene = replace(result.scene, duration=15.0)
    shown = contents.contents(tribo.simulate(scene, accuracy=1e-6))
    assert shown["status"] == "ended early"
    assert shown["sentence"].startswith("The run ends at t = 15, before the bobs have passed")
    assert shown["sentence"].endswith("a duration of 40.")
    assert contents.contents(result)["status"] == "completed"


def test_one_work_on_a_surface():
    """Summary, plot, film and page: the work of external forces; what springs do is beside it."""
    springs = tribo.Springs(stiffness=1.0)
    row = {"shape": (2, 1), "spacing": (2.0, 0.0), "springs": springs, "drive": "free"}
    upper = Surface("upper", bob=(-5.0, 0.3), velocity=(0.5, 0.0), **row)
    scene = Scene(
        (upper, Surface("lower", facing="up")), Coulomb(0.2), 8.0, output=Output(samples=9)
    )
    result = tribo.simulate(scene, accuracy=1e-6)
    table = result["upper"]
    film = animation.Film(result, "upper", 400)
    film.show(8)
    lines = {line.get_label(): line.get_ydata() for line in result.plot.work("upper").lines}
    curves = next(g["curves"] for g in contents.contents(result)["groups"] if g["name"] == "upper")
    page = {curve["name"]: numbers(curve["values"]) for curve in curves}
    for name in ("W", "w_int", "w1"):
        want = table[name].reshape(9, -1).sum(axis=1)
        assert abs(want[-1]) > 1e-4
        for found in (lines[name], film.lines[name].get_ydata(), page[name]):
            np.testing.assert_allclose(found, want, rtol=1e-5, atol=1e-12)
    assert not {"w", "w_ps"} & {*lines, *film.lines, *page}
    assert f"upper: work {table['W'][-1]: .6g}, pseudowork {table['W_ps'][-1]: .6g}" in str(result)
    outer = sum(table[name].sum(axis=1) for name in ("w1", "w2", "wL", "wR"))
    np.testing.assert_allclose(table["W"], outer, rtol=1e-12, atol=1e-15)


def test_a_quantity_has_one_colour():
    """Works have that of figures in the page on a light background."""
    style = (files("tribo.viewer") / "parts" / "style.css").read_text(encoding="utf-8")
    colours = dict(re.findall(r"--(\w+): (#\w+)", style.partition("@media")[0]))
    for name, work in WORKS.items():
        if name not in ("w", "W"):
            assert colours[name.replace("_", "")] == work.colour, name


def test_the_page_loads_nothing(page):
    """No address in it, and a policy that forbids every request."""
    text = page.read_text(encoding="utf-8")
    assert page.stat().st_size < 3e6
    assert not re.findall(r"https?:|src=|@import|url\(", text)
    assert "default-src 'none'" in text
    assert set(re.findall(r"\[\[\w+\]\]", text)) == {"[[DATA]]"}  # of the title


@pytest.fixture(scope="module")
def bathed(result):
    """The same with a bath on the lower bar, which 30 listed oscillators make."""
    bath = tribo.Bath(np.full(30, 0.05), np.linspace(0.5, 3.0, 30))
    upper, lower = result.scene.surfaces
    output = Output(samples=41, series=["oscillators"])
    scene = replace(result.scene, surfaces=(upper, replace(lower, bath=bath)), output=output)
    return tribo.simulate(replace(scene, numerics=NUMERICS))


def test_bath_oscillators_on_request(bathed, tmp_path):
    """Evenly chosen ones are dots below the bar, with displacements that are magnified alike."""
    page = bathed.to_html(tmp_path / "bath.html", bath=True)
    upper, lower = held(page)["run"]["surfaces"]
    assert upper["dots"] is None and page.stat().st_size < 3e6
    dots = numbers(lower["dots"]).reshape(41, 12, 2)
    bar = np.stack([bathed["lower"][f"{axis}_bar"] for axis in "xy"], axis=-1)
    rod = bathed.scene.surfaces[1].asperite.for_each(1)["length"][0]
    row = dots[0] - bar[0]
    assert row[:, 1] == pytest.approx(-0.4 * rod) and np.all(np.diff(row[:, 0]) > 0.0)
    chosen = np.linspace(0, 29, 12).round().astype(int)
    true = bathed.oscillators("lower")[:, 0]
    drawn = true[:, chosen] * 0.25 * rod / np.abs(true).max()
    assert dots - bar - row == pytest.approx(drawn, abs=1e-5)
    assert np.abs(drawn).max() > 0.1 * rod
    factor = 0.25 * rod / np.abs(true).max()
    assert f"displaced {factor:.3g} times" in held(page)["run"]["notes"][-1]


def test_bath_in_other_pictures(result, bathed, tmp_path, capsys):
    """Snapshots and films have the dots too; a result without oscillators is refused."""
    for bath, number in ((False, 0), (True, 12)):
        marks = bathed.plot.snapshots([40.0], bath=bath).collections
        assert sum(len(each.get_offsets()) == 12 for each in marks) == number // 12
    assert bathed.animate(tmp_path / "a.gif", frames=2, width=180, bath=True).stat().st_size > 0
    with pytest.raises(InputError, match="bath: no surface has bath oscillators"):
        result.to_html(tmp_path / "a.html", bath=True)
    scene = replace(bathed.scene, output=Output(samples=3), numerics=NUMERICS)
    scene.save(tmp_path / "a.toml")
    arguments = ["view", str(tmp_path / "a.toml"), "-o", str(tmp_path / "a.html")]
    assert main([*arguments, "--bath"]) == 0
    assert held(tmp_path / "a.html")["run"]["surfaces"][1]["dots"]
    tribo.simulate(scene).save(tmp_path / "a.nc")
    assert main(["view", str(tmp_path / "a.nc"), *arguments[2:], "--bath"]) == 2
    assert 'output.series: does not contain "oscillators"' in capsys.readouterr().err


def test_frames_are_thinned(result, monkeypatch):
    """Of many asperites, some samples are drawn, the first and the last among them."""
    monkeypatch.setattr(contents, "MOST_PLACES", 5 * 2 * 7)
    data = contents.contents(result)
    frames = numbers(data["frames"])
    assert len(frames) == 7 and frames[0] == 0 and frames[-1] == 40
    assert len(numbers(data["surfaces"][0]["places"]["x_bob"])) == 7


def test_no_arrows_where_forces_are_unknown(result, monkeypatch):
    """As where the code of a potential was not loaded."""

    def refuse(*arguments):
        raise InputError("potential", "is code that was not loaded")

    monkeypatch.setattr(ContactProbe, "__call__", refuse)
    assert contents.contents(result)["forces"] == {}


def test_command(result, tmp_path, capsys):
    """A scene file and the file of a run give the same page."""
    scene = tmp_path / "a.toml"
    file = tmp_path / "a.nc"
    out = tmp_path / "a.html"
    result.scene.save(scene)
    result.save(file)
    for source in (scene, file):
        assert main(["view", str(source), "-o", str(out)]) == 0
        assert capsys.readouterr().out == f"{out}\n"
        assert held(out)["run"]["title"] == result.scene.title
        out.unlink()
    assert main(["view", str(file), "-o", str(tmp_path / "none" / "a.html")]) == 2
    assert main(["view", str(tmp_path / "b.nc"), "-o", str(out)]) == 2
    assert not out.exists()


@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
def test_in_a_browser(result, page):
    """It plays, scrubs, shows the ledger's values, and neither fails nor asks for anything."""
    playwright = pytest.importorskip("playwright.sync_api", reason="needs tribo[browser]")
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=CHROMIUM, args=ARGUMENTS)
        tab = browser.new_page()
        problems = []
        requests = []
        tab.on("console", lambda message: problems.append(message.text))
        tab.on("pageerror", lambda error: problems.append(str(error)))
        tab.on("request", lambda request: requests.append(request.url))
        tab.goto(page.as_uri())
        for sample, key in ((0, None), (1, "ArrowRight"), (40, "End"), (39, "ArrowLeft")):
            if key:
                tab.keyboard.press(key)
            assert_shown(tab, result, sample)
        tab.locator("[data-part=time]").fill(str(result.t[20] - 0.4))  # t[20] is the nearest
        assert_shown(tab, result, 20)
        scene = tab.locator("[data-part=scene]")
        play = tab.locator("[data-part=play]")
        before = scene.screenshot()
        play.click()
        tab.wait_for_timeout(500)
        assert play.inner_text() == "Pause"
        assert float(tab.locator("[data-part=time]").input_value()) > result.t[20]
        play.click()
        assert scene.screenshot() != before
        browser.close()
    assert problems == []
    assert [url for url in requests if not url.startswith("data:")] == [page.as_uri()]


def assert_shown(tab, result, sample):
    """The table of each group has the values of a sample, to the digits shown, and its time."""
    tab.wait_for_timeout(100)
    for name in ("upper", "lower", "system"):
        tab.locator("[data-part=group]").select_option(label=name)
        tab.wait_for_timeout(100)
        table = result.system if name == "system" else result[name]
        cells = tab.locator('td[data-column="shown"]').all()
        assert len(cells) >= 3
        for cell in cells:
            want = np.ravel(table[cell.get_attribute("data-quantity")][sample])[0]
            assert_same(cell.inner_text(), want)
        assert_same(
            tab.locator("[data-part=when]").inner_text().removeprefix("t = "), result.t[sample]
        )
