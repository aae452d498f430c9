"""The live page: what it holds, and what it does in a browser."""

import re
from dataclasses import replace
from html import unescape

import pytest

import tribo
from support.command import main
from support.pages import ARGUMENTS, CHROMIUM, held, held_in

# Most bytes of the page of case A.
LARGEST = 300_000
# Relative round-off of a run in the browser: its functions of numbers differ in the last bit.
ROUND_OFF = 1e-11


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    path = tmp_path_factory.mktemp("live") / "a.html"
    assert tribo.paper.scene("A").to_live_html(path) == path
    return path


def test_contents(page):
    """One file, small, with the scene's own values; no address of anything else."""
    data = held(page)
    assert page.stat().st_size < LARGEST
    assert data["title"] == "A: forced sliding, repulsive" and data["samples"] == 401
    assert {key["key"]: key["value"] for key in data["keys"]}["upper.velocity"] == 0.5
    text = page.read_text(encoding="utf-8")
    assert "http://" not in text.replace("http://www.w3.org", "") and "https://" not in text
    assert "default-src 'none'" in text and "<svg" in text


def test_replaced_pages_of_other_commands(tmp_path, capsys, monkeypatch):
    """`live` and `view` have one default page; a line says that one replaces that of the other."""
    monkeypatch.chdir(tmp_path)
    tribo.paper.scene("D").save("d.toml")
    for first, second in (("live", "view"), ("view", "live")):
        assert main([first, "d.toml", "-o", "d.html"]) == 0 and main([first, "d.toml"]) == 0
        assert capsys.readouterr().err == ""
        assert main([second, "d.toml"]) == 0
        assert capsys.readouterr().err == (
            f"tribo: d.html is a page of tribo {first}; this one replaces it; -o d_{second}.html "
            "keeps both\n"
        )


def test_command(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    tribo.paper.scene("A").save("a.toml")
    (tmp_path / "c.toml").write_text('title = "Wie schnell?"\n"upper.velocity" = [0.2, 1.0]\n')
    assert main(["live", "a.toml", "--set", "upper.velocity=0.4", "--controls", "c.toml"]) == 0
    assert capsys.readouterr().out == "a.html\n"
    data = held(tmp_path / "a.html")
    assert data["title"] == "Wie schnell?" and len(data["controls"]) == 1
    assert data["controls"][0]["value"] == 0.4
    row = replace(tribo.paper.scene("A").surfaces[0], shape=(2, 1), spacing=(3.0, 0.0))
    scene = replace(tribo.paper.scene("A"), surfaces=(row, tribo.paper.scene("A").surfaces[1]))
    damped = replace(scene.surfaces[1], langevin=tribo.Langevin(gamma=0.1))
    replace(scene, surfaces=(scene.surfaces[0], damped)).save("row.toml")
    assert main(["live", "row.toml"]) == 2
    assert "it has langevin" in capsys.readouterr().err and not (tmp_path / "row.html").exists()


# Milliseconds between looks at a page; frames may stop in a tab that is not seen.
POLLING = 50
LAWS = {"label": "law", "own": "strong", "values": {"weak": tribo.Coulomb(0.1)}}


def test_laws(tmp_path):
    """Controls offer other potentials, each with its own keys, or are refused in a sentence."""
    scene = tribo.paper.scene("A")
    controls = {"interaction": LAWS, "interaction.strength": None, "duration": None}
    data = held(scene.to_live_html(tmp_path / "a.html", controls))
    laws = data["laws"]
    other = laws["sources"]["weak"]
    assert (laws["label"], laws["own"]) == ("law", "strong")
    assert [each["value"] for each in data["controls"]] == [0.2, 40.0]
    assert [each["value"] for each in other["controls"]] == [0.1, 40.0]
    assert len(other["module"]) > 10_000 and "strength = 0.1" in other["toml"]
    table = {"values": {"wrong": {"potential": "coulomb", "depth_of_all": 1.0}}}
    with pytest.raises(tribo.InputError, match=r"controls\.interaction\.wrong.*depth_of_all"):
        scene.to_live_html(tmp_path / "b.html", {"interaction": table})
    with pytest.raises(tribo.InputError, match="without the scene's own"):
        scene.to_live_html(tmp_path / "b.html", {"interaction": LAWS | {"own": "weak"}})


def test_exported_widgets():
    """An exported notebook shows a live page in place of a widget, or the page of the run."""
    pytest.importorskip("anywidget", reason="needs tribo[notebook]")
    scene = replace(tribo.paper.scene("A"), duration=1.0)
    played = tribo.play(scene, {"upper.velocity": (0.1, 2.0), "upper.drive": ["forced", "free"]})
    for widget in (tribo.simulate(scene).widget(), played):
        shown = exported(widget)
        assert "makeProgram" in shown and len(held_in(shown)["module"]) > 10_000
    velocity, _ = held_in(shown)["controls"]
    assert (velocity["low"], velocity["high"]) == (0.1, 2.0)
    played = tribo.play(scene, {"upper.velocity,duration": [[0.5, 1.0], [1.0, 0.5]]})
    shown = exported(played)  # a live page has no slider of two keys
    assert "makeProgram" not in shown and held_in(shown)["run"]["title"] in shown


def exported(widget):
    """The page in the frame that stands for a widget."""
    data, _ = widget._repr_mimebundle_()
    assert "application/vnd.jupyter.widget-view+json" in data
    return unescape(re.search(r'srcdoc="([^"]*)"', data["text/html"])[1])


@pytest.mark.thorough
@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
def test_in_a_browser(page):
    """Its numbers are those of Python; its values stand in the address; nothing fails."""
    playwright = pytest.importorskip("playwright.sync_api", reason="needs tribo[browser]")
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=CHROMIUM, args=ARGUMENTS)
        tab = browser.new_page(viewport={"width": 1366, "height": 768})
        problems, requests = [], []
        tab.on("console", lambda message: problems.append(message.text))
        tab.on("pageerror", lambda error: problems.append(str(error)))
        tab.on("request", lambda request: requests.append(request.url))
        tab.goto(page.as_uri() + "#upper.velocity=0.4")
        tab.wait_for_function("window.tribo", polling=POLLING)
        assert tab.evaluate("tribo.values['upper.velocity']") == 0.4
        for values in ({}, {"upper.velocity": 0.5, "interaction.strength": 0.1}):
            check_run(tab, {"upper.velocity": 0.4} | values)
        tab.evaluate("tribo.set({'upper.velocity': 0.3})")
        assert "upper.velocity=0.3" in tab.url
        status = tab.locator("[data-part=status]")
        assert "before the bobs have passed" in status.inner_text()
        status.locator("button").click()
        assert tab.evaluate("window.tribo.values.duration") == 100.0
        assert "Work of friction" in status.inner_text()
        tab.locator("[data-part=reset]").click()
        assert tab.evaluate("tribo.values['upper.velocity']") == 0.5 and "#" not in tab.url
        tab.locator("[data-key='upper.velocity']").focus()
        tab.keyboard.press("Space")
        tab.wait_for_timeout(400)
        assert float(tab.locator("[data-part=time]").input_value()) > 0.0
        wrong = "tribo.run({'upper.asperite.m1': -1})"
        refused = f"(() => {{ try {{ {wrong} }} catch (e) {{ return e.message }} }})()"
        assert tab.evaluate(refused) == "upper.asperite.m1 must be positive, got -1"
        check_map(tab)
        check_starts(tab)
        check_printed(tab)
        tab.evaluate("tribo.set({'upper.drive': 'free'})")
        for name in ("Energy", "Numbers", "Many starts", "Files", "End value"):
            tab.get_by_role("tab", name=name).click()
            tab.wait_for_timeout(50)
            check_accessible(tab)
        check_stopped(browser, page)
        check_laws(browser, page.with_name("laws.html"), problems)
        browser.close()
    assert problems == []
    assert [url for url in requests if not url.startswith(("data:", "blob:"))] == [requests[0]]


def check_laws(browser, path, problems):
    """Another law gives the numbers of its scene and stands in the address; Reset leaves it."""
    scene = tribo.paper.scene("A")
    scene.to_live_html(path, {"interaction": LAWS, "upper.velocity": None})
    tab = browser.new_page()
    tab.on("pageerror", lambda error: problems.append(str(error)))
    tab.goto(path.as_uri() + "#upper.velocity=0.4")
    tab.wait_for_function("window.tribo", polling=POLLING)
    tab.locator("[data-part=law]").select_option("weak")
    tab.wait_for_function("tribo.law === 'weak'", polling=POLLING)
    assert tab.url.endswith("#interaction=weak&upper.velocity=0.4")
    want = case_a({"interaction.strength": 0.1, "upper.velocity": 0.4})
    work = tribo.simulate(want, accuracy=1e-9)["upper"].w1[-1, 0]
    for _ in range(2):  # as chosen, and from the address
        assert tab.evaluate("tribo.run().end.upper.w1") == pytest.approx(work, abs=1e-7)
        tab.reload()
        tab.wait_for_function("window.tribo", polling=POLLING)
    tab.locator("[data-part=reset]").click()
    tab.wait_for_function("tribo.law === 'strong'", polling=POLLING)
    assert tab.evaluate("tribo.values['upper.velocity']") == 0.5 and "#" not in tab.url


def check_map(tab):
    """With a second control the end value is a map, and a click takes a value of each."""
    tab.locator("[data-part=velocities]").check()
    tab.locator("[data-part=endSecond]").select_option("interaction.strength")
    tab.wait_for_selector("[data-part=end][aria-busy=false]", timeout=60_000)
    tab.locator("[data-part=end]").click(position={"x": 150, "y": 60})
    values = tab.evaluate("window.tribo.values")
    assert values["upper.velocity"] != 0.5 and values["interaction.strength"] > 0.3
    tab.locator("[data-part=reset]").click()


def check_starts(tab):
    """Of starts at a temperature, the mean of exp(-gain / temperature) is 1."""
    tab.get_by_role("tab", name="Many starts").click()
    sentence = tab.locator("[data-part=startsSentence]")
    tab.locator("[data-part=amplitude]").fill("1")
    tab.locator("[data-part=more]").click()
    has_many = re.compile(r"^Of \d{3}")
    tab.locator("[data-part=startsSentence]", has_text=has_many).wait_for(timeout=60_000)
    tab.locator("[data-part=more]").click()
    mean, error = re.search(
        r"temperature\) is ([\d.]+) ± ([\d.]+\d)", sentence.inner_text()
    ).groups()
    assert abs(float(mean) - 1.0) < 6.0 * float(error) + 0.05


def check_printed(tab):
    """On paper, canvases keep the proportions that were drawn, so that circles stay circles."""
    tab.emulate_media(media="print")
    ratios = tab.evaluate(
        "[...document.querySelectorAll('canvas')].filter((each) => each.clientHeight)"
        ".map((each) => { document.body.style.width = '520px';"
        " const box = each.getBoundingClientRect();"
        " return (box.width / box.height) / (each.width / each.height) })"
    )
    tab.evaluate("document.body.style.width = ''")
    tab.emulate_media(media="screen")
    assert len(ratios) > 1 and ratios == pytest.approx([1.0] * len(ratios), rel=0.01)


def check_stopped(browser, page):
    """Where a policy forbids WebAssembly, a sentence and the stored picture stand in its place."""
    text = page.read_text(encoding="utf-8").replace("'wasm-unsafe-eval' ", "")
    forbidden = page.with_name("forbidden.html")
    forbidden.write_text(text, encoding="utf-8")
    tab = browser.new_page()
    tab.goto(forbidden.as_uri())
    tab.wait_for_selector("main svg")
    assert "cannot simulate here" in tab.locator("[data-part=status]").inner_text()


def case_a(values):
    """Case A of the paper with another velocity, and perhaps another strength."""
    scene = tribo.paper.scene("A")
    upper, lower = scene.surfaces
    upper = replace(upper, velocity=(values["upper.velocity"], 0.0))
    potential = tribo.Coulomb(values.get("interaction.strength", 0.2))
    return replace(scene, surfaces=(upper, lower), interactions=tribo.Interaction(potential))


def check_run(tab, values):
    """A run of the page and one of Python differ by round-off, and by less than both errors."""
    found = tab.evaluate(
        "(values) => { const r = tribo.run(values); return [r.end, r.errors, r.status] }", values
    )
    end, errors, status = found
    assert status == "completed"
    result = tribo.simulate(case_a(values), accuracy=1e-10)
    for surface in ("upper", "lower"):
        for name in ("w1", "w1_ps", "w2", "theta", "delta_e_int", "x_bob", "wL", "W"):
            want = result[surface][name].reshape(len(result.t), -1)[-1, 0]
            allowed = errors[surface][name] + result.error_estimate[name] + ROUND_OFF
            assert abs(end[surface][name] - want) <= allowed, (surface, name)


def check_accessible(tab):
    """No violation by axe."""
    axe = pytest.importorskip(
        "axe_playwright_python.sync_playwright", reason="needs tribo[browser]"
    )
    violations = axe.Axe().run(tab).response["violations"]
    assert [each["id"] for each in violations] == []
