"""Commented scene files to start from, by kind, and the command `tribo new`."""

from importlib.resources import files

from tribo.validation import one_of

# What each scene file shows.
KINDS = {
    "paper": "two asperites whose bobs repel: the paper's case A",
    "row": "a row that slides over another one",
    "rough": "rough surfaces, with reservoirs that take up the heat",
    "bath": "a free asperite that a bath of oscillators slows down",
    "pulled": "a tip that sticks and slips on a corrugated surface",
}


def starter(kind: str) -> str:
    """The text of a commented scene file, in TOML.  Raises InputError for a kind not in `KINDS`."""
    path = files("tribo.starters").joinpath("scenes", f"{one_of('kind', kind, KINDS)}.toml")
    return path.read_text(encoding="utf-8")
