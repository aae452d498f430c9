"""Every code block of the pages runs, and prints the output that the page shows."""

import ast
import doctest
import importlib
import importlib.util
import inspect
import json
import re
from dataclasses import fields, is_dataclass
from pathlib import Path

import pytest

import tribo
from support.registered import forgotten
from tribo import InputError

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = ("tutorials", "how-to", "explanation", "studies", "reference", "developers")
PAGES = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "paper.md")),
    *sorted((ROOT / "docs").glob("*.md")),
    *(page for folder in FOLDERS for page in sorted((ROOT / "docs" / folder).glob("*.md"))),
]


def module_of_docs(name):
    """A module of the folder docs/, which is no package."""
    spec = importlib.util.spec_from_file_location(name, ROOT / "docs" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


page_code = module_of_docs("page_code")


# Pages whose programs take many seconds.
THOROUGH = {"docs/how-to/live.md", "docs/how-to/fit.md"}


def with_marks(page):
    """A page and its name, marked where its test is thorough."""
    name = str(page.relative_to(ROOT))
    return pytest.param(page, marks=[pytest.mark.thorough] * (name in THOROUGH), id=name)


@pytest.mark.parametrize("page", [*map(with_marks, PAGES)])
def test_page(page, tmp_path):
    """The blocks run in order, and print what the page shows; code without a language fails."""
    if "x3p" in page.read_text(encoding="utf-8") and page.parent.name == "tutorials":
        pytest.importorskip("SurfaceTopography")
    with forgotten():
        page_code.run(page, tmp_path)


NOTEBOOKS = ["answers", "energy_direction", "friction_law", "from_the_paper", "new_potential"]


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_notebook(name, tmp_path, monkeypatch):
    """A notebook has the code of its page in order, and what the page shows as its output."""
    monkeypatch.syspath_prepend(ROOT / "docs")
    page = ROOT / "docs" / "tutorials" / f"{name}.md"
    text = page.read_text(encoding="utf-8")
    pictures = re.findall(r"^```\{image\} /\S*?([\w.-]+)$", text, re.MULTILINE)
    for picture in pictures:
        (tmp_path / picture).write_bytes(b"a picture")
    path = module_of_docs("notebooks").write(page, tmp_path)
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    blocks = list(page_code.blocks(page))
    programs = [block.text.rstrip() for block in blocks if block.language == "python"]
    # Cells that write a file or run tribo in a shell are made of other blocks.
    others = re.compile(r"%%writefile |import sys\n\n!\"\{sys\.executable\}\" -m tribo ")
    assert [cell["source"] for cell in code if not others.match(cell["source"])] == programs
    outputs = [output for cell in code for output in cell["outputs"]]
    printed = [output["text"] for output in outputs if output["output_type"] == "stream"]
    assert printed == [b.text for b in blocks if b.language == "text" and b.follows]
    assert not any(mark in cell["source"] for cell in cells for mark in ("```python", ".md)"))
    prose = "".join(cell["source"] for cell in cells if cell["cell_type"] == "markdown")
    assert "[]" not in prose
    kept = json.loads(page.with_suffix(".ipynb").read_text(encoding="utf-8"))["cells"]
    without = [
        re.sub(r'base64,[^)]*|(?<="image/png": ")[^"]*', "", json.dumps(each))
        for each in (cells, kept)
    ]
    assert without[0] == without[1], "python docs/notebooks.py writes the notebooks again"


@pytest.mark.parametrize("name", sorted({*NOTEBOOKS} - {"answers"}))
def test_cells_draw_their_pictures(name, tmp_path, monkeypatch):
    """A picture is the output of the cell that draws it, which ends with the drawing itself."""
    monkeypatch.syspath_prepend(ROOT / "docs")
    page = ROOT / "docs" / "tutorials" / f"{name}.md"
    pictures = re.findall(r"^```\{image\} /\S*?([\w.-]+)$", page.read_text("utf-8"), re.MULTILINE)
    for picture in pictures:
        (tmp_path / picture).write_bytes(b"a picture")
    path = module_of_docs("notebooks").write(page, tmp_path)
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    drawn = [
        (cell["source"], output["data"]["image/png"])
        for cell in cells
        for output in cell.get("outputs", ())
        if output["output_type"] == "display_data"
    ]
    assert pictures and [data for _, data in drawn] == ["YSBwaWN0dXJl"] * len(pictures)
    for source, _ in drawn:
        assert re.search(r"^\w+$", source.splitlines()[-1]) or "save_figure" in source


# What readers search for, and the page that explains it.
SEARCHED = {
    "install": "install",
    "error bar": "how-to/averages",
    "friction coefficient": "tutorials/friction_law",
    "stick-slip": "gallery/stick_slip",
    "sliders": "tutorials/teaching",
    "resume": "how-to/files",
    "noise": "how-to/velocity_and_temperature",
    "own potential": "tutorials/new_potential",
}


@pytest.mark.parametrize("words", SEARCHED)
def test_search_finds_the_page(words):
    """A main entry of the index is the first result of the search for its words.

    The search of Sphinx gives an entry of the index that equals the words 100 points, and a title
    that contains them at most 16, a word in the text 5.
    """
    found = set()
    for page in (ROOT / "docs").rglob("*.md"):
        for entries in re.findall(r"^```\{index\} (.*)$", page.read_text("utf-8"), re.MULTILINE):
            if words in {entry.strip().removeprefix("!").lower() for entry in entries.split(",")}:
                assert f"!{words}" in entries
                found.add(page.relative_to(ROOT / "docs").with_suffix("").as_posix())
    assert found == {SEARCHED[words]}


def test_docstrings_repeat_what_they_share(monkeypatch):
    """The reference shows the text of an argument, and no pointer to another function."""
    monkeypatch.syspath_prepend(ROOT / "docs")
    shared_text = module_of_docs("shared_text")
    lines = inspect.getdoc(tribo.simulate).splitlines()
    assert any("As for :func:`prepare`" in line for line in lines)
    whole = "\n".join(shared_text.repeated(lines))
    assert "\nscene : Scene\n    The scene to run.\n" in whole and "\nresume : bool\n" in whole
    assert whole.count("largest error of any reported quantity") == 1
    for function in (tribo.simulate, tribo.ensemble, tribo.sweep, tribo.explain):
        text = shared_text.repeated(inspect.getdoc(function).splitlines())
        assert not any("As for :" in line for line in text), function.__name__


function_examples = module_of_docs("function_examples")


@pytest.mark.thorough
@pytest.mark.parametrize("name", function_examples.EXAMPLES)
def test_example_of_a_function(name, tmp_path, monkeypatch):
    """The example in the Python reference runs, and prints what it shows."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")
    program = function_examples.START + function_examples.EXAMPLES[name]
    example = doctest.DocTestParser().get_doctest(program, {}, name, None, 0)
    failures = []
    with forgotten():
        doctest.DocTestRunner(verbose=False).run(example, out=failures.append)
    assert not failures, "".join(failures)


def test_every_function_has_an_example(monkeypatch):
    """Each function of the Python reference, by the name with which users call it."""
    monkeypatch.syspath_prepend(ROOT / "docs")
    shared_text = module_of_docs("shared_text")
    text = (ROOT / "docs" / "reference" / "api.md").read_text(encoding="utf-8")
    names = set()
    for directive, name in re.findall(r"^\.\. (\w+):: ([\w.]+)", text, re.MULTILINE):
        if directive in ("currentmodule", "automodule"):
            module = name
        elif directive == "autofunction":
            whole = name if name.startswith("tribo.") else f"{module}.{name}"
            place, _, last = whole.rpartition(".")
            function = getattr(importlib.import_module(place), last)
            names.add(shared_text.public_name(function))
    assert names == function_examples.EXAMPLES.keys()


def test_picture_of_the_house(monkeypatch):
    """The caption has the length of the longest chain, and the lines leave no import out."""
    monkeypatch.syspath_prepend(ROOT / "docs")
    house = module_of_docs("house")
    graph = house.imports()
    longest = max(house.heights(graph).values()) + 1
    assert f"longest chain of imports has {longest} of them" in architecture()
    lines = house.needed(graph)
    reached = {room: {other for start, other in lines if start == room} for room in graph}
    for room in sorted(graph, key=house.heights(graph).__getitem__):
        reached[room] |= {further for other in reached[room] for further in reached[other]}
        assert graph[room] <= reached[room]


CAPTION = re.compile(r"\A\*[^*].*\d.*\*\Z", re.DOTALL)
FIGURE = re.compile(r"^```\{figure\}.*\n(?::.*\n)*([^`]*)^```", re.MULTILINE)
GALLERY = sorted((ROOT / "docs" / "gallery").glob("*.md"))


@pytest.mark.parametrize("page", [*PAGES, *GALLERY], ids=lambda page: str(page.relative_to(ROOT)))
def test_pictures_have_captions(page):
    """Each picture, or row of pictures, has a caption with a number: below it in italics."""
    text = page.read_text(encoding="utf-8")
    paragraphs = re.split(r"\n\s*\n", text)
    is_picture = [paragraph.startswith("```{image}") for paragraph in paragraphs]
    for number, paragraph in enumerate(paragraphs):
        if is_picture[number] and not is_picture[number + 1]:
            assert CAPTION.match(paragraphs[number + 1].strip()), paragraph
    captions = FIGURE.findall(text)
    assert len(captions) == text.count("```{figure}")
    assert all(re.search(r"\d", caption) for caption in captions)


def test_live_pages_are_those_of_the_pages():
    """Each page in a frame is made, and each that is made stands in a page."""
    pytest.importorskip("sphinx", reason="needs tribo[docs]")
    named = set()
    for page in (ROOT / "docs").rglob("*.md"):
        named |= set(re.findall(r"^```\{live\} (\w+)$", page.read_text("utf-8"), re.MULTILINE))
    assert named == set(module_of_docs("live_frames").PAGES)


def architecture():
    """The text of the page on architecture."""
    return (ROOT / "docs" / "developers" / "architecture.md").read_text(encoding="utf-8")


def test_drawing_of_the_layout():
    """The page on architecture draws every folder, in the order in which imports run downward."""
    drawn = re.findall(r"^    (\w+)(?:/|\.py) ", architecture(), re.MULTILINE)
    tree = ast.parse((ROOT / "tests" / "test_architecture.py").read_text(encoding="utf-8"))
    (order,) = (
        ast.literal_eval(node.value)
        for node in tree.body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "ORDER"
    )
    assert drawn == order


def test_files_that_are_named_exist():
    """Every file that the page on architecture names is in the package or in the checkout."""
    named = re.findall(r"`(\w+(?:/\w+)+\.\w+)`", architecture())
    missing = [
        name
        for name in named
        if not (ROOT / name).exists() and not (ROOT / "src" / "tribo" / name).exists()
    ]
    assert len(named) > 20 and not missing


def test_fields_are_documented():
    """Every field of a public class is in its docstring; those of a result are internal."""
    for name in set(tribo.__all__) - {"Result"}:
        kind = getattr(tribo, name)
        if isinstance(kind, type):
            names = fields(kind) if is_dataclass(kind) else ()
            own = [field.name for field in names] or getattr(kind, "_fields", ())
            for field in own:
                entry = rf"^(\w+, )*{field}(, \w+)* :"
                assert re.search(entry, inspect.getdoc(kind), re.MULTILINE), f"{name}.{field}"


PROGRAM = """
```python
from typing import NamedTuple
x = 1.25

class Named(NamedTuple):
    a: float

print("x is", x)
```

```text
x is 1.25
```

```python
import inspect
print(inspect.getsource(Named).splitlines()[1].strip(), Named(x).a)
```

```text
a: float 1.25
```
"""
SCENE = """
```toml
# small.toml
duration = 1.0
surface = [{name = "upper"}]
```
"""


@pytest.fixture
def written(tmp_path):
    """Write a page and run it."""

    def call(text):
        page = tmp_path / "page.md"
        page.write_text(text, encoding="utf-8")
        page_code.run(page, tmp_path)

    return call


@pytest.mark.parametrize(
    ("text", "error", "message"),
    [
        (PROGRAM.replace("x is 1.25", "y is 1.25"), AssertionError, "prints\nx is 1.25"),
        (PROGRAM.replace("x is 1.25", "x is 1.35"), AssertionError, "prints\nx is 1.25"),
        (PROGRAM.replace("x = 1.25", "x = 1.25 + y"), NameError, "'y' is not defined"),
        (SCENE.replace("name", "nmae"), InputError, "nmae"),
        (SCENE + "```shell\ntribo run large.toml\n```\n", AssertionError, "fails"),
        (SCENE + "```shell\nls small.toml\n```\n", AssertionError, "use console"),
        ("```py\ntribo.sweep(scene, {}, measures=1)\n```\n", TypeError, "measures"),
        ("```py\ntribo.grid\n```\n", AttributeError, "grid"),
        ("```none\ntribo paper\n```\n", AssertionError, "'none' is not known"),
        ("So\n\n    x = 1\n\nis it.\n", AssertionError, "fence 'x = 1'"),
        ("```python\nx = 1\n", AssertionError, "is not closed"),
    ],
)
def test_a_page_that_is_wrong_fails(written, text, error, message):
    """A page fails by its text, its code, its scene or its commands."""
    with pytest.raises(error) as failure:
        written(text)
    assert message in str(failure.value)


def test_a_page_that_is_right_passes(written):
    """Blocks share one namespace and one folder; the last digit may differ."""
    written(PROGRAM.replace("x is 1.25", "x is 1.26") + SCENE)
    assert not page_code.same("a 1.0e-3", "a 1.2e-3")
    assert page_code.same("a 1e-12", "a 3e-13")


def test_joined_tutorials(tmp_path):
    """The tutorials are joined in the order of their contents; links lead to other sites only."""
    archive = module_of_docs("archive")
    names = archive.tutorials()
    assert names[0] == "from_the_paper"
    assert set(names) == {p.stem for p in (ROOT / "docs/tutorials").glob("*.md")} - {"index"}
    for name in names:
        links = '<a href="other.html">one</a> <a class="x" href="https://example.org/">two</a>'
        text = f"<head><title>{name} - tribo</title></head><article>{name}: {links}</article>"
        (tmp_path / f"{name}.html").write_text(text, encoding="utf-8")
    page = archive.joined_page(tmp_path, names)
    assert re.findall(r"(\w+): <a", page) == names
    assert "other.html" not in page and page.count("https://example.org/") == len(names)
