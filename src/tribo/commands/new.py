"""The command `tribo new`."""

import argparse
from pathlib import Path

from tribo.files import replace_file
from tribo.starters.scenes_by_kind import KINDS, starter
from tribo.validation import InputError

# The cases of the paper.
CASES = "ABCDE"


def add_new(new: argparse.ArgumentParser) -> None:
    """Add the arguments of `tribo new`."""
    kinds = ";  ".join(f"{kind}: {meaning}" for kind, meaning in KINDS.items())
    new.add_argument(
        "kind",
        nargs="?",
        choices=[*KINDS, *CASES],
        default="paper",
        help=f"{kinds};  A to E: that case of the paper, without comments",
    )
    new.add_argument(
        "-o", "--out", type=Path, metavar="FILE.toml", help="a new file (default: print the scene)"
    )
    new.set_defaults(command=_new)


def _new(options: argparse.Namespace) -> int:
    is_case = options.kind in CASES
    text = _case(options.kind) if is_case else starter(options.kind)
    if options.out is None:
        print(text, end="")
        return 0
    if options.out.exists():
        raise InputError("--out", f"must be a new file, but {options.out} exists")
    replace_file(options.out, text.encode())
    meaning = f"case {options.kind} of the paper" if is_case else KINDS[options.kind]
    print(f"{options.out}: {meaning}; run it with: tribo run {options.out}")
    return 0


def _case(name: str) -> str:
    """The scene file of a case of the paper."""
    from tribo.model.scene_writer import toml, without_defaults
    from tribo.paper import scene

    return toml(without_defaults(scene(name).to_table())).decode()
