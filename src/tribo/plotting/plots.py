"""``result.plot``: every drawing of a result, and the same drawing of several results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.plotting import measured, snapshots
from tribo.plotting.curves import ASPECT, COLOURS, DASHES, finish, legend, named, swing_of
from tribo.plotting.energies import draw_budget
from tribo.plotting.style import (
    COLUMN,
    MEDIUM,
    THIN,
    WIDE,
    drawing_on,
    style,
)
from tribo.plotting.works import WORKS, draw_works, pseudowork_sample, works_of
from tribo.results.force_averages import has_mean_friction
from tribo.results.run_result import RunResult
from tribo.validation import must_be, one_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


class Plots:
    """The plots of a result: each draws on the Axes `ax`, or in a new figure, and returns the Axes.

    Parameters
    ----------
    result : RunResult
    label : str
        Its name in a graph of several results.
    """

    def __init__(self, result: RunResult, label: str = "") -> None:
        self._result = result
        self._label = label

    def angles(self, ax: Axes | None = None) -> Axes:
        """Draw swings (angles of pendulums from rest) over time [rad].

        For a surface of more than 6 asperites, draw the median and a band from the 5th to the
        95th percentile.
        """
        result = self._result
        with drawing_on(ax, COLUMN, ASPECT * COLUMN) as ax:
            for k, surface in enumerate(result.scene.surfaces):
                swing = swing_of(result, surface)
                line: dict[str, Any] = {"color": COLOURS[k], "linewidth": self._width(k)}
                name = named(surface.name, self._label)
                if surface.count <= 6:  # of more, the median and a band
                    for other in ax.plot(result.t, swing, label=name, **line)[1:]:
                        other.set_label("_")
                    continue
                low, middle, high = np.percentile(swing, [5.0, 50.0, 95.0], axis=1)
                ax.plot(result.t, middle, label=f"{name}: median, 5 to 95 %", **line)
                ax.fill_between(result.t, low, high, color=COLOURS[k], alpha=0.2, linewidth=0.0)
            finish(ax, result, "swing (rad)")
        return ax

    def velocities(self, ax: Axes | None = None) -> Axes:
        """Draw the velocity along x of the centre of mass of each surface [length / time]."""
        result = self._result
        with drawing_on(ax, COLUMN, ASPECT * COLUMN) as ax:
            for k, surface in enumerate(result.scene.surfaces):
                masses = surface.each["m1"] + surface.each["m2"]
                mean = np.average(result[surface.name].vx_cm, axis=1, weights=masses)
                label = named(surface.name, self._label)
                ax.plot(result.t, mean, color=COLOURS[k], label=label, linewidth=self._width(k))
            finish(ax, result, "velocity (length / time)")
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
            The axes to draw on; by default a new figure, whose legend has the forces in words.

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
        if asperite is None and self._result.scene.output.ledger == "none":
            raise must_be("output.ledger", '"asperites" or "surfaces" for works', "none")
        works = works_of(self._result, name, asperite)
        is_new = ax is None
        with drawing_on(ax, WIDE, ASPECT * WIDE) as ax:
            lines = draw_works(ax, self._result, works, span)
            scene = self._result.scene
            number = scene.surfaces[scene.index_of(name)].count
            of_one = "" if asperite is None or number == 1 else f", asperite {asperite}"
            ax.set_ylabel(f"work on {name}{of_one}")
            words = {WORKS[work].meaning: line for work, line in lines.items() if work in WORKS}
            if any(line.is_dashed() for line in lines.values()):
                words["pseudoworks"] = pseudowork_sample()
            if is_new and words:
                legend(ax, list(words.values()), list(words))
        return ax

    def energy_budget(self, ax: Axes | None = None) -> Axes:
        """Draw the energies that the work put in over time became, one on top of the other.

        The parts are bulk kinetic energy, contact, fields, internal energy, heat and the springs
        of pulled surfaces, of all surfaces together; the heat of baths is separate from internal
        energy if the scene's output asks for the series "energies".  Negative parts are below
        zero, one under the other.  The height of the stack above zero less the depth below it is
        the sum, which equals the work that is put in; a text gives the largest gap between the two.
        The applied work of the ledger is net of the
        heat given to reservoirs, and is that of pulling springs, not of their stage.  With
        reservoirs, heat is a part of the stack, and is added to the applied work.  On pulled
        surfaces, the work put in is that of the stage in place of that of the springs.
        """
        return draw_budget(self._result, self._label, ax)

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
        return measured.draw_friction(self._result, self._surface(surface), after, ax)

    def loop(
        self, surface: str | None = None, position: object = None, ax: Axes | None = None
    ) -> Axes:
        """Draw the friction loop of a surface: see :meth:`tribo.Result.loop`.

        Parameters
        ----------
        surface : str, optional
            The first without it.
        position : array_like, (times,), optional
            The position of the stage of a drive of one's own [length].
        """
        return measured.draw_loop(self._result, self._surface(surface), position, ax)

    def friction_map(
        self, surface: str | None = None, force: str = "friction", ax: Axes | None = None
    ) -> Axes:
        """Draw the mean force of each asperite where it rests; along x of a row.

        Parameters
        ----------
        surface : str, optional
            The first without it.
        force : "friction" or "normal"
            Which of the forces of :meth:`tribo.Result.friction_map`.
        """
        return measured.draw_map(self._result, self._surface(surface), force, ax)

    def contacts(self, surface: str | None = None, ax: Axes | None = None) -> Axes:
        """Draw the share of asperites in contact over time, of the first surface by default."""
        return measured.draw_contacts(self._result, self._surface(surface), ax)

    def phase(self, ax: Axes | None = None) -> Axes:
        """Draw the angular velocity of pendulums over their swing.

        Of a surface with more than 200 asperites, 200 are drawn: more would cover one another.
        """
        result = self._result
        with drawing_on(ax, COLUMN, 0.8 * COLUMN) as ax:
            for k, surface in enumerate(result.scene.surfaces):
                shown = np.unique(np.linspace(0, surface.count - 1, 200).astype(int))
                swing = swing_of(result, surface)[:, shown]
                rate = result[surface.name].omega[:, shown]
                faint = max(0.08, min(1.0, 4.0 / len(shown)))
                width = THIN * self._width(k)
                colour = COLOURS[k]
                ax.plot(swing, rate, linewidth=width, alpha=faint, color=colour)
                ax.plot(swing[-1], rate[-1], "o", color=colour, markersize=2.5)
                ax.plot([], [], label=named(surface.name, self._label), color=colour)
            ax.set(xlabel="swing (rad)", ylabel=r"$\omega$ (rad / time)")
            legend(ax)
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
        drawn as their bobs alone, coloured by swing.  Beside a single surface, a line shows the
        corrugation of its field, and all snapshots show one stretch of it if that is at most 6
        times as wide as one of them.

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
            There is no such surface, a time is not in the run, the oscillators are not recorded, or
            a calculator of the scene fails.
        """
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
        return measured.draw_grid(self._result, self._surface(surface), quantity, t, ax)

    def overview(self) -> Figure:
        """Draw snapshots, works on the first surface, energies, angles and phases in one figure.

        Where sliding goes on and forces are recorded, the friction force on the first surface takes
        the place of the phases; where all pendulums are rigid, velocities that of the angles.

        Raises
        ------
        InputError
            The run was too large to keep the places of single asperites.
        """
        from tribo.plotting.shown import ShownFigure

        result = self._result
        with style():
            figure = ShownFigure(figsize=(7.0, 7.6), layout="constrained")
            figure.suptitle(result.scene.title)
            places = figure.subplot_mosaic(
                [["snapshots", "snapshots"], ["work", "energies"], ["angles", "last"]],
                height_ratios=(1.5, 1.0, 1.0),
            )
            self.energy_budget(ax=places["energies"])
            rigid = all(surface.asperite.is_rigid for surface in result.scene.surfaces)
            (self.velocities if rigid else self.angles)(ax=places["angles"])
            slides = has_mean_friction(result.scene) and "friction_force" in result[self._surface()]
            (self.friction_force if slides else self.phase)(ax=places["last"])
            if result.scene.output.ledger != "none":
                self.work(ax=places["work"])
                if any(line.is_dashed() for line in places["work"].get_lines()):
                    legend(places["work"], [pseudowork_sample()], ["pseudoworks"])
            if result.scene.periodic:
                caption = "one period; bars that leave it enter at the other side"
                places["snapshots"].set_title(caption, fontsize="medium")
            figure.draw_without_rendering()  # lays out the Axes, whose sizes snapshots need
            self.snapshots(ax=places["snapshots"])
            places["snapshots"].set_axis_off()
            if not places["work"].lines:
                places["work"].set_axis_off()
        return figure

    def _surface(self, name: str | None = None) -> str:
        scene = self._result.scene
        return scene.surfaces[0 if name is None else scene.index_of(name)].name

    def _width(self, index: int) -> float:
        """The width of a surface's lines; with two widths, equal curves are both seen [points]."""
        return (2.6, 1.0)[index % 2] if len(self._result.scene.surfaces) > 1 else MEDIUM


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
    from matplotlib import rc_context

    one_of("kind", kind, ("angles", "energy_budget", "phase"))
    if not 1 <= len(results) <= len(DASHES):
        raise must_be("results", f"1 to {len(DASHES)} results", len(results))
    with drawing_on(ax, WIDE, ASPECT * WIDE) as ax:
        for dashes, (label, result) in zip(DASHES, results.items(), strict=False):
            with rc_context({"lines.linestyle": dashes}):
                getattr(Plots(result, label), kind)(ax=ax)
        if kind != "phase":
            begin = min(result.t[0] for result in results.values())
            end = max(result.t[-1] for result in results.values())
            ax.set_xlim(begin, end)
    return ax
