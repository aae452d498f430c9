"""The scene files to start from, by kind."""

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
    """The text of a commented scene file.

    Parameters
    ----------
    kind : str
        A key of `KINDS`.

    Returns
    -------
    str
        TOML, which :func:`tribo.load_scene` reads from a file.

    Raises
    ------
    InputError
        There is no such kind.
    """
    if kind not in KINDS:
        raise must_be("kind", f"one of {', '.join(KINDS)}", kind)
    return files("tribo.starters").joinpath("scenes", f"{kind}.toml").read_text(encoding="utf-8")
