"""The command `tribo new`."""

import argparse
from pathlib import Path

from tribo.files import replace_file
from tribo.starters.scenes_by_kind import KINDS, starter
from tribo.validation import InputError


def add_new(new: argparse.ArgumentParser) -> None:
    """Add the arguments of `tribo new`."""
    kinds = ";  ".join(f"{kind}: {meaning}" for kind, meaning in KINDS.items())
    new.add_argument("kind", nargs="?", choices=list(KINDS), default="paper", help=kinds)
    new.add_argument(
        "-o", "--out", type=Path, metavar="FILE.toml", help="a new file (default: print the scene)"
    )
    new.set_defaults(command=_new)


def _new(options: argparse.Namespace) -> int:
    text = starter(options.kind)
    if options.out is None:
        print(text, end="")
        return 0
    if options.out.exists():
        raise InputError("--out", f"must be a new file, but {options.out} exists")
    replace_file(options.out, text.encode())
    print(f"{options.out}: {KINDS[options.kind]}; run it with: tribo run {options.out}")
    return 0
