"""Formulas as MathML, which browsers draw without scripts, fonts or a network.

A Sphinx extension: a math renderer that converts LaTeX when the pages are built.
"""

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.writers.html5 import HTML5Translator

LOGGER = logging.getLogger(__name__)


def mathml(node: nodes.Element, display: str) -> str:
    """The formula of a node; warns of commands that latex2mathml does not know."""
    formula = convert(node.astext().replace("{aligned}", "{align*}"), display=display)
    if "\\" in formula or "<mi>&</mi>" in formula:
        LOGGER.warning("not converted to MathML: %s", node.astext(), location=node)
    return formula


def inline(page: HTML5Translator, node: nodes.Element) -> None:
    """Write a formula in a line of text."""
    page.body.append(mathml(node, "inline"))
    raise nodes.SkipNode


def block(page: HTML5Translator, node: nodes.Element) -> None:
    """Write a formula between paragraphs; wide ones scroll on narrow screens."""
    page.body.append(f'<div class="math">{mathml(node, "block")}</div>')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the renderer as ``mathml``."""
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
