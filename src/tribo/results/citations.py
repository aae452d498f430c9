"""The papers behind a result: of the model, the method, the potentials, and the effects."""

import inspect
import re

from tribo.integrators.methods import METHODS
from tribo.model.scene import Scene
from tribo.plugins.classes import parts
from tribo.validation import choice

STYLES = ("text", "bibtex")
# What every result rests on.
ALWAYS = {
    "tribo": "The tribo developers, tribo: sliding friction from the asperite up, "
    "version {version}",
    "model": "J. D. Brown, Work Done by Sliding Friction, Department of Physics and Astronomy, "
    "North Carolina State University, Raleigh, NC 27695",
}
# By the name of an effect; see tribo.model.effects.
OF_EFFECTS = {
    "bath": "R. Zwanzig, J. Stat. Phys. 9 (1973) 215",
    "torsional bath": "R. Zwanzig, J. Stat. Phys. 9 (1973) 215",
    "langevin": "D. L. Ermak, H. Buckholz, J. Comput. Phys. 35 (1980) 169",
    "swing langevin": "D. L. Ermak, H. Buckholz, J. Comput. Phys. 35 (1980) 169",
    "pull": "L. Prandtl, Z. angew. Math. Mech. 8 (1928) 85",
}
# A paper: authors, journal, volume (year) page.
PAPER = re.compile(
    r"(?P<author>.+), (?P<journal>[^,]+?) (?P<volume>\d+) \((?P<year>\d{4})\) (?P<pages>\d+)"
    r"(, (?P<note>.+))?"
)


def citations(scene: Scene, method: str, style: str) -> str:
    """The references as text or BibTeX; see :meth:`tribo.Result.cite`."""
    from tribo import __version__

    choice("style", style, STYLES)
    found = {key: text.format(version=__version__) for key, text in ALWAYS.items()}
    if method in METHODS:
        found[f"method {method}"] = METHODS[method].source
    for interaction in scene.interactions:
        found |= _of_potential(interaction.potential)
    found |= {name: OF_EFFECTS[name] for name in map(str, scene.effects) if name in OF_EFFECTS}
    if style == "text":
        return "\n".join(f"{key}: {text}." for key, text in found.items())
    return "\n".join(_bibtex(key, text) for key, text in found.items())


def _of_potential(potential: object) -> dict[str, str]:
    """The papers that the docstrings of a potential and of its parts name."""
    found: dict[str, str] = {}
    for kind in map(type, parts(potential)):
        doc = inspect.getdoc(kind) or ""
        source = re.search(r"^(\w\..* \d+ \(\d{4}\) \d+)\.$", doc, re.MULTILINE)
        if source is not None:
            found[f"potential {kind.__name__}"] = source[1]
    return found


def _bibtex(key: str, text: str) -> str:
    """One entry: an article for each paper, else the text as a note."""
    entries = []
    for number, part in enumerate(text.split("; ")):
        label = key.replace(" ", "-") + (f"-{number + 1}" if number else "")
        paper = PAPER.fullmatch(part)
        kind = "misc" if paper is None else "article"
        fields = {"note": part} if paper is None else paper.groupdict()
        if "author" in fields:
            fields["author"] = fields["author"].replace(", ", " and ")
        body = ",\n".join(f"  {field} = {{{value}}}" for field, value in fields.items() if value)
        entries.append(f"@{kind}{{{label},\n{body}\n}}")
    return "\n".join(entries)
