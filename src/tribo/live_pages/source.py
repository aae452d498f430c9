"""What a live page holds: the module, its numbers, the keys that set them, and words."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np

from tribo.integrators.methods import METHODS
from tribo.kernels.records import CLOCK
from tribo.kernels.status import MEANINGS, STATUS_OF_CODE
from tribo.layout.layout import Layout, lay_out
from tribo.ledger.quantities import EVERY_QUANTITY
from tribo.live_pages import inputs, lattice_source, program
from tribo.live_pages.compile import ARRAYS, ELSEWHERE, module_of
from tribo.live_pages.controls import PANELS, Controls, controls_of, least, of_other_law
from tribo.live_pages.keys import keys_of, numbers_of
from tribo.live_pages.lattice_source import Lattice, kinds_and_meanings
from tribo.live_pages.quantities import OF_ASPERITE, OfSystem
from tribo.loops.pair_records import is_pair
from tribo.model.scene import Scene
from tribo.pair import step_rows
from tribo.pair.step import table
from tribo.validation import InputError, inside
from tribo.viewer.contents import subject

# The method of a pair's loop, and the accuracy of a page whose scene names none.
METHOD = "gauss-radau-15"
ACCURACY = 1e-8
# Samples of a run in a page, at most, and steps before it is given up.
MOST_SAMPLES = 1001
MOST_STEPS = 20_000
# Options of the program that the page's script reads and writes.
PLACES = (
    *("LEVEL", "NEAR", "ESTIMATE", "MOST_STEPS", "REACHED", "EVALUATIONS", "PASSED", "NEEDED"),
    *("AMPLITUDE", "PHASE1", "PHASE2", "ROUGH", "TEMPERATURE", "DRAWN1", "DRAWN2"),
)
# Meanings of what only live pages show.
MEANINGS_HERE = {
    "p1": "power of the contact force at the bob",
    "p1_cm": "power of the contact force at the velocity of the centre of mass",
    "p2": "power of the drive at the bar",
    "p2_cm": "power of the drive at the velocity of the centre of mass",
    "distance": "distance of the bobs",
}


def check(scene: Scene) -> Layout:
    """The layout of a scene that can go into a page.  Raises InputError for others."""
    layout = lay_out(scene)
    reason = _why_not(scene, layout)
    if reason is None:
        return layout
    raise InputError("scene", f"cannot go into a live page: {reason}; {ELSEWHERE}")


def _is_small(layout: Layout) -> bool:
    """Whether the loop of a pair runs the scene."""
    return is_pair(layout) and not _has_other_arrays(layout.scene.interactions[0].potential)


def _has_other_arrays(potential: Any) -> bool:
    """Whether a potential or a part of it has arrays that the page's script does not pass."""
    parts = [value for value in potential if hasattr(value, "_fields")]
    arrays = [value for value in potential if isinstance(value, np.ndarray)]
    others = [each for each in arrays if each.ndim != 1 or each.dtype != np.float64]
    return bool(others) or any(map(_has_other_arrays, parts))


def _why_not(scene: Scene, layout: Layout) -> str | None:
    """Why a page cannot show the scene, as the rest of a sentence; None if it can."""
    if _is_small(layout):
        return None
    return lattice_source.why_not(scene, layout)


def source_of(scene: Scene, given: object = None) -> dict[str, Any]:
    """The page of a scene as JSON.  Raises InputError."""
    source, controls = _of_one_law(scene, given, is_other=False)
    laws = controls.laws
    if laws is not None:
        others = {}
        for word, other in laws.scenes.items():
            with inside(f"controls.interaction.{word}"):
                others[word], _ = _of_one_law(other, given, is_other=True)
        source["laws"] = {"label": laws.label, "own": laws.own, "sources": others}
    return source


def _of_one_law(scene: Scene, given: object, is_other: bool) -> tuple[dict[str, Any], Controls]:
    """The page of a scene with its own potential alone, and its controls."""
    layout = check(scene)
    lattice = None if _is_small(layout) else Lattice(scene, layout)
    keys = keys_of(scene) if lattice is None else lattice.keys
    given = of_other_law(given, keys) if is_other else given
    controls = controls_of(
        scene, given, keys, has_choices=lattice is None, are_its_own=not is_other
    )
    if lattice is None:
        found = _program(scene, layout) | _values(scene, layout, controls)
        found["module"] = _bytes(module_of(layout.model.contacts[0].potential))
    else:
        found = lattice.source() | _of_controls(scene, controls) | kinds_and_meanings()
        found["meanings"] |= MEANINGS_HERE
    found["names"]["statuses"] = {k: str(v) for k, v in STATUS_OF_CODE.items()}
    found |= {
        "statuses": {code: MEANINGS[status] for code, status in STATUS_OF_CODE.items()},
        "title": controls.words.get("title") or scene.title or "A scene of tribo",
        "introduction": controls.words.get("introduction", ""),
        "questions": controls.words.get("questions", ""),
        "panel": controls.words.get("panel", PANELS[0]),
        "toml": scene.to_toml(),
    }
    return found, controls


def _program(scene: Scene, layout: Layout) -> dict[str, Any]:
    """How the program is called."""
    accuracy = scene.numerics.accuracy
    accuracy = accuracy if isinstance(accuracy, float) else ACCURACY
    memory = np.zeros((step_rows.ROWS, 8))
    coefficients: Any = METHODS[METHOD].coefficients
    memory[: step_rows.LIMITS] = table(coefficients)
    names = {"asperite": OF_ASPERITE, "system": OfSystem._fields}
    every = [*OF_ASPERITE, *OfSystem._fields]
    known = {name: EVERY_QUANTITY[name] for name in every if name in EVERY_QUANTITY}
    return {
        "arrays": [
            {"name": name, "shape": shape, "item": CLOCK.itemsize if name == "clocks" else 8}
            for name, shape in ARRAYS.items()
        ],
        "memory": _floats(memory),
        "samples": int(min(len(scene.times), MOST_SAMPLES)),
        "level": program.level_of(accuracy),
        "near": program.NEAR_FINE,
        "most": MOST_STEPS,
        "rough": bool(np.isfinite(scene.smoothness)),
        "places": {name: getattr(program, name) for name in PLACES},
        "names": names,
        "meanings": {name: each.long_name for name, each in known.items()} | MEANINGS_HERE,
        "kinds": {name: each.kind for name, each in known.items()},
        "kind": "pair",
        "method": METHOD,
    }


def _values(scene: Scene, layout: Layout, controls: Controls) -> dict[str, Any]:
    """The numbers of a pair, and the keys and controls that set them."""
    return {
        "inputs": inputs.INPUTS,
        "numbers": _floats(numbers_of(layout)),
        "potential": _arguments(layout.model.contacts[0].potential, [inputs.INPUTS]),
        "surfaces": [
            {"name": s.name, "facing": s.facing, "count": 1, "bonds": []} for s in scene.surfaces
        ],
        "duration": inputs.DURATION,
        "observer": inputs.OBSERVER_X,
        **_of_controls(scene, controls),
    }


def _of_controls(scene: Scene, controls: Controls) -> dict[str, Any]:
    """The keys and controls of a page."""
    keys = []
    for key in sorted(controls.keys, key=lambda each: -len(each.parts)):
        lowest, closed = least(scene, key)
        low = lowest if np.isfinite(lowest) else None
        keys.append(key._asdict() | {"least": low, "open": not closed})
    return {
        "keys": keys,
        "choices": [choice._asdict() for choice in controls.choices],
        "controls": [vars(control) for control in controls.shown],
        "subject": subject(scene),
    }


def _arguments(potential: Any, place: list[int]) -> list[Any]:
    """The potential's fields as arguments: places of its numbers, and arrays."""
    found: list[Any] = []
    for value in potential:
        if isinstance(value, tuple):
            found += _arguments(value, place)
        elif isinstance(value, np.ndarray):
            found.append({"values": _floats(value)})
        else:
            found.append(place[0])
            place[0] += 1
    return found


def _bytes(content: bytes) -> str:
    return base64.b64encode(content).decode("ascii")


def _floats(values: np.ndarray) -> str:
    return _bytes(np.ascontiguousarray(values, "<f8").tobytes())
