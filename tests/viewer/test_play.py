"""Sliders: runs of a page without Python, of the server, and of a notebook, and what is refused."""

import http.client
import json
import threading
from dataclasses import replace

import numpy as np
import pytest

import tribo
from support.command import main
from support.pages import ARGUMENTS, CHROMIUM, assert_same, numbers
from tribo import InputError
from tribo.model.parameters import with_values
from tribo.sliders import MOST_EVALUATIONS, Playing, sliders_of
from tribo.viewer.server import MOST_BYTES, Server

SCENE = tribo.paper.scene("A")
SCENE = replace(SCENE, output=tribo.Output(samples=41))
STRENGTH = {"interaction.strength": (0.05, 1.0), "upper.drive": ["forced", "free"]}


@pytest.fixture(scope="module")
def server():
    """A server of the paper's case A with two sliders, and its thread."""
    playing = Playing(SCENE, sliders_of(SCENE, STRENGTH))
    with Server(playing.source(), playing.run) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        yield server
        server.shutdown()
        thread.join()


def asked(server, method="POST", path="/run", body=b'{"interaction.strength": 0.3}', **headers):
    """Status and content of an answer; a header of None is left out."""
    connection = http.client.HTTPConnection(server.host, timeout=60)
    usual = {"Host": server.host, "Origin": f"http://{server.host}", "X_Tribo_Token": server.token}
    connection.putrequest(method, path, skip_host=True)
    if method == "POST":
        usual["Content_Length"] = str(len(body))
    for name, value in (usual | headers).items():
        if value is not None:
            connection.putheader(name.replace("_", "-"), value)
    connection.endheaders(body if method == "POST" and len(body) <= MOST_BYTES else None)
    answer = connection.getresponse()
    content = answer.read()
    connection.close()
    return answer.status, content


def end_of(run, name, group="upper"):
    """The last value of a curve."""
    curves = next(each["curves"] for each in run["groups"] if each["name"] == group)
    return numbers(next(each["values"] for each in curves if each["name"] == name))[-1]


def test_the_server_simulates(server):
    """Its numbers are those of tribo.simulate, to the digits shown."""
    status, content = asked(server, body=b'{"interaction.strength": 0.3, "upper.drive": "free"}')
    assert status == 200
    values = {"interaction.strength": 0.3, "upper.drive": "free"}
    result = tribo.simulate(with_values(SCENE, values))
    for name in ("w1", "w1_ps", "W"):
        want = np.ravel(result["upper"][name][-1])[0]
        assert f"{end_of(json.loads(content), name):.6g}" == f"{want:.6g}"


@pytest.mark.parametrize(
    "request_",
    [
        {"X_Tribo_Token": "x"},
        {"X_Tribo_Token": None},
        {"Host": "tribo.example:80"},
        {"Host": "localhost"},
        {"Origin": "https://tribo.example"},
        {"Origin": "null"},
        {"Origin": None},
        {"path": "/other"},
        {"method": "GET", "path": "/"},
        {"method": "GET", "path": "/?token=x"},
        {"method": "GET", "path": "/etc/passwd"},
    ],
)
def test_others_are_forbidden(server, request_):
    """Without the token, from another page, by another name, or another file: 403."""
    assert asked(server, **request_)[0] == 403


@pytest.mark.parametrize(
    ("body", "sentence"),
    [
        (b'{"interaction.strength": 2}', "interaction.strength: must be from 0.05 to 1, got 2"),
        (b'{"interaction.strength": NaN}', "interaction.strength: must be"),
        (b'{"duration": 1}', "duration: must be one of interaction.strength, upper.drive"),
        (b'{"upper.drive": "own.py:Drive"}', "upper.drive: must be one of forced, free"),
        (b"[1]", "values: must be a value for each key"),
        (b"{", "must be JSON"),
    ],
)
def test_values_that_are_refused(server, body, sentence):
    """Keys that were not declared, values out of range, and no JSON: one sentence."""
    status, content = asked(server, body=body)
    assert status == 400 and sentence in json.loads(content)["error"]


def test_a_slider_of_one_of_two_reservoirs():
    """It begins at the present value; a key without the place is no key."""
    both = [tribo.Langevin(0.3), tribo.Langevin(0.4, on="swing")]
    upper, lower = SCENE.surfaces
    scene = replace(SCENE, surfaces=(replace(upper, langevin=both), lower))
    (slider,) = sliders_of(scene, {"upper.langevin.swing.gamma": (0.1, 1.0)})
    assert slider.value == 0.4
    with pytest.raises(InputError, match="is not a known key"):
        sliders_of(scene, {"upper.langevin.gamma": (0.1, 1.0)})


def test_a_whole_number_of_a_list():
    """JavaScript sends 1.0 as 1."""
    playing = Playing(SCENE, sliders_of(SCENE, {"duration": [0.5, 1.0]}))
    assert playing.simulated({"duration": 1}).scene.duration == 1.0


def test_values_that_change_together():
    """Keys with commas between them have rows of values, as in sweeps."""
    (slider,) = sliders_of(SCENE, {"upper.velocity,duration": [[0.25, 80], [0.5, 40.0]]})
    assert slider.values == ("0.25, 80", "0.5, 40") and slider.value == "0.5, 40"
    playing = Playing(SCENE, [slider])
    scene = playing.simulated({"upper.velocity,duration": "0.25, 80"}).scene
    assert scene.duration == 80.0 and scene.surfaces[0].velocity == (0.25, 0.0)
    assert sliders_of(SCENE, {("upper.velocity", "duration"): [[0.25, 80], [0.5, 40.0]]}) == [
        slider
    ]
    for wrong in ([0.25, 80], [[0.25], [0.5]], 1.0):
        with pytest.raises(InputError, match="must be a list of rows"):
            sliders_of(SCENE, {"upper.velocity,duration": wrong})


def test_the_value_of_the_scene_is_in_the_grid():
    """In place of the nearest of the evenly spaced values."""
    (slider,) = sliders_of(SCENE, {"upper.velocity": (0.1, 2.0)})
    grid = slider.on_a_grid(11)
    assert grid.value == 0.5 and grid.values[2] == 0.5 and len(set(grid.values)) == 11
    assert grid.values[0] == 0.1 and grid.values[-1] == 2.0


def test_limits(server):
    """Long bodies and those without a length are not read; evaluations are bounded."""
    assert asked(server, body=b" " * (MOST_BYTES + 1))[0] == 413
    assert asked(server, Content_Length=None)[0] == 400
    assert asked(server, Content_Length="-1")[0] == 400
    assert server.server_address[0] == "127.0.0.1"
    result = Playing(SCENE, []).simulated({})
    assert result.scene.numerics.max_evaluations == MOST_EVALUATIONS


def test_ranges_that_are_refused(tmp_path, capsys):
    """Of keys, and of values that the scene cannot have."""
    scene = tmp_path / "a.toml"
    SCENE.save(scene)
    for given, sentence in (
        ("upper.speed=0.1:1", "upper.speed: is not a known key"),
        ("upper.velocity=1:0.1", "whose first number is the lower one"),
        ("upper.asperite.m1=-1:1", "m1: must be positive"),
        ("upper.velocity=1", "must be a range"),
    ):
        assert main(["view", str(scene), "--slider", given]) == 2
        assert sentence in capsys.readouterr().err


def test_a_page_of_a_grid(tmp_path, capsys):
    """41 values of a range in one file below 5 MB that loads nothing."""
    scene = tmp_path / "a.toml"
    page = tmp_path / "a.html"
    tribo.paper.scene("A").save(scene)
    assert main(["view", str(scene), "--slider", "upper.velocity=0.1:2"]) == 0
    assert capsys.readouterr().out == f"{page}\n"
    text = page.read_text(encoding="utf-8")
    assert len(text) < 5e6 and "default-src 'none'" in text and "connect-src" not in text
    assert main(["view", str(scene), "--slider", "upper.velocity=0.1"]) == 2
    assert "--slider upper.velocity: must be a range" in capsys.readouterr().err


@pytest.fixture(scope="module")
def browser():
    """Chromium."""
    playwright = pytest.importorskip("playwright.sync_api", reason="needs tribo[browser]")
    if CHROMIUM is None:
        pytest.skip("needs Chromium")
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=CHROMIUM, args=ARGUMENTS)
        yield browser
        browser.close()


@pytest.fixture
def tab(browser):
    """A page, without a message or an error of its scripts at the end."""
    tab = browser.new_page()
    problems = []
    tab.on("console", lambda message: problems.append(message.text))
    tab.on("pageerror", lambda error: problems.append(str(error)))
    yield tab
    tab.close()
    assert problems == []


# Moves a slider 20 times within one task, and waits for the picture at the last value.
MOVES = """([key, last]) => new Promise((resolve, reject) => {
  setTimeout(() => reject(new Error("no picture of the last value")), 20000);
  const slider = document.querySelector(`[data-key="${key}"]`);
  const player = document.querySelector(".tribo");
  const began = performance.now();
  let wanted = null;
  player.addEventListener("tribo-shown", function seen({ detail }) {
    if (detail[key] !== wanted) return;
    player.removeEventListener("tribo-shown", seen);
    resolve([detail[key], performance.now() - began]);
  });
  for (let k = 20; k >= 0; k -= 1) {
    slider.value = last + k * Number(slider.step);
    slider.dispatchEvent(new Event("input"));
  }
  wanted = Number(slider.parentElement.querySelector("output").textContent);
})"""


def assert_end(tab, scene, values):
    """The page has the values of the end of a run, to the digits shown."""
    tab.keyboard.press("End")
    tab.wait_for_timeout(200)
    result = tribo.simulate(with_values(scene, values))
    for name in ("w1", "w1_ps", "w2", "W", "delta_E_int"):
        cell = tab.locator(f'td[data-quantity="{name}"][data-column="shown"]')
        want = np.ravel(result["upper"][name][-1])[0]
        assert_same(cell.inner_text(), want)


def test_served_sliders_in_a_browser(server, tab):
    """20 fast moves end at the last value; requests go to the server alone."""
    requests = []
    tab.on("request", lambda request: requests.append(request.url))
    tab.goto(server.url)
    value, _ = tab.evaluate(MOVES, ["interaction.strength", 0.3])
    assert value == pytest.approx(0.3, abs=0.005)
    assert_end(tab, SCENE, {"interaction.strength": value})
    tab.locator('[data-key="upper.drive"]').select_option(label="free")
    tab.wait_for_timeout(1000)
    assert_end(tab, SCENE, {"interaction.strength": value, "upper.drive": "free"})
    assert {url.partition("?")[0] for url in requests} <= {
        f"http://{server.host}/",
        f"http://{server.host}/run",
        "data:,",
    }
    assert len([url for url in requests if url.endswith("/run")]) < 20


def page_of_grid(folder, *sliders):
    """The page of the scene with these sliders, which `tribo view` writes."""
    scene = folder / "a.toml"
    SCENE.save(scene)
    options = [part for slider in sliders for part in ("--slider", slider)]
    assert main(["view", str(scene), *options]) == 0
    return folder / "a.html"


def test_a_grid_in_a_browser(tab, tmp_path):
    """The page without Python does the same; a kept run stays beside."""
    tab.goto(page_of_grid(tmp_path, "upper.velocity=0.1:2.1").as_uri())
    tab.locator("[data-part=keep]").click()
    value, _ = tab.evaluate(MOVES, ["upper.velocity", 12])
    assert value == 0.7
    assert_end(tab, SCENE, {"upper.velocity": 0.7})
    kept = tab.locator('td[data-quantity="w1"][data-column="kept"]').inner_text()
    want = tribo.simulate(SCENE)["upper"]["w1"][-1, 0]
    assert_same(kept, want)
    names = tab.locator("tbody label").all_inner_texts()
    assert {"w1", "w1,ps", "ΔEint", "friction work", "friction force"} <= set(names)


def test_keys_from_any_control(tab, tmp_path):
    """Home and End go to the start and the end, but for a slider of a value, where Space plays."""
    choices = {"interaction.strength": "0.1,0.2", "upper.drive": "forced,free"}
    given = [f"{key}={values}" for key, values in choices.items()]
    tab.goto(page_of_grid(tmp_path, *given).as_uri())
    parts = [f"[data-part={part}]" for part in ("play", "speed", "forces", "group", "time", "keep")]
    for control in (*parts, *(f'[data-key="{key}"]' for key in choices)):
        tab.locator(control).focus()
        for key, t in (("End", 40.0), ("Home", 0.0)):
            tab.keyboard.press(key)
            tab.wait_for_timeout(100)
            now = float(tab.locator("[data-part=time]").input_value())
            assert now == (0.0 if control == '[data-key="interaction.strength"]' else t)
    slider = tab.locator('[data-key="interaction.strength"]')
    slider.focus()
    tab.keyboard.press("End")
    assert slider.input_value() == "1"
    tab.keyboard.press("Space")
    tab.wait_for_timeout(300)
    assert float(tab.locator("[data-part=time]").input_value()) > 0.0


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [380, 1300])
def test_accessible(browser, server, scheme, width):
    """No findings of axe, and nothing that is wider than the window."""
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="needs axe")
    context = browser.new_context(
        viewport={"width": width, "height": 900},
        color_scheme=scheme,
        reduced_motion="reduce",
        bypass_csp=True,
    )
    tab = context.new_page()
    tab.goto(server.url)
    tab.locator("[data-part=keep]").click()
    tab.wait_for_timeout(300)
    found = axe.Axe().run(tab)
    wide = tab.evaluate("document.documentElement.scrollWidth")
    table = tab.locator(".table").evaluate("(each) => each.scrollWidth - each.clientWidth")
    context.close()
    assert found.violations_count == 0, found.generate_report()
    assert wide <= width and table <= 0


def test_reduced_motion(browser, tmp_path):
    """Nothing moves by itself, also where motion is welcome; every control goes there at once."""
    page = tribo.simulate(SCENE).to_html(tmp_path / "a.html")
    for motion in ("reduce", "no-preference"):
        context = browser.new_context(reduced_motion=motion)
        tab = context.new_page()
        tab.goto(page.as_uri())
        tab.wait_for_timeout(200)
        before = tab.screenshot()
        tab.wait_for_timeout(800)
        assert tab.screenshot() == before
        assert tab.evaluate("document.getAnimations().length") == 0
        tab.locator("[data-part=play]").focus()
        tab.keyboard.press("End")
        tab.wait_for_timeout(300)
        after = tab.screenshot()
        tab.wait_for_timeout(400)
        assert tab.screenshot() == after != before
        context.close()


def test_widget():
    """A widget begins with the run, and answers messages with runs or sentences."""
    pytest.importorskip("anywidget", reason="needs tribo[notebook]")
    widget = tribo.play(SCENE, {"upper.velocity": (0.1, 2.0)})
    assert widget.source["sliders"][0]["key"] == "upper.velocity"
    sent = []
    widget.send = sent.append
    widget._answer(widget, {"upper.velocity": 1.0}, [])
    widget._answer(widget, {"upper.velocity": 3.0}, [])
    want = tribo.simulate(with_values(SCENE, {"upper.velocity": 1.0}))["upper"]["w1"][-1, 0]
    assert f"{end_of(sent[0]['run'], 'w1'):.6g}" == f"{want:.6g}"
    assert "must be from 0.1 to 2" in sent[1]["error"]
    assert tribo.simulate(SCENE).widget().source["sliders"] == []


def test_the_module_with_a_model(tab):
    """The module that anywidget loads shows a model's run, and asks it for others."""
    from tribo.viewer.html import module, part

    playing = Playing(SCENE, sliders_of(SCENE, {"upper.velocity": (0.1, 2.0)}))
    tab.expose_function("simulated", playing.run)
    tab.set_content(f"<style>{part('style.css')}</style><div id=here></div>")
    tab.evaluate(
        """async ([text, source]) => {
          const code = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
          const { default: widget } = await import(code);
          let answer = null;
          const model = {
            get: () => source,
            on: (_, callback) => { answer = callback; },
            send: async (values) => answer({ run: await window.simulated(values) }),
          };
          widget.render({ model, el: document.getElementById("here") });
        }""",
        [module(), playing.source()],
    )
    value, _ = tab.evaluate(MOVES, ["upper.velocity", 1.05])
    tab.locator("[data-part=play]").focus()
    assert_end(tab, SCENE, {"upper.velocity": value})
