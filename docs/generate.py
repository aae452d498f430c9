"""What the pages take from the package: figures, the paper's table, and tables of names.

All of it is generated again when a source of the package has changed, so the pages cannot be older
than the code: figures that the pages' own code draws, the paper's numbers beside the computed ones,
and tables of methods, effects, statuses and files.
"""

import ast
import logging
import re
import shutil
from collections.abc import Iterable
from dataclasses import fields
from pathlib import Path

import atlas_tables
import measure_accuracy
import measure_effects
import notebooks
import page_code
import slip as slip_page

import tribo
from tribo import paper, plotting, potentials, units
from tribo.compiler.jit import package_stamp
from tribo.integrators import methods
from tribo.kernels.status import MEANINGS
from tribo.model import roughness
from tribo.model.effects import Effect
from tribo.paper import figures as paper_figures
from tribo.potentials import LennardJones
from tribo.report_card import check

HERE = Path(__file__).resolve().parent
PUBLIC_PARTS = (paper, plotting, potentials, units)
PAGES_WITH_PICTURES = [
    *notebooks.PAGES,
    *(HERE / "how-to" / f"{name}.md" for name in ("afm", "ensembles")),
]


def everything(folder: Path) -> None:
    """Fill the folder, unless it was filled from the same sources and pages."""
    stamp = folder / "stamp"
    own = [*HERE.glob("*.py"), *HERE.glob("measured/*.json"), *PAGES_WITH_PICTURES]
    now = package_stamp() + "".join(file.read_text(encoding="utf-8") for file in sorted(own))
    if stamp.exists() and stamp.read_text(encoding="utf-8") == now:
        return
    logging.getLogger("fontTools").setLevel(logging.WARNING)  # it logs every glyph of a PDF
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    documented_keys(HERE / "reference" / "scene_file.md")
    documented_names(HERE / "reference" / "api.md")
    for page in PAGES_WITH_PICTURES:
        page_code.run(page, folder)
    for page in notebooks.PAGES:
        notebooks.write(page, folder)
    report_cards(folder)
    paper_figures.draw(folder, paper.CASES)
    atlas_tables.figure(folder / "atlas.png")
    measure_effects.figure(folder / "effects.png")
    tables = paper.compare(paper.CASES)
    (folder / "paper.txt").write_text(paper.report(tables) + "\n", encoding="utf-8")
    for name, rows in {
        "agreement": agreement(tables),
        "methods": table_of_methods(),
        "effects": table_of_effects(),
        "statuses": table_of_statuses(),
        "chosen": measure_accuracy.chosen(),
        "evaluations": measure_accuracy.evaluations(),
        "files": table_of_files(),
        "effect_costs": measure_effects.costs(),
        "by_hand": measure_effects.by_hand(),
        "atlas": atlas_tables.outcomes(),
        **{f"atlas_{kind}": atlas_tables.by_method(kind) for kind in atlas_tables.KINDS},
        "atlas_stability": atlas_tables.stability(),
    }.items():
        (folder / f"{name}.md").write_text(markdown(rows), encoding="utf-8")
    stamp.write_text(now, encoding="utf-8")


def report_cards(folder: Path) -> None:
    """The two report cards on their page: one that passes, and one that fails."""
    report = check(LennardJones(1.0, 1.0).with_cutoff(2.5))
    report.save_figure(folder / "card.png")
    slip = check(slip_page.Ions(1.0))
    if not report.passed or slip["force"].passed:
        raise AssertionError("report_card.md shows a card that passes and one that fails")
    for name, card in {"card": report, "slip": slip}.items():
        (folder / f"{name}.txt").write_text(f"{card}\n", encoding="utf-8")


def markdown(rows: Iterable[Iterable[str]]) -> str:
    """A table in Markdown; the first row is its head."""
    head, *rest = (list(row) for row in rows)
    lines = [head, ["---"] * len(head), *rest]
    return "".join("| " + " | ".join(cells) + " |\n" for cells in lines)


def agreement(tables: dict[str, list[paper.Row]]) -> Iterable[Iterable[str]]:
    """How many of the printed numbers agree, case by case."""
    yield "case", "", "numbers printed", "agree"
    for case, rows in tables.items():
        yield case, paper.CASES[case], str(len(rows)), str(sum(row.agrees for row in rows))


def table_of_methods() -> Iterable[Iterable[str]]:
    """Every method and what it is good for."""
    yield "method", "order", "steps", "good for", "source"
    for method in methods.METHODS.values():
        steps = "chooses its own" if method.adaptive else "equal"
        yield f"`{method.name}`", str(method.order), steps, method.use, method.source


def table_of_effects() -> Iterable[Iterable[str]]:
    """Every effect by its name."""
    yield "effect", ""
    for effect in Effect:
        yield f"`{effect}`", effect.description


def table_of_statuses() -> Iterable[Iterable[str]]:
    """Every way in which a run ends."""
    yield "status", ""
    for name, meaning in MEANINGS.items():
        yield f"`{name}`", meaning


def table_of_files() -> Iterable[Iterable[str]]:
    """Every file of the package and the first sentence of its docstring."""
    yield "file", ""
    root = Path(tribo.__file__).parent
    files = [file for file in root.rglob("*.py") if file.read_text(encoding="utf-8")]
    for file in sorted(files, key=lambda f: (len(f.relative_to(root).parts), f)):
        doc = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
        first = re.split(r"(?<=\.)\s|\n\n", doc)[0].rstrip(":.")
        yield f"`{file.relative_to(root)}`", re.sub(r"\s+", " ", first).replace("|", "\\|")


def documented_keys(page: Path) -> None:
    """Raise AssertionError if a key of scene files is missing in the page."""
    text = page.read_text(encoding="utf-8")
    kinds = (
        *(tribo.Scene, tribo.Surface, tribo.Asperite, tribo.Initial, tribo.Output),
        *(tribo.Numerics, tribo.Springs, tribo.Langevin, tribo.Periodic, roughness.Roughness),
    )
    files_names = {"surfaces": "surface", "interactions": "interaction", "fields": "field"}
    keys = {files_names.get(f.name, f.name) for kind in kinds for f in fields(kind)}
    missing = sorted(key for key in keys if not re.search(rf"`\[*{key}\b", text))
    if missing:
        raise AssertionError(f"{page.name} does not mention {', '.join(missing)}")


def documented_names(page: Path) -> None:
    """Raise AssertionError if a public name is missing in the page."""
    text = page.read_text(encoding="utf-8")
    documented = set(re.findall(r"^\.\. auto\w+:: (?:[\w.]+\.)?(\w+)", text, re.MULTILINE))
    documented |= set(re.findall(r"`(?:[\w.]+\.)?(\w+)`", text))
    public = {name for part in (tribo, *PUBLIC_PARTS) for name in part.__all__}
    missing = sorted(public - documented - {"__version__"})
    if missing:
        raise AssertionError(f"{page.name} does not mention {', '.join(missing)}")
