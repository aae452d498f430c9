"""One figure of a whole result, as `tribo plot` draws it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tribo.plotting.plots import Plots
from tribo.plotting.style import style
from tribo.results.force_averages import has_mean_friction
from tribo.results.run_result import RunResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Width and height of the figure [inch].
SIZE = (7.0, 7.6)


def overview(result: RunResult) -> Figure:
    """Draw snapshots, works on the first surface, energies, angles and phases of a result.

    Where sliding goes on and forces are recorded, the friction force on the first surface takes the
    place of the phases.

    Parameters
    ----------
    result : RunResult

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        The run was too large to keep the places of single asperites.
    """
    from tribo.plotting.shown import ShownFigure

    with style():
        figure = ShownFigure(figsize=SIZE, layout="constrained")
        figure.suptitle(result.scene.title)
        first = result.scene.surfaces[0].name
        slides = has_mean_friction(result.scene) and "friction_force" in result[first]
        last = "friction" if slides else "phase"
        places = figure.subplot_mosaic(
            [["snapshots", "snapshots"], ["work", "energies"], ["angles", last]],
            height_ratios=(1.5, 1.0, 1.0),
        )
        plots = Plots(result)
        plots.energy_budget(ax=places["energies"])
        plots.angles(ax=places["angles"])
        (plots.friction_force if slides else plots.phase)(ax=places[last])
        if result.scene.output.ledger != "none":
            plots.work(ax=places["work"])
        figure.draw_without_rendering()  # lays out the Axes, whose sizes snapshots need
        plots.snapshots(ax=places["snapshots"])
        for name in ("snapshots", "work"):
            if not places[name].lines:  # no curves
                places[name].set_axis_off()
    return figure
