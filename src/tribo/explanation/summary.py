"""What a run will do and cost: found from its scene, before it is run."""

from __future__ import annotations

import numpy as np
from numba import config
from numba.core.event import install_recorder

from tribo.accuracy.choose_method import choose
from tribo.accuracy.run_time import pairs_of_bobs
from tribo.compiler.plugin_methods import type_of
from tribo.explanation.explanation import Contact, Explanation
from tribo.explanation.fastest_motion import slow_motion
from tribo.explanation.prediction import Search, predict
from tribo.integrators.methods import Method
from tribo.kernels.potential_in_lanes import is_vectorized
from tribo.layout.layout import Layout, lay_out
from tribo.layout.threads import threads_of
from tribo.ledger.ledger import check_keep
from tribo.loops.general import GeneralLoop
from tribo.model.effects import Effect, keys_of, lack_of
from tribo.model.scene import Scene, checked_scene
from tribo.validation import inside

# Time of a run from which on the explanation says what makes it slow [s].
LONG = 45 * 60.0
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
    threads = threads_of(layout.model, choice.method, None)
    with install_recorder("numba:compile") as compilations:
        search = Search(layout, choice.method, threads.number)
    predicted, step = predict(choice, search)
    return Explanation(
        scene=scene,
        effects={str(each): why_present(scene, each) for each in Effect if each in scene.effects},
        absent={str(each): lack_of(each) for each in Effect if each not in scene.effects},
        coordinates=coordinates(scene),
        contact=contact(layout, choice.method),
        method=choice.method.name,
        why=choice.why,
        threads=threads,
        accuracy=choice.accuracy,
        step=step,
        compiled=not compilations.buffer,
        predicted=predicted,
        evaluations_used=search.evaluations,
        slow=slow_motion(layout, choice.step) if predicted.seconds >= LONG else "",
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
    acting = [each.potential for each in (*layout.model.contacts, *(layout.model.within or ()))]
    if not config.DISABLE_JIT:  # type: ignore[attr-defined]
        acting = [each for each in acting if not is_vectorized(type_of(each))]
    names = tuple(dict.fromkeys(type(each).__name__ for each in acting))
    inactive = inactive_at_start(layout, method)
    return Contact(pairs, by_list, "scalar" if names else "lanes", names, inactive)


def inactive_at_start(layout: Layout, method: Method) -> int:
    """Number of asperites that a run does not step at its start."""
    if not method.splits:
        return 0
    loop = GeneralLoop(layout, method, 1.0, layout.start, 0.0)
    loop.advance(layout.times[-1:], loop.room(1), 0)
    return loop.inactive
