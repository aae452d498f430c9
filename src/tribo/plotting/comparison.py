"""The same plot of several results in one figure."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from tribo.plotting.curves import ASPECT, Look
from tribo.plotting.plots import Plots
from tribo.plotting.style import WIDE, drawing_on
from tribo.results.run_result import RunResult
from tribo.validation import must_be

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Line styles of the results of a comparison, one after the other.
DASHES: tuple[Any, ...] = ("-", (0, (4, 2)), (0, (1, 1.2)), (0, (5, 1.5, 1, 1.5)))


def compare(
    results: Mapping[str, RunResult], kind: str = "energy_budget", ax: Axes | None = None
) -> Axes:
    """Draw the same plot of several results in one figure, each with a line style of its own.

    Parameters
    ----------
    results : mapping of str to RunResult
        Results by the names that legends show.
    kind : str
        "angles", "energy_budget" or "phase".
    ax : matplotlib.axes.Axes, optional
        The axes to draw on; by default a new figure.

    Raises
    ------
    InputError
        If there is no plot of this kind, or no result.

    Examples
    --------
    ``plotting.compare({"soft": one, "stiff": other}, "angles")``
    """
    if kind not in (kinds := ("angles", "energy_budget", "phase")):
        raise must_be("kind", f"one of {', '.join(kinds)}", kind)
    if not 1 <= len(results) <= len(DASHES):
        raise must_be("results", f"1 to {len(DASHES)} results", len(results))
    with drawing_on(ax, WIDE, ASPECT * WIDE) as ax:
        for dashes, (label, result) in zip(DASHES, results.items(), strict=False):
            getattr(Plots(result, Look(label, dashes)), kind)(ax=ax)
        if kind != "phase":
            ends = [result.t[k] for result in results.values() for k in (0, -1)]
            ax.set_xlim(min(ends), max(ends))
    return ax
