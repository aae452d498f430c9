"""Surfaces and the system, from sums over asperites.  Arrays are (times,) unless stated."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from tribo.kernels.kinematics import rod_position, versine
from tribo.kernels.records import BARS
from tribo.kernels.samples import BATH, KINETIC, MOMENTUM_X, MOMENTUM_Y, SPRINGS, TORSIONAL, WITHIN
from tribo.layout.elastic_body import shares_of_edges
from tribo.layout.layout import Layout, once_per_layout
from tribo.layout.span import Span
from tribo.ledger.accounts import APPLIED, EXTERNAL, Account, Integrals, OfAccounts, Part
from tribo.ledger.contact_pairs import counts_of_contacts
from tribo.ledger.forces import Forces
from tribo.ledger.lazy import lazy_property
from tribo.ledger.motion import Motion
from tribo.ledger.samples import Samples
from tribo.ledger.separation import bob_places, touching

# In a run that stopped because values were not finite, the last are infinite or NaN here too.
_with_infinities = np.errstate(over="ignore", invalid="ignore")


class AsperiteSeries:
    """Some asperites, by their spans, from the samples of a run that begin with its start."""

    def __init__(self, layout: Layout, samples: Samples, spans: tuple[Span, ...]) -> None:
        self._layout = layout
        self.samples = samples
        self.spans = spans

    @lazy_property
    def motions(self) -> tuple[Motion, ...]:
        """The motion of the asperites, span by span."""
        return tuple(Motion(self._layout, span, self.samples) for span in self.spans)

    @_with_infinities
    def each(self, value: Callable[[Motion], np.ndarray]) -> np.ndarray:
        """A quantity of all asperites, (times, asperites)."""
        return _side_by_side([value(motion) for motion in self.motions])

    def accounted(self, integrals: Integrals, quantity: OfAccounts) -> np.ndarray:
        """A work, a pseudowork or the heat of all asperites, (times, asperites)."""
        return _side_by_side([quantity.series(integrals[span]) for span in self.spans])


class SurfaceSeries(AsperiteSeries):
    """A surface: its asperites, and sums over them; V is the velocity of its centre of all masses.

    `among` is the motion of all asperites, if it is known; `forces` is where the surfaces of a
    ledger keep those that they share.
    """

    def __init__(
        self,
        layout: Layout,
        samples: Samples,
        index: int,
        among: Motion | None = None,
        forces: list[Forces] | None = None,
    ) -> None:
        """Take the surface with this index; series are computed when they are asked for."""
        super().__init__(layout, samples, layout.spans[index])
        self._index = index
        # The asperites, or lanes that stand for their sums, with accounts.
        self._accounted = layout.accounted_spans[index]
        self._among = among
        self._forces = forces

    @lazy_property
    def _record(self) -> np.record:
        """The surface as the kernels know it."""
        return self._layout.surfaces[self._index]

    @property
    def place(self) -> tuple[Layout, int]:
        """The layout, and the index of the surface there."""
        return self._layout, self._index

    def summed(self, integrals: Integrals, quantity: OfAccounts) -> np.ndarray:
        """The sum over the asperites of a work, a pseudowork or the heat."""
        return _sum(quantity.series(integrals[span]) for span in self._accounted)

    def work(self, integrals: Integrals) -> np.ndarray:
        """The work of external forces."""
        return self.sum_over(integrals, EXTERNAL, Account.work)

    def pseudowork(self, integrals: Integrals) -> np.ndarray:
        """The pseudowork of external forces."""
        slot = self._record.acc_block
        boost = self.sum_over(integrals, EXTERNAL, Account.boost)
        if slot >= 0:
            return boost + integrals.s[:, slot]
        # Surfaces keep their momentum, or a constraint provides its change.
        return boost + self.samples.change(self._bulk) if self._record.drive == BARS else boost

    def friction(self, integrals: Integrals) -> np.ndarray:
        """Minus the work of the contact's impulse at the initial velocity of the surface."""
        return 0.0 - self.sum_over(integrals, ("w1",), Account.boost)

    def work_of_stage(self, integrals: Integrals) -> np.ndarray:
        """The work of the stage that pulls the surface: its speed times the impulse along x.

        Of a stage that follows a schedule, the work at its velocity relative to the surface's has
        an account.
        """
        layout = self._layout
        index = self._index
        speed = layout.velocity_of(index)[0]
        slot = self._record.acc_stage
        if slot < 0:
            speed = speed + layout.number_of(index, "speed")
        every = (integrals[span] for span in self._accounted)
        own = integrals.s[:, slot] if slot >= 0 else 0.0
        return np.asarray(own + speed * _sum(each.whole(each["w2"].jx) for each in every))

    @property
    def energy_of_pull(self) -> np.ndarray:
        """The energy of the springs between the bars and the stage."""
        layout = self._layout
        index = self._index
        stiffness = layout.number_of(index, "stiffness")
        anchor = float(layout.model.surfaces[index].anchor)
        stage = np.asarray(anchor + layout.stage_moved(index, self.samples.t))[:, None]

        def squares(motion: Motion) -> np.ndarray:
            if self._record.tilting:  # whose spring is at the mean of the bars
                return np.asarray((stage - motion.x_of_block) ** 2)
            x, _ = rod_position(motion.x, motion.y, -motion.span.asperites.l2, *motion.direction)
            return np.asarray((stage - x) ** 2)

        if self._record.elastic_block:
            return self._energy_of_elastic_pull(stage[:, 0])
        energy = np.asarray(0.5 * stiffness * self._total(squares))
        stiffness_y = float(self._record.stiffness_y)
        if stiffness_y > 0.0:  # of a block, whose bars are displaced alike
            energy = energy + 0.5 * stiffness_y * self._total(lambda e: e.y_of_block**2)
        return energy

    def _energy_of_elastic_pull(self, stage: np.ndarray) -> np.ndarray:
        """That of the spring at the place of the elastic body of a block."""
        count = int(self._record.end - self._record.start)

        def bar(motion: Motion) -> tuple[np.ndarray, np.ndarray]:
            a = motion.span.asperites
            _, ty = motion.direction
            rise = a.l2 * a.facing * versine(motion.swing)
            return motion.x - a.l2 * ty, motion.y - rise

        scene = self._layout.scene
        shares = shares_of_edges(scene, scene.surfaces[self._index])
        if shares is None:
            x = self._total(lambda motion: bar(motion)[0]) / count
            y = self._total(lambda motion: bar(motion)[1]) / count
        else:
            along = self.each(lambda motion: bar(motion)[0])
            upward = self.each(lambda motion: bar(motion)[1])
            x, y = np.einsum("atn,and->dt", (along, upward), shares) / count
        each = self._record.stiffness * (stage - x) ** 2 + self._record.stiffness_y * y**2
        return np.asarray(0.5 * count * each)

    @lazy_property
    def change_of_kinetic(self) -> np.ndarray:
        vx, vy = self._layout.velocity_of(self._index)
        lag_x, lag_y = self._lag
        moving = self._mass * (vx * lag_x + vy * lag_y) + self._bulk
        return self.samples.change(moving)

    @lazy_property
    def change_of_internal(self) -> np.ndarray:
        """The change of the internal energy: of all energy that is not bulk kinetic."""
        within = self._total(lambda e: e.within) - self._bulk
        stored = self.stored[:, [SPRINGS, BATH, TORSIONAL, WITHIN]]
        within = within + np.add.reduce(stored, axis=1)
        return self.samples.change(within)

    def force(self, name: str, axis: int) -> np.ndarray:
        """A force on each asperite along x or y, axis 0 or 1, (times, asperites)."""
        assert self._forces is not None
        if not self._forces:
            self._forces.append(Forces(self._layout, self.samples))
        (forces,) = self._forces
        index = self._index
        return _side_by_side([forces.of(motion, index, name, axis) for motion in self.motions])

    @property
    def without_contact(self) -> np.ndarray:
        """1 where no bob of the surface and one of another repel each other, else 0."""

        def is_mine(pair: tuple[int, int]) -> bool:
            return self._index in pair

        met = touching(self._layout, self.samples, is_mine, repelling=True)
        return (~np.any(met, axis=1)).astype(float)

    @lazy_property
    def _contacts(self) -> tuple[np.ndarray, np.ndarray]:
        """Contacts of each asperite, (times, asperites), and of the surface, (times,)."""
        layout = self._layout
        part = list(layout.parts.values())[self._index]
        places = bob_places(layout, self.samples)
        return counts_of_contacts(layout, places, self._index, part)

    @property
    def in_contact(self) -> np.ndarray:
        """1 where a bob and one of another surface repel each other, else 0, (times, asperites)."""
        return (self._contacts[0] > 0).astype(float)

    @property
    def contact_number(self) -> np.ndarray:
        """The number of pairs of a bob and one of another surface that repel each other."""
        return self._contacts[1].astype(float)

    @property
    def normal_forces(self) -> np.ndarray:
        """The contact force on each bob away from what its surface faces, (times, asperites)."""
        facing = self._layout.scene.surfaces[self._index].facing_sign
        return facing * self.force("f1", 1)

    @lazy_property
    def stored(self) -> np.ndarray:
        """The stored energies and momenta, (times, STORED)."""
        return self.samples.stored[:, self._index]

    @property
    def heat_of_bath(self) -> np.ndarray:
        """The change of the bath's energy in the motion with V, or with driven bars."""
        energy = self._bath_energy
        if self._record.drive != BARS:
            x, y = self._lag
            stored = self.stored
            common = x * stored[:, MOMENTUM_X] + y * stored[:, MOMENTUM_Y]
            energy = energy - common + 0.5 * self._mass_of_bath * (x**2 + y**2)
        return self.samples.change(energy)

    @property
    def kinetic_of_bath(self) -> np.ndarray:
        """The kinetic energy of the bath in the laboratory."""
        vx, vy = self._layout.velocity_of(self._index)
        stored = self.stored
        moving = vx * stored[:, MOMENTUM_X] + vy * stored[:, MOMENTUM_Y]
        own = self._own_kinetic_of_bath + moving
        return np.asarray(own + 0.5 * self._mass_of_bath * (vx**2 + vy**2))

    @property
    def potential_of_bath(self) -> np.ndarray:
        return np.asarray(self._bath_energy - self._own_kinetic_of_bath)

    @property
    def _mass_of_bath(self) -> float | np.ndarray:
        """The mass of all oscillators that move along x and y."""
        return self._mass - float(self._record.mass)

    @property
    def _bath_energy(self) -> np.ndarray:
        """The energy of the bath, in the surface's first frame."""
        return np.asarray(self.stored[:, [BATH, TORSIONAL]].sum(axis=1))

    @property
    def _own_kinetic_of_bath(self) -> np.ndarray:
        """The kinetic energy of the bath, in the surface's first frame."""
        part = list(self._layout.parts.values())[self._index]
        columns = self._layout.places.columns[part]
        return np.asarray(self.samples.baths[:, KINETIC, columns].sum(axis=1))

    @lazy_property
    def _mass(self) -> float | np.ndarray:
        """The mass of the surface and its bath."""
        return _masses(self._layout)[self._index]

    @lazy_property
    def _lag(self) -> tuple[np.ndarray, np.ndarray]:
        """The velocity V in the surface's first frame."""
        mass = self._mass
        stored = self.stored
        px = self._total(lambda e: e.momentum[0]) + stored[:, MOMENTUM_X]
        py = self._total(lambda e: e.momentum[1]) + stored[:, MOMENTUM_Y]
        return px / mass, py / mass

    @lazy_property
    def _bulk(self) -> np.ndarray:
        """The kinetic energy of the motion with V, in the surface's first frame."""
        lag_x, lag_y = self._lag
        bulk: np.ndarray = 0.5 * self._mass * (lag_x**2 + lag_y**2)
        return bulk

    def sum_over(
        self,
        integrals: Integrals,
        names: tuple[str, ...],
        part: Callable[[Account, np.ndarray], Part],
    ) -> np.ndarray:
        """The sum over the asperites of a part of the accounts of some forces."""
        return _sum([integrals[span].total(names, part) for span in self._accounted])

    def _total(self, value: Callable[[Motion], np.ndarray]) -> np.ndarray:
        """The sum over the asperites of a quantity; see :func:`_sum`."""
        if self._among is None:
            return _sum([value(motion) for motion in self.motions])
        every = value(self._among)
        return _sum([every[:, span.place] for span in self.spans])


@dataclass(eq=False)
class SystemSeries:
    """The whole system, which is no span of asperites, from the samples of a run."""

    layout: Layout
    samples: Samples
    wholes: tuple[SurfaceSeries, ...]
    spans: ClassVar[tuple[Span, ...]] = ()

    def change_of_energy(self) -> np.ndarray:
        """The change of the total energy; that of bobs at one place is infinite."""
        potential = self.samples.contact + self.samples.field
        change = self.samples.change(potential)
        changes = [whole.change_of_kinetic + whole.change_of_internal for whole in self.wholes]
        return sum(changes) + change

    def applied(self, integrals: Integrals) -> np.ndarray:
        """The work of drives, ends, reservoirs and moving fields."""
        works = sum(whole.sum_over(integrals, APPLIED, Account.work) for whole in self.wholes)
        return np.asarray(
            sum((integrals.s[:, slot] for slot in self.layout.accounts_of_fields), start=works)
        )


class Moving:
    """A quantity of each asperite; `value` takes the motion of some of them."""

    def __init__(self, value: Callable[[Motion], np.ndarray]) -> None:
        self.value = value

    def __call__(self, source: AsperiteSeries) -> np.ndarray:
        """Its series, (times, asperites)."""
        return source.each(self.value)


class Summed:
    """A quantity of a surface or the system, of which `value` computes the series."""

    def __init__(self, value: Callable[..., np.ndarray]) -> None:
        self.value = value

    @_with_infinities
    def __call__(self, source: SurfaceSeries | SystemSeries) -> np.ndarray:
        """Its series, (times,)."""
        return self.value(source)


class Linear:
    """A quantity that is linear in the integrals; `value` takes its surface or system and these."""

    def __init__(self, value: Callable[..., np.ndarray]) -> None:
        self.value = value

    def __call__(self, source: AsperiteSeries | SystemSeries) -> np.ndarray:
        """Its series, from the samples of its surface or of the system."""
        key = source.spans, self
        return source.samples.linear(key, lambda integrals: self.value(source, integrals))


@once_per_layout
def _masses(layout: Layout) -> list[float | np.ndarray]:
    return [layout.mass_of(index) for index in range(len(layout.parts))]


def _side_by_side(series: list[np.ndarray]) -> np.ndarray:
    """The series of all asperites, from those of the spans."""
    return series[0] if len(series) == 1 else np.concatenate(series, axis=1)


def _sum(values: Iterable[np.ndarray]) -> np.ndarray:
    """The sum over asperites, with the same bits for any number of times, unlike products."""
    total: Any = 0.0
    for value in values:
        total = total + np.add.reduce(value, axis=1)
    return total  # type: ignore[no-any-return]
