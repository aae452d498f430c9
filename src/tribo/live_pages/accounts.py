"""What the quantities of pairs and of rows share: forces' accounts, energies and powers."""

from typing import Any, NamedTuple

from tribo.compiler.jit import inlined, kernel
from tribo.ledger.quantities import EVERY_QUANTITY

# What only pages show, with its dimension; others are in tribo.ledger.quantities.
ONLY_HERE = {
    **dict.fromkeys(("p1", "p1_cm", "p2", "p2_cm"), "power"),
    **dict.fromkeys(("vx_bob", "vy_bob", "vx_bar", "vy_bar"), "velocity"),
    "distance": "length",
    "energy_bath": "energy",
}
DIMENSIONS = ("angle", "rate", "length", "velocity", "energy", "force", "power")


def dimension_of(name: str) -> int:
    """The place of a quantity's dimension among DIMENSIONS."""
    own = ONLY_HERE.get(name)
    return DIMENSIONS.index(own if own is not None else EVERY_QUANTITY[name].kind)


class Energies(NamedTuple):
    """Energies, and works on a surface as a whole, with the names of a ledger."""

    delta_k_trans: Any
    delta_e_int: Any
    swing_energy: Any
    W: Any
    W_ps: Any
    delta_K: Any
    delta_E_int: Any
    friction_work: Any
    k_trans: Any
    k_swing: Any
    e_torsion: Any


class Powers(NamedTuple):
    """Powers of the contact force at the bob and of the drive at the bar, and both at the centre.

    The centre is that of mass.
    """

    p1: Any
    p1_cm: Any
    p2: Any
    p2_cm: Any


class Entry(NamedTuple):
    """One force's account: see :class:`tribo.ledger.accounts.Account`."""

    about: Any
    jx: Any
    jy: Any
    pseudo: Any


@inlined
def boost(side, entry):
    return side.vx * entry.jx + side.vy * entry.jy


@inlined
def pseudowork(side, entry):
    return entry.pseudo + boost(side, entry)


@inlined
def work(side, entry):
    return entry.about + pseudowork(side, entry)


@inlined
def total(*entries):
    about = jx = jy = pseudo = 0.0
    for entry in entries:
        about += entry.about
        jx += entry.jx
        jy += entry.jy
        pseudo += entry.pseudo
    return Entry(about, jx, jy, pseudo)


@kernel
def powers_of(forces, moving):
    """The powers of two forces, from these and from velocities."""
    return Powers(
        forces.f1_x * moving.vx_bob + forces.f1_y * moving.vy_bob,
        forces.f1_x * moving.vx_cm + forces.f1_y * moving.vy_cm,
        forces.f2_x * moving.vx_bar + forces.f2_y * moving.vy_bar,
        forces.f2_x * moving.vx_cm + forces.f2_y * moving.vy_cm,
    )
