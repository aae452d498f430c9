"""Scenes with noise in equilibrium: temperatures, momentum balance, and a halved step.

Every scene has one temperature and no drive that moves, so that m <v^2> = T for every velocity,
and the mean force of a load is the load.  Steps are those that tribo chooses.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

import tribo
from support.mixed.comparison import Findings, doubted
from support.mixed.draw import Draw
from support.mixed.plugins import Trap
from tribo.potentials import from_points

# What a step may change of a mean, relative to it, beside the interval.
BIAS = 0.01
# Half-widths of a 95 % interval within which the first run may be off without a second look.
SUSPECT = 1.3
LONGER = 6.0


class Mean(NamedTuple):
    """An average, its interval and what it has to be."""

    name: str
    mean: float
    half_width: float
    expected: float

    @property
    def excess(self) -> float:
        """The deviation beyond 1 %, in half-widths."""
        beyond = abs(self.mean - self.expected) - BIAS * abs(self.expected)
        return beyond / max(self.half_width, 1e-12)


class Warm(NamedTuple):
    """A scene with noise and the means that it has to have."""

    scene: tribo.Scene
    means: Callable[[tribo.Result], list[Mean]]
    text: str


def _average(result: tribo.Result, values: np.ndarray, name: str, expected: float) -> Mean:
    """The mean of a series after the run-in, over its columns together."""
    series = values.mean(axis=1) if values.ndim == 2 else values
    found = tribo.time_average(result.t, series, after=0.05 * float(result.t[-1]))
    return Mean(name, found.mean, found.half_width, expected)


def _output(duration: float, forces: bool = False) -> dict[str, Any]:
    samples = 8001
    series = ["forces"] if forces else []
    return {"duration": duration, "output": tribo.Output(samples=samples, series=series)}


def trap(draw: Draw, longer: float) -> Warm:
    """A rigid tip in a trap of the user's own, of any stiffness."""
    along = draw.between(0.5, 45.0)
    across = draw.between(0.5, 45.0)
    temperature = draw.between(0.02, 0.5)
    gamma = draw.between(1.0, 5.0)
    tip = tribo.Surface(
        "tip",
        asperite=tribo.Asperite(m1=1.0, m2=draw.between(1.0, 3.0), kappa=np.inf),
        drive=tribo.Free(load=0.0),
        langevin=tribo.Langevin(gamma, temperature),
        initial=tribo.Initial(temperature=temperature),
    )
    mass = float(np.sum([tip.asperite.m1, tip.asperite.m2]))
    field = tribo.Field(Trap(along, across), on=["tip"])
    scene = tribo.Scene([tip], [], fields=[field], seed=draw.pick(1, 2, 3), **_output(4e3 * longer))

    def means(result: tribo.Result) -> list[Mean]:
        own = result["tip"]
        return [
            _average(result, mass * own.vx_cm**2, "M <vx^2>", temperature),
            _average(result, mass * own.vy_cm**2, "M <vy^2>", temperature),
            _average(result, along * own.x_bob**2, "k <x^2>", temperature),
            _average(result, across * own.y_bob**2, "k <y^2>", temperature),
        ]

    return Warm(scene, means, f"trap {along}, {across}, M = {mass}, T = {temperature}")


def bond(draw: Draw, longer: float) -> Warm:
    """Two pendulums on driven bars whose bobs a bond of any stiffness joins."""
    length = draw.between(1.0, 2.0)
    depth = draw.between(0.5, 45.0)
    temperature = draw.between(1e-4, 1e-3)
    asperite = tribo.Asperite(
        m1=draw.between(0.8, 1.5), kappa=draw.between(1.0, 3.0), length=length
    )
    inertia = float(asperite.m1) * length**2

    def surface(name: str, x: float) -> tribo.Surface:
        return tribo.Surface(
            name,
            bob=(x, 0.0),
            asperite=asperite,
            drive="bars",
            langevin=tribo.Langevin(draw.between(0.5, 2.0), temperature, on="swing"),
            initial=tribo.Initial(temperature=temperature),
        )

    morse = tribo.Morse(depth, 1.0, 5.0)
    surfaces = [surface("one", 0.0), surface("other", 5.0)]
    scene = tribo.Scene(surfaces, morse, seed=draw.pick(1, 2, 3), **_output(8e3 * longer))

    def means(result: tribo.Result) -> list[Mean]:
        return [
            _average(
                result, inertia * result[name].omega ** 2, f"J <omega^2> of {name}", temperature
            )
            for name in ("one", "other")
        ]

    return Warm(scene, means, f"bond D = {depth}, length {length}, T = {temperature}")


def pressed(draw: Draw, longer: float) -> Warm:
    """A rigid tip that a load presses on a periodic row: kinetic temperature and momentum."""
    load = draw.between(0.2, 1.0)
    temperature = draw.between(0.03, 0.15)
    strength = draw.between(0.5, 10.0)
    tip = tribo.Surface(
        "tip",
        bob=(0.0, 1.1),
        asperite=tribo.Asperite(m1=1.0, m2=draw.between(1.0, 2.0), kappa=np.inf),
        drive=tribo.Free(load=load),
        langevin=tribo.Langevin(draw.between(1.0, 3.0), temperature),
    )
    mass = float(np.sum([tip.asperite.m1, tip.asperite.m2]))
    rigid = tribo.Asperite(kappa=np.inf)
    shape = {"shape": (6, 1), "spacing": (1.0, 0.0), "asperite": rigid}
    row = tribo.Surface("row", facing="up", drive="bars", **shape)
    contact = tribo.LennardJones(strength, 1.0).with_cutoff(2.5)
    how = _output(2e3 * longer, forces=True)
    scene = tribo.Scene([tip, row], contact, periodic={"x": 6.0}, seed=draw.pick(1, 2, 3), **how)

    def means(result: tribo.Result) -> list[Mean]:
        own = result["tip"]
        return [
            _average(result, own.f1_y, "<f1_y>", load),
            _average(result, mass * own.vx_cm**2, "M <vx^2>", temperature),
            _average(result, mass * own.vy_cm**2, "M <vy^2>", temperature),
        ]

    return Warm(scene, means, f"load {load}, epsilon {strength}, T = {temperature}")


def held(draw: Draw, longer: float) -> Warm:
    """A pendulum on a pulling spring at rest over a corrugation, with both reservoirs."""
    temperature = draw.between(0.05, 0.4)
    stiffness = draw.between(0.5, 30.0)
    amplitude = draw.between(0.05, 2.0)
    period = draw.between(0.5, 1.5)
    asperite = tribo.Asperite(kappa=draw.between(0.8, 3.0), length=draw.between(1.0, 2.0))
    mass = float(np.sum([asperite.m1, asperite.m2]))
    inertia = float(asperite.m1 * asperite.m2) / mass * float(asperite.length) ** 2
    both = [
        tribo.Langevin(draw.between(0.5, 3.0), temperature),
        tribo.Langevin(draw.between(0.5, 2.0), temperature, on="swing"),
    ]
    tip = tribo.Surface(
        "tip",
        asperite=asperite,
        drive=tribo.Pulled(stiffness=stiffness, speed=0.0),
        langevin=both,
        initial=tribo.Initial(temperature=temperature),
    )
    field = tribo.Field(tribo.Corrugation(amplitude, period), on=["tip"])
    scene = tribo.Scene([tip], [], fields=[field], seed=draw.pick(1, 2, 3), **_output(4e3 * longer))

    def means(result: tribo.Result) -> list[Mean]:
        own = result["tip"]
        return [
            _average(result, mass * own.vx_cm**2, "M <vx^2>", temperature),
            _average(result, inertia * own.omega**2, "I <omega^2>", temperature),
        ]

    text = f"spring {stiffness}, corrugation {amplitude} / {period}, T = {temperature}"
    return Warm(scene, means, text)


def composed(draw: Draw, longer: float) -> Warm:
    """A tip with a bath, pressed on a row by a sum of a table and a scaled hill, over a field."""
    load = draw.between(0.2, 1.0)
    temperature = draw.between(0.03, 0.15)
    r = np.linspace(0.3, 3.0, 400)
    depth = draw.between(0.5, 5.0)
    hill = draw.between(0.5, 3.0)
    table = from_points(r, depth * (np.exp(-4.0 * (r - 1.0)) - 2.0 * np.exp(-2.0 * (r - 1.0))))
    contact = (table + hill * tribo.Gaussian(0.2, 0.4)).with_cutoff(2.5)
    oscillators = draw.each(0.1, 0.5, 2), draw.each(0.5, 6.0, 2)
    tip = tribo.Surface(
        "tip",
        bob=(0.0, 1.0),
        asperite=tribo.Asperite(m1=1.0, m2=draw.between(1.0, 2.0), kappa=np.inf),
        drive=tribo.Free(load=load),
        bath=tribo.Bath(*oscillators, temperature=temperature),
        langevin=tribo.Langevin(draw.between(1.0, 3.0), temperature),
        initial=tribo.Initial(temperature=temperature),
    )
    mass = float(np.sum([tip.asperite.m1, tip.asperite.m2]))
    rigid = tribo.Asperite(kappa=np.inf)
    shape = {"shape": (6, 1), "spacing": (1.0, 0.0), "asperite": rigid}
    row = tribo.Surface("row", facing="up", drive="bars", **shape)
    field = tribo.Field(tribo.Corrugation(draw.between(0.02, 0.3), 1.0), on=["tip"])
    how = _output(2e3 * longer, forces=True) | {"seed": draw.pick(1, 2, 3), "fields": [field]}
    scene = tribo.Scene([tip, row], contact, periodic={"x": 6.0}, **how)

    def means(result: tribo.Result) -> list[Mean]:
        own = result["tip"]
        return [
            _average(result, own.f1_y, "<f1_y>", load),
            _average(result, mass * own.vx_cm**2, "M <vx^2>", temperature),
            _average(result, mass * own.vy_cm**2, "M <vy^2>", temperature),
        ]

    return Warm(scene, means, f"load {load}, depth {depth}, hill {hill}, T = {temperature}")


WARM = {
    "noise trap": trap,
    "noise bond": bond,
    "noise load": pressed,
    "noise held": held,
    "noise composed": composed,
}
# Kinds whose kinetic energy is that of one velocity of each surface.
PLAIN = ("noise trap", "noise bond", "noise held", "noise composed")
CHECKS = ("run", "run", "ensemble", "continued", "halved", "sweep")
MEMBERS = 2048
# Duration of members in units of the slowest damping: starts are drawn without contact and field,
# and are up to a hundred times too hot.
SETTLED = 12.0
# Temperatures of a sweep, relative to that of the scene.
COLDER = (1.0, 0.25)


def check_noise(findings: Findings, name: str) -> None:
    """One scene with noise, judged by its temperatures; a suspect is run again for longer."""
    draw = Draw(findings.seed, 2)
    check = draw.pick(*CHECKS)
    if check in ("ensemble", "sweep") and name in PLAIN:
        return _ensemble(findings, name, check == "sweep")
    if check == "halved":
        return _halved(findings, name)
    warm = WARM[name](Draw(findings.seed, 3), 1.0)
    check = f"{name}, {check}: {warm.text}"
    findings.checks.append(check)
    result = _run(findings, warm.scene, check, "continued" in check)
    if result is None:
        return None
    suspects = [each.name for each in warm.means(result) if each.excess > SUSPECT]
    if suspects:
        longer = WARM[name](Draw(findings.seed, 3), LONGER)
        result = _run(findings, replace(longer.scene, seed=99), check, False)
        if result is None:
            return None
        for each in longer.means(result):
            if each.name in suspects and each.excess > SUSPECT:
                verdict = "noted" if doubted(result.notes) else "silent"
                value = f"{each.mean:.4g} +- {each.half_width:.2g} for {each.expected:.4g}"
                findings.add(verdict, check, f"{each.name}: {value}")
    return None


def _run(
    findings: Findings, scene: tribo.Scene, check: str, continued: bool
) -> tribo.Result | None:
    """A run with the step that tribo chooses; in two pieces where it is continued."""
    start = None
    if continued:
        short = replace(scene, duration=0.1 * scene.duration, output=tribo.Output(samples=5))
        start = tribo.simulate(short).state()
    result = tribo.simulate(scene, start=start)
    if result.status != "completed":
        findings.add("stopped", check, str(result.status))
        return None
    return result


def _ensemble(findings: Findings, name: str, swept: bool) -> None:
    """Kinetic energies of many members at the end of their runs; of suspects after longer ones."""
    warm = WARM[name](Draw(findings.seed, 3), 1.0)
    check = f"{name}, {'sweep' if swept else 'ensemble'}: {warm.text}"
    findings.checks.append(check)
    moving = [each for each in warm.scene.surfaces if each.langevin is not None]
    settled = SETTLED * max(map(_slowest, moving))
    for duration in (settled, LONGER * settled):  # where a bath keeps what it had at the start
        scene = replace(warm.scene, duration=duration, output=tribo.Output(samples=2))
        found, problem = _hot_members(scene, name, swept)
        if problem is not None:
            verdict, text = problem
            findings.add(verdict, check, text)
            return
        if not found:
            return
    for text in found:
        findings.add("silent", check, text)


def _hot_members(
    scene: tribo.Scene, name: str, swept: bool
) -> tuple[list[str], tuple[str, str] | None]:
    """Mean energies that are off, at each temperature; a verdict and text if members stopped."""
    moving = [each for each in scene.surfaces if each.langevin is not None]
    quantity = "vx_cm" if name in ("noise trap", "noise composed") else "omega"
    keep = [f"{surface.name}.{quantity}" for surface in moving]
    how: dict[str, Any] = {"keep": keep, "progress": False}
    if swept:
        temperatures = [part * _temperature(moving[0]) for part in COLDER]
        keys = tuple(key for surface in moving for key in _temperatures(surface))
        values = {keys: [(each,) * len(keys) for each in temperatures]}
        data = tribo.sweep(scene, values, members=MEMBERS, **how)
    else:
        temperatures = [_temperature(moving[0])]
        data = tribo.ensemble(scene, MEMBERS, **how)
    done = data["status"].values == "completed"
    notes = str(data.attrs.get("notes", ""))
    if not done.all():
        verdict = "stopped" if doubted((notes,)) else "silent"
        return [], (verdict, f"{(~done).sum()} of {done.size} members stopped: {notes!r}")
    wrong = []
    for surface, full in zip(moving, keep, strict=True):
        own = surface.asperite
        weight = mass = float(np.sum([own.m1, own.m2]))
        if quantity == "omega":
            whole = float(own.m1) * float(own.length) ** 2
            weight = whole if name == "noise bond" else whole * float(own.m2) / mass
        rates = data[f"{full}_end" if f"{full}_end" in data else full].values
        for expected, each in zip(temperatures, rates.reshape(-1, MEMBERS), strict=True):
            energy = weight * each**2
            half = 1.96 * float(energy.std(ddof=1)) / energy.size**0.5
            found = Mean(f"m <{full}^2>", float(energy.mean()), half, expected)
            if found.excess > 2.5:
                value = f"{found.mean:.4g} +- {half:.2g} for {expected:.4g}"
                wrong.append(f"{found.name}: {value}, notes {notes!r}")
    return wrong, None


def _slowest(surface: tribo.Surface) -> float:
    """The longest time in which a reservoir of a surface damps energy."""
    own = surface.asperite
    inertia = {"bar": own.m1 + own.m2, "swing": own.m1 * own.length**2}
    given = surface.langevin
    return max(
        float(inertia[each.on]) / each.gamma
        for each in (given if isinstance(given, tuple) else (given,))
    )


def _temperature(surface: tribo.Surface) -> float:
    given = surface.langevin
    return (given[0] if isinstance(given, tuple) else given).temperature


def _temperatures(surface: tribo.Surface) -> list[str]:
    """Keys of all temperatures of a surface."""
    both = isinstance(surface.langevin, tuple)
    keys = ["langevin.bar", "langevin.swing"] if both else ["langevin"]
    keys += ["bath"] if surface.bath else []
    return [f"{surface.name}.{key}.temperature" for key in keys] + [f"{surface.name}.temperature"]


def _halved(findings: Findings, name: str) -> None:
    """Means with the automatic step and with half of it agree."""
    warm = WARM[name](Draw(findings.seed, 3), 1.0)
    check = f"{name}, halved: {warm.text}"
    findings.checks.append(check)
    one = _run(findings, warm.scene, check, False)
    if one is None:
        return
    step = warm.scene.duration / one.cost.steps
    for factor, longer in ((1.0, 1.0), (LONGER, LONGER)):
        scene = WARM[name](Draw(findings.seed, 3), longer).scene
        coarse = one if factor == 1.0 else _run(findings, scene, check, False)
        fine = tribo.simulate(replace(scene, seed=77), method=one.method, step=0.5 * step)
        if coarse is None or fine.status != "completed":
            findings.add("stopped", check, str(fine.status))
            return
        pairs = list(zip(warm.means(coarse), warm.means(fine), strict=True))
        both = [
            Mean(a.name, a.mean, float(np.hypot(a.half_width, b.half_width)), b.mean)
            for a, b in pairs
        ]
        wrong = [each for each in both if each.excess > SUSPECT]
        if not wrong:
            return
    for each in wrong:
        verdict = "noted" if doubted(one.notes) else "silent"
        text = (
            f"{each.mean:.4g} with the step, {each.expected:.4g} with half, {each.half_width:.2g}"
        )
        findings.add(verdict, check, f"{each.name}: {text}")
