"""One sentence that says what a run shows of work and pseudowork."""

from collections.abc import Mapping

import numpy as np

from tribo.model.scene import Scene

# Works that differ by less than this part of their size are called equal.
EQUAL = 1e-6


def sentence(scene: Scene, works_of: Mapping[str, Mapping[str, np.ndarray]]) -> str:
    """What the work of friction says about the motion of the bobs of the first moving surface.

    `works_of` maps surface -> work -> (times,).  Empty where no works of the contact force are
    recorded.
    """
    moving = next((s for s in scene.surfaces if s.velocity[0] != 0.0), scene.surfaces[0])
    works = works_of[moving.name]
    if "w1" not in works or "w1_ps" not in works:
        return ""
    work, pseudowork = (float(works[name][-1]) for name in ("w1", "w1_ps"))
    size = max(abs(work), abs(pseudowork), *(float(np.max(np.abs(v))) for v in works.values()))
    if abs(work - pseudowork) <= EQUAL * size:
        return (
            f'The work of friction on "{moving.name}" equals its pseudowork: friction\'s point of '
            "action has moved as far as the block."
        )
    alone = moving.count == 1
    bobs = f'The {"bob" if alone else "bobs"} of "{moving.name}"'
    numbers = f"the work of friction ({work:.3g}) and its pseudowork ({pseudowork:.3g})"
    if work * pseudowork < 0.0:
        return f"{bobs} swing{'s' * alone} against the block: {numbers} have opposite signs."
    lag = abs(work) < abs(pseudowork)
    seen = f"lag{'s' * alone}" if lag else f"run{'s' * alone} ahead"
    less = "less" if lag else "more"
    return (
        f"{bobs} {seen}: friction's point of action moves {less} than the block, so the work of "
        f"friction ({work:.3g}) is {'smaller' if lag else 'larger'} in magnitude than its "
        f"pseudowork ({pseudowork:.3g})."
    )
