"""Live pages in the documents: the scenes that they show, and the directive that shows one.

A Sphinx extension.  ``{live} case_a`` is a frame with the page of that name and its caption; the
pages are written when the documents are built, into ``live/`` beside them.
"""

import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

from docutils import nodes
from docutils.parsers.rst import Directive, directives
from sphinx.application import Sphinx

import tribo

HERE = Path(__file__).resolve().parent
FOLDER = HERE / "_generated" / "live"
# Height of a frame [px], in which drawing, curves and the first controls have room.
HEIGHT = 620


class LiveScene(NamedTuple):
    """A scene, and the controls of its page."""

    scene: tribo.Scene
    controls: dict[str, Any] | None = None


def _case(name: str, panel: str | None = None) -> LiveScene:
    """A case of the paper with the usual controls, and the panel that its page opens with."""
    return LiveScene(tribo.paper.scene(name), None if panel is None else {"panel": panel})


def _with(potential: tribo.Potential, title: str, gap: float) -> LiveScene:
    """Forced sliding with another potential, at a gap between the paths of the bobs."""
    scene = tribo.paper.scene("A")
    upper, lower = scene.surfaces
    surfaces = (replace(upper, bob=(-10.0, gap)), lower)
    return LiveScene(replace(scene, surfaces=surfaces, interactions=(potential,), title=title))


# The pages by their names.  Each class of potential takes half a minute to compile, once.
PAGES = {
    **{f"case_{name.lower()}": (lambda name=name: _case(name)) for name in "ABCDE"},
    "start": lambda: LiveScene(
        tribo.paper.scene("A"),
        {
            "title": "Two asperites",
            "upper.velocity": [0.3, 2.0],
            "interaction.strength": [-0.6, 0.6],
            "upper.bob.1": None,
            "*.asperite.kappa": None,
            "panel": "Energy",
        },
    ),
    "frames": lambda: _case("A", "Numbers"),
    "starts": lambda: _case("A", "Many starts"),
    "heat": lambda: _case("A", "Energy"),
    "direction": lambda: LiveScene(
        tribo.paper.scene("A"),
        {
            "*.swing": {"range": [-1.0, 1.0], "label": "swing of both pendulums"},
            "interaction.strength": None,
        },
    ),
    "lennard_jones": lambda: _with(tribo.LennardJones(0.1, 0.5), "Lennard-Jones", 0.6),
    "morse": lambda: _with(tribo.Morse(0.2, 1.5, 0.8), "Morse", 0.5),
    "yukawa": lambda: _with(tribo.Yukawa(0.3, 0.5), "Yukawa", 0.0),
    "gaussian": lambda: _with(tribo.potentials.Gaussian(0.3, 0.5), "Gaussian", 0.0),
}


def write(folder: Path) -> None:
    """Write all pages into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, made in PAGES.items():
        page = made()
        page.scene.to_live_html(folder / f"{name}.html", page.controls)


class Live(Directive):
    """A frame with a live page, a link to it, and a caption as the content."""

    required_arguments = 1
    option_spec: ClassVar = {"height": directives.positive_int}
    has_content = True

    def run(self) -> list[nodes.Node]:
        """The nodes of the frame."""
        (name,) = self.arguments
        if name not in PAGES:
            raise self.error(f"no live page is named {name}; there are {', '.join(PAGES)}")
        document = self.state.document.settings.env.docname
        address = f"{'../' * document.count('/')}live/{name}.html"
        height = self.options.get("height", HEIGHT)
        caption = nodes.paragraph()
        self.state.nested_parse(self.content, self.content_offset, caption)
        frame = (
            f'<iframe class="live" src="{address}" loading="lazy" height="{height}" '
            f'title="Live page: {name.replace("_", " ")}" allow="clipboard-write"></iframe>'
            f'<p class="live-link"><a href="{address}">Open this page alone</a></p>'
        )
        return [nodes.raw("", frame, format="html"), *caption.children]


def copy(app: Sphinx, error: Exception | None) -> None:
    """Copy the pages beside the documents."""
    if error is None and app.builder.format == "html":
        shutil.copytree(FOLDER, Path(app.outdir) / "live", dirs_exist_ok=True)


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("live", Live)
    app.connect("build-finished", copy)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
