"""The rounding of reported sums and differences, whose terms may be far larger than they are.

A change of an energy is a difference of two energies, and a work in the laboratory a sum of works
in another frame.  Where the terms nearly cancel, their rounding is most of the error, and it may be
the same in all runs that are compared.
"""

from __future__ import annotations

import numpy as np

from tribo.accuracy.scales import EPSILON, largest
from tribo.kernels.samples import BATH, SPRINGS, TORSIONAL, WITHIN
from tribo.model.fields import Corrugation
from tribo.run.accounts import Account
from tribo.run.closest_bobs import closest_bobs
from tribo.run.layout import Layout
from tribo.run.ledger import entries
from tribo.run.motion import Batch, Motion, internal_energy
from tribo.run.samples import Samples

# Roundings of a term: those of the rates in it, of their squares, of products and of the sum.
TERM_ROUNDINGS = 4.0
# Names of the works that outside agents do on a surface.
APPLIED = ("w2", "wL", "wR", "w_T")


class _Terms(dict[str, float]):
    """The largest magnitude of the terms of each quantity."""

    def put(self, name: str, *magnitudes: np.ndarray) -> np.ndarray:
        """Take in the sum of the magnitudes of all terms, and return it."""
        total = np.asarray(sum(magnitudes))
        self[name] = max(self.get(name, 0.0), largest(total))
        return total


def rounding_of_terms(layout: Layout, samples: Samples, steps: int) -> dict[str, float]:
    """The rounding of the terms of energies and works, by quantity, in its own unit.

    Each term has some roundings of its own, and those of its `steps`, which add up like a random
    walk.
    """
    terms = _Terms()
    whole = np.zeros(samples.t.size)
    applied, farthest = np.zeros(samples.t.size), np.zeros(samples.t.size)
    for k in range(len(layout.scene.surfaces)):
        energy, work, place = _of_surface(layout, samples, k, terms)
        whole, applied = whole + energy, applied + work
        farthest = np.maximum(farthest, place)
    # The rounding of a position is relative to its terms, and an energy changes over the length of
    # its potential.
    steepness = 1.0 + farthest / _shortest_length(layout, samples)
    whole = whole + terms.put("contact_energy", np.abs(samples.contact) * steepness)
    whole = whole + np.abs(samples.field) * (1.0 + farthest / _shortest_wave(layout))
    for field in layout.model.fields or ():
        if field.account >= 0:
            applied = applied + np.abs(samples.s[:, field.account])
    terms.put("total_energy_change", whole)
    terms.put("applied_work", applied)
    count = EPSILON * (TERM_ROUNDINGS + steps**0.5)
    return {name: count * magnitude for name, magnitude in terms.items()}


def _shortest_length(layout: Layout, samples: Samples) -> float:
    """The shortest length over which a contact's force changes; infinite without contacts.

    Of potentials without a length of their own, at the sample with the largest energy of contact.
    """
    potentials = [c.potential for c in (*layout.model.contacts, *(layout.model.within or ()))]
    lengths = [potential.feature()[0] for potential in potentials]
    largest_at = int(np.argmax(np.abs(samples.contact)))
    bobs = closest_bobs(layout, samples.at(samples.t[largest_at : largest_at + 1]))
    if bobs is not None:
        lengths += [float(potential.clearance(bobs[0])) for potential in potentials]
    return min((length for length in lengths if length > 0.0), default=np.inf)


def _shortest_wave(layout: Layout) -> float:
    """The shortest period over 2 pi of a corrugation; infinite without one."""
    potentials = (field.potential for field in layout.model.fields or ())
    periods = (item.period for item in potentials if isinstance(item, Corrugation))
    return min(periods, default=np.inf) / (2.0 * np.pi)


def _of_surface(
    layout: Layout, samples: Samples, index: int, terms: _Terms
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The terms of a surface: of its energy, of the applied work, and of places, each (times,)."""
    record, stored = layout.surfaces[index], samples.stored[:, index]
    energy = np.sum(np.abs(stored[:, [SPRINGS, BATH, TORSIONAL, WITHIN]]), axis=1)
    momentum, work, applied, farthest = (np.zeros(samples.t.size) for _ in range(4))
    speed = 0.0
    for batch, motion, forces, _ in entries(layout, samples, index):
        a = batch.asperites
        mass = a.mass
        x = np.abs(a.x) + np.abs(a.vx * motion.t) + np.abs(motion.x)
        y = np.abs(a.y) + np.abs(a.vy * motion.t) + np.abs(motion.y)
        for name, arm in (("bob", a.l1), ("bar", a.l2)):
            terms.put(f"x_{name}", x, arm)
            terms.put(f"y_{name}", y, arm)
        farthest = np.maximum(farthest, np.max(np.hypot(x, y) + a.l1, axis=1))
        internal, moving = _of_energies(batch, motion, terms)
        energy = energy + np.sum(internal, axis=1) + moving @ mass
        momentum = momentum + np.hypot(motion.vx, motion.vy) @ mass
        external, agents = _of_works(batch, forces, terms)
        work, applied = work + external, applied + agents
        speed = float(np.hypot(*batch.velocity))
    terms.put("W", work)
    terms.put("W_ps", work)
    terms.put("delta_E_int", energy)
    energy = energy + terms.put("delta_K", momentum * (speed + momentum / record.mass))
    return energy, applied, farthest


def _of_energies(batch: Batch, m: Motion, terms: _Terms) -> tuple[np.ndarray, np.ndarray]:
    """The terms of asperites' changes of energy: internal, and kinetic over mass."""
    internal = internal_energy(batch.asperites, m.omega, m.nu, m.swing - m.phi)
    moving = 0.5 * (m.vx**2 + m.vy**2)
    boost = np.abs(batch.velocity[0] * m.vx) + np.abs(batch.velocity[1] * m.vy)
    terms.put("delta_e_int", internal)
    terms.put("delta_k_trans", batch.asperites.mass * (moving + boost))
    return internal, moving


def _of_works(
    batch: Batch, forces: dict[str, Account], terms: _Terms
) -> tuple[np.ndarray, np.ndarray]:
    """The terms of asperites' works; their sums of external forces and of outside agents."""
    pseudo, whole = {}, {}
    for name, account in forces.items():
        jx, jy = batch.velocity[0] * account.jx, batch.velocity[1] * account.jy
        pseudo[name] = terms.put(f"{name}_ps", *map(np.abs, (account.pseudo, jx, jy)))
        whole[name] = terms.put(name, np.abs(account.about), pseudo[name])
    terms.put("w", *whole.values())
    terms.put("w_ps", *pseudo.values())
    thermal, record = forces["w_T"], batch.surface
    reservoir = np.abs(record.reservoir_x * thermal.jx) + np.abs(record.reservoir_y * thermal.jy)
    terms.put("heat", reservoir, np.abs(thermal.about), np.abs(thermal.pseudo))
    external = sum(whole[name] for name in whole if name != "w_int")
    agents = sum(whole[name] for name in APPLIED)
    return np.sum(external, axis=1), np.sum(agents, axis=1)
