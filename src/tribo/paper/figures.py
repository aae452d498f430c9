"""The paper's figures, drawn again from the computed motion.

J. David Brown, *Work Done by Sliding Friction*.  Figures have the paper's order; its labels for
them are those in FIGURES.
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
from tribo.plotting import COLUMN, INK, WIDE, arrow, note
from tribo.plotting.geometry import Pose, Poses, poses
from tribo.validation import InputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes


FORCE = "#a50f15"
GUTTER = 0.2  # between snapshots [length]


@dataclass(frozen=True)
class Figure:
    """One figure: the file's name, the paper's own label, and how it is drawn."""

    name: str
    label: str
    case: str  # "" for the model itself
    draw: Callable[[], Axes]


def draw(folder: Path, cases: Iterable[str]) -> list[Path]:
    """Draw the model and the figures of the given cases into a folder; returns the files.

    Every figure is written as PDF and as PNG.  Raises InputError if the folder cannot be used.
    """
    wanted = {"", *cases}
    written: list[Path] = []
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with plotting.style():
            for figure in FIGURES:
                if figure.case in wanted:
                    written += plotting.save(figure.draw(), folder / figure.name)
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError("--figures", f"{folder} cannot be written to ({reason})") from None
    return written


def _angle(case: str) -> Axes:
    ax = plotting.axes(COLUMN, 0.62 * COLUMN)
    plotting.angle_curve(ax, Run.followed(case).result)
    ax.axhline(0.0, color="0.6", linewidth=0.5, zorder=0)
    ax.set_xlim(0.0, END[case])
    ax.set_ylim(-0.9, 0.9)
    return ax


def _snapshots(case: str, times: tuple[float, ...]) -> Axes:
    """Snapshots side by side, and through each a line where the lower centre of mass stays."""
    ax = plotting.axes(WIDE)
    result = Run.followed(case).result
    drawn: list[Poses] = []
    right = 0.0
    for t in times:
        left = plotting.extent(poses(result, t))[0]
        drawn.append(plotting.snapshot(ax, result, t, shift=(right - left, 0.0)))
        right = plotting.extent(drawn[-1])[1] + GUTTER
    box = plotting.extent(*drawn)
    for there, label in zip(drawn, plotting.clock(times), strict=True):
        left, right, *_ = plotting.extent(there)
        note(ax, (0.5 * (left + right), box[2]), label, (0.0, -8.0))
        (lower,) = there["lower"]
        ax.plot(2 * [lower.cm[0]], box[2:], color=INK, lw=0.6, ls=(0, (4, 2)), zorder=1)
    plotting.frame(ax, box, bottom=18.0)
    plotting.trim(ax)
    return ax


def _works(case: str) -> Axes:
    ax = plotting.axes(COLUMN, 0.72 * COLUMN)
    plotting.work_curves(ax, Run.followed(case).result, span=(10.0, END[case]))
    return ax


def _phases(case: str, times: tuple[float, ...], points: tuple[str, ...]) -> Axes:
    ax = plotting.axes(COLUMN)
    result = Run.followed(case).result
    plotting.sequence(ax, result, times, points=points, phases=("approach", "recede"))
    plotting.trim(ax)
    return ax


def _model() -> Axes:
    """The upper asperite with all that the equations of motion name."""
    ax = plotting.axes(COLUMN)
    theta, l2 = np.pi / 6, 1.6
    centre = np.array([l2 * np.sin(theta), -l2 * np.cos(theta)])  # so that the bar's is at (0, 0)
    pose = Pose(centre, theta, phi=np.pi / 12, l1=1.7, l2=l2, bar_length=5.0)
    plotting.draw_asperite(ax, pose)
    _model_lengths(ax, pose)
    _model_angles(ax, pose)
    _model_places(ax, pose)
    _model_forces(ax, pose)
    plotting.frame(ax, (-3.05, 3.2, -3.6, 1.8))
    plotting.trim(ax)
    return ax


def _model_lengths(ax: Axes, pose: Pose) -> None:
    rod = np.array([np.cos(pose.theta), np.sin(pose.theta)])  # across it, to the right
    bar = np.array([-np.sin(pose.phi), np.cos(pose.phi)])  # across it, upwards
    left, right = pose.ends
    for place, text in (
        (0.4 * pose.bar + 0.6 * pose.cm + 0.32 * rod, r"$\ell_2$"),
        (0.5 * (pose.cm + pose.bob) + 0.32 * rod, r"$\ell_1$"),
        (pose.cm + 0.4 * rod, "cm"),
        (pose.bob + np.array([0.6, -0.1]), "$m_1$"),
        (pose.bar + 0.4 * bar + (0.55, 0.15), "$m_2,\\ i_2$"),
        (0.65 * left + 0.35 * pose.bar + 0.4 * bar, "$a/2$"),
        (0.65 * right + 0.35 * pose.bar + 0.4 * bar, "$a/2$"),
    ):
        note(ax, place, text)


def _model_angles(ax: Axes, pose: Pose) -> None:
    from matplotlib.patches import Arc

    for tip in ((2.75, 0.0), (0.0, -1.45)):
        ax.plot([0.0, tip[0]], [0.0, tip[1]], color=INK, lw=0.6, ls=(0, (4, 2)), zorder=3)
    for radius, start, angle in ((2.05, 0.0, pose.phi), (1.05, -90.0, pose.theta)):
        turn = {"theta1": start, "theta2": start + float(np.degrees(angle))}
        ax.add_patch(Arc((0.0, 0.0), 2 * radius, 2 * radius, **turn, lw=0.7, zorder=3))
    note(ax, (2.22, 0.24), r"$\phi$")
    note(ax, (0.31, -1.2), r"$\theta$")


def _model_places(ax: Axes, pose: Pose) -> None:
    origin = np.array([-2.4, -3.45])
    for axis, text in zip(1.3 * np.eye(2), ("$x$", "$y$"), strict=True):
        arrow(ax, origin, origin + axis, linewidth=0.6, linestyle=(0, (4, 2)), mutation_scale=6)
        note(ax, origin + 1.12 * axis, text)
    for tip, shift, text in (
        (pose.cm, (-0.1, 0.25), r"$\vec{r}_{\rm cm}$"),
        (pose.bob, (0.1, 0.25), r"$\vec{r}_1$"),
        (pose.bar, (-0.3, 0.1), r"$\vec{r}_2$"),
    ):
        arrow(ax, origin, tip, linewidth=0.7, mutation_scale=6)
        note(ax, 0.5 * (origin + tip) + shift, text)
    for end, shift, text in (
        (pose.ends[0], (-0.3, 0.0), r"$\vec{r}_L$"),
        (pose.ends[1], (0.3, 0.0), r"$\vec{r}_R$"),
    ):
        arrow(ax, pose.bar, end, linewidth=0.7, mutation_scale=6)
        note(ax, end + shift, text)


def _model_forces(ax: Axes, pose: Pose) -> None:
    for start, force, shift, text in (
        (pose.bob, (1.4, 1.1), (0.2, 0.1), r"$\vec{f}_1$"),
        (pose.bar, (-1.2, 1.05), (-0.2, 0.1), r"$\vec{f}_2$"),
        (pose.ends[0], (-0.2, -0.9), (-0.25, 0.0), r"$\vec{f}_L$"),
        (pose.ends[1], (0.4, 0.95), (0.3, 0.0), r"$\vec{f}_R$"),
    ):
        tip = start + np.array(force)
        arrow(ax, start, tip, linewidth=1.5, color=FORCE, mutation_scale=10)
        note(ax, tip + shift, text, color=FORCE)


ALL_THREE = ("bar", "cm", "bob")
SLIDING_FREELY = ("cm", "bob")

FIGURES = (
    Figure("fig01_model", "UpperBlockFig", "", _model),
    Figure("fig02_A_angle", "thetaelecfig", "A", partial(_angle, "A")),
    Figure(
        "fig03_A_snapshots",
        "Elec20thru26",
        "A",
        partial(_snapshots, "A", (20.0, 21.5, 23.0, 24.5, 26.0)),
    ),
    Figure("fig04_A_work", "workpowerrepulsionfig", "A", partial(_works, "A")),
    Figure(
        "fig05_A_sequence",
        "ForcedRepulsiveFig",
        "A",
        partial(_phases, "A", (15.0, 23.2, 26.0), ALL_THREE),
    ),
    Figure("fig06_B_work", "workpowerEAB", "B", partial(_works, "B")),
    Figure(
        "fig07_B_sequence",
        "ForcedAttractiveFig",
        "B",
        partial(_phases, "B", (15.0, 19.3, 26.0), ALL_THREE),
    ),
    Figure("fig08_C_work", "WorkPowerERU", "C", partial(_works, "C")),
    Figure(
        "fig09_C_sequence",
        "FreeAttractiveFig",
        "C",
        partial(_phases, "C", (13.0, 25.9, 30.0), SLIDING_FREELY),
    ),
    Figure("fig10_D_work", "WorkPowerEAU", "D", partial(_works, "D")),
    Figure(
        "fig11_E_sequence",
        "FreeAttractiveFigNewFrame",
        "E",
        partial(_phases, "E", (13.0, 25.9, 30.0), SLIDING_FREELY),
    ),
)
