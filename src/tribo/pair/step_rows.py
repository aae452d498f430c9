"""The rows and columns of the memory of the pair's loop."""

from tribo.compiler.lanes import LANES

# The loop's memory is an array of rows of eight numbers.  Rows of the method's table, whose
# coefficients are those of Collocation.  The first node is the start of a step, where nothing is to
# be found, so rows for all nodes have the end of the step in its place.
AT = 0  # times of the end and of nodes 1 to 7, in steps
NODES = 1  # times of all nodes, in steps
POLE = 2
B = 3
V = 4
LAST = 5
A = 6  # eight rows, one for each node: its weights in coordinates, b and a
AA = 14  # eight rows: the matrix of A times a, which applies the weights twice
R = 22  # eight rows, one for each node: its weights in velocities, v and r

# Rows of the limits: the tolerances of the rates, with the level and the first step, and the
# reciprocals of the tolerances of the accounts.
LIMITS = R + LANES
ALLOWED = R + LANES + 1

# Columns of LIMITS.
OF_V1, OF_V2, OF_J, LEVEL, FIRST = range(5)

# First row of the state.
STATE = ALLOWED + 1

# Rows of the state; MEMORY has three, the accelerations of the last step.
PLACE, LOW, START, ACCOUNTS, REMAINDERS, BEGINNING, SCRATCH, MEMORY = range(STATE, STATE + 8)

# Number of rows.
ROWS = MEMORY + 3

# Columns of PLACE, and of LOW with the rounding errors.  START and SCRATCH have q1'', q2'' and k''
# in the first three.
Q1, Q2, K, V1, V2, J = range(6)

# Column of START with the rate of encounters, behind the accelerations.
RATE = 3

# Accounts: integrals over time, where f is the force on the first bob.  J_Y: f_y.
# X1: f_x omega1 cos q1, Y1: f_y omega1 sin q1; X2, Y2 likewise.  T1: q1, T2: q2.  S: f_x j.
J_Y, X1, Y1, X2, Y2, T1, T2, S = range(8)
