"""Plots of a whole result: lines for few asperites, bands and points for many."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.model.surface import Surface
from tribo.plotting.encounter import encounter_times
from tribo.plotting.maps import surface_map
from tribo.plotting.picture import Picture, pose
from tribo.plotting.series import MEANINGS, WORKS, work_curves
from tribo.plotting.snapshots import sequence
from tribo.plotting.style import (
    COLUMN,
    CYCLE,
    EDGE,
    INK,
    POINTS_PER_INCH,
    WIDE,
    colour_bar,
    drawing_on,
    note,
    point_length,
    time_labels,
)
from tribo.results.force_averages import friction_force
from tribo.results.run_result import RunResult
from tribo.validation import InputError, must_be

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Above this number of asperites of a surface, angles are a band rather than lines.
MOST_LINES = 6

# Percentiles of the asperites between which a band lies.
BAND = (5.0, 95.0)

# Most paths of a phase plot: more cover one another.
MOST_PATHS = 200

# Widths of lines, one surface after the other: equal curves are both seen [points].
WIDTHS = (2.6, 1.0)

# Width of lines where there is one surface, and of all paths in a phase plot [points].
WIDTH, PATH_WIDTH = 1.1, 0.7

# Height of a graph over its width.
ASPECT = 0.66

# Distance between two snapshots [points].
GAP = 9.0

# Distance of the gap of an energy budget from the axes, beside the label of the times [points].
GAP_BELOW = 22.0

# Margin for times left of snapshots [points].
MARGIN = 50.0

# Height that the colours of many asperites take below snapshots [points].
BAR_ROOM = 30.0

# Percentile of the magnitudes of swings that has the strongest colour.
STRONGEST = 99.0


class Plots:
    """The plots of a result.  Each takes ``ax=None`` and returns the Axes.

    Parameters
    ----------
    result : RunResult
    label : str
        Text before the names of lines in legends.
    linestyle : str or tuple
        Line style of matplotlib.
    """

    def __init__(self, result: RunResult, label: str = "", linestyle: Any = "-") -> None:
        self._result = result
        self._label = label
        self._line = {"linestyle": linestyle}

    def angles(self, ax: Axes | None = None) -> Axes:
        """Draw swings (angles of pendulums from rest) over time [rad].

        For a surface of more than 6 asperites, draw the median and a band from the 5th to the
        95th percentile.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to draw in.

        Returns
        -------
        matplotlib.axes.Axes
        """
        result, surfaces = self._result, self._result.scene.surfaces
        with drawing_on(ax, COLUMN, ASPECT * COLUMN) as ax:
            for k, (colour, surface) in enumerate(zip(_colours(), surfaces, strict=False)):
                swing = _swing(result, surface)
                look: dict[str, Any] = {"linewidth": self._width(k)} | self._line
                look |= {"color": colour, "label": self._named(surface.name)}
                if surface.count <= MOST_LINES:
                    for line in ax.plot(result.t, swing, **look)[1:]:
                        line.set_label("_")
                    continue
                low, middle, high = np.percentile(swing, [BAND[0], 50.0, BAND[1]], axis=1)
                ax.plot(result.t, middle, **look)
                ax.fill_between(result.t, low, high, color=colour, alpha=0.2, linewidth=0.0)
            self._over_time(ax, "swing (rad)")
        return ax

    def work(
        self, surface: str | None = None, asperite: int | None = None, ax: Axes | None = None
    ) -> Axes:
        """Draw the works on a surface over time, or those on one asperite; pseudoworks are dashed.

        Parameters
        ----------
        surface : str, optional
            The first without it.
        asperite : int, optional
            All together without it.
        ax : matplotlib.axes.Axes, optional
            The axes to draw on; by default a new figure.

        Returns
        -------
        matplotlib.axes.Axes
        """
        name = self._surface(surface)
        is_new = ax is None
        with drawing_on(ax, WIDE, ASPECT * WIDE) as ax:
            work_curves(self._result, name, asperite, ax=ax)
            of_one = "" if asperite is None else f", asperite {asperite}"
            ax.set_ylabel(f"work on {name}{of_one}")
            drawn = {str(line.get_label()): line for line in ax.lines}
            words = {work: MEANINGS[work] for work in WORKS if work in drawn}
            if is_new and words:
                handles = [drawn[work] for work in words]
                _legend(ax, handles, list(words.values()))
        return ax

    def energy_budget(self, ax: Axes | None = None) -> Axes:
        """Draw the energies that the work put in over time became, one on top of the other.

        The parts are bulk kinetic energy, contact, fields, internal energy and heat, of all
        surfaces together; the heat of baths is separate from internal energy if the scene's output
        asks for the series "energies".  A negative part goes down from the edge before it. The
        last edge is the sum, which equals the work that is put in; a text gives the largest gap
        between the two.  The applied work of the ledger is net of the heat given to reservoirs.
        With reservoirs, heat is a part of the stack, and is added to the applied work.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to draw in.

        Returns
        -------
        matplotlib.axes.Axes
        """
        result = self._result
        with drawing_on(ax, COLUMN, ASPECT * COLUMN) as ax:
            below = np.zeros(result.t.size)
            for colour, (name, values) in zip(_colours(), _budget(result).items(), strict=False):
                edge = below + values
                look: dict[str, Any] = {"linewidth": PATH_WIDTH} | self._line
                ax.plot(result.t, edge, color=colour, label=self._named(name), **look)
                if not self._label:  # stacks of several results would cover one another
                    shade: dict[str, Any] = {"color": colour, "alpha": 0.35, "linewidth": 0.0}
                    ax.fill_between(result.t, below, edge, **shade)
                below = edge
            put_in, name = _work_put_in(result)
            if put_in is not None:
                look = {"linewidth": WIDTHS[0] / 2.0, "linestyle": (0, (4.0, 3.0))}
                ax.plot(result.t, put_in, color=INK, label=self._named(name), **look)
                if not self._label:
                    gap = f"gap {np.max(np.abs(below - put_in)):.1e}"
                    below_axes: dict[str, Any] = {"xycoords": "axes fraction", "ha": "right"}
                    note(ax, (1.0, 0.0), gap, (0.0, -GAP_BELOW), **below_axes)
            self._over_time(ax, "energy")
        return ax

    def friction_force(
        self, surface: str | None = None, after: float | str | None = None, ax: Axes | None = None
    ) -> Axes:
        """Draw the friction force on a surface over time, with its average and 95 % interval.

        Parameters
        ----------
        surface : str, optional
            Name of the surface; without it the first.
        after : float or "auto", optional
            When the average begins, to leave out the run-in; by default the scene's
            ``output.run_in`` [time].
        ax : matplotlib.axes.Axes, optional
            Axes to draw in.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        InputError
            The forces were not recorded, or there are too few samples.
        """
        result, name = self._result, self._surface(surface)
        found = friction_force(result, name, after)
        with drawing_on(ax, COLUMN, ASPECT * COLUMN) as ax:
            given = math.isfinite(found.half_width)
            label = f"{found.mean:.3g}" + f" ± {found.half_width:.1g}" * given
            low, high = found.mean - found.half_width, found.mean + found.half_width
            later = [found.after, result.t[-1]]
            look: dict[str, Any] = {"linewidth": WIDTH} | self._line
            ax.plot(result.t, result[name].friction_force, color=CYCLE[0], **look)
            ax.plot(later, [found.mean] * 2, color=CYCLE[1], label=self._named(label), **look)
            ax.fill_between(later, low, high, color=CYCLE[1], alpha=0.3, linewidth=0.0)
            self._over_time(ax, f"friction force on {name}")
        return ax

    def phase(self, ax: Axes | None = None) -> Axes:
        """Draw the angular velocity of pendulums over their swing.

        Of a surface with more than 200 asperites, 200 are drawn.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to draw in.

        Returns
        -------
        matplotlib.axes.Axes
        """
        result, surfaces = self._result, self._result.scene.surfaces
        with drawing_on(ax, COLUMN, 0.8 * COLUMN) as ax:
            for k, (colour, surface) in enumerate(zip(_colours(), surfaces, strict=False)):
                shown = np.unique(
                    np.linspace(0, surface.count - 1, min(surface.count, MOST_PATHS)).astype(int)
                )
                swing = _swing(result, surface)[:, shown]
                rate = result[surface.name].omega[:, shown]
                faint = max(0.08, min(1.0, 4.0 / len(shown)))
                look: dict[str, Any] = {"color": colour, "alpha": faint} | self._line
                look["linewidth"] = PATH_WIDTH * self._width(k)
                ax.plot(swing, rate, **look)
                ax.plot(swing[-1], rate[-1], "o", color=colour, markersize=2.5)
                ax.plot([], [], color=colour, label=self._named(surface.name), **self._line)
            ax.set(xlabel="swing (rad)", ylabel=r"$\omega$ (rad / time)")
            _legend(ax)
        return ax

    def snapshots(
        self,
        times: Sequence[float] | None = None,
        ax: Axes | None = None,
        bath: bool = False,
    ) -> Axes:
        """Draw all asperites at several times below one another.

        More than 120 asperites are drawn as their bobs alone, coloured by swing.

        Parameters
        ----------
        times : sequence of float, optional
            Each means the nearest sample [time].  Without it four, between which the contact energy
            changes by equal amounts; from start to end where there is no contact.
        ax : matplotlib.axes.Axes, optional
            The axes to draw on; by default a new figure.
        bath : bool
            Whether bath oscillators are drawn, as dots behind their bars with magnified
            displacements; the scene's output must ask for the series "oscillators".

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        InputError
            A time is not in the run, or the oscillators are not recorded.
        """
        result = self._result
        samples = [nearest_sample(result, t) for t in _times(result, times)]
        boxes = np.array([pose(result, k, bath).box for k in samples])
        left, right = boxes[:, 0].min(), boxes[:, 1].max()
        is_given = ax is not None
        with drawing_on(ax, WIDE) as ax:
            point = point_length(ax, (left, right, 0.0, 0.0), left=MARGIN)
            if is_given:  # it may be too low to be filled in its width
                room = ax.bbox.height / ax.figure.dpi * POINTS_PER_INCH - BAR_ROOM
                heights = float((boxes[:, 3] - boxes[:, 2]).sum())
                point = max(point, heights / max(1.0, room - GAP * len(samples)))
            swing, floor = typical_swing(result), 0.0
            for k, box, label in zip(
                samples, boxes, time_labels(result.t[samples].tolist()), strict=True
            ):
                picture = Picture(ax, result, 1.0 / point, swing, bath)
                picture.show(k, (0.0, floor - box[3]))
                middle = floor - 0.5 * (box[3] - box[2])
                note(ax, (left - (MARGIN - EDGE) * point, middle), label, ha="left", va="center")
                floor -= box[3] - box[2] + GAP * point
            if picture.colours is not None:
                floor -= (BAR_ROOM - GAP) * point
                place = (left + 0.6 * (right - left), floor + 16.0 * point)
                colour_bar(ax, picture.colours, place, 0.4 * (right - left), 4.0 * point)
            ax.set_xlim(left - MARGIN * point, right + EDGE * point)
            ax.set_ylim(floor, EDGE * point)
            ax.set_aspect("equal")
        return ax

    def sequence(
        self,
        times: Sequence[float] | None = None,
        surface: str | None = None,
        asperite: int = 0,
        ax: Axes | None = None,
    ) -> Axes:
        """Draw snapshots of an encounter, and the displacements of one asperite between them.

        Parameters
        ----------
        times : sequence of float, optional
            Times of the snapshots [time].  Without it three: as asperites approach, when the energy
            of contact is half spent, and as they recede.
        surface : str, optional
            The first without it.
        asperite : int
            The asperite whose displacements and contact force are shown.
        ax : matplotlib.axes.Axes, optional
            The axes to draw on; by default a new figure.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        InputError
            A time is outside the run.
        """
        times = encounter_times(self._result, 3) if times is None else times
        return sequence(self._result, times, self._surface(surface), asperite, ax=ax)

    def map(
        self,
        quantity: str = "w1",
        surface: str | None = None,
        t: float | None = None,
        ax: Axes | None = None,
    ) -> Axes:
        """Draw a quantity of every asperite of a grid in colour, over x and z.

        Parameters
        ----------
        quantity : str
            "height" about the mean [length], or a series of each asperite: "w1", "theta", or "f1_y"
            where the scene's output asks for the series "forces".
        surface : str, optional
            The first without it.
        t : float, optional
            The nearest sample counts, the last without it [time].
        ax : matplotlib.axes.Axes, optional
            The axes to draw on; by default a new figure.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        InputError
            If the surface is no grid, or has no such series, or the time is not in the run.
        """
        result, name = self._result, self._surface(surface)
        sample = -1 if t is None else nearest_sample(result, t)
        return surface_map(result, name, quantity, sample, ax)

    def _surface(self, name: str | None) -> str:
        names = [surface.name for surface in self._result.scene.surfaces]
        if name is not None and name not in names:
            raise must_be("surface", f"one of {', '.join(names)}", name)
        return name or names[0]

    def _named(self, name: str) -> str:
        return f"{self._label}: {name}" if self._label else name

    def _over_time(self, ax: Axes, ylabel: str) -> None:
        ax.axhline(0.0, color="0.6", linewidth=0.5, zorder=0)
        ax.set(xlabel="$t$", ylabel=ylabel)
        ax.set_xlim(self._result.t[0], self._result.t[-1])
        _legend(ax)

    def _width(self, index: int) -> float:
        return WIDTHS[index % 2] if len(self._result.scene.surfaces) > 1 else WIDTH


def nearest_sample(result: RunResult, t: float) -> int:
    """The sample whose time is nearest.  Raises InputError for a time outside of the run."""
    if not result.t[0] <= t <= result.t[-1]:
        raise InputError("times", f"must be from {result.t[0]:g} to {result.t[-1]:g}, got {t}")
    return int(np.argmin(np.abs(result.t - t)))


def typical_swing(result: RunResult) -> float:
    """The swing that 99 % of all swings in the run do not exceed, at least 1e-9 [rad]."""
    swings = [np.abs(_swing(result, surface)).ravel() for surface in result.scene.surfaces]
    return max(1e-9, float(np.nanpercentile(np.concatenate(swings), STRONGEST)))


def _legend(ax: Axes, lines: Sequence[Any] = (), names: Sequence[str] = ()) -> None:
    """Names of lines, or of all, above the graph, clear of the curves, at most three in a row."""
    handles, labels = (lines, names) if lines else ax.get_legend_handles_labels()
    number = max(1, len(labels))
    rows = math.ceil(number / 3)
    ax.legend(
        handles,
        labels,
        loc="lower center",
        bbox_to_anchor=(0.5, 1.0),
        ncols=math.ceil(number / rows),
        frameon=False,
        fontsize=7.5,
        borderaxespad=0.2,
        columnspacing=1.2,
    )


def _times(result: RunResult, times: Sequence[float] | None) -> Sequence[float]:
    return encounter_times(result, 4) if times is None else times


def _swing(result: RunResult, surface: Surface) -> np.ndarray:
    """(times, asperites) angles of pendulums from their rest, relative to the bars [rad]."""
    series = result[surface.name]
    return np.asarray(series.theta - surface.rest - series.phi)


def _colours() -> tuple[str, ...]:
    return CYCLE * 8


def _budget(result: RunResult) -> dict[str, np.ndarray]:
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


def _work_put_in(result: RunResult) -> tuple[np.ndarray | None, str]:
    """The work that is put in, before heat, and its name; None without a ledger."""
    if "applied_work" not in result.system:
        return None, ""
    heats = _heats(result)
    work = result.system["applied_work"] + sum(heats)
    return np.asarray(work), "applied work + heat" if heats else "applied work"
