"""The commands `tribo view` and `tribo play`: a page that plays runs, with or without sliders."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tribo.commands import scene_options as shared
from tribo.files import page_target, replace_file
from tribo.interrupts import COMPLETED, STOPPED, also_in_part, answer
from tribo.validation import InputError, must_be

if TYPE_CHECKING:
    from tribo.model.scene import Scene
    from tribo.result import Result
    from tribo.sliders import Slider


def add_view(view: argparse.ArgumentParser) -> None:
    """Add the arguments and options of `tribo view`."""
    shared.add_scene(view, "SCENE.toml|FILE.nc")
    beside = "a second run, shown beside the first"
    view.add_argument("beside", type=Path, nargs="?", metavar="OTHER", help=beside)
    page = "the page (default: SCENE.html)"
    view.add_argument("-o", "--out", type=Path, metavar="PAGE.html", help=page)
    bath = 'draw bath oscillators; the file of a run must contain the series "oscillators"'
    view.add_argument("--bath", action="store_true", help=bath)
    _add_slider(view, "the page contains the runs of 41 values, or of all combinations of 11 or 5")
    view.set_defaults(command=_view)


def add_play(play: argparse.ArgumentParser) -> None:
    shared.add_scene(play)
    _add_slider(play, "each move simulates the scene again")
    quiet = "print the address, but open no browser"
    play.add_argument("--no-browser", action="store_true", help=quiet)
    play.set_defaults(command=_play)


def _add_slider(command: argparse.ArgumentParser, meaning: str) -> None:
    value = "a value to change, as 'interaction.strength=0.05:1', 'upper.drive=forced,free' or "
    value += "'upper.velocity,duration=[0.25,80],[0.5,40]' for values that change together; may be "
    value += f"repeated; {meaning}"
    command.add_argument("--slider", metavar="KEY=LOW:HIGH", help=value, **shared.REPEATED)


def _sliders(options: argparse.Namespace, scene: Scene) -> list[Slider]:
    """The sliders that are given.  Raises InputError about --slider."""
    from tribo.sliders import sliders_of

    given: dict[str, Any] = {}
    for key, values in shared.by_key("--slider", options.slider).items():
        low, sign, high = values.partition(":")
        if sign:
            given[key] = tuple(shared.as_number(f"--slider {key}", end) for end in (low, high))
        else:
            given[key] = shared.parsed_list(f"--slider {key}", values)
    try:
        return sliders_of(scene, given)
    except InputError as error:
        raise InputError(f"--slider {error.field}", error.problem) from None


def _view(options: argparse.Namespace) -> int:
    """Write a page that plays one run, two side by side, or the runs of sliders."""
    from tribo.viewer.contents import contents
    from tribo.viewer.html import document

    page = shared.page_of(options, "view", "live")
    out = page_target("--out", page)
    if options.slider:
        if options.scene.suffix != ".toml" or options.beside is not None:
            raise InputError("--slider", "needs one scene file")
        from tribo.sliders import grid_page

        scene = shared.load_with_values(options)
        text = grid_page(scene, _sliders(options, scene), options.bath)
        complete = True
    else:
        files = [options.scene] if options.beside is None else [options.scene, options.beside]
        results = [_result(options, file) for file in files]
        complete = all(result.status == "completed" for result in results)
        run, *others = (contents(result, options.bath) for result in results)
        source: dict[str, Any] = {"run": run, "sliders": []}
        if others:
            source["beside"] = {"run": others[0], "name": options.beside.name}
            source["name"] = options.scene.name
        text = document(source)
    replace_file(out, text.encode())
    print(page)
    return COMPLETED if complete else STOPPED


def _result(options: argparse.Namespace, file: Path) -> Result:
    """The result of a scene file, or in the file of a run."""
    from tribo.result import load_result
    from tribo.simulation import simulate
    from tribo.sliders import shown

    if file.suffix != ".toml":
        if options.set:
            raise InputError("--set", "cannot go with the file of a run; give a scene file")
        return load_result(file)
    scene = shared.load_with_values(argparse.Namespace(**vars(options) | {"scene": file}))
    return also_in_part(simulate, shown(scene, options.bath))


def _play(options: argparse.Namespace) -> int:
    """Serve a page with sliders on this machine, whose runs are made when they are asked for."""
    import webbrowser

    from tribo.sliders import Playing
    from tribo.viewer.server import Server

    scene = shared.load_with_values(options)
    sliders = _sliders(options, scene)
    if not sliders:
        raise must_be("--slider", "given, as --slider interaction.strength=0.05:1", "none")
    playing = Playing(scene, sliders)
    with Server(playing.source(), playing.run) as server:
        print(f"{server.url}\nCtrl-C ends it", flush=True)
        if not options.no_browser:
            webbrowser.open(server.url)
        try:
            server.serve_forever(poll_interval=0.1)
        except KeyboardInterrupt:
            answer()
            print(file=sys.stderr)
    return COMPLETED
