"""Live pages: one HTML file with a scene, the module that simulates it, and what shows it."""

from __future__ import annotations

from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from tribo.files import page_target, replace_file, strict_json
from tribo.live_pages.source import source_of
from tribo.model.scene import Scene
from tribo.simulation import simulate
from tribo.validation import as_path
from tribo.viewer.html import HEAD, frame
from tribo.viewer.html import part as viewer_part

# The scripts, in the order in which they need one another; those of the viewer first.  A worker has
# those in WORKER alone.
OF_VIEWER = ("symbols.js", "run.js", "drawing.js", "curves.js")
SCRIPTS = (
    *("machine.js", "lattice.js", "state.js", "runs.js", "panels.js", "worker.js"),
    *("end_panel.js", "starts_panel.js", "files_panel.js", "energy_panel.js", "numbers_panel.js"),
    *("body.js", "controls.js", "tabs.js", "curve_choices.js", "dragging.js", "status.js"),
    *("interface.js", "laws.js", "page.js"),
)
WORKER = ("machine.js",)
POLICY = (
    "style-src 'unsafe-inline'; script-src 'unsafe-inline' 'wasm-unsafe-eval' "
    "blob:; worker-src blob:; img-src data: blob:"
)
PAGE = """\
<body class="page">
<main id="live"></main>
<noscript>This page simulates its scene, which needs JavaScript. {picture}</noscript>
<script type="application/json" id="data">{data}</script>
<script type="module">
"use strict";
{module}
const source = JSON.parse(document.getElementById("data").textContent);
await startPages(document.getElementById("live"), source);
</script>
</body>
</html>
"""
# Height of a page in a notebook [pixels].
FRAME_HEIGHT = 760
# The stored picture: its size, and the works in it with their colours.
WIDTH = 720
HEIGHT = 300
DRAWN = {"w1": "#0b62a4", "w1_ps": "#0b62a4", "w2": "#d55e00", "w2_ps": "#d55e00"}


def live_part(name: str) -> str:
    return files("tribo.live_pages").joinpath("parts", name).read_text(encoding="utf-8")


def document(scene: Scene, controls: object = None) -> str:
    """The live page of a scene as text; see :func:`to_live_html`."""
    source = source_of(scene, controls)
    source["script"] = "\n".join(map(live_part, WORKER))
    picture = source["picture"] = _picture(scene, source["subject"])
    return (HEAD + PAGE).format(
        policy=POLICY,
        title=escape(source["title"]),
        style="\n".join([viewer_part("style.css"), live_part("live.css")]),
        picture=picture,
        # "<" would end the script that holds the data; JSON may write it as an escape.
        data=strict_json(source, None).replace("<", "\\u003c"),
        module="\n".join([*map(viewer_part, OF_VIEWER), *map(live_part, SCRIPTS)]),
    )


def to_live_html(scene: Scene, path: str | Path, controls: object = None) -> Path:
    """Write a page that simulates a scene in the browser: one file that loads nothing else.

    Parameters
    ----------
    scene : Scene
        Up to 200 asperites, with any potential: one on one, or rows and grids with any drive,
        springs, fields, loads, schedules and baths; without reservoirs, elastic bodies and
        calculators.
    path : str or Path
        The file, which is replaced if it exists.
    controls : mapping or str or Path, optional
        The values that have sliders, in their order: key -> range (low, high), or None for the
        usual one, or a table with `range` and `label`; beside them "title", "introduction" and
        "questions" in Markdown, and "panel", the panel that is open at first: "End value",
        "Energy", "Numbers", "Many starts" or "Files".  "interaction" offers other potentials: a
        table whose `values` have potentials by the words for them, and beside it `label` and `own`,
        the words for the choice and for the scene's own potential.  Or the name of a TOML file
        with the same.  By default the strength of the force, the gap, the velocity, stiffness,
        masses, length, drive and duration.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        If the scene cannot go into a page, a key or a range cannot be used, or the file cannot be
        written.
    """
    target = page_target("path", as_path(path))
    replace_file(target, document(scene, controls).encode())
    return as_path(path)


class LivePage:
    """A live page in a notebook."""

    def __init__(self, text: str) -> None:
        self._text = text

    def _repr_html_(self) -> str:
        return frame(self._text, "live page", FRAME_HEIGHT)


def live(scene: Scene, controls: object = None) -> LivePage:
    """Show a scene in a notebook as a page that simulates it in the browser.

    Parameters and errors are those of :func:`to_live_html`.
    """
    return LivePage(document(scene, controls))


def _picture(scene: Scene, surface: int) -> str:
    """Works of the run of the scene's own values, for browsers that cannot simulate."""
    result = simulate(scene, progress=False)
    table: Any = result[scene.surfaces[surface].name]
    series = {name: np.asarray(table[name])[:, 0] for name in DRAWN}
    low = min(0.0, *(float(np.min(each)) for each in series.values()))
    high = max(0.0, *(float(np.max(each)) for each in series.values()))
    span = (high - low) or 1.0
    duration = float(result.t[-1]) or 1.0
    every = max(1, len(result.t) // 100)
    lines = []
    for name, values in series.items():
        x = WIDTH * result.t[::every] / duration
        y = HEIGHT * (high - values[::every]) / span
        points = " ".join(f"{a:.0f},{b:.0f}" for a, b in zip(x, y, strict=True))
        dash = ' stroke-dasharray="6 4"' if name.endswith("_ps") else ""
        lines.append(
            f'<polyline points="{points}" fill="none" stroke="{DRAWN[name]}" stroke-width="2"'
            f"{dash}><title>{name}</title></polyline>"
        )
    label = f"works of friction and drive over time, from {low:.3g} to {high:.3g}"
    frame = f'viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{label}"'
    return f"<svg {frame}>{''.join(lines)}</svg>"
