"""Links of Markdown lead to files and headings that exist, and commands name scripts and tests."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGES = [
    *ROOT.glob("*.md"),
    *ROOT.glob(".github/**/*.md"),
    *(p for p in ROOT.glob("docs/**/*.md") if not {"_build", "_generated"} & set(p.parts)),
]
LINK = re.compile(r"\]\(([^)\s]+)\)")


def anchors(page):
    """The anchors of the headings of a page, as GitHub, MyST and docutils make them."""
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    titles = re.findall(r"^#+ (.*)$", text, re.M)
    plain = [re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", title).lower() for title in titles]
    explicit = set(re.findall(r"^\(([\w-]+)\)=$", text, re.M))
    of_docutils = {re.sub(r"[^a-z0-9]+", "-", title).strip("-") for title in plain}
    of_github = {re.sub(r"[^\w\- ]", "", title).replace(" ", "-") for title in plain}
    return explicit | of_docutils | of_github


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page):
    """Those that stay inside the checkout."""
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    for target in LINK.findall(text):
        file, _, anchor = target.partition("#")
        if ":" in file or file.startswith("/_generated"):
            continue
        found = page.parent / file if file else page
        assert found.exists(), f"{target}: no such file"
        assert not anchor or anchor in anchors(found), f"{target}: no such heading"


FOLDERS = r"\.ci|tests|tools|docs|benchmarks|examples"
# A file, and after it the name of a test.
NAMED = re.compile(rf"(?<![\w/.-])((?:{FOLDERS})/[\w./-]*\w)(?:::(\w+))?")
# Python that a page runs in a shell.
RUN = re.compile(rf"python ((?:{FOLDERS})/[a-z\d_/]+\.py)()")
MADE = {"docs/_build", "docs/_generated"}
SCRIPTS = [*sorted(ROOT.glob(".ci/*")), *sorted(ROOT.glob(".github/workflows/*.yml"))]


@pytest.mark.parametrize("text", [*SCRIPTS, *PAGES], ids=lambda text: str(text.relative_to(ROOT)))
def test_commands_name_what_exists(text):
    """Scripts, workflows and pages run no file and no test that is missing."""
    pattern = RUN if text.suffix == ".md" else NAMED
    for name, test in pattern.findall(text.read_text(encoding="utf-8")):
        path = ROOT / name
        assert name in MADE or path.exists(), f"{name}: no such file"
        assert not test or f"def {test}(" in path.read_text(encoding="utf-8"), f"{name}: no {test}"
