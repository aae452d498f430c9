"""Swept keys that would change nothing, or whose points would have different times: refused."""

from collections.abc import Sequence

from tribo.ensembles.members import is_random
from tribo.ledger.quantities import AVERAGED
from tribo.model.parameters import with_values
from tribo.model.scene import Scene
from tribo.sweeps.grid import Grid
from tribo.validation import InputError, inside

# Keys that change no value of any result.
IDLE = {
    "title": "is text for reports, and changes no result; give it in the scene",
    "output.ledger": "changes no kept quantity; give it in the scene",
    "numerics.allow_unresolved": "permits runs, and changes no result; give it in the scene",
    "numerics.max_evaluations": "limits runs, and changes no result; give it in the scene",
}
# Keys that change the recorded times, and that at which averages over time begin.
TIMES = ("duration", "output.samples", "output.times")
RUN_IN = "output.run_in"


def check_effects(grid: Grid, keep: Sequence[str], series: bool, members: bool) -> None:
    """Raise InputError about a key without an effect on `keep`, or on the times of `series`."""
    averages = not series and any(name.rpartition(".")[2] in AVERAGED for name in keep)
    with inside("values"):
        for key in grid.bound:
            if key in IDLE:
                raise InputError(key, IDLE[key])
            if series and key in TIMES:
                raise InputError(
                    key, "cannot be swept where series are kept, as times would differ"
                )
            if key in (*TIMES[1:], RUN_IN) and not averages:
                problem = 'changes averages over time alone; keep one at the end, as "upper.'
                raise InputError(key, f'{problem}friction_force"')
            if key == "seed" and not _follows_seed(grid, members):
                raise InputError(key, _without_seed(members))


def _follows_seed(grid: Grid, members: bool) -> bool:
    """Whether some point depends on the seed of the scene, which members do by heights alone."""
    first = grid.point(0)
    points = [first | axis.at(place) for axis in grid.axes for place in range(len(axis.rows))]
    scenes = (with_values(grid.scene, point) for point in points)
    return any(_has_random_heights(s) or (not members and is_random(s)) for s in scenes)


def _has_random_heights(scene: Scene) -> bool:
    return any(surface.draws_heights for surface in scene.surfaces)


def _without_seed(members: bool) -> str:
    if members:
        return "changes nothing: members have other seeds, and the scene has no random heights"
    return "changes nothing: the scene has no noise, thermal start or random heights"
