"""Measure the time of one pair of asperites with its whole ledger: tribo, heyoka, SciPy, rebound.

The paper's cases A to D are run to their ends, every time from a new angle theta of the upper
asperite.  Every program is compiled and set up before, at the loosest tolerance whose true error
is below the one wanted.  That error is the largest over several angles and over all reported
angles, rates, positions, velocities, energies, works and pseudoworks at the end, each relative to
its scale, against heyoka in extended precision.  Runs are interleaved, and the shortest of each
counts.

A timed call takes the angle and returns the state at the end; the ledger follows from the state by
formulas.  In the columns "to the number" the call returns a number, the work w1 of the upper
surface at the end, and its formula is timed too.  tribo integrates all of its accounts.  heyoka has
an easier task: coordinates that do not move are left out, and of the ledger it integrates only the
impulse and the works of the contact, from which the rest follows.  "heyoka-motion", SciPy, and
rebound if it is installed have the easiest: the motion alone, since for one pair all works follow
from it by conservation of energy and momentum.  heyoka runs with fast_math.

    python benchmarks/pair.py [--json | --markdown] [--rounds 100] [--cases ABCD]
"""

import argparse
import importlib.util
import json
import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import tribo
from tribo import paper

# Relative errors wanted.
ERRORS = (1e-6, 1e-9, 1e-12)

# Runs of a program in each round: the first one reloads its code and data into the caches.
REPEATS = 10

# Angles at which true errors are measured [rad].
ANGLES = (0.0, 0.03, -0.07, 0.12, 0.2)


@dataclass(frozen=True)
class Problem:
    """The parameters of a case: equal asperites, the upper one forced or free."""

    case: str
    duration: float
    m1: float
    m2: float
    kappa: float
    length: float
    bar_length: float
    strength: float
    free: bool
    gap: tuple[float, float]  # from the lower centre of mass to the upper
    speed: float

    @classmethod
    def of(cls, case: str) -> "Problem":
        """The parameters of the scene that tribo runs."""
        scene = paper.scene(case)
        upper, lower = scene.surfaces
        a = upper.asperite.for_each(1)
        l1 = float(a["l1"][0])
        length = l1 + float(a["l2"][0])
        m1 = float(a["mass"][0]) * (1.0 - l1 / length)
        return cls(
            case=case,
            duration=scene.duration,
            m1=m1,
            m2=float(a["mass"][0]) - m1,
            kappa=float(a["kappa"][0]),
            length=length,
            bar_length=float(a["bar_length"][0]),
            strength=scene.interactions[0].potential.strength,
            free=isinstance(upper.drive, tribo.Free),
            gap=(upper.bob[0] - lower.bob[0], upper.bob[1] - lower.bob[1] + 2.0 * l1),
            speed=upper.velocity[0] - lower.velocity[0],
        )

    @property
    def mass(self) -> float:
        """Mass of one asperite."""
        return self.m1 + self.m2

    @property
    def arms(self) -> tuple[float, float]:
        """Distances of the centre of mass from the bob and from the bar."""
        return self.length * self.m2 / self.mass, self.length * self.m1 / self.mass

    @property
    def inertia(self) -> float:
        """Moment of inertia about the centre of mass."""
        l1, l2 = self.arms
        return self.m1 * l1**2 + self.m2 * l2**2

    def contact(self, y: Any, t: Any, lib: Any) -> tuple[Any, ...]:
        """Force on the upper bob, and sine and cosine of both swings."""
        l1, _ = self.arms
        q, other = y[:2]
        sin, cos, sin2, cos2 = lib.sin(q), lib.cos(q), lib.sin(other), lib.cos(other)
        dx = (y[4] if self.free else self.gap[0] + self.speed * t) + l1 * (sin + sin2)
        dy = self.gap[1] - l1 * (cos + cos2)
        push = self.strength * (dx * dx + dy * dy) ** -1.5
        return push * dx, push * dy, sin, cos, sin2, cos2

    def equations(self, y: Any, t: Any, lib: Any) -> list[Any]:
        """y' for y = (q, Q, q', Q'), followed by (x, x') if the upper asperite is free.

        q and Q are the swings theta and Theta - pi, x is the position of the upper centre of mass.
        """
        l1, _ = self.arms
        q, other, rate, other_rate = y[:4]
        fx, fy, sin, cos, sin2, cos2 = self.contact(y, t, lib)
        across = l1 if self.free else self.length
        turn = (across * cos * fx + self.length * sin * fy - self.kappa * q) / self.inertia
        turn2 = (self.length * (cos2 * fx + sin2 * fy) - self.kappa * other) / self.inertia
        slide = [y[5], fx / self.mass] if self.free else []
        return [rate, other_rate, turn, turn2, *slide]

    def powers(self, y: Any, t: Any, lib: Any) -> list[Any]:
        """Powers of the contact, whose integrals are its accounts.

        Force along x, powers about the upper centre of mass by x and by y, and about the lower one.
        """
        l1, _ = self.arms
        fx, fy, sin, cos, sin2, cos2 = self.contact(y, t, lib)
        one, two = l1 * y[2], l1 * y[3]
        return [fx, one * cos * fx, one * sin * fy, two * (cos2 * fx + sin2 * fy)]

    def ledger_from_accounts(self, angle: float, y: Any, accounts: Any) -> dict[str, float]:
        """The ledger at the end, with works from the integrals of the powers."""
        impulse, about_x, about_y, lower = (float(value) for value in accounts)
        l1, l2 = self.arms
        ledger = self.ledger(angle, y)
        pseudo = ledger["upper.delta_k_trans"] if self.free else self.speed * impulse
        held = 0.0 if self.free else about_x
        return ledger | {
            "upper.w1": self.work_from_accounts(y, accounts),
            "upper.w2": l2 / l1 * (held + about_y) - (0.0 if self.free else pseudo),
            "upper.w1_ps": pseudo,
            "upper.w2_ps": 0.0 if self.free else -pseudo,
            "lower.w1": lower,
            "lower.w2": l2 / l1 * lower,
        }

    def work_from_accounts(self, y: Any, accounts: Any) -> float:
        """The work w1 of the upper surface at the end, from the integrals of the powers."""
        impulse, about_x, about_y = accounts[0], accounts[1], accounts[2]
        return float(about_x + about_y + (self.gain(y[5]) if self.free else self.speed * impulse))

    def gain(self, velocity: float) -> float:
        """Change of the kinetic energy of a free asperite's centre of mass."""
        return 0.5 * self.mass * (velocity - self.speed) * (velocity + self.speed)

    def start(self, angle: float) -> list[float]:
        """y at t = 0."""
        return [angle, 0.0, 0.0, 0.0, *([self.gap[0], self.speed] if self.free else [])]

    def inner(self, swing: float, omega: float) -> float:
        """Internal energy of an asperite."""
        return 0.5 * (self.inertia * omega**2 + self.kappa * swing**2)

    def contact_energy(self, x: float, one: float, two: float) -> float:
        """Energy of the contact, for the upper centre of mass at x and both swings."""
        l1, _ = self.arms
        dx = x + l1 * (math.sin(one) + math.sin(two))
        dy = self.gap[1] - l1 * (math.cos(one) + math.cos(two))
        return self.strength / math.hypot(dx, dy)

    def work(self, angle: float, y: Any) -> float:
        """The work w1 of the upper surface at the end, by conservation of energy."""
        x = y[4] if self.free else self.gap[0] + self.speed * self.duration
        change = self.contact_energy(x, y[0], y[1]) - self.contact_energy(self.gap[0], angle, 0.0)
        return float(-change - self.arms[0] / self.length * self.inner(y[1], y[3]))

    def ledger(self, angle: float, y: Any) -> dict[str, float]:
        """The ledger at the end from the motion, by conservation of energy and momentum."""
        l1, l2 = self.arms
        begin = [float(value) for value in self.start(angle)]
        q, other, rate, other_rate = (float(value) for value in y[:4])
        x, v = self.gap[0] + self.speed * self.duration, self.speed
        if self.free:
            x, v = float(y[4]), float(y[5])

        def ends(swing: float) -> float:
            return -self.kappa * l2 / self.bar_length * (math.sin(swing) - swing * math.cos(swing))

        e1 = self.inner(q, rate) - self.inner(begin[0], 0.0)
        e2 = self.inner(other, other_rate)
        contact = self.contact_energy(x, q, other)
        change = contact - self.contact_energy(self.gap[0], begin[0], 0.0)
        k_trans = self.gain(v)
        if self.free:
            impulse = self.mass * (v - self.speed)
            w2 = k_trans + e1 + e2 + change - l2 / self.length * e2
            w1, w1_ps, w2_ps = k_trans + e1 - w2, k_trans, 0.0
        else:
            impulse = -(l1 / self.length * (e1 + e2) + change) / self.speed
            w1_ps, w2_ps = self.speed * impulse, -self.speed * impulse
            w1, w2 = w1_ps + l1 / self.length * e1, w2_ps + l2 / self.length * e1
        return {
            "upper.theta": q,
            "upper.omega": rate,
            "upper.vx_cm": v,
            "upper.w1": w1,
            "upper.w2": w2,
            "upper.w1_ps": w1_ps,
            "upper.w2_ps": w2_ps,
            "upper.wL": ends(q) - ends(begin[0]),
            "upper.delta_k_trans": k_trans,
            "upper.delta_e_int": e1,
            "lower.theta": other + math.pi,
            "lower.omega": other_rate,
            "lower.w1": l1 / self.length * e2,
            "lower.w2": l2 / self.length * e2,
            "lower.wL": -ends(other),
            "lower.delta_e_int": e2,
            "contact_energy": contact,
        } | ({"upper.x_cm": x - self.gap[0]} if self.free else {})


KIND = {"theta": "angle", "omega": "rate", "x_cm": "length", "vx_cm": "velocity"}


def deviation(problem: Problem, one: dict[str, float], other: dict[str, float]) -> float:
    """The largest difference, relative to the scale of its kind of quantity."""
    kinds = {name: KIND.get(name.rpartition(".")[2], "energy") for name in other}
    scales = {"angle": 1.0, "length": problem.length, "velocity": problem.speed}
    for kind in ("energy", "rate"):
        sizes = [abs(other[name]) for name in other if kinds[name] == kind]
        scales[kind] = max(sizes)
    return max(abs(one[name] - other[name]) / scales[kinds[name]] for name in other)


class Tribo:
    """tribo by gauss-radau-15, which integrates every account."""

    name = "tribo"
    settings = 10.0 ** np.arange(-1.0, -13.0, -0.1)

    def __init__(self, problem: Problem, setting: float) -> None:
        scene = replace(paper.scene(problem.case), output=tribo.Output(samples=2))
        self._simulation = tribo.prepare(scene, accuracy=setting, method="gauss-radau-15")
        self._simulation.run({}, estimate=False)

    def run(self, angle: float) -> Any:
        """Run from an angle; this is timed."""
        return self._simulation.run({"upper.theta": angle}, estimate=False)

    def work(self, problem: Problem, angle: float, end: Any) -> float:
        """The reported work; this is timed."""
        return float(end["upper"].w1[-1, 0])

    def ledger(self, problem: Problem, angle: float, end: Any) -> dict[str, float]:
        """The reported ledger at the end."""
        names = problem.ledger(angle, problem.start(angle))
        found = {}
        for name in names:
            surface, _, quantity = name.rpartition(".")
            series = end[surface][quantity][:, 0] if surface else end.system[quantity]
            found[name] = float(series[-1])
            if quantity == "x_cm":
                found[name] -= float(series[0])
        return found


class HeyokaMotion:
    """heyoka, compiled Taylor series, with the motion alone."""

    name = "heyoka-motion"
    settings = 10.0 ** np.arange(-3.0, -18.1, -0.1)
    accounts = False

    def __init__(self, problem: Problem, setting: float, kind: Any = float) -> None:
        import heyoka

        names = ["q", "Q", "v", "V", "x", "u"][: len(problem.start(0.0))]
        y = [heyoka.expression(name) for name in names]
        equations = list(zip(y, problem.equations(y, heyoka.time, heyoka), strict=True))
        powers = problem.powers(y, heyoka.time, heyoka) if self.accounts else []
        equations += [(heyoka.expression(f"s{k}"), power) for k, power in enumerate(powers)]
        start = [*problem.start(0.0), *(0.0 for _ in powers)]
        self._coordinates = len(names)
        self._start = np.array(start, dtype=kind)
        self._zero, self._duration = kind(0.0), kind(problem.duration)
        self._taylor = heyoka.taylor_adaptive(
            equations, self._start, tol=kind(setting), fast_math=kind is float, fp_type=kind
        )
        self._state = self._taylor.state

    def run(self, angle: float) -> Any:
        """Run from an angle; this is timed."""
        self._taylor.time = self._zero
        self._state[:] = self._start
        self._state[0] = angle
        self._taylor.propagate_until(self._duration)
        return self._state

    def work(self, problem: Problem, angle: float, end: Any) -> float:
        """The work by conservation of energy; this is timed."""
        return problem.work(angle, end)

    def ledger(self, problem: Problem, angle: float, end: Any) -> dict[str, float]:
        """The ledger at the end by conservation laws."""
        return problem.ledger(angle, end)


class Heyoka(HeyokaMotion):
    """heyoka with the accounts of the contact."""

    name = "heyoka"
    accounts = True

    def work(self, problem: Problem, angle: float, end: Any) -> float:
        """The work from the accounts; this is timed."""
        return problem.work_from_accounts(end, end[self._coordinates :])

    def ledger(self, problem: Problem, angle: float, end: Any) -> dict[str, float]:
        """The ledger at the end from the accounts."""
        return problem.ledger_from_accounts(
            angle, end[: self._coordinates], end[self._coordinates :]
        )


class Scipy:
    """SciPy, DOP853 with the equations in Python, with the motion alone."""

    name = "scipy"
    settings = 10.0 ** np.arange(-3.0, -14.1, -0.5)

    def __init__(self, problem: Problem, setting: float) -> None:
        self._problem = problem
        self._setting = max(setting, 3e-14)

    def run(self, angle: float) -> Any:
        """Run from an angle; this is timed."""
        from scipy.integrate import solve_ivp

        problem = self._problem
        return solve_ivp(
            lambda t, y: problem.equations(y, t, math),
            (0.0, problem.duration),
            problem.start(angle),
            method="DOP853",
            rtol=self._setting,
            atol=self._setting,
        ).y[:, -1]

    def work(self, problem: Problem, angle: float, end: Any) -> float:
        """The work by conservation of energy; this is timed."""
        return problem.work(angle, end)

    def ledger(self, problem: Problem, angle: float, end: Any) -> dict[str, float]:
        """The ledger at the end by conservation laws."""
        return problem.ledger(angle, end)


class Rebound:
    """rebound, Bulirsch-Stoer with the equations in Python, with the motion alone."""

    name = "rebound"
    settings = 10.0 ** np.arange(-4.0, -15.1, -0.5)

    def __init__(self, problem: Problem, setting: float) -> None:
        self._problem = problem
        self._setting = setting

    def run(self, angle: float) -> Any:
        """Run from an angle; this is timed."""
        import rebound

        problem = self._problem
        start = problem.start(angle)
        simulation = rebound.Simulation()
        simulation.integrator = "BS"
        accuracy = simulation.integrator
        accuracy.eps_rel = accuracy.eps_abs = self._setting
        ode = simulation.create_ode(length=len(start), needs_nbody=False)

        def derivatives(_: Any, slope: Any, y: Any, t: float) -> None:
            for k, value in enumerate(problem.equations(y[: len(start)], t, math)):
                slope[k] = value

        ode.derivatives = derivatives
        for k, value in enumerate(start):
            ode.y[k] = value
        simulation.integrate(problem.duration)
        return [ode.y[k] for k in range(len(start))]

    def work(self, problem: Problem, angle: float, end: Any) -> float:
        """The work by conservation of energy; this is timed."""
        return problem.work(angle, end)

    def ledger(self, problem: Problem, angle: float, end: Any) -> dict[str, float]:
        """The ledger at the end by conservation laws."""
        return problem.ledger(angle, end)


PROGRAMS = {"tribo": Tribo, "heyoka": Heyoka, "heyoka-motion": HeyokaMotion, "scipy": Scipy}
if importlib.util.find_spec("rebound") is not None:
    PROGRAMS["rebound"] = Rebound
SLOW = ("scipy", "rebound")  # timed less often


def references(problem: Problem) -> list[dict[str, float]]:
    """The ledger at the end from each angle, in extended precision."""
    exact = HeyokaMotion(problem, 1e-18, np.longdouble)
    return [problem.ledger(angle, exact.run(np.longdouble(angle))) for angle in ANGLES]


def settled(
    problem: Problem, system: Callable[[Problem, float], Any], known: list[dict[str, float]]
) -> dict[float, tuple[Any, float, float]]:
    """For each error wanted, the program at its loosest setting, the setting and the error."""
    found: dict[float, tuple[Any, float, float]] = {}
    wanted = list(ERRORS)
    for setting in system.settings:  # type: ignore[attr-defined]
        if not wanted:
            break
        program = system(problem, float(setting))
        error = max(
            deviation(problem, program.ledger(problem, angle, program.run(angle)), exact)
            for angle, exact in zip(ANGLES, known, strict=True)
        )
        while wanted and error < wanted[0]:
            found[wanted.pop(0)] = (program, float(setting), error)
    return found


def measure(cases: str, rounds: int) -> list[dict[str, Any]]:
    """Microseconds of a run and to a number, and true error, for every case, error and program."""
    rows = []
    for case in cases:
        problem = Problem.of(case)
        known = references(problem)
        programs = {
            (wanted, system.name): settings
            for system in PROGRAMS.values()
            for wanted, settings in settled(problem, system, known).items()
        }
        seconds, whole = dict.fromkeys(programs, math.inf), dict.fromkeys(programs, math.inf)
        for k in range(rounds):
            for key, (program, _, _) in programs.items():
                if key[1] in SLOW and k % 50:
                    continue
                for repeat in range(REPEATS):
                    angle = 1e-4 * ((REPEATS * k + repeat) % 2000 + 1)
                    began = time.perf_counter()
                    end = program.run(angle)
                    ran = time.perf_counter()
                    program.work(problem, angle, end)
                    whole[key] = min(whole[key], time.perf_counter() - began)
                    seconds[key] = min(seconds[key], ran - began)
        for (wanted, name), (_, setting, error) in programs.items():
            rows.append(
                {
                    "case": case,
                    "wanted": wanted,
                    "program": name,
                    "setting": setting,
                    "error": error,
                    "microseconds": 1e6 * seconds[wanted, name],
                    "ratio": seconds[wanted, name] / seconds.get((wanted, "tribo"), math.nan),
                    "to_number": 1e6 * whole[wanted, name],
                    "ratio_to_number": whole[wanted, name] / whole.get((wanted, "tribo"), math.nan),
                }
            )
    return rows


def geometric_mean(values: list[float]) -> float:
    """The geometric mean."""
    return math.exp(sum(map(math.log, values)) / len(values))


def report(rows: list[dict[str, Any]]) -> str:
    """The table as text."""
    lines = [
        f"{'case':>4} {'error':>6}  {'program':<13} {'us':>9} {'true error':>11} {'ratio':>7} "
        f"{'to the number':>13} {'ratio':>7}"
    ]
    for row in sorted(rows, key=lambda row: (row["case"], -row["wanted"])):
        lines.append(
            f"{row['case']:>4} {row['wanted']:>6.0e}  {row['program']:<13} "
            f"{row['microseconds']:>9.1f} {row['error']:>11.1e} {row['ratio']:>7.2f} "
            f"{row['to_number']:>13.1f} {row['ratio_to_number']:>7.2f}"
        )
    for name in list(PROGRAMS)[1:]:
        for ratio, what in (("ratio", "a run"), ("ratio_to_number", "from the call to the number")):
            ratios = [row[ratio] for row in rows if row["program"] == name]
            if ratios:
                mean, least = geometric_mean(ratios), min(ratios)
                lines.append(
                    f"{name}, {what}: {mean:.2f} times tribo's time on average, "
                    f"at least {least:.2f}"
                )
    return "\n".join(lines)


# Tables of the page: a sentence, and the column of the rows that is shown for each program.
TABLES = {
    "ratio_to_number": "Times to the number, divided by that of tribo:",
    "to_number": "Microseconds to the number:",
    "microseconds": "Microseconds of the integration:",
}


def markdown(rows: list[dict[str, Any]]) -> str:
    """The tables of docs/developers/pairs.md."""
    return "\n\n".join(f"{text}\n\n{_table(rows, key)}" for key, text in TABLES.items())


def _table(rows: list[dict[str, Any]], key: str) -> str:
    """One number of every program, for each case and accuracy; ratios with their means."""
    titles = {"heyoka-motion": "heyoka, motion alone", "scipy": "SciPy"}
    programs = list(PROGRAMS)[1:] if key.startswith("ratio") else list(PROGRAMS)
    lines = [["case", "true error below", *(titles.get(name, name) for name in programs)]]
    lines.append(["---"] * len(lines[0]))
    for case, wanted in sorted({(row["case"], -row["wanted"]) for row in rows}):
        found = {r["program"]: r for r in rows if (r["case"], -r["wanted"]) == (case, wanted)}
        values = [f"{found[name][key]:.3g}" if name in found else "-" for name in programs]
        lines.append([case, f"{-wanted:.0e}", *values])
    if key.startswith("ratio"):
        ratios = [[row[key] for row in rows if row["program"] == name] for name in programs]
        means = [f"{geometric_mean(each):.3g}" if each else "-" for each in ratios]
        lines.append(["geometric mean", "", *means])
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def main() -> None:
    """Measure all programs in one process."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--markdown", action="store_true", help="as in docs/measured/pair.md")
    parser.add_argument("--rounds", type=int, default=100)
    parser.add_argument("--cases", default="ABCD")
    options = parser.parse_args()
    rows = measure(options.cases, options.rounds)
    shown = markdown if options.markdown else report
    print(json.dumps(rows, indent=1) if options.json else shown(rows))


if __name__ == "__main__":
    main()
