"""What the works of all surfaces become: energies by name, and one on top of the other."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.plotting.curves import ASPECT, COLOURS, finish, named
from tribo.plotting.marks import note, with_minus
from tribo.plotting.style import COLUMN, INK, NOTE_SIZE, THIN, drawing_on
from tribo.plotting.works import total
from tribo.results.run_result import RunResult

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def energies(result: RunResult) -> dict[str, np.ndarray]:
    """The energies that work became, by name; those that never change are left out."""
    system = result.system
    blocks = result.ledger.blocks.values()
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
        "heat": sum(heats_of(result)),
        "pulling springs": energy_of_pull(result),
    }
    return {name: np.asarray(values) for name, values in changes.items() if np.any(values)}


def has_pull(result: RunResult) -> bool:
    """Whether a surface is pulled by springs."""
    return any("e_pull" in block for block in result.ledger.blocks.values())


def energy_of_pull(result: RunResult) -> np.ndarray:
    """The change of the energy of all pulling springs, (times,)."""
    blocks = result.ledger.blocks.values()
    each = (block["e_pull"] - block["e_pull"][0] for block in blocks if "e_pull" in block)
    return sum(each, start=np.zeros(result.t.size))


def heats_of(result: RunResult) -> list[np.ndarray]:
    """The heat that the reservoir of each surface was given, (times,); empty without any."""
    tables = [result[name] for name in result.ledger.surfaces]
    return [total(table["heat"]) for table in tables if "heat" in table]


def draw_budget(result: RunResult, label: str, ax: Axes | None) -> Axes:
    """Draw the energies one on top of the other; with a label, as one of several results.

    Negative ones are below zero, one under the other, so that no two areas overlap.
    """
    heats = heats_of(result)
    with drawing_on(ax, COLUMN, ASPECT * COLUMN) as ax:
        parts = energies(result)
        top = np.zeros(result.t.size)
        bottom = np.zeros(result.t.size)
        for k, (name, values) in enumerate(parts.items()):
            raised = top + np.maximum(values, 0.0)
            lowered = bottom + np.minimum(values, 0.0)
            # An edge hides those of later parts, which are there as well where these are zero.
            edge: dict[str, Any] = {"color": COLOURS[k], "linewidth": THIN, "zorder": 2 - 0.01 * k}
            ax.plot(result.t, raised, label=named(name, label), **edge)
            if np.any(values < 0.0):
                ax.plot(result.t, lowered, label=f"_{name} below zero", **edge)
            if not label:  # stacks of several results would cover one another
                area: dict[str, Any] = {"color": COLOURS[k], "alpha": 0.35, "linewidth": 0.0}
                ax.fill_between(result.t, top, raised, **area)
                ax.fill_between(result.t, bottom, lowered, **area)
            top = raised
            bottom = lowered
        if "applied_work" in result.system:
            work = result.system["applied_work"] + sum(heats) + energy_of_pull(result)
            name = "applied work + heat" if heats else "applied work"
            name = "work put in" if has_pull(result) else name
            line: dict[str, Any] = {"linewidth": 1.3, "linestyle": (0, (4.0, 3.0))}
            ax.plot(result.t, work, color=INK, label=named(name, label), **line)
            if not label:
                gap = np.max(np.abs(sum(parts.values()) - work))
                text = with_minus(f"|work - sum| ≤ {gap:.1e}")
                place = {"xycoords": "axes fraction", "ha": "right", "fontsize": NOTE_SIZE}
                note(ax, (1.0, 0.0), text, (0.0, -22.0), **place)  # beside the label of time
        finish(ax, result, "energy")
    return ax
