"""The command `tribo atlas`."""

from __future__ import annotations

import argparse
import sys
from dataclasses import asdict
from typing import TYPE_CHECKING

from tribo.files import strict_json
from tribo.interrupts import COMPLETED, STOPPED, answer, report_by

if TYPE_CHECKING:
    from tribo.atlas import Row


def run_atlas(options: argparse.Namespace) -> int:
    """Run the chosen scenes one after another, print a line for each, and compare the outcomes."""
    from tribo import atlas

    entries = atlas.chosen(options.names)
    # With --json, the lines show the progress on a terminal.
    lines = sys.stderr if options.json else sys.stdout
    shown = not options.json or lines.isatty()
    rows: list[Row] = []

    def report() -> None:  # what was reached where an interrupt ends the program
        print(f"tribo: interrupted after {len(rows)} of {len(entries)} scenes", file=sys.stderr)
        _print(options, rows, len(entries))

    report_by(report)
    if shown:
        print(atlas.HEAD, file=lines, flush=True)
    try:
        for one in map(atlas.row, entries):
            rows.append(one)
            if shown:
                print(one, file=lines, flush=True)
    except KeyboardInterrupt:
        answer()
        report()
        return STOPPED
    return _print(options, rows, len(entries))


def _print(options: argparse.Namespace, rows: list[Row], count: int) -> int:
    """Print the rows of `count` scenes, or how many ended as declared; the exit status."""
    declared = sum(one.as_declared for one in rows)
    if options.json:
        print(strict_json({"rows": [asdict(one) for one in rows]}), flush=True)
    else:
        print(f"{declared} of {count} scenes as declared", flush=True)
    return COMPLETED if declared == count else STOPPED
