"""What a run will do and cost: found from its scene, before it is run."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from numba import config

from tribo.accuracy.choose_method import Choice, choose
from tribo.accuracy.run_time import pairs_of_bobs
from tribo.compiler.plugin_methods import type_of
from tribo.explanation.explanation import Contact, Explanation, Predicted
from tribo.explanation.fastest_motion import fastest_motion
from tribo.explanation.measured import (
    bytes_of_run,
    compilations,
    inactive_at_start,
    seconds_of_evaluation,
)
from tribo.explanation.prediction import Prediction, Search, predict
from tribo.integrators.methods import Method
from tribo.kernels.potential_in_lanes import is_vectorized
from tribo.layout.layout import Layout, lay_out
from tribo.layout.threads import threads_of
from tribo.ledger.ledger import check_keep
from tribo.loops.guards import MOST_PREDICTED, most_evaluations, reach_of
from tribo.model.effects import Effect, keys_of, lack_of
from tribo.model.scene import Scene, checked_scene
from tribo.validation import inside

# Time of a run from which on the explanation says what makes it slow [s].
LONG = 45 * 60.0
# The phase of the fastest motion in a step [rad] that is still well resolved.
RESOLVED = 0.1
# Most keys that a reason names.
MOST_NAMED = 3


def explain(scene: Scene) -> Explanation:
    """Predict what a run of a scene does and costs, with the scene's own numerics.

    This compiles the time loop. With an accuracy, it also makes the search for settings with
    which every run begins, for at most two seconds by the model of costs.

    Parameters
    ----------
    scene : Scene
        The scene to explain.

    Returns
    -------
    Explanation

    Raises
    ------
    InputError
        As for :func:`tribo.prepare`.
    """
    scene = checked_scene(scene)
    layout, given = lay_out(scene), scene.numerics
    check_keep(layout)
    with inside("numerics"):
        choice = choose(layout, given.accuracy, given.method, given.step)
    before = compilations(layout, choice.method)
    threads = threads_of(layout.model, choice.method, None)
    search = Search(layout, choice.method, threads.number)
    compiled = compilations(layout, choice.method) == before
    began = time.perf_counter()
    found = predict(choice, search)
    beside = 0.0 if choice.step else time.perf_counter() - began - search.seconds
    predicted = _predicted(layout, choice, search, found, beside)
    setting = None if found.plan is None else found.plan.setting
    present = [effect for effect in Effect if effect in scene.effects]
    return Explanation(
        scene=scene,
        effects={str(effect): why_present(scene, effect) for effect in present},
        absent={str(effect): lack_of(effect) for effect in Effect if effect not in present},
        coordinates=coordinates(scene),
        contact=contact(layout, choice.method),
        method=choice.method.name,
        why=choice.why,
        threads=threads,
        accuracy=choice.accuracy,
        step=setting if isinstance(setting, float) else None,
        compiled=compiled,
        predicted=predicted,
        evaluations_used=search.evaluations,
        slow=_slow(layout, choice) if predicted.seconds >= LONG else "",
    )


def why_present(scene: Scene, effect: Effect) -> str:
    """The keys of the scene that call for an effect."""
    found = list(keys_of(scene, effect))
    more = f" and {len(found) - MOST_NAMED} more" if len(found) > MOST_NAMED else ""
    return "; ".join(found[:MOST_NAMED]) + more


def coordinates(scene: Scene) -> dict[str, int]:
    """How many coordinates of each kind are integrated."""
    surfaces = scene.surfaces
    return {
        "swings": sum(int(np.isfinite(s.each["kappa"]).sum()) for s in surfaces),
        "bars": sum(s.count for s in surfaces if s.bars != "clamped"),
        "x": sum(s.count for s in surfaces if scene.slides_along_x(s)),
        "y": sum(s.count for s in surfaces if scene.slides_along_y(s)),
        "baths": sum(s.count * (2 * s.bath.masses.size + s.bath.inertias.size) for s in surfaces),
    }


def contact(layout: Layout, method: Method) -> Contact:
    """How contact is computed."""
    pairs, by_list = pairs_of_bobs(layout)
    acting = (*layout.model.contacts, *(layout.model.within or ()))
    scalar = [item.potential for item in acting if not in_lanes(item.potential)]
    names = tuple(dict.fromkeys(type(potential).__name__ for potential in scalar))
    inactive = inactive_at_start(layout, method)
    return Contact(pairs, by_list, "scalar" if names else "lanes", names, inactive)


def in_lanes(potential: Any) -> bool:
    """Whether the forces of eight pairs are computed at once."""
    return not config.DISABLE_JIT and is_vectorized(type_of(potential))  # type: ignore[attr-defined]


def _predicted(
    layout: Layout, choice: Choice, search: Search, found: Prediction, beside: float
) -> Predicted:
    step = choice.step or search.step
    if step is None or search.evaluations:
        each = search.seconds / max(1, search.evaluations)
    else:
        each = seconds_of_evaluation(layout, choice.method, step, search.threads)
    return Predicted(
        force_evaluations=round(found.evaluations),
        seconds=each * found.evaluations + beside,
        memory_bytes=bytes_of_run(layout, choice.method, found.samples, choice.step is None),
        basis=found.basis,
        met=None if found.plan is None or found.plan.tuned is None else found.plan.tuned.met,
        stop=_stop(layout, choice, found),
    )


def _stop(layout: Layout, choice: Choice, found: Prediction) -> str:
    """Why the run will stop as NoProgress, and what would do; empty if it should not."""
    ended = found.basis == "searched" and found.whole > 0.0
    too_many = found.whole > MOST_PREDICTED * most_evaluations(layout.scene)
    if not (ended or (choice.method.adaptive and too_many)):
        return ""
    return (
        f"{reach_of(layout.scene, found.whole, layout.beginning)}; give a lower accuracy, a "
        "shorter duration, more max_evaluations, or a method and a step"
    )


def _slow(layout: Layout, choice: Choice) -> str:
    """Which motion bounds the steps of a run, and what would slow it."""
    motion = fastest_motion(layout)
    if motion.frequency == 0.0:
        return ""
    cure = f"{motion.cure} would allow longer steps"
    if choice.step is not None and choice.step * motion.frequency < RESOLVED:
        cure = f"a step of {RESOLVED / motion.frequency:.2g}, not {choice.step:.2g}, resolves it"
    return (
        f"the fastest motion is that of {motion.name}, at {motion.frequency:.3g} rad per unit of "
        f"time, for {motion.frequency * layout.scene.duration:.2g} rad in all; {cure}"
    )
