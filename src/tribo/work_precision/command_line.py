"""The command `tribo accuracy`."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from tribo.interrupts import COMPLETED, STOPPED, report_by
from tribo.scene_options import check_figure, load_with_values

if TYPE_CHECKING:
    from tribo.work_precision.rows import WorkPrecision


def run_accuracy(options: argparse.Namespace) -> int:
    """Measure and print errors and costs; the exit status."""
    from tribo.work_precision import work_precision

    scene = load_with_values(options)
    check_figure(options.figure)
    found: list[WorkPrecision] = []

    def report() -> None:
        """Print what was measured where an interrupt ends the program."""
        for diagram in found[-1:]:
            print(diagram.to_json() if options.json else diagram, flush=True)
        print("tribo: interrupted", file=sys.stderr)

    report_by(report)
    tell = (lambda name: print(name, file=sys.stderr)) if sys.stderr.isatty() else None
    diagram = work_precision(
        scene, options.methods, options.observables or (), options.seconds, tell, found.append
    )
    if options.figure is not None:
        diagram.save_figure(options.figure)
    print(diagram.to_json() if options.json else diagram)
    if not diagram.rows:
        print("tribo: no run ended in time; give more --seconds", file=sys.stderr)
    return COMPLETED if diagram.rows and diagram.status == "completed" else STOPPED
