"""A scene as compiled code reads it: the model, a structure of arrays, and its parts.

The rows of its tables are those of `records`.
"""

from typing import Any, NamedTuple

import numpy as np


class Contact(NamedTuple):
    """One interaction: a potential, and the pairs of surfaces between which it acts.

    A pair that names one surface twice is contact among that surface's bobs.
    """

    potential: Any
    pairs: np.ndarray  # (n, 2) indices of surfaces, the first not above the second
    rows: np.ndarray  # (n,) first row of each pair in the neighbour list; -1: all pairs
    species: Any  # (2,) between bobs of which species; None: of any
    within: Any = None  # True where it acts among the bobs of one surface
    numbers: Any = None  # (fields, 8) of the potential, where members of an ensemble differ in them


class Contacts(NamedTuple):
    """All interactions, those within surfaces last, and the units of their potentials.

    Units and numbers are addresses, see :mod:`tribo.compiler.units`.
    """

    forces: np.ndarray  # (n,) units that add forces on bobs
    pieces: np.ndarray  # (n,) units that do a piece of that; 0 where no threads share it
    energy: np.ndarray  # (n,) units that find the energy at a distance
    clearances: np.ndarray  # (n,) units that find how far bobs may move before a force changes
    numbers: np.ndarray  # (n,) of the potentials
    memory: np.ndarray  # where these are
    feature: np.ndarray  # (n,) shortest length over which a force changes [length]
    within: np.ndarray  # (n,) 1 where it acts among the bobs of one surface
    species: np.ndarray  # (n, 2) between bobs of which species; -1: of any
    first: np.ndarray  # (n + 1,) the first pair of each
    pairs: np.ndarray  # (pairs, 2) indices of surfaces, the first not above the second
    rows: np.ndarray  # (pairs,) first row of each pair in the neighbour list; -1: all pairs


class Acting(NamedTuple):
    """One of all interactions, in a unit of its potential."""

    potential: Any  # None outside of it
    box: Any  # Box; None where space is known to be open
    species: Any  # (n,) of each bob; None where it is known not to matter
    kinds: np.ndarray  # (2,) between bobs of which species; -1: of any
    first: int  # its pairs are first <= k < stop
    stop: int
    pairs: np.ndarray  # (pairs, 2) of all interactions
    rows: np.ndarray  # (pairs,)


class FieldOn(NamedTuple):
    """One external field, and the surfaces on whose bobs it acts."""

    potential: Any
    surfaces: np.ndarray  # (n,) indices
    origin: np.ndarray  # (2,) of the scene, in the field's own frame at t = 0
    velocity: np.ndarray  # (2,) of the first surface, in the field's own frame
    drift: np.ndarray  # (2,) velocity of the field in the laboratory
    anchor: np.ndarray  # (2,) displacement of the field at t = 0, included in `origin`
    account: int  # of the work done by moving or modulating it; -1 where it stands
    modulation: int = 0  # row of the schedule of its factor; 0 where that is 1
    begun: float = 0.0  # when its own time was zero


class Fields(NamedTuple):
    """All external fields, as :class:`FieldOn` has each, and the units of their potentials."""

    forces: np.ndarray  # (n,) units that add forces on bobs
    energy: np.ndarray  # (n,) units that find the energy of the bobs
    power: np.ndarray  # (n,) units that find the power of moving it
    numbers: np.ndarray  # (n,) addresses of the potentials' numbers
    memory: np.ndarray  # where these are
    first: np.ndarray  # (n + 1,) the first surface of each, in `surfaces`
    surfaces: np.ndarray
    origin: np.ndarray  # (n, 2)
    velocity: np.ndarray  # (n, 2)
    drift: np.ndarray  # (n, 2)
    account: np.ndarray  # (n,)
    modulation: np.ndarray  # (n,)
    begun: np.ndarray  # (n,)


class Custom(NamedTuple):
    """A plug-in's force on the bars of one surface, or on their ends."""

    plugin: Any
    surface: int
    origin: np.ndarray  # (2,) of the scene, in the laboratory
    velocity: np.ndarray  # (2,) of the first surface, in the laboratory
    begun: float = 0.0  # when the plug-in's own time was zero


class Customs(NamedTuple):
    """All of these at one place, bars or their ends, as :class:`Custom` has each."""

    forces: np.ndarray  # (n,) units that set the forces
    numbers: np.ndarray  # (n,) addresses of the plug-ins' numbers
    memory: np.ndarray  # where these are
    surface: np.ndarray  # (n,)
    origin: np.ndarray  # (n, 2)
    velocity: np.ndarray  # (n, 2)
    begun: np.ndarray  # (n,)


class Calculator(NamedTuple):
    """Contact that is computed outside of the kernels, for all bobs of some surfaces at once."""

    address: int  # of a function without arguments that sets `forces` and `energy`
    columns: np.ndarray  # (m,) of the surfaces' bobs
    positions: np.ndarray  # (m, 2) x and y of these, set before the call
    forces: np.ndarray  # (m, 2) on each of them
    energy: np.ndarray  # (1,) their potential energy


class Elastic(NamedTuple):
    """The elastic bodies under the bars of surfaces, see `kernels.elastic`.

    Grids of many bars follow one another in `grid`, and their waves in `waves`.
    """

    pairs: np.ndarray  # (rows, 4 LANES) K between few bars, after a row of 0
    # (4, n) of each bar of a block: what it takes of a drive that is shared alike, xx, xy, yx, yy.
    shares: np.ndarray
    columns: np.ndarray  # (bars,) columns of the bars of grids
    grid: np.ndarray  # (2, bars) scratch: their displacements, or K times these
    waves: np.ndarray  # (2, 2 waves) scratch: complex numbers, the transforms of these
    stiffness: np.ndarray  # (3, waves) K_xx, K_yy, K_xy / i
    calls: np.ndarray  # (2,) addresses of functions that transform the grids, and back


class Box(NamedTuple):
    """Lengths of a periodic scene; 0 where it is not."""

    x: float
    z: float


class Active(NamedTuple):
    """The packs that are stepped; all others are inactive, see `integrators.inactive`.

    All packs are stepped where `packs` is empty.
    """

    packs: np.ndarray  # column / LANES of the active packs, surface after surface, ascending
    first: np.ndarray  # (surfaces + 1,) place of each surface's first one in `packs`
    since: np.ndarray  # (packs,) time that each inactive pack has reached; nan of active ones
    eligible: np.ndarray  # (surfaces,) 1 where the motion without contact is known
    place: np.ndarray  # (2, n) positions of the bobs when the active packs were selected
    selected: np.ndarray  # (1,) when that was [time]; nan before
    margin: float  # by which inactive packs are farther away than the list reaches [length]


class Boxes(NamedTuple):
    count: np.ndarray  # (1,) how many there are
    centres: np.ndarray  # (3, room) x, y and z
    halves: np.ndarray  # (3, room) half widths


class Cells(NamedTuple):
    """Points, sorted into rectangular cells in x and z."""

    corner: np.ndarray  # (2,) lowest x and z
    widths: np.ndarray  # (2,)
    counts: np.ndarray  # (2,) of cells along x and z
    first: np.ndarray  # (2 room + 17,) place of each cell's first point in `order`
    order: np.ndarray  # (room,) points, cell after cell, and ascending in each
    cell: np.ndarray  # (room,) of each point


class Neighbours(NamedTuple):
    """Lists of the packs of bobs that may be within reach, row by row in the order of the bobs.

    A row belongs to a bob of a pair's first surface and lists packs of its second, in ascending
    order, so sums over the list are bit for bit the sums over all pairs.  There may be no rows.
    """

    pairs: np.ndarray  # (m, 3) first and second surface of each listed pair, and its first row
    species: np.ndarray  # (m, 2) between bobs of which species; -1: of any
    reach: np.ndarray  # (m,) largest distance listed, cutoff plus skin [length]
    start: np.ndarray  # (rows + 1,) first place of each row in `index`
    index: np.ndarray  # packs: column / LANES; rows that end beyond its room are not used
    place: np.ndarray  # (2, n) positions of the bobs when the list was built; nan before
    skin: float  # by which the list reaches farther than the cutoff [length]
    made: np.ndarray  # (1,) number of times that the list was built
    crossed: np.ndarray  # (1,) 1 after a drift in which a bob has crossed half the skin
    listed: np.ndarray  # (1,) when splitting methods built it last [time]; nan before
    active: Active
    own: Boxes  # around the active packs of a pair's first surface, while its rows are filled
    others: Boxes  # of its second one
    cells: Cells  # those of the second


class Springs(NamedTuple):
    chains: Any  # recarray of CHAIN
    table: np.ndarray  # (3, springs), see STIFFNESS


class Tables(NamedTuple):
    """A scene as tables: what is common to all its runs.  An effect that is absent is None.

    Scratch is True where a loop needs it; each time loop has arrays of its own in its place, and
    columns `fx`, in a :class:`Model` of these tables.
    """

    constants: np.ndarray  # (rows, columns of constants), see CONSTANTS
    each: np.ndarray  # (EACH_ROWS, n), see X_START
    surfaces: Any  # recarray of SURFACE
    core: int  # number of the asperites' coordinates, before those of baths
    contacts: tuple  # of Contact, those within surfaces last
    bobs: Any  # (2, n), scratch: place of each bob
    directions: Any  # (2, n), scratch: the unit vector along which a growing theta moves it
    f1: Any  # (2, n), scratch: contact force on it
    drive: Any  # (2, n), scratch: f2 on each bar
    ledger: Any = None  # True, or None where no works are kept
    sums: Any = None  # True where accounts are sums over asperites
    calculators: Any = None  # tuple of Calculator
    species: Any = None  # (n,) of each bob, floats
    inner: Any = None  # (2, n), scratch: contact within on each bob
    external: Any = None  # (2, n), scratch: external fields on each bob
    internal: Any = None  # (2, n), scratch: springs and bath on each bar
    displaced: Any = None  # (2, n), scratch: displacement of each bar from its rest
    friction: Any = None  # (2, n), scratch: Langevin friction on each bar without noise
    swing_friction: Any = None  # (1, n), scratch: the same torque on each swing
    # (1, columns of constants), see `kernels.levers`; None without driven bars or such blocks.
    pivots: Any = None
    arms: Any = None  # (2, n) of each bar of a block that tilts; None without any
    turned: Any = None  # (2, n), scratch: the same, turned by the tilt
    couples: Any = None  # (1, n), scratch: torque of the constraint on each bar of such a block
    left: Any = None  # (2, n), scratch: a plug-in's force on the left end of each bar
    right: Any = None  # (2, n), scratch: on its right end
    box: Any = None  # Box
    springs: Any = None  # Springs
    bath: Any = None  # (2, oscillators), see OSCILLATOR_MASS
    bath_momentum: Any = None  # (2, n), scratch: of the oscillators on each bar
    torsional: Any = None  # (2, oscillators) whose masses are inertias
    fields: Any = None  # tuple of FieldOn
    drives: Any = None  # tuple of Custom
    ends: Any = None  # tuple of Custom
    # (n,), scratch: contact on rigid surfaces, where the lanes of a pack are members of an
    # ensemble, one asperite of each; None where the asperites of a pack are of one run.
    members: Any = None
    own: Any = None  # (numbers, n) of surfaces where members differ in them, see OF_MEMBERS
    team: Any = None  # Team, see `compiler.team`; None where a step is too short to be shared
    schedules: Any = None  # (1 + schedules, COLUMNS) in the first leg, see `kernels.schedule`


class Model(NamedTuple):
    """A scene for kernels: a structure of arrays, whose rows are contiguous.

    It has the same type for all scenes, so that kernels are compiled once.  Arrays of an effect
    that is absent have no columns, and what belongs to it is skipped surface by surface.
    """

    constants: np.ndarray  # (rows, columns of constants), see CONSTANTS
    each: np.ndarray  # (EACH_ROWS, n), see X_START
    surfaces: Any  # recarray of SURFACE
    core: int  # number of the asperites' coordinates, before those of baths
    units: np.ndarray  # (UNITS,) addresses; 0 of those that the scene does not need
    contacts: Contacts
    fields: Fields
    drives: Customs  # of bars
    ends: Customs  # of the ends of bars
    bobs: np.ndarray  # (2, n), scratch: place of each bob
    directions: np.ndarray  # (2, n), scratch: the vector along which a growing theta moves it
    f1: np.ndarray  # (2, n), scratch: contact force on it
    drive: np.ndarray  # (2, n), scratch: f2 on each bar
    inner: np.ndarray  # (2, n), scratch: contact within on each bob
    external: np.ndarray  # (2, n), scratch: external fields on each bob
    internal: np.ndarray  # (2, n), scratch: springs and bath on each bar
    displaced: np.ndarray  # (2, n), scratch: displacement of each bar from its rest
    friction: np.ndarray  # (2, n), scratch: Langevin friction on each bar without noise
    swing_friction: np.ndarray  # (1, n), scratch: the same torque on each swing
    turned: np.ndarray  # (2, n), scratch: arms of blocks that tilt, turned by the tilt
    couples: np.ndarray  # (1, n), scratch: torque of the constraint on each bar of such a block
    left: np.ndarray  # (2, n), scratch: a plug-in's force on the left end of each bar
    right: np.ndarray  # (2, n), scratch: on its right end
    bath_momentum: np.ndarray  # (2, n), scratch: of the oscillators on each bar
    found: np.ndarray  # (FOUND,), scratch: the next encounters, see `kernels.encounters`
    ledger: bool  # whether works are kept
    sums: bool  # whether accounts are sums over asperites
    shared: bool  # whether there are accounts that are of no asperite
    rigid: bool  # whether any surface moves by the sum of the contact forces on it
    on_bobs: bool  # whether other forces than contact with other surfaces act on bobs
    on_bars: bool  # whether other forces than f2 act on bars
    elastic: Elastic
    bodies: bool  # whether the bars of any surface stand on an elastic body
    blocks: bool  # whether the bars of any surface are one rigid body, see `kernels.rigid_block`
    species: np.ndarray  # (n,) of each bob, floats; empty where none matters
    pivots: np.ndarray  # (1, columns of constants), see `kernels.levers`
    arms: np.ndarray  # (2, n) of each bar of a block that tilts
    box: Box
    springs: Springs
    bath: np.ndarray  # (2, oscillators), see OSCILLATOR_MASS
    torsional: np.ndarray  # (2, oscillators) whose masses are inertias
    team: Any  # Team, see `compiler.team`; with no counters where a step is too short to be shared
    calculators: Any  # tuple of Calculator, or None
    # (n,), scratch: contact on rigid surfaces, where the lanes of a pack are members of an
    # ensemble, one asperite of each; empty where the asperites of a pack are of one run.
    members: np.ndarray
    own: np.ndarray  # (numbers, n) of surfaces where members differ in them, see OF_MEMBERS
    schedules: np.ndarray  # (rows, COLUMNS) in the present leg, see `kernels.schedule`
