"""Where the powers of a state are added up: the accounts of the ledger, group by group.

`kernels/powers.py` computes the powers of each group, and `ledger/accounts.py` reads the accounts.
The accounts of a group stand one after another, each with a slot for every asperite of the surface.
Where a scene asks for sums over surfaces, each has a slot for every lane, in which the powers of a
surface's packs are added up; contact and drive then have their levers in the work about the centre
of mass.  Without a ledger there are none.
"""

from typing import Any, NamedTuple

import numpy as np

from tribo.compiler.jit import inlined
from tribo.compiler.lanes import lane
from tribo.compiler.lanes_memory import add_pack

# Number of accounts in each group, as `powers` lists them; POINT is that of internal, field and
# thermal.
CONTACT = 4
SLIDE = 2
DRIVE = 4
ENDS = 5
USER_ENDS = 8
POINT = 4
SWING = 1


@inlined
def place_of(s, slot, i):
    """Place of asperite i in an account that begins at `slot`."""
    return slot + ((i - s.start) & s.account_mask)


class Powers(NamedTuple):
    """Where powers are added up, as the works that they do in a time."""

    accounts: np.ndarray  # (accounts,)
    tau: Any  # [time]; one for the powers themselves


@inlined
def add_total(members, accounts, k, x):
    """Add a total, as `packs.totals` has it, to one account; or that of each member to its own."""
    if members.size > 0:
        add_pack(accounts, k, x)
    else:
        accounts[k] += lane(x, 0)


@inlined
def add_powers(power, s, slot, i, *powers):
    """Add powers of a pack to its accounts from `slot` on."""
    k = place_of(s, slot, i)
    for x in powers:
        add_pack(power.accounts, k, power.tau * x)
        k += s.account_stride


@inlined
def add_works(accounts, s, slot, i, *works):
    """Add works of a pack to its accounts from `slot` on."""
    k = place_of(s, slot, i)
    for x in works:
        add_pack(accounts, k, x)
        k += s.account_stride
