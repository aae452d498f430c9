"""Measure members a second of ensembles: tribo and heyoka's batch mode.

Members of the paper's cases differ in the angle theta of the upper asperite.  Both programs deliver
w1, w2 and delta_e_int of both surfaces at the end in an xarray data set.  A timed call is all of
it: values drawn, members run, checked where the program does so, and the data set made.  What is
compiled or planned once for all ensembles of a scene is compiled before; tribo plans in every call.

Members of rows of 3 over 3 and of 16 over 16 asperites differ in the angles of all upper ones.  The
quantities are those that follow from the motion: delta_e_int of each asperite and the change of the
total energy.  There is no goal for them.

The true error of both is the largest over several members and all of these quantities, relative to
the largest of them, against heyoka in extended precision, and for rows at its finest tolerance in
double precision.  heyoka's tolerance is the loosest with which it is below the one wanted; tribo is
asked for that accuracy, and its true error is printed.

Further rows are of the cases with other numbers varied in place of the angle, one at a time: the
velocity of the upper surface, its kappa, and the strength of the interaction.  heyoka is not run.

heyoka integrates the motion alone, as its fastest way: works follow by conservation of energy and
momentum, by the same formulas as in benchmarks/pair.py.  Runs are interleaved, and the fastest of
each counts.

    python benchmarks/ensemble.py [--json] [--quick] [--rounds 5] [--members 200000]
                                  [--cases AC,3,16]

--quick takes case A with 20,000 members, which suffices to see that a change costs nothing.
"""

import argparse
import json
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any, Protocol

import heyoka
import numpy as np
import xarray
from scipy import stats

import tribo
from pair import ANGLES, ERRORS, Problem, references
from tribo import paper

# Angles of the members [rad].
START = stats.uniform(0.0, 0.2)

# Numbers of members, by their keys.
NUMBERS = {
    "upper.velocity": stats.uniform(0.4, 0.2),
    "upper.asperite.kappa": stats.uniform(0.8, 0.4),
    "interaction.strength": stats.uniform(0.15, 0.1),
}

# Batches of members that a thread of heyoka's takes at a time.
CHUNK = 256

# Members of rows of so many asperites over as many, for each of a pair's: they take some ten and
# some two hundred times as long.
SHARES = {3: 0.2, 16: 0.02}

# Relative errors wanted of rows: 1e-12 is out of reach for tribo in 16 + 16.
ERRORS_OF_ROWS = ERRORS[:2]

# heyoka's tolerance for the members of rows that others are compared with.
FINEST = 1e-17


class Motion(Protocol):
    """The motion of a scene as equations for heyoka, and the quantities that follow from it.

    Attributes
    ----------
    scene : tribo.Scene
        What tribo runs.
    names : sequence of str
        Of the quantities.
    start : ndarray, (coordinates and rates,)
        At t = 0, with angles of zero first.
    angles : int
        That members differ in.
    """

    scene: tribo.Scene
    names: tuple[str, ...]
    start: np.ndarray
    angles: int

    def equations(self, y: list[Any]) -> list[Any]:
        """y'."""

    def quantities(self, angles: np.ndarray, y: np.ndarray) -> dict[str, np.ndarray]:
        """The quantities of members with some angles (members, angles) and ends (..., members)."""

    def exact(self, angles: np.ndarray) -> dict[str, np.ndarray]:
        """The quantities to many digits."""


class Pair:
    """The motion of a case of the paper; see `Motion`."""

    names = tuple(f"{s}.{q}" for s in ("upper", "lower") for q in ("w1", "w2", "delta_e_int"))
    angles = 1

    def __init__(self, case: str) -> None:
        self.scene = paper.scene(case)
        self._problem = Problem.of(case)
        self.start = np.array(self._problem.start(0.0))

    def equations(self, y: list[Any]) -> list[Any]:
        """y' of the swings, their rates, and the place and velocity of a free asperite."""
        return self._problem.equations(y, heyoka.time, heyoka)

    def exact(self, angles: np.ndarray) -> dict[str, np.ndarray]:
        """The quantities for the angles of `ANGLES`, in extended precision."""
        known = references(self._problem)
        return {name: np.array([ledger[name] for ledger in known]) for name in self.names}

    def quantities(self, angles: np.ndarray, y: np.ndarray) -> dict[str, np.ndarray]:
        """As `Problem.ledger`, of many members."""
        angles = angles[:, 0]
        p = self._problem
        l1, l2 = p.arms
        q, other, rate, other_rate = y[:4]
        x = y[4] if p.free else p.gap[0] + p.speed * p.duration

        def inner(swing: np.ndarray, omega: np.ndarray | float) -> np.ndarray:
            return np.asarray(0.5 * (p.inertia * omega**2 + p.kappa * swing**2))

        def contact(x: np.ndarray | float, one: np.ndarray, two: np.ndarray | float) -> np.ndarray:
            dx = x + l1 * (np.sin(one) + np.sin(two))
            dy = p.gap[1] - l1 * (np.cos(one) + np.cos(two))
            return np.asarray(p.strength / np.hypot(dx, dy))

        e1, e2 = inner(q, rate) - inner(angles, 0.0), inner(other, other_rate)
        change = contact(x, q, other) - contact(p.gap[0], angles, 0.0)
        if p.free:
            k_trans = 0.5 * p.mass * (y[5] - p.speed) * (y[5] + p.speed)
            w2 = k_trans + e1 + e2 + change - l2 / p.length * e2
            w1 = k_trans + e1 - w2
        else:
            w1_ps = -(l1 / p.length * (e1 + e2) + change)
            w1, w2 = w1_ps + l1 / p.length * e1, l2 / p.length * e1 - w1_ps
        values = (w1, w2, e1, l1 / p.length * e2, l2 / p.length * e2, e2)
        return dict(zip(self.names, values, strict=True))


class Rows:
    """The motion of a row over another one, whose bars move uniformly or rest; see `Motion`."""

    def __init__(self, count: int) -> None:
        row = {"shape": (count, 1), "spacing": (1.5, 0.0)}
        upper = tribo.Surface("upper", bob=(-1.0, 0.5), velocity=(0.5, 0.0), **row)
        lower = tribo.Surface("lower", facing="up", **row)
        self.scene = tribo.Scene((upper, lower), tribo.Coulomb(0.2), 4.0)
        self.names = ("upper.delta_e_int", "lower.delta_e_int", "total_energy_change")
        self.angles = count
        self.start = np.zeros(4 * count)
        each = upper.asperite.for_each(1)
        self._inertia, self._kappa = float(each["inertia"][0]), float(each["kappa"][0])
        self._arm = float(each["l1"][0])
        self._length = self._arm + float(each["l2"][0])
        gaps = upper.resting_bobs()[:, None, :2] - lower.resting_bobs()[None, :, :2]
        self._gaps = gaps + np.array([0.0, 2.0 * self._arm])

    def equations(self, y: list[Any]) -> list[Any]:
        """y' of the swings, first the upper ones, and of their rates."""
        n = self.angles
        sin, cos = [heyoka.sin(q) for q in y[: 2 * n]], [heyoka.cos(q) for q in y[: 2 * n]]
        turns = [-self._kappa * q for q in y[: 2 * n]]
        for i in range(n):
            for j in range(n, 2 * n):
                x0, y0 = map(float, self._gaps[i, j - n])
                dx = x0 + 0.5 * heyoka.time + self._arm * (sin[i] + sin[j])
                dy = y0 - self._arm * (cos[i] + cos[j])
                push = 0.2 * self._length * (dx * dx + dy * dy) ** -1.5
                turns[i] += push * (cos[i] * dx + sin[i] * dy)
                turns[j] += push * (cos[j] * dx + sin[j] * dy)
        return [*y[2 * n :], *(turn / self._inertia for turn in turns)]

    def exact(self, angles: np.ndarray) -> dict[str, np.ndarray]:
        """The quantities at heyoka's finest tolerance."""
        data = Heyoka(self, FINEST).run(angles, 1)
        return {name: data[name].values for name in self.names}

    def quantities(self, angles: np.ndarray, y: np.ndarray) -> dict[str, np.ndarray]:
        """Gains of internal energy, and of it and the energy of the contact."""
        n = self.angles
        start = np.zeros((4 * n, len(angles)))
        start[:n] = angles.T
        gain = self._inner(y) - self._inner(start)
        contact = self._contact(y, self.scene.duration) - self._contact(start, 0.0)
        return {
            "upper.delta_e_int": gain[:n].T,
            "lower.delta_e_int": gain[n:].T,
            "total_energy_change": gain.sum(axis=0) + contact,
        }

    def _inner(self, y: np.ndarray) -> np.ndarray:
        n = 2 * self.angles
        return np.asarray(0.5 * (self._inertia * y[n:] ** 2 + self._kappa * y[:n] ** 2))

    def _contact(self, y: np.ndarray, t: float) -> np.ndarray:
        n = self.angles
        sums = [f(y[:n])[:, None] + f(y[n : 2 * n])[None] for f in (np.sin, np.cos)]
        dx = self._gaps[..., :1] + 0.5 * t + self._arm * sums[0]
        dy = self._gaps[..., 1:] - self._arm * sums[1]
        return np.asarray(np.sum(0.2 / np.hypot(dx, dy), axis=(0, 1)))


class Tribo:
    """tribo.ensemble with the quantities at the end."""

    def __init__(self, motion: Motion, accuracy: float) -> None:
        self._scene = replace(motion.scene, numerics=tribo.Numerics(accuracy=accuracy))
        self._names = motion.names

    def run_numbers(self, members: int, threads: int, key: str) -> xarray.Dataset:
        """The data set of so many members that differ in a number of `NUMBERS`."""
        vary = {key: NUMBERS[key]}
        return tribo.ensemble(self._scene, members, vary, keep=self._names, threads=threads)

    def run(self, members: int | np.ndarray, threads: int) -> xarray.Dataset:
        """The data set of so many members, or of given angles (members, angles)."""
        given = isinstance(members, np.ndarray)
        count = len(members) if isinstance(members, np.ndarray) else members
        vary = {"upper.theta": members if given else START}
        return tribo.ensemble(self._scene, count, vary, keep=self._names, threads=threads)


class Heyoka:
    """heyoka's batch mode: as many members at a time as fit a register."""

    def __init__(self, motion: Motion, tolerance: float) -> None:
        self._motion = motion
        self._lanes = heyoka.recommended_simd_size()
        y = [heyoka.expression(f"y{k}") for k in range(motion.start.size)]
        equations = list(zip(y, motion.equations(y), strict=True))
        self._start = np.repeat(motion.start[:, None], self._lanes, axis=1)
        taylor = heyoka.taylor_adaptive_batch(
            equations,
            self._start.copy(),
            tol=tolerance,
            fast_math=True,
            high_accuracy=False,
            compact_mode=motion.start.size > 16,
        )
        self._taylors = [taylor, taylor.__copy__()]

    def run(self, members: int | np.ndarray, threads: int) -> xarray.Dataset:
        """The data set of so many members, or of given angles (members, angles)."""
        motion, start = self._motion, self._start
        if isinstance(members, np.ndarray):
            angles = members
        else:
            rng = np.random.default_rng(0)
            angles = START.rvs(size=(members, motion.angles), random_state=rng)
        count = -(-len(angles) // self._lanes)
        batches = np.resize(angles, (count * self._lanes, motion.angles))
        batches = batches.reshape(count, self._lanes, motion.angles)
        ends = np.empty((count, len(start), self._lanes))
        parts = [range(k, min(k + CHUNK, count)) for k in range(0, count, CHUNK)]

        def run_parts(thread: int) -> None:
            taylor = self._taylors[thread]
            zeros = np.zeros(self._lanes)
            duration = np.full(self._lanes, motion.scene.duration)
            for part in parts[thread::threads]:
                for k in part:
                    taylor.set_time(zeros)
                    taylor.state[:] = start
                    taylor.state[: motion.angles] = batches[k].T
                    taylor.propagate_until(duration)
                    ends[k] = taylor.state

        if threads == 1:
            run_parts(0)
        else:
            with ThreadPoolExecutor(threads) as pool:
                list(pool.map(run_parts, range(threads)))
        y = np.moveaxis(ends, 1, 0).reshape(len(start), -1)[:, : len(angles)]
        found = motion.quantities(angles, y)
        dimensions = {1: ("member",), 2: ("member", "asperite")}
        return xarray.Dataset(
            {name: (dimensions[values.ndim], values) for name, values in found.items()},
            {"upper.theta": (("member", "asperite"), angles)},
        )


def angles_of(motion: Motion) -> np.ndarray:
    """Angles of the members whose true errors are measured, (members, angles)."""
    steps = 0.01 * np.arange(motion.angles)
    return np.array(ANGLES)[:, None] + steps


def true_error(data: xarray.Dataset, known: dict[str, np.ndarray]) -> float:
    """The largest error of any member, relative to the largest energy of that member."""
    exact = np.concatenate([v.reshape(len(ANGLES), -1) for v in known.values()], axis=1)
    found = [data[name].values.reshape(len(ANGLES), -1) for name in known]
    gaps = np.abs(np.concatenate(found, axis=1) - exact)
    return float(np.max(gaps.max(axis=1) / np.abs(exact).max(axis=1)))


def loosest(motion: Motion, wanted: float, known: dict[str, np.ndarray]) -> tuple[Heyoka, float]:
    """heyoka with the loosest tolerance that keeps an error, and the error."""
    step = 0.25 if motion.angles == 1 else 1.0  # larger scenes take seconds to compile
    for tolerance in wanted * 10.0 ** np.arange(4.0, -6.0, -step):
        program = Heyoka(motion, max(float(tolerance), 1e-17))
        error = true_error(program.run(angles_of(motion), 1), known)
        if error < wanted:
            return program, error
    raise SystemExit(f"heyoka does not reach {wanted} in {motion.scene.title}")


def cases_in(words: str) -> list[str]:
    """The cases in "AC,3,16": A, C, and rows of 3 and 16."""
    return [
        case for word in words.split(",") for case in ([word] if word.isdigit() else list(word))
    ]


def measure(cases: list[str], members: int, rounds: int) -> list[dict[str, Any]]:
    """Members a second, for every case, error and number of threads."""
    rows = []
    for case in cases:
        motion: Motion = Rows(int(case)) if case.isdigit() else Pair(case)
        count = max(8, int(members * SHARES.get(motion.angles, 1.0)))
        known = motion.exact(angles_of(motion))
        for wanted in ERRORS_OF_ROWS if case.isdigit() else ERRORS:
            other, other_error = loosest(motion, wanted, known)
            own = Tribo(motion, wanted)
            own_error = true_error(own.run(angles_of(motion), 1), known)
            for threads in (1, 2):
                seconds = [np.inf, np.inf]
                for _ in range(rounds):
                    for k, program in enumerate((own, other)):
                        began = time.perf_counter()
                        program.run(count, threads)
                        seconds[k] = min(seconds[k], time.perf_counter() - began)
                rows.append(
                    {
                        "case": f"{case} + {case}" if case.isdigit() else case,
                        "error": wanted,
                        "threads": threads,
                        "tribo_per_second": count / seconds[0],
                        "heyoka_per_second": count / seconds[1],
                        "tribo_error": own_error,
                        "heyoka_error": other_error,
                    }
                )
    return rows


def measure_numbers(cases: list[str], members: int, rounds: int) -> list[dict[str, Any]]:
    """Members a second that differ in numbers, of tribo alone."""
    rows = []
    for case in cases:
        for wanted in ERRORS:
            own = Tribo(Pair(case), wanted)
            for key in NUMBERS:
                own.run_numbers(64, 1, key)
                for threads in (1, 2):
                    seconds = np.inf
                    for _ in range(rounds):
                        began = time.perf_counter()
                        own.run_numbers(members, threads, key)
                        seconds = min(seconds, time.perf_counter() - began)
                    row = {"case": case, "error": wanted, "threads": threads, "varied": key}
                    rows.append(row | {"tribo_per_second": members / seconds})
    return rows


def report_numbers(rows: list[dict[str, Any]]) -> str:
    """The table of varied numbers as text."""
    lines = ["   case  error  threads    tribo / s  varied"]
    for row in rows:
        lines.append(
            f"{row['case']:>7} {row['error']:>6.0e} {row['threads']:>8} "
            f"{row['tribo_per_second']:>12.0f}  {row['varied']}"
        )
    return "\n".join(lines)


def report(rows: list[dict[str, Any]]) -> str:
    """The table as text."""
    lines = ["   case  error  threads    tribo / s   heyoka / s  ratio  true errors"]
    for row in rows:
        ratio = row["tribo_per_second"] / row["heyoka_per_second"]
        lines.append(
            f"{row['case']:>7} {row['error']:>6.0e} {row['threads']:>8} "
            f"{row['tribo_per_second']:>12.0f} {row['heyoka_per_second']:>12.0f} {ratio:>6.2f}  "
            f"{row['tribo_error']:.1e} {row['heyoka_error']:.1e}"
        )
    return "\n".join(lines)


def main() -> None:
    """Measure both programs in one process."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--quick", action="store_true", help="one case, few members")
    parser.add_argument("--rounds", type=int)
    parser.add_argument("--members", type=int)
    parser.add_argument("--cases")
    parser.set_defaults(rounds=5, members=200_000, cases="AC,3,16")
    if parser.parse_known_args()[0].quick:
        parser.set_defaults(rounds=3, members=20_000, cases="A")
    options = parser.parse_args()
    cases = cases_in(options.cases)
    rows = measure(cases, options.members, options.rounds)
    pairs = [case for case in cases if not case.isdigit()]
    numbers = measure_numbers(pairs, options.members, options.rounds)
    if options.json:
        print(json.dumps({"rows": rows, "numbers": numbers}, indent=1))
    else:
        print(report(rows), report_numbers(numbers), sep="\n\n")


if __name__ == "__main__":
    main()
