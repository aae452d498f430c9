"""``result.plot``: every drawing of a result."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.plotting import budget, curves, snapshots
from tribo.plotting.maps import surface_map
from tribo.plotting.pose import nearest_sample
from tribo.plotting.style import COLUMN, WIDE, drawing_on, style
from tribo.plotting.works import WORKS, draw_works, works_of
from tribo.results.force_averages import friction_force, has_mean_friction
from tribo.results.run_result import RunResult
from tribo.validation import must_be

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Above this number of asperites of a surface, angles are a band rather than lines.
MOST_LINES = 6
# Percentiles of the asperites between which a band lies.
BAND = (5.0, 95.0)
# Most paths of a phase plot: more cover one another.
MOST_PATHS = 200
# Widths of lines, one surface after the other: equal curves are both seen [points].
WIDTHS = (2.6, 1.0)
# Width of lines where there is one surface [points].
WIDTH = 1.1
# Width and height of the overview [inch].
SIZE = (7.0, 7.6)


class Plots:
    """The plots of a result: each draws on the Axes `ax`, or in a new figure, and returns the Axes.

    Parameters
    ----------
    result : RunResult
    look : Look
        What tells its lines from those of other results in the same graph.
    """

    def __init__(self, result: RunResult, look: curves.Look = curves.PLAIN) -> None:
        self._result = result
        self._look = look

    def angles(self, ax: Axes | None = None) -> Axes:
        """Draw swings (angles of pendulums from rest) over time [rad].

        For a surface of more than 6 asperites, draw the median and a band from the 5th to the
        95th percentile.
        """
        result, look = self._result, self._look
        with drawing_on(ax, COLUMN, curves.ASPECT * COLUMN) as ax:
            for k, surface in enumerate(result.scene.surfaces):
                swing = curves.swing_of(result, surface)
                line: dict[str, Any] = {"linewidth": self._width(k), "linestyle": look.linestyle}
                line |= {"color": curves.COLOURS[k], "label": look.named(surface.name)}
                if surface.count <= MOST_LINES:
                    for other in ax.plot(result.t, swing, **line)[1:]:
                        other.set_label("_")
                    continue
                low, middle, high = np.percentile(swing, [BAND[0], 50.0, BAND[1]], axis=1)
                ax.plot(result.t, middle, **line)
                ax.fill_between(
                    result.t, low, high, color=curves.COLOURS[k], alpha=0.2, linewidth=0.0
                )
            curves.finish(ax, result, "swing (rad)")
        return ax

    def work(
        self,
        surface: str | None = None,
        asperite: int | None = None,
        span: tuple[float, float] | None = None,
        ax: Axes | None = None,
    ) -> Axes:
        """Draw the works on a surface over time, or those on one asperite; pseudoworks are dashed.

        The work of a force on a surface is the sum of its works on the asperites, and the total W
        that of all external forces.  Works that are zero throughout are left out, and so is the
        total pseudowork.

        Parameters
        ----------
        surface : str, optional
            The first without it.
        asperite : int, optional
            All together without it.
        span : tuple of float, optional
            Times between which curves are shown; labels stand at the later one [time].
        ax : matplotlib.axes.Axes, optional
            The axes to draw on; by default a new figure, with the forces in words.

        Returns
        -------
        matplotlib.axes.Axes
            The label of each line is the name of the work in the ledger, as "w1_ps".

        Raises
        ------
        InputError
            The result has no works, or none of single asperites.
        """
        name = self._surface(surface)
        if self._result.scene.output.ledger == "none":
            one = '"asperites" for works of single asperites'
            wanted = '"asperites" or "surfaces" for works' if asperite is None else one
            raise must_be("output.ledger", wanted, "none")
        works = works_of(self._result, name, asperite)
        is_new = ax is None
        with drawing_on(ax, WIDE, curves.ASPECT * WIDE) as ax:
            lines = draw_works(ax, self._result, works, span)
            (number,) = (s.count for s in self._result.scene.surfaces if s.name == name)
            of_one = "" if asperite is None or number == 1 else f", asperite {asperite}"
            ax.set_ylabel(f"work on {name}{of_one}")
            words = {WORKS[work].meaning: line for work, line in lines.items() if work in WORKS}
            if is_new and words:
                curves.legend(ax, list(words.values()), list(words))
        return ax

    def energy_budget(self, ax: Axes | None = None) -> Axes:
        """Draw the energies that the work put in over time became, one on top of the other.

        The parts are bulk kinetic energy, contact, fields, internal energy and heat, of all
        surfaces together; the heat of baths is separate from internal energy if the scene's output
        asks for the series "energies".  A negative part goes down from the edge before it. The
        last edge is the sum, which equals the work that is put in; a text gives the largest gap
        between the two.  The applied work of the ledger is net of the heat given to reservoirs.
        With reservoirs, heat is a part of the stack, and is added to the applied work.
        """
        return budget.energy_budget(self._result, self._look, ax)

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

        Raises
        ------
        InputError
            The forces were not recorded, or there are too few samples.
        """
        result, look, name = self._result, self._look, self._surface(surface)
        found = friction_force(result, name, after)
        with drawing_on(ax, COLUMN, curves.ASPECT * COLUMN) as ax:
            interval = f" ± {found.half_width:.1g}" * math.isfinite(found.half_width)
            low, high = found.mean - found.half_width, found.mean + found.half_width
            later, line = (
                [found.after, result.t[-1]],
                {"linewidth": WIDTH, "linestyle": look.linestyle},
            )
            ax.plot(result.t, result[name].friction_force, color=curves.COLOURS[0], **line)
            label = look.named(f"{found.mean:.3g}{interval}")
            ax.plot(later, [found.mean] * 2, color=curves.COLOURS[1], label=label, **line)
            ax.fill_between(later, low, high, color=curves.COLOURS[1], alpha=0.3, linewidth=0.0)
            curves.finish(ax, result, f"friction force on {name}")
        return ax

    def phase(self, ax: Axes | None = None) -> Axes:
        """Draw the angular velocity of pendulums over their swing.

        Of a surface with more than 200 asperites, 200 are drawn.
        """
        result, look = self._result, self._look
        with drawing_on(ax, COLUMN, 0.8 * COLUMN) as ax:
            for k, surface in enumerate(result.scene.surfaces):
                number = min(surface.count, MOST_PATHS)
                shown = np.unique(np.linspace(0, surface.count - 1, number).astype(int))
                swing = curves.swing_of(result, surface)[:, shown]
                rate = result[surface.name].omega[:, shown]
                line: dict[str, Any] = {"color": curves.COLOURS[k], "linestyle": look.linestyle}
                width = curves.PATH_WIDTH * self._width(k)
                faint = max(0.08, min(1.0, 4.0 / len(shown)))
                ax.plot(swing, rate, linewidth=width, alpha=faint, **line)
                ax.plot(swing[-1], rate[-1], "o", color=curves.COLOURS[k], markersize=2.5)
                ax.plot([], [], label=look.named(surface.name), **line)
            ax.set(xlabel="swing (rad)", ylabel=r"$\omega$ (rad / time)")
            curves.legend(ax)
        return ax

    def snapshots(
        self,
        times: Sequence[float] | None = None,
        forces: tuple[str, int] | None = None,
        bath: bool = False,
        ax: Axes | None = None,
    ) -> Axes:
        """Draw all asperites at one or several times.

        Narrow snapshots stand in a row, wide ones below one another.  More than 120 asperites are
        drawn as their bobs alone, coloured by swing.

        Parameters
        ----------
        times : sequence of float, optional
            Each means the nearest sample [time].  Without it four, between which the contact energy
            changes by equal amounts; from start to end where there is no contact.
        forces : tuple of str and int, optional
            Surface and asperite whose contact force f1 is shown, and that on the nearest bob of
            another surface.  Arrows have the directions of the forces, not their sizes.
        bath : bool
            Whether bath oscillators are drawn, as dots behind their bars with magnified
            displacements; the scene's output must ask for the series "oscillators".

        Raises
        ------
        InputError
            A time is not in the run, the oscillators are not recorded, or a calculator of the scene
            fails.
        """
        times = snapshots.encounter_times(self._result, 4) if times is None else times
        return snapshots.snapshots(self._result, times, forces, bath, ax)

    def sequence(
        self,
        times: Sequence[float] | None = None,
        surface: str | None = None,
        asperite: int = 0,
        points: Sequence[str] = ("bar", "cm", "bob"),
        phases: Sequence[str] = (),
        ax: Axes | None = None,
    ) -> Axes:
        """Draw snapshots of an encounter, and the displacements of one asperite between them.

        Contact forces are shown in the first and the last snapshot.

        Parameters
        ----------
        times : sequence of float, optional
            Times of the snapshots; between samples, places are interpolated [time].  Without it
            three: as asperites approach, when the energy of contact is half spent, and as they
            recede.
        surface : str, optional
            The first without it.
        asperite : int
            The asperite whose displacements along x and contact force are shown.
        points : sequence of str
            Its points, of "bar", "cm" and "bob".
        phases : sequence of str
            Words beside the gaps, one fewer than the times.

        Raises
        ------
        InputError
            A time is outside the run, or a calculator of the scene fails.
        """
        times = snapshots.encounter_times(self._result, 3) if times is None else times
        whose = (self._surface(surface), asperite)
        return snapshots.sequence(self._result, times, whose, points, phases, ax)

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

        Raises
        ------
        InputError
            If the surface is no grid, or has no such series, or the time is not in the run.
        """
        sample = -1 if t is None else nearest_sample(self._result, t)
        return surface_map(self._result, self._surface(surface), quantity, sample, ax)

    def overview(self) -> Figure:
        """Draw snapshots, works on the first surface, energies, angles and phases in one figure.

        Where sliding goes on and forces are recorded, the friction force on the first surface takes
        the place of the phases.

        Raises
        ------
        InputError
            The run was too large to keep the places of single asperites.
        """
        from tribo.plotting.shown import ShownFigure

        result = self._result
        with style():
            figure = ShownFigure(figsize=SIZE, layout="constrained")
            figure.suptitle(result.scene.title)
            places = figure.subplot_mosaic(
                [["snapshots", "snapshots"], ["work", "energies"], ["angles", "last"]],
                height_ratios=(1.5, 1.0, 1.0),
            )
            self.energy_budget(ax=places["energies"])
            self.angles(ax=places["angles"])
            slides = has_mean_friction(result.scene) and "friction_force" in result[self._surface()]
            (self.friction_force if slides else self.phase)(ax=places["last"])
            if result.scene.output.ledger != "none":
                self.work(ax=places["work"])
            figure.draw_without_rendering()  # lays out the Axes, whose sizes snapshots need
            self.snapshots(ax=places["snapshots"])
            places["snapshots"].set_axis_off()
            if not places["work"].lines:
                places["work"].set_axis_off()
        return figure

    def _surface(self, name: str | None = None) -> str:
        names = [surface.name for surface in self._result.scene.surfaces]
        if name is not None and name not in names:
            raise must_be("surface", f"one of {', '.join(names)}", name)
        return name or names[0]

    def _width(self, index: int) -> float:
        return WIDTHS[index % 2] if len(self._result.scene.surfaces) > 1 else WIDTH
