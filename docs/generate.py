"""What the pages take from the package: figures, the paper's table, and tables of names.

Each part is made again when a source of the package, or of the part itself, has changed (of a
page, the code in it), so the pages cannot be older than the code: figures that the pages' own code
draws, the paper's numbers beside the computed ones, and tables of methods, effects, statuses and
files.  Two parts are made at the same time; the longest begin first, or those that come first in
`parts` where no time is known.
"""

import ast
import hashlib
import json
import logging
import multiprocessing
import re
import shutil
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import fields
from pathlib import Path
from typing import Any, NamedTuple

import atlas_tables
import house
import live_frames
import measure_accuracy
import measure_effects
import notebooks
import page_code
import slip as slip_page

import tribo
from tribo import paper, plotting, potentials, units
from tribo.compiler.source_stamps import package_stamp
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
    *(HERE / "how-to" / f"{name}.md" for name in ("afm", "ensembles", "schedules")),
]


# In the folder of the parts, the stamp and the time of each.
STAMPS = "stamps.json"
# Parts that are made at the same time.
PROCESSES = 2
# Seconds of a part that has not been made before, and of others until they have.
UNKNOWN = 25.0


class Part(NamedTuple):
    """Files of the pages that are made together, and what they depend on beside the package."""

    make: Callable[[Path], None]
    sources: list[Path]
    page: Path | None = None  # whose code it runs


def everything(folder: Path) -> None:
    """Fill the folder with what is missing or was made from other sources; print what is made."""
    documented_keys(HERE / "reference" / "scene_file.md")
    documented_names(HERE / "reference" / "api.md")
    folder.mkdir(exist_ok=True)
    stamps = folder / STAMPS
    made = json.loads(stamps.read_text(encoding="utf-8")) if stamps.exists() else {}
    now = {name: _stamp(part) for name, part in parts().items()}
    made = {name: entry for name, entry in made.items() if name in now}
    old = [name for name, stamp in now.items() if made.get(name, {}).get("stamp") != stamp]
    if old:
        _make_all(old, now, made, folder)
    for page in notebooks.PAGES:  # of text too, which may have changed alone
        notebooks.write(page, folder)


def _make_all(
    old: list[str], now: dict[str, str], made: dict[str, dict[str, Any]], folder: Path
) -> None:
    """Make parts, and write down the stamp and the time of each."""
    expected = {name: made.get(name, {}).get("seconds", UNKNOWN) for name in old}
    seconds = max(sum(expected.values()) / PROCESSES, *expected.values())
    print(
        f"making {len(old)} of {len(now)} parts: about {max(1.0, seconds / 60.0):.0f} min",
        flush=True,
    )
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(PROCESSES, context) as pool:
        order = sorted(old, key=expected.__getitem__, reverse=True)
        begun = {pool.submit(_make, name, folder): name for name in order}
        for number, done in enumerate(as_completed(begun), start=1):
            name = begun[done]
            made[name] = {"stamp": now[name], "seconds": round(done.result(), 1)}
            (folder / STAMPS).write_text(json.dumps(made, indent=1), encoding="utf-8")
            print(f"[{number}/{len(old)}] {name}: {made[name]['seconds']} s", flush=True)


def parts() -> dict[str, Part]:
    """The parts by their names; those that take long come first."""
    own = [HERE / "generate.py", HERE / "page_code.py"]
    found = {"live pages": Part(_live_pages, [*own, HERE / "live_frames.py"])}  # take longest
    for page in PAGES_WITH_PICTURES:
        name = str(page.relative_to(HERE).with_suffix(""))
        found[name] = Part(_Page(page), own, page)
    measured = sorted(HERE.glob("measured/*.json"))
    tables = [*own, *HERE.glob("atlas_tables.py"), *HERE.glob("measure_*.py"), *measured]
    return found | {
        "report cards": Part(report_cards, [*own, HERE / "slip.py"]),
        "the paper": Part(_paper, own),
        "tables": Part(_tables, tables),
    }


def _stamp(part: Part) -> str:
    """Hash of the package and of the sources of a part."""
    digest = hashlib.blake2b(package_stamp().encode(), digest_size=8)
    for source in part.sources:
        digest.update(source.read_bytes())
    if part.page is not None:
        for block in page_code.blocks(part.page):
            digest.update(f"{block.language}\n{block.text}".encode())
    return digest.hexdigest()


def _make(name: str, folder: Path) -> float:
    """Make a part; returns the seconds that it took."""
    began = time.perf_counter()
    logging.getLogger("fontTools").setLevel(logging.WARNING)  # it logs every glyph of a PDF
    parts()[name].make(folder)
    return time.perf_counter() - began


class _Page:
    """Runs the program of a page in its own folder, and keeps its pictures."""

    def __init__(self, page: Path) -> None:
        self._page = page

    def __call__(self, folder: Path) -> None:
        own = folder / "programs" / self._page.stem
        own.mkdir(parents=True, exist_ok=True)
        page_code.run(self._page, own)
        for picture in own.iterdir():
            if picture.suffix in (".png", ".pdf", ".html"):
                shutil.copy(picture, folder / picture.name)


def _paper(folder: Path) -> None:
    """The paper's figures and its tables."""
    paper_figures.draw(folder, paper.CASES)
    tables = paper.compare(paper.CASES)
    (folder / "paper.txt").write_text(paper.report(tables) + "\n", encoding="utf-8")
    paper.draw_overview(tables, folder / "paper.png")
    (folder / "agreement.md").write_text(markdown(agreement(tables)), encoding="utf-8")


def _live_pages(folder: Path) -> None:
    """The live pages, whose modules are compiled once for each potential."""
    live_frames.write(folder / live_frames.FOLDER.name)


def _tables(folder: Path) -> None:
    """Tables of names, the picture of the imports, and pictures and tables of measurements."""
    atlas_tables.figure(folder / "atlas.png")
    measure_effects.figure(folder / "effects.png")
    house.draw(folder / "house.png")
    for name, rows in {
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
