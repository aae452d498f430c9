"""What a live page holds of a scene with rows or grids, in place of the numbers of a pair."""

from __future__ import annotations

import base64
import zlib
from typing import Any

import numpy as np

from tribo.integrators import methods
from tribo.kernels.status import ENCOUNTER_JUMPED, NOT_FINITE
from tribo.layout.layout import Layout
from tribo.ledger.guards import MOST_PASSED, facing
from tribo.ledger.quantities import EVERY_QUANTITY
from tribo.live_pages import lattice_asperite as asperites
from tribo.live_pages import lattice_quantities as quantities
from tribo.live_pages.arguments import flat_arguments
from tribo.live_pages.compile import ELSEWHERE
from tribo.live_pages.image import WORD, Image
from tribo.live_pages.keys import Key, Part
from tribo.live_pages.lattice import ACCURACY, METHOD, Program, program_of
from tribo.live_pages.lattice_compile import module_of
from tribo.live_pages.lattice_keys import Words, words_of_keys
from tribo.model.effects import Effect, reason_for
from tribo.model.scene import Scene
from tribo.model.surface import Surface
from tribo.plotting.pose import has_spring, joined_bars
from tribo.simulation import prepare
from tribo.validation import InputError

# Effects of scenes that can go into a page.
KNOWN = {
    *(Effect.CONTACT, Effect.SWING, Effect.SLIDING, Effect.CLAMPED_ENDS, Effect.CUTOFF),
    *(Effect.DRIVEN_BARS, Effect.TURNING_BARS, Effect.PULL, Effect.PUSH, Effect.LOAD),
    *(Effect.SPRINGS, Effect.FIELD, Effect.CONTACT_WITHIN, Effect.PERIODIC),
    *(Effect.BATH, Effect.TORSIONAL_BATH, Effect.SCHEDULE, Effect.RIGID),
    *(Effect.MOVED_PENDULUMS, Effect.BLOCK, Effect.BLOCK_OF_PENDULUMS, Effect.DAMPED_BLOCK),
    *(Effect.TILTING_BLOCK, Effect.OWN_DRIVE, Effect.OWN_ENDS),
}
MOST_ASPERITES = 200
MOST_SAMPLES = 1001
# Methods with equal steps, the cheapest first; the last refuses no scene.
METHODS = ("blanes-moan-6", METHOD, "rk4")


def why_not(scene: Scene, layout: Layout) -> str | None:
    """Why a scene with rows or grids cannot go into a page, as the rest of a sentence."""
    if scene.count > MOST_ASPERITES:
        return f"it has {scene.count} asperites, and live pages have at most {MOST_ASPERITES}"
    for effect in sorted(scene.effects - KNOWN):
        return f"it has {effect} ({reason_for(scene, effect)})"
    if scene.output.ledger != "asperites":
        return f'output.ledger is "{scene.output.ledger}", not "asperites"'
    if len(scene.times) > MOST_SAMPLES:
        return f"it has {len(scene.times)} samples, and rows have at most {MOST_SAMPLES}"
    return None


class Lattice:
    """A scene with rows or grids for a page: its program, its keys, and its step.

    Raises InputError if it cannot go in.
    """

    def __init__(self, scene: Scene, layout: Layout) -> None:
        """Choose the cheapest method that takes the scene, plan its step, and find the keys."""
        self.scene = scene
        self.layout = layout
        reason = why_not(scene, layout)
        if reason is not None:
            raise InputError("scene", f"cannot go into a live page: {reason}; {ELSEWHERE}")
        accuracy = scene.numerics.accuracy
        accuracy = accuracy if isinstance(accuracy, float) else ACCURACY
        named = [each for each in METHODS if not methods.refusal(methods.named(each), scene)]
        self.method = named[0]
        plan = prepare(scene, method=self.method, accuracy=accuracy).plan
        self.step = plan.setting.of_equal_steps()
        self.program = program_of(layout, self.step, self.method, accuracy)
        self.words = words_of_keys(layout, self.program)

    @property
    def keys(self) -> list[Key]:
        """The keys, each of which sets a number of its own."""
        return [
            Key(each.key, each.value, (Part(n, 1.0, 0.0),)) for n, each in enumerate(self.words)
        ]

    def source(self) -> dict[str, Any]:
        """The parts of a page that pairs have in other ways, for JSON."""
        program = self.program
        image = program.image()
        observer = Words(
            "", 0.0, _places(image, program.scene.numbers, asperites.OBSERVER_X), np.ones(1)
        )
        every = [*self.words, observer]
        content = module_of(self.scene, program, self.layout.plugins)
        numbers = np.array([each.value for each in every])
        keys = [each.key for each in self.words]
        # With times of samples that are given, it is no key.
        duration = keys.index("duration") if "duration" in keys else -1
        return {
            "kind": "lattice",
            "module": _compressed(content),
            "method": self.method,
            "step": self.step,
            "tooLong": [NOT_FINITE, ENCOUNTER_JUMPED],  # codes of runs whose steps may be too long
            "samples": int(self.layout.times.size),
            "image": _of_image(image),
            "calls": _calls(program, image),
            "results": {
                name: {each: [image.place_of(array), array.size] for each, array in own.items()}
                for name, own in program.results.items()
            },
            "numbers": base64.b64encode(numbers.astype("<f8").tobytes()).decode("ascii"),
            "words": [_grouped(each) for each in every],
            "names": {
                "asperite": quantities.OF_SURFACE,
                "system": quantities.OfWhole._fields,
                "drawn": asperites.Drawn._fields,
            },
            "surfaces": [_drawn(surface) for surface in self.scene.surfaces],
            "facing": facing(self.layout),  # pairs of surfaces, of which one may pass the other
            "mostPassed": MOST_PASSED,
            "duration": duration,
            "observer": len(self.words),
        }


def _drawn(surface: Surface) -> dict[str, Any]:
    """What is drawn of a surface, without its places."""
    values = surface.each
    return {
        "name": surface.name,
        "facing": surface.facing,
        "count": surface.count,
        "barLength": values["bar_length"].tolist(),
        "depth": surface.resting_bobs()[:, 2].tolist(),
        "centre": (values["m1"] / (values["m1"] + values["m2"])).tolist(),
        "hasBath": bool(surface.bath),
        "twisted": bool(np.any(has_spring(surface))),
        "bonds": np.asarray(joined_bars(surface)).ravel().tolist(),
    }


def _places(image: Image, array: np.ndarray, first: int) -> np.ndarray:
    return np.array([image.place_of(array) // WORD + first])


def _of_image(image: Image) -> dict[str, Any]:
    """An image for JSON."""
    return {
        "words": _compressed(image.words.astype("<i8").tobytes()),
        "addresses": image.addresses.tolist(),
        "units": image.units.tolist(),
        "size": image.size,
    }


def _compressed(content: bytes) -> str:
    return base64.b64encode(zlib.compress(content, 9)).decode("ascii")


def _calls(program: Program, image: Image) -> dict[str, dict[str, Any]]:
    """The arguments of each call, as pairs of kind and value."""
    return {
        name: {call.name: flat_arguments(call.arguments, image) for call in calls}
        for name, calls in program.calls.items()
    }


def _grouped(words: Words) -> list[Any]:
    """Places of words by the factor with which they grow: [factor, places] each."""
    found = []
    for factor in dict.fromkeys(words.factors.tolist()):
        found.append([factor, words.places[words.factors == factor].tolist()])
    return found


def kinds_and_meanings() -> dict[str, Any]:
    """Kinds and meanings of the quantities of surfaces and of the whole that a ledger has."""
    names = (*quantities.OF_SURFACE, *quantities.OfWhole._fields)
    known = {name: EVERY_QUANTITY[name] for name in names if name in EVERY_QUANTITY}
    return {
        "meanings": {name: each.long_name for name, each in known.items()},
        "kinds": {name: each.kind for name, each in known.items()},
    }
