"""Sweeps and ensembles: each point and member against a scene that is built for it alone."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
from scipy import stats

import tribo
from support.mixed.comparison import ACCURACY, Findings, compare, is_refused, same
from support.mixed.draw import Draw, Scene, Table
from tribo.model.scene_file import scene_from

# Difference of a value at the end of a point from that of its own run, beside their estimates.
ALLOWED = 1e-7
SAMPLES = 3


def put(table: Table, key: str, value: Any) -> None:
    """Set a value of a table by its key, as a file would have it."""
    first, _, rest = key.partition(".")
    if first in ("duration", "seed"):
        table[first] = value
        return
    if first in ("numerics", "output", "periodic"):
        table.setdefault(first, {})[rest] = value
        return
    if first in ("interaction", "field"):
        part = table[first][0]
        *inner, last = rest.split(".")
        for each in inner:
            part = part["of"] if each == "of" else part["of"][("first", "second").index(each)]
        part[last] = value
        return
    for surface in table["surface"]:
        if first in ("*", surface["name"]):
            _put_surface(surface, rest, value)


def _put_surface(surface: Table, key: str, value: Any) -> None:
    """Set a value of a surface's table by its key; one of theta and swing replaces the other."""
    part, _, name = key.rpartition(".")
    if part:
        surface[part][name] = value
    elif key == "velocity":
        pair = [value, surface.get("velocity", [0.0, 0.0])[1]] if np.ndim(value) == 0 else value
        surface["velocity"] = np.asarray(pair, float).tolist()
    elif key in ("bob", "spacing", "depth"):
        surface[key] = value
    else:
        initial = surface.setdefault("initial", {})
        if key in ("theta", "swing"):
            initial.pop("swing" if key == "theta" else "theta", None)
        initial[key] = value if np.ndim(value) == 0 else np.asarray(value, float).tolist()


def keys_of(scene: Scene, draw: Draw) -> dict[str, tuple[float, float]]:
    """Keys of a scene and the ranges of their values."""
    upper = scene.table["surface"][0]
    drive = upper["drive"] if isinstance(upper["drive"], dict) else {}
    found = {"upper.velocity": (0.3, 0.8), "upper.asperite.length": (1.0, 2.0)}
    found |= {"upper.asperite.m1": (0.6, 2.0), "upper.asperite.m2": (1.0, 3.0)}
    if "rigid" not in scene.structure.effects:
        found |= {"upper.asperite.kappa": (0.8, 3.0), "*.asperite.kappa": (0.8, 3.0)}
        found |= {"upper.theta": (-0.3, 0.3), "upper.swing": (-0.3, 0.3)}
        found |= {"upper.omega": (-0.3, 0.3), "*.swing": (-0.3, 0.3), "upper.phi": (-0.2, 0.2)}
    if "load" in drive:
        found["upper.drive.load"] = (0.01, 0.1)
    if "speed" in drive:
        found |= {"upper.drive.speed": (0.2, 0.8), "upper.drive.stiffness": (0.5, 3.0)}
        found |= {"upper.x": (-0.2, 0.2), "upper.vx": (-0.2, 0.2)}
    if "gamma" in upper.get("langevin", {}):
        found["upper.langevin.gamma"] = (0.2, 1.5)
    if "springs" in upper:
        found["upper.springs.stiffness"] = (0.5, 3.0)
    if len(scene.table.get("field", [])) == 1:
        name = "along" if "trap" in scene.structure.effects else "amplitude"
        found[f"field.{name}"] = (0.05, 0.3)
    if len(scene.table["interaction"]) == 1:
        own = scene.table["interaction"][0]
        for name in ("strength", "epsilon", "sigma", "cutoff", "height", "c"):
            if name in own:
                found[f"interaction.{name}"] = (0.8 * own[name], 1.25 * own[name])
        if own["potential"] == "sum" and draw.chance(0.3):
            for name in ("strength", "depth"):
                if name in own["of"][1]:
                    found[f"interaction.second.{name}"] = (0.05, 0.3)
    found["duration"] = (0.5 * scene.table["duration"], scene.table["duration"])
    return found


def kept(scene: Scene) -> list[str]:
    """Quantities to keep of each point."""
    names = ["upper.W", "upper.x_cm", "upper.theta", "contact_energy"]
    return names if len(scene.table["surface"]) == 2 else names[:-1]


def value_at(data: Any, name: str, index: dict[str, int]) -> np.ndarray:
    """The values of a point or member."""
    name = f"{name}_end" if f"{name}_end" in data else name
    variable = data[name]
    return variable.isel({k: v for k, v in index.items() if k in variable.dims}).values


def own_run(scene: Scene, values: dict[str, Any]) -> tuple[tribo.Result, Table]:
    """A run of the scene with its own values, built as from a file."""
    table = scene.copy()
    for key, value in values.items():
        put(table, key, value)
    table["output"] = {"samples": SAMPLES} | {"series": table["output"].get("series", [])}
    result = tribo.simulate(
        scene_from(copy.deepcopy(table)), method=scene.structure.method, accuracy=ACCURACY
    )
    return result, table


def ends(result: tribo.Result, name: str) -> np.ndarray:
    """The value at the end of a run, by its full name."""
    surface, _, quantity = name.rpartition(".")
    series = result[surface][quantity] if surface else result.system[quantity]
    return np.asarray(series)[-1]


def agree(
    findings: Findings, check: str, data: Any, index: dict[str, int], own: tribo.Result, names: list
) -> None:
    """Each kept value of a point is that of its own run."""
    status = str(value_at(data, "status", index))
    if status != own.status and status != "AccuracyMissed":
        findings.add("silent", check, f"status {status} for {own.status} at {index}")
        return
    if own.status != "completed":
        return
    for name in names:
        bound = own.error_estimate.get(name.rpartition(".")[2]) or 0.0
        scale = max(1.0, float(np.max(np.abs(ends(own, name)))))
        allowed = 3.0 * bound + ALLOWED + 2.0 * ACCURACY * scale
        found = np.asarray(value_at(data, name, index), float)
        if status == "AccuracyMissed" and np.all(np.isnan(found)):
            named = "have no values (AccuracyMissed" in str(data.attrs["notes"])
            findings.add("stopped" if named else "silent", check, f"{status} at {index}")
            return
        same(findings, check, found, ends(own, name), allowed, f"{name} at {index}")


def check_sweep(findings: Findings, scene: Scene, draw: Draw) -> None:
    """Two keys, or two joined ones; all points, and one of them against the second solution."""
    keys = keys_of(scene, draw)
    names = kept(scene)
    chosen = [str(key) for key in draw.rng.permutation(list(keys))[:2]]
    if any(_clash(one, other) for one in chosen for other in chosen if one != other):
        chosen = chosen[:1]
    values = {key: draw.each(*keys[key], 2) for key in chosen}
    joined = len(chosen) == 2 and draw.chance(0.4)
    check = f"sweep of {' and '.join(chosen)}" + (", joined" if joined else "")
    asked: dict[Any, Any] = dict(values)
    if joined:
        asked = {tuple(chosen): list(zip(*values.values(), strict=True))}
    table = scene.copy()
    table["output"] = {"samples": SAMPLES} | {"series": table["output"].get("series", [])}
    how: dict[str, Any] = {"method": scene.structure.method, "accuracy": ACCURACY}
    data = tribo.sweep(scene_from(table), asked, keep=names, progress=False, **how)
    dims = [",".join(chosen)] if joined else chosen
    findings.checks.append(check)
    for index in np.ndindex(*(2 for _ in dims)):
        place = dict(zip(dims, index, strict=True))
        own = {k: values[k][index[0] if joined else index[j]] for j, k in enumerate(chosen)}
        result, built = own_run(scene, own)
        agree(findings, check, data, place, result, names)
        if not any(index):
            compare(findings, f"{check}, a point", result, built)


def _clash(one: str, other: str) -> bool:
    """Whether two keys set the same number, or one of them the start that another implies."""
    ends = {each.rpartition(".")[2] for each in (one, other)}
    starts = {"theta", "swing", "phi", "swing_state", "omega"}
    return len(ends) == 1 or ends <= starts


def check_ensemble(findings: Findings, scene: Scene, draw: Draw) -> None:
    """Arrays of starts and parameters; all members, and one against the second solution."""
    keys = keys_of(scene, draw)
    names = kept(scene)
    members = 3
    others = ("duration", "*.asperite")
    if "turning" not in scene.structure.effects:
        others += ("upper.phi",)  # of clamped bars, which each need a scene
    fit = [key for key in keys if not key.startswith(others)]
    chosen = [str(key) for key in draw.rng.permutation(fit)[: draw.pick(1, 2)]]
    if len(chosen) == 2 and _clash(*chosen):
        chosen = chosen[:1]
    n = scene.table["surface"][0]["shape"][0]
    vary: dict[str, np.ndarray] = {}
    for key in chosen:
        per_asperite = n > 1 and key.split(".")[-1] in ("theta", "swing", "omega", "x")
        several = per_asperite and not key.startswith("*") and draw.chance(0.5)
        size = (members, n) if several else (members,)
        vary[key] = np.round(draw.rng.uniform(*keys[key], size), 4)
    check = f"ensemble over {' and '.join(chosen)}"
    table = scene.copy()
    table["output"] = {"samples": SAMPLES} | {"series": table["output"].get("series", [])}
    how: dict[str, Any] = {"method": scene.structure.method, "accuracy": ACCURACY}
    data = tribo.ensemble(scene_from(table), members, vary, keep=names, progress=False, **how)
    findings.checks.append(check)
    for member in range(members):
        result, built = own_run(scene, {key: array[member] for key, array in vary.items()})
        agree(findings, check, data, {"member": member}, result, names)
        if not member:
            compare(findings, f"{check}, a member", result, built)


def check_drawn_starts(findings: Findings, scene: Scene, draw: Draw) -> None:
    """Swing states beside swept keys: each start has the energies of its own point."""
    if "rigid" in scene.structure.effects:
        return
    kind = draw.pick("canonical", "canonical", "fixed", "clash")
    key = draw.pick(
        "*.asperite.kappa", "*.asperite.m1", "*.asperite.length", "interaction.strength"
    )
    if kind == "clash":
        key = draw.pick("upper.theta", "upper.swing", "upper.omega")
    if key.startswith("interaction") and scene.name != "pair":
        key = "*.asperite.kappa"
    check = f"swing states beside a sweep of {key}"
    members = 200
    temperature = draw.between(0.02, 0.2)
    state = tribo.Canonical(temperature)
    if kind == "fixed":
        state = tribo.Microcanonical(temperature)
    values = {"kappa": [1.0, 4.0, 9.0], "m1": [0.5, 2.0], "length": [1.0, 2.5]}
    table = scene.copy()
    for surface in table["surface"]:
        surface.pop("initial", None)
    # Some starts are deep in a core, and the motion after them is of no interest.
    table |= {"output": {"samples": 2}, "duration": 4e-4}
    where = "*" if key.startswith("*") else "upper"
    swept = {key: values.get(key.rpartition(".")[2], [0.1, 0.3])}
    how: dict[str, Any] = {"method": "verlet", "step": 1e-4, "progress": False}
    findings.checks.append(check)
    how |= {"members": members, "vary": {f"{where}.swing_state": state}}
    how |= {"keep": ["upper.swing_energy"], "at": "samples"}
    if kind == "clash":
        if not is_refused(lambda: tribo.sweep(scene_from(table), swept, **how)):
            findings.add("silent", check, "two starts of the same swings were both accepted")
        return
    data = tribo.sweep(scene_from(table), swept, **how)
    if set(data["status"].values.ravel()) != {"completed"}:
        findings.add("stopped", check, "some members")
        return
    n = table["surface"][0]["shape"][0]
    total = sum(each["shape"][0] for each in table["surface"]) if where == "*" else n
    found = value_at(data, "upper.swing_energy", {"time": 0})
    own = found.reshape(len(swept[key]), members, n)
    mean = own.mean(axis=(1, 2))
    expected = temperature if kind != "fixed" else temperature / total
    spread = stats.t.ppf(1.0 - 1e-7, members - 1) * own.mean(axis=2).std(axis=1, ddof=1)
    allowed = float(np.max(spread)) / members**0.5 + 1e-9
    same(findings, check, mean, np.full(mean.shape, expected), allowed, "mean energy of the starts")


def check_settings(findings: Findings, scene: Scene, draw: Draw) -> None:
    """A swept setting acts, also beside an argument of the same meaning."""
    beside = draw.chance(0.7)
    table = scene.copy()
    table["output"] = {"samples": 2}
    how: dict[str, Any] = {"method": "verlet", "progress": False, "keep": kept(scene)}
    swept = {"numerics.step": [0.05, 0.0125]}
    check = "sweep of numerics.step" + (" beside step=" if beside else "")
    findings.checks.append(check)
    if beside:
        # Equal steps at all points, if the argument replaced the key.
        if not is_refused(lambda: tribo.sweep(scene_from(table), swept, **how, step=0.05)):
            findings.add("silent", check, "two steps were both accepted")
        return
    data = tribo.sweep(scene_from(table), swept, **how)
    if set(data["status"].values) != {"completed"}:
        findings.add("stopped", check, "some points")
        return
    steps = data["steps"].values
    if not steps[1] > 2 * steps[0]:
        findings.add("silent", check, f"points took {steps.tolist()} steps")
