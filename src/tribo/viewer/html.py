"""The page: one HTML document with its style, the module that shows runs, and their data."""

from html import escape
from importlib.resources import files
from typing import Any

from tribo.files import strict_json

# The scripts of the module, in the order in which they need one another.
SCRIPTS = (
    *("symbols.js", "run.js", "drawing.js", "curves.js"),
    *("sources.js", "sliders.js", "player.js"),
)
# What all pages begin with, up to their body.
HEAD = """\
<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; {policy}">
<title>{title}</title>
<link rel="icon" href="data:,">
<style>
{style}
</style>
</head>
"""
PAGE = """\
<body class="page">
<main id="player"></main>
<script type="application/json" id="data">{data}</script>
<script type="module">
{module}
const data = JSON.parse(document.getElementById("data").textContent);
mount(document.getElementById("player"), {{ ...{source}(data), isPage: true }});
</script>
</body>
</html>
"""
# What the page may do, and the function of sources.js that reads its data.
HELD = ("style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:", "heldRuns")
SERVED = (f"{HELD[0]}; connect-src 'self'", "servedRuns")


def part(name: str) -> str:
    return files("tribo.viewer").joinpath("parts", name).read_text(encoding="utf-8")


def module() -> str:
    """The JavaScript module, whose default export is what anywidget asks for."""
    exports = "export { mount };\nexport default { render };"
    return "\n".join(['"use strict";', *map(part, SCRIPTS), exports])


def document(source: dict[str, Any], kind: tuple[str, str] = HELD) -> str:
    """The page that shows a source as text; `kind` is `HELD` or `SERVED`.

    The source contains "run", "sliders" and, where the page holds all runs, "runs", as the module
    reads them.
    """
    policy, reader = kind
    return (HEAD + PAGE).format(
        policy=policy,
        title=escape(source["run"]["title"]),
        style=part("style.css"),
        # "<" would end the script that holds the data; JSON may write it as an escape.
        data=strict_json(source, None).replace("<", "\\u003c"),
        module=module(),
        source=reader,
    )


def frame(page: str, title: str, height: int) -> str:
    """A page in a frame of a notebook's cell, `height` pixels high."""
    return (
        f'<iframe srcdoc="{escape(page, quote=True)}" title="{title}" style="width: 100%; '
        f'height: {height}px; border: 0" allow="clipboard-write"></iframe>'
    )
