"""Tables with a column of prose, which are shown as lists of definitions on narrow screens.

A Sphinx extension: marks such tables by the class ``prose``, and writes the head of a column into
each of its cells, which only narrow screens show.
"""

from docutils import nodes
from sphinx.application import Sphinx

# A cell with more letters is prose.
LONG = 48


def mark(app: Sphinx, doctree: nodes.document) -> None:
    """Mark the tables of a page."""
    for table in doctree.findall(nodes.table):
        if any(len(cell.astext()) > LONG for cell in table.findall(nodes.entry)):
            table["classes"].append("prose")
            _add_heads(table)


def _add_heads(table: nodes.table) -> None:
    """Write the heads of the columns into the cells after the first of each row."""
    rows = list(table.findall(nodes.row))
    heads = [cell.astext() for cell in rows[0]]
    if len(heads) < 3:
        return
    for row in rows[1:]:
        for head, cell in list(zip(heads, row, strict=True))[1:]:
            if head and cell.astext().strip():
                cell.insert(0, nodes.paragraph("", f"{head}:", classes=["column-head"]))


def setup(app: Sphinx) -> dict[str, bool]:
    """Mark tables when pages are read."""
    app.connect("doctree-read", mark)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
