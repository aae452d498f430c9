"""Measure members a second of ensembles of one pair of asperites: tribo and heyoka's batch mode.

Members of the paper's cases differ in the angle theta of the upper asperite.  Both programs deliver
w1, w2 and delta_e_int of both surfaces at the end in an xarray data set.  A timed call is all of
it: values drawn, members run, checked where the program does so, and the data set made.  What is
compiled or planned once for all ensembles of a scene is compiled before; tribo plans in every call.

The true error of both is the largest over several members and all of these quantities, relative to
the largest of them, against heyoka in extended precision.  heyoka's tolerance is the loosest with
which it is below the one wanted; tribo is asked for that accuracy, and its true error is printed.

heyoka integrates the motion alone, as its fastest way: works follow by conservation of energy and
momentum, by the same formulas as in benchmarks/pair.py.  Runs are interleaved, and the fastest of
each counts.

    python benchmarks/ensemble.py [--json] [--rounds 5] [--members 200000] [--cases AC]
"""

import argparse
import json
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import heyoka
import numpy as np
import xarray
from scipy import stats

import tribo
from pair import ANGLES, ERRORS, Problem, references
from tribo import paper

# Angles of the members [rad].
START = stats.uniform(0.0, 0.2)

# The quantities that are delivered.
NAMES = tuple(f"{s}.{q}" for s in ("upper", "lower") for q in ("w1", "w2", "delta_e_int"))

# Batches of members that a thread of heyoka's takes at a time.
CHUNK = 256


class Tribo:
    """tribo.ensemble with the quantities at the end."""

    def __init__(self, case: str, accuracy: float) -> None:
        numerics = tribo.Numerics(accuracy=accuracy)
        self._scene = replace(paper.scene(case), numerics=numerics)

    def run(self, members: int | np.ndarray, threads: int) -> xarray.Dataset:
        """The data set of so many members, or of given angles."""
        given = isinstance(members, np.ndarray)
        count = members.size if isinstance(members, np.ndarray) else members
        vary = {"upper.theta": members if given else START}
        return tribo.ensemble(self._scene, count, vary, keep=NAMES, threads=threads)


class Heyoka:
    """heyoka's batch mode: as many members at a time as fit a register."""

    def __init__(self, problem: Problem, tolerance: float) -> None:
        self._problem = problem
        self._lanes = heyoka.recommended_simd_size()
        names = ["q", "Q", "v", "V", "x", "u"][: len(problem.start(0.0))]
        y = [heyoka.expression(name) for name in names]
        equations = list(zip(y, problem.equations(y, heyoka.time, heyoka), strict=True))
        self._start = np.repeat(np.array(problem.start(0.0))[:, None], self._lanes, axis=1)
        taylor = heyoka.taylor_adaptive_batch(
            equations, self._start.copy(), tol=tolerance, fast_math=True, high_accuracy=False
        )
        self._taylors = [taylor, taylor.__copy__()]

    def run(self, members: int | np.ndarray, threads: int) -> xarray.Dataset:
        """The data set of so many members, or of given angles."""
        if isinstance(members, np.ndarray):
            angles = members
        else:
            angles = START.rvs(size=members, random_state=np.random.default_rng(0))
        count = -(-angles.size // self._lanes)
        batches = np.resize(angles, (count, self._lanes))
        ends = np.empty((count, len(self._start), self._lanes))
        parts = [range(k, min(k + CHUNK, count)) for k in range(0, count, CHUNK)]

        def run_parts(thread: int) -> None:
            taylor = self._taylors[thread]
            zeros, duration = np.zeros(self._lanes), np.full(self._lanes, self._problem.duration)
            for part in parts[thread::threads]:
                for k in part:
                    taylor.set_time(zeros)
                    taylor.state[:] = self._start
                    taylor.state[0] = batches[k]
                    taylor.propagate_until(duration)
                    ends[k] = taylor.state

        if threads == 1:
            run_parts(0)
        else:
            with ThreadPoolExecutor(threads) as pool:
                list(pool.map(run_parts, range(threads)))
        y = np.moveaxis(ends, 1, 0).reshape(len(self._start), -1)[:, : angles.size]
        return xarray.Dataset(
            {name: ("member", values) for name, values in self._works(angles, y).items()},
            {"upper.theta": ("member", angles)},
        )

    def _works(self, angles: np.ndarray, y: np.ndarray) -> dict[str, np.ndarray]:
        """As `Problem.ledger`, of many members."""
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
        return dict(zip(NAMES, values, strict=True))


def true_error(data: xarray.Dataset, known: list[dict[str, float]]) -> float:
    """The largest error of members with the angles of `ANGLES`, relative to the largest energy."""
    exact = np.array([[ledger[name] for name in NAMES] for ledger in known])
    found = np.stack([data[name].values.reshape(len(known)) for name in NAMES], axis=1)
    return float(np.max(np.abs(found - exact).max(axis=1) / np.abs(exact).max(axis=1)))


def loosest(problem: Problem, wanted: float, known: list[dict[str, float]]) -> tuple[Heyoka, float]:
    """heyoka with the loosest tolerance that keeps an error, and the error."""
    for tolerance in wanted * 10.0 ** np.arange(4.0, -6.0, -0.25):
        program = Heyoka(problem, max(float(tolerance), 1e-17))
        error = true_error(program.run(np.array(ANGLES), 1), known)
        if error < wanted:
            return program, error
    raise SystemExit(f"heyoka does not reach {wanted} in case {problem.case}")


def measure(cases: str, members: int, rounds: int) -> list[dict[str, Any]]:
    """Members a second, for every case, error and number of threads."""
    rows = []
    for case in cases:
        problem = Problem.of(case)
        known = references(problem)
        for wanted in ERRORS:
            other, other_error = loosest(problem, wanted, known)
            own = Tribo(case, wanted)
            own_error = true_error(own.run(np.array(ANGLES), 1), known)
            for threads in (1, 2):
                seconds = [np.inf, np.inf]
                for _ in range(rounds):
                    for k, program in enumerate((own, other)):
                        began = time.perf_counter()
                        program.run(members, threads)
                        seconds[k] = min(seconds[k], time.perf_counter() - began)
                rows.append(
                    {
                        "case": case,
                        "error": wanted,
                        "threads": threads,
                        "tribo_per_second": members / seconds[0],
                        "heyoka_per_second": members / seconds[1],
                        "tribo_error": own_error,
                        "heyoka_error": other_error,
                    }
                )
    return rows


def report(rows: list[dict[str, Any]]) -> str:
    """The table as text."""
    lines = ["case  error  threads    tribo / s   heyoka / s  ratio  true errors"]
    for row in rows:
        ratio = row["tribo_per_second"] / row["heyoka_per_second"]
        lines.append(
            f"{row['case']:>4} {row['error']:>6.0e} {row['threads']:>8} "
            f"{row['tribo_per_second']:>12.0f} {row['heyoka_per_second']:>12.0f} {ratio:>6.2f}  "
            f"{row['tribo_error']:.1e} {row['heyoka_error']:.1e}"
        )
    return "\n".join(lines)


def main() -> None:
    """Measure both programs in one process."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--members", type=int, default=200_000)
    parser.add_argument("--cases", default="AC")
    options = parser.parse_args()
    rows = measure(options.cases, options.members, options.rounds)
    print(json.dumps({"rows": rows}, indent=1) if options.json else report(rows))


if __name__ == "__main__":
    main()
