"""Laws of friction, each as one number with its 95 % interval.

    static  exponent p of the static friction per asperite, F ~ N^p, of rigid rows of N asperites:
            commensurate (0 expected), incommensurate (-1), incommensurate and rough (-1/2)
    angle   exponent p of the angle at which the static friction of two rigid grids of L x L falls
            to half, angle ~ L^p (-1 expected): structural lubricity
    load    slope of the friction of a rough surface against the load, with a reservoir on every
            swing; and the friction coefficient without reservoirs
    speed   exponent p of that friction at low speed, F ~ speed^p (0 expected); and again the
            coefficient without reservoirs

Static friction is the largest force against sliding over one spacing of the lower surface.  Rigid
asperites on driven bars have no motion of their own, so that every sample is a static force.  The
rough surface is a grid of pendulums on driven bars, at a fixed height over a rigid grid; its load
is the mean of the contact force along y.

With --points, finished points are stored in a file of JSON lines, from which a study that was
interrupted continues.  docs/measured/friction_points.jsonl has those of the figures in the pages:

    python benchmarks/friction_laws.py static angle load speed --side 64
        --points docs/measured/friction_points.jsonl --figures docs/measured
"""

import argparse
import json
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy import stats

import tribo
from tribo import plotting

RIGID = tribo.Asperite(kappa=math.inf)
GOLDEN_MEAN = 0.5 * (1.0 + math.sqrt(5.0))
# Contact of static studies: the corrugation of a row has nearly one harmonic.
MORSE = tribo.Morse(0.1, 3.0, 1.0).with_cutoff(3.0)
# Repulsion of the rough surface, which grows with the load.
REPULSION = tribo.BornMayer(20.0, 0.25).with_cutoff(3.0)
# Numbers of asperites of rows; each stands for the mean over this and the next seven, since the
# friction of incommensurate rows vanishes for some numbers.
ROWS, NEXT = (8, 16, 32, 64, 128, 256, 512, 1024, 2048), 8
CASES = ("commensurate", "incommensurate", "rough")
# Sides of grids, and their angles in units of 1 / side [rad].
SIDES, ANGLES = (8, 12, 16, 24, 32, 48), np.linspace(0.0, 1.2, 25)
# Static forces over one spacing.
SAMPLES = 128
# Spacing of the rough grid [length]: 8 of its spacings are 13 of the lower one.
ROUGH_SPACING = 13.0 / 8.0
ROUGHNESS = tribo.Roughness(0.3, hurst=0.8)
# Pendulums on driven bars with a period of 4.4 [time].
SOFT = tribo.Asperite(kappa=8.0)
# Of the reservoirs on swings [torque time].
DAMPING = 2.0
# Heights of the rough surface [length], and that at which speeds are compared.
HEIGHTS, HEIGHT = (2.0, 1.8, 1.6, 1.4, 1.2, 1.0, 0.8), 1.2
# Height up to which the slope against the load is fitted [length]: asperites jump there.
PRESSED = 1.4
# Speeds of the rough surface [length / time], and that at which loads are compared.
SPEEDS, SPEED = (0.05, 0.1, 0.2, 0.4, 0.8, 1.6), 0.2
# Speed up to which its exponent is fitted: a spacing then takes longer than a swing.
SLOW = 0.2
# Sliding of the rough surface, of which the second half is measured [length].
DISTANCE = 4.0
# Samples of the rough surface, few enough that the forces on all asperites are kept.
ROUGH_SAMPLES = 101
# Step of Verlet [time], a 200th of a swing.
STEP = 0.02


class Point(NamedTuple):
    """What identifies a run: the study, its case, the varied number and the replicate."""

    study: str
    case: str
    x: float
    side: int
    seed: int


class Number(NamedTuple):
    """A result and the half-width of its 95 % interval."""

    name: str
    value: float
    half_width: float


def slid(upper: tribo.Surface, lower: tribo.Surface, potential, duration, samples, **settings):
    """The run of two surfaces with the forces on all asperites."""
    output = tribo.Output(samples=samples, ledger="none", series=("forces",))
    scene = tribo.Scene((upper, lower), potential, duration, output=output, **settings)
    result = tribo.simulate(scene, method="verlet", step=STEP)
    assert result.status == "completed", result.status
    return result


def static_friction(upper: tribo.Surface, lower: tribo.Surface) -> float:
    """Largest force against sliding along x, per upper asperite, over a sliding distance of 1."""
    force = slid(upper, lower, MORSE, 1.0, SAMPLES + 1)["upper"].friction_force
    return float(np.max(-force)) / upper.count


def static(point: Point) -> dict[str, float]:
    """A rigid row over a rigid row of spacing 1 that extends beyond it."""
    n, spacing = int(point.x) + point.seed, 1.0 if point.case == "commensurate" else GOLDEN_MEAN
    heights = tribo.Roughness(0.1, seed=n) if point.case == "rough" else None
    row = {"asperite": RIGID, "drive": "bars"}
    upper = tribo.Surface(
        "upper",
        bob=(0.0, 1.0),
        velocity=(1.0, 0.0),
        shape=(n, 1),
        spacing=(spacing, 0.0),
        heights=heights,
        **row,
    )
    count = math.ceil(n * spacing) + 9
    lower = tribo.Surface(
        "lower", facing="up", bob=(-4.0, 0.0), shape=(count, 1), spacing=(1.0, 0.0), **row
    )
    return {"friction": static_friction(upper, lower)}


def angle(point: Point) -> dict[str, float]:
    """A rigid square of point.side^2 bobs that is turned about its centre, over a larger one."""
    half = 0.5 * (point.side - 1)
    x, z = (grid.ravel() - half for grid in np.meshgrid(*[np.arange(point.side)] * 2))
    turn = point.x / point.side
    places = np.column_stack(
        [
            x * math.cos(turn) + z * math.sin(turn),
            np.ones(x.size),
            z * math.cos(turn) - x * math.sin(turn),
        ]
    )
    settings = {"asperite": RIGID, "drive": "bars"}
    upper = tribo.Surface("upper", positions=places, velocity=(1.0, 0.0), **settings)
    reach = math.ceil(1.5 * half) + 4
    lower = tribo.Surface(
        "lower",
        facing="up",
        bob=(-reach + half % 1.0, 0.0),
        depth=-reach + half % 1.0,
        shape=(2 * reach + 2, 2 * reach + 2),
        spacing=(1.0, 1.0),
        **settings,
    )
    return {"friction": static_friction(upper, lower)}


def rough(point: Point) -> dict[str, float]:
    """The friction and the load per asperite of a rough grid of side^2 over a rigid one."""
    side = point.side
    reservoir = tribo.Langevin(DAMPING, on="swing") if point.case == "reservoirs" else None
    height, speed = (point.x, SPEED) if point.study == "load" else (HEIGHT, point.x)
    upper = tribo.Surface(
        "upper",
        bob=(0.3, height),
        velocity=(speed, 0.0),
        shape=(side, side),
        spacing=(ROUGH_SPACING, ROUGH_SPACING),
        heights=ROUGHNESS,
        drive="bars",
        asperite=SOFT,
        langevin=reservoir,
    )
    period = side * ROUGH_SPACING
    shape = (round(period), round(period))
    lower = tribo.Surface(
        "lower", facing="up", shape=shape, spacing=(1.0, 1.0), drive="bars", asperite=RIGID
    )
    duration, periods = DISTANCE / speed, {"x": period, "z": period}
    result = slid(
        upper, lower, REPULSION, duration, ROUGH_SAMPLES, periodic=periods, seed=point.seed
    )
    half = result.t >= 0.5 * duration
    series = result["upper"]
    return {
        "friction": -float(np.mean(series.friction_force[half])) / upper.count,
        "load": float(np.mean(series.f1_y[half].sum(axis=1))) / upper.count,
    }


RUNS: dict[str, Callable[[Point], dict[str, float]]] = {
    "static": static,
    "angle": angle,
    "load": rough,
    "speed": rough,
}


def points(study: str, side: int, seeds: int) -> Iterator[Point]:
    """All points of a study."""
    if study == "static":
        for case in CASES:
            for n in ROWS:
                for more in range(NEXT):
                    yield Point(study, case, n, 1, more)
    elif study == "angle":
        for length in SIDES:
            for turn in ANGLES:
                yield Point(study, "square", round(float(turn), 12), length, 0)
    else:
        for x in HEIGHTS if study == "load" else SPEEDS:
            for case in ("reservoirs", "none"):
                for seed in range(seeds):
                    yield Point(study, case, x, side, seed)


def line(names: tuple[str, str], x: np.ndarray, y: np.ndarray) -> tuple[Number, Number]:
    """Slope and intercept of a straight line, and Student's intervals of the regression."""
    fit = stats.linregress(x, y)
    width = stats.t.ppf(0.975, len(x) - 2)
    return (
        Number(names[0], fit.slope, width * fit.stderr),
        Number(names[1], fit.intercept, width * fit.intercept_stderr),
    )


def power_law(name: str, x: np.ndarray, y: np.ndarray) -> Number:
    """The exponent p of y ~ x^p."""
    return line((name, "log of the factor"), np.log(x), np.log(y))[0]


def mean(name: str, values: np.ndarray) -> Number:
    """The mean of independent values, and Student's interval."""
    width = stats.t.ppf(0.975, len(values) - 1) * stats.sem(values)
    return Number(name, float(np.mean(values)), float(width))


class Table:
    """The values of points, by study and case.

    Parameters
    ----------
    values : mapping of Point to values
    """

    def __init__(self, values: dict[Point, dict[str, float]]) -> None:
        self._values = values

    def of(self, study: str, case: str, *names: str) -> np.ndarray:
        """(points, 3 + names): x, side and seed of every point of a case, and its values."""
        rows = [
            [p.x, p.side, p.seed, *(v[name] for name in names)]
            for p, v in self._values.items()
            if (p.study, p.case) == (study, case)
        ]
        return np.array(rows)

    def rows(self, case: str) -> tuple[np.ndarray, np.ndarray]:
        """Mean numbers of asperites of rows, and the means of their static friction."""
        n, _, more, friction = self.of("static", case, "friction").T
        return _means(n, n + more), _means(n, friction)

    def half_angles(self) -> tuple[np.ndarray, np.ndarray]:
        """Sides of grids, and the angles at which their friction has fallen to half [rad]."""
        turn, side, _, friction = self.of("angle", "square", "friction").T
        sides = np.unique(side)
        angles = []
        for length in sides:
            mine = side == length
            angles.append(_half(turn[mine], friction[mine]) / length)
        return sides, np.array(angles)

    def numbers(self, study: str) -> list[Number]:
        """The results of a study."""
        if study == "static":
            found = []
            for case in CASES:
                found.append(power_law(f"static friction ~ N^p, {case}: p", *self.rows(case)))
            return found
        if study == "angle":
            return [power_law("angle of half the friction ~ L^p: p", *self.half_angles())]
        x, _, _, friction, load = self.of(study, "none", "friction", "load").T
        # Different surfaces at the same value are correlated.
        coefficients = _means(x, friction / load)
        lost = mean(f"friction / load without reservoirs, any {study}", coefficients)
        x, _, _, friction, load = self.of(study, "reservoirs", "friction", "load").T
        if study == "load":
            pressed = x <= PRESSED
            names = "d friction / d load with reservoirs", "friction of that line at no load"
            return [*line(names, load[pressed], friction[pressed]), lost]
        slow = x <= SLOW
        return [power_law("slow friction ~ speed^p: p", x[slow], friction[slow]), lost]

    def draw(self, study: str, folder: Path) -> Path:
        """The figure of a study."""
        with plotting.style():
            ax = plotting.axes(plotting.COLUMN, 2.6)
            if study == "static":
                for case, mark in zip(CASES, "os^", strict=True):
                    ax.plot(*self.rows(case), mark, ms=3, label=case)
                ax.set(xscale="log", yscale="log", xlabel="asperites $N$")
            elif study == "angle":
                turn, side, _, friction = self.of(study, "square", "friction").T
                for length in np.unique(side):
                    mine = side == length
                    label = rf"${length:g} \times {length:g}$"
                    ax.plot(turn[mine] / length, friction[mine], label=label)
                ax.set(xlabel="angle (rad)", xscale="log")
            else:
                for case, mark in (("reservoirs", "o"), ("none", "s")):
                    x, _, _, friction, load = self.of(study, case, "friction", "load").T
                    label = "with reservoirs" if case == "reservoirs" else "without"
                    ax.plot(load if study == "load" else x, friction, mark, ms=3, label=label)
                ax.axhline(0.0, color="0.7", lw=0.5, zorder=0)
                ax.set(xlabel="load per asperite" if study == "load" else "speed")
                ax.set(xscale="linear" if study == "load" else "log")
            static = study in ("static", "angle")
            ax.set(ylabel=f"{'static ' * static}friction per asperite")
            ax.legend()
        return plotting.save(ax, folder / f"friction_{study}.png")


def _half(x: np.ndarray, y: np.ndarray) -> float:
    """Where y first falls to half of its first value, between two points."""
    first = int(np.argmax(y < 0.5 * y[0]))
    return float(np.interp(-0.5 * y[0], -y[first - 1 : first + 1], x[first - 1 : first + 1]))


def _means(groups: np.ndarray, values: np.ndarray) -> np.ndarray:
    """The mean of the values of each group, in the order of the groups' numbers."""
    return np.array([np.mean(values[groups == group]) for group in np.unique(groups)])


def kept(path: Path | None) -> dict[Point, dict[str, float]]:
    """The points that a file has."""
    if path is None or not path.exists():
        return {}
    lines = map(json.loads, path.read_text().splitlines())
    return {Point(*line["point"]): line["values"] for line in lines}


def main() -> None:
    """Run the points that are missing, then print the numbers."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("studies", nargs="+", choices=RUNS, metavar="STUDY", help=", ".join(RUNS))
    parser.add_argument("--side", type=int, default=16, help="of the rough surface; 8, 16, ...")
    parser.add_argument("--seeds", type=int, default=3, help="rough surfaces")
    parser.add_argument("--points", type=Path, metavar="FILE", help="JSON lines of all points")
    parser.add_argument("--figures", type=Path, metavar="DIR")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    every, found = kept(options.points), {}
    for study in options.studies:
        for point in points(study, options.side, options.seeds):
            found[point] = every.get(point) or RUNS[study](point)
            if options.points is not None and point not in every:
                with options.points.open("a") as file:
                    file.write(json.dumps({"point": point, "values": found[point]}) + "\n")
    table = Table(found)
    numbers = [number for study in options.studies for number in table.numbers(study)]
    if options.json:
        print(json.dumps([number._asdict() for number in numbers], indent=1))
    else:
        for number in numbers:
            print(f"{number.name:55} {number.value:8.4f} +- {number.half_width:.4f}")
    for study in options.studies if options.figures else ():
        print(table.draw(study, options.figures))


if __name__ == "__main__":
    main()
