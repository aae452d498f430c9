"""Time from a slider to the picture, in a page of `tribo play` in headless Chromium.

    python benchmarks/sliders.py [--moves 40] [--json]

For the paper's case A and for rows of 3 on 3: the median and the 90th percentile, over single moves
of the slider of the strength of contact, of the wall time until the picture of the new run is
drawn, and the CPU time of Python for one run.  Needs tribo[browser] and Chromium, and an idle
machine: other work on the cores multiplies the wall times.
"""

import argparse
import json
import shutil
import statistics
import threading
import time
from collections.abc import Callable
from dataclasses import replace

from playwright.sync_api import sync_playwright

import tribo
from tribo.sliders import Playing, sliders_of
from tribo.viewer.server import Server

KEY, RANGE = "interaction.strength", (0.05, 1.0)
ARGUMENTS = ["--no-sandbox", "--disable-gpu"]
# Moves the slider to a value; resolves with the milliseconds until the page has drawn its run.
MOVE = """([key, value]) => new Promise((resolve) => {
  const slider = document.querySelector(`[data-key="${key}"]`);
  const player = document.querySelector(".tribo");
  slider.value = value;
  const began = performance.now();
  slider.dispatchEvent(new Event("input"));
  const wanted = Number(slider.parentElement.querySelector("output").textContent);
  player.addEventListener("tribo-shown", function seen({ detail }) {
    if (detail[key] !== wanted) return;
    player.removeEventListener("tribo-shown", seen);
    resolve(performance.now() - began);
  });
})"""


def scenes() -> dict[str, tribo.Scene]:
    """The paper's case A, and the same with rows of three."""
    one = tribo.paper.scene("A")
    rows = [replace(surface, shape=(3, 1), spacing=(3.0, 0.0)) for surface in one.surfaces]
    return {"case A": one, "3 on 3": replace(one, surfaces=tuple(rows))}


def timed(run: Callable[[object], dict], spent: list[float]) -> Callable[[object], dict]:
    """A run that adds its CPU time to `spent` [ms]."""

    def timed_run(values: object) -> dict:
        began = time.thread_time()
        found = run(values)
        spent.append(1e3 * (time.thread_time() - began))
        return found

    return timed_run


def measured(scene: tribo.Scene, browser: object, moves: int) -> dict[str, float]:
    """Times of a scene [ms]; the first tenth of the moves is left out."""
    playing, spent = Playing(scene, sliders_of(scene, {KEY: RANGE})), []
    with Server(playing.source(), timed(playing.run, spent)) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        tab = browser.new_page()
        tab.goto(server.url)
        low, high = RANGE
        values = [low + (high - low) * (7 * k % moves + 1) / (moves + 1) for k in range(moves)]
        waits = [tab.evaluate(MOVE, [KEY, value]) for value in values][moves // 10 :]
        tab.close()
        server.shutdown()
        thread.join()
    deciles = statistics.quantiles(waits, n=10)
    return {
        "median": statistics.median(waits),
        "90 %": deciles[-1],
        "least": min(waits),
        "CPU of a run": statistics.median(spent),
    }


def main() -> None:
    """Print the times of both scenes."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--moves", type=int, default=40)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=ARGUMENTS)
        found = {n: measured(s, browser, options.moves) for n, s in scenes().items()}
        browser.close()
    if options.json:
        print(json.dumps(found, indent=1))
        return
    for name, times in found.items():
        print(f"{name}: " + ", ".join(f"{what} {value:.0f} ms" for what, value in times.items()))


if __name__ == "__main__":
    main()
