"""With thermal noise: the half-width of means against the number of members and their cost."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from tribo import interrupts
from tribo.accuracy.scales import reported_scales
from tribo.ensembles import ensemble
from tribo.kernels.status import Status
from tribo.model.scene import Scene
from tribo.prepared import Simulation
from tribo.results.averages import mean_text, student
from tribo.simulation import prepare
from tribo.validation import POSITIVE, InputError, number, one_of

if TYPE_CHECKING:
    import xarray

# Half-widths for which the members are given, in units of the scale of energies.
GOALS = (1e-1, 1e-2, 1e-3)
# Members of the first ensemble: at 15 degrees of freedom the quantile of Student's distribution is
# 9 % above that of the normal.
FEWEST = 16
# Ratio of the members of two ensembles: half of the half-width.
RATIO = 4
# Members for a tenth of the half-width, in units of those for all of it.
RATIO_OF_DIGIT = 100


@dataclass(frozen=True)
class MeanRow:
    """Means over some members.

    Attributes
    ----------
    method : str
        The method's name.
    setting : float
        Its step [time].
    members : int
        Number of runs.
    half_width : float
        The largest half-width of the 95 % interval of a mean, in units of the scale of energies.
    bias : float
        The largest difference, at the end, of a mean from that at half the step that exceeds its
        half-width, in the same units; 0 if none does.
    force_evaluations : int
        Evaluations of all forces, in all members.
    seconds : float
        Time of the ensemble, with the second runs that measure the bias.
    bias_half_width : float or None
        The half-width of `bias`, in the same units, or that of `unseen_bias` if `bias` is 0. The
        intervals of all quantities contain their biases with a probability of 95 %. None if the
        bias was not measured.
    unseen_bias : float or None
        The largest half-width of the other biases: a bias below it may be unseen.
    """

    method: str
    setting: float
    members: int
    half_width: float
    bias: float
    force_evaluations: int
    seconds: float
    bias_half_width: float | None = None
    unseen_bias: float | None = None

    def scaled_to(self, half_width: float) -> MeanRow:
        """What another half-width takes: it falls with the square root of the members."""
        members = max(2, math.ceil(self.members * (self.half_width / half_width) ** 2))
        ratio = members / self.members
        return replace(
            self,
            members=members,
            half_width=half_width,
            force_evaluations=round(ratio * self.force_evaluations),
            seconds=ratio * self.seconds,
        )

    @property
    def bias_text(self) -> str:
        """What is known of the bias of the step at the end."""
        if self.bias_half_width is None or self.unseen_bias is None:
            return "the bias of the step was not measured"
        if self.bias == 0.0:
            half_width = f"{self.bias_half_width:.2g}"
            return f"no bias of the step can be seen (below its half-width of {half_width})"
        text = f"the step's bias is {mean_text(self.bias, self.bias_half_width)}"
        other = f"; biases of other quantities below {self.unseen_bias:.2g} cannot be seen"
        return text + (other if self.unseen_bias > self.bias else "")


@dataclass(frozen=True)
class MeansPrecision:
    """Half-widths of means against members; ``print`` shows a table.

    Attributes
    ----------
    rows : tuple of MeanRow
        Ensembles, from few members to many.
    status : Status
        "completed", or "Interrupted" where an interrupt left out ensembles.
    """

    rows: tuple[MeanRow, ...]
    status: Status = Status.COMPLETED

    @property
    def cheapest(self) -> list[MeanRow]:
        """What the half-widths 0.1, 0.01 and 0.001 take, by the largest ensemble."""
        return [self.rows[-1].scaled_to(goal) for goal in GOALS] if self.rows else []

    def to_json(self) -> str:
        """All runs as one JSON object, as ``tribo accuracy --json`` prints them with noise."""
        table = {
            "rows": [asdict(row) for row in self.rows],
            "reference": None,
            "cheapest": [asdict(row) | {"digit_more": RATIO_OF_DIGIT} for row in self.cheapest],
            "status": self.status,
        }
        return json.dumps(table, indent=1)

    def __str__(self) -> str:
        """A table of all ensembles, and the cheapest of them for each half-width."""
        lines = [
            "thermal noise: no two runs agree, so these are means over members of an ensemble",
            f"{'method':>15} {'step':>9} {'members':>9} {'half-width':>11} {'bias':>9} "
            f"{'+-':>9} {'evaluations':>12} {'seconds':>10}",
        ]
        lines += [
            f"{row.method:>15} {row.setting:9.2e} {row.members:9d} {row.half_width:11.1e} "
            f"{row.bias:9.1e} {row.bias_half_width or np.nan:9.1e} "
            f"{row.force_evaluations:12d} {row.seconds:10.2e}"
            for row in self.rows
        ]
        lines += [
            f"half-width {row.half_width:g}: {row.members} members by {row.method} at step "
            f"{row.setting:.2g}, {row.force_evaluations} evaluations, {row.seconds:.2g} s"
            + ("; the step's bias is larger" if row.bias > row.half_width else "")
            for row in self.cheapest
        ]
        lines += [f"at the end, {row.bias_text}" for row in self.rows[-1:]]
        lines.append(
            f"one digit more takes {RATIO_OF_DIGIT} times the members; half-widths are of 95 % "
            "intervals, in units of the scale of energies"
        )
        if self.status != Status.COMPLETED:
            lines.append(f"{self.status}: the ensembles up to there")
        return "\n".join(lines)


def means_precision(
    scene: Scene,
    observables: Iterable[str] = (),
    seconds: float = 30.0,
    report: Callable[[MeansPrecision], None] | None = None,
) -> MeansPrecision:
    """Measure the half-widths of means against the number of members.

    Parameters
    ----------
    scene : Scene
        With thermal noise.
    observables : iterable of str
        Names as "upper.W", whose means count; all works and energies without any.
    seconds : float
        About the time that all ensembles may take together, compilation not included.
    report : callable, optional
        Called with all ensembles so far, after each.

    Raises
    ------
    InputError
        The scene has no thermal noise, or a name cannot be used.
    KeyboardInterrupt
        The attribute ``result`` has the MeansPrecision of the ensembles that ended before, if any
        did.
    """
    if not scene.is_noisy:
        raise InputError("scene", "must have thermal noise; without it, measure single runs")
    seconds = number("seconds", seconds, POSITIVE, "s")
    simulation = prepare(scene, progress=False)
    first = simulation.compute()
    if first.status == Status.INTERRUPTED:
        raise KeyboardInterrupt
    if first.status != Status.COMPLETED:
        raise InputError("scene", f"must run to its end, but ends by {first.status}")
    scale = reported_scales(simulation.layout, first.ledger).energy
    rows: list[MeanRow] = []
    members = FEWEST
    began = time.perf_counter()
    try:
        while not rows or time.perf_counter() - began + RATIO * rows[-1].seconds < seconds:
            data = ensemble(scene, members, progress=False)
            evaluations = members * first.cost.force_evaluations
            rows.append(_row(data, _checked(data, observables), simulation, scale, evaluations))
            members *= RATIO
            if report:
                report(MeansPrecision(tuple(rows), Status.INTERRUPTED))
    except KeyboardInterrupt:
        interrupts.answer()
        if not rows:
            raise
        part = MeansPrecision(tuple(rows), Status.INTERRUPTED)
        raise interrupts.Interrupted(part) from None
    return MeansPrecision(tuple(rows))


def _checked(data: xarray.Dataset, observables: Iterable[str]) -> list[str]:
    """The names of the quantities whose means count.  Raises InputError."""
    end = "_half_width"
    known = [name.removesuffix(end) for name in map(str, data) if name.endswith(end)]
    known = [name for name in known if not name.endswith("_bias")]
    for name in observables:
        one_of("observables", name, known)
    return list(observables) or known


def _row(
    data: xarray.Dataset,
    names: Sequence[str],
    simulation: Simulation,
    scale: float,
    evaluations: int,
) -> MeanRow:
    """The largest half-width and bias of an ensemble."""
    half_width = max(float(data[f"{name}_half_width"].max()) for name in names)
    bias, bias_half_width, unseen = _bias(data, names)
    return MeanRow(
        simulation.method.name,
        simulation.plan.setting.of_equal_steps(),
        data.sizes["member"],
        half_width / scale,
        bias / scale,
        evaluations,
        data.attrs["seconds"],
        None if bias_half_width is None else bias_half_width / scale,
        None if unseen is None else unseen / scale,
    )


def _bias(data: xarray.Dataset, names: Sequence[str]) -> tuple[float, float | None, float | None]:
    """The largest significant bias at the end, its half-width, and the largest of the others."""
    measured = [f"{name}_bias" for name in names if f"{name}_bias" in data]
    if not measured:
        return 0.0, None, None
    found = np.array([abs(data[name].values.flat[-1]) for name in measured])
    # The data set has intervals of one quantity at a time; here the largest of several decides.
    wider = student(FEWEST - 1, len(measured)) / student(FEWEST - 1)
    half_widths = wider * np.array(
        [data[f"{name}_half_width"].values.flat[-1] for name in measured]
    )
    seen = found > half_widths
    unseen = float(np.max(half_widths, initial=0.0, where=~seen))
    if not np.any(seen):
        return 0.0, unseen, unseen
    largest = int(np.argmax(np.where(seen, found, 0.0)))
    return float(found[largest]), float(half_widths[largest]), unseen
