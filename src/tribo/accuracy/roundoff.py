"""The rounding of reported sums and differences, whose terms may be far larger than they are.

Where the terms of a change of energy, or of a work in the laboratory, nearly cancel, their rounding
is most of the error, and it may be the same in all runs that are compared.
"""

from typing import Any

import numpy as np

from tribo.accuracy.force_rounding import rounding_of_forces
from tribo.accuracy.scales import EPSILON, largest
from tribo.kernels.samples import BATH, SPRINGS, TORSIONAL, WITHIN
from tribo.layout.layout import Layout
from tribo.ledger.accounts import APPLIED, EXTERNAL, FORCES, Accounts
from tribo.ledger.motion import Motion
from tribo.model.fields import Corrugation
from tribo.model.scene import Scene
from tribo.potentials.combined import Sum, Wrapper
from tribo.potentials.cutoff import ForceShifted, Shifted

# Roundings of a term: those of the rates in it, of their squares, of products and of the sum.
TERM_ROUNDINGS = 4.0
# Effect of the rounding of a run, in units of sqrt(steps) roundings: three times the standard
# deviation of a random walk.  At one, one of 1000 random scenes had an error of 1.2 times its
# estimate; at two, one of 1500 had an error of 1.001 times.
WALK = 3.0
# Bobs of a surface of which the distances are looked at.
MOST_BOBS = 64
# Terms of a force: work about the centre of mass, pseudowork, and the impulse's at velocities x, y.
PARTS = 4
# All terms: those of each force, and the works of the reservoir's impulse at its own velocity.
TERMS = PARTS * len(FORCES) + 2


def _members(forces: tuple[str, ...], first: int) -> list[int]:
    """The terms of some forces, from the part `first` on."""
    places = [list(FORCES).index(name) for name in forces]
    return [PARTS * place + part for place in places for part in range(first, PARTS)]


def _sums() -> tuple[tuple[str, ...], np.ndarray]:
    """Names of sums of terms, and which terms each has (terms, sums)."""
    every, (about, pseudo, *_) = tuple(FORCES), _members(("w_T",), 0)
    members = {name: _members((name,), 0) for name in FORCES}
    members |= {f"{name}_ps": _members((name,), 1) for name in FORCES}
    members |= {"w": _members(every, 0), "w_ps": _members(every, 1)}
    members |= {"heat": [about, pseudo, TERMS - 2, TERMS - 1], "heat_swing": [about]}
    members |= {"friction_work": _members(("w1",), 2)}
    members |= {"external": _members(EXTERNAL, 0), "applied": _members(APPLIED, 0)}
    table = np.zeros((TERMS, len(members)))
    for column, terms in enumerate(members.values()):
        table[terms, column] = 1.0
    return tuple(members), table


SUMS, MEMBERS = _sums()


def rounding_of_terms(layout: Layout, motion: Motion, steps: int) -> dict[str, float]:
    """The rounding of the terms of energies and works, by quantity, in its own unit.

    Each term has some roundings of its own, and those of the run's `steps`, which add up like a
    random walk.  The motion is that of a run and of those that it is compared with.
    """
    samples, span = motion.samples, layout.accounted
    # The magnitudes of the terms of all accounts, summed: (times, asperites, sums).
    terms_of_works = np.abs(samples.linear("terms", lambda s: _terms(s[span])))
    sums = np.asarray(terms_of_works @ MEMBERS)
    if layout.model.sums is not None:  # over lanes, of each surface
        whole = [sums[:, part].sum(axis=1) for part in layout.accounted_parts]
        sums, parts = np.stack(whole, axis=1), [slice(k, k + 1) for k in range(len(whole))]
    else:
        parts = list(layout.parts.values())
    terms = dict(zip(SUMS, sums.max(axis=(0, 1)).tolist(), strict=True))
    friction, external, agents = np.moveaxis(sums[:, :, -3:], 2, 0)
    for name, each in (("W", external), ("friction_work", friction)):
        terms[name] = max(largest(each[:, part].sum(axis=1)) for part in parts)
    terms["W_ps"] = terms["W"]
    applied = agents.sum(axis=1)
    for slot in layout.accounts_of_fields:
        applied += np.abs(samples.s[:, slot])
    terms["applied_work"] = largest(applied)
    terms |= _of_energies(layout, motion)
    count = EPSILON * (TERM_ROUNDINGS + WALK * steps**0.5)
    found = {name: count * magnitude for name, magnitude in terms.items()}
    ends, forces = _of_ends(layout, motion, count), rounding_of_forces(layout, motion, steps)
    for each in (ends, forces, _of_cutoffs(layout)):
        for name, rounding in each.items():
            found[name] = found.get(name, 0.0) + rounding
    return found


def _of_ends(layout: Layout, motion: Motion, count: float) -> dict[str, float]:
    """The rounding of the works of the ends of clamped bars, by quantity; `count` is of angles.

    They are differences of sin x - x cos x, with x the twist, whose terms may be far larger, with
    the same bits in all runs.  In sums of both ends they cancel.
    """
    a, twist = motion.span.asperites, np.abs(motion.swing - motion.phi)
    clamped = layout.surfaces.acc_ends[a.surface] >= 0
    sin = np.abs(np.sin(twist))
    rounding = TERM_ROUNDINGS * EPSILON * (sin + np.abs(twist * np.cos(twist)))
    rounding += count * twist**2 * sin  # of the twist itself
    rounding *= np.where(clamped, a.kappa / a.bar_length, 0.0)
    found: dict[str, float] = {}
    for kind, lever in (("", a.l2 + a.pivot), ("_ps", a.pivot)):
        each = rounding * lever
        if layout.model.sums is not None:
            each = np.stack([each[:, part].sum(axis=1) for part in layout.parts.values()])
        found |= dict.fromkeys((f"wL{kind}", f"wR{kind}"), largest(each))
    return found


def _of_cutoffs(layout: Layout) -> dict[str, float]:
    """The rounding of what cutoffs subtract from energies, which may be far larger than these."""
    scene, found = layout.scene, {"total_energy_change": 0.0}
    for name, within in (("contact_energy", None), ("delta_E_int", True)):
        contacts = [contact for contact in layout.model.contacts if contact.within is within]
        energy = sum(_subtracted(contact.potential, scene) for contact in contacts)
        found[name] = TERM_ROUNDINGS * EPSILON * scene.count * energy
        found["total_energy_change"] += found[name]
    return found


def _subtracted(potential: Any, scene: Scene) -> float:
    """The energy that cutoffs in a potential subtract from that of two of the largest charges."""
    if isinstance(potential, Sum):
        return _subtracted(potential.first, scene) + _subtracted(potential.second, scene)
    if not isinstance(potential, Wrapper):
        return 0.0
    inner = potential.potential
    found = abs(getattr(potential, "factor", 1.0)) * _subtracted(inner, scene)
    end = getattr(potential, "cutoff", np.inf)
    if isinstance(potential, (Shifted, ForceShifted)) and end < inner.range():
        charge = max(float(np.max(np.abs(surface.each["charge"]))) for surface in scene.surfaces)
        found += abs(float(inner.energy_between(end, charge, charge)))
        if isinstance(potential, ForceShifted):
            found += abs(float(end * inner.force_between(end, charge, charge)))
    return found


def _terms(forces: Accounts) -> np.ndarray:
    """The terms of all accounts, (times, asperites, terms)."""
    (vx, vy), (x, y) = forces.span.velocity, forces.span.reservoir
    terms = []
    for name in FORCES:
        account = forces[name]
        terms += [account.about, account.pseudo, vx * account.jx, vy * account.jy]
    thermal = forces["w_T"]
    terms += [x * thermal.jx, y * thermal.jy]
    return np.stack([forces.whole(term) for term in terms], axis=2)


def _of_energies(layout: Layout, motion: Motion) -> dict[str, float]:
    """The largest terms of energies, by quantity."""
    a, velocity, samples = motion.span.asperites, motion.span.velocity, motion.samples
    internal, moving = motion.energy, motion.moving
    boost = a.mass * (np.abs(velocity[0] * motion.vx) + np.abs(velocity[1] * motion.vy))
    momentum = a.mass * np.hypot(motion.vx, motion.vy)
    whole, within, bulk = np.zeros(samples.t.size), 0.0, 0.0
    for index, part in enumerate(layout.parts.values()):
        record, stored = layout.surfaces[index], samples.stored[:, index]
        energy = (internal + moving)[:, part].sum(axis=1)
        energy += np.abs(stored[:, [SPRINGS, BATH, TORSIONAL, WITHIN]]).sum(axis=1)
        p = momentum[:, part].sum(axis=1)
        kinetic = p * (np.hypot(*velocity[:, part.start]) + p / record.mass)
        within, bulk = max(within, largest(energy)), max(bulk, largest(kinetic))
        whole = whole + energy + kinetic
    potentials = (field.potential for field in layout.model.fields or ())
    periods = (item.period for item in potentials if type(item) is Corrugation)
    shortest_wave = min(periods, default=np.inf) / (2.0 * np.pi)
    # The rounding of a position is relative to its terms, and an energy changes over the length of
    # its potential.  The rounding of an angle of many turns moves the ends of its arms.
    x = np.abs(a.x) + np.abs(a.vx * motion.t) + np.abs(motion.x)
    y = np.abs(a.y) + np.abs(a.vy * motion.t) + np.abs(motion.y)
    turned = 1.0 + np.abs(motion.swing)
    farthest = (np.hypot(x, y) + a.l1 * turned).max(axis=1)
    contact = np.abs(samples.contact) * (1.0 + farthest / _shortest_length(layout, motion))
    whole = whole + np.abs(samples.field) * (1.0 + farthest / shortest_wave)
    places = {
        f"{axis}_{end}": largest(magnitude + arm * turned)
        for end, arm in (("bob", a.l1), ("bar", a.l2))
        for axis, magnitude in (("x", x), ("y", y))
    }
    return places | {
        "delta_e_int": largest(internal),
        "swing_energy": largest(motion.swinging),
        "delta_k_trans": largest(moving + boost),
        "delta_E_int": within,
        "delta_K": bulk,
        "contact_energy": largest(contact),
        "total_energy_change": largest(whole + contact),
    }


def _shortest_length(layout: Layout, motion: Motion) -> float:
    """The shortest length over which a contact's force changes; infinite without contacts."""
    lengths = [contact.potential.feature()[0] for contact in layout.model.contacts]
    sample, parts = int(np.argmax(np.abs(motion.samples.contact))), list(layout.parts.values())
    x, y = (place[sample] for place in motion.bob)
    for contact in layout.model.contacts:
        for one, other in ((parts[i], parts[j]) for i, j in contact.pairs if i != j):
            dx, dy = (p[one][:MOST_BOBS, None] - p[other][:MOST_BOBS] for p in (x, y))
            nearest = np.min(np.hypot(dx, dy))
            lengths.append(float(contact.potential.clearance_between(nearest, 1.0, 1.0)))
    return min((length for length in lengths if length > 0.0), default=np.inf)
