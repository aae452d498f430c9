"""What the work put in became: energies on top of one another."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tribo.plotting.curves import ASPECT, COLOURS, PATH_WIDTH, Look, finish
from tribo.plotting.marks import note
from tribo.plotting.style import COLUMN, INK, drawing_on
from tribo.results.run_result import RunResult

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Width and dashes of the line of the work put in.
WORK_WIDTH, DASHES = 1.3, (0, (4.0, 3.0))
# Distance of the text of the gap from the axes, beside the label of the times [points].
GAP_BELOW = 22.0


def energy_budget(result: RunResult, look: Look, ax: Axes | None) -> Axes:
    """Draw the energies, and the work put in; see :meth:`tribo.plotting.Plots.energy_budget`."""
    with drawing_on(ax, COLUMN, ASPECT * COLUMN) as ax:
        below = np.zeros(result.t.size)
        for colour, (name, values) in zip(COLOURS, _energies(result).items(), strict=False):
            edge = below + values
            line = {"color": colour, "label": look.named(name), "linestyle": look.linestyle}
            ax.plot(result.t, edge, linewidth=PATH_WIDTH, **line)
            if not look.label:  # stacks of several results would cover one another
                ax.fill_between(result.t, below, edge, color=colour, alpha=0.35, linewidth=0.0)
            below = edge
        if "applied_work" in result.system:
            heats = _heats(result)
            work = result.system["applied_work"] + sum(heats)
            name = look.named("applied work + heat" if heats else "applied work")
            line = {"color": INK, "label": name, "linestyle": DASHES}
            ax.plot(result.t, work, linewidth=WORK_WIDTH, **line)
            if not look.label:
                text = f"gap {np.max(np.abs(below - work)):.1e}"
                note(ax, (1.0, 0.0), text, (0.0, -GAP_BELOW), xycoords="axes fraction", ha="right")
        finish(ax, result, "energy")
    return ax


def _energies(result: RunResult) -> dict[str, np.ndarray]:
    """The energies that work became, by name; those that never change are left out."""
    system, blocks = result.system, result.ledger.blocks.values()
    kinetic = sum(block["delta_K"] for block in blocks)
    internal = sum(block["delta_E_int"] for block in blocks)
    contact = system["contact_energy"] - system["contact_energy"][0]
    field = system["total_energy_change"] - contact - kinetic - internal
    bath = sum(block["heat_bath"] for block in blocks if "heat_bath" in block)
    changes = {
        "kinetic": kinetic,
        "contact": contact,
        "field": field if result.scene.fields else 0.0,
        "internal": internal - bath,
        "bath": bath,
        "heat": sum(_heats(result)),
    }
    return {name: np.asarray(values) for name, values in changes.items() if np.any(values)}


def _heats(result: RunResult) -> list[np.ndarray]:
    """The heat that the reservoir of each surface was given, (times,); empty without any."""
    tables = [result[name] for name in result.ledger.surfaces]
    heats = [np.asarray(table["heat"]) for table in tables if "heat" in table]
    return [heat.reshape(result.t.size, -1).sum(axis=1) for heat in heats]
