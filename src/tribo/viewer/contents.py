"""What a page holds of a result: places to draw, contact forces, and curves.

Places and forces are drawn only, and are kept in single precision at some of the samples.  Curves
are shown as numbers, and are kept as they are at all samples.
"""

from __future__ import annotations

import base64
from typing import Any

import numpy as np

from tribo.analysis.contact_probe import ContactProbe
from tribo.ledger.quantities import EVERY_QUANTITY, Table
from tribo.model.surface import Surface
from tribo.plotting.oscillators import MOST, magnification, oscillator_dots
from tribo.results.run_result import RunResult
from tribo.validation import InputError

# Numbers that are drawn: places of each asperite, at each time that is drawn.
PLACES = ("x_bar", "y_bar", "phi", "x_bob", "y_bob")
# Most numbers of places in a page, which then has 16 MB of them.
MOST_PLACES = 3_000_000
# Most asperites whose contact forces are drawn: arrows of more hide one another.
MOST_ARROWS = 200
# Works of single forces that are shown, summed over a surface.
WORKS = ("w1", "w1_ps", "w2", "w2_ps", "wL", "wR")


def contents(result: RunResult, bath: bool = False) -> dict[str, Any]:
    """Everything that the page shows, for JSON.

    Parameters
    ----------
    result : RunResult
    bath : bool
        Whether bath oscillators are drawn.

    Returns
    -------
    dict
        Arrays are in base64: float32 of the places and forces, float64 of times and curves.

    Raises
    ------
    InputError
        The result has no places to draw, or none of the bath oscillators that are asked for.
    """
    scene = result.scene
    frames = _frames(result, bath)
    surfaces = [_drawn(result, surface, frames) for surface in scene.surfaces]
    notes, dots = list(result.notes), {}
    if bath:
        dots = oscillator_dots(result, frames)
        factor = magnification(result)
        notes.append(
            f"Dots are bath oscillators in order of frequency, displaced {factor:.3g} times as far "
            "from their bars as in the run."
        )
    for surface in surfaces:
        places = dots.get(surface["name"])
        surface["dots"] = None if places is None else _singles(places)
    return {
        "title": scene.title or "A run of tribo",
        "status": str(result.status),
        "method": result.method,
        "accuracy": _accuracy(result),
        "notes": notes,
        "times": _doubles(result.t),
        "frames": frames.tolist(),
        "surfaces": surfaces,
        "forces": _forces(result, frames),
        "groups": _groups(result),
    }


def _frames(result: RunResult, bath: bool) -> np.ndarray:
    """The samples that are drawn: all, or as many as a page can hold, the last among them."""
    samples = len(result.t)
    numbers = len(PLACES) * result.scene.count
    if bath:
        numbers += sum(2 * s.count * min(MOST, s.bath.masses.size) for s in result.scene.surfaces)
    most = max(2, MOST_PLACES // numbers)
    if samples <= most:
        return np.arange(samples)
    return np.unique(np.linspace(0, samples - 1, most).round().astype(int))


def _accuracy(result: RunResult) -> str:
    """What is known of the errors, in words."""
    if result.met is None:
        return "errors not estimated"
    return "accuracy met" if result.met else "accuracy not met"


def _drawn(result: RunResult, surface: Surface, frames: np.ndarray) -> dict[str, Any]:
    """Sizes of the asperites of a surface, and their places at each frame."""
    table = result[surface.name]
    missing = [name for name in PLACES if name not in table]
    if missing:
        raise InputError("output", f"must keep {missing[0]}: a page shows places of asperites")
    if len(table[PLACES[0]]) != len(result.t):
        raise InputError(
            "output.samples",
            f"a page needs the places of asperites at every sample; of {len(result.t)} samples of "
            f"{result.scene.count} asperites only the first and the last are kept: give fewer",
        )
    values = surface.each
    places = np.stack([table[name][frames] for name in PLACES], axis=-1)
    return {
        "name": surface.name,
        "facing": surface.facing,
        "count": surface.count,
        "bar_length": _singles(values["bar_length"]),
        "depth": _singles(surface.resting_bobs()[:, 2]),
        "places": _singles(places),  # frame after frame, asperite after asperite, as PLACES
    }


def _forces(result: RunResult, frames: np.ndarray) -> str | None:
    """Contact forces on all bobs at each frame (x, y); None where they are not drawn.

    They are not where asperites are many, and where the code of a potential was not loaded.
    """
    scene = result.scene
    if scene.count > MOST_ARROWS or not scene.interactions:
        return None
    try:
        probe = ContactProbe(scene)
        bobs = np.concatenate(
            [
                np.stack([result[s.name][name][frames] for name in ("x_bob", "y_bob")], axis=-1)
                for s in scene.surfaces
            ],
            axis=1,
        )
        bobs = bobs - probe.layout.origin
        depths = np.broadcast_to(probe.depths[None, :, None], (*bobs.shape[:2], 1))
        charges = np.tile(probe.charges, (len(frames), 1))
        _, forces = probe(np.concatenate([bobs, depths], axis=2), charges)
    except InputError:
        return None
    return _singles(forces)


def _groups(result: RunResult) -> list[dict[str, Any]]:
    """The curves of each surface, the works of single forces summed over it, and the system."""
    ledger = result.ledger
    groups = []
    for surface in result.scene.surfaces:
        block, table = ledger.blocks[surface.name], result[surface.name]
        series = {name: block[name] for name in block}
        for name in WORKS:
            if name in table:
                values = table[name]
                series[name] = values if values.ndim == 1 else values.sum(axis=1)
        groups.append({"name": surface.name, "curves": _curves(series)})
    return [*groups, {"name": "system", "curves": _curves(ledger.system)}]


def _curves(table: Table) -> list[dict[str, str]]:
    """Name, meaning and values of each series of a table."""
    return [
        {"name": name, "meaning": EVERY_QUANTITY[name].long_name, "values": _doubles(table[name])}
        for name in table
    ]


def _singles(values: np.ndarray) -> str:
    return _base64(values, "<f4")


def _doubles(values: np.ndarray) -> str:
    return _base64(values, "<f8")


def _base64(values: np.ndarray, dtype: str) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype).tobytes()).decode("ascii")
