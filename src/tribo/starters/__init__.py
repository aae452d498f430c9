"""Commented scene files to start from, by kind, and the command `tribo new`."""

from importlib.resources import files

from tribo.validation import must_be

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
    if kind not in KINDS:
        raise must_be("kind", f"one of {', '.join(KINDS)}", kind)
    return files("tribo.starters").joinpath("scenes", f"{kind}.toml").read_text(encoding="utf-8")
