"""The verdict on a seed: its scene, its checks, and what they found."""

from __future__ import annotations

import traceback
import warnings
from collections.abc import Callable, Sequence

import tribo
from support.mixed import derived, many, noise, states
from support.mixed.comparison import ACCURACY, Findings, compare
from support.mixed.draw import STRUCTURES, Draw, Scene, drawn
from tribo.model.scene_file import scene_from

Check = Callable[[Findings, Scene, Draw], None]


def check_run(findings: Findings, scene: Scene, draw: Draw) -> None:
    """A run of the scene by itself."""
    how = {"method": scene.structure.method, "accuracy": ACCURACY}
    result = tribo.simulate(scene_from(scene.copy()), **how, threads=draw.pick(1, 2))
    compare(findings, "run", result, scene.table)


# What a scene is put through, and how often.
CHECKS: dict[str, tuple[Check, float]] = {
    "run": (check_run, 0.3),
    "state": (states.check_state, 0.5),
    "relax": (states.check_relax, 0.1),
    "sweep": (many.check_sweep, 0.3),
    "ensemble": (many.check_ensemble, 0.3),
    "starts": (many.check_drawn_starts, 0.08),
    "settings": (many.check_settings, 0.04),
    "averages": (derived.check_averages, 0.2),
    "depinning": (derived.check_depinning, 0.2),
    "files": (derived.check_files, 0.15),
    "copies": (derived.check_copies, 0.1),
    "subclass": (derived.check_subclass, 0.06),
    "potentials": (derived.check_potentials, 0.3),
}
KINDS = (*STRUCTURES, *noise.WARM)
# Part of the scenes that have noise.
NOISY = 0.2


def kind_of(seed: int, kinds: Sequence[str] = KINDS) -> str:
    """The kind of scene of a seed, of those that are wanted."""
    draw = Draw(seed, 0)
    warm = [kind for kind in kinds if kind in noise.WARM]
    cold = [kind for kind in kinds if kind not in noise.WARM]
    noisy = not cold or (warm and draw.chance(NOISY))
    return str(draw.pick(*(warm if noisy else cold)))


def judged(
    seed: int, kinds: Sequence[str] = KINDS, checks: Sequence[str] = tuple(CHECKS)
) -> Findings:
    """What the scene of a seed shows."""
    kind = kind_of(seed, kinds)
    findings = Findings(seed, kind)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        if kind in noise.WARM:
            _guarded(findings, "noise", lambda: noise.check_noise(findings, kind))
            return findings
        draw = Draw(seed, 4)
        scene = drawn(seed, kind)
        chosen = [name for name, (_, share) in CHECKS.items() if draw.chance(share)]
        for number, name in enumerate(chosen):
            if name in checks:
                check = CHECKS[name][0]
                own = Draw(seed, 5, number)
                _guarded(findings, name, lambda check=check, own=own: check(findings, scene, own))
        if not (findings.checks or findings.found) and "run" in checks:
            # None was chosen, or the scene has nothing that they look at.
            _guarded(findings, "run", lambda: check_run(findings, scene, Draw(seed, 6)))
    return findings


def _guarded(findings: Findings, name: str, check: Callable[[], None]) -> None:
    """A check whose refusals and errors are findings."""
    try:
        check()
    except tribo.InputError as problem:
        sentence = str(problem)
        findings.add("refused" if len(sentence.splitlines()) == 1 else "crash", name, sentence)
    except Exception as problem:
        where = traceback.extract_tb(problem.__traceback__)[-1]
        place = f"{where.filename.rpartition('/')[2]}:{where.lineno}"
        findings.add("crash", name, f"{type(problem).__name__}: {problem} ({place})")
