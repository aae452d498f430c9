"""The paper's figures, drawn from the computed motion.

J. David Brown, *Work Done by Sliding Friction*.  Figures are in the order of the paper.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tribo import plotting
from tribo.paper.cases import END, Run
from tribo.plotting.marks import Box, arrow, frame, note, point_length, time_labels
from tribo.plotting.picture import Picture
from tribo.plotting.pose import Pose, pose
from tribo.plotting.style import COLUMN, INK, WIDE, drawing_on
from tribo.plotting.works import WORKS
from tribo.validation import InputError, as_path

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True)
class Figure:
    """One figure of the paper."""

    name: str  # of the file, without suffix; "fig03" is figure 3 of the paper
    case: str  # "A" to "E"; empty for the drawing of the model
    draw: Callable[[], Axes]


def draw(folder: str | Path, cases: Iterable[str]) -> list[Path]:
    """Draw the model and the figures of some cases, each as PDF and as PNG.

    Parameters
    ----------
    folder : str or Path
        The folder to write to; made if it does not exist.
    cases : iterable of str
        Of "A" to "E".
    """
    folder = as_path(folder)
    wanted = {"", *cases}
    written: list[Path] = []
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for figure in FIGURES:
            if figure.case in wanted:
                with plotting.style():
                    ax = figure.draw()
                names = (f"{figure.name}.pdf", f"{figure.name}.png")
                written += [plotting.save(ax, folder / name) for name in names]
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError("--figures", f"{folder} cannot be written to ({reason})") from None
    except InputError as error:
        raise InputError("--figures", error.problem) from None
    return written


def _angle(case: str) -> Axes:
    result = Run.extended(case).result
    ax = plotting.axes()
    ax.plot(result.t, result["upper"].theta[:, 0], color=WORKS["w1"].colour)
    ax.axhline(0.0, color="0.6", linewidth=0.5, zorder=0)
    ax.set(xlabel="$t$", ylabel=r"$\theta$ (rad)", xlim=(0.0, END[case]), ylim=(-0.9, 0.9))
    return ax


def _snapshots(case: str, times: tuple[float, ...]) -> Axes:
    """Snapshots side by side, each with a line at the lower centre of mass, which stays."""
    result = Run.extended(case).result
    drawn: list[Pose] = []
    right = 0.0
    for t in times:
        now = pose(result, t)
        drawn.append(now.shifted((right - now.box.left, 0.0)))
        right = drawn[-1].box.right + 0.2  # lengths between snapshots
    boxes = np.array([now.box for now in drawn])
    box = Box(boxes[0, 0], boxes[-1, 1], boxes[:, 2].min(), boxes[:, 3].max())
    with drawing_on(None, WIDE) as ax:
        for now, label in zip(drawn, time_labels(times), strict=True):
            Picture(ax, now, point_length(ax, box.left, box.right))
            note(ax, (0.5 * (now.box.left + now.box.right), box.bottom), label, (0.0, -8.0))
            lower = now.cms[now.index("lower", 0), 0]
            ax.plot(2 * [lower], [box.bottom, box.top], color=INK, lw=0.6, ls=(0, (4, 2)), zorder=1)
        frame(ax, box, bottom=18.0)
    return ax


def _works(case: str) -> Axes:
    result = Run.extended(case).result
    ax = plotting.axes(COLUMN, 0.72 * COLUMN)
    return result.plot.work("upper", 0, (10.0, END[case]), ax)


def _phases(case: str, times: tuple[float, ...]) -> Axes:
    result = Run.extended(case).result
    points = ("bar", "cm", "bob") if case in "AB" else ("cm", "bob")  # free sliding
    return result.plot.sequence(times, points=points, phases=("approach", "recede"))


def _model() -> Axes:
    """The upper asperite with every quantity that the equations of motion name."""
    phi = np.pi / 12
    theta = np.pi / 6
    l1 = 2.2
    l2 = 1.1
    box = Box(-3.05, 3.35, -3.6, 1.8)
    rod = np.array([[np.sin(theta), -np.cos(theta)]])  # from the bar, at the origin, to the bob
    now = Pose(
        parts={"upper": slice(0, 1)},
        bars=np.zeros((1, 2)),
        cms=l2 * rod,
        bobs=(l1 + l2) * rod,
        phi=np.array([phi]),
        theta=np.array([theta]),
        bar_lengths=np.array([5.0]),
        up=np.ones(1),
        is_twisted=np.ones(1, bool),
        aside=np.zeros((1, 2)),
        joined=np.empty((0, 2), int),
        dots=np.empty((0, 2)),
    )
    with drawing_on(None, COLUMN) as ax:
        Picture(ax, now, point_length(ax, box.left, box.right))
        _model_lengths(ax, now)
        _model_angles(ax, now)
        _model_arrows(ax, now)
        frame(ax, box)
    return ax


def _model_lengths(ax: Axes, now: Pose) -> None:
    """Write the names of lengths and masses beside the parts of an asperite."""
    centre = now.bars[0]
    cm = now.cms[0]
    bob = now.bobs[0]
    left, right = now.ends[0]
    rod = np.array([np.cos(now.theta[0]), np.sin(now.theta[0])])  # across it, to the right
    bar = np.array([-np.sin(now.phi[0]), np.cos(now.phi[0])])  # across it, upwards
    for position, text in (
        (0.22 * centre + 0.78 * cm + 0.42 * rod, r"$\ell_2$"),
        (0.5 * (cm + bob) + 0.32 * rod, r"$\ell_1$"),
        (0.9 * cm + 0.1 * bob + 0.4 * rod, "cm"),
        (bob + np.array([0.6, -0.1]), "$m_1$"),
        (centre + 0.4 * bar + (0.55, 0.15), "$m_2,\\ i_2$"),
        (0.65 * left + 0.35 * centre + 0.4 * bar, "$a/2$"),
        (0.65 * right + 0.35 * centre + 0.4 * bar, "$a/2$"),
    ):
        note(ax, position, text)


def _model_angles(ax: Axes, now: Pose) -> None:
    """Draw the axes of an asperite, and arcs for its two angles."""
    from matplotlib.patches import Arc

    for tip in ((2.75, 0.0), (0.0, -1.95)):
        ax.plot([0.0, tip[0]], [0.0, tip[1]], color=INK, lw=0.6, ls=(0, (4, 2)), zorder=3)
    for radius, start, angle in ((2.05, 0.0, now.phi[0]), (1.6, -90.0, now.theta[0])):
        turn = {"theta1": start, "theta2": start + float(np.degrees(angle))}
        ax.add_patch(Arc((0.0, 0.0), 2 * radius, 2 * radius, **turn, lw=0.7, zorder=3))
    note(ax, (2.22, 0.24), r"$\phi$")
    note(ax, (0.36, -1.75), r"$\theta$")


def _model_arrows(ax: Axes, now: Pose) -> None:
    """The axes, positions and forces, each with its name."""
    origin = np.array([-2.4, -3.45])
    cm = now.cms[0]
    bob = now.bobs[0]
    bar = now.bars[0]
    left, right = now.ends[0]
    axis = {"linewidth": 0.6, "linestyle": (0, (4, 2)), "mutation_scale": 6}
    vector = {"linewidth": 0.7, "mutation_scale": 6}
    force = {"linewidth": 1.5, "mutation_scale": 10, "color": "#a50f15"}
    # The place of a name is a part of the way from the start to the tip, and a shift from there.
    for start, step, part, shift, text, look in (
        (origin, (1.3, 0.0), 1.12, (0.0, 0.0), "$x$", axis),
        (origin, (0.0, 1.3), 1.12, (0.0, 0.0), "$y$", axis),
        (origin, cm - origin, 0.5, (0.35, -0.05), r"$\vec{r}_{\rm cm}$", vector),
        (origin, bob - origin, 0.5, (0.1, 0.25), r"$\vec{r}_1$", vector),
        (origin, bar - origin, 0.5, (-0.3, 0.1), r"$\vec{r}_2$", vector),
        (bar, left - bar, 1.0, (-0.3, 0.0), r"$\vec{r}_L$", vector),
        (bar, right - bar, 1.0, (0.3, 0.0), r"$\vec{r}_R$", vector),
        (bob, (1.4, 1.1), 1.0, (0.2, 0.1), r"$\vec{f}_1$", force),
        (bar, (-1.2, 1.05), 1.0, (-0.2, 0.1), r"$\vec{f}_2$", force),
        (left, (-0.2, -0.9), 1.0, (-0.25, 0.0), r"$\vec{f}_L$", force),
        (right, (0.4, 0.95), 1.0, (0.3, 0.0), r"$\vec{f}_R$", force),
    ):
        arrow(ax, start, start + np.array(step), **look)
        place = start + part * np.array(step) + shift
        note(ax, place, text, color=look.get("color", "black"))


FIGURES = (
    Figure("fig01_model", "", _model),
    Figure("fig02_A_angle", "A", partial(_angle, "A")),
    Figure("fig03_A_snapshots", "A", partial(_snapshots, "A", (20.0, 21.5, 23.0, 24.5, 26.0))),
    Figure("fig04_A_work", "A", partial(_works, "A")),
    Figure("fig05_A_sequence", "A", partial(_phases, "A", (15.0, 23.2, 26.0))),
    Figure("fig06_B_work", "B", partial(_works, "B")),
    Figure("fig07_B_sequence", "B", partial(_phases, "B", (15.0, 19.3, 26.0))),
    Figure("fig08_C_work", "C", partial(_works, "C")),
    Figure("fig09_C_sequence", "C", partial(_phases, "C", (13.0, 25.9, 30.0))),
    Figure("fig10_D_work", "D", partial(_works, "D")),
    Figure("fig11_E_sequence", "E", partial(_phases, "E", (13.0, 25.9, 30.0))),
)
