"""Works that are smaller than the rounding of the energies that they change."""

from __future__ import annotations

from tribo.accuracy.comparison import Accuracy, observables
from tribo.accuracy.scales import EPSILON, Scales, kind_of


def weak_notes(scales: Scales, accuracy: Accuracy) -> tuple[str, ...]:
    """A note on works below the rounding of the internal energies, which are then the scale."""
    asked = [kind_of(name) for name in observables(accuracy)]
    if asked and not {"energy", "total"} & set(asked):
        return ()
    if not 0.0 < scales.work <= EPSILON * scales.energy:
        return ()
    return (
        f"no work exceeds {scales.work:.1e}, below the rounding of the energies of "
        f"{scales.energy:.1e} that it changes: errors are relative to these, and works and changes "
        "of energies have no digit that is known",
    )
