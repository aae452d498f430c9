"""Numbers and objects that follow from a run: averages, files, copies, threads, potentials."""

from __future__ import annotations

import copy
import pickle
import tempfile
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np

import tribo
from support.mixed import potentials
from support.mixed.comparison import ACCURACY, Findings, compare, is_refused, same
from support.mixed.draw import Draw, Scene, Table
from support.mixed.many import put
from support.mixed.states import at_rest
from tribo.model.scene_file import scene_from

# Names of surfaces that a file could confuse with parts of its own.
NAMES = ("state", "first", "memory", "a b", "system", "t", "x_cm", "tip_1")
ROUNDING = 1e-9
# How far a bar has to move to slide [length].
SLID = 0.05


def check_averages(findings: Findings, scene: Scene, draw: Draw) -> None:
    """Mean forces of a window are those of the recorded series; what is weighted says so."""
    table = scene.copy()
    check = "averages"
    after = draw.pick(0.0, 0.3) * table["duration"]
    table["output"] = {"samples": 121, "series": ["forces"], "run_in": after}
    result = _run(scene, table)
    findings.checks.append(check)
    if result.status != "completed":
        return
    name = table["surface"][0]["name"]
    for quantity, found in (
        ("friction_force", result.friction_force(name)),
        ("pull_force", result.pull_force(name)),
    ):
        series = np.asarray(result[name][quantity])
        window = result.t >= after - ROUNDING
        t = result.t[window]
        values = series[window]
        plain = np.trapezoid(values, t) / (t[-1] - t[0])
        scale = float(np.max(np.abs(values), initial=1e-6))
        if abs(found.mean - plain) > 1e-6 * scale and "weight" not in str(found):
            text = f"{quantity}: mean {found.mean:.6g}, of the series {plain:.6g}, {found.note!r}"
            findings.add("silent", check, text)


def check_depinning(findings: Findings, scene: Scene, draw: Draw) -> None:
    """The force at which a surface starts to slide is one that the run recorded."""
    table = scene.copy()
    drive = table["surface"][0]["drive"]
    if not isinstance(drive, dict) or not {"speed", "rate"} & set(drive):
        return
    rest = draw.chance(0.6)
    check = "depinning" + (" after a rest" if rest else "")
    table["output"] = {"samples": 401, "series": ["forces"]}
    how: dict[str, Any] = {"method": scene.structure.method, "accuracy": 1e-4}
    start = None
    if rest:
        first = copy.deepcopy(table)
        at_rest(first)
        first["duration"] = draw.between(1.0, 4.0)
        table["duration"] += first["duration"]
        one = tribo.simulate(scene_from(first), **how)
        if one.status != "completed":
            return
        start = one.state()
    result = tribo.simulate(scene_from(copy.deepcopy(table)), **how, start=start)
    findings.checks.append(check)
    name = table["surface"][0]["name"]
    recorded = np.asarray(result[name]["f2_x"])
    place = np.asarray(result[name]["x_bar"])
    if table["surface"][0].get("springs"):  # which make the bars slide together
        recorded, place = (
            np.tile(each.mean(axis=1, keepdims=True), each.shape[1]) for each in (recorded, place)
        )
    moved = float(np.max(_along(table, result, place, recorded)))
    if result.status == "completed" and moved < SLID:
        if not is_refused(lambda: result.depinning(name, distance=SLID)):
            findings.add("silent", check, f"bars that moved by {moved:.3g} are said to slide")
        return
    found = result.depinning(name, distance=SLID)
    for k, (t, force) in enumerate(zip(found.times, found.each, strict=True)):
        if np.isfinite(force):
            at = int(np.argmin(np.abs(result.t - t)))
            scale = max(1.0, float(np.max(np.abs(recorded))))
            allowed = 1e-6 * scale
            same(findings, check, force, recorded[at, k], allowed, f"force {k} at t = {t:.4g}")


def _along(table: Table, result: tribo.Result, place: np.ndarray, force: np.ndarray) -> np.ndarray:
    """How far bars moved along their drive, over the fields or else the other surface."""
    upper = table["surface"][0]
    t = result.t - result.t[0]
    fields = [f for f in table.get("field", []) if upper["name"] in f["on"]]
    if fields:
        ground = np.mean([f.get("velocity", (0.0, 0.0))[0] for f in fields]) * t
    else:
        ground = result[table["surface"][1]["name"]]["x_bar"].mean(axis=1)
    moved = place - ground[:, None]
    sign = np.sign(force[-1, 0])
    if upper["drive"]["kind"] == "pulled":
        sign = np.sign(upper["drive"]["speed"] * t[-1] - (ground[-1] - ground[0]))
    return sign * (moved - moved[0])


def check_files(findings: Findings, scene: Scene, draw: Draw) -> None:
    """A file gives back every series and the state, whatever surfaces are called."""
    table = scene.copy()
    check = "file"
    if draw.chance(0.5):
        rename(table, draw.pick(*NAMES))
        check = f"file with a surface {table['surface'][0]['name']!r}"
    result = _run(scene, table)
    findings.checks.append(check)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.nc"
        result.save(path)
        again = tribo.load_result(path)
        series_alike(findings, check, result, again)
        if result.error_estimate != again.error_estimate:
            findings.add("silent", check, "error estimates differ")
        if result.status == "completed" and again.state().digest != result.state().digest:
            findings.add("silent", check, "the state differs")
        if draw.chance(0.3):
            repeated = tribo.simulate(again.scene, method=scene.structure.method, accuracy=ACCURACY)
            series_alike(findings, f"{check}, repeated", result, repeated)


def rename(table: Table, name: str) -> None:
    """Give the first surface another name."""
    old = table["surface"][0]["name"]
    table["surface"][0]["name"] = name
    for part in (*table["interaction"], *table.get("field", [])):
        for key in ("between", "on"):
            if key in part:
                part[key] = [name if each == old else each for each in part[key]]


def series_alike(findings: Findings, check: str, one: tribo.Result, other: tribo.Result) -> None:
    """All series have the same bits."""
    groups = [("system", one.system, other.system)]
    groups += [(s.name, one[s.name], other[s.name]) for s in one.scene.surfaces]
    for name, mine, theirs in groups:
        if set(mine) != set(theirs):
            findings.add("silent", check, f"{name}: {sorted(set(mine) ^ set(theirs))[:4]} differ")
            continue
        for quantity in mine:
            if not np.array_equal(mine[quantity], theirs[quantity], equal_nan=True):
                findings.add("silent", check, f"{name}.{quantity} differs")
                return


def check_copies(findings: Findings, scene: Scene, draw: Draw) -> None:
    """Copies, pickles and threads give the same bits; initial values those of their own scene."""
    table = scene.copy()
    check = "copies"
    built = scene_from(copy.deepcopy(table))
    how: dict[str, Any] = {"method": scene.structure.method, "accuracy": ACCURACY}
    simulation = tribo.prepare(built, **how, threads=1)
    result = simulation.run()
    findings.checks.append(check)
    others = [pickle.loads(pickle.dumps(simulation)), copy.deepcopy(simulation)]
    others.append(tribo.prepare(built, **how, threads=2))
    for each in others:
        series_alike(findings, check, result, each.run())
    if "rigid" in scene.structure.effects:
        return
    n = table["surface"][0]["shape"][0]
    turns = "turning" in scene.structure.effects
    angle = "upper.phi" if turns else "upper.swing"  # clamped bars keep their angle
    key = draw.pick("upper.theta", "upper.swing", "upper.omega", angle)
    values = draw.each(-0.2, 0.2, n)
    put(table, key, values)
    changed = simulation.run({key: values})
    compare(findings, f"run({key})", changed, table)


class _Forced(tribo.Forced):
    """A drive that changes nothing of its parent."""


class _Free(tribo.Free):
    """As above."""


class _Pulled(tribo.Pulled):
    """As above."""


class _Pushed(tribo.Pushed):
    """As above."""


CHILDREN = {"Forced": _Forced, "Free": _Free, "Pulled": _Pulled, "Pushed": _Pushed}


def check_subclass(findings: Findings, scene: Scene, draw: Draw) -> None:
    """A subclass of a drive that adds nothing is its parent, or is refused."""
    built = scene_from(scene.copy())
    drive = built.surfaces[0].drive
    child = CHILDREN.get(type(drive).__name__)
    if child is None:
        return
    check = f"subclass of {type(drive).__name__}"
    given = {field.name: getattr(drive, field.name) for field in fields(drive)}
    surface = replace(built.surfaces[0], drive=child(**given))
    other = replace(built, surfaces=(surface, *built.surfaces[1:]))
    findings.checks.append(check)
    result = tribo.simulate(other, method=scene.structure.method, accuracy=ACCURACY)
    assert draw is not None
    compare(findings, check, result, scene.table)


def check_potentials(findings: Findings, scene: Scene, draw: Draw) -> None:
    """Energies and forces of the scene's potentials at distances of all sizes."""
    built = scene_from(scene.copy())
    for table, interaction in zip(scene.table["interaction"], built.interactions, strict=True):
        whole = interaction.potential
        check = f"potential {table['potential']}"
        findings.checks.append(check)
        if draw.chance(0.5) and "cutoff" not in table:
            cutoff = draw.between(1.0, 3.0)
            how = draw.pick("switch", "shift", "force-shift")
            table = copy.deepcopy(table) | {"cutoff": cutoff, "at_cutoff": how}
            whole = whole.with_cutoff(cutoff, how)
            check = f"{check}, cut by {how}"
        energy = potentials.energy_of(table)
        for r in draw.each(0.45, 3.5, 12):
            q = np.array([draw.between(0.5, 1.5)])
            at = np.array([r])
            theirs = float(energy(at, q)[0].real), float(potentials.force(energy, at, q)[0])
            ours = (
                whole.energy_between(r, 1.0, float(q[0])),
                whole.force_between(r, 1.0, float(q[0])),
            )
            allowed = 1e-9 * (1.0 + max(map(abs, theirs)))
            same(findings, check, ours, theirs, allowed, f"energy and force at r = {r}")


def _run(scene: Scene, table: Table) -> tribo.Result:
    """A run of a table that may be changed later."""
    return tribo.simulate(
        scene_from(copy.deepcopy(table)), method=scene.structure.method, accuracy=ACCURACY
    )
