"""Runs in two pieces: the second one against a solution from what the first one recorded."""

from __future__ import annotations

import copy
import pickle
import tempfile
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import tribo
from support.mixed.comparison import ACCURACY, ROUNDING, Findings, compare, is_refused, same
from support.mixed.draw import Draw, Scene, Table, drive_of
from support.mixed.solver import SYSTEM, Model, Start, Surface, vectors
from tribo.model.scene_file import scene_from

NUMBERS = ("x_cm", "y_cm", "vx_cm", "vy_cm", "theta", "omega", "phi", "nu")
# Least difference of velocities of asperites that are no rigid body.
APART = 1e-6
# Ways in which a state is passed on, and what else the second scene is.
CARRIED = ("as it is", "pickled", "copied", "from a file")
CHANGES = ("same", "same", "order", "drive", "stage", "ramp", "load", "fields", "rest", "potential")


def check_state(findings: Findings, scene: Scene, draw: Draw) -> None:
    """Run to a time, change the scene in one way, and run on from the state."""
    first = scene.copy()
    change = draw.pick(*CHANGES)
    whole = first["duration"]
    if change == "rest":
        at_rest(first)
    pause = draw.between(0.3, 0.7) * whole
    first |= {"duration": pause, "output": scene.table["output"] | {"samples": 3}}
    second = scene.copy()
    second["output"] = scene.table["output"] | {"samples": 7}
    second = changed(second, change, draw, scene)
    if second is None:
        return
    check = f"state, {change}"
    how: dict[str, Any] = {"method": scene.structure.method, "accuracy": ACCURACY}
    one = tribo.simulate(scene_from(copy.deepcopy(first)), **how)
    if one.status != "completed":
        findings.add("stopped", check, str(one.status))
        return
    state = carried(one, draw.pick(*CARRIED))
    run = partial(tribo.simulate, scene_from(copy.deepcopy(second)), **how, start=state)
    body = change == "drive" and "rigid" in second["surface"][0]["drive"]
    body = body and "rigid" not in first["surface"][0]["drive"]
    if body and np.ptp(one["upper"]["vx_cm"][-1]) > APART:
        findings.checks.append(f"{check} to a rigid body")
        if not is_refused(run):
            findings.add("silent", check, "asperites that move apart were made a rigid body")
        return
    other = run()
    if change == "same" and other.status == "completed":
        works_continue(findings, check, one, other)
    start = named_start(one, first, second)
    stood = first["surface"][0]["drive"]
    now = second["surface"][0]["drive"]
    new_pull = change == "drive" and isinstance(now, dict) and now["kind"] == "pulled"
    if new_pull and not (isinstance(stood, dict) and stood["kind"] == "pulled"):
        # A new stage stands where the bars were at rest, at t = 0 or in their uniform motion.
        trial = Findings(findings.seed, findings.kind)
        if not compare(trial, check, other, second, start) and trial.verdict == "silent":
            start.stages["upper"] = float(first["surface"][0]["velocity"][0]) * start.t
    compare(findings, check, other, second, start)


def works_continue(findings: Findings, check: str, one: tribo.Result, other: tribo.Result) -> None:
    """In the same scene works go on from their values."""
    for each in one.scene.surfaces:
        for name in ("w1", "w2", "W", "delta_E_int"):
            values = one[each.name][name][-1], other[each.name][name][0]
            same(
                findings, check, values[1], values[0], ROUNDING, f"{each.name}.{name} at the state"
            )
    for name in ("contact_energy", "total_energy_change"):
        values = one.system[name][-1], other.system[name][0]
        same(findings, check, values[1], values[0], ROUNDING, f"{name} at the state")
    assert SYSTEM


def carried(result: tribo.Result, how: str) -> tribo.State:
    """The state of a result, passed on in one way."""
    if how == "from a file":
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "part.nc"
            result.save(path)
            return tribo.load_result(path).state()
    state = result.state()
    if how == "pickled":
        return pickle.loads(pickle.dumps(state))
    return copy.deepcopy(state) if how == "copied" else state


def at_rest(table: Table) -> None:
    """Stages and ramps of a scene stand still."""
    for surface in table["surface"]:
        drive = surface["drive"]
        if isinstance(drive, dict) and "speed" in drive:
            drive["speed"] = 0.0
        if isinstance(drive, dict) and "rate" in drive:
            drive["rate"] = [0.0, 0.0]


def changed(table: Table, change: str, draw: Draw, scene: Scene) -> Table | None:
    """The second scene; None where there is nothing to change."""
    upper = table["surface"][0]
    drive = upper["drive"] if isinstance(upper["drive"], dict) else {}
    if change == "order":
        table["surface"].reverse()
        table.get("field", []).reverse()
        if len(table["surface"]) + len(table.get("field", [])) < 3:
            return None
    elif change == "drive":
        if "load" in drive:
            return None
        new = drive_of(draw, scene.structure, upper=True)
        if isinstance(new, dict):
            new.pop("load", None)
        upper["drive"] = new
    elif change == "stage":
        if "speed" not in drive:
            return None
        drive["speed"] = draw.between(-0.5, 0.9)
        if draw.chance(0.5):
            drive["stiffness"] *= draw.between(0.5, 2.0)
    elif change == "ramp":
        if "rate" not in drive:
            return None
        drive["rate"] = [draw.between(0.02, 0.3), 0.0]
    elif change == "load":
        if not drive or "rate" in drive or upper["drive"]["kind"] == "bars":
            return None
        drive["load"] = drive["load"] * 1.7 if draw.chance(0.7) and "load" in drive else 0.05
    elif change == "fields":
        if not table.get("field"):
            return None
        table["field"][-1]["velocity"] = [draw.between(-0.4, 0.4), 0.0]
    elif change == "rest":
        if "speed" not in drive and "rate" not in drive:
            return None
    elif change == "potential":
        if scene.name != "pair":
            return None
        table["interaction"][0]["strength"] *= draw.between(0.4, 2.0)
    return table


def named_start(one: tribo.Result, first: Table, second: Table) -> Start:
    """Where the second run begins, from the last sample of the first one and its scene."""
    t = float(one.t[-1])
    start = Start(t, {}, fields=[])
    old = {each["name"]: each for each in first["surface"]}
    model = Model(first)
    own = {s.name: s for s in model.surfaces}
    for surface in second["surface"]:
        name = surface["name"]
        before = old[name]
        start.surfaces[name] = {key: one[name][key][-1] for key in NUMBERS}
        if len(own[name].bath):
            start.surfaces[name]["bath"] = bath_of(one, own[name], model)
        stood = before["drive"] if isinstance(before["drive"], dict) else {}
        start.stages[name] = stood.get("speed", 0.0) * t
        start.zeros[name] = 0.0 if _timed(surface["drive"]) == _timed(before["drive"]) else t
    moved = [np.array(f.get("velocity", (0.0, 0.0))) * t for f in first.get("field", [])]
    if len(second.get("field", [])) == len(moved):
        same_order = [s["name"] for s in second["surface"]] == [s["name"] for s in first["surface"]]
        start.fields = moved if same_order else moved[::-1]
    return start


def _timed(drive: Any) -> Any:
    """What depends on the time of a drive: all but its load, which is constant."""
    if isinstance(drive, dict):
        return {key: value for key, value in drive.items() if key != "load"}
    return drive


def bath_of(one: tribo.Result, surface: Surface, model: Model) -> np.ndarray:
    """Positions and velocities of a surface's oscillators at the end, (asperites, n, 4).

    Rates are those of the state, which has them alone; positions are those that were recorded.
    """
    own = one[surface.name]
    part = surface.part
    theta = own["theta"][-1]
    lever = model.l2[part]
    bar = vectors(own["x_cm"][-1] - lever * np.sin(theta), own["y_cm"][-1] + lever * np.cos(theta))
    positions = bar[:, None] + one.oscillators(surface.name)[-1]
    table = one.state().baths[surface.name]
    rates = surface.velocity + np.stack([table["vx"], table["vy"]], axis=-1)
    return np.concatenate([positions, rates], axis=-1)


def check_relax(findings: Findings, scene: Scene, draw: Draw) -> None:
    """An equilibrium has no accelerations, and a run from it is one from its numbers."""
    table = scene.copy()
    check = "relax"
    at_rest(table)
    for surface in table["surface"]:
        surface["velocity"] = [0.0, 0.0]
        surface.get("langevin", {}).pop("velocity", None)
        surface.pop("initial", None)
    for own in table.get("field", []):
        own.pop("velocity", None)
    findings.checks.append(check)
    try:
        state = tribo.relax(scene_from(copy.deepcopy(table)))
    except tribo.NoEquilibriumError:
        findings.add("stopped", check, "no equilibrium")
        return
    model = Model(table)
    start = Start(0.0, {})
    for s in model.surfaces:
        own = state.surfaces[s.name]
        lever = model.down[s.part] * model.l1[s.part]
        centre = s.bobs[:, 0] + own["x"], s.bobs[:, 1] + lever + own["y"]
        theta = own["swing"] + model.rest[s.part]
        still = np.zeros(s.n)
        values = (*centre, still, still, theta, still, own["phi"], still)
        start.surfaces[s.name] = dict(zip(NUMBERS, values, strict=True))
        start.surfaces[s.name]["bath"] = np.zeros((s.n, len(s.bath), 4))
    if any(len(s.bath) for s in model.surfaces):
        return
    model.start = start
    rows = model.initial().reshape(8, -1)
    rates = model.evaluate(0.0, rows, np.zeros(0))["rates"][[2, 3, 5, 7]]
    same(findings, check, rates, np.zeros(rates.shape), 1e-4, "accelerations in equilibrium")
    how: dict[str, Any] = {"method": scene.structure.method, "accuracy": ACCURACY}
    moving = scene.copy()
    for before, after in zip(table["surface"], moving["surface"], strict=True):
        kept = {key: before[key] for key in ("velocity", "langevin") if key in before}
        after |= kept
        after.pop("initial", None)
    moving["field"] = table.get("field", [])
    result = tribo.simulate(scene_from(copy.deepcopy(moving)), **how, start=state)
    assert draw is not None
    compare(findings, check, result, moving, start)
