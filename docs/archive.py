"""Pack the built pages as one zip, and print the tutorials as one PDF.

    python docs/archive.py [FOLDER]      (dist)

Run it after `.ci/docs`.  The PDF needs Chromium.
"""

import html
import re
import shutil
import subprocess
import sys
from pathlib import Path

import tribo

HERE = Path(__file__).resolve().parent
BUILT = HERE / "_build"
# Programs that print a page.
BROWSERS = ("chromium", "chromium-browser", "google-chrome")

STYLE = """
@page { size: A4; margin: 18mm 16mm; }
body { font-size: 10pt; }
section.tutorial { break-before: page; }
pre { white-space: pre-wrap; break-inside: avoid; }
img { max-width: 100%; max-height: 125mm; object-fit: contain; break-inside: avoid; }
a:not([href]) { color: inherit; }
h1, h2, h3 { break-after: avoid; }
a.headerlink, button.copybtn { display: none; }
"""


def archive(folder: Path) -> None:
    """Write the zip and the PDF into the folder, and print their names and sizes."""
    folder.mkdir(parents=True, exist_ok=True)
    name = f"tribo-{tribo.__version__}"
    pages = folder / f"{name}-html"
    shutil.copytree(BUILT, pages, ignore=shutil.ignore_patterns(".*"), dirs_exist_ok=True)
    packed = shutil.make_archive(str(pages), "zip", folder, pages.name)
    shutil.rmtree(pages)
    printed = folder / f"{name}-tutorials.pdf"
    # Beside the pages, whose pictures and styles it takes.
    joined = BUILT / "tutorials" / "all.html"
    joined.write_text(joined_page(BUILT / "tutorials", tutorials()), encoding="utf-8")
    try:
        print_page(joined, printed)
    finally:
        joined.unlink()
    for file in (Path(packed), printed):
        print(f"{file}: {file.stat().st_size / 1e6:.1f} MB")


def tutorials() -> list[str]:
    """The names of the tutorials in the order of their table of contents."""
    text = (HERE / "tutorials" / "index.md").read_text(encoding="utf-8")
    return re.search(r"^:::\{toctree\}\n:hidden:\n\n(.*?)\n:::", text, re.M | re.S)[1].split()


def joined_page(folder: Path, names: list[str]) -> str:
    """One page of the articles of several; only links to other sites are kept."""
    articles = []
    titles = []
    for name in names:
        text = (folder / f"{name}.html").read_text(encoding="utf-8")
        article = re.search(r"<article[^>]*>(.*?)</article>", text, re.DOTALL)[1]
        article = re.sub(r'(<a\b[^>]*?) href="(?!https?:)[^"]*"', r"\1", article)
        articles.append(f'<section class="tutorial">{article}</section>')
        titles.append(re.search(r"<title>(.*?) - tribo</title>", text)[1])
    head = re.search(r"<head>(.*?)</head>", text, re.DOTALL)[1]
    head = re.sub(r"<title>.*?</title>", "", head)
    contents = "".join(f"<li>{title}</li>" for title in titles)
    version = html.escape(tribo.__version__)
    return (
        f'<!doctype html><html lang="en"><head>{head}<title>tribo {version}: tutorials</title>'
        f'<style>{STYLE}</style></head><body data-theme="light">'
        f"<h1>tribo {version}: tutorials</h1><ol>{contents}</ol>{''.join(articles)}</body></html>"
    )


def print_page(page: Path, printed: Path) -> None:
    """Print a page as a PDF."""
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser is None:
        sys.exit(f"the PDF needs one of {', '.join(BROWSERS)}")
    command = [browser, "--headless", "--no-sandbox", "--no-pdf-header-footer"]
    command += [f"--print-to-pdf={printed}", page.as_uri()]
    subprocess.run(command, check=True, capture_output=True)


if __name__ == "__main__":
    archive(Path(sys.argv[1] if len(sys.argv) > 1 else HERE.parent / "dist").resolve())
