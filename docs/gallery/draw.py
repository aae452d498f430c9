"""Run all examples, and write the gallery: its pictures, its numbers and its pages.

    python docs/gallery/draw.py              all examples: about two minutes
    python docs/gallery/draw.py stick_slip   some of them

    python docs/gallery/draw.py --pages      none: the pages alone

A test compares the numbers and the pages with the examples.
"""

import importlib.util
import json
import sys
import tempfile
from pathlib import Path

from captions import CAPTIONS, FORMULAS, REFERENCES, THEMES
from PIL import Image

FOLDER = Path(__file__).resolve().parent
EXAMPLES = FOLDER.parents[1] / "examples"
NUMBERS = FOLDER / "numbers.json"

# Pixels of the page for each inch of a figure, so that text has one size in all pictures; a file
# has twice as many.  With a palette of this many colours it has 25 to 100 kB.
SCALE, COLOURS = 118, 256

WRITTEN = "<!-- written by docs/gallery/draw.py -->\n"
HEADER = f"""\
{WRITTEN}# Gallery

Each picture leads to the page of an example of the folder `examples/`: its code, and the numbers
that a test compares with a closed form or a published value.
"""


def module(name):
    """An example as a module."""
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    return found


def names():
    """The names of all examples, by theme."""
    return [name for members in THEMES.values() for name in members]


def run(name):
    """The numbers of an example, whose picture is written to this folder."""
    with tempfile.TemporaryDirectory() as folder:
        numbers = module(name).main(folder)
        with Image.open(Path(folder) / f"{name}.png") as image:
            ratio = 2.0 * SCALE / image.info["dpi"][0]
            size = (round(ratio * image.width), round(ratio * image.height))
            small = image.convert("RGB").resize(size, Image.Resampling.LANCZOS)
    # Few large areas have the most colours; this method keeps those of small ones, as of scales.
    few = small.quantize(COLOURS, Image.Quantize.MAXCOVERAGE, kmeans=3)
    few.save(FOLDER / f"{name}.png", optimize=True)
    return {key: float(value) for key, value in numbers.items()}


def pages(numbers):
    """The pages by their names: thumbnails, and a page for each example."""
    parts = [HEADER]
    for theme, members in THEMES.items():
        cards = "".join(map(_card, members))
        parts.append(f"\n## {theme}\n\n::::{{grid}} 2 2 3 3\n:gutter: 2\n{cards}::::\n")
    listed = "\n".join(names())
    parts.append(f"\n:::{{toctree}}\n:hidden:\n:maxdepth: 1\n\n{listed}\n:::\n")
    return {"index": "".join(parts)} | {name: _page(name, numbers[name]) for name in names()}


def _card(name):
    """A thumbnail that leads to the page of an example."""
    title, _ = _words(name)
    return (
        f"\n:::{{grid-item-card}}\n:link: {name}\n:link-type: doc\n:img-top: {name}.png\n"
        f":img-alt: {title}\n\n{title}\n:::\n"
    )


def _words(name):
    """The title of an example, and its text with formulas."""
    title, _, about = module(name).__doc__.strip().partition("\n\n")
    for ascii_formula, latex in FORMULAS.get(name, {}).items():
        if ascii_formula not in about:
            raise ValueError(f"{name}: the text has no {ascii_formula!r}")
        about = about.replace(ascii_formula, latex)
    return " ".join(title.split()).removesuffix("."), about


def _page(name, numbers):
    """The page of an example."""
    title, about = _words(name)
    references = REFERENCES[name]
    rows = "\n".join(
        f"| {key} | {value:.4g} | {expected} | {unit} |"
        for (key, value), (expected, unit) in zip(numbers.items(), references, strict=True)
    )
    function, caption = CAPTIONS[name]
    with Image.open(FOLDER / f"{name}.png") as image:
        width = image.width // 2
    index = "```{index} !stick-slip, !Prandtl-Tomlinson\n```\n\n" if name == "stick_slip" else ""
    source = f"../../examples/{name}.py"
    return (
        f"{WRITTEN}# {title}\n\n{index}"
        f"```{{figure}} {name}.png\n:width: {width}px\n:alt: {title}\n\n"
        f"{caption.format(*numbers.values())}\n```\n\n"
        "Points are simulations and lines are closed forms, unless the legend or the caption says "
        f"otherwise.\n\n{about}\n\n"
        f"| number | tribo | reference | unit |\n| --- | --- | --- | --- |\n{rows}\n\n"
        f"A test compares the numbers with the references. This function sets up the scene:\n\n"
        f"```{{literalinclude}} {source}\n:language: python\n:pyobject: {function}\n"
        ":class: wrap\n```\n\n"
        f":::{{dropdown}} The whole program\n`python examples/{name}.py` draws the picture "
        f"({{download}}`download <{source}>`).\n\n"
        f"```{{literalinclude}} {source}\n:language: python\n:class: wrap\n```\n:::\n"
    )


def main(chosen):
    """Run the chosen examples, and write the pages."""
    numbers = json.loads(NUMBERS.read_text(encoding="utf-8")) if NUMBERS.exists() else {}
    if chosen != ["--pages"]:
        numbers |= {name: run(name) for name in chosen or names()}
    numbers = {name: numbers[name] for name in sorted(names())}
    NUMBERS.write_text(json.dumps(numbers, indent=1) + "\n", encoding="utf-8")
    for name, text in pages(numbers).items():
        (FOLDER / f"{name}.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
