"""The rounding of reported sums and differences, whose terms may be far larger than they are.

Where the terms of a change of energy, or of a work in the laboratory, nearly cancel, their rounding
is most of the error, and it may be the same in all runs that are compared.
"""

import numpy as np

from tribo.accuracy.force_rounding import rounding_of_forces
from tribo.accuracy.scales import EPSILON, largest
from tribo.kernels.samples import BATH, SPRINGS, TORSIONAL, WITHIN
from tribo.layout.layout import Layout, once_per_layout
from tribo.ledger import quantities
from tribo.ledger.accounts import FORCES, Accounts, OfAccounts, Part, forces_with_accounts
from tribo.ledger.motion import Motion
from tribo.ledger.row_products import row_product
from tribo.model.fields import period_of
from tribo.potentials.potential import acting_charges

# Roundings of a term: those of the rates in it, of their squares, of products and of the sum.
TERM_ROUNDINGS = 4.0
# Effect of the rounding of a run, in units of sqrt(steps) roundings: three times the standard
# deviation of a random walk.  At one, one of 1000 random scenes had an error of 1.2 times its
# estimate; at two, one of 1500 had an error of 1.001 times.
WALK = 3.0
# Bobs of a surface of which the distances are looked at.
MOST_BOBS = 64
# Energies that samples store of a surface.
STORES = [SPRINGS, BATH, TORSIONAL, WITHIN]
# Terms of each force, and those of the reservoir's force behind them.
PARTS = 4
TERMS = PARTS * len(FORCES) + 2
# Sums over the asperites of each surface, and over all of the system.
OF_SURFACES = tuple(name for name, each in quantities.BLOCK_QUANTITIES.items() if each.terms)
APPLIED_WORK = "applied_work"


def _terms_of(quantity: OfAccounts) -> list[int]:
    """Places of the terms that a quantity sums."""
    found: list[int] = []
    for force in quantity.forces:
        for term in quantity.kind.terms:
            first = PARTS * list(FORCES).index(force) if term < PARTS else TERMS - PARTS - 2
            found.append(first + term)
    return found


def _table_of_sums() -> tuple[tuple[str, ...], np.ndarray]:
    """Names of quantities that are sums of terms, and which terms each has (terms, sums)."""
    sums = {name: each.terms for name, each in quantities.QUANTITIES.items() if each.terms}
    table = np.zeros((TERMS, len(sums)))
    for column, quantity in enumerate(sums.values()):
        table[_terms_of(quantity), column] = 1.0
    return tuple(sums), table


SUMS, MEMBERS = _table_of_sums()
# Whether each sum is over the asperites of a surface, or of the system.
IS_TOTAL = np.isin(SUMS, (*OF_SURFACES, APPLIED_WORK))


def rounding_of_terms(layout: Layout, motion: Motion, steps: int) -> dict[str, float]:
    """The rounding of the terms of energies and works, by quantity, in its own unit.

    Each term has some roundings of its own, and those of the run's `steps`, which add up like a
    random walk.  The motion is that of a run and of those that it is compared with.
    """
    samples = motion.samples
    span = layout.accounted
    forces, names, members = _acting(layout)
    magnitudes = np.abs(samples.linear("terms", lambda s: _terms(s[span], forces)))
    # The magnitudes of the terms of all accounts, summed: (times, asperites, sums).
    sums = row_product(magnitudes.reshape(-1, len(members)), members)
    sums = sums.reshape(*magnitudes.shape[:2], len(names))
    if layout.model.sums is not None:  # over lanes, of each surface
        whole = [sums[:, part].sum(axis=1) for part in layout.accounted_parts]
        sums = np.stack(whole, axis=1)
        parts = [slice(k, k + 1) for k in range(len(whole))]
    else:
        parts = list(layout.parts.values())
    highest = np.maximum.reduce(sums, axis=(0, 1))
    terms = dict(zip(names, highest.tolist(), strict=True))
    if sums.shape[1] > len(parts):  # else the sum over a surface is that of its one asperite
        for name in OF_SURFACES:
            each = sums[:, :, names.index(name)]
            terms[name] = max([largest(np.add.reduce(each[:, part], axis=1)) for part in parts])
    applied = np.add.reduce(sums[:, :, names.index(APPLIED_WORK)], axis=1)
    for slot in layout.accounts_of_fields:
        applied += np.abs(samples.s[:, slot])
    terms[APPLIED_WORK] = largest(applied)
    terms |= _of_energies(layout, motion)
    count = EPSILON * (TERM_ROUNDINGS + WALK * steps**0.5)
    found = {name: count * magnitude for name, magnitude in terms.items()}
    ends = _of_ends(layout, motion, count)
    motions = rounding_of_forces(layout, motion, steps)
    for roundings in (ends, motions, _of_cutoffs(layout)):
        for name, rounding in roundings.items():
            found[name] = found[name] + rounding if name in found else rounding
    return found


def _of_ends(layout: Layout, motion: Motion, count: float) -> dict[str, float]:
    """The rounding of the works of the ends of clamped bars, by quantity; `count` is of angles.

    They are differences of sin x - x cos x, with x the twist, whose terms may be far larger, with
    the same bits in all runs.  In sums of both ends they cancel.
    """
    stiffness = _stiffness_of_ends(layout)
    if stiffness is None:
        return {}
    a = motion.span.asperites
    twist = np.abs(motion.swing - motion.phi)
    sin = np.abs(np.sin(twist))
    rounding = TERM_ROUNDINGS * EPSILON * (sin + np.abs(twist * np.cos(twist)))
    rounding += count * twist**2 * sin  # of the twist itself
    rounding *= stiffness
    found: dict[str, float] = {}
    for kind, lever in (("", a.l2 + a.pivot), ("_ps", a.pivot)):
        each = rounding * lever
        if layout.model.sums is not None:
            each = np.stack([each[:, part].sum(axis=1) for part in layout.parts.values()])
        found |= dict.fromkeys((f"wL{kind}", f"wR{kind}"), largest(each))
    return found


@once_per_layout
def _stiffness_of_ends(layout: Layout) -> np.ndarray | None:
    """The torque of clamped ends by twist and length of the bar, (asperites,); None without any."""
    a = layout.together.asperites
    clamped = np.asarray(layout.surfaces)["acc_ends"][a.surface] >= 0
    return np.where(clamped, a.kappa / a.bar_length, 0.0) if clamped.any() else None


@once_per_layout
def _of_cutoffs(layout: Layout) -> dict[str, float]:
    """The rounding of what cutoffs subtract from energies, which may be far larger than these."""
    scene = layout.scene
    found = {"total_energy_change": 0.0}
    charge = max(float(np.abs(surface.each["charge"]).max()) for surface in scene.surfaces)
    for name, within in (("contact_energy", None), ("delta_E_int", True)):
        contacts = [contact for contact in layout.model.contacts if contact.within is within]
        energy = sum(contact.potential.energy_subtracted(charge) for contact in contacts)
        found[name] = TERM_ROUNDINGS * EPSILON * scene.count * energy
        found["total_energy_change"] += found[name]
    return found


@once_per_layout
def _acting(layout: Layout) -> tuple[tuple[str, ...], tuple[str, ...], np.ndarray]:
    """The forces that act on any asperite, the sums in which they are, and the terms of these.

    The table (terms, sums) is a part of MEMBERS.
    """
    # The terms of contact and drives are arrays, of zeros where a ledger has no accounts.
    acting = {"w1", "w2"} | forces_with_accounts(layout.accounted.present)
    forces = tuple([name for name in FORCES if name in acting])
    rows = [PARTS * list(FORCES).index(name) + part for name in forces for part in range(PARTS)]
    if "w_T" in forces:
        rows += [TERMS - 2, TERMS - 1]
    own = MEMBERS[rows]
    present = own.any(axis=0) | IS_TOTAL
    names = tuple([SUMS[place] for place in np.flatnonzero(present).tolist()])
    return forces, names, own[:, present]


def _terms(accounts: Accounts, forces: tuple[str, ...]) -> np.ndarray:
    """The terms of the accounts of some forces, (times, asperites, terms)."""
    vx, vy = accounts.span.velocity
    x, y = accounts.span.reservoir
    terms: list[Part] = []
    for name in forces:
        account = accounts[name]
        terms += [account.about, account.pseudo, vx * account.jx, vy * account.jy]
    if "w_T" in forces:
        thermal = accounts["w_T"]
        terms += [x * thermal.jx, y * thermal.jy]
    found = np.empty((*accounts.shape, len(terms)))
    for k, term in enumerate(terms):
        found[:, :, k] = term
    return found


def _of_energies(layout: Layout, motion: Motion) -> dict[str, float]:
    """The largest terms of energies, by quantity."""
    a = motion.span.asperites
    velocity = motion.span.velocity
    samples = motion.samples
    internal = motion.energy
    moving = motion.moving
    boost = a.mass * (np.abs(velocity[0] * motion.vx) + np.abs(velocity[1] * motion.vy))
    momentum = a.mass * np.hypot(motion.vx, motion.vy)
    whole = np.zeros(samples.t.size)
    within = 0.0
    bulk = 0.0
    stored = np.add.reduce(np.abs(samples.stored[:, :, STORES]), axis=2)
    masses, shortest_wave = _masses_and_wave(layout)
    for index, part in enumerate(layout.parts.values()):
        energy = np.add.reduce((internal + moving)[:, part], axis=1) + stored[:, index]
        p = np.add.reduce(momentum[:, part], axis=1)
        kinetic = p * (np.hypot(*velocity[:, part.start]) + p / masses[index])
        within = max(within, largest(energy))
        bulk = max(bulk, largest(kinetic))
        whole = whole + energy + kinetic
    # The rounding of a position is relative to its terms, and an energy changes over the length of
    # its potential.  The rounding of an angle of many turns moves the ends of its arms.
    x = np.abs(a.x) + np.abs(a.vx * motion.t) + np.abs(motion.x)
    y = np.abs(a.y) + np.abs(a.vy * motion.t) + np.abs(motion.y)
    turned = 1.0 + np.abs(motion.swing)
    farthest = np.maximum.reduce(np.hypot(x, y) + a.l1 * turned, axis=1)
    contact = np.abs(samples.contact) * (1.0 + farthest / _shortest_length(layout, motion))
    whole = whole + np.abs(samples.field) * (1.0 + farthest / shortest_wave)
    places = {}
    for end, arm in (("bob", a.l1), ("bar", a.l2)):
        places[f"x_{end}"] = largest(x + arm * turned)
        places[f"y_{end}"] = largest(y + arm * turned)
    return places | {
        "delta_e_int": largest(internal),
        "swing_energy": largest(motion.swinging),
        "delta_k_trans": largest(moving + boost),
        "delta_E_int": within,
        "delta_K": bulk,
        "contact_energy": largest(contact),
        "total_energy_change": largest(whole + contact),
    }


@once_per_layout
def _masses_and_wave(layout: Layout) -> tuple[list[float], float]:
    """The masses of the surfaces, and the shortest length over which a field's force changes."""
    declared = (period_of(field.potential) for field in layout.model.fields or ())
    periods = (period for period in declared if period is not None)
    masses = np.asarray(layout.surfaces)["mass"].tolist()
    return masses, min(periods, default=np.inf) / (2.0 * np.pi)


@once_per_layout
def _features(layout: Layout) -> list[float]:
    """The lengths that the potentials of contacts declare."""
    return [contact.potential.feature()[0] for contact in layout.model.contacts]


def _shortest_length(layout: Layout, motion: Motion) -> float:
    """The shortest length over which a contact's force changes; infinite without contacts."""
    lengths = list(_features(layout))
    sample = np.abs(motion.samples.contact).argmax()
    parts = list(layout.parts.values())
    x = motion.bob[0][sample]
    y = motion.bob[1][sample]
    for contact in layout.model.contacts:
        for i, j in contact.pairs:
            if i == j:
                continue
            one = parts[i]
            other = parts[j]
            dx = x[one][:MOST_BOBS, None] - x[other][:MOST_BOBS]
            dy = y[one][:MOST_BOBS, None] - y[other][:MOST_BOBS]
            nearest = np.minimum.reduce(np.hypot(dx, dy), axis=None)
            charges = acting_charges(contact.potential)
            lengths.append(float(contact.potential.clearance_between(nearest, *charges)))
    return min((length for length in lengths if length > 0.0), default=np.inf)
