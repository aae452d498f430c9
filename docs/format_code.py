"""Format the Python of pages with lines of 80 columns, which fit the pages without scrolling.

    python docs/format_code.py [PAGE.md ...]      all pages without an argument

Needs ruff.  Comments and long strings keep their length.
"""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
COLUMNS = 80
BLOCK = re.compile(r"(?<=^```python\n)((?:.*\n)*?)(?=^```$)", re.MULTILINE)


def formatted(code: str) -> str:
    """A program in the style of the project, with shorter lines."""
    command = ["ruff", "format", f"--line-length={COLUMNS}", "--stdin-filename=page.py", "-"]
    python = [sys.executable, "-m", *command]
    return subprocess.run(
        python, input=code, capture_output=True, text=True, check=True, cwd=ROOT
    ).stdout


def format_page(page: Path) -> bool:
    """Format the blocks of a page; whether it has changed."""
    text = page.read_text(encoding="utf-8")
    new = BLOCK.sub(lambda found: formatted(found[1]), text)
    page.write_text(new, encoding="utf-8")
    return new != text


if __name__ == "__main__":
    chosen = [Path(name) for name in sys.argv[1:]]
    pages = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]
    for each in chosen or [p for p in pages if not {"_build", "_generated"} & set(p.parts)]:
        if format_page(each):
            print(each.relative_to(ROOT) if each.is_absolute() else each)
