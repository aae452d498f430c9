"""Works that are smaller than the rounding of the energies that they change."""

from __future__ import annotations

from collections.abc import Mapping

from tribo.accuracy.comparison import Accuracy, observables
from tribo.accuracy.scales import ENERGIES, EPSILON, kind_of, largest, reported_scales
from tribo.layout.layout import Layout
from tribo.ledger.ledger import Ledger, assemble
from tribo.loops.integrate import Integration

# The works and pseudoworks of an asperite.
WORKS = tuple(name for name in ENERGIES if name.startswith("w"))


def weak_notes(
    layout: Layout, run: Integration, bounds: Mapping[str, float], accuracy: Accuracy
) -> tuple[str, ...]:
    """A note on works below the rounding of the internal energies, which are then the scale."""
    asked = [kind_of(name) for name in observables(accuracy)]
    if layout.model.ledger is None or (asked and not {"energy", "total"} & set(asked)):
        return ()
    if _largest_work(assemble(layout, run.samples.ends())) > bounds["delta_e_int"]:
        return ()
    ledger = assemble(layout, run.samples)
    work, scale = _largest_work(ledger), reported_scales(layout, ledger).energy
    if not 0.0 < work <= EPSILON * scale:
        return ()
    return (
        f"no work exceeds {work:.1e}, below the rounding of the energies of {scale:.1e} that it "
        "changes: errors are relative to these, and works and changes of energies have no digit "
        "that is known",
    )


def _largest_work(ledger: Ledger) -> float:
    """The largest magnitude of any work or pseudowork of an asperite."""
    works = [name for name in WORKS if ledger.series(name)]
    return max(largest(each) for name in works for each in ledger.series(name))
