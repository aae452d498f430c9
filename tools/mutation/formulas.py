"""Checks of single functions of the package against a formula or a search written out here.

They are for what no run of a short scene shows: costs, limits, and cells of large lists.  Each
returns what is wrong, or nothing.  They import the package when they run: see `judge`.
"""

import itertools
from dataclasses import replace
from types import SimpleNamespace
from typing import NamedTuple
from unittest import mock

import numpy as np
from tools.mutation.registers import registers_as_arrays
from tools.mutation.scenes import SCENES
from tools.mutation.start import start_of

EPSILON = np.finfo(float).eps


CALLS: list[tuple[float, ...]] = []  # arguments with which a drive was called


class Recorder(NamedTuple):
    """A drive that records its arguments."""

    nothing: float = 0.0

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        """f2."""
        CALLS.append((t, x, y, vx, vy, fx, fy))
        return self.nothing, self.nothing


def arguments_of_a_drive() -> str:
    """A drive is told of place and velocity of the bar in the laboratory, and of f1."""
    from tribo.kernels.equations_of_motion import place_bobs
    from tribo.kernels.user_forces import set_customs
    from tribo.layout.layout import lay_out
    from tribo.model.own_drive import Custom
    from tribo.model.scene_file import scene_from
    from tribo.threads.writable_memory import own_model

    table = SCENES["slid"]
    t = 0.7
    scene = scene_from(table)
    drive = Custom(force=Recorder())
    layout = lay_out(replace(scene, surfaces=[replace(s, drive=drive) for s in scene.surfaces]))
    q, v = (np.zeros(layout.room[0]) for _ in range(2))
    q[layout.places.q], v[layout.places.q] = np.split(layout.start, 2)
    model, _ = own_model(layout)
    place_bobs(model, t, q)
    count = layout.asperites.size
    fx = 1.0 + np.arange(count)
    fy = -2.0 - np.arange(count)
    model.f1[:, layout.places.columns] = fx, fy
    CALLS.clear()
    set_customs(model, model.drives, t, q, v)
    start = start_of(table)
    bar = start.bar + start.velocity * t
    expected = [np.full(count, t), *bar, *start.bar_velocity, fx, fy]
    names = ("t", "x", "y", "vx", "vy", "fx", "fy")
    for name, found, truth in zip(names, np.array(CALLS).T, expected, strict=True):
        if not np.allclose(found, truth, 0.0, 1e-13):
            return f"{name}: {found} instead of {truth}"
    return ""


def errors() -> str:
    """The error of a step is in units of the tolerance, or of the round-off of large values."""
    from tribo.integrators.linear_combinations import largest

    rng = np.random.default_rng(1)
    weights = rng.normal(size=4)
    rates = rng.normal(size=(4, 16))
    values = np.zeros(16)
    tolerance = np.full(16, 1e-3)
    values[1:3] = (-1e10, 3e9)
    tolerance[1:3] = 1e-6
    for component in (0, 1, 2, 15):
        only = np.arange(16) == component
        found = largest(0.5, weights, rates * only, values, tolerance)
        unit = tolerance[component] + 2.0 * EPSILON * abs(values[component])
        if not np.isclose(found, 0.5 * abs(weights @ rates[:, component]) / unit, 1e-12):
            return f"component {component}"
        if np.isfinite(largest(0.5, weights, np.where(only, np.inf, rates), values, tolerance)):
            return f"infinite component {component}"
    return ""


def closing_speeds() -> str:
    """Two surfaces close in at the diagonal of their velocities, and two swings at most."""
    from tribo.kernels.encounters import closing_speed

    rng = np.random.default_rng(2)
    surfaces = [
        SimpleNamespace(start=start, end=end, stop=stop)
        for start, end, stop in ((0, 8, 8), (8, 19, 24), (32, 34, 40))
    ]
    model = SimpleNamespace(surfaces=surfaces)
    every = [*range(8, 19), 32, 33]

    def some(active: list[int], first: list[int]) -> SimpleNamespace:
        return SimpleNamespace(blocks=np.array(active), first=first)

    none = some([0], [0, 1, 1, 1])
    if closing_speed(model, none, (1, 2), np.ones((3, 48))) != 0.0:
        return "of blocks that are not active"
    for sign, active, columns in (
        (1.0, None, every),
        (-1.0, None, every),
        (1.0, some([0, 1, 4], [0, 1, 2, 3]), [*range(8, 16), 32, 33]),
        (-1.0, some([4], [0, 0, 0, 1]), [32, 33]),
    ):
        speeds = np.full((3, 48), 1e3)  # of other surfaces
        own = rng.normal(2.0 * sign, 1.0, (3, len(columns)))
        own[2] = np.abs(own[2])
        speeds[:, columns] = own
        expected = np.hypot(*np.ptp(own[:2], axis=1)) + 2.0 * np.max(own[2])
        if not np.isclose(closing_speed(model, active, (1, 2), speeds), expected, 1e-12):
            return "not the diagonal"
    return ""


def listed_pairs() -> str:
    """A list has exactly the pairs within its reach, sorted, whether cells are many or one."""
    from tribo.kernels.neighbours import refresh
    from tribo.kernels.records import X, Y
    from tribo.layout import layout as layouts
    from tribo.model.scene_file import scene_from
    from tribo.threads.writable_memory import own_model

    rng = np.random.default_rng(3)
    for count, extent, box in (
        (70, 12.0, {}),
        (70, 12.0, {"x": 12.0}),
        (70, 12.0, {"z": 11.0}),
        (70, 12.0, {"x": 5.0, "z": 3.5}),
        (400, 40.0, {}),
        (400, 40.0, {"x": 40.0, "z": 0.7 * 40.0}),
    ):
        places = rng.uniform(0.0, extent, (count, 3)) * [1.0, 0.08, 0.7] + [0.0, 0.0, 5.0]
        with mock.patch("tribo.layout.contacts.UNLISTED_PAIRS", 0):
            layout = layouts.lay_out(scene_from(two_clouds(places, box)))
        model = own_model(layout)[0]
        columns = layout.places.columns
        neighbours = layout.neighbours()
        neighbours = neighbours._replace(index=np.zeros(60 * count, np.int32))
        near = 0.49 * layout.skin
        far = 0.51 * layout.skin
        for slide, rise, lists_made in (
            (0.0, 0.0, 1),
            (0.0, near, 1),
            (near, 0.0, 1),
            (0.75 * far, 0.75 * far, 2),
            (0.75 * far, -0.5 * far, 3),
            (5.3, 0.0, 4),
        ):
            moves = np.arange(count) < UPPER
            place = places[:, 0] + slide * moves, places[:, 1] + rise * moves
            model.bobs[[[X], [Y]], columns] = place
            refresh(model, neighbours)
            if neighbours.made[0] != lists_made:
                return f"slide {slide}: list {neighbours.made[0]} instead of {lists_made}"
            if near in (slide, rise):
                continue  # the list is the one before
            now = np.column_stack([*place, layout.depths])
            for k, pair in enumerate(neighbours.pairs.tolist()):
                wrong = wrong_row(layout, neighbours, k, now, box, pair)
                if wrong:
                    return f"box {box}, slide {slide}: {wrong}"
    return ""


# Bobs of the upper cloud: one more than fills blocks of eight.
UPPER = 33


def two_clouds(places: np.ndarray, box: dict) -> dict:
    """A scene of UPPER bobs and the rest, with contact between and within."""
    potential = {"potential": "lennard-jones", "epsilon": 0.1, "sigma": 0.5}
    species = ["A" if k % 3 else "B" for k in range(len(places))]
    return {
        "duration": 1.0,
        "periodic": box,
        "interaction": [
            potential | {"cutoff": 1.5, "between": ["upper", "lower"], "species": ["A", "B"]},
            potential | {"cutoff": 1.2, "between": ["upper", "upper"], "species": ["A", "A"]},
        ],
        "surface": [
            {"name": "upper", "positions": places[:UPPER].tolist(), "species": species[:UPPER]},
            {
                "name": "lower",
                "facing": "up",
                "positions": places[UPPER:].tolist(),
                "species": species[UPPER:],
            },
        ],
    }


def wrong_row(layout, neighbours, k, places, box, pair) -> str:
    """The first row of the kth pair of surfaces that a comparison of all bobs contradicts."""
    one, other, row = pair
    reach = neighbours.reach[k]
    kinds = sorted(neighbours.species[k])
    parts = list(layout.parts.values())
    columns = layout.places.columns
    theirs = np.arange(parts[other].start, parts[other].stop)
    for i in range(parts[one].start, parts[one].stop):
        expected = []
        for n in np.unique(columns[theirs] // 8):
            own = places[theirs[columns[theirs] // 8 == n]]
            middle = 0.5 * (np.min(own, axis=0) + np.max(own, axis=0))
            away = places[i] - middle
            for axis, name in ((0, "x"), (2, "z")):
                if name in box:
                    away[axis] -= box[name] * np.round(away[axis] / box[name])
            beyond = np.maximum(abs(away) - 0.5 * np.ptp(own, axis=0), 0.0)
            is_partner = layout.model.species[columns[i]] in kinds
            if np.sum(beyond**2) < reach**2 and is_partner and 8 * n + 7 > columns[i]:
                expected.append(int(n))
        at = row + columns[i] - layout.model.surfaces.start[one]
        found = neighbours.index[neighbours.start[at] : neighbours.start[at + 1]].tolist()
        if found != expected:
            return f"bob {i} has the blocks {found} instead of {expected}"
    return ""


def errors_of_a_pair() -> str:
    """The error of a pair's step: the worst rate's, and that of the worst account."""
    rng = np.random.default_rng(4)
    with registers_as_arrays():
        from tribo.pair import step_rows as rows
        from tribo.pair.step_sums import error_of

        work = rng.uniform(1e-6, 1e-5, (rows.ROWS, 8))
        work[rows.PLACE] = 1e10 * rng.normal(size=8)
        places = (rows.V1, rows.OF_V1), (rows.V2, rows.OF_V2), (rows.J, rows.OF_J)
        units = [
            work[rows.LIMITS, limit] + 2.0 * EPSILON * abs(work[rows.PLACE, rate])
            for rate, limit in places
        ]
        for worst in range(3):
            leading = np.where(np.arange(3) == worst, -1.0, 1e-3)
            gains = rng.normal(size=8)
            found = error_of(0.5, work, SimpleNamespace(leading=leading, leading_gains=gains))
            accounts = np.max(0.5 * abs(gains) * work[rows.ALLOWED])
            if not np.isclose(found, np.max(0.5 * abs(leading) / units) + accounts, 1e-12):
                return f"rate {worst}"
    return ""


def steps_towards_encounters() -> str:
    """A pair's next step goes 3/4 of the way by the rate that will have grown as much again.

    By the rate at its start it goes the part that the clock allows.
    """
    clock = SimpleNamespace(encounter_fraction=0.5)
    length = 0.5
    sums = SimpleNamespace(once=(0.0, 0.0, 0.0))
    with registers_as_arrays():
        from tribo.pair import step
        from tribo.pair.step_rows import ROWS

        rest = SimpleNamespace(square=np.zeros(8))
        nodes = step.Nodes((np.zeros(8),) * 3, np.zeros(8), np.zeros(8), rest)
        nothing = {
            "solve": lambda *_: (True, nodes),
            "powers": lambda *_: None,
            "end_values": lambda *_: np.zeros(8),
            "sums_of": lambda *_: sums,
            "error_of": lambda *_: 0.0,
            "update_state": lambda *_: None,
        }
        for rate, later in ((0.2, 0.8), (0.6, 0.8), (0.8, 0.8), (1.2, 0.8)):
            work = np.zeros((ROWS, 8))
            changed = nothing | {"encounter_rate_of": lambda *_, later=later: later}
            with mock.patch.multiple(step, **changed):
                _, growth, _ = step.try_step(None, None, clock, length, rate, 1.0, work)
            longest = clock.encounter_fraction / later
            if later > rate:
                longest = min(longest, 0.75 / (later + (later - rate)))
            if not np.isclose(growth * length, longest, 1e-12):
                return f"from {rate} to {later}: {growth * length} instead of {longest}"
    return ""


def columns_by_slot() -> str:
    """The columns of a table in some slots, and another value where a slot is absent."""
    from tribo.ledger.motion import columns

    table = np.arange(6.0).reshape(2, 3)
    other = np.array([[7.0, 8.0, 9.0]])
    for slots, absent, expected in (
        ([2, -1, 0], 5.0, [[2.0, 5.0, 0.0], [5.0, 5.0, 3.0]]),
        ([-1, 1, -1], other, [[7.0, 1.0, 9.0], [7.0, 4.0, 9.0]]),
        ([1, 2, 0], 5.0, [[1.0, 2.0, 0.0], [4.0, 5.0, 3.0]]),
        ([-1, -1, -1], other, [[7.0, 8.0, 9.0], [7.0, 8.0, 9.0]]),
    ):
        if not np.array_equal(columns(np.array(slots), table, absent), expected):
            return f"slots {slots}"
    return ""


def given_starts() -> str:
    """Displacements and velocities that are given are those of each centre of mass."""
    from tribo.layout.layout import lay_out
    from tribo.model.scene_file import scene_from

    given = {"x": [0.1, 0.2, 0.3], "y": 0.4, "vx": 0.5, "vy": [0.6, 0.7, 0.8]}
    surface = {"name": "upper", "shape": [3, 1], "spacing": [1.0, 0.0], "initial": given}
    surface["drive"] = {"kind": "free", "load": 0.1}
    contact = {"potential": "coulomb", "strength": 0.1}
    lower = {"name": "lower", "facing": "up", "bob": [0.0, -2.0]}
    table = {"duration": 1.0, "interaction": contact, "surface": [surface, lower]}
    layout = lay_out(scene_from(table))
    q, v = np.split(layout.start, 2)
    for name, value in given.items():
        slots = layout.asperites[f"dof_{name[-1]}"][:3]
        found = (v if name.startswith("v") else q)[slots]
        if not np.array_equal(found, np.broadcast_to(value, 3)):
            return f"{name} = {found}"
    return ""


def empty_cells(room: int):
    """Cells for so many boxes."""
    from tribo.kernels.model import Cells

    numbers = (np.empty(size, np.int64) for size in (2 * room + 17, room, room))
    return Cells(np.zeros(2), np.zeros(2), np.zeros(2, np.int64), *numbers)


def cells() -> str:
    """Boxes in cells of at least a size, as many as fit, each box in the cell around its centre."""
    from tribo.kernels.cells import sort_boxes
    from tribo.kernels.model import Boxes

    rng = np.random.default_rng(7)
    xs = rng.uniform(3.0, 15.0, 60)
    zs = rng.uniform(-9.0, 0.0, 60)
    extent_x = np.ptp(xs)
    extent_z = np.ptp(zs)
    points = Boxes(np.array([60]), np.array([xs, np.zeros(60), zs]), np.zeros((3, 60)))
    for size_x, size_z, box_x, box_z, expected in (
        (2.0, 3.0, 0.0, 0.0, (int(extent_x / 2.0), int(extent_z / 3.0))),
        (2.0, 3.0, 0.9, 10.0, (1, 3)),  # below three cells there is one
        (2.0, 3.0, 13.0, 5.9, (6, 1)),
        (0.2, 0.3, 0.9, 0.8, (4, 1)),
        (50.0, 40.0, 0.0, 0.0, (1, 1)),
        (1e-3, 1e-3, 0.0, 0.0, None),
    ):
        cells = empty_cells(60)
        box = SimpleNamespace(x=box_x, z=box_z)
        reach = 0.5 * min(size_x, size_z)  # the rest is of boxes on either side
        halves = np.array([[size_x - reach], [0.0], [size_z - reach]])
        own = Boxes(np.array([1]), np.zeros((3, 1)), 0.75 * halves)
        theirs = points._replace(halves=np.repeat(0.25 * halves, 60, axis=1))
        sort_boxes(box, own, theirs, reach, cells)
        width_x, width_z = cells.widths
        nx, nz = cells.counts
        if expected is None:
            if not 60 <= nx * nz <= 2 * 60 + 16:
                return f"{nx * nz} cells for 60 points"
        elif (nx, nz) != expected or width_x < size_x or width_z < size_z:
            return f"{nx} x {nz} cells of {width_x} x {width_z} instead of {expected}"
        if expected not in (None, (1, 1)) and max(width_x / size_x, width_z / size_z) > 3.0:
            return "wide cells"
        place_x = np.mod(xs, box_x) if box_x else xs - np.min(xs)
        place_z = np.mod(zs, box_z) if box_z else zs - np.min(zs)
        cell_x = np.minimum((place_x / width_x).astype(int), nx - 1)
        cell_z = np.minimum((place_z / width_z).astype(int), nz - 1)
        cell = cell_z * nx + cell_x
        if not np.array_equal(cells.order, np.argsort(cell, kind="stable")):
            return "order of the points"
        first = cells.first[: nx * nz + 1]
        if first[0] != 0 or not np.array_equal(
            np.diff(first), np.bincount(cell, minlength=nx * nz)
        ):
            return "numbers of points in cells"
    return ""


def boxes_within_reach() -> str:
    """Of boxes in cells, exactly those within reach of another box, in ascending order."""
    from tribo.kernels.cells import near_blocks, sort_boxes
    from tribo.kernels.model import Boxes

    rng = np.random.default_rng(9)
    boxes = (
        (0.0, 0.0),
        (20.0, 0.0),
        (0.0, 30.0),
        (20.0, 30.0),
        (4.0, 0.9),
        (0.9, 4.0),
        (8.0, 17.0),
    )
    for (x, z), unit in itertools.product(boxes, (1.0, 0.04)):
        reach = 1.5 * unit
        half_x = 0.5 * min(x or 1.0, 1.0)
        half_z = 0.5 * min(z or 4.0, 4.0)
        own, theirs = (
            Boxes(
                np.array([count]),
                rng.uniform(-5.0, 25.0, (3, 310)) * [[unit], [0.2 * unit], [1.2 * unit]],
                rng.uniform(0.0, unit, (3, 310)) * [[half_x], [0.2], [half_z]],
            )
            for count in (25, 300)
        )
        periods = x * unit, z * unit
        lengths = SimpleNamespace(x=periods[0], z=periods[1])
        cells = empty_cells(310)
        sort_boxes(lengths, own, theirs, reach, cells)
        away = theirs.centres[:, None, :300] - own.centres[:, :25, None]
        for axis, box in zip((0, 2), periods, strict=True):
            if box:
                away[axis] -= box * np.round(away[axis] / box)
        widths = theirs.halves[:, None, :300] + own.halves[:, :25, None]
        gaps = np.maximum(abs(away) - widths, 0.0)
        for k, near in enumerate(np.sum(gaps**2, axis=0) < reach**2):
            found = np.full(300, -1)
            count = near_blocks(lengths, own, k, theirs, reach, cells, found)
            if not np.array_equal(found[:count], np.flatnonzero(near)):
                return f"periods {periods}: box {k}"
    return ""


def lists_in_chunks() -> str:
    """Rows of a list that are filled in chunks, and moved together, are those of one thread."""
    import tribo
    from support.sliding import POTENTIAL, scene
    from tribo.compiler.team import COUNTERS, NO_TEAM, PAIR
    from tribo.kernels.equations_of_motion import place_bobs
    from tribo.kernels.neighbours import join_chunks, list_chunk, list_pair, rebuild
    from tribo.layout.layout import lay_out
    from tribo.threads.writable_memory import own_model

    rng = np.random.default_rng(3)
    upper, lower = (rng.uniform(-6.0, 6.0, (n, 3)) * [1.0, 0.05, 1.0] for n in (70, 90))
    contacts = [tribo.Interaction(POTENTIAL, ("upper", name)) for name in ("lower", "upper")]
    layout = lay_out(replace(scene(upper, lower, {}), interactions=contacts))
    model, _ = own_model(layout)
    place_bobs(model, 0.0, np.zeros(layout.room[0]))
    alone = layout.neighbours()
    shared = layout.neighbours()
    rebuild(model, alone)
    stops = [*alone.pairs[1:, 2], alone.start.size - 1]
    team = SimpleNamespace(counters=np.zeros(COUNTERS, np.int64), lengths=np.zeros(5, np.int64))
    team.begins = np.zeros(6, np.int64)
    end = 0
    for k, stop in enumerate(stops):
        list_pair(model, NO_TEAM, shared, k, end)  # for its boxes and cells
        rows = slice(shared.pairs[k, 2], stop)
        shared.start[rows] = -1
        shared.index[end:] = -1
        team.counters[PAIR] = k
        team.begins[:] = end + (shared.index.size - end) // 5 * np.arange(6)
        for chunk in (3, 0, 4, 2, 1):
            list_chunk(model, team, shared, chunk)
        if np.min(team.lengths) < 10:
            return "chunks without rows show nothing"
        end = join_chunks(model, team, shared, k, end)
        if not np.array_equal(shared.start[rows], alone.start[rows]):
            return f"starts of the rows of pair {k}"
    if end != alone.start[-1] or not np.array_equal(shared.index[:end], alone.index[:end]):
        return "blocks in the list"
    return ""


def one_bob_that_crosses() -> str:
    """A bob has crossed as soon as it has moved by half the skin, and not before."""
    from tribo.kernels.neighbours import have_moved

    for far, crossed in ((0.0, 0.0), (0.249, 0.0), (0.251, 1.0)):
        bobs = np.zeros((2, 8))
        bobs[:, 5] = 0.6 * far, -0.8 * far
        found = have_moved(SimpleNamespace(bobs=bobs), np.zeros((2, 8)), 0.5, 0)
        if not np.array_equal(found, crossed * (np.arange(8) == 5)):
            return f"a bob that has moved by {far}"
    return ""


def cold_baths() -> str:
    """Oscillators of a bath at temperature 0 start where their bars are."""
    from tribo.layout.layout import lay_out
    from tribo.model.scene_file import scene_from

    m1 = 0.6
    m2 = 1.2
    length = 1.4
    swing = 0.3
    shift = {"x": [0.1, 0.2, 0.4], "y": [-0.3, 0.5, 0.7]}
    bath = {"oscillators": [{"mass": 0.2, "frequency": 1.5}, {"mass": 0.1, "frequency": 2.0}]}
    l2 = length * m1 / (m1 + m2)
    sideways = l2 * np.sin(swing)
    along = l2 * (1.0 - np.cos(swing))
    for drive, given in (
        ({"kind": "free", "load": 0.1}, shift),
        ({"kind": "forced"}, {}),
        ("bars", {}),
    ):
        surface = {
            "name": "upper",
            "shape": [3, 1],
            "spacing": [1.0, 0.0],
            "asperite": {"m1": m1, "m2": m2, "length": length},
            "drive": drive,
            "initial": {"theta": swing} | given,
            "bath": bath,
        }
        contact = {"potential": "coulomb", "strength": 0.1}
        lower = {"name": "lower", "facing": "up", "bob": [0.0, -3.0]}
        table = {"duration": 1.0, "interaction": contact, "surface": [surface, lower]}
        layout = lay_out(scene_from(table))
        q, _ = np.split(layout.start, 2)
        first = layout.asperites.dof_bath[:3]
        for axis, (name, moved) in enumerate((("x", -sideways), ("y", -along))):
            held = drive == "bars"  # in place, whatever the swing
            bars = np.broadcast_to(given.get(name, 0.0), 3) + (0.0 if held else moved)
            for oscillator in range(2):
                if not np.allclose(q[first + 2 * axis + oscillator], bars, 0.0, 1e-14):
                    return f"{name} of oscillators below the drive {drive}"
    return ""


def partners() -> str:
    """Bobs of the two kinds of a contact are partners of one another; without kinds, all are."""
    from tribo.kernels.neighbours import is_partner, partner_species

    species = np.array([0, 1, 2, 1])
    for kinds in ((-1, -1), (0, 1), (1, 0), (1, 1), (2, 1)):
        for i, j in np.ndindex(4, 4):
            found = is_partner(species, partner_species(species, kinds, i), j)
            pair = sorted((species[i], species[j]))
            if found != (kinds == (-1, -1) or pair == sorted(kinds)):
                return f"bobs {i} and {j} of {species} for {kinds}"
    none = np.zeros(0)
    if not is_partner(none, partner_species(none, (0, 1), 2), 3):
        return "a scene without species"
    return ""


def short_rows() -> str:
    """The beginning of an array is sorted, and the rest is as it was."""
    from tribo.kernels.cells import sort_row

    rng = np.random.default_rng(8)
    for count in (0, 1, 2, 7, 9):
        row = rng.permutation(9)
        expected = np.concatenate([np.sort(row[:count]), row[count:]])
        sort_row(row, count)
        if not np.array_equal(row, expected):
            return f"the first {count}"
    return ""


FORMULAS = {
    "arguments of a drive": arguments_of_a_drive,
    "errors": errors,
    "errors of a pair": errors_of_a_pair,
    "steps of a pair towards encounters": steps_towards_encounters,
    "closing speeds": closing_speeds,
    "listed pairs of two clouds": listed_pairs,
    "columns by slot": columns_by_slot,
    "given starts": given_starts,
    "cold baths": cold_baths,
    "cells": cells,
    "boxes within reach": boxes_within_reach,
    "lists in chunks": lists_in_chunks,
    "one bob that crosses": one_bob_that_crosses,
    "partners": partners,
    "short rows": short_rows,
}
