"""Rows, columns and fields of the flat tables that compiled code reads, one column an asperite.

Lengths, times and masses are plain floats.  Positions are relative to the scene's origin and
velocities to the first surface's, so no digits are lost in a distant scene or a fast frame.
:mod:`tribo.ledger.ledger` computes the quantities in the laboratory.
"""

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

# Rows of the table of constants that kernels read.  Asperites that are alike share one pack of
# its columns, see `kernels.packs.column_of_constants`; others have a column each.  On driven bars
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
# an asperite.  Those that fill the last pack of a surface are not present, 0 instead of 1: no
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
        ("end", "i8"),  # columns from here to `stop` fill its last pack
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

# Places in `Model.units` of the addresses of units: of what only some scenes need, lists of
# neighbours, baths, and the parts of splitting methods for these, reservoirs, plug-ins and threads;
# rigid and elastic bodies; and of drifts and kicks, which several loops and units share.
UNITS = (
    *("rebuild", "bath_forces", "torsional_accelerations", "bath_momenta", "torsional_powers"),
    *("bath_samples", "make_lists", "advance_inactive", "kick_around", "settle_custom_forces"),
    *("share_contacts", "share_step", "drift", "kick", "join_blocks"),
    *("elastic_forces", "elastic_energies", "rotate_baths", "damp"),
    *("rates", "powers", "speeds", "encounters", "sample"),
)
REBUILD, BATH_FORCES, TORSIONAL_ACCELERATIONS, BATH_MOMENTA, TORSIONAL_POWERS = range(5)
BATH_SAMPLES, MAKE_LISTS, ADVANCE_INACTIVE, KICK_AROUND, SETTLE_CUSTOM_FORCES = range(5, 10)
SHARE_CONTACTS, SHARE_STEP, DRIFT, KICK, JOIN_BLOCKS = range(10, 15)
ELASTIC_FORCES, ELASTIC_ENERGIES, ROTATE_BATHS, DAMP = range(15, 19)
RATES, POWERS, SPEEDS, ENCOUNTERS, SAMPLE = range(19, len(UNITS))
