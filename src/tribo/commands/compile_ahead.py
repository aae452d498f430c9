"""`tribo doctor --compile`: compile before anyone waits, for images, clusters and classrooms.

The scenes are those of `tribo new`, shortened.  A scene that is not among them compiles only what
it has beyond them.
"""

import time
import tomllib
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from tribo.ensembles import ensemble
from tribo.model.interaction import Interaction
from tribo.model.langevin import Langevin
from tribo.model.scene import Scene
from tribo.model.scene_file import scene_from
from tribo.model.settings import Output
from tribo.potentials import Coulomb, LennardJones, Morse, Potential
from tribo.simulation import simulate
from tribo.starters import starter

# One asperite on one compiles its loop for each potential; other scenes compile units for each.
POTENTIALS: tuple[Potential, ...] = (
    Coulomb(0.2),
    Morse(0.1, 1.0, 1.5),
    LennardJones(0.1, 1.0),
    LennardJones(0.1, 1.0).with_cutoff(2.5),
)
DURATION = 0.1  # [time]
STEP = 0.01  # of splitting methods [time]
SWINGS = np.linspace(0.0, 0.01, 64)  # of members [rad]


def short(kind: str) -> Scene:
    """The scene that `tribo new` writes, for a short time."""
    scene = scene_from(tomllib.loads(starter(kind)))
    return replace(scene, duration=DURATION, output=Output(samples=3))


def with_reservoir(scene: Scene, langevin: Langevin | None) -> Scene:
    """The scene with this reservoir on the bars of its first surface, or with none."""
    first, *others = scene.surfaces
    return replace(scene, surfaces=(replace(first, langevin=langevin), *others))


def runs() -> dict[str, Callable[[], object]]:
    """A run of each kind of scene, by what it shows."""
    pair = short("paper")
    row = short("row")
    swings = {"upper.swing": SWINGS}
    found: dict[str, Callable[[], object]] = {}
    for potential in POTENTIALS:
        scene = replace(pair, interactions=(Interaction(potential),))
        found[f"a pair, {potential}"] = lambda scene=scene: simulate(scene)  # type: ignore[misc]
    found["members of a pair"] = lambda: ensemble(pair, SWINGS.size, vary=swings)
    for kind in ("row", "rough", "bath", "pulled"):
        found[f"{kind}, for an accuracy"] = lambda kind=kind: simulate(short(kind))  # type: ignore[misc]
    free = with_reservoir(row, None)
    noisy = with_reservoir(row, Langevin(0.5, 0.01))
    found["a row without reservoirs, for an accuracy"] = lambda: simulate(free)
    for potential in POTENTIALS:
        scene = replace(noisy, interactions=(Interaction(potential),))
        found[f"a row with noise, {potential}"] = lambda scene=scene: simulate(  # type: ignore[misc]
            scene, method="verlet", step=STEP
        )
    found["members of a row"] = lambda: ensemble(free, SWINGS.size, vary=swings)
    found["members of a row with noise"] = lambda: ensemble(
        noisy, SWINGS.size, method="verlet", step=STEP
    )
    return found


def compile_ahead() -> None:
    """Compile, and print what, and the seconds of each and of all together."""
    began = time.perf_counter()
    for purpose, run in runs().items():
        print(f"  {purpose[:72]:<72} ", end="", flush=True)
        start = time.perf_counter()
        run()
        print(f"{time.perf_counter() - start:6.1f} s", flush=True)
    print(f"{'compiled':<12} in {time.perf_counter() - began:.0f} s")
