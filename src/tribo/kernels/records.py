"""The flat data that compiled code reads: tables with one column an asperite.

Lengths, times and masses are plain floats.  Positions are relative to the scene's origin and
velocities to the first surface's, so no digits are lost in a distant scene or a fast frame.
:mod:`tribo.ledger.ledger` computes the quantities in the laboratory.
"""

from typing import Any, NamedTuple

import numpy as np

# The groups of accounts, see `kernels.powers`.
GROUPS = (
    *("acc_contact", "acc_slide", "acc_drive", "acc_ends", "acc_user_ends"),
    *("acc_internal", "acc_field", "acc_thermal", "acc_swing"),
)

# What each asperite is and where its numbers stand, for code outside of the kernels.  A slot of -1
# means that the asperite has no such degree of freedom, or no such account.
ASPERITE = np.dtype(
    [
        ("mass", "f8"),  # m1 + m2
        ("inertia", "f8"),  # m1 l1^2 + m2 l2^2, about the centre of mass
        ("kappa", "f8"),  # torsion stiffness
        ("l1", "f8"),  # centre of mass to bob
        ("l2", "f8"),  # centre of mass to bar
        ("i2", "f8"),  # the bar's moment of inertia
        ("bar_length", "f8"),
        ("pivot", "f8"),  # on driven bars l2, from the bar to the centre of mass; else 0
        ("arm_x", "f8"),  # of bars of a block that tilts, from the mean of their places; else 0
        ("arm_y", "f8"),
        ("facing", "f8"),  # +1 hangs down (rest angle 0), -1 stands up (rest angle pi)
        ("x", "f8"),  # centre of mass at t = 0
        ("y", "f8"),
        ("vx", "f8"),  # the surface's initial velocity
        ("vy", "f8"),
        ("phi", "f8"),  # the bar's angle at t = 0; with nu, the motion of a clamped bar
        ("nu", "f8"),
        ("surface", "i4"),
        ("stride", "i4"),  # from one account of a group to the next
        ("dof_x", "i4"),  # slots in the vector of coordinates; the swing's slot is the index
        ("dof_y", "i4"),
        ("dof_phi", "i4"),
        ("dof_bath", "i4"),  # first of its bath's: all x, all y, then the torsional
        *((group, "i4") for group in GROUPS),  # first slots in the vector of accounts
    ],
    align=True,
)

# Rows of the table of constants that kernels read.  Asperites that are alike share one block of
# its columns, see `kernels.blocks.column_of_constants`; others have a column each.  On driven bars
# they refer to the bar's centre, see `kernels.levers`; rigid asperites have an infinite inertia.
# phi, with its sine and cosine, and nu are those at the start.  The frequency is that of the
# torsion spring's rotation, of the pendulum and, if that can turn, of the bar.  Inverses are here
# since a product takes a third of the time of a division.
CONSTANTS = (
    *("mass", "inertia", "kappa", "l1", "l2", "i2", "bar_length", "phi", "nu", "sin_phi"),
    *("cos_phi", "frequency", "inverse_mass", "inverse_inertia", "inverse_bar_length"),
)
MASS, INERTIA, KAPPA, L1, L2, I2, BAR_LENGTH, PHI_START, NU_START, SIN_PHI, COS_PHI = range(11)
FREQUENCY, INVERSE_MASS, INVERSE_INERTIA, INVERSE_BAR_LENGTH = range(11, len(CONSTANTS))

# Rows of the table of constants that differ between asperites that are alike otherwise, one column
# an asperite.  Those that fill the last block of a surface are not present, 0 instead of 1: no
# drive or friction acts on them.
X_START, Y_START, Z, CHARGE, PRESENT = range(5)
EACH_ROWS = 5

# Numbers of a surface that may follow a schedule; see `tribo.layout.legs`.
SCHEDULED = ("stage", "load", "push", "heat", "swing_heat")

FORCED, FREE, RIGID, PULLED, CUSTOM, BARS, PUSHED, MOVED = range(8)

# What a surface whose bars are one rigid body consists of, see `kernels.rigid_block`; else 0.  Bars
# that follow a given motion are such a body where pendulums swing on them.
RIGID_ASPERITES, PENDULUMS = 1, 2

# How the forces of an elastic body are found, see `kernels.elastic`; else 0.
PAIRS, WAVES = 1, 2

SURFACE = np.dtype(
    [
        ("start", "i8"),  # columns start <= i < stop
        ("stop", "i8"),
        ("end", "i8"),  # columns from here to `stop` fill its last block
        ("facing", "f8"),  # +1 hangs down, -1 stands up
        ("vx", "f8"),  # its initial velocity, relative to the first surface's
        ("vy", "f8"),
        ("turning", "i8"),  # 1 where clamped bars turn
        ("tilted", "i8"),  # 1 where the angles of bars at the start, or their rates, are not 0
        ("drive", "i8"),  # FORCED, FREE, RIGID, PULLED, CUSTOM, BARS, PUSHED, MOVED
        ("user_ends", "i8"),  # 1 where a plug-in exerts the forces on the ends of bars
        ("fixed", "i8"),  # 1 where pendulums are fixed to their bars: rigid asperites
        ("mass", "f8"),  # of all its asperites
        ("total_mass", "f8"),  # of all its asperites and their baths
        ("inverse_total_mass", "f8"),
        ("loaded", "i8"),  # 1 where a load or a push takes the place of -f1_y
        ("load", "f8"),  # the y force on each bar at t = 0
        ("load_rate", "f8"),  # and its growth
        ("push", "f8"),  # the x force on each pushed bar at t = 0
        ("push_rate", "f8"),  # and its growth
        ("stiffness", "f8"),  # of the pulling spring
        ("speed", "f8"),  # of the pulling stage, relative to the surface's initial velocity
        ("anchor", "f8"),  # displacement of the pulling stage at t = 0
        ("block", "i8"),  # RIGID_ASPERITES, PENDULUMS; the drive's numbers are a bar's share
        ("tilting", "i8"),  # 1 where the rigid body turns about z, see `kernels.tilting_block`
        ("elastic", "i8"),  # PAIRS, WAVES; 0 without an elastic body
        ("elastic_row", "i8"),  # first row of its pairs, or place in the grid, of `Elastic`
        ("elastic_block", "i8"),  # 1 where the drive acts on the bars by their shares, `Elastic`
        ("stiffness_y", "f8"),  # of the pulling spring along y
        ("damping", "f8"),  # of the damper beside the pulling spring
        ("damping_y", "f8"),  # of the same along y
        ("ax", "f8"),  # acceleration of a rigid body, or place of an elastic one, scratch
        ("ay", "f8"),
        ("alpha", "f8"),  # angular acceleration and velocity of a body that tilts, scratch
        ("rate", "f8"),
        # Rows of the table of schedules that take the place of these numbers; 0 where none does.
        # A stage's is that of its displacement from `anchor`, and "heat" is the temperature.  Of
        # a surface with a given motion, "push" and "load" are its velocities along x and y.
        *((f"{name}_schedule", "i8") for name in SCHEDULED),
        ("fx", "f8"),  # sum of the contact forces' x components, scratch
        ("oscillators", "i8"),  # its bath's rows: first <= n < first + oscillators, on every bar
        ("first_oscillator", "i8"),
        ("torsionals", "i8"),
        ("first_torsional", "i8"),
        ("gamma", "f8"),  # Langevin damping of every bar, 0 if there is none
        ("swing_gamma", "f8"),  # the same of every swing
        ("temperature", "f8"),  # of the Langevin reservoir at the bars
        ("swing_temperature", "f8"),  # of that on the swings
        ("reservoir_x", "f8"),  # its velocity, relative to the surface's initial one
        ("reservoir_y", "f8"),
        ("dof_x", "i8"),  # slots of its first asperite, as in ASPERITE; -1 if absent
        ("dof_y", "i8"),
        ("dof_phi", "i8"),
        ("dof_bath", "i8"),
        ("first_constants", "i8"),  # column of the constants of its first asperite
        ("constants_mask", "i8"),  # of an asperite's place in its surface: its constants' place
        ("account_stride", "i8"),  # from one account of a group to the next
        ("account_mask", "i8"),  # of an asperite's place in its surface: its place in an account
        *((group, "i8") for group in GROUPS),  # those of its first asperite
        ("acc_block", "i8"),  # account of the surface's own pseudowork, -1 if absent
        # Of the work of a stage that follows a schedule, at its velocity relative to the surface's.
        ("acc_stage", "i8"),
    ],
    align=True,
)

# Numbers of surfaces in which members of an ensemble may differ, and their rows of a table that has
# a column for each asperite of each member.
OF_MEMBERS = (
    *("vx", "vy", "load", "stiffness", "speed"),
    *("gamma", "swing_gamma", "temperature", "swing_temperature"),
)
OWN_VX, OWN_VY, OWN_LOAD, OWN_STIFFNESS, OWN_SPEED = range(5)
OWN_GAMMA, OWN_SWING_GAMMA, OWN_TEMPERATURE, OWN_SWING_TEMPERATURE = range(5, len(OF_MEMBERS))

# Rows of a table of places, directions or forces in the plane.
X, Y = range(2)

# Rows of a table of bath oscillators, whose masses are inertias if they are torsional.
OSCILLATOR_MASS, OSCILLATOR_FREQUENCY = range(2)

# How far a run has come; kept in an array of one, so that a kernel can go on where it stopped.
CLOCK = np.dtype(
    [
        ("t", "f8"),
        ("t_low", "f8"),  # what rounding took from t
        ("drift_lag", "f8"),  # time by which a splitting method's drift is behind t
        ("encounter_fraction", "f8"),  # of the way to the next encounter that a step may go
        ("encounter_rate", "f8"),  # [1 / time], as it was last computed
        ("encounter_age", "f8"),  # time since equal steps computed it
        ("clearance", "f8"),  # no pair can move less before its force changes considerably
        ("h", "f8"),  # the step the controller wants next; 0: not chosen yet
        ("last_step", "f8"),  # 0: none yet
        ("sample", "i8"),  # next sample to be recorded
        ("steps", "i8"),
        ("rejected", "i8"),
        ("after_rejection", "i8"),  # 1: the next step may not grow
        ("not_finite", "i8"),  # 1: the last step that was tried led to values that are not finite
        ("evaluations", "i8"),  # of all forces
        ("passages", "i8"),  # steps in which bobs passed an encounter that cannot matter
        ("passing", "i8"),  # the bobs that did so last
        ("passed", "i8"),
        ("leg", "i8"),  # kinks of schedules that were passed
    ],
    align=True,
)


# Lattice springs between bars i + n and j + n, n < count, of one surface.
CHAIN = np.dtype(
    [
        ("i", "i8"),
        ("j", "i8"),
        ("count", "i8"),
        ("first", "i8"),  # column of the table of springs
        ("surface", "i8"),
    ],
    align=True,
)

# Rows of the table of springs, one column a spring: the vector is r2_i - r2_j of the bars at rest,
# less the rest vector of the spring.
STIFFNESS, REST_X, REST_Y = range(3)


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
    clearance: np.ndarray  # (n,) units that find how far bobs may move before their force changes
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
    """The blocks that are stepped; all others are inactive, see `integrators.inactive`.

    All blocks are stepped where `blocks` is empty.
    """

    blocks: np.ndarray  # column / LANES of the active blocks, surface after surface, ascending
    first: np.ndarray  # (surfaces + 1,) place of each surface's first one in `blocks`
    since: np.ndarray  # (blocks,) time that each inactive block has reached; nan of active ones
    eligible: np.ndarray  # (surfaces,) 1 where the motion without contact is known
    place: np.ndarray  # (2, n) positions of the bobs when the active blocks were selected
    selected: np.ndarray  # (1,) when that was [time]; nan before
    margin: float  # by which inactive blocks are farther away than the list reaches [length]


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
    """Lists of the blocks of bobs that may be within reach, row by row in the order of the bobs.

    A row belongs to a bob of a pair's first surface and lists blocks of its second, in ascending
    order, so sums over the list are bit for bit the sums over all pairs.  There may be no rows.
    """

    pairs: np.ndarray  # (m, 3) first and second surface of each listed pair, and its first row
    species: np.ndarray  # (m, 2) between bobs of which species; -1: of any
    reach: np.ndarray  # (m,) largest distance listed, cutoff plus skin [length]
    start: np.ndarray  # (rows + 1,) first place of each row in `index`
    index: np.ndarray  # blocks: column / LANES; rows that end beyond its room are not used
    place: np.ndarray  # (2, n) positions of the bobs when the list was built; nan before
    skin: float  # by which the list reaches farther than the cutoff [length]
    made: np.ndarray  # (1,) number of times that the list was built
    crossed: np.ndarray  # (1,) 1 after a drift in which a bob has crossed half the skin
    listed: np.ndarray  # (1,) when splitting methods built it last [time]; nan before
    active: Active
    own: Boxes  # around the active blocks of a pair's first surface, while its rows are filled
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
    # (n,), scratch: contact on rigid surfaces, where the lanes of a block are members of an
    # ensemble, one asperite of each; None where the asperites of a block are of one run.
    members: Any = None
    own: Any = None  # (numbers, n) of surfaces where members differ in them, see OF_MEMBERS
    team: Any = None  # Team, see `compiler.team`; None where a step is too short to be shared
    schedules: Any = None  # (1 + schedules, COLUMNS) in the first leg, see `kernels.schedule`


# Places in `Model.units` of the addresses of units: of what only some scenes need, lists of
# neighbours, baths, and the parts of splitting methods for these, reservoirs, plug-ins and threads;
# rigid and elastic bodies;
# and of drifts and kicks, which several loops and units share.
UNITS = (
    *("rebuild", "bath_forces", "torsional_accelerations", "bath_momenta", "torsional_powers"),
    *("bath_samples", "make_lists", "advance_inactive", "kick_around", "settle_custom_forces"),
    *("share_contacts", "share_step", "drift", "kick", "join_blocks"),
    *("elastic_forces", "elastic_energies"),
    *("rates", "powers", "speeds", "encounters", "sample"),
)
REBUILD, BATH_FORCES, TORSIONAL_ACCELERATIONS, BATH_MOMENTA, TORSIONAL_POWERS = range(5)
BATH_SAMPLES, MAKE_LISTS, ADVANCE_INACTIVE, KICK_AROUND, SETTLE_CUSTOM_FORCES = range(5, 10)
SHARE_CONTACTS, SHARE_STEP, DRIFT, KICK, JOIN_BLOCKS = range(10, 15)
ELASTIC_FORCES, ELASTIC_ENERGIES = range(15, 17)
RATES, POWERS, SPEEDS, ENCOUNTERS, SAMPLE = range(17, len(UNITS))


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
    # (n,), scratch: contact on rigid surfaces, where the lanes of a block are members of an
    # ensemble, one asperite of each; empty where the asperites of a block are of one run.
    members: np.ndarray
    own: np.ndarray  # (numbers, n) of surfaces where members differ in them, see OF_MEMBERS
    schedules: np.ndarray  # (rows, COLUMNS) in the present leg, see `kernels.schedule`
