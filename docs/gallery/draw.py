"""Run all examples, and write the gallery: its pictures, its numbers and its page.

    python docs/gallery/draw.py              all examples: about two minutes
    python docs/gallery/draw.py stick_slip   some of them

A test compares the numbers and the page with the examples.
"""

import importlib.util
import json
import sys
import tempfile
from pathlib import Path

from captions import CAPTIONS, THEMES
from PIL import Image

FOLDER = Path(__file__).resolve().parent
EXAMPLES = FOLDER.parents[1] / "examples"
NUMBERS = FOLDER / "numbers.json"
PAGE = FOLDER / "index.md"

# Pixels of the page for each inch of a figure, so that text has one size in all pictures; a file
# has twice as many.  With a palette of this many colours it has 25 to 100 kB.
SCALE, COLOURS = 118, 256

HEADER = """\
<!-- written by docs/gallery/draw.py -->
# Gallery

This page shows each example of the folder `examples/`: its picture, the function that sets up the
scene, and the numbers that a test compares with a closed form or a published value. Points are
simulations and lines are closed forms, unless a legend or a caption says otherwise. The command
`python examples/NAME.py` draws a picture again.
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


def page(numbers):
    """The text of the page: each example with its picture, its code and its numbers."""
    parts = [HEADER]
    for theme, members in THEMES.items():
        parts.append(f"\n## {theme}\n")
        parts += [_section(name, numbers[name]) for name in members]
    return "".join(parts)


def _section(name, numbers):
    """The part of the page about an example."""
    title, _, about = module(name).__doc__.strip().partition("\n\n")
    title = " ".join(title.split()).removesuffix(".")
    rows = "\n".join(f"| {key} | {value:.4g} |" for key, value in numbers.items())
    function, caption = CAPTIONS[name]
    with Image.open(FOLDER / f"{name}.png") as image:
        width = image.width // 2
    return (
        f"\n### {title}\n\n```{{figure}} {name}.png\n:width: {width}px\n:alt: {title}\n\n"
        f"{caption.format(*numbers.values())}\n```\n\n"
        f"```{{literalinclude}} ../../examples/{name}.py\n:language: python\n"
        f":pyobject: {function}\n```\n\n{about}\n\n"
        f"| `examples/{name}.py` | |\n| --- | --- |\n{rows}\n"
    )


def main(chosen):
    """Run the chosen examples, and write the page."""
    numbers = json.loads(NUMBERS.read_text(encoding="utf-8")) if NUMBERS.exists() else {}
    numbers |= {name: run(name) for name in chosen or names()}
    numbers = {name: numbers[name] for name in sorted(names())}
    NUMBERS.write_text(json.dumps(numbers, indent=1) + "\n", encoding="utf-8")
    PAGE.write_text(page(numbers), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
