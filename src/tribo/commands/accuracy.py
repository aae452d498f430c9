"""The command `tribo accuracy`."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from tribo.commands.scene_options import check_figure, draw_to, load_with_values
from tribo.interrupts import COMPLETED, STOPPED, also_in_part, report_by
from tribo.validation import InputError

if TYPE_CHECKING:
    from tribo.work_precision import MeansPrecision, WorkPrecision


def run_accuracy(options: argparse.Namespace) -> int:
    """Measure and print errors and costs, or with noise half-widths and costs; the exit status."""
    from tribo.work_precision import WorkPrecision, means_precision, work_precision

    scene = load_with_values(options)
    check_figure(options.figure)
    observables = options.observables or ()
    found: MeansPrecision | WorkPrecision

    def show(found: MeansPrecision | WorkPrecision) -> None:
        print(found.to_json() if options.json else found, flush=True)

    def report(found: MeansPrecision | WorkPrecision) -> None:
        if found.rows:  # to be printed if an interrupt ends the program
            report_by(lambda: show(found))

    if scene.is_noisy:
        for option in ("methods", "figure"):
            if getattr(options, option) is not None:
                raise InputError(f"--{option}", "cannot go with a scene that has thermal noise")
        found = also_in_part(means_precision, scene, observables, options.seconds, report)
    else:
        progress = (lambda name: print(name, file=sys.stderr)) if sys.stderr.isatty() else None
        settings = options.methods, observables, options.seconds, progress, report
        found = also_in_part(work_precision, scene, *settings)
    show(found)
    if isinstance(found, WorkPrecision) and found.rows:
        draw_to(options.figure, found.save_figure)
    if not found.rows:
        print("tribo: no run ended in time; give more --seconds", file=sys.stderr)
    return COMPLETED if found.rows and found.status == "completed" else STOPPED
