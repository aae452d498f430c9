"""What a page holds of a run: places and forces to draw, and curves with their values.

A curve is rounded to the digits that the page shows, which numbers of 32 bits keep.
"""

import base64
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

import numpy as np

from tribo.analysis.contact_probe import ContactProbe
from tribo.ledger.quantities import EVERY_QUANTITY
from tribo.ledger.quantity import Table
from tribo.model.scene import Scene
from tribo.model.surface import Surface
from tribo.plotting.oscillators import MOST, magnification, oscillator_dots
from tribo.plotting.pose import has_spring, joined_bars
from tribo.plotting.works import total, works_of
from tribo.results.run_result import RunResult, of_all
from tribo.validation import InputError

# Numbers that are drawn: places of each asperite, at each time that is drawn.
PLACES = ("x_bar", "y_bar", "phi", "x_bob", "y_bob")
# Most numbers of places in a page, which then has 16 MB of them.
MOST_PLACES = 3_000_000
# Most asperites whose forces are drawn: arrows of more hide one another.
MOST_ARROWS = 200
# Significant digits of a value in the page.
DIGITS = 6
# Magnitudes that numbers of 32 bits have with that many digits.
SINGLE = (1e-36, 1e38)
# What is known of the errors, by whether the accuracy was met.
ACCURACY = {None: "errors not estimated", True: "accuracy met", False: "accuracy not met"}
# Works that differ by less than this part of their size are called equal.
EQUAL = 1e-6
# Part of the bobs' distance at the start from which on an encounter is over: 0.19 in case B of the
# paper.
APART = 0.15
# What a page of a periodic scene does not show.
PERIODIC = (
    "The scene is periodic. Places are not wrapped and images are not drawn: asperites that have "
    "left the drawn part of the other surface can be in contact with its images."
)
# The curves that a page opens with, where they are recorded.
DRAWN = ("w1", "w1_ps", "w2", "w2_ps", "W", "W_ps", "heat", "heat_bath")


def contents(result: RunResult, bath: bool = False) -> dict[str, Any]:
    """Everything that the page shows of a run, for JSON; arrays are as of :func:`packed`.

    With `bath`, bath oscillators are drawn.  Raises InputError if the result has no places to draw,
    or none of the bath oscillators.
    """
    scene = result.scene
    frames = _frames(result, bath)
    surfaces = [_drawn(result, surface, frames) for surface in scene.surfaces]
    unfinished = _unfinished(result)
    works = {surface.name: works_of(result, surface.name, None) for surface in scene.surfaces}
    notes = [*result.notes, *([PERIODIC] if scene.periodic else [])]
    dots = {}
    if bath:
        dots = oscillator_dots(result, frames)
        notes.append(
            "Dots are bath oscillators in order of frequency, displaced "
            f"{magnification(result):.3g} times as far from their bars as in the run."
        )
    for surface in surfaces:
        surface["dots"] = packed(dots[surface["name"]]) if surface["name"] in dots else None
    return {
        "title": scene.title or "A run of tribo",
        "status": "ended early" if unfinished else str(result.status),
        "method": result.method,
        "accuracy": ACCURACY[result.met],
        "sentence": unfinished or _sentence(scene, works),
        "notes": notes,
        "times": packed(result.t, exact=True),
        "frames": packed(frames),
        "surfaces": surfaces,
        "forces": _forces(result, frames),
        "groups": _groups(result, works),
    }


def subject(scene: Scene) -> int:
    """The index of the surface that sentences are about: one that slides freely, or that moves."""
    drives = [surface.drive for surface in scene.surfaces]
    held = [
        drive.cancels_x or drive.holds_bars or drive.gives_motion or drive.drives_along_x
        for drive in drives
    ]
    free = [k for k, is_held in enumerate(held) if not is_held]
    moving = [k for k, surface in enumerate(scene.surfaces) if surface.velocity[0] != 0.0]
    return (free + moving + [0])[0]


def _sentence(scene: Scene, of_surfaces: Mapping[str, Table]) -> str:
    """How work and pseudowork of friction on its `subject` differ; empty without these.

    Their difference is the integral of the contact forces along the motion of the bobs relative to
    the centres of mass.  Where a bob ends says nothing about it: it also swings without a force.
    """
    moving = scene.surfaces[subject(scene)]
    works = of_surfaces[moving.name]
    if "w1" not in works or "w1_ps" not in works:
        return ""
    work, pseudowork = (float(works[name][-1]) for name in ("w1", "w1_ps"))
    size = max(abs(work), abs(pseudowork), *(float(np.max(np.abs(v))) for v in works.values()))
    if moving.count == 1:
        motion = "the motion of the bob relative to the centre of mass"
        them = "that motion"
    else:
        motion = "the motions of the bobs relative to the centres of mass of their asperites"
        them = "those motions"
    if abs(work - pseudowork) <= EQUAL * size:
        return (
            f'The work of friction on "{moving.name}" equals its pseudowork: friction does no net '
            f"work on {motion}."
        )
    more = work > pseudowork
    drives, holds = f"drives {them}", f"holds {them} back"
    sign = f"positive: friction {drives} more than it {holds}"
    if not more:
        sign = f"negative: friction {holds} more than it {drives}"
    return (
        f'Friction does {"more" if more else "less"} work on "{moving.name}" ({work:.3g}) than '
        f"pseudowork ({pseudowork:.3g}). The difference, {work - pseudowork:.3g}, is its work on "
        f"{motion}. It is {sign}."
    )


def _unfinished(result: RunResult) -> str:
    """What to say of one asperite on one whose bobs approach at the end; else empty.

    The encounter is over where the bobs are APART of their distance along x at the start away from
    each other, or more, and their centres of mass part.
    """
    scene = result.scene
    if scene.count != 2 or len(scene.surfaces) != 2 or result.status != "completed":
        return ""
    tables = [result[surface.name] for surface in scene.surfaces]
    if any(name not in table for table in tables for name in ("x_bob", "vx_cm")):
        return ""
    one, other = tables
    gap = (one["x_bob"] - other["x_bob"])[:, 0]
    speed = (one["vx_cm"] - other["vx_cm"])[:, 0]
    if gap[0] * speed[0] >= 0.0 or (
        abs(gap[-1]) >= APART * abs(gap[0]) and gap[-1] * speed[-1] > 0
    ):
        return ""
    needed = 2.0 * abs(gap[0] / speed[0])
    return (
        f"The run ends at t = {result.t[-1]:.6g}, before the bobs have passed each other, so its "
        "works are not those of the encounter. At the velocity of the start they have passed after "
        f"a duration of {needed:.3g}."
    )


def _frames(result: RunResult, bath: bool) -> np.ndarray:
    """The samples that are drawn: all, or as many as a page can hold, the last among them."""
    samples = len(result.t)
    numbers = len(PLACES) * result.scene.count
    if bath:
        numbers += sum(2 * s.count * min(MOST, s.bath.masses.size) for s in result.scene.surfaces)
    most = max(2, MOST_PLACES // numbers)
    return np.unique(np.linspace(0, samples - 1, min(samples, most)).round().astype(int))


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
    return {
        "name": surface.name,
        "facing": surface.facing,
        "count": surface.count,
        "barLength": packed(values["bar_length"]),
        "depth": packed(surface.resting_bobs()[:, 2]),
        # From the bar to the bob, in parts of the rod.
        "centre": packed(values["m1"] / (values["m1"] + values["m2"])),
        "twisted": bool(np.any(has_spring(surface))),
        "bonds": packed(joined_bars(surface)),
        # Of each place frame after frame, asperite after asperite.
        "places": {name: packed(table[name][frames]) for name in PLACES},
    }


def _forces(result: RunResult, frames: np.ndarray) -> dict[str, list[dict[str, Any]]]:
    """x and y of contact forces and drives at each frame, of all asperites, where they are known.

    They are known where the run recorded them.  Else contact is computed from the places of the
    bobs, unless the code of its potential was not loaded, and a drive that cancels contact is
    opposite to it.
    """
    scene = result.scene
    if scene.count > MOST_ARROWS:
        return {}
    names = [surface.name for surface in scene.surfaces]
    found = {}
    for force in ("f1", "f2"):
        if all(f"{force}_x" in result[name] for name in names):
            found[force] = [of_all(result, f"{force}_{axis}")[frames] for axis in "xy"]
    if not found and scene.interactions:
        bobs = np.stack([of_all(result, f"{axis}_bob")[frames] for axis in "xy"], axis=-1)
        with suppress(InputError):
            probe = ContactProbe(scene)
            _, forces = probe(probe.positions(bobs))
            found["f1"] = [forces[:, :, axis] for axis in (0, 1)]
        if found and all(s.drive.cancels_contact for s in scene.surfaces):
            found["f2"] = [-values for values in found["f1"]]
    return {name: [packed(x), packed(y)] for name, (x, y) in found.items()}


def _groups(result: RunResult, works: Mapping[str, Table]) -> list[dict[str, Any]]:
    """The works on each surface and its other curves, and those of the system."""
    ledger = result.ledger
    tables: dict[str, Table] = {}
    for name, own in works.items():
        table = result[name]
        block = ledger.blocks[name]
        heat = {"heat": total(table["heat"])} if "heat" in table else {}
        others = {each: block[each] for each in block if each not in own}
        tables[name] = {**own, **others, **heat}
    tables["system"] = ledger.system
    return [{"name": name, "curves": _curves(table)} for name, table in tables.items()]


def _curves(table: Table) -> list[dict[str, Any]]:
    """Name, meaning and values of each series of a table, those that the page opens with first."""
    names = [*(name for name in DRAWN if name in table), *(n for n in table if n not in DRAWN)]
    first = [name for name in names if name in DRAWN] or names[:4]
    rounded = _rounded(np.array([table[name] for name in names]))
    return [
        {
            "name": name,
            "meaning": EVERY_QUANTITY[name].long_name,
            "kind": EVERY_QUANTITY[name].kind,
            "drawn": name in first,
            "values": packed(values),
        }
        for name, values in zip(names, rounded, strict=True)
    ]


def _rounded(values: np.ndarray) -> np.ndarray:
    """The values with as many digits as the page shows."""
    with np.errstate(all="ignore"):
        size = np.where(values == 0.0, 1.0, np.abs(values))
        unit = 10.0 ** (np.floor(np.log10(size)) - DIGITS + 1)
        rounded = np.round(values / unit) * unit
    return np.where(np.isfinite(rounded), rounded, values)


def packed(values: np.ndarray, exact: bool = False) -> dict[str, Any]:
    """An array for JSON: "f4" or "f8" with bytes in base64, or "same" with the number, and "size".

    The second is for arrays of equal numbers.  With `exact`, all digits of numbers of 64 bits are
    kept.
    """
    values = np.asarray(values, float).ravel()
    if values.size and np.all(values == values[0]):
        return {"same": float(values[0]), "size": values.size}
    sizes = np.abs(values[np.isfinite(values) & (values != 0.0)])
    single = not exact and (not sizes.size or (SINGLE[0] < sizes.min() and sizes.max() < SINGLE[1]))
    kind = "f4" if single else "f8"
    return {kind: base64.b64encode(values.astype(f"<{kind}").tobytes()).decode("ascii")}
