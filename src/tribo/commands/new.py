"""The command `tribo new`."""

import argparse
from pathlib import Path

from tribo.files import replace_file
from tribo.starters import KINDS, starter
from tribo.validation import InputError

# The cases of the paper.
CASES = "ABCDE"


def add_new(new: argparse.ArgumentParser) -> None:
    kinds = ";  ".join(f"{kind}: {meaning}" for kind, meaning in KINDS.items())
    kinds += ";  A to E: that case of the paper, without comments"
    new.add_argument("kind", nargs="?", choices=[*KINDS, *CASES], default="paper", help=kinds)
    out = "a new file (default: print the scene)"
    new.add_argument("-o", "--out", type=Path, metavar="FILE.toml", help=out)
    new.set_defaults(command=_new)


def _new(options: argparse.Namespace) -> int:
    """Print a commented scene of a kind, or a case of the paper, or write it to a new file."""
    if options.kind in CASES:
        from tribo.model.scene_writer import toml, without_defaults
        from tribo.paper import scene

        text = toml(without_defaults(scene(options.kind).to_table())).decode()
        meaning = f"case {options.kind} of the paper"
    else:
        text = starter(options.kind)
        meaning = KINDS[options.kind]
    if options.out is None:
        print(text, end="")
        return 0
    if options.out.exists():
        raise InputError("--out", f"must be a new file, but {options.out} exists")
    replace_file(options.out, text.encode())
    print(f"{options.out}: {meaning}; run it with: tribo run {options.out}")
    return 0
