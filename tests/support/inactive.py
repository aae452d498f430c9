"""Which asperites have to be stepped, and when that is decided, by the distances of all bobs."""

from types import SimpleNamespace

import numpy as np

STEP = 0.03
STOPS = (3.0, 6.0, 9.0, 12.0)


def crossing(stops=STOPS, columns=40, rows=3, ends="free", first=11.0):
    """A pulled slider crosses a forced surface, and driven bars come up; all of them swing."""
    import tribo

    slider = tribo.Surface(
        "slider",
        bob=(2.0, 0.7),
        shape=(3, 4),
        spacing=(1.0, 1.0),
        velocity=(0.5, 0.0),
        drive=tribo.Pulled(stiffness=2.0, speed=0.5),
    )
    count = columns * rows
    kappa = np.linspace(0.5, 16.0, count)
    swing = np.linspace(-0.25, 0.2, count)
    kappa[-1] = 0.0
    hills = np.cos(np.arange(count) % columns / 2.0) - 1.0
    lower = tribo.Surface(
        "lower",
        facing="up",
        shape=(columns, rows),
        spacing=(1.0, 0.8),
        velocity=(-0.5, 0.0),
        heights=hills,
        asperite=tribo.Asperite(kappa=kappa),
        initial=tribo.Initial(swing=swing, omega=0.1, phi=0.15),
    )
    bars = tribo.Surface(
        "bars",
        facing="up",
        bob=(first, 0.05),
        depth=4.0,
        velocity=(-2.0, 0.0),
        shape=(columns - 10, rows),
        spacing=(0.9, 0.9),
        drive="bars",
        bars=ends,
        initial=tribo.Initial(swing=0.2, phi=-0.1),
    )
    potential = tribo.LennardJones(0.05, 0.5).with_cutoff(1.3)
    pairs = [("slider", "lower"), ("slider", "bars")]
    return tribo.Scene(
        (lower, slider, bars),
        [tribo.Interaction(potential, pair) for pair in pairs],
        stops[-1],
        periodic={"z": 7.0},
        output=tribo.Output(times=stops),
    )


def loops(scene):
    """The loop of a scene, and one with the same code that steps all asperites at all times."""
    from tribo.integrators.methods import METHODS
    from tribo.layout.layout import lay_out
    from tribo.loops.general import GeneralLoop
    from tribo.loops.setting import Setting

    found = []
    for _ in range(2):
        layout = lay_out(scene)
        found.append(GeneralLoop(layout, METHODS["verlet"], Setting(step=STEP), layout.start, 0.0))
    step_all(found[1]._neighbours.active)
    return found


def step_all(active):
    """Let all asperites be stepped at all times; returns the same packs."""
    active.eligible[:] = 0
    return active


def inactive(loop):
    """Whether each asperite is inactive, (n,)."""
    from tribo.compiler.lanes import LANES

    active = loop._neighbours.active
    packs = np.ones(active.since.size, bool)
    packs[active.packs[: active.first[-1]]] = False
    assert np.array_equal(packs, np.isfinite(active.since)), "times of packs that are stepped"
    return packs[loop.layout.places.columns // LANES]


def positions(loop):
    """Positions of all bobs at the last evaluation of the forces, (n, 3)."""
    from tribo.kernels.records import X, Y

    layout = loop.layout
    bobs = loop.model.bobs[[[X], [Y]], layout.places.columns]
    return np.column_stack([*bobs, layout.depths])


def longest_paths(loop):
    """How far free swings may carry each bob from where it is, (n,); 0 of the slider's."""
    layout = loop.layout
    a = loop.layout.asperites
    swing, omega = loop.state.y.reshape(2, -1)[:, layout.places.q[: a.size]]
    inertia = a.inertia + a.mass * a.pivot**2
    with np.errstate(divide="ignore"):
        amplitude = np.sqrt((swing - a.phi) ** 2 + omega**2 * inertia / a.kappa)
    amplitude[a.dof_phi >= 0] = 1.0
    amplitude[layout.parts["slider"]] = 0.0
    return 2.0 * (a.l1 + a.pivot) * np.minimum(amplitude, 1.0)


def boxes(layout, part, places, paths):
    """Pack of each asperite of a surface; low and high corners of the boxes of the packs."""
    from tribo.compiler.lanes import LANES

    names, pack = np.unique(layout.places.columns[part] // LANES, return_inverse=True)
    corners = []
    for extreme, sign in ((np.minimum, -1.0), (np.maximum, 1.0)):
        corner = np.full((names.size, 3), -sign * np.inf)
        extreme.at(corner, pack, places[part])
        path = np.zeros(names.size)
        np.maximum.at(path, pack, paths[part])
        corner[:, :2] += sign * path[:, None]
        corners.append(corner)
    return pack, *corners


def out_of_reach(layout, places, paths, reach, period):
    """Whether each asperite is in a pack that is farther than `reach` from the other surfaces."""
    far = np.zeros(len(places), bool)
    _, low, high = boxes(layout, layout.parts["slider"], places, paths)
    for name in ("lower", "bars"):
        pack, theirs_low, theirs_high = boxes(layout, layout.parts[name], places, paths)
        middle = 0.5 * ((low + high)[:, None] - (theirs_low + theirs_high)[None])
        middle[..., 2] -= period * np.round(middle[..., 2] / period)
        widths = 0.5 * ((high - low)[:, None] + (theirs_high - theirs_low)[None])
        gaps = np.maximum(np.abs(middle) - widths, 0.0)
        far[layout.parts[name]] = np.all(np.sum(gaps**2, axis=-1) >= reach**2, axis=0)[pack]
    return far


def farthest(places, before, stepped, speed, elapsed):
    """How far a bob that is stepped, or a surface with others, has moved."""
    moved = np.linalg.norm((places - before)[stepped, :2], axis=-1)
    return max(np.max(moved), speed * elapsed)


def near(places, sliding, reach, period):
    """Whether each bob is within reach of the slider's."""
    away = places[sliding, None] - places[None]
    away[..., 2] -= period * np.round(away[..., 2] / period)
    return np.any(np.sum(away**2, axis=-1) < reach**2, axis=0)


def check(scene) -> str:
    """What is wrong with the asperites that are not stepped, at any step; empty if nothing is."""
    from tribo.kernels.status import PAUSED
    from tribo.layout.contacts import MARGIN, SKIN

    loop, every = loops(scene)
    neighbours = loop._neighbours
    selection = loop._neighbours.active
    end = scene.times[-1]
    cutoff = scene.interactions[0].potential.range()
    skin = SKIN * cutoff
    period = scene.periodic.z
    times = np.array([end, 1.5 * end])
    sliding = np.zeros(scene.count, bool)
    sliding[loop.layout.parts["slider"]] = True
    lower = loop.layout.parts["lower"]  # the first surface of its pair, which has the rows
    first = loop.layout.model.surfaces[0].start
    rows = neighbours.pairs[0, 2] + loop.layout.places.columns[lower] - first
    speed = np.abs(scene.surfaces[2].velocity[0] - scene.surfaces[0].velocity[0])
    rooms = [each.room(2) for each in (loop, every)]
    listed = chosen = (np.full((scene.count, 3), np.nan), 0.0)
    t = 0.0
    steps = 0
    while t < end - 1.5 * STEP:
        before = ~inactive(loop), int(neighbours.made[0]), selection.selected[0]
        paths = longest_paths(every)
        for each, room in zip((loop, every), rooms, strict=True):
            # None at first: the lists are made at t = 0.
            if each.advance(times, room, steps) != PAUSED:
                return f"t = {t}: the run stops"
        places = positions(every)
        asleep = inactive(loop)
        t = loop.clocks["t"][0] - 0.5 * STEP * steps
        if np.max(np.abs(positions(loop) - places)[~asleep]) > 1e-11:
            return f"t = {t}: bobs are not where steps carry them"
        if np.any(asleep & near(places, sliding, cutoff, period)) or np.any(asleep[sliding]):
            return f"t = {t}: a bob within reach is not stepped"
        late = not farthest(places, listed[0], before[0], speed, t - listed[1]) < 0.5 * skin
        if late != (neighbours.made[0] != before[1]):
            return f"t = {t}: the list is made at another time"
        room = MARGIN * skin
        far = not farthest(places, chosen[0], before[0], speed, t - chosen[1]) < 0.5 * room
        if (late and far) != (selection.selected[0] != before[2]):
            return f"t = {t}: packs are selected at another time"
        if late:
            listed = places, t
            lengths = np.diff(neighbours.start)
            if np.any(lengths < 0) or np.any(lengths[rows][asleep[lower]]):
                return f"t = {t}: rows of bobs that are not stepped"
        if late and far:
            chosen = (places, t)
            reach = cutoff + skin + room
            if np.any(asleep != out_of_reach(every.layout, places, paths, reach, period)):
                return f"t = {t}: others should be stepped"
        steps = 1
    for each, room in zip((loop, every), rooms, strict=True):
        each.advance(times, room, 10**6)
    for one, other in zip(rooms[0][:2], rooms[1][:2], strict=True):
        if np.max(np.abs(one - other)) > 1e-12 * np.max(np.abs(other)):
            return "samples differ from those of steps"
    return ""


def check_paths(scene) -> str:
    """What is wrong with the boxes around packs and their free swings; uncompiled code only."""
    from tribo.integrators.inactive import set_boxes_of_paths
    from tribo.kernels.neighbours import inactive_have_crossed

    model = SimpleNamespace(surfaces=np.array([(3.0, 4.0)], "f8, f8"))
    model.surfaces.dtype.names = ("vx", "vy")
    model.surfaces = model.surfaces.view(np.recarray)
    for eligible, width, crossed in ((1, 19.9, True), (1, 20.1, False), (0, 19.9, False)):
        active = SimpleNamespace(eligible=[eligible], packs=np.zeros(1))
        if inactive_have_crossed(model, active, width, -2.0) != crossed:
            return "the distance that a surface moves"
    loop, _ = loops(scene)
    loop.advance(scene.times, loop.room(1), 0)
    layout, q, v = loop.layout, *loop.state.y.reshape(2, -1)
    places = positions(loop)
    paths = longest_paths(loop)
    for k, (name, part) in enumerate(layout.parts.items()):
        _, low, high = boxes(layout, part, places, paths)
        found = loop._neighbours.own
        active = loop._neighbours.active
        set_boxes_of_paths(loop.model, active, k, 0.0, q, v, found)
        centres, halves = (each[:, : found.count[0]] for each in found[1:])
        if not (np.allclose(centres - halves, low.T) and np.allclose(centres + halves, high.T)):
            return f"boxes around {name}"
    return ""
