"""Which test files use what users do not: names that no page for users shows, and patches.

    python -m tools.internals [FOLDER]   # a line for each file; at the end, how many use what

A name is public if `tribo/__init__.pyi` has it, or if a page for users imports or documents it.
tests/README.md says why the others are used.
"""

import ast
import re
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGES = ("how-to", "tutorials", "lessons", "reference", "explanation")
# Names for which there is a public way.
REPLACEABLE = {
    "tribo.commands.cli.main": "support.command.main, the function that pyproject.toml declares",
    "tribo.model.scene_file.scene_from": "support.scene_tables.scene_from, which writes a file",
    "tribo.validation.InputError": "tribo.InputError",
    "tribo.export.lammps.to_lammps": "tribo.export.to_lammps",
    "tribo.accuracy.scales.EPSILON": "np.finfo(float).eps",
}
# What tests use -> beginnings of the names, the first that fits.
KINDS = {
    "compiled code": (
        "kernels",
        "compiler",
        "lanes",
        "pair",
        "threads",
        "interrupts",
        "integrators",
    ),
    "parts of a run": ("layout", "loops", "ledger", "accuracy", "simulation", "explanation"),
    "members and points": ("ensembles", "sweeps"),
    "keys and scenes": ("model", "sliders", "live_pages", "plugins", "starters", "validation"),
    "single functions of plots, cards and files": ("",),
}
# Tables whose every entry is tried: methods, statuses, effects, quantities, starters, words.
TABLE = re.compile(r"\.[A-Z][A-Z_]+$")


def public_names() -> set[str]:
    """Names that users see, as "tribo.Scene" and "tribo.export.to_lammps"."""
    stub = (ROOT / "src/tribo/__init__.pyi").read_text("utf-8")
    found = {f"tribo.{name}" for name in re.findall(r"(\w+) as \1\b", stub)}
    for page in (path for part in PAGES for path in (ROOT / "docs" / part).glob("*.md")):
        text = page.read_text("utf-8")
        found |= set(re.findall(r"\btribo(?:\.\w+)+", text))
        module = "tribo"
        for line in text.splitlines():
            if match := re.search(r"currentmodule:: (\S+)", line):
                module = match[1]
            if match := re.search(r"auto(?:class|function):: (\w+)(?:\(\))?$", line):
                found.add(f"{module}.{match[1]}")
            if match := re.match(r"from (tribo[\w.]*) import (.+)", line):
                found |= {f"{match[1]}.{name.strip(' ()')}" for name in match[2].split(",")}
    return found


def used(path: Path) -> Iterator[str]:
    """Names of the package that a file imports, and those that it patches by their places."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom) and re.match(r"tribo\b", node.module or ""):
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Import):
            yield from (each.name for each in node.names if each.name.startswith("tribo."))
        elif isinstance(node, ast.Constant) and re.fullmatch(r"tribo(\.\w+)+", str(node.value)):
            yield str(node.value)


def internals(path: Path, public: set[str]) -> list[str]:
    """The names of a file that are not public."""
    return sorted({name for name in used(path) if name not in public})


def kind_of(name: str) -> str:
    """What a name belongs to."""
    if TABLE.search(name):
        return "tables and limits"
    rest = name.removeprefix("tribo.")
    return next(kind for kind, begins in KINDS.items() if rest.startswith(begins))


def main() -> None:
    """Print the names of each test file."""
    folder = ROOT / "tests" / "".join(sys.argv[1:])
    public = public_names()
    files = sorted(folder.rglob("test_*.py"))
    counts: Counter[str] = Counter()
    for path in files:
        names = internals(path, public)
        if names:
            print(f"{path.relative_to(ROOT)}: {', '.join(names)}")
        counts.update({kind_of(name) for name in names})
        counts["any"] += bool(names)
    for kind, count in counts.most_common():
        print(f"{count} of {len(files)} files: {kind}")


if __name__ == "__main__":
    main()
