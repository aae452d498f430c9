"""The command `tribo live`: a page that simulates a scene in the browser."""

from __future__ import annotations

import argparse
from pathlib import Path

from tribo.commands import scene_options as shared
from tribo.files import page_target
from tribo.interrupts import COMPLETED


def add_live(live: argparse.ArgumentParser) -> None:
    shared.add_scene(live)
    page = "the page (default: SCENE.html)"
    live.add_argument("-o", "--out", type=Path, metavar="PAGE.html", help=page)
    controls = "a TOML file with keys that have sliders, their ranges and labels, and words"
    live.add_argument("--controls", type=Path, metavar="FILE.toml", help=controls)
    live.set_defaults(command=_live)


def _live(options: argparse.Namespace) -> int:
    from tribo.live_pages.page import to_live_html

    out = shared.page_of(options, "live", "view")
    page_target("--out", out)
    print(to_live_html(shared.load_with_values(options), out, options.controls))
    return COMPLETED
