"""A Jupyter kernel shows what tribo draws, and its objects briefly."""

import base64

import pytest

SCENE = """\
import tribo
scene = tribo.paper.scene("A")
result = tribo.simulate(scene)
"""
BRIEF = "scene, scene.surfaces[0], tribo.explain(scene)"
DRAWN = ('result.plot.work("upper")', "result.plot.sequence()", "result.plot.overview()")


@pytest.mark.parametrize("inline", [pytest.param(False, marks=pytest.mark.slow), True])
def test_bare_plots_are_shown(inline):
    """Once each, with and without matplotlib's backend for notebooks; Axes in a page's width."""
    nbformat = pytest.importorskip("nbformat", reason="needs nbclient")
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    sources = ["%matplotlib inline" if inline else "pass", SCENE, *DRAWN, BRIEF]
    cells = [nbformat.v4.new_code_cell(source) for source in sources]
    book = nbclient.NotebookClient(nbformat.v4.new_notebook(cells=cells), timeout=600).execute()
    shown = [cell.outputs for cell in book.cells]
    assert shown[0] == []
    for (output,) in shown[2:5]:
        assert base64.b64decode(output.data["image/png"]).startswith(b"\x89PNG")
    for (output,) in shown[2:4]:
        assert 300 < output.metadata["image/png"]["width"] < 900
    (brief,) = shown[5]
    text = brief.data["text/plain"]
    assert len(text) < 2000 and "<Scene" in text and "<Surface" in text
