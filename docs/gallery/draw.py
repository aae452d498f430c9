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

from PIL import Image

FOLDER = Path(__file__).resolve().parent
EXAMPLES = FOLDER.parents[1] / "examples"
NUMBERS = FOLDER / "numbers.json"
PAGE = FOLDER / "index.md"

# Width of a picture [pixels]; with a palette of this many colours a file has 25 to 75 kB.
WIDTH, COLOURS = 900, 256

HEADER = """\
<!-- written by docs/gallery/draw.py -->
# Gallery

Each example is a script of less than 60 lines in the folder `examples/`, with one idea, one
picture, and a number that a test compares with a closed form or a published value. Lines in the
pictures are closed forms and points are simulations, unless a legend says otherwise.
"""


def module(name):
    """An example as a module."""
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    return found


def names():
    """The names of all examples."""
    return sorted(path.stem for path in EXAMPLES.glob("*.py"))


def run(name):
    """The numbers of an example, whose picture is written to this folder."""
    with tempfile.TemporaryDirectory() as folder:
        numbers = module(name).main(folder)
        with Image.open(Path(folder) / f"{name}.png") as image:
            size = (WIDTH, round(WIDTH * image.height / image.width))
            small = image.convert("RGB").resize(size, Image.Resampling.LANCZOS)
    small.quantize(COLOURS).save(FOLDER / f"{name}.png", optimize=True)
    return {key: float(value) for key, value in numbers.items()}


def page(numbers):
    """The text of the page: each example with its picture, its explanation and its numbers."""
    return HEADER + "".join(_section(name, numbers[name]) for name in names())


def _section(name, numbers):
    title, _, about = module(name).__doc__.strip().partition("\n\n")
    title = " ".join(title.split()).removesuffix(".")
    rows = "\n".join(f"| {key} | {value:.6g} |" for key, value in numbers.items())
    first, value = next(iter(numbers.items()))
    caption = f"{title}: {first} = {value:.4g}."
    return (
        f"\n## {title}\n\n```{{figure}} {name}.png\n:width: 70%\n:alt: {title}\n\n{caption}\n"
        f"```\n\n{about}\n\n"
        f"| `examples/{name}.py` | |\n| --- | --- |\n{rows}\n"
    )


def main(chosen):
    """Run the chosen examples, and write the page."""
    numbers = json.loads(NUMBERS.read_text(encoding="utf-8")) if NUMBERS.exists() else {}
    numbers |= {name: run(name) for name in chosen or names()}
    numbers = {name: numbers[name] for name in names()}
    NUMBERS.write_text(json.dumps(numbers, indent=1) + "\n", encoding="utf-8")
    PAGE.write_text(page(numbers), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
